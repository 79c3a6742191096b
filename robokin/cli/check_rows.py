"""Files of answers: every line is marked, whatever stands on it; only a file that is none is refused."""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robokin.cli.lines import BYTE_ORDER_MARK, MAX_LINE, PLAIN
from robokin.cli.output.numbers import counted
from robokin.cli.rows import open_input
from robokin.description.expressions import Scope, evaluate
from robokin.errors import ExpressionError, InputError, did_you_mean
from robokin.units import Units

Array = NDArray[np.float64]

IDS = ("id", "question", "target")
"""Columns that name a question; the first of them that is there does."""

STUDENTS = ("student", "name")
"""Columns that name who answered."""

BLANK, NOT_A_NUMBER, BAD_LINE = "blank", "not a number", "bad line"

LARGEST = 64 << 20
"""Bytes of a file of answers; it is held as a whole, since answers to one question may stand anywhere in it."""


GREATEST = 1e12
"""Numbers beyond this, in any unit, are no lengths and no joint values; their squares would not be finite."""


class NoAnswerError(Exception):
    """An answer that cannot be compared: the status word that it gets, and why."""

    def __init__(self, status: str, detail: str = "") -> None:
        super().__init__(status)
        self.status, self.detail = status, detail


@dataclass(frozen=True)
class Row:
    """A line of a file: its cells by their columns, its number, and what is wrong with the line as such, or ""."""

    cells: dict[str, str]
    line: int
    fault: str = ""

    def numbers(self, names: Sequence[str], angles: Sequence[bool], units: Units) -> Array:
        """The numbers in some columns, in the units. Raises NoAnswerError for cells that hold none."""
        if self.fault:
            raise NoAnswerError(BAD_LINE, f"line {self.line}: {self.fault}")
        if not any(self.cells[name] for name in names):
            raise NoAnswerError(BLANK, f"line {self.line}: no answer")
        try:
            return np.array([number(self.cells[n], a, units) for n, a in zip(names, angles, strict=True)])
        except NoAnswerError as wrong:
            raise NoAnswerError(wrong.status, f"line {self.line}: {wrong.detail}") from None


def number(cell: str, angle: bool, units: Units) -> float:
    """The number in a cell, in the units. Raises NoAnswerError."""
    if not cell.strip():
        raise NoAnswerError(BLANK, "found a blank, expected a number")
    if PLAIN.fullmatch(cell) and math.isfinite(value := float(cell)):
        return sized(value)
    try:
        return sized(evaluate(cell, Scope(degrees=units.degrees), angle=angle).number)
    except ExpressionError as error:
        raise NoAnswerError(NOT_A_NUMBER, str(error)) from None


def sized(value: float) -> float:
    """The value. Raises NoAnswerError for one that is too great for anything."""
    if abs(value) > GREATEST:
        raise NoAnswerError(NOT_A_NUMBER, f"found {value:g}, expected a number below {GREATEST:g}")
    return value


@dataclass(frozen=True)
class Sheet:
    """A file of rows below a header."""

    name: str
    columns: tuple[str, ...]
    rows: tuple[Row, ...]

    def column(self, names: Sequence[str]) -> str | None:
        """The first of some columns that is there."""
        return next((name for name in names if name in self.columns), None)

    def require(self, names: Sequence[str], what: str) -> None:
        """Raise InputError where a column is not there."""
        for name in names:
            if name not in self.columns:
                found, hint = ", ".join(self.columns)[:200], did_you_mean(name, self.columns)
                raise InputError(f"{self.name}: found the columns {found}, expected {name} as well: {what}{hint}")


def read_sheet(source: str) -> Sheet:
    """A CSV with a header. A line with another number of cells is kept with its fault.

    Raises InputError for what is no text, has no header, or names a column twice.
    """
    with open_input(source) as (stream, name):
        try:
            data = stream.read(LARGEST + 1)
        except OSError as error:
            raise InputError(f"{name}: {error.strerror}, expected rows that can be read") from None
    if len(data) > LARGEST:
        raise InputError(f"{name}: found more than {LARGEST} bytes, expected the answers of a class")
    try:
        text = data.removeprefix(BYTE_ORDER_MARK).decode()
    except UnicodeDecodeError as error:
        place = data.count(b"\n", 0, error.start) + 1
        raise InputError(f"{name}, line {place}: found bytes that are no text, expected UTF-8") from None
    columns: tuple[str, ...] | None = None
    rows = []
    for place, line in enumerate(text.splitlines(), start=1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        fault, cells = "", []
        try:
            if len(line) > MAX_LINE:
                raise csv.Error("a line that is too long")
            cells = [cell.strip() for cell in next(csv.reader([line], strict=True, skipinitialspace=True))]
        except csv.Error as error:
            fault = f"{error}, expected cells with commas between them"
        if columns is None:
            columns = _header(cells, fault, f"{name}, line {place}")
            continue
        if not fault and len(cells) != len(columns):
            fault = f"found {counted(len(cells), 'cell')}, expected {len(columns)} as in the header"
        rows.append(Row(dict(zip(columns, cells + [""] * len(columns), strict=False)), place, fault))
    if columns is None:
        raise InputError(f"{name}: found nothing, expected a header and answers")
    if not rows:
        raise InputError(f"{name}: found a header alone, expected answers below it")
    return Sheet(name, columns, tuple(rows))


def _header(cells: list[str], fault: str, place: str) -> tuple[str, ...]:
    if fault:
        raise InputError(f"{place}: {fault}")
    if len(cells) == 1 and (";" in cells[0] or "\t" in cells[0]):
        raise InputError(f"{place}: found no commas, expected a CSV with commas between the columns")
    if any(PLAIN.fullmatch(cell) for cell in cells):
        raise InputError(f"{place}: found numbers, expected a header that names the columns")
    for cell in cells:
        if cells.count(cell) > 1:
            raise InputError(f"{place}: found the column '{cell}' twice, expected it once")
    return tuple(cells)
