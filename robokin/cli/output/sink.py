"""Where output goes: standard output, or a file that is whole or absent."""

from __future__ import annotations

import contextlib
import secrets
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import IO

from robokin.errors import InputError, OutputError

ENDINGS = {".csv": "csv", ".jsonl": "jsonl", ".json": "json", ".npy": "npy"}
"""Formats by the ending of the output's name."""


def format_of(output: str | None, chosen: str | None) -> str:
    """The format to write: the output's ending, else the chosen one, else a table."""
    if output is None:
        return chosen or "table"
    ending = Path(output).suffix.lower()
    if ending not in ENDINGS:
        raise InputError(f"--output: found '{output}', expected a name that ends with {', '.join(ENDINGS)}")
    if chosen is not None and chosen != ENDINGS[ending]:
        raise InputError(f"--output {output} and --format {chosen} say different things, expected one of them")
    return ENDINGS[ending]


@contextlib.contextmanager
def sink(output: str | None) -> Iterator[IO[bytes]]:
    """A stream of bytes to the output, standard output for None.

    A file is written under a temporary name beside it and takes its own name when all is written; on
    any error, and on Ctrl-C, nothing is left.
    """
    if output is None:
        # What was printed before as text must come first.
        sys.stdout.flush()
        yield sys.stdout.buffer
        sys.stdout.buffer.flush()
        return
    path = Path(output)
    temporary = path.with_name(f".{path.name}.{secrets.token_hex(4)}.part")
    try:
        stream = temporary.open("xb")
    except OSError as error:
        raise OutputError(f"--output {output}: {error.strerror}, expected a place that can be written") from None
    try:
        with stream:
            yield stream
        temporary.replace(path)
    except OSError as error:
        if isinstance(error, BrokenPipeError):
            raise
        raise OutputError(f"--output {output}: {error.strerror}, nothing was written") from None
    finally:
        with contextlib.suppress(OSError):
            temporary.unlink(missing_ok=True)
