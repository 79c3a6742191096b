"""Files and standard input, opened for reading: the one place, with one sentence for whatever cannot be read.

Whatever has a name may be read: files, pipes, devices, links to them. A reader takes bounded pieces, or one piece of
bounded size by `read_up_to`, so that a device that never ends costs no memory; waiting for the writer of a pipe can be
interrupted.
"""

from __future__ import annotations

import contextlib
import os
import select
import signal
import stat
import sys
import threading
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import IO, Any

from robokin.errors import InputError, shown
from robokin.unfinished_work import in_order

STDIN = "standard input"
"""What messages call it."""

MAX_LINKS = 40
"""Links that are followed one after the other, as Linux does."""

TAKEN = 1 << 16
"""Bytes taken out of a pipe at once, which is what it holds, and more than the buffer of a stream."""

CLOSED: set[int] = set()
"""Those of the descriptors 0, 1 and 2 that were closed when the program started."""


@contextlib.contextmanager
def open_input(source: str, expected: str) -> Iterator[tuple[IO[bytes], str]]:
    """The stream that `-` or a path means, and the name to give it in messages.

    `expected` ends the sentence about what cannot be opened. Raises InputError.
    """
    if source != "-":
        with open_path(source, expected) as stream:
            yield stream, source
        return
    _require_standard_input(expected)
    yield sys.stdin.buffer, STDIN


@contextlib.contextmanager
def open_path(path: str, expected: str) -> Iterator[IO[bytes]]:
    """The stream that a path means, whatever it is called. Raises InputError for what cannot be opened."""
    if descriptor_of(path) == 0:
        _require_standard_input(expected)
    try:
        stream = open(path, "rb")  # noqa: SIM115, PTH123 - only opening may fail with this sentence
    except (OSError, ValueError) as error:
        name = path if isinstance(error, OSError) else shown(path)
        raise InputError(f"{name}: {unreadable(error)}, expected {expected}") from None
    with stream:
        yield stream


def read_up_to(stream: IO[bytes], name: str, most: int, expected: str) -> bytes:
    """What a stream holds, or its first `most` + 1 bytes where it holds more. Raises InputError."""
    parts, left = [], most + 1
    try:
        while left:
            wait_for(stream)
            if not (part := stream.read1(min(left, 1 << 20))):  # type: ignore[attr-defined]
                break
            parts.append(part)
            left -= len(part)
    except OSError as error:
        raise InputError(f"{name}: {unreadable(error)}, expected {expected}") from None
    return b"".join(parts)


class HeededStream:
    """A stream that gives what it has, and waits for more as `wait_for` does; for pipes, which have no way back."""

    def __init__(self, stream: Any) -> None:
        """The stream is a buffered one; what is in its buffer is given first."""
        self.stream = stream
        self.kept = b""
        """What was taken out of the stream and is not read yet."""
        self.fresh = True
        """Whether the stream's own buffer may hold something, so that there is nothing to wait for."""

    def seekable(self) -> bool:
        """It never is."""
        return False

    def read(self, most: int) -> bytes:
        """The next bytes, up to so many of them; none at the end."""
        if not self.kept and most:
            self._take(most)
        part, self.kept = self.kept[:most], self.kept[most:]
        return part

    def peek(self, count: int) -> bytes:
        """The next bytes, which stay to be read: so many of them, or fewer before the end."""
        while len(self.kept) < count and self._take(count):
            pass
        return self.kept

    def _take(self, most: int) -> bool:
        """Take more bytes out of the stream; whether there were any."""
        if not self.fresh:
            wait_for(self.stream)
        more = self.stream.read1(max(most, TAKEN))  # all of its buffer, which would be in the way of the next wait
        self.kept, self.fresh = self.kept + more, False
        return bool(more)


def wait_for(stream: Any) -> None:
    """Wait for the next bytes of a stream of which none are in its buffer, or for its end, or for a signal.

    Python runs the handler of a signal between two of its steps: of one that comes just before the stream is read it
    would know when the read is over, which on a pipe may be never. So what is waited for is either.
    """
    with contextlib.suppress(OSError, ValueError, AttributeError):  # what is no file has no number
        number = stream.fileno()
        if in_order.heeded and not stat.S_ISREG(os.fstat(number).st_mode) and (woken := _woken()) is not None:
            while number not in select.select([number, woken], [], [])[0]:
                with contextlib.suppress(BlockingIOError):
                    os.read(woken, 1 << 10)


@cache
def _woken() -> int | None:
    """The number of what can be read when a signal has come; None where there is no such thing."""
    if os.name != "posix" or threading.current_thread() is not threading.main_thread():
        return None
    here, there = os.pipe()
    os.set_blocking(here, False)
    os.set_blocking(there, False)
    signal.set_wakeup_fd(there, warn_on_full_buffer=False)
    return here


def _require_standard_input(expected: str) -> None:
    if sys.stdin is None or 0 in CLOSED:
        raise InputError(f"{STDIN} is closed, expected {expected}")


def unreadable(error: OSError | ValueError) -> str:
    """Why something cannot be read."""
    if isinstance(error, FileNotFoundError):
        return "no such file"
    if isinstance(error, IsADirectoryError):
        return "found a directory"
    if isinstance(error, OSError):
        return str(error.strerror or error)
    return "this is no path"  # one with a null character


def descriptor_of(place: str) -> int | None:
    """The number of the open descriptor that a path means, such as 1 for /dev/stdout; None for any other path."""
    ours = ("/dev/fd", f"/proc/{os.getpid()}/fd")
    for _ in range(MAX_LINKS):
        folder, name = os.path.split(place)
        try:
            if name.isdecimal() and os.path.realpath(folder or ".") in ours:
                return int(name)
            place = str(Path(folder) / Path(place).readlink())
        except (OSError, ValueError):
            return None
    return None
