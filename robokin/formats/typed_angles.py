"""Whether joint values that a user types or pipes in look like angles in the other unit."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from robokin.formats.written_numbers import is_part_of_pi, significant

if TYPE_CHECKING:
    from robokin.arrays import Array
    from robokin.model import Robot, Tree
    from robokin.units import Units

LOOKED_AT = 600
"""Values that are looked at: a hundred lines of six."""

MANY = 50
"""Values from which their range says something: of so many drawn between -pi and pi some come near to the ends."""

NEAR_PI = 0.97
"""The greatest of many values is so much of pi, or less than a hair more, if they are drawn between -pi and pi."""

TURNS = 20.0
"""A joint value [rad] that is hardly meant, three turns."""


def unit_of_values(robot: Robot | Tree, units: Units, q: Array) -> str:
    """A sentence on joint values q: (m, n), in the units, that are likely in the other angle unit; "" for none."""
    return unit_of_angles(q[:, robot.revolute].ravel()[:LOOKED_AT].tolist(), units.degrees)


def unit_of_angles(values: Sequence[float], degrees: bool) -> str:
    """The same of the values of joints that turn, of at most `LOOKED_AT`."""
    values = [value for value in values if math.isfinite(value) and value]
    if not values:
        return ""
    most = max(map(abs, values))
    if not degrees:
        if most < TURNS:
            return ""
        return f"joint values up to {most:g} are read as radians, more than three turns; for degrees give --angle deg"
    if most > 2.0 * math.pi + 1e-3:
        return ""
    parts = [value for value in values if is_part_of_pi(value)]
    sure = [value for value in parts if significant(repr(value)) >= 4]
    drawn = len(values) >= MANY and NEAR_PI * math.pi <= most <= math.pi + 1e-6
    if not (len(parts) == len(values) or len(sure) >= max(2, len(values) // 20) or drawn):
        return ""
    shown = parts[0] if parts else most
    return f"joint values such as {shown:g} are read as degrees; for radians give --angle rad"
