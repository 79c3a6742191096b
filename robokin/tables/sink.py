"""Where output goes: standard output, a file that is whole or absent, or a pipe or a device as it is."""

from __future__ import annotations

import contextlib
import os
import stat
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import IO

from robokin.errors import InputError, OutputError, or_list
from robokin.files import CLOSED, descriptor_of
from robokin.tables.arrow_library import ENDINGS as ARROW_ENDINGS
from robokin.unfinished_work import unfinished

ENDINGS = {".csv": "csv", ".jsonl": "jsonl", ".json": "json", ".npy": "npy"}
"""Formats by the ending of the output's name."""


class Writing:
    """Whether files are written; not where questions are served."""

    refused = False


CLOSED_OUTPUT = "standard output is closed, expected a place that can be written"


def format_of(output: str | None, chosen: str | None, *, arrays: bool = False, rows: bool = False) -> str:
    """The format to write: the output's ending, else the chosen one, else a table.

    `arrays` tells whether what is written can be an array, so that `.npy` is possible, `rows` whether it can be a table
    of rows, so that `.parquet`, `.arrow` and `.feather` are.
    """
    if output is None:
        return chosen or "table"
    possible = {ending: kind for ending, kind in ENDINGS.items() if arrays or kind != "npy"}
    possible |= ARROW_ENDINGS if rows else {}
    kind = possible.get(Path(output).suffix.lower())
    if kind is None:
        folder = ", or with / for a folder of parts" if rows else ""
        raise InputError(f"--output: found '{output}', expected a name that ends with {or_list(possible)}{folder}")
    if chosen is not None and chosen != kind:
        raise InputError(f"--output {output} and --format {chosen} say different things, expected one of them")
    return kind


def is_folder(output: str | None) -> bool:
    """Whether an output is a folder of parts: by the / at its end, or because such a folder is there."""
    if output is None:
        return False
    if output.endswith(("/", os.sep)):
        return True
    from robokin.tables.part_folders import MANIFEST

    return os.path.isfile(os.path.join(output, MANIFEST))  # noqa: PTH113, PTH118 - pathlib refuses what is no path


@contextlib.contextmanager
def sink(output: str | None, option: str = "--output") -> Iterator[IO[bytes]]:
    """A stream of bytes to the output, standard output for None; `option` is what named it.

    A file is written under a temporary name beside it and takes its own name when all is written; on any error, and on
    Ctrl-C, nothing is left. What is no regular file (a pipe, a device, /dev/stdout) is written as it is.
    """
    if output is None:
        yield from _standard_output()
        return
    if Writing.refused:
        raise InputError(f"{option} {output}: expected no file to write, answers are documents on standard output")
    place = Destination(output, option)
    try:
        with place.straight() if place.special else place.whole() as stream:
            yield stream
    except OSError as error:
        if isinstance(error, BrokenPipeError) and place.special:
            raise  # whoever reads has what it wants
        rest = "expected a place that can be written" if place.special else "nothing was written"
        raise OutputError(f"{option} {output}: {error.strerror or error}, {rest}") from None


def _standard_output() -> Iterator[IO[bytes]]:
    if sys.stdout is None or 1 in CLOSED:
        raise OutputError(CLOSED_OUTPUT)
    try:
        # What was printed before as text must come first.
        sys.stdout.flush()
        yield sys.stdout.buffer
        sys.stdout.buffer.flush()
    except OSError as error:
        error.filename = error.filename or "standard output"
        raise


class Destination:
    """Where an option wants a file: `path`, links followed; `special` where there is something else than a file.

    Raises OutputError for a place that cannot be written.
    """

    def __init__(self, output: str, option: str) -> None:
        self.output, self.option = output, option
        self.path = Path(output)
        self.before: os.stat_result | None = None
        """What is known of the file that is there."""
        try:
            self.descriptor = descriptor_of(output)
            self.special = self.descriptor is not None
            if not self.special:
                # A link stays a link: what it points to is replaced.
                self.path = Path(os.path.realpath(output))
                self._look()
        except (OSError, ValueError) as error:
            raise self.refusal(getattr(error, "strerror", None) or "this is no path") from None

    def _look(self) -> None:
        """What is there now."""
        try:
            there = self.path.stat()
        except FileNotFoundError:
            return
        for refused, what in ((stat.S_ISDIR, "directory"), (stat.S_ISBLK, "disk"), (stat.S_ISSOCK, "socket")):
            if refused(there.st_mode):
                raise self.refusal(f"found a {what}")
        if not os.access(self.path, os.W_OK):
            raise self.refusal("Permission denied")
        self.special = not stat.S_ISREG(there.st_mode)
        self.before = there

    def refusal(self, reason: str) -> OutputError:
        """The error that says why nothing can be written here."""
        return OutputError(f"{self.option} {self.output}: {reason}, expected a place that can be written")

    @contextlib.contextmanager
    def whole(self) -> Iterator[IO[bytes]]:
        """A stream to a file that takes its name, and the permissions of the one before it, when all is written."""
        temporary = self.path.with_name(f".{self.path.name[:40]}.{os.urandom(4).hex()}.part")
        with unfinished(str(temporary)):
            try:
                stream = temporary.open("xb")
            except OSError as error:
                raise self.refusal(str(error.strerror)) from None
            with stream:
                if self.before is not None:
                    with contextlib.suppress(OSError, AttributeError):  # only root gives files away
                        os.chown(temporary, self.before.st_uid, self.before.st_gid)
                    temporary.chmod(stat.S_IMODE(self.before.st_mode))
                yield stream
            temporary.replace(self.path)

    @contextlib.contextmanager
    def straight(self) -> Iterator[IO[bytes]]:
        """A stream to what is no regular file, in order with what was written there before."""
        with self._opened() as stream:
            if self.path.suffix.lower() != ".npy":
                yield stream
                return
            import shutil
            import tempfile

            # An array says its number of rows in front when all is known, and here there is no way back.
            with tempfile.TemporaryFile() as kept:
                yield kept
                kept.seek(0)
                shutil.copyfileobj(kept, stream)

    def _opened(self) -> IO[bytes]:
        try:
            if self.descriptor is None:
                writing = os.O_WRONLY | getattr(os, "O_NOCTTY", 0)
                return open(os.open(self.path, writing), "wb")  # noqa: PTH123 - a descriptor, no path
            if self.descriptor in CLOSED:
                raise self.refusal("it is closed")
            for stream in (sys.stdout, sys.stderr):
                stream.flush()
            return open(os.dup(self.descriptor), "wb")  # noqa: PTH123 - a descriptor, no path
        except OSError as error:
            raise self.refusal(str(error.strerror)) from None
