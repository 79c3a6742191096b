"""What stderr says while long work goes on: a bar for what can be counted, or the stage that it has come to."""

from __future__ import annotations

import contextlib
import shutil
import sys
import threading
import time

from robokin.jobs.stages import followed
from robokin.unfinished_work import in_order

PATIENCE = 1.0
"""Seconds of work before the bar appears: what is shorter needs none."""

REST = 0.2
"""Seconds between two states of the bar."""

WIDTH = 30


class Progress:
    """Shows how much is done, on a terminal only, and wipes itself out at the end."""

    def __init__(self, noun: str) -> None:
        self.noun = noun
        self.began = time.monotonic()
        self.shown = 0.0
        self.first: int | None = None
        self.interrupted = in_order()

    def __enter__(self) -> Progress:
        """The bar, not yet shown."""
        self.interrupted.__enter__()
        return self

    def __exit__(self, *error: object) -> None:
        """Wipe the bar out."""
        if self.shown:
            _write("\r\033[K")
        self.interrupted.__exit__(None, None, None)

    def told(self, done: int, total: int | None) -> None:
        """`done` of `total` are done; None where nobody knows how many there will be."""
        now = time.monotonic()
        if self.first is None:
            self.first, self.began = done, now  # what was there before took no time
        if now - self.began < PATIENCE or now - self.shown < REST or not _terminal():
            return
        self.shown = now
        if total is None:
            _write(f"\r\033[K{done:,} {self.noun}, {now - self.began:.0f} s")
            return
        rate = (done - self.first) / (now - self.began)
        left = (total - done) / rate if rate else 0.0
        full = round(WIDTH * done / total) if total else WIDTH
        bar = "━" * full + "╌" * (WIDTH - full)
        _write(f"\r\033[K{bar} {done:,} of {total:,} {self.noun}, {left:.0f} s left")


class Stages:
    """Shows the stage that work has come to, on a terminal only, and wipes itself out at the end.

    Work that is interrupted says which stages were done.
    """

    def __init__(self) -> None:
        self.began = time.monotonic()
        self.over = threading.Event()
        self.followed = followed()
        self.thread: threading.Thread | None = None
        self.interrupted = in_order()

    def __enter__(self) -> Stages:
        """Begin to follow what is done within."""
        self.interrupted.__enter__()
        self.work = self.followed.__enter__()
        if _terminal():
            self.thread = threading.Thread(target=self._show, daemon=True)
            self.thread.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, *error: object) -> None:
        """Wipe the line out; after Ctrl-C say what was done."""
        self.over.set()
        if self.thread is not None:
            self.thread.join()
        self.followed.__exit__(None, None, None)
        if kind is not None and issubclass(kind, KeyboardInterrupt):
            from robokin.cli.statuses import say

            say(f"after {time.monotonic() - self.began:.0f} s: {self._state()}")
        self.interrupted.__exit__(None, None, None)

    def _state(self) -> str:
        done, now = ", ".join(self.work.done) or "nothing", self.work.now
        return f"done: {done}; not done: {now}{self._part()}" if now else f"done: {done}"

    def _part(self) -> str:
        part = self.work.part
        return f" ({part[0]} of {part[1]} parts)" if part is not None and part[1] > 1 else ""

    def _show(self) -> None:
        shown = False
        wait = PATIENCE
        while not self.over.wait(wait):
            wait, shown = REST, True
            seconds = time.monotonic() - self.began
            text = f"{self.work.now}{self._part()}, {seconds:.0f} s"
            _write(f"\r\033[K{text[: shutil.get_terminal_size().columns - 1]}")
        if shown:
            _write("\r\033[K")


def _write(text: str) -> None:
    with contextlib.suppress(OSError, ValueError):
        sys.stderr.write(text)
        sys.stderr.flush()


def _terminal() -> bool:
    return sys.stderr is not None and sys.stderr.isatty()
