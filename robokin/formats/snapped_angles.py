"""Angles that are parts of pi cut in print, taken as what was meant.

Makers print 1.5708 for a right angle. An axis that is off by 4e-6 rad meets no other any more, and an arm with a closed
form has none. One note tells of all such angles of a file.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from robokin.errors import Note, counted, shown
from robokin.formats.written_numbers import decimals, significant
from robokin.formats.yaml_tree import FilePlace

MOST_NAMED = 12
"""Names that a message lists."""

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


class RoundedAngles:
    """Takes angles in radians as what was meant, and keeps which of them that changes; not with `exact`.

    least [rad]: an angle that is moved by no more than this is moved without a note.
    """

    def __init__(self, exact: bool = False, least: float = 0.0) -> None:
        self.exact, self.least = exact, least
        self.count = 0
        self.first: tuple[FilePlace, str] | None = None
        self.owners: dict[str, None] = {}

    def meant(self, value: float, text: str, place: FilePlace, owner: str = "") -> float:
        """The angle [rad] that is meant by one written as `text`; owner: the joint that the note is to name."""
        if self.exact:
            return value
        meant = snapped_angle(value, text)
        if abs(meant - value) > self.least:
            self.count += 1
            self.first = self.first or (place, text)
            if owner:
                self.owners[owner] = None
        return meant

    def notes(self) -> tuple[Note, ...]:
        """One note, or none: how many angles there are, or whose."""
        if self.first is None:
            return ()
        place, text = self.first
        ending = "(--exact takes them as written)"
        if self.owners:
            message = f"angles cut in print are taken as multiples of 15° in {listed_joints([*self.owners])} {ending}"
        elif self.count > 1:
            angles = counted(self.count, "angle")
            message = f"{angles} cut in print ({shown(text)}) taken as multiples of 15° {ending}"
        else:
            message = f"an angle cut in print ({shown(text)}) taken as a multiple of 15° (--exact takes it as written)"
        return (Note(message, place.file, place.line, place.column),)


def listed_joints(names: Sequence[str]) -> str:
    """Names of joints or links in a line."""
    more = f" and {len(names) - MOST_NAMED} more" if len(names) > MOST_NAMED else ""
    return ", ".join(shown(name) for name in names[:MOST_NAMED]) + more
