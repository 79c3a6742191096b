"""Rows of joint values from files, pipes and folders of parts, in blocks: CSV, JSON, `.npy`, Parquet and Arrow.

A stream is read as it comes, and a block of some thousand rows is all that is held of it.
"""

from __future__ import annotations

import io
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from robokin.arrays import Array
from robokin.errors import InputError, shown
from robokin.files import HeededStream, open_input, wait_for
from robokin.tables.arrow_library import ENDINGS as ARROW_ENDINGS
from robokin.tables.arrow_library import kind_of_start
from robokin.tables.carried import Carried
from robokin.tables.text_source import BYTE_ORDER_MARK, ROWS, Say
from robokin.tables.wanted_columns import Wanted

MAGIC = b"\x93NUMPY"
"""What an array begins with."""


def kind_of_stream(stream: Any, name: str) -> tuple[str, Any]:
    """What a stream holds (csv, json, npy, parquet or arrow), by its name's ending or else by its first bytes; and it,
    to be read."""
    buffered = stream if hasattr(stream, "peek") else io.BufferedReader(stream)
    wait_for(stream)
    head = bytes(buffered.peek(8))
    ending = Path(name).suffix.lower()
    if ending == ".npy" or (head and MAGIC.startswith(head[: len(MAGIC)])):  # of a pipe less may have come
        return "npy", buffered if buffered.seekable() else HeededStream(buffered)
    if (arrow := ARROW_ENDINGS.get(ending) or kind_of_start(head)) is not None and ending not in (".csv", ".jsonl"):
        return arrow, buffered
    brace = head.removeprefix(BYTE_ORDER_MARK).lstrip()[:1] in (b"{", b"[")
    return "json" if ending in (".jsonl", ".json") or (brace and ending != ".csv") else "csv", buffered


def read_rows(source: str, wanted: Wanted, carried: Carried, say: Say) -> Iterator[Array]:
    """Blocks (m, k) of what is wanted of a file or of standard input (-).

    `carried` takes the cells that go through, `say` notes. Raises InputError with the number of the line that is
    wrong.
    """
    unsolved = 0
    for place in places_of(source):
        with open_input(place, ROWS) as (stream, name):
            try:
                kind, buffered = kind_of_stream(stream, name)
                if kind == "npy":
                    yield from _array_rows(buffered, name, wanted)
                    return
                reader = _reader(kind, buffered, name, wanted, carried, say)
                yield from reader.rows()
                unsolved += reader.unsolved
            except OSError as error:
                raise InputError(f"{name}: {error.strerror}, expected rows that can be read") from None
    if unsolved:
        verb = "target has" if unsolved == 1 else "targets have"
        told = name if place == source or source == "-" else source
        say(f"{told}: {unsolved} {verb} no solution and {'is' if unsolved == 1 else 'are'} left out")


def places_of(source: str) -> list[str]:
    """The files of a source, in the order of their rows: itself, or the parts of a folder. Raises InputError."""
    if source == "-" or not os.path.isdir(source):  # noqa: PTH112 - pathlib refuses what is no path
        return [source]
    from robokin.tables.part_folders import whole_parts

    return whole_parts(source)


def _reader(kind: str, stream: Any, name: str, wanted: Wanted, carried: Carried, say: Say) -> Any:
    """What reads the rows of a stream of a kind."""
    if kind == "json":
        from robokin.tables.json_rows import JsonReader

        return JsonReader(stream, name, wanted, carried, say)
    if kind in ("parquet", "arrow"):
        from robokin.tables.arrow_rows import ArrowReader

        return ArrowReader(stream, name, kind, wanted, carried, say)
    from robokin.tables.csv_rows import CsvReader

    return CsvReader(stream, name, wanted, carried, say)


def _array_rows(stream: Any, name: str, wanted: Wanted) -> Iterator[Array]:
    """Blocks (m, width) of an array (rows, width), (width,), or (m, k, width) as `ik` pads it with NaN."""
    from robokin.tables.array_rows import ArrayReader, array_header, finite_blocks

    width = len(wanted.bare(0).columns)
    expected = f"expected an array of numbers (rows, {width}): {wanted.what}"
    shape, fortran, dtype = array_header(stream, name, expected)
    if width == 1 and len(shape) == 1:
        shape = (*shape, 1)
    if shape[-1:] != (width,) or len(shape) > 3:
        raise InputError(f"{name}: found an array of shape {shown(str(shape))}, {expected}")
    rows, inner = (1, shape) if len(shape) == 1 else (shape[0], shape[1:])
    if len(shape) == 3 and not shape[1]:
        rows = 0
    blocks = ArrayReader(stream, name, rows, inner, dtype, fortran).blocks()
    flat = (block.reshape(-1, width) for block in blocks)
    yield from finite_blocks(flat, name, expected, padded=len(shape) == 3)
