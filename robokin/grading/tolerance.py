"""How far an answer may be off: stated, inclusive, and of a sensible size where nobody says it."""

from __future__ import annotations

import math
from dataclasses import dataclass

from robokin.errors import InputError
from robokin.expected import expect_flag, expect_number
from robokin.kinematics.structure import arm_size
from robokin.model import Robot, expect_robot

ANSWER_PART = 1e-3
"""Part of the arm's size by which an answered position may be off unless it is said otherwise: what rounding of
joint angles to a tenth of a degree does, well below what a wrong cell of the table does."""

ANSWER_ANGLE = math.radians(0.1)
"""The like for an orientation [rad]; a matrix printed with three decimals is off by up to 0.06°."""

TABLE_PART = 1e-4
"""Part of the arm's size by which the lengths of a table may be off: they are copied, not computed."""

TABLE_ANGLE = math.radians(0.01)
"""The like for its angles [rad]: pi/2 written as 1.5708 is off by 0.0002°, as 1.57 by 0.05°."""

ROUNDING = 1e-9
"""Part of a tolerance that is let pass beyond it, so that an error of just the tolerance passes in any unit."""

DUST = 1e-12
"""Part of the arm's size, and radians, below which every error is rounding, even where no tolerance is allowed."""


@dataclass(frozen=True)
class Tolerance:
    """What is allowed: position [m], angle [rad], and `relative`, a part of the right value's size added to them.

    `size` [m] is the arm's.
    """

    position: float
    angle: float
    relative: float = 0.0
    size: float = 1.0

    def __post_init__(self) -> None:
        """Refuse what is no tolerance. Raises InputError."""
        for name in ("position", "angle", "relative", "size"):
            value = expect_number(getattr(self, name), name, "a finite number of 0 or more")
            if value < 0.0:
                raise InputError(f"{name}: found {value:g}, expected a finite number of 0 or more")

    def allows_position(self, error: float, right: float = 0.0) -> bool:
        """Whether a length may be off by the error [m], the right one being of the size `right` [m]."""
        return error <= (self.position + self.relative * abs(right)) * (1.0 + ROUNDING) + DUST * self.size

    def allows_angle(self, error: float, right: float = 0.0) -> bool:
        """Whether an angle may be off by the error [rad]; a NaN never passes."""
        return error <= (self.angle + self.relative * abs(right)) * (1.0 + ROUNDING) + DUST


def default_tolerance(robot: Robot, *, table: bool = False) -> Tolerance:
    """The tolerance for answers about a robot, or for its table, where none is stated.

    The length is the greatest of 1, 2 or 5 times a power of ten, in the description's own unit, that is no more
    than its part of the arm's size: a number that can be said, and the same whatever units are asked for. Raises
    InputTypeError for what is no robot.
    """
    robot, table = expect_robot(robot), expect_flag(table, "table")
    size = arm_size(robot)
    part = (TABLE_PART if table else ANSWER_PART) * size / robot.units.metres
    power = 10.0 ** math.floor(math.log10(part))
    digit = max(digit for digit in (1.0, 2.0, 5.0) if digit * power <= part * (1.0 + ROUNDING) or digit == 1.0)
    position = float(f"{digit * power:.1g}") * robot.units.metres
    return Tolerance(position, TABLE_ANGLE if table else ANSWER_ANGLE, size=size)
