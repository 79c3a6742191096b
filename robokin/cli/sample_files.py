"""Files of sampled positions, of any number of samples in constant memory; what is interrupted can be resumed.

While it is made, `name.part` grows by whole blocks and `name.part.json` says how far it has come and from which
settings it is made. A block depends on nothing but the settings and its number, so that a file that was resumed has the
bytes of one that was not.
"""

from __future__ import annotations

import contextlib
import json
import os
from collections.abc import Callable, Generator, Iterator
from pathlib import Path
from typing import Any

from robokin.cli.sample_rows import BLOCK, Samples
from robokin.errors import InputError, OutputError
from robokin.workspace.parallel import in_order


def write_samples(
    output: str,
    samples: Samples,
    cores: int | None = None,
    resume: bool = False,
    progress: Callable[[int, int], None] | None = None,
) -> int:
    """Write a file of samples; the number of them that were written before, by a run that is resumed.

    `progress` is told, after every block, how many samples of how many there are. With `resume` the unfinished
    file of an earlier run is gone on with, if there is one. Raises OutputError for a place that cannot be
    written, and InputError when the unfinished file is of other settings. A full disk and Ctrl-C keep the whole
    blocks, and say so.
    """
    total = samples.count  # what is wrong with the samples is said before a file is touched
    # A link stays a link: what it points to is replaced.
    path = Path(os.path.realpath(output))
    if path.is_dir():
        raise OutputError(f"--output {output}: found a directory, expected a place that can be written")
    with _Part.opened(output, path, samples, resume) as part:
        before = part.done
        first = -(-part.done // BLOCK)
        blocks = in_order(samples.block, range(first, -(-total // BLOCK)), cores)
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
    """The unfinished file: `done` samples in `size` bytes are whole, whatever stands behind them."""

    def __init__(self, output: str, path: Path, settings: dict[str, Any], number: int) -> None:
        self.output, self.path, self.settings, self.number = output, path, settings, number
        self.part = path.with_name(f"{path.name}.part")
        self.side = path.with_name(f"{path.name}.part.json")
        self.done = self.size = 0

    @classmethod
    @contextlib.contextmanager
    def opened(cls, output: str, path: Path, samples: Samples, resume: bool) -> Iterator[_Part]:
        """An unfinished file to append to; whatever ends the work early, its whole blocks are kept."""
        part = path.with_name(f"{path.name}.part")
        try:
            number = os.open(part, os.O_RDWR | os.O_CREAT | getattr(os, "O_BINARY", 0), 0o666)
        except OSError as error:
            raise OutputError(f"--output {output}: {error.strerror}, expected a place that can be written") from None
        unfinished = cls(output, path, samples.settings(), number)
        try:
            unfinished._lock()
            found = unfinished._found() if resume else None
            try:
                unfinished._begin(found, samples.header())
                yield unfinished
            except BaseException as error:
                sentence = unfinished._keep(samples.count)
                if isinstance(error, OSError):
                    raise OutputError(f"--output {output}: {error.strerror}, {sentence}") from None
                if isinstance(error, KeyboardInterrupt | SystemExit):
                    from robokin.cli import say

                    say(f"--output {output}: {sentence}")
                raise
        finally:
            os.close(number)

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

    def _found(self) -> dict[str, Any] | None:
        """How far an earlier run has come; None when it has not begun. Raises InputError for other settings."""
        name = self.part.name
        if not os.fstat(self.number).st_size:
            return None
        wrong = f"--resume: {name} is not the beginning of this file, expected what a run left that was interrupted"
        try:
            state = json.loads(self.side.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            raise InputError(wrong) from None
        shape = isinstance(state, dict) and isinstance(state.get("settings"), dict)
        if not shape or not all(isinstance(state.get(key), int) and state[key] >= 0 for key in ("done", "size")):
            raise InputError(wrong)
        for key, value in self.settings.items():
            before = state["settings"].get(key)
            if before == value:
                continue
            if key in ("table", "block"):
                raise InputError(
                    f"--resume: {name} was made from another description of {self.settings['robot']}, "
                    "expected the same one, or no --resume"
                )
            raise InputError(f"--resume: {name} was made with {key} {before}, found {value}, expected the same")
        if state["size"] > os.fstat(self.number).st_size:
            raise InputError(wrong)
        return dict(state)

    def _begin(self, found: dict[str, Any] | None, header: bytes) -> None:
        if found is not None and found["size"] >= len(header):
            self.done, self.size = found["done"], found["size"]
            os.ftruncate(self.number, self.size)
            return
        # At no moment is there a part that the side file does not explain.
        os.ftruncate(self.number, 0)
        self._record(0, 0)
        self.append(header, 0)

    def append(self, data: bytes, done: int) -> None:
        """Add a block, after which `done` samples are whole."""
        os.lseek(self.number, self.size, os.SEEK_SET)
        rest = memoryview(data)
        while rest:
            rest = rest[os.write(self.number, rest) :]
        self._record(done, self.size + len(data))

    def _record(self, done: int, size: int) -> None:
        """Say in the side file, which is replaced as a whole, how far the work has come."""
        fresh = self.side.with_name(f"{self.side.name}.new")
        fresh.write_text(json.dumps({"settings": self.settings, "done": done, "size": size}) + "\n", encoding="utf-8")
        fresh.replace(self.side)
        self.done, self.size = done, size

    def _keep(self, count: int) -> str:
        """Cut off what is not whole; a sentence that says what is kept. Nothing is left where nothing is whole."""
        self.side.with_name(f"{self.side.name}.new").unlink(missing_ok=True)
        done = size = 0
        with contextlib.suppress(OSError, ValueError):
            # What the side file says counts: an interruption may have come just after it was written.
            state = json.loads(self.side.read_text(encoding="utf-8"))
            done, size = state["done"], state["size"]
        if not done:
            self.part.unlink(missing_ok=True)
            self.side.unlink(missing_ok=True)
            return "nothing was written"
        with contextlib.suppress(OSError):
            os.ftruncate(self.number, size)
        return f"{done:,} of {count:,} samples are kept in {self.part.name}, --resume goes on from there"

    def finish(self) -> None:
        """Give the file its name."""
        self.part.replace(self.path)
        self.side.unlink(missing_ok=True)
