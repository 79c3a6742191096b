"""Rows of numbers from JSON lines: lists, or objects that hold them, such as `fk` writes."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robokin.cli.lines import LineReader
from robokin.cli.output.numbers import counted
from robokin.errors import or_list
from robokin.units import METRES, RADIANS, Units

Array = NDArray[np.float64]


class JsonReader(LineReader):
    """A stream of JSON documents, one a line."""

    def blocks(self) -> Iterator[Array]:
        """Blocks (m, k) of the wanted columns."""
        for block in self.text_blocks():
            rows = []
            for number, line in enumerate(self.decode(block, self.line + 1).split("\n"), start=self.line + 1):
                if line.strip():
                    rows += self.json_rows(line, number)
            self.line += block.count(b"\n") + 1
            if rows:
                yield np.array(rows, dtype=float).reshape(len(rows), self.columns.count)

    def json_rows(self, line: str, number: int) -> list[list[float]]:
        """The rows of a line: a list, or what an object has under the key, in the units that it states.

        An object such as `ik` writes has a row in each of its solutions.
        """
        key, what = self.columns.key, self.columns.what
        expected = f'expected a list or an object with "{key}" on each line: {what}'
        try:
            document = json.loads(line)
        except (ValueError, RecursionError) as error:
            reason = f"{error.msg} at column {error.colno}" if isinstance(error, json.JSONDecodeError) else str(error)
            raise self.error(number, f"this is not JSON ({reason}), {expected}") from None
        units = self.units
        if isinstance(document, dict):
            solutions = document.get("solutions")
            if key not in document and isinstance(solutions, list):
                self.unsolved += not solutions
                stated = self.stated_units(document.get("units"), number)
                found = [solution.get(key) if isinstance(solution, dict) else None for solution in solutions]
                return [self.json_row(row, stated, number, expected) for row in found]
            if key not in document:
                raise self.error(number, f"the key '{key}' is missing, {expected}")
            units = self.stated_units(document.get("units"), number)
            document = document[key]
        return [self.json_row(document, units, number, expected)]

    def json_row(self, document: Any, units: Units, number: int, expected: str) -> list[float]:
        """The values of a list."""
        what = self.columns.what
        if not isinstance(document, list):
            raise self.error(number, f"found {json.dumps(document)[:40]}, {expected}")
        if len(document) != self.columns.count:
            found = counted(len(document), "value")
            raise self.error(number, f"found {found}, expected {self.columns.count}: {what}")
        row = []
        for value, angle in zip(document, self.columns.angles, strict=True):
            if isinstance(value, str):
                value = self.value(value, units, angle, number)
            if isinstance(value, bool) or not isinstance(value, (int, float)) or not _finite(value):
                raise self.error(number, f"found {json.dumps(value)[:40]}, expected a finite number")
            row.append(float(value))
        if units != self.units:
            angular, linear = units.radians / self.units.radians, units.metres / self.units.metres
            factors = [angular if angle else linear for angle in self.columns.angles]
            row = [value * factor for value, factor in zip(row, factors, strict=True)]
        return row

    def stated_units(self, stated: Any, number: int) -> Units:
        """The units that a document states, as those that `fk` writes do; the wanted ones for none."""
        if stated is None:
            return self.units
        if isinstance(stated, dict):
            length, angle = stated.get("length", self.units.length), stated.get("angle", self.units.angle)
            if length in [*METRES] and angle in [*RADIANS]:  # it may be anything, also what cannot be hashed
                return self.units.override(length, angle)
        expected = f"expected length {or_list(METRES)} and angle {or_list(RADIANS)}"
        raise self.error(number, f"found the units {json.dumps(stated)[:60]}, {expected}")


def _finite(value: float) -> bool:
    try:
        return math.isfinite(value)
    except OverflowError:
        return False
