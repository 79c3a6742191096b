"""Files of answers: every line is marked, whatever stands on it; only a file that is none is refused."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from robokin.arrays import Array
from robokin.errors import ExpressionError, InputError, did_you_mean, shown
from robokin.files import open_input
from robokin.grading.answers.answer_records import LARGEST, SheetReader
from robokin.grading.answers.submissions import OPEN_PLACES, open_plain_file
from robokin.grading.mark_items import BAD_LINE, BLANK, NOT_A_NUMBER
from robokin.grading.marking import NoAnswerError
from robokin.tables.arrow_text import as_csv
from robokin.tables.number_cells import PLAIN, Decimals, decimals_of, number_in
from robokin.tables.text_source import Say
from robokin.units import Units

Value = TypeVar("Value")

IDS = ("id", "question", "target")
"""Columns that name a question; the first of them that is there does."""

STUDENTS = ("student", "name")
"""Columns that name who answered."""

GREATEST = 1e12
"""Numbers beyond this, in any unit, are no lengths and no joint values; their squares would not be finite."""

COMMA = re.compile(r"\s*[-+]?\d+,\d+\s*")
"""A number with a decimal comma; in a file whose cells are separated by commas it may as well group thousands."""

NOTES = 20
"""Lines that are not marked that are named one by one."""

DOUBTFUL = "it may be part of the cell of another row, whose quotes do not end"


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

    @property
    def doubt(self) -> int:
        """How little it is to be trusted to be what it says: 0 for a row, more for what may be another one's cell."""
        return 2 if self.fault else int(self.doubtful)

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
        said = f"found a decimal comma, expected a point (in '{cell}')" if COMMA.fullmatch(cell) else str(error)
        raise NoAnswerError(NOT_A_NUMBER, said) from None


def sized(value: float) -> float:
    """The value. Raises NoAnswerError for one that is too great for anything."""
    if abs(value) > GREATEST:
        raise NoAnswerError(NOT_A_NUMBER, f"found {value:g}, expected a number below {GREATEST:g}")
    return value


@dataclass(frozen=True)
class AnswerFile:
    """A file of rows below a header. `say` takes notes about it."""

    name: str
    columns: tuple[str, ...]
    rows: tuple[Row, ...]
    say: Say

    def column(self, names: Sequence[str]) -> str:
        """The first of some columns that is there, or ""."""
        return next((name for name in names if name in self.columns), "")

    def require(self, names: Sequence[str], what: str) -> None:
        """Raise InputError where a column is not there."""
        for name in names:
            if name not in self.columns:
                found, hint = shown(", ".join(self.columns), 200), did_you_mean(name, self.columns)
                raise InputError(f"{self.name}: found the columns {found}, expected {name} as well: {what}{hint}")

    def lines(self) -> Iterator[tuple[str | None, str, Row]]:
        """Who answered which question, for each row: None where no column says who, "" where none says which."""
        id, student = self.column(IDS), self.column(STUDENTS)
        for row in self.rows:
            yield row.cells[student] if student else None, row.cells[id] if id else "", row

    def named_lines(self, what: str) -> Iterator[tuple[str | None, str, Row]]:
        """The same of a file in which ids are needed. Raises InputError where no column has them."""
        if not self.column(IDS):
            raise InputError(f"{self.name}: found no column 'id', expected one that names the questions{what}")
        return self.lines()

    def keyed(self, read: Callable[[Row], Value]) -> dict[str, Value]:
        """What a key says of each question. Raises InputError for a line that is wrong: a key is no answer."""
        found: dict[str, Value] = {}
        for _, id, row in self.named_lines(""):
            if not id or id in found:
                said = f"the id '{id}' twice" if id else "no id"
                raise InputError(f"{self.name}, line {row.line}: found {said}, expected one for each question")
            try:
                found[id] = read(row)
            except NoAnswerError as wrong:
                raise InputError(f"{self.name}, {wrong.detail}") from None
        return found

    def by_question(self, ids: Sequence[str]) -> list[tuple[str | None, str, list[Row]]]:
        """Each student with each question and the lines that answer it; notes name the lines that answer none.

        A line with a fault, or in another one's quotes, may name a student whose it is not: it stands for an answer
        only where there is no other.
        """
        answers: dict[tuple[str | None, str], list[Row]] = {}
        students: dict[str | None, None] = {}
        unmarked, known = [], set(ids)
        for who, id, row in self.named_lines(" of --key"):
            students[who] = None
            if id not in known:
                unmarked.append(f"line {row.line}: there is no question '{shown(id)}' in the key; not marked")
            answers.setdefault((who, id), []).append(row)
        for place, rows in answers.items():
            best = min(row.doubt for row in rows)
            unmarked += [f"line {row.line}: {row.fault or DOUBTFUL}; not marked" for row in rows if row.doubt > best]
            answers[place] = [row for row in rows if row.doubt == best]
        for note in unmarked[:NOTES]:
            self.say(f"{self.name}, {note}")
        if len(unmarked) > NOTES:
            self.say(f"{self.name}: and {len(unmarked) - NOTES} more lines that are not marked")
        return [(who, id, answers.get((who, id), [])) for who in students for id in ids]


def read_key(source: str, say: Say) -> AnswerFile:
    """The questions: the teacher's own file, whatever kind of file it is. Raises InputError."""
    with open_input(source, "a CSV of questions") as (stream, name):
        return _sheet(SheetReader(as_csv(stream, name, LARGEST), name, say))


def read_answers(source: str, say: Say, *, follow: bool) -> AnswerFile:
    """A CSV with a header, as RFC 4180 says. A line that is no row of it is kept with its fault.

    follow: whether a symbolic link is. Raises InputError for what is no plain file and no text, has no header, or names
    a column twice.
    """
    if source == "-" or source.startswith(OPEN_PLACES):
        with open_input(source, "a CSV of answers") as (stream, name):
            return _sheet(SheetReader(stream, name, say))
    with open_plain_file(source, follow) as stream:
        return _sheet(SheetReader(as_csv(stream, source, LARGEST), source, say))


def _sheet(reader: SheetReader) -> AnswerFile:
    name = reader.name
    columns: tuple[str, ...] = ()
    rows: list[Row] = []
    try:
        for cells, line, fault, doubtful in reader.rows():
            if columns:
                cells += [""] * (len(columns) - len(cells))
                rows.append(Row(dict(zip(columns, cells, strict=False)), line, fault, doubtful=doubtful))
            else:
                columns = _header(cells, f"{name}, line {line}")
    except OSError as error:
        raise InputError(f"{name}: {error.strerror}, expected rows that can be read") from None
    if not rows:
        expected = "a header alone, expected answers below it" if columns else "nothing, expected a header and answers"
        raise InputError(f"{name}: found {expected}")
    decimals = decimals_of(reader.separator, (cell for row in rows for cell in row.cells.values()))
    return AnswerFile(name, columns, tuple(replace(row, decimals=decimals) for row in rows), reader.say)


def _header(cells: list[str], place: str) -> tuple[str, ...]:
    if any(PLAIN.fullmatch(cell) for cell in cells):
        raise InputError(f"{place}: found numbers, expected a header that names the columns")
    for cell in cells:
        if cells.count(cell) > 1:
            raise InputError(f"{place}: found the column '{shown(cell)}' twice, expected it once")
    return tuple(cells)
