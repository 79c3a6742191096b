"""What the headings of a table mean: usual names in any order, in upper or lower case, with a unit behind them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from robokin.errors import InputError, shown
from robokin.units import METRES, RADIANS, Units

MAX_NAMES = 200
"""Characters of a header that a message repeats."""

UNIT_WORDS = {
    **{word: word for word in (*METRES, *RADIANS)},
    "degree": "deg",
    "degrees": "deg",
    "°": "deg",
    "radian": "rad",
    "radians": "rad",
    "inch": "in",
}
"""How a heading says a unit."""

WITH_UNIT = re.compile(  # the name may not end in what belongs to the unit
    r"(?P<name>.*?)\s*(?:[\[(]\s*(?P<a>{0})\s*[\])]|[_/]\s*(?P<b>{0}))".format("|".join(map(re.escape, UNIT_WORDS))),
    re.IGNORECASE,
)


@dataclass(frozen=True)
class Way:
    """A set of columns that say what is wanted.

    `columns` are the names that each may have, the first one as it is written. `kinds` has a letter for each: l for
    a length, a for an angle, u for a pure number. `numbered` is what stands before the number where names are
    numbered from 1; `kind` is for the reader of what was found.
    """

    columns: tuple[tuple[str, ...], ...]
    kinds: str
    numbered: str = ""
    kind: str = ""

    @property
    def names(self) -> tuple[str, ...]:
        """The columns as they are written."""
        return tuple(names[0] for names in self.columns)

    @property
    def angles(self) -> tuple[bool, ...]:
        """Which columns are angles."""
        return tuple(kind == "a" for kind in self.kinds)


@dataclass(frozen=True)
class FoundColumns:
    """Where the columns of a way stand in a table, and the units of each."""

    way: Way
    places: tuple[int, ...]
    units: tuple[Units, ...]


def normal(heading: str) -> str:
    """A heading in lower case, words joined by one underscore: `Joint 1` and `joint_1` are the same."""
    return re.sub(r"[\s_.\-]+", "_", heading.strip().casefold())


def find(ways: Sequence[Way], headings: Sequence[str], units: Units) -> FoundColumns | None:
    """The first of some ways whose columns are all there; as they are written comes before other spellings.

    Raises InputError for a column that is there twice, or whose unit cannot be that of its values, or where numbered
    columns go on beyond those that are wanted.
    """
    exact = next((way for way in ways if set(headings) >= {*way.names}), None)
    if exact is not None:
        found: list[list[tuple[int, str]]] = [
            [(i, "") for i, heading in enumerate(headings) if heading == name] for name in exact.names
        ]
        return _only(exact, found, headings, units)
    spelled = [(normal(heading), *_with_unit(heading)) for heading in headings]
    for way in ways:
        found = [_places({normal(name) for name in names}, spelled) for names in way.columns]
        if all(found):
            return _only(way, found, headings, units)
    return None


def partial(way: Way, headings: Sequence[str]) -> list[str]:
    """The headings that are columns of a way."""
    known = {normal(name) for names in way.columns for name in names}
    return [heading for heading in headings if normal(heading) in known or _with_unit(heading)[0] in known]


def refused(headings: Sequence[str], expected: str) -> InputError:
    """The error for headings that say nothing that is wanted."""
    return InputError(f"found the columns {shown(', '.join(headings), MAX_NAMES)}, expected {expected}")


def _with_unit(heading: str) -> tuple[str, str]:
    """The normal form of a heading's name and its unit; ("", "") where it has none."""
    match = WITH_UNIT.fullmatch(heading.strip()) if len(heading) < MAX_NAMES else None
    return (normal(match["name"]), UNIT_WORDS[(match["a"] or match["b"]).casefold()]) if match else ("", "")


def _places(known: set[str], spelled: Sequence[tuple[str, str, str]]) -> list[tuple[int, str]]:
    """Where headings stand that are one of some names, with the unit behind the name or ""."""
    return [
        (i, "" if plain in known else unit)
        for i, (plain, name, unit) in enumerate(spelled)
        if plain in known or name in known
    ]


def _only(way: Way, found: list[list[tuple[int, str]]], headings: Sequence[str], units: Units) -> FoundColumns:
    """The one place of each column, and its units."""
    stated = []
    for places, kind in zip(found, way.kinds, strict=True):
        names = [headings[i] for i, _ in places]
        if len(places) > 1:
            if len({*names}) == 1:
                raise InputError(f"found the column '{shown(names[0])}' twice, expected it once")
            raise InputError(
                f"found the columns {shown(' and '.join(names))}, which say the same, expected one of them"
            )
        unit = places[0][1]
        if unit and kind != ("a" if unit in RADIANS else "l"):
            expected = {"a": "a unit of angles (deg, rad)", "l": "a unit of lengths (m, cm, mm, in)", "u": "no unit"}
            raise InputError(f"found the unit {unit} in the column '{shown(names[0])}', expected {expected[kind]}")
        stated.append(units.override(angle=unit) if kind == "a" else units.override(length=unit))
    at = tuple(places[0][0] for places in found)
    if way.numbered:
        more = [h for i, h in enumerate(headings) if i not in at and re.fullmatch(way.numbered + r"_?\d+", normal(h))]
        if more:
            raise InputError(f"found the column '{shown(more[0])}', expected {way.names[0]} to {way.names[-1]} alone")
    return FoundColumns(way, at, tuple(stated))
