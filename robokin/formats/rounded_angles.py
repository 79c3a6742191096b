"""The angles of one file that are taken as multiples of 15° cut in print, and the one note that tells of them."""

from __future__ import annotations

from robokin.errors import Note, counted, shown
from robokin.formats.snapped_angles import snapped_angle
from robokin.formats.yaml_tree import FilePlace


class RoundedAngles:
    """Takes angles in radians as what was meant, and counts where that is another number; not with `exact`."""

    def __init__(self, exact: bool = False) -> None:
        self.exact = exact
        self.count = 0
        self.first: tuple[FilePlace, str] | None = None

    def meant(self, value: float, text: str, place: FilePlace) -> float:
        """The angle [rad] that is meant by one written as `text`."""
        if self.exact:
            return value
        meant = snapped_angle(value, text)
        if meant != value:
            self.count += 1
            self.first = self.first or (place, text)
        return meant

    def notes(self) -> tuple[Note, ...]:
        """One note, or none."""
        if self.first is None:
            return ()
        place, text = self.first
        angles = "an angle" if self.count == 1 else counted(self.count, "angle")
        message = (
            f"{angles} cut in print ({shown(text)}) taken as multiples of 15° (--exact takes them as written)"
            if self.count > 1
            else f"{angles} cut in print ({shown(text)}) taken as a multiple of 15° (--exact takes it as written)"
        )
        return (Note(message, place.file, place.line, place.column),)
