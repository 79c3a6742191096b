"""Angles that are parts of pi cut in print, taken as what was meant.

Makers print 1.5708 for a right angle. An axis that is off by 4e-6 rad meets no other any more, and an arm with a closed
form has none.
"""

from __future__ import annotations

import math

from robokin.formats.written_numbers import decimals, significant

TWELFTH = math.pi / 12.0
LEAST_DIGITS = {True: 3, False: 4}
"""Digits that tell a part of pi from any other number, for eighths of a turn and for other twelfths of pi: 1.57 and
0.785 are hardly anything else, 1.05 may be."""


def snapped_angle(value: float, text: str) -> float:
    """The multiple of pi/12 that an angle [rad], written as `text`, is when rounded or cut off there; else the angle.

    0 stays what it is, and what is near 0 is none.
    """
    part = round(value / TWELFTH)
    if part == 0 or abs(part) > 48 or significant(text) < LEAST_DIGITS[part % 3 == 0]:
        return value
    meant = part * TWELFTH
    last = 10.0 ** -min(decimals(text), 15)
    missing = abs(meant) - abs(value)
    return meant if abs(missing) <= 0.5001 * last or 0.0 <= missing < last else value
