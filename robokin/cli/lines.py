"""Lines of text from files and pipes, in blocks, and the numbers in their cells."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import IO, Any

from robokin.description.expressions import Scope, evaluate
from robokin.errors import ExpressionError, InputError
from robokin.units import Units

CHUNK = 1 << 18
"""Bytes read at once: about 2,000 lines of six numbers."""

MAX_LINE = 1 << 20
"""A line longer than this is no row of numbers."""

PLAIN = re.compile(r"\s*[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?\s*", re.ASCII)
"""A number that is no expression."""

BYTE_ORDER_MARK = b"\xef\xbb\xbf"
"""What some editors put before UTF-8."""


@dataclass(frozen=True)
class Columns:
    """The columns that are wanted of each row.

    `names` and `aliases` are their headings in a CSV; `angles` tells which are angles; `key` is what a
    JSON object calls the row.
    """

    names: tuple[str, ...]
    aliases: tuple[str, ...]
    angles: tuple[bool, ...]
    key: str
    what: str

    @property
    def count(self) -> int:
        """How many there are."""
        return len(self.names)


class LineReader:
    """A stream of text, and how far it is read."""

    def __init__(self, stream: IO[bytes], name: str, columns: Columns, units: Units) -> None:
        """`name` is what messages call the stream; the numbers of its lines are in `units`."""
        self.stream: Any = stream
        self.name = name
        self.columns = columns
        self.units = units
        self.line = 0
        """Number of the last line that was handed on."""
        self.unsolved = 0
        """How many lines said that inverse kinematics had no solution: they hold no configuration."""

    def error(self, line: int, message: str) -> InputError:
        """An error that names the stream and the line."""
        return InputError(f"{self.name}, line {line}: {message}")

    def text_blocks(self) -> Iterator[bytes]:
        """The stream's text in blocks of whole lines, without the last newline of each."""
        kept = b""
        first = True
        while chunk := self.stream.read1(CHUNK):
            if first:
                chunk, first = chunk.removeprefix(BYTE_ORDER_MARK), False
            cut = chunk.rfind(b"\n")
            if cut < 0:
                kept += chunk
                if len(kept) > MAX_LINE:
                    raise self.error(self.line + 1, f"longer than {MAX_LINE} bytes, expected {self.columns.what}")
                continue
            yield kept + chunk[:cut]
            kept = chunk[cut + 1 :]
        if kept:
            yield kept

    def decode(self, block: bytes, line: int) -> str:
        """A block as text; its first line has the number `line`."""
        try:
            return block.decode()
        except UnicodeDecodeError as error:
            line += block.count(b"\n", 0, error.start)
            raise self.error(line, "found bytes that are no text, expected UTF-8") from None

    def value(self, cell: str, units: Units, angle: bool, line: int) -> float:
        """The number in a cell, in the given units."""
        # A plain number is most of what there is, and needs no parser.
        if PLAIN.fullmatch(cell) and math.isfinite(number := float(cell)):
            return number
        try:
            return evaluate(cell, Scope(degrees=units.degrees), angle=angle).number
        except ExpressionError as error:
            raise self.error(line, str(error)) from None
