"""Plain calls without the native kernel: an array of floats goes to the robot's own code before any check.

What `at_once` does where there is a kernel. What is unusual gets None, and is looked at by those who have the words.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from robokin.arrays import Array
from robokin.kernel.facts import NAME, facts_of
from robokin.kernel.straight_line import Straight
from robokin.model import Robot

POSE, JACOBIAN = "code of the pose", "code of the Jacobian"
"""What the facts are called in which a robot's code is found in no time."""

FLOATS = np.dtype(np.float64)


def pose_by_code(robot: Robot, q: Any) -> Array | None:
    """The pose of the tool (4, 4) at q (n,), or None."""
    return _by_code(POSE, robot, q)


def jacobian_by_code(robot: Robot, q: Any) -> Array | None:
    """The Jacobian (6, n) in the axes of the base, or None."""
    columns = _by_code(JACOBIAN, robot, q)
    return None if columns is None else columns.T


def _by_code(name: str, robot: Any, q: Any) -> Array | None:
    """What the code of a robot finds at q (n,); of an infinite angle or another number of values None."""
    if type(robot) is not Robot or type(q) is not np.ndarray or q.dtype is not FLOATS or q.ndim != 1:
        return None
    try:
        found: Array = robot.__dict__[NAME][name](q.tolist())
    except (KeyError, ValueError):
        return None
    return found


def keep_code(name: str, robot: Robot, code: Straight) -> None:
    """Let plain calls find the code of a robot whose joints move one by one from now on."""
    facts_of(robot)[name] = code
