"""Where no solution is exact: the nearest pose, if it will do within stated tolerances."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from robokin.arrays import Array
from robokin.inverse.solutions import Result
from robokin.inverse.solve import solve_many
from robokin.inverse.verify import CLOSES, residuals
from robokin.kinematics.forward import forward_kinematics
from robokin.model import Robot

NEAREST = "solved for the nearest pose, within the tolerances"
"""Why a list of solutions that miss the target by no more than the tolerances is not said to be complete."""


def within_tolerance(
    robot: Robot, T: Array, result: Result, position: float | None, angle: float | None, **options: Any
) -> Result:
    """The result, or where it has no solution all solutions of the nearest pose, if the tolerances allow that.

    T: (4, 4) [m] the target. position [m], angle [rad]: how far the nearest pose may be off; None for both asks for
    exact solutions, None for one for none of that error. `options` are those of `robokin.solve_ik` that the result
    comes from. Each solution has its errors against the target.
    """
    nearest = result.nearest
    if nearest is None or (position is None and angle is None):
        return result
    if nearest.position_error > max(position or 0.0, CLOSES) or nearest.angle_error > max(angle or 0.0, CLOSES):
        return result
    # The nearest pose has other solutions than the one that was found first.
    reached = forward_kinematics(robot, nearest.q)
    found = solve_many(robot, reached[None], **{**options, "task": "pose"})[0].solutions
    solutions = [nearest] if nearest.within_limits or not options.get("limits", True) else []
    if found and options.get("task", "pose") == "pose":
        errors = residuals(np.array([T] * len(found)), np.array([reached] * len(found)))
        solutions = [
            replace(solution, position_error=float(off), angle_error=float(turn))
            for solution, off, turn in zip(found, *errors, strict=True)
        ]
    if not solutions:
        return result
    return replace(
        result, solutions=tuple(solutions), complete=False, basis=None, certificate=NEAREST, families=(),
        families_complete=False,
        reason=None, nearest=None, postures=False, counts={"listed": len(solutions)},
    )  # fmt: skip
