"""Rows of numbers from `.npy` files, in blocks. A file is checked whole: nothing may be missing, nothing left over."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator
from typing import Any

import numpy as np

from robokin.arrays import Array
from robokin.errors import InputError, counted, shown

ARRAY_ROWS = 8192
"""Rows of an array read at once."""

READ = 1 << 22
"""Bytes asked for at once: a header may promise more rows than there is memory for."""

MAX_HEADER = 10_000
"""Bytes of a header, as numpy limits it, but before it is read."""

MAX_REASON = 100
"""Characters of a reason why a header is none: numpy's repeat the header."""

VERSIONS = ((1, 0), (2, 0), (3, 0))
"""Those of the format that there are."""

MAX_TURNED = 1 << 30
"""Bytes of an array in Fortran order that come through a pipe, which have to be held as a whole."""


def array_header(stream: Any, name: str, expected: str) -> tuple[tuple[int, ...], bool, np.dtype[Any]]:
    """The shape of an array, whether it is in Fortran order, and the type of its numbers.

    `expected` ends the message of an InputError for what is no array of numbers.
    """
    try:
        head = bytes(stream.peek(12)[:12])
        if len(head) == 12 and head[6] > 1 and int.from_bytes(head[8:], "little") > MAX_HEADER:
            raise ValueError(f"its header is longer than {MAX_HEADER} bytes")
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # headers of an old Python are read as well
            version = np.lib.format.read_magic(stream)
            if version not in VERSIONS:
                raise ValueError(f"version {version[0]}.{version[1]}")
            old = version == (1, 0)
            read = np.lib.format.read_array_header_1_0 if old else np.lib.format.read_array_header_2_0
            shape, fortran, dtype = read(stream)
    except (OSError, KeyboardInterrupt):
        raise
    except Exception as error:  # a header is Python text, and what is none fails in many ways
        raise InputError(f"{name}: this is no .npy file ({reason_of(error)}), {expected}") from None
    if dtype.kind not in "fiu":
        raise InputError(f"{name}: found values of type {shown(str(dtype))}, {expected}")
    if any(isinstance(count, bool) or count < 0 for count in shape):
        raise InputError(f"{name}: found an array of shape {shown(str(shape))}, {expected}")
    return shape, fortran, dtype


def reason_of(error: Exception) -> str:
    """Why a header is none, by numpy's error: short, and the same in each run."""
    if "ast." in str(error):  # Python's words for an expression tell where it is in memory
        return "its header holds more than plain values"
    return shown(str(error).partition("\n")[0], MAX_REASON) or "its header cannot be read"


class ArrayReader:
    """The numbers of an array, after its header: `rows` of numbers of the shape `inner` each."""

    def __init__(
        self, stream: Any, name: str, rows: int, inner: tuple[int, ...], dtype: np.dtype[Any], fortran: bool
    ) -> None:
        self.stream, self.name, self.rows, self.inner, self.dtype = stream, name, rows, inner, dtype
        self.width = math.prod(inner)
        self.fortran = fortran

    def blocks(self) -> Iterator[Array]:
        """Blocks (m, width), each row in C order. Raises InputError for a file that is too short or too long."""
        self.check_size()
        yield from self.fortran_blocks() if self.fortran else self.plain_blocks()
        if self.stream.read(1):
            raise self.too_long()

    def check_size(self) -> None:
        """Of a file that can be searched its size, before anything is done with its rows."""
        if not self.stream.seekable():
            return
        here = self.stream.tell()
        left = self.stream.seek(0, 2) - here
        self.stream.seek(here)
        size = self.rows * self.width * self.dtype.itemsize
        if left < size:
            raise self.too_short()
        if left > size:
            raise self.too_long()

    def too_short(self) -> InputError:
        """The error for a file that ends early."""
        return InputError(f"{self.name}: it ends before its {counted(self.rows, 'row')} do, expected a whole .npy file")

    def too_long(self) -> InputError:
        """The error for a file that goes on."""
        said = counted(self.rows, "row")
        return InputError(f"{self.name}: found more bytes behind its {said}, expected the end of the .npy file")

    def plain_blocks(self) -> Iterator[Array]:
        """Row after row, as they are stored."""
        for start in range(0, self.rows, ARRAY_ROWS):
            count = min(ARRAY_ROWS, self.rows - start)
            yield self.numbers(count * self.width).reshape(count, self.width)

    def fortran_blocks(self) -> Iterator[Array]:
        """Column after column is stored: a file is searched for each; of a pipe all has to be read first."""
        order = np.arange(self.width).reshape(self.inner[::-1]).T.ravel()
        if not self.stream.seekable():
            if self.rows * self.width * self.dtype.itemsize > MAX_TURNED:
                said = f"more than {MAX_TURNED} bytes in Fortran order"
                raise InputError(f"{self.name}: found {said}, expected C order, or a file instead of a pipe")
            whole = self.numbers(self.rows * self.width).reshape(self.width, self.rows)[order]
            for start in range(0, self.rows, ARRAY_ROWS):
                yield np.ascontiguousarray(whole[:, start : start + ARRAY_ROWS].T)
            return
        first = self.stream.tell()
        for start in range(0, self.rows, ARRAY_ROWS):
            count = min(ARRAY_ROWS, self.rows - start)
            block = np.empty((count, self.width))
            for column, stored in enumerate(order.tolist()):
                self.stream.seek(first + (stored * self.rows + start) * self.dtype.itemsize)
                block[:, column] = self.numbers(count)
            yield block
        self.stream.seek(0, 2)

    def numbers(self, count: int) -> Array:
        """The next numbers of the file. Raises InputError when it ends before."""
        size = count * self.dtype.itemsize
        parts = []
        while size > 0 and (part := self.stream.read(min(size, READ))):
            parts.append(part)
            size -= len(part)
        if size:
            raise self.too_short()
        with np.errstate(over="ignore"):  # what is too great for a float is refused as infinite
            return np.frombuffer(b"".join(parts), dtype=self.dtype).astype(np.float64)


def finite_blocks(blocks: Iterator[Array], name: str, expected: str, *, padded: bool) -> Iterator[Array]:
    """The blocks (m, width), all of their numbers finite; of `padded` ones without the rows that are NaN as a whole.

    Raises InputError with the number of a row that is not finite.
    """
    done = 0
    for block in blocks:
        finite = np.isfinite(block)
        if not finite.all():
            empty = np.isnan(block).all(axis=1) if padded else np.zeros(len(block), dtype=bool)
            wrong = ~(finite.all(axis=1) | empty)
            if wrong.any():
                row = done + int(np.argmax(wrong)) + 1
                raise InputError(f"{name}, row {row}: found a number that is not finite, {expected}")
            done += len(block)
            block = block[~empty]
        else:
            done += len(block)
        if len(block):
            yield block
