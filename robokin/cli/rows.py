"""Rows of numbers from files and pipes, in blocks: CSV, JSON lines and `.npy`.

A stream is read as it comes, and a block of some thousand rows is all that is held of it. Plain numbers
take a fast way; everything else (expressions, quotes, comments, mistakes) takes a slow one that knows
the number of each line.
"""

from __future__ import annotations

import contextlib
import csv
import io
import json
import math
import re
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from robokin.description.expressions import Scope, evaluate
from robokin.errors import ExpressionError, InputError
from robokin.units import Units

Array = NDArray[np.float64]

CHUNK = 1 << 18
"""Bytes read at once: about 2,000 lines of six numbers."""

NPY_ROWS = 8192
"""Rows of an array read at once."""

MAX_LINE = 1 << 20
"""A line longer than this is no row of numbers."""

NUMERALS = b"0123456789+-.eE, \t\r\n"
"""All that a block of plain numbers consists of."""

HEADER_CELL = re.compile(r"\s*[A-Za-z_][\w .()\[\]/°-]*\s*")

try:
    from pydantic_core import from_json
except ImportError:  # an older Typer brings no pydantic
    from_json = None  # type: ignore[assignment]


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


@contextlib.contextmanager
def open_input(source: str) -> Iterator[tuple[IO[bytes], str]]:
    """The stream that `-` or a path means, and the name to give it in messages."""
    if source == "-":
        yield sys.stdin.buffer, "standard input"
        return
    try:
        stream = open(source, "rb")  # noqa: SIM115, PTH123 - only opening may fail with this sentence
    except OSError as error:
        raise InputError(f"{source}: {error.strerror}, expected a file of rows (.csv, .jsonl or .npy)") from None
    with stream:
        yield stream, source


def read_rows(stream: IO[bytes], name: str, columns: Columns, units: Units) -> Iterator[Array]:
    """Blocks (m, k) of the wanted columns, in the order of `columns`, in the given units.

    What the stream holds is told by its name's ending, or else by its first byte. Raises InputError
    with the number of the line that is wrong.
    """
    ending = Path(name).suffix.lower()
    buffered: Any = stream if hasattr(stream, "peek") else io.BufferedReader(stream)
    head = bytes(buffered.peek(8)[:8])
    reader = _Reader(buffered, name, columns, units)
    if ending == ".npy" or head.startswith(b"\x93NUMPY"):
        return reader.arrays()
    if ending == ".jsonl" or (ending != ".csv" and head.lstrip()[:1] in (b"{", b"[")):
        return reader.json_lines()
    return reader.csv()


class _Reader:
    """A stream, and how far it is read."""

    def __init__(self, stream: Any, name: str, columns: Columns, units: Units) -> None:
        self.stream = stream
        self.name = name
        self.columns = columns
        self.scope = Scope(degrees=units.degrees)
        self.line = 0
        """Number of the last line that was handed on."""
        self.picked: list[int] | None = None
        """Where in a line the wanted columns stand; None before the first line is seen."""
        self.width = columns.count

    def error(self, line: int, message: str) -> InputError:
        return InputError(f"{self.name}, line {line}: {message}")

    # Text ------------------------------------------------------------------------------------------

    def text_blocks(self) -> Iterator[bytes]:
        """The stream's text in blocks of whole lines, without the last newline of each."""
        kept = b""
        first = True
        while chunk := self.stream.read1(CHUNK):
            if first:
                chunk, first = chunk.removeprefix(b"\xef\xbb\xbf"), False
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

    def csv(self) -> Iterator[Array]:
        for block in self.text_blocks():
            if self.picked is None:
                rest = self.header(block)
                if rest is None:
                    continue
                block = rest
            rows = self.fast_csv(block)
            if rows is None:
                rows = self.slow_csv(self.decode(block))
            self.line += block.count(b"\n") + 1
            if len(rows):
                yield rows

    def header(self, block: bytes) -> bytes | None:
        """What follows the first line with something on it, if that is a header; picks the columns.

        None when the block has no such line, or nothing after the header.
        """
        lines = block.split(b"\n")
        for i, raw in enumerate(lines):
            cells = self.cells(self.decode(raw), i)
            if cells is None:
                continue
            if not any(HEADER_CELL.fullmatch(cell) and not self.is_number(cell) for cell in cells):
                self.picked = list(range(self.columns.count))
                self.line += i
                return b"\n".join(lines[i:])
            self.pick(cells, self.line + i + 1)
            self.line += i + 1
            return b"\n".join(lines[i + 1 :]) if i + 1 < len(lines) else None
        self.line += len(lines)
        return None

    def is_number(self, cell: str) -> bool:
        try:
            evaluate(cell, self.scope)
        except ExpressionError as error:
            return "pi in an angle" in str(error)
        return True

    def pick(self, cells: Sequence[str], line: int) -> None:
        """Find the wanted columns among a header's."""
        headings = [cell.strip() for cell in cells]
        for names in (self.columns.names, self.columns.aliases):
            if names and all(name in headings for name in names):
                self.picked = [headings.index(name) for name in names]
                self.width = len(headings)
                return
        raise self.error(
            line, f"found the columns {', '.join(headings)[:200]}, expected {', '.join(self.columns.names)}"
        )

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

    def slow_csv(self, text: str) -> Array:
        """A block line by line: expressions, quotes, blank lines and comments, and the mistakes."""
        rows: list[list[float]] = []
        for i, line in enumerate(text.split("\n")):
            cells = self.cells(line, i)
            if cells is None:
                continue
            number = self.line + i + 1
            if len(cells) != self.width:
                raise self.error(number, f"found {len(cells)} values, expected {self.width}: {self.columns.what}")
            picked = [cells[k] for k in self.picked or []]
            rows.append(
                [self.value(cell, angle, number) for cell, angle in zip(picked, self.columns.angles, strict=True)]
            )
        return np.array(rows, dtype=float).reshape(len(rows), self.columns.count)

    def cells(self, line: str, offset: int) -> list[str] | None:
        """The cells of a line; None for a blank line and a comment."""
        line = line.strip()
        if not line or line.startswith("#"):
            return None
        if "," not in line:
            return line.split()
        try:
            return next(csv.reader([line], strict=True))
        except csv.Error as error:
            raise self.error(self.line + offset + 1, f"{error}, expected {self.columns.what}") from None

    def value(self, cell: str, angle: bool, line: int) -> float:
        try:
            return evaluate(cell, self.scope, angle=angle).number
        except ExpressionError as error:
            raise self.error(line, str(error)) from None

    def decode(self, block: bytes) -> str:
        try:
            return block.decode()
        except UnicodeDecodeError as error:
            line = self.line + 1 + block.count(b"\n", 0, error.start)
            raise self.error(line, "found bytes that are no text, expected UTF-8") from None

    # JSON lines -------------------------------------------------------------------------------------

    def json_lines(self) -> Iterator[Array]:
        for block in self.text_blocks():
            rows = []
            for i, line in enumerate(self.decode(block).split("\n")):
                if line.strip():
                    rows.append(self.json_row(line, self.line + i + 1))
            self.line += block.count(b"\n") + 1
            if rows:
                yield np.array(rows, dtype=float).reshape(len(rows), self.columns.count)

    def json_row(self, line: str, number: int) -> list[float]:
        try:
            document = json.loads(line)
        except (ValueError, RecursionError) as error:
            raise self.error(number, f"this is not JSON ({error}), expected {self.columns.what}") from None
        key = self.columns.key
        if isinstance(document, dict):
            if key not in document:
                raise self.error(number, f"the key '{key}' is missing, expected {self.columns.what}")
            document = document[key]
        if not isinstance(document, list):
            raise self.error(number, f"found no list, expected {self.columns.what}")
        if len(document) != self.columns.count:
            raise self.error(
                number, f"found {len(document)} values, expected {self.columns.count}: {self.columns.what}"
            )
        row = []
        for value, angle in zip(document, self.columns.angles, strict=True):
            if isinstance(value, str):
                value = self.value(value, angle, number)
            if isinstance(value, bool) or not isinstance(value, (int, float)) or not _finite(value):
                raise self.error(number, f"found {json.dumps(value)[:40]}, expected a finite number")
            row.append(float(value))
        return row

    # Arrays -----------------------------------------------------------------------------------------

    def arrays(self) -> Iterator[Array]:
        expected = f"expected an array of floats (rows, {self.columns.count}): {self.columns.what}"
        try:
            version = np.lib.format.read_magic(self.stream)
            read = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
            shape, fortran, dtype = read(self.stream)
        except (ValueError, EOFError) as error:
            raise InputError(f"{self.name}: this is no .npy file ({error}), {expected}") from None
        if dtype.kind not in "fiu":
            raise InputError(f"{self.name}: found values of type {dtype}, {expected}")
        rows, width = (1, *shape) if len(shape) == 1 else shape if len(shape) == 2 else (0, -1)
        if width != self.columns.count:
            raise InputError(f"{self.name}: found an array of shape {shape}, {expected}")
        blocks = self.fortran_rows(rows, width, dtype) if fortran else self.plain_rows(rows, width, dtype)
        for block in blocks:
            finite = np.isfinite(block)
            if not finite.all():
                row = self.line + int(np.argmin(finite.all(axis=1)))
                raise InputError(f"{self.name}, row {row + 1}: found a number that is not finite, {expected}")
            self.line += len(block)
            yield block

    def plain_rows(self, rows: int, width: int, dtype: np.dtype[Any]) -> Iterator[Array]:
        for start in range(0, rows, NPY_ROWS):
            count = min(NPY_ROWS, rows - start)
            data = self.exactly(count * width * dtype.itemsize, rows)
            yield np.frombuffer(data, dtype=dtype).astype(np.float64).reshape(count, width)

    def fortran_rows(self, rows: int, width: int, dtype: np.dtype[Any]) -> Iterator[Array]:
        """Column by column in the file: all of it has to be read before the first row is known."""
        data = self.exactly(rows * width * dtype.itemsize, rows)
        whole = np.frombuffer(data, dtype=dtype).reshape(width, rows).T
        for start in range(0, rows, NPY_ROWS):
            yield whole[start : start + NPY_ROWS].astype(np.float64)

    def exactly(self, size: int, rows: int) -> bytes:
        parts = []
        while size and (part := self.stream.read(size)):
            parts.append(part)
            size -= len(part)
        if size:
            raise InputError(f"{self.name}: it ends before its {rows} rows do, expected a whole .npy file")
        return b"".join(parts)


def numbers_of(block: bytes) -> Any:
    """Lines of numbers and commas as a list of lists. Raises ValueError.

    pydantic's core, which Typer brings, reads JSON ten times faster than float() reads numbers.
    """
    if from_json is not None:
        return from_json(b"[[" + block.replace(b"\n", b"],[") + b"]]", allow_inf_nan=False)
    return [[float(cell) for cell in line.split(b",")] for line in block.split(b"\n")]


def _finite(value: float) -> bool:
    try:
        return math.isfinite(value)
    except OverflowError:
        return False
