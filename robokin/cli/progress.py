"""A bar on stderr that tells how far long work has come."""

from __future__ import annotations

import contextlib
import sys
import time

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

    def __enter__(self) -> Progress:
        """The bar, not yet shown."""
        return self

    def __exit__(self, *error: object) -> None:
        """Wipe the bar out."""
        if self.shown:
            self._write("\r\033[K")

    def told(self, done: int, total: int) -> None:
        """`done` of `total` are done."""
        now = time.monotonic()
        if self.first is None:
            self.first, self.began = done, now  # what was there before took no time
        if now - self.began < PATIENCE or now - self.shown < REST or not _terminal():
            return
        self.shown = now
        rate = (done - self.first) / (now - self.began)
        left = (total - done) / rate if rate else 0.0
        full = round(WIDTH * done / total) if total else WIDTH
        bar = "━" * full + "╌" * (WIDTH - full)
        self._write(f"\r\033[K{bar} {done:,} of {total:,} {self.noun}, {left:.0f} s left")

    def _write(self, text: str) -> None:
        with contextlib.suppress(OSError, ValueError):
            sys.stderr.write(text)
            sys.stderr.flush()


def _terminal() -> bool:
    return sys.stderr is not None and sys.stderr.isatty()
