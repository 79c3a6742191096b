"""Angles in radians that are plainly parts of pi cut in print: 1.5708, 3.1416.

A right angle that is off by 4e-6 makes axes skew that are meant to be parallel, and no closed form applies.
"""

from __future__ import annotations

import math

from robokin.errors import Note, counted, shown
from robokin.formats.written_numbers import is_part_of_pi
from robokin.formats.yaml_tree import FilePlace


class RoundedAngles:
    """Takes such angles as meant, and counts them for one note; not with `exact`."""

    def __init__(self, exact: bool = False) -> None:
        self.exact = exact
        self.count = 0
        self.first: tuple[FilePlace, str] | None = None

    def meant(self, value: float, text: str, place: FilePlace) -> float:
        """The angle [rad] that is meant by one written as `text`."""
        if self.exact or not is_part_of_pi(value, text):
            return value
        meant = round(value / (math.pi / 12.0)) * math.pi / 12.0
        if abs(meant - value) > 1e-15:
            self.count += 1
            self.first = self.first or (place, text)
        return meant

    def notes(self) -> tuple[Note, ...]:
        """One note, or none."""
        if self.first is None:
            return ()
        place, text = self.first
        message = (
            f"took {counted(self.count, 'angle')} such as {shown(text)} as the parts of pi that they are rounded from; "
            "exact takes them as written"
        )
        return (Note(message, place.file, place.line, place.column),)
