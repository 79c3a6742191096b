"""Rows of numbers from CSV, with a header or without.

Plain numbers take a fast way; everything else (expressions, quotes, comments, mistakes) takes a slow one
that knows the number of each line.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator, Sequence
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from robokin.cli.lines import Columns, LineReader
from robokin.cli.output.numbers import counted
from robokin.cli.output.text import pydantic_function
from robokin.description.expressions import Scope, evaluate
from robokin.errors import ExpressionError
from robokin.units import Units

Array = NDArray[np.float64]

NUMERALS = b"0123456789+-.eE, \t\r\n"
"""All that a block of plain numbers consists of."""

HEADER_CELL = re.compile(r"\s*[A-Za-z_][\w .()\[\]/°-]*\s*")


class CsvReader(LineReader):
    """A stream of CSV."""

    def __init__(self, stream: IO[bytes], name: str, columns: Columns, units: Units) -> None:
        """As a LineReader; the columns are found when the first line is seen."""
        super().__init__(stream, name, columns, units)
        self.picked: list[int] | None = None
        """Where in a line the wanted columns stand; None before the first line is seen."""
        self.width = columns.count
        self.solution: int | None = None
        """Where the number of a solution stands in a line that `ik` wrote: 0 tells that there is none."""

    def blocks(self) -> Iterator[Array]:
        """Blocks (m, k) of the wanted columns."""
        for block in self.text_blocks():
            if self.picked is None:
                rest = self.header(block)
                if rest is None:
                    continue
                block = rest
            rows = self.fast_csv(block)
            if rows is None:
                rows = self.slow_csv(block)
            self.line += block.count(b"\n") + 1
            if len(rows):
                yield rows

    def header(self, block: bytes) -> bytes | None:
        """What follows the first line with something on it, if that is a header; picks the columns.

        None when the block has no such line, or nothing after the header.
        """
        lines = block.split(b"\n")
        for i, raw in enumerate(lines):
            number = self.line + i + 1
            cells = self.cells(self.decode(raw, number), number)
            if cells is None:
                continue
            if not self.is_header(cells):
                self.picked = list(range(self.columns.count))
                self.line += i
                return b"\n".join(lines[i:])
            self.pick(cells, number)
            self.line += i + 1
            return b"\n".join(lines[i + 1 :]) if i + 1 < len(lines) else None
        self.line += len(lines)
        return None

    def is_header(self, cells: Sequence[str]) -> bool:
        """Whether cells are headings: the wanted ones are among them, or none of them is a number."""
        numbers = [self.is_number(cell) for cell in cells]
        return (self.wanted(cells) is not None and not all(numbers)) or not any(numbers)

    def is_number(self, cell: str) -> bool:
        """Whether a cell is a number, if perhaps not one that will do."""
        if not HEADER_CELL.fullmatch(cell) or cell.strip().lower() in ("nan", "inf", "infinity"):
            return True
        try:
            evaluate(cell, Scope(degrees=self.units.degrees))
        except ExpressionError:
            return False
        return True

    def wanted(self, cells: Sequence[str]) -> tuple[str, ...] | None:
        """The names of the wanted columns, as these headings call them."""
        headings = {cell.strip() for cell in cells}
        return next((names for names in (self.columns.names, self.columns.aliases) if headings >= {*names}), None)

    def pick(self, cells: Sequence[str], line: int) -> None:
        """Find the wanted columns among a header's."""
        headings = [cell.strip() for cell in cells]
        names = self.wanted(cells)
        if names is None:
            found, expected = ", ".join(headings)[:200], ", ".join(self.columns.names)
            raise self.error(line, f"found the columns {found}, expected {expected}")
        for name in names:
            if headings.count(name) > 1:
                raise self.error(line, f"found the column '{name}' twice, expected it once")
        self.picked = [headings.index(name) for name in names]
        self.width = len(headings)
        if "solution" in headings and "target" in headings:
            self.solution = headings.index("solution")

    def fast_csv(self, block: bytes) -> Array | None:
        """A block of nothing but numbers and commas; None when it holds anything else."""
        if not block or block.translate(None, NUMERALS):
            return None
        try:
            rows = np.array(numbers_of(block), dtype=float)
        except (ValueError, TypeError, OverflowError):
            return None
        if rows.ndim != 2 or rows.shape[1] != self.width or not np.isfinite(rows).all():
            return None
        picked = self.picked or []
        return rows if picked == list(range(self.width)) else rows[:, picked]

    def slow_csv(self, block: bytes) -> Array:
        """A block line by line: expressions, quotes, blank lines and comments, and the mistakes."""
        rows: list[list[float]] = []
        for number, line in enumerate(self.decode(block, self.line + 1).split("\n"), start=self.line + 1):
            cells = self.cells(line, number)
            if cells is None:
                continue
            if len(cells) != self.width:
                found = counted(len(cells), "value")
                raise self.error(number, f"found {found}, expected {self.width}{self.meaning()}")
            if self.solution is not None and cells[self.solution].strip() == "0":
                self.unsolved += 1
                continue
            picked = zip([cells[k] for k in self.picked or []], self.columns.angles, strict=True)
            rows.append([self.value(cell, self.units, angle, number) for cell, angle in picked])
        return np.array(rows, dtype=float).reshape(len(rows), self.columns.count)

    def meaning(self) -> str:
        """What the values of a line are, for a message that has said their number."""
        return f": {self.columns.what}" if self.width == self.columns.count else ", as in the header"

    def cells(self, line: str, number: int) -> list[str] | None:
        """The cells of a line; None for a blank line and a comment."""
        line = line.strip()
        if not line or line.startswith("#"):
            return None
        if "," not in line:
            return line.split()
        try:
            return next(csv.reader([line], strict=True))
        except csv.Error as error:
            raise self.error(number, f"{error}, expected {self.columns.what}") from None


def numbers_of(block: bytes) -> Any:
    """Lines of numbers and commas as a list of lists. Raises ValueError.

    pydantic's core, which Typer brings, reads JSON ten times faster than float() reads numbers.
    """
    from_json = pydantic_function("from_json")
    if from_json is not None:
        return from_json(b"[[" + block.replace(b"\n", b"],[") + b"]]", allow_inf_nan=False)
    return [[float(cell) for cell in line.split(b",")] for line in block.split(b"\n")]
