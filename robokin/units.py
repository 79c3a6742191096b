"""Units of lengths and angles. Everything inside robokin is in metres and radians.

A description and the command line speak in units of their own; `Units` holds the two factors.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from robokin.expected import expect_choice

METRES = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254}
"""Length units by name: metres in one of them."""

RADIANS = {"rad": 1.0, "deg": math.pi / 180.0}
"""Angle units by name: radians in one of them."""


@dataclass(frozen=True, slots=True)
class Units:
    """A length unit (m, cm, mm, in) and an angle unit (rad, deg)."""

    length: str = "m"
    angle: str = "rad"

    def __post_init__(self) -> None:
        """Refuse what is no unit. Raises InputError."""
        expect_choice(self.length, METRES, "length")
        expect_choice(self.angle, RADIANS, "angle")

    @property
    def metres(self) -> float:
        """Metres in one length unit."""
        return METRES[self.length]

    @property
    def radians(self) -> float:
        """Radians in one angle unit."""
        return RADIANS[self.angle]

    @property
    def degrees(self) -> bool:
        """Whether angles are in degrees."""
        return self.angle == "deg"

    def override(self, length: str | None = None, angle: str | None = None) -> Units:
        """These units with the given ones in place of their own. Raises InputError for what is no unit."""
        return replace(self, length=length or self.length, angle=angle or self.angle)

    def as_record(self) -> dict[str, str]:
        """`{"length": …, "angle": …}`, as every JSON document says it."""
        return {"length": self.length, "angle": self.angle}


def value_in_unit(value: float, factor: float) -> float:
    """An SI value in units of `factor`, without the last digit's dust that the division leaves.

    90° in radians and back is 90.00000000000001; a value within two units in the last place of one
    with twelve digits is that one.
    """
    scaled = value / factor
    short = float(f"{scaled:.12g}")
    return (short if abs(scaled - short) <= 4.0 * math.ulp(scaled) else scaled) + 0.0
