"""Files of answers: every line is marked, whatever stands on it; only a file that is none is refused."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from robokin.arrays import Array
from robokin.cli.sheet_records import SheetReader
from robokin.cli.statuses import say
from robokin.cli.submissions import OPEN_PLACES, open_plain_file
from robokin.errors import ExpressionError, InputError, did_you_mean, shown
from robokin.files import open_input
from robokin.tables.number_cells import PLAIN, Decimals, decimals_of, number_in
from robokin.units import Units

IDS = ("id", "question", "target")
"""Columns that name a question; the first of them that is there does."""

STUDENTS = ("student", "name")
"""Columns that name who answered."""

BLANK, NOT_A_NUMBER, BAD_LINE = "blank", "not a number", "bad line"

GREATEST = 1e12
"""Numbers beyond this, in any unit, are no lengths and no joint values; their squares would not be finite."""


class NoAnswerError(Exception):
    """An answer that cannot be compared: the status word that it gets, and why."""

    def __init__(self, status: str, detail: str = "") -> None:
        super().__init__(status)
        self.status, self.detail = status, detail


@dataclass(frozen=True)
class Row:
    """A line of a file: its cells by their columns, its number, and what is wrong with the line as such, or "".

    `decimals` tells how numbers are written in a file whose cells are not separated by commas; `doubtful` is a line
    that may be part of another one's cell.
    """

    cells: dict[str, str]
    line: int
    fault: str = ""
    decimals: Decimals = Decimals.POINT
    doubtful: bool = False

    def numbers(self, names: Sequence[str], angles: Sequence[bool], units: Units) -> Array:
        """The numbers in some columns, in the units. Raises NoAnswerError for cells that hold none."""
        if self.fault:
            raise NoAnswerError(BAD_LINE, f"line {self.line}: {self.fault}")
        if not any(self.cells[name] for name in names):
            raise NoAnswerError(BLANK, f"line {self.line}: no answer")
        try:
            return np.array(
                [number(self.decimals.plain(self.cells[n]), a, units) for n, a in zip(names, angles, strict=True)]
            )
        except NoAnswerError as wrong:
            raise NoAnswerError(wrong.status, f"line {self.line}: {wrong.detail}") from None


def number(cell: str, angle: bool, units: Units) -> float:
    """The number in a cell, in the units. Raises NoAnswerError."""
    if not cell.strip():
        raise NoAnswerError(BLANK, "found a blank, expected a number")
    try:
        return sized(number_in(cell, units, angle))
    except ExpressionError as error:
        raise NoAnswerError(NOT_A_NUMBER, str(error)) from None


def sized(value: float) -> float:
    """The value. Raises NoAnswerError for one that is too great for anything."""
    if abs(value) > GREATEST:
        raise NoAnswerError(NOT_A_NUMBER, f"found {value:g}, expected a number below {GREATEST:g}")
    return value


@dataclass(frozen=True)
class AnswerFile:
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
                found, hint = shown(", ".join(self.columns), 200), did_you_mean(name, self.columns)
                raise InputError(f"{self.name}: found the columns {found}, expected {name} as well: {what}{hint}")


def read_key(source: str) -> AnswerFile:
    """The questions: the teacher's own file, whatever kind of file it is. Raises InputError."""
    with open_input(source, "a CSV of questions") as (stream, name):
        return _sheet(SheetReader(stream, name, say))


def read_sheet(source: str, *, follow: bool) -> AnswerFile:
    """A CSV with a header, as RFC 4180 says. A line that is no row of it is kept with its fault.

    follow: whether a symbolic link is. Raises InputError for what is no plain file and no text, has no header, or names
    a column twice.
    """
    if source == "-" or source.startswith(OPEN_PLACES):
        with open_input(source, "a CSV of answers") as (stream, name):
            return _sheet(SheetReader(stream, name, say))
    with open_plain_file(source, follow) as stream:
        return _sheet(SheetReader(stream, source, say))


def _sheet(reader: SheetReader) -> AnswerFile:
    name = reader.name
    columns: tuple[str, ...] | None = None
    rows = []
    try:
        for cells, line, fault, doubtful in reader.rows():
            if columns is None:
                columns = _header(cells, f"{name}, line {line}")
                continue
            rows.append(
                Row(dict(zip(columns, cells + [""] * len(columns), strict=False)), line, fault, doubtful=doubtful)
            )
    except OSError as error:
        raise InputError(f"{name}: {error.strerror}, expected rows that can be read") from None
    if columns is None:
        raise InputError(f"{name}: found nothing, expected a header and answers")
    if not rows:
        raise InputError(f"{name}: found a header alone, expected answers below it")
    decimals = decimals_of(reader.separator, (cell for row in rows for cell in row.cells.values()))
    rows = [replace(row, decimals=decimals) for row in rows]
    return AnswerFile(name, columns, tuple(rows))


def _header(cells: list[str], place: str) -> tuple[str, ...]:
    if any(PLAIN.fullmatch(cell) for cell in cells):
        raise InputError(f"{place}: found numbers, expected a header that names the columns")
    for cell in cells:
        if cells.count(cell) > 1:
            raise InputError(f"{place}: found the column '{shown(cell)}' twice, expected it once")
    return tuple(cells)
