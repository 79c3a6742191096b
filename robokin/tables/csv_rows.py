"""Rows of numbers from CSV, with a header or without.

Plain numbers take a fast way; everything else (expressions, quotes, comments, mistakes) takes a slow one
that knows the number of each line.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Iterator, Sequence
from typing import IO

import numpy as np

from robokin.arrays import Array
from robokin.errors import ExpressionError, InputError, counted
from robokin.formats.number_expressions import Scope, evaluate
from robokin.kernel.native_kernel import native
from robokin.tables.carried import Carried
from robokin.tables.csv_records import Record, RecordReader
from robokin.tables.fast_json import pydantic_function
from robokin.tables.headings import FoundColumns
from robokin.tables.number_cells import OneDecimalSign, number_in
from robokin.tables.text_source import Say
from robokin.tables.wanted_columns import Wanted, factors
from robokin.units import Units

NUMERALS = b"0123456789+-.eE, \t\r\n"
"""All that a block of plain numbers consists of."""

IGNORED, NUMBER, TEXT, SOLUTION = range(4)
"""What a column is to the native kernel: TEXT goes through, of a SOLUTION 0 is not plain."""

UNPLAIN = (b'"', b"#", b"\r", b"\0")
"""What a block may not hold that is split at its separators: quotes, comments, other ends of lines."""

IN_NUMBERS = NUMERALS.translate(None, b",\n")
"""What of it stands in a number or beside it."""

WHOLE_MINUS_ZERO = re.compile(rb"-0(?<![eE]-0)(?![.eE])")
"""It begins with what is looked for, which is found ten times as fast as behind a condition."""

HEADER_CELL = re.compile(r"\s*[A-Za-z_][\w .()\[\]/°-]*\s*")


class CsvReader(RecordReader):
    """A stream of CSV whose rows hold numbers."""

    def __init__(self, stream: IO[bytes], name: str, wanted: Wanted, carried: Carried, say: Say) -> None:
        """What is wanted is found when the first line is seen; cells that are not understood go to `carried`."""
        super().__init__(stream, name, say)
        self.wanted, self.carried = wanted, carried
        self.found: FoundColumns | None = None
        """Where in a line the wanted columns stand; None before the first line is seen."""
        self.picked: list[tuple[int, Units, bool]] = []
        """Their places, with the units of each and whether it is an angle."""
        self.factors: Array | None = None
        self.width = 0
        self.passed: list[int] = []
        """Where in a line the cells stand that go through."""
        self.solution: int | None = None
        """Where the number of a solution stands in a line that `ik` wrote: 0 tells that there is none."""
        self.unsolved = 0
        """How many lines said that inverse kinematics had no solution: they hold no configuration."""
        self.decimal = OneDecimalSign("")
        self.row_lines: Sequence[int] = ()
        """The line of each row of the last block."""

    def rows(self) -> Iterator[Array]:
        """Blocks (m, k) of the wanted columns."""
        for block in self.waiting:
            rows = self.fast_rows(block) if self.found is not None else None
            if rows is None:
                rows = self.slow_rows(block)
            if len(rows):
                yield rows

    def slow_rows(self, block: bytes) -> Array:
        """A block record by record; what follows a header is tried the fast way."""
        rows: list[list[float]] = []
        lines: list[int] = []
        records = self.records_of(block)
        for record in records:
            if record.fault:
                raise self.error(record.line, record.fault)
            if self.found is None:
                if not self.begin(record):
                    self.add(rows, lines, record)
                rest = b"".join(self.lines)
                fast = self.fast_rows(rest)
                if fast is not None:
                    self.row_lines = [*lines, *self.row_lines]
                    return np.vstack([self.array(rows), fast])
                self.lines = iter(rest.splitlines(keepends=True))
            else:
                self.add(rows, lines, record)
        self.row_lines = lines
        return self.array(rows)

    def array(self, rows: list[list[float]]) -> Array:
        """Rows (m, k) in the wanted units."""
        assert self.found is not None or not rows
        width = len(self.found.places) if self.found else 0
        values = np.array(rows, dtype=float).reshape(len(rows), width)
        return values if self.factors is None else values * self.factors

    def add(self, rows: list[list[float]], lines: list[int], record: Record) -> None:
        """Append the numbers of a record; what is not understood goes through."""
        cells, line, found = record.cells, record.line, self.found
        assert found is not None
        if len(cells) != self.width:
            raise self.error(line, f"found {counted(len(cells), 'value')}, expected {self.width}{self.meaning()}")
        if self.solution is not None and cells[self.solution] == "0":
            self.unsolved += 1
            return
        try:
            if self.decimal.commas or any("," in cells[i] for i in found.places):
                cells = [self.decimal.plain(cell) if i in found.places else cell for i, cell in enumerate(cells)]
            rows.append([number_in(cells[i], units, angle) for i, units, angle in self.picked])
        except ExpressionError as error:
            raise self.error(line, str(error)) from None
        lines.append(line)
        if self.passed:
            self.carried.put([[record.cells[i] for i in self.passed]])

    def meaning(self) -> str:
        """What the values of a line are, for a message that has said their number."""
        assert self.found is not None
        return f": {self.wanted.what}" if self.width == len(self.found.places) else ", as in the header"

    # The first line ---------------------------------------------------------------------------------------

    def begin(self, record: Record) -> bool:
        """Find the wanted columns by the first record; whether that is a header."""
        self.decimal = OneDecimalSign(self.separator)
        cells = record.cells
        try:
            header = self.is_header(cells)
            self.found = self.wanted.headed(cells) if header else self.wanted.plain(len(cells))
        except InputError as error:
            raise self.error(record.line, str(error)) from None
        self.picked = list(zip(self.found.places, self.found.units, self.found.way.angles, strict=True))
        self.factors = factors(self.found, self.wanted.units)
        self.width = len(cells) if header else len(self.found.places)
        if header:
            self.passed = self.carried.choose(cells, self.found.places)
            if "solution" in cells and "target" in cells:
                self.solution = cells.index("solution")
        elif self.separator == "\t":
            self.aligned = True
        return header

    def is_header(self, cells: Sequence[str]) -> bool:
        """Whether cells are headings: none of them is a number, or some are not and the wanted ones are among them."""
        numbers = [self.is_number(cell) for cell in cells]
        if all(numbers) or not any(numbers):
            return not any(numbers)
        try:
            self.wanted.headed(cells)
        except InputError:
            return False
        return True

    def is_number(self, cell: str) -> bool:
        """Whether a cell is a number, if perhaps not one that will do."""
        if not HEADER_CELL.fullmatch(cell) or cell.lower() in ("nan", "inf", "infinity"):
            return True
        try:
            evaluate(cell, Scope(degrees=self.wanted.units.degrees))
        except ExpressionError:
            return False
        return True

    # Plain numbers ----------------------------------------------------------------------------------------

    def fast_rows(self, block: bytes) -> Array | None:
        """A block of plain numbers, and of text without quotes in other columns; None when it holds anything else."""
        if not block:
            return None
        assert self.found is not None
        if native is not None and (rows := self.native_rows(block)) is not None:
            return rows
        block = (block.replace(b"\r\n", b"\n") if b"\r" in block else block).removesuffix(b"\n")
        places = list(self.found.places)
        passed: list[list[str]] = []
        if self.passed or self.separator not in ", " or not plain_lines(block, self.width):
            parts = self.split(block)
            if parts is None:
                return None
            block, passed = parts
            places, width = list(range(len(places))), len(places)
        else:
            width = self.width
        try:
            rows = numbers_of(block, width)
        except (ValueError, TypeError, OverflowError, struct.error):
            return None
        if not np.isfinite(rows).all():
            return None
        return self.taken(rows if places == list(range(width)) else rows[:, places], passed)

    def taken(self, rows: Array, passed: list[list[str]]) -> Array:
        """Rows (m, k) of a block that is read as a whole, in the wanted units; `passed` goes through."""
        self.carried.put(passed)
        self.row_lines = range(self.line + 1, self.line + 1 + len(rows))
        self.line += len(rows)
        return rows if self.factors is None else rows * self.factors

    def native_rows(self, block: bytes) -> Array | None:
        """The same by the native kernel, which knows plain rows alone."""
        assert native is not None and self.found is not None
        places = self.found.places
        kinds = bytearray(self.width)
        for i in self.passed:
            kinds[i] = TEXT
        if self.solution is not None:
            kinds[self.solution] = SOLUTION
        for i in places:
            kinds[i] = NUMBER
        if self.passed != sorted(self.passed) or kinds.count(TEXT) != len(self.passed):
            return None
        read = native.rows_in(block, b" " if self.aligned else self.separator.encode(), bytes(kinds))
        if read is None:
            return None
        rows, passed, points = read
        if self.decimal.commas and points:
            if self.decimal.seen == ",":
                return None
            self.decimal.seen = "."
        order = sorted(places)
        return self.taken(rows if list(places) == order else rows[:, [order.index(i) for i in places]], passed)

    def split(self, block: bytes) -> tuple[bytes, list[list[str]]] | None:
        """The wanted columns of a block as plain numbers with points and commas, and the cells that go through."""
        if self.separator == " " or any(sign in block for sign in UNPLAIN) or not self.found:
            return None
        separator, places = self.separator.encode(), self.found.places
        rows = [line.split(separator) for line in block.split(b"\n")]
        if {*map(len, rows)} != {self.width}:
            return None
        if self.solution is not None and any(cells[self.solution].strip() == b"0" for cells in rows):
            return None
        numbers = b"\n".join([b";".join([cells[i] for i in places]) for cells in rows])
        if numbers.translate(None, NUMERALS + b";"):
            return None
        sign = "," if b"," in numbers else "." if b"." in numbers else self.decimal.seen
        if (sign == "," and b"." in numbers) or sign != (self.decimal.seen or sign):
            return None
        try:
            passed = [[cells[i].decode().strip() for i in self.passed] for cells in rows] if self.passed else []
        except UnicodeDecodeError:
            return None
        self.decimal.seen = sign
        return numbers.replace(b",", b".").replace(b";", b","), passed


def plain_lines(block: bytes, width: int) -> bool:
    """Whether a block is plain numbers, so many a line with commas, as far as its signs and commas tell."""
    line = b"," * (width - 1) + b"\n"
    return block.translate(None, IN_NUMBERS) == (line * (block.count(b"\n") + 1))[:-1]


def numbers_of(block: bytes, width: int) -> Array:
    """Lines of so many numbers each, with commas, as an array (m, width). Raises ValueError.

    pydantic's core, which Typer brings, reads JSON ten times faster than float() reads numbers, and one list in two
    thirds of the time of a list for each line.
    """
    block = block.replace(b"\n", b",")
    from_json = pydantic_function("from_json")
    numbers = from_json(b"[" + block + b"]", allow_inf_nan=False) if from_json else [*map(float, block.split(b","))]
    if not numbers:
        raise ValueError("nothing but white space")
    rows = np.empty((len(numbers) // width, width))
    struct.pack_into(f"{rows.size}d", rows.data, 0, *numbers)
    if from_json and not rows.all() and WHOLE_MINUS_ZERO.search(block):
        raise ValueError("JSON has no sign for a whole number that is 0")
    return rows
