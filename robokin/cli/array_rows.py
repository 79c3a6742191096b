"""Rows of numbers from `.npy` files, in blocks."""

from __future__ import annotations

from collections.abc import Iterator
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from robokin.errors import InputError

Array = NDArray[np.float64]

ARRAY_ROWS = 8192
"""Rows of an array read at once."""

READ = 1 << 22
"""Bytes asked for at once: a header may promise more rows than there is memory for."""


def array_blocks(stream: IO[bytes], name: str, width: int, what: str) -> Iterator[Array]:
    """Blocks (m, width) of an array (rows, width) of numbers, or of one row (width,).

    `name` and `what` are the stream and its rows in messages. Raises InputError, with the number of a
    row that is not finite.
    """
    expected = f"expected an array of numbers (rows, {width}): {what}"
    shape, fortran, dtype = array_header(stream, name, expected)
    if width == 1 and len(shape) == 1:
        shape = (*shape, 1)
    rows = shape[0] if len(shape) == 2 else 1
    if shape not in ((rows, width), (width,)):
        raise InputError(f"{name}: found an array of shape {shape}, {expected}")
    reader = ArrayReader(stream, name, rows, width, dtype)
    done = 0
    for block in reader.fortran_blocks() if fortran and len(shape) == 2 else reader.plain_blocks():
        finite = np.isfinite(block)
        if not finite.all():
            row = done + int(np.argmin(finite.all(axis=1))) + 1
            raise InputError(f"{name}, row {row}: found a number that is not finite, {expected}")
        done += len(block)
        yield block


def array_header(stream: IO[bytes], name: str, expected: str) -> tuple[tuple[int, ...], bool, np.dtype[Any]]:
    """The shape of an array, whether it is in Fortran order, and the type of its numbers."""
    try:
        version = np.lib.format.read_magic(stream)
        old = version == (1, 0)
        read = np.lib.format.read_array_header_1_0 if old else np.lib.format.read_array_header_2_0
        shape, fortran, dtype = read(stream)
    except (OSError, KeyboardInterrupt):
        raise
    except Exception as error:  # a header is Python text, and what is none fails in many ways
        reason = str(error).partition("\n")[0]
        raise InputError(f"{name}: this is no .npy file ({reason}), {expected}") from None
    if dtype.kind not in "fiu":
        raise InputError(f"{name}: found values of type {dtype}, {expected}")
    return shape, fortran, dtype


class ArrayReader:
    """The numbers of an array, after its header."""

    def __init__(self, stream: IO[bytes], name: str, rows: int, width: int, dtype: np.dtype[Any]) -> None:
        """`rows` and `width` are the counts of numbers that the header promises."""
        self.stream, self.name, self.rows, self.width, self.dtype = stream, name, rows, width, dtype

    def plain_blocks(self) -> Iterator[Array]:
        """Row after row, as they are stored."""
        for start in range(0, self.rows, ARRAY_ROWS):
            count = min(ARRAY_ROWS, self.rows - start)
            yield self.numbers(count * self.width).reshape(count, self.width)

    def fortran_blocks(self) -> Iterator[Array]:
        """Column after column is stored: a file is searched for each; of a pipe all has to be read first."""
        if not self.stream.seekable():
            whole = self.numbers(self.rows * self.width).reshape(self.width, self.rows)
            for start in range(0, self.rows, ARRAY_ROWS):
                yield np.ascontiguousarray(whole[:, start : start + ARRAY_ROWS].T)
            return
        first = self.stream.tell()
        for start in range(0, self.rows, ARRAY_ROWS):
            count = min(ARRAY_ROWS, self.rows - start)
            block = np.empty((count, self.width))
            for column in range(self.width):
                self.stream.seek(first + (column * self.rows + start) * self.dtype.itemsize)
                block[:, column] = self.numbers(count)
            yield block

    def numbers(self, count: int) -> Array:
        """The next numbers of the file. Raises InputError when it ends before."""
        size = count * self.dtype.itemsize
        parts = []
        while size > 0 and (part := self.stream.read(min(size, READ))):
            parts.append(part)
            size -= len(part)
        if size:
            raise InputError(f"{self.name}: it ends before its {self.rows} rows do, expected a whole .npy file")
        return np.frombuffer(b"".join(parts), dtype=self.dtype).astype(np.float64)
