"""Answered Jacobians as items."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from robokin.cli.arguments import in_units, joint_factors
from robokin.cli.check_poses import matrix_argument
from robokin.cli.check_rows import NoAnswerError
from robokin.cli.checks import PASS, Item
from robokin.cli.output.numbers import show
from robokin.grading.tolerance import Tolerance
from robokin.kinematics.jacobian import jacobian
from robokin.model import Robot
from robokin.units import Units

Array = NDArray[np.float64]

ROWS = ("vx", "vy", "vz", "wx", "wy", "wz")


def jacobian_item(robot: Robot, q: Array, text: str, frame: str, allowed: Tolerance, units: Units) -> Item:
    """The mark of a 6×n matrix for q (n,) [rad | m]; its score is the part of the columns that are right.

    Linear entries of turning joints are lengths (for a radian), all others pure numbers, which may be off by the
    angle tolerance in radians.
    """
    J = jacobian(robot, q, "tool" if frame == "tool" else "base")
    scale = np.ones((6, robot.n))
    scale[:3, robot.revolute] = units.metres
    more: dict[str, Any] = {"q": in_units(q, joint_factors(robot, units)).tolist(), "frame": frame}
    expected = (J / scale + 0.0).tolist()
    try:
        given = matrix_argument(text, [(6, robot.n)], units) * scale
    except NoAnswerError as wrong:
        return Item("1", wrong.status, 0.0, expected, None, {"linear": None, "angular": None}, wrong.detail, more=more)
    right = _right(J, given, robot, allowed)
    off = np.abs(given - J)
    turning = robot.revolute
    errors: dict[str, float | None] = {
        "linear": float(np.max(off[:3] / scale[:3], initial=0.0)),
        "angular": float(np.max(off[3:], initial=0.0)),
    }
    if right.all():
        return Item("1", PASS, 1.0, expected, (given / scale).tolist(), errors, more=more)
    wrong_entries = np.argwhere(~right)
    i, k = wrong_entries[np.argmax((off / np.where(scale == 1.0, 1.0, allowed.size))[~right])]
    count = "1 entry" if len(wrong_entries) == 1 else f"{len(wrong_entries)} entries"
    found, wanted = show(given[i, k] / scale[i, k]), show(J[i, k] / scale[i, k])
    detail = f"{count} wrong, the worst {ROWS[i]} of q{k + 1}: {found}, expected {wanted}"
    other = "base" if frame == "tool" else "tool"
    if _right(jacobian(robot, q, "tool" if other == "tool" else "base"), given, robot, allowed).all():
        detail += f"; this is the Jacobian in the {other} frame"
    swapped = np.concatenate([J[3:], J[:3]]) / np.concatenate([scale[3:], scale[:3]])
    if turning.all() and _right(swapped * scale, given, robot, allowed).all():
        detail += "; the angular rows stand first, expected the linear ones first"
    score = float(np.mean(right.all(axis=0)))
    return Item("1", "wrong entries", score, expected, (given / scale).tolist(), errors, detail, more=more)


def _right(J: Array, given: Array, robot: Robot, allowed: Tolerance) -> NDArray[np.bool_]:
    """(6, n) which entries are within the tolerance."""
    right = np.zeros(J.shape, dtype=bool)
    for i, k in np.ndindex(J.shape):
        test = allowed.allows_position if i < 3 and robot.revolute[k] else allowed.allows_angle
        right[i, k] = test(float(abs(given[i, k] - J[i, k])), float(J[i, k]))
    return right
