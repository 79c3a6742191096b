"""Rows of numbers from files and pipes, in blocks: CSV, JSON lines and `.npy`.

A stream is read as it comes, and a block of some thousand rows is all that is held of it.
"""

from __future__ import annotations

import contextlib
import io
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from robokin.cli import say
from robokin.cli.lines import BYTE_ORDER_MARK, Columns
from robokin.errors import InputError
from robokin.units import Units

__all__ = ["Columns", "open_input", "read_rows"]

Array = NDArray[np.float64]


@contextlib.contextmanager
def open_input(source: str) -> Iterator[tuple[IO[bytes], str]]:
    """The stream that `-` or a path means, and the name to give it in messages."""
    if source == "-":
        if sys.stdin is None:
            raise InputError("standard input is closed, expected rows")
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
    try:
        yield from _blocks(stream, name, columns, units)
    except OSError as error:
        raise InputError(f"{name}: {error.strerror}, expected rows that can be read") from None


def _blocks(stream: Any, name: str, columns: Columns, units: Units) -> Iterator[Array]:
    buffered = stream if hasattr(stream, "peek") else io.BufferedReader(stream)
    head = bytes(buffered.peek(8))
    ending = Path(name).suffix.lower()
    if ending == ".npy" or head.startswith(b"\x93NUMPY"):
        from robokin.cli.array_rows import array_blocks

        yield from array_blocks(buffered, name, columns.count, columns.what)
        return
    brace = head.removeprefix(BYTE_ORDER_MARK).lstrip()[:1] in (b"{", b"[")
    if ending == ".jsonl" or (brace and ending != ".csv"):
        from robokin.cli.json_rows import JsonReader

        reader: Any = JsonReader(buffered, name, columns, units)
    else:
        from robokin.cli.csv_rows import CsvReader

        reader = CsvReader(buffered, name, columns, units)
    yield from reader.blocks()
    if reader.unsolved:
        verb = "target has" if reader.unsolved == 1 else "targets have"
        say(f"{name}: {reader.unsolved} {verb} no solution and {'is' if reader.unsolved == 1 else 'are'} left out")
