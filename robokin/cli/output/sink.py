"""Where output goes: standard output, or a file that is whole or absent."""

from __future__ import annotations

import contextlib
import os
import secrets
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import IO

from robokin.errors import InputError, OutputError, or_list

ENDINGS = {".csv": "csv", ".jsonl": "jsonl", ".json": "json", ".npy": "npy"}
"""Formats by the ending of the output's name."""


def format_of(output: str | None, chosen: str | None, *, arrays: bool = False) -> str:
    """The format to write: the output's ending, else the chosen one, else a table.

    `arrays` tells whether what is written can be an array, so that `.npy` is possible.
    """
    if output is None:
        return chosen or "table"
    kind = ENDINGS.get(Path(output).suffix.lower())
    if kind is None or (kind == "npy" and not arrays):
        possible = [ending for ending in ENDINGS if arrays or ending != ".npy"]
        raise InputError(f"--output: found '{output}', expected a name that ends with {or_list(possible)}")
    if chosen is not None and chosen != kind:
        raise InputError(f"--output {output} and --format {chosen} say different things, expected one of them")
    return kind


@contextlib.contextmanager
def sink(output: str | None, option: str = "--output") -> Iterator[IO[bytes]]:
    """A stream of bytes to the output, standard output for None; `option` is what named it.

    A file is written under a temporary name beside it and takes its own name when all is written; on
    any error, and on Ctrl-C, nothing is left.
    """
    if output is None:
        if sys.stdout is None:
            raise OutputError("standard output is closed, expected a place that can be written")
        try:
            # What was printed before as text must come first.
            sys.stdout.flush()
            yield sys.stdout.buffer
            sys.stdout.buffer.flush()
        except OSError as error:
            error.filename = error.filename or "standard output"
            raise
        return
    # A link stays a link: what it points to is replaced.
    path = Path(os.path.realpath(output))
    if path.is_dir():
        raise OutputError(f"{option} {output}: found a directory, expected a place that can be written")
    temporary = path.with_name(f".{path.name}.{secrets.token_hex(4)}.part")
    try:
        stream = temporary.open("xb")
    except OSError as error:
        raise OutputError(f"{option} {output}: {error.strerror}, expected a place that can be written") from None
    try:
        with stream:
            yield stream
        temporary.replace(path)
    except OSError as error:
        raise OutputError(f"{option} {output}: {error.strerror}, nothing was written") from None
    finally:
        with contextlib.suppress(OSError):
            temporary.unlink(missing_ok=True)
