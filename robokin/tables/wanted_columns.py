"""What is wanted of each row of a table: by a header, or by how many numbers a row without one has."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np

from robokin.arrays import Array
from robokin.tables.headings import FoundColumns, Way
from robokin.units import Units


class Wanted(ABC):
    """The numbers that are wanted of each row, in some units. `what` says what they are, `key` their name in JSON."""

    key: str
    what: str
    units: Units

    @abstractmethod
    def headed(self, headings: Sequence[str]) -> FoundColumns:
        """Where the columns stand below some headings. Raises InputError that lists what is allowed."""

    @abstractmethod
    def bare(self, count: int) -> Way:
        """What a row of so many numbers without a header is. Raises InputError where that cannot be told."""

    def plain(self, count: int) -> FoundColumns:
        """The same, with the places of its columns."""
        way = self.bare(count)
        return FoundColumns(way, tuple(range(len(way.columns))), (self.units,) * len(way.columns))


def factors(found: FoundColumns, units: Units) -> Array | None:
    """(k,) what numbers of the columns are multiplied with to be in `units`; None for nothing but ones."""
    values = [
        column.radians / units.radians if angle else column.metres / units.metres
        for column, angle in zip(found.units, found.way.angles, strict=True)
    ]
    return None if all(value == 1.0 for value in values) else np.array(values)
