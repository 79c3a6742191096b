"""Rows of joint values from files and pipes, in blocks: CSV, JSON and `.npy`.

A stream is read as it comes, and a block of some thousand rows is all that is held of it.
"""

from __future__ import annotations

import io
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from robokin.arrays import Array
from robokin.errors import InputError
from robokin.files import HeededStream, open_input, wait_for
from robokin.tables.carried import Carried
from robokin.tables.text_source import BYTE_ORDER_MARK, ROWS, Say
from robokin.tables.wanted_columns import Wanted

MAGIC = b"\x93NUMPY"
"""What an array begins with."""


def kind_of_stream(stream: Any, name: str) -> tuple[str, Any]:
    """What a stream holds (csv, json or npy), by its name's ending or else by its first bytes; and it, to be read."""
    buffered = stream if hasattr(stream, "peek") else io.BufferedReader(stream)
    wait_for(stream)
    head = bytes(buffered.peek(8))
    ending = Path(name).suffix.lower()
    if ending == ".npy" or (head and MAGIC.startswith(head[: len(MAGIC)])):  # of a pipe less may have come
        return "npy", buffered if buffered.seekable() else HeededStream(buffered)
    brace = head.removeprefix(BYTE_ORDER_MARK).lstrip()[:1] in (b"{", b"[")
    return "json" if ending in (".jsonl", ".json") or (brace and ending != ".csv") else "csv", buffered


def read_rows(source: str, wanted: Wanted, carried: Carried, say: Say) -> Iterator[Array]:
    """Blocks (m, k) of what is wanted of a file or of standard input (-).

    `carried` takes the cells that go through, `say` notes. Raises InputError with the number of the line that is
    wrong.
    """
    with open_input(source, ROWS) as (stream, name):
        try:
            kind, buffered = kind_of_stream(stream, name)
            if kind == "npy":
                yield from _array_rows(buffered, name, wanted)
                return
            if kind == "json":
                from robokin.tables.json_rows import JsonReader

                reader: Any = JsonReader(buffered, name, wanted, carried, say)
            else:
                from robokin.tables.csv_rows import CsvReader

                reader = CsvReader(buffered, name, wanted, carried, say)
            yield from reader.rows()
        except OSError as error:
            raise InputError(f"{name}: {error.strerror}, expected rows that can be read") from None
    if reader.unsolved:
        verb = "target has" if reader.unsolved == 1 else "targets have"
        say(f"{name}: {reader.unsolved} {verb} no solution and {'is' if reader.unsolved == 1 else 'are'} left out")


def _array_rows(stream: Any, name: str, wanted: Wanted) -> Iterator[Array]:
    """Blocks (m, width) of an array (rows, width), (width,), or (m, k, width) as `ik` pads it with NaN."""
    from robokin.tables.array_rows import ArrayReader, array_header, finite_blocks

    width = len(wanted.bare(0).columns)
    expected = f"expected an array of numbers (rows, {width}): {wanted.what}"
    shape, fortran, dtype = array_header(stream, name, expected)
    if width == 1 and len(shape) == 1:
        shape = (*shape, 1)
    if shape[-1:] != (width,) or len(shape) > 3:
        raise InputError(f"{name}: found an array of shape {shape}, {expected}")
    rows, inner = (1, shape) if len(shape) == 1 else (shape[0], shape[1:])
    if len(shape) == 3 and not shape[1]:
        rows = 0
    blocks = ArrayReader(stream, name, rows, inner, dtype, fortran).blocks()
    flat = (block.reshape(-1, width) for block in blocks)
    yield from finite_blocks(flat, name, expected, padded=len(shape) == 3)
