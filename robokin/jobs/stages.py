"""Where long work has come to, for whoever shows it: its stages by name, and how much of the present one is done.

The work says what it does (`stage`), and maps of blocks count themselves; with nobody listening both cost nothing.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from contextvars import ContextVar
from dataclasses import dataclass, field
from typing import TypeVar

T = TypeVar("T")


@dataclass
class Work:
    """done: the stages that are over; now: the present one; part: how much of its present step is done, if known."""

    done: list[str] = field(default_factory=list)
    now: str = ""
    part: tuple[int, int] | None = None
    about: str = ""

    def begin(self, words: str) -> None:
        """The present stage is over, and another begins."""
        if self.now and (not self.done or self.done[-1] != self.now):
            self.done.append(self.now)
        self.now, self.part = f"{self.about}{words}", None


_listening: ContextVar[Work | None] = ContextVar("listening", default=None)


@contextlib.contextmanager
def followed() -> Iterator[Work]:
    """The work that is done within, as far as it has come."""
    work = Work()
    token = _listening.set(work)
    try:
        yield work
    finally:
        _listening.reset(token)


def stage(words: str) -> None:
    """A stage begins: what is found in it, as a noun."""
    work = _listening.get()
    if work is not None:
        work.begin(words)


def about(words: str) -> None:
    """What the following stages are about, to tell them from those before."""
    work = _listening.get()
    if work is not None:
        work.about = f"{words}: " if words else ""


def counted(results: Iterator[T], total: int | None) -> Iterator[T]:
    """Results as they are, counted as parts of the present stage; total: how many there will be, if known."""
    work = _listening.get()
    return results if work is None or not total else _counted(work, results, total)


def _counted(work: Work, results: Iterator[T], total: int) -> Iterator[T]:
    work.part = 0, total
    for number, result in enumerate(results, start=1):
        work.part = number, total
        yield result
