"""Files of sampled positions, of any number of samples in constant memory; what is interrupted can be resumed.

While it is made, `name.part` grows by whole blocks and `name.part.json` says how far it has come, from which settings
it is made, and the check sum of what is there. A block depends on nothing but the settings and its number, so that a
file that was resumed has the bytes of one that was not.
"""

from __future__ import annotations

import contextlib
import errno
import json
import os
import stat
import zlib
from collections.abc import Callable, Generator, Iterator
from pathlib import Path
from typing import Any

from robokin.errors import InputError, OutputError
from robokin.files import open_path, read_up_to
from robokin.jobs.ordered_map import ordered_map
from robokin.reports.sample_rows import BLOCK, Samples
from robokin.tables.sink import Destination
from robokin.tables.text_source import Say
from robokin.unfinished_work import UNFINISHED, in_order

MOST_OF_A_STATE = 1 << 16
"""Bytes of `name.part.json`: it has a few hundred."""

PIECE = 1 << 20
"""Bytes read at once of what is gone on with."""


def write_samples(
    output: str,
    samples: Samples,
    cores: int | None = None,
    resume: bool = False,
    progress: Callable[[int, int], None] | None = None,
    say: Say | None = None,
) -> int:
    """Write a file of samples; the number of them that were written before, by a run that is resumed.

    `progress` is told, after every block, how many samples of how many there are. With `resume` the unfinished
    file of an earlier run is gone on with, if there is one. A pipe or a device is written as it is. Raises OutputError
    for a place that cannot be written, and InputError when the unfinished file is of other settings or was changed.
    A full disk and Ctrl-C keep the whole blocks; `say` is told so where no error says it.
    """
    total = samples.count  # what is wrong with the samples is said before a file is touched
    place = Destination(output, "--output")
    if place.special and resume:
        raise InputError(f"--resume: {output} is a pipe or a device, expected a file")
    with (
        in_order(),
        _straight(place, samples) if place.special else _Part.opened(output, place.path, samples, resume, say) as part,
    ):
        before = part.done
        first = -(-part.done // BLOCK)
        blocks = ordered_map(samples.block, range(first, -(-total // BLOCK)), cores)
        with contextlib.closing(_closable(blocks)) as whole:
            for data in whole:
                part.append(data, min(part.done + BLOCK, total))
                if progress is not None:
                    progress(part.done, total)
        part.finish()
    return before


def _closable(blocks: Iterator[bytes]) -> Generator[bytes, None, None]:
    """The blocks as a generator, whose end ends the workers even where an error holds on to them."""
    yield from blocks


class _Part:
    """The unfinished file: `done` samples in `size` bytes with the CRC-32 `sum` are whole, whatever stands behind."""

    def __init__(self, output: str, path: Path, samples: Samples, number: int) -> None:
        self.output, self.path, self.samples, self.number = output, path, samples, number
        self.settings = samples.settings()
        self.part = path.with_name(f"{path.name}.part")
        self.side = path.with_name(f"{path.name}.part.json")
        self.fresh = path.with_name(f"{path.name}.part.json.new")
        self.done = self.size = self.sum = 0

    @classmethod
    @contextlib.contextmanager
    def opened(cls, output: str, path: Path, samples: Samples, resume: bool, say: Say | None) -> Iterator[_Part]:
        """An unfinished file to append to; whatever ends the work early, its whole blocks are kept."""
        part = path.with_name(f"{path.name}.part")
        if not os.path.lexists(part):
            UNFINISHED.add(str(part))  # until there is a block in it
        number = _file_to_change(part, output)
        unfinished = cls(output, path, samples, number)
        try:
            unfinished._lock()
            found = unfinished._found() if resume else None
            try:
                UNFINISHED.add(str(unfinished.fresh))
                unfinished._begin(found, samples.header())
                yield unfinished
            except BaseException as error:
                sentence = unfinished._keep(samples.count)
                if isinstance(error, OSError):
                    raise OutputError(f"--output {output}: {error.strerror}, {sentence}") from None
                if say is not None and isinstance(error, KeyboardInterrupt | SystemExit):
                    say(f"--output {output}: {sentence}")
                raise
        finally:
            os.close(number)
            UNFINISHED.difference_update({str(part), str(unfinished.fresh)})

    def _lock(self) -> None:
        """Two runs must not write the same file; where the system knows no locks, that is the user's care."""
        with contextlib.suppress(ImportError):
            import fcntl

            try:
                fcntl.flock(self.number, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                raise OutputError(
                    f"--output {self.output}: another run is writing {self.part.name}, expected it to be done"
                ) from None
            except OSError:
                pass  # a file system without locks

    def _found(self) -> dict[str, int] | None:
        """How far an earlier run has come; None when it has not begun.

        Raises InputError for other settings, and for a file that does not hold what the earlier run wrote.
        """
        name = self.part.name
        if not os.fstat(self.number).st_size:
            return None
        wrong = InputError(
            f"--resume: {name} is not the beginning of this file, expected what a run left that was interrupted; "
            "without --resume it is written anew"
        )
        state = self._state()
        if state is None:
            raise wrong
        for key, value in self.settings.items():
            before = state["settings"].get(key)
            if before == value:
                continue
            if key in ("table", "block"):
                raise InputError(
                    f"--resume: {name} was made from another description of {self.settings['robot']}, "
                    "expected the same one, or no --resume"
                )
            said = json.dumps(before)[:40] if isinstance(before, dict | list) else before
            raise InputError(f"--resume: {name} was made with {key} {said}, found {value}, expected the same")
        if not self._holds(state):
            raise wrong
        return {key: state[key] for key in ("done", "size", "sum")}

    def _state(self) -> dict[str, Any] | None:
        """What the side file says; None where it does not say it as this program does."""
        expected = "what a run left that was interrupted"
        try:
            if not self.side.is_file():
                return None
            with open_path(str(self.side), expected) as stream:
                data = read_up_to(stream, self.side.name, MOST_OF_A_STATE, expected)
            state = json.loads(data) if len(data) <= MOST_OF_A_STATE else None
        except (OSError, InputError, ValueError, RecursionError):
            return None
        if not isinstance(state, dict) or not isinstance(state.get("settings"), dict):
            return None
        # True is an int, but no number of samples.
        whole = all(type(state.get(key)) is int and state[key] >= 0 for key in ("done", "size", "sum"))
        return state if whole else None

    def _holds(self, state: dict[str, Any]) -> bool:
        """Whether the file begins with as many samples, and with the bytes, that the side file says."""
        header, done, size = self.samples.header(), state["done"], state["size"]
        if done > self.samples.count or (done % BLOCK and done != self.samples.count):
            return False
        left, found, rows = size, 0, -header.count(b"\n")
        os.lseek(self.number, 0, os.SEEK_SET)
        start = b""
        while left and (piece := os.read(self.number, min(left, PIECE))):
            start = start or piece[: len(header)]
            left, found, rows = left - len(piece), zlib.crc32(piece, found), rows + piece.count(b"\n")
        if self.samples.kind in ("npy", "ply"):
            rows = (size - len(header)) // (8 * len(self.samples.columns))
        begun = size >= len(header) and start == header and rows == done
        return not left and found == state["sum"] and (begun or not done)

    def _begin(self, found: dict[str, int] | None, header: bytes) -> None:
        if found is not None and found["size"] >= len(header):
            self.done, self.size, self.sum = found["done"], found["size"], found["sum"]
            os.ftruncate(self.number, self.size)
            return
        # At no moment is there a part that the side file does not explain.
        os.ftruncate(self.number, 0)
        self._record(0, b"")
        self.append(header, 0)

    def append(self, data: bytes, done: int) -> None:
        """Add a block, after which `done` samples are whole."""
        os.lseek(self.number, self.size, os.SEEK_SET)
        rest = memoryview(data)
        while rest:
            rest = rest[os.write(self.number, rest) :]
        self._record(done, data)

    def _record(self, done: int, data: bytes) -> None:
        """Say in the side file, which is replaced as a whole, how far the work has come with this block."""
        size, check = self.size + len(data), zlib.crc32(data, self.sum)
        state = {"settings": self.settings, "done": done, "size": size, "sum": check}
        self.fresh.write_text(json.dumps(state) + "\n", encoding="utf-8")
        self.fresh.replace(self.side)
        self.done, self.size, self.sum = done, size, check
        if done:
            UNFINISHED.discard(str(self.part))

    def _keep(self, count: int) -> str:
        """Cut off what is not whole; a sentence that says what is kept. Nothing is left where nothing is whole."""
        _remove(self.fresh)
        # What the side file says counts: an interruption may have come just after it was written.
        state = self._state() or {"done": 0, "size": 0}
        if not state["done"]:
            _remove(self.part)
            _remove(self.side)
            return "nothing was written"
        with contextlib.suppress(OSError):
            os.ftruncate(self.number, state["size"])
        return f"{state['done']:,} of {count:,} samples are kept in {self.part.name}, --resume goes on from there"

    def finish(self) -> None:
        """Give the file its name."""
        self.part.replace(self.path)
        self.side.unlink(missing_ok=True)


def _remove(path: Path) -> None:
    """Remove a file if it is there; a name that is too long for the system was never one."""
    with contextlib.suppress(OSError):
        path.unlink(missing_ok=True)


def _file_to_change(part: Path, output: str) -> int:
    """The descriptor of a regular file, which is made where there is none. Raises OutputError."""
    safe = getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
    try:
        number = os.open(part, os.O_RDWR | os.O_CREAT | safe, 0o666)
    except OSError as error:
        linked = error.errno == errno.ELOOP
        reason = f"{part.name} is a link" if linked else error.strerror
        raise OutputError(f"--output {output}: {reason}, expected a place that can be written") from None
    if not stat.S_ISREG(os.fstat(number).st_mode):
        os.close(number)
        raise OutputError(f"--output {output}: {part.name} is no file, expected a place that can be written")
    return number


class _Straight:
    """A pipe or a device: blocks go out as they come, and nothing can be resumed."""

    def __init__(self, stream: Any) -> None:
        self.stream, self.done = stream, 0

    def append(self, data: bytes, done: int) -> None:
        """Write a block, after which `done` samples are whole."""
        self.stream.write(data)
        self.done = done

    def finish(self) -> None:
        """Write the rest."""
        self.stream.flush()


@contextlib.contextmanager
def _straight(place: Destination, samples: Samples) -> Iterator[_Straight]:
    try:
        with place.straight() as stream:
            stream.write(samples.header())
            yield _Straight(stream)
    except BrokenPipeError:
        raise  # whoever reads has what it wants
    except OSError as error:
        raise place.refusal(str(error.strerror)) from None
