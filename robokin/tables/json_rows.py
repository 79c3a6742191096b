"""Rows of numbers from JSON: lists, objects that hold them such as `fk` and `ik` write, or objects by names."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Sequence
from typing import IO, Any

import numpy as np

from robokin.arrays import Array
from robokin.errors import ExpressionError, InputError, counted, or_list, shown
from robokin.json_text import finite
from robokin.tables.carried import ID, Carried, given_back
from robokin.tables.json_documents import DocumentReader
from robokin.tables.number_cells import number_in
from robokin.tables.text_source import Say
from robokin.tables.wanted_columns import Wanted
from robokin.units import METRES, RADIANS, Units

WRITTEN = frozenset(
    ("schema", "robot", "units", "q", "within_limits", "pose", "frames", "target", "reachable", "complete", "basis",
     "certificate", "counts", "families", "families_complete", "method", "reason", "solutions", "nearest", "hold",
     "explanation", "jump",
     "matrix", "position", "task")
)  # fmt: skip
"""Keys of the documents that `fk` and `ik` write."""


class JsonReader(DocumentReader):
    """A stream of JSON documents of joint values."""

    def __init__(self, stream: IO[bytes], name: str, wanted: Wanted, carried: Carried, say: Say) -> None:
        """Numbers of documents that state no units are in those of `wanted`."""
        key = wanted.key
        super().__init__(stream, name, f'expected a list or an object with "{key}" on each line: {wanted.what}', say)
        self.wanted, self.carried = wanted, carried
        self.passing = Passing(carried)
        self.unsolved = 0
        """How many documents said that inverse kinematics had no solution: they hold no configuration."""

    def rows(self) -> Iterator[Array]:
        """Blocks (m, k) of the wanted columns."""
        for documents in self.documents():
            each = ((number, one) for number, document in documents for one in _elements(document))
            rows = [row for number, one in each for row in self.json_rows(one, number)]
            if rows:
                yield np.array(rows, dtype=float).reshape(len(rows), -1)

    def json_rows(self, document: Any, number: int) -> list[list[float]]:
        """The rows of a document: a list, or what an object has under the key or by names, in the units that it states.

        An object such as `ik` writes has a row in each of its solutions.
        """
        try:
            if not isinstance(document, dict):
                self.passing.add({}, (), 1)
                return [self.json_row(document, self.wanted.units)]
            units = stated_units(document.get("units"), self.wanted.units)
            key, solutions = self.wanted.key, document.get("solutions")
            if key in document:
                found, used = [document[key]], [key]
            elif isinstance(solutions, list):
                self.unsolved += not solutions
                found, used = [one.get(key) if isinstance(one, dict) else None for one in solutions], ["solutions"]
            else:
                used = self.named(document)
                found = [document]
            rows = [self.json_row(value, units) for value in found]
            self.passing.add(document, used, len(rows))
        except InputError as error:
            raise self.error(number, str(error)) from None
        return rows

    def named(self, document: dict[str, Any]) -> list[str]:
        """The keys of an object that has the values by names. Raises InputError for one that has none."""
        names = list(document)
        try:
            return [names[i] for i in self.wanted.headed(names).places]
        except InputError as error:
            said = str(error) if len(names) < 40 else ""
            raise InputError(f"the key '{self.wanted.key}' is missing, {self.expected}; or by names: {said}") from None

    def json_row(self, values: Any, units: Units) -> list[float]:
        """The values of a list, or of an object that has them by names."""
        found = self.wanted.plain(0)
        columns = found.units
        if isinstance(values, dict):
            found = self.wanted.headed(list(values))
            columns, values = found.units, [[*values.values()][i] for i in found.places]
        elif not isinstance(values, list):
            raise InputError(f"found {_json(values)}, {self.expected}")
        if len(values) != len(found.places):
            said = counted(len(values), "value")
            raise InputError(f"found {said}, expected {len(found.places)}: {self.wanted.what}")
        row = []
        for value, angle, column in zip(values, found.way.angles, columns, strict=True):
            own = column if column != self.wanted.units else units
            number = _number(value, own, angle)
            factor = own.radians / self.wanted.units.radians if angle else own.metres / self.wanted.units.metres
            row.append(number * factor)
        return row


def _elements(document: Any) -> list[Any]:
    """The documents of a line: itself, or the elements of a list of lists or of objects."""
    listed = isinstance(document, list) and document and all(isinstance(one, (list, dict)) for one in document)
    return document if listed else [document]


class Passing:
    """The values of documents that go through; their names are the keys of the first document."""

    def __init__(self, carried: Carried) -> None:
        self.carried = carried
        self.begun = False
        self.known: set[str] = set()
        self.passed: list[str] = []
        """The keys of what goes through."""

    def add(self, document: dict[str, Any], used: Sequence[str], count: int) -> None:
        """Hand on what is not understood of a document, once for each of its rows."""
        if not self.carried.wanted:
            return
        more = {name: value for name, value in document.items() if name not in used and not _written(name, document)}
        if _written(ID, document) and (before := given_back(more)):
            more = {ID if name == before else name: value for name, value in more.items()}
        if not self.begun:
            self.begun = True
            keys = list(more)
            self.passed = [keys[i] for i in self.carried.choose(keys, ())]
            self.carried.typed = True
            self.known = {*more}
        new = [name for name in more if name not in self.known]
        if new:
            self.known |= {*new}
            self.carried.say(f"the key '{shown(new[0])}' is left out, since the first document has none of that name")
        if self.passed:
            self.carried.put([[finite(more.get(name)) for name in self.passed]] * count)


def _written(name: str, document: dict[str, Any]) -> bool:
    """Whether a key is one that `fk` or `ik` wrote."""
    return name in WRITTEN or (name == ID and "robot" in document and document.get(ID) == document["robot"])


def _number(value: Any, units: Units, angle: bool) -> float:
    """A number, or the value of an expression."""
    if isinstance(value, str):
        try:
            return number_in(value, units, angle)
        except ExpressionError as error:
            raise InputError(str(error)) from None
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not _finite(value):
        raise InputError(f"found {_json(value)}, expected a finite number")
    return float(value)


def stated_units(stated: Any, otherwise: Units) -> Units:
    """The units that a document states, as those that `fk` writes do. Raises InputError for what is none."""
    if stated is None:
        return otherwise
    if isinstance(stated, dict):
        length, angle = stated.get("length", otherwise.length), stated.get("angle", otherwise.angle)
        if length in [*METRES] and angle in [*RADIANS]:  # it may be anything, also what cannot be hashed
            return otherwise.override(length, angle)
    expected = f"expected length {or_list(METRES)} and angle {or_list(RADIANS)}"
    raise InputError(f"found the units {json.dumps(stated)[:60]}, {expected}")


def _json(value: Any) -> str:
    return json.dumps(value)[:40]


def _finite(value: float) -> bool:
    try:
        return math.isfinite(value)
    except OverflowError:
        return False
