"""Which values the variables of a robot may have whose joints hang on each other: a box, and what cuts it.

Limits of what is typed, and of joints that one variable alone moves, make the box. Limits of a joint that several move
together (a forearm held against the horizontal) are inequalities between these.
"""

from __future__ import annotations

import numpy as np

from robokin.arrays import Array, Flags
from robokin.errors import InputError, shown
from robokin.model import CoupledRobot
from robokin.spatial.angles import TURN
from robokin.workspace.half_spaces import ROUNDING, HalfSpaces

TURNS_BACK = 64
"""Turns of a variable after which all that it moves stands as before, at most: ratios of a gear's teeth are smaller."""

WHOLE = 1e-9
"""How far a number may be from a whole one: ratios are typed as fractions, or with many digits."""


def geared_box(robot: CoupledRobot) -> tuple[Array, Array, Flags, HalfSpaces]:
    """low, high (n,) [rad | m], which variables make a whole turn, and what else the variables must satisfy.

    A variable that turns without limits has as many turns as lead all joints back. Raises InputError where there is no
    end of values, or none at all.
    """
    drive = robot.drive
    box = drive.limits - drive.offsets[:, None]
    low, high = robot.limits[:, 0].copy(), robot.limits[:, 1].copy()
    several = np.sum(drive.S != 0.0, axis=1) != 1
    cuts = HalfSpaces.of(
        np.concatenate([drive.S[several], -drive.S[several]]), np.concatenate([box[several, 1], -box[several, 0]])
    )
    low, high = cuts.hull(low, high)
    if cuts.empty or np.any(low > high + ROUNDING):
        raise InputError(f"no values are within the limits of all joints of {robot.name}, expected limits that agree")
    high = np.maximum(low, high)  # one value, but for rounding
    cuts = cuts.cutting(low, high)
    full = np.zeros(robot.n, dtype=bool)
    for j, joint in enumerate(robot.joints):
        endless = not np.isfinite(high[j] - low[j])
        if endless and not robot.revolute[j]:
            raise InputError(
                f"joint {shown(joint.name)} slides without limits, expected limits in the description: the workspace "
                "has no bound"
            )
        turns = 0 if not robot.revolute[j] or cuts.linked[j] else _turns(robot, j)
        if endless and not turns:
            raise InputError(
                f"joint {shown(joint.name)} turns without limits and other joints with it, by a ratio that leads back "
                f"after no {TURNS_BACK} turns or to limits, expected limits in the description"
            )
        if turns and not high[j] - low[j] < turns * TURN * (1.0 - 1e-12):
            low[j], high[j] = _about(low[j], high[j], 0.5 * turns * TURN)
            full[j] = turns == 1
    return low, high, full, cuts


def _turns(robot: CoupledRobot, j: int) -> int:
    """The least number of turns of variable j that lead all joints back to where they stood; 0 where none does."""
    column = robot.drive.S[:, j]
    if np.any(column[~robot.free_motion.revolute]):
        return 0
    for count in range(1, TURNS_BACK + 1):
        turned = count * column
        if np.all(np.abs(turned - np.round(turned)) <= WHOLE * np.maximum(1.0, np.abs(turned))):
            return count
    return 0


def _about(low: float, high: float, half: float) -> tuple[float, float]:
    """A range of `half` [rad] each way about the middle of limits, or within the only one that there is."""
    if np.isfinite(low) and np.isfinite(high):
        middle = 0.5 * (low + high)
    else:
        middle = low + half if np.isfinite(low) else high - half if np.isfinite(high) else 0.0
    return float(middle - half), float(middle + half)
