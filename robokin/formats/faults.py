"""The mistakes of a description, gathered so that all are said at once.

Who reads a part that can go wrong by itself reads it through `Faults.attempt`; the mistake is kept and reading goes on
with something harmless in its place. What is wrong only because something else is (a cell that names a broken
parameter) raises a `ConsequenceError`, which is not listed.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from typing import ParamSpec, TypeVar

from robokin.errors import DescriptionError
from robokin.formats.excerpts import LINE_BREAK, excerpt

P = ParamSpec("P")
T = TypeVar("T")
V = TypeVar("V")

MOST = 200
"""Mistakes after which reading stops: this is no description, and looking for names that are near takes its time."""

DIGITS = re.compile(r"\d+")


class ConsequenceError(DescriptionError):
    """Wrong only because of a mistake that has been said."""


class Faults:
    """The mistakes of one description so far."""

    def __init__(self) -> None:
        self.found: list[DescriptionError] = []
        self.count = 0
        """How often something could not be read, consequences included: what was read meanwhile is whole if it is
        the same."""
        self._said: set[tuple[int, int, str]] = set()

    def add(self, error: DescriptionError) -> None:
        """Keep a mistake, unless it is only a consequence or stands at this place already.

        What an alias repeats is one mistake: its message differs by the number of a row at most.
        """
        if any(error is known for known in self.found):
            raise error  # it ends the reading
        self.count += 1
        if self._keep(error) and len(self.found) >= MOST:
            self.stop()

    def _keep(self, error: DescriptionError) -> bool:
        key = (error.line, error.column, DIGITS.sub("", error.message))
        if isinstance(error, ConsequenceError) or key in self._said:
            return False
        self._said.add(key)
        self.found.append(error)
        return True

    def attempt(self, otherwise: V, read: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T | V:
        """What `read` gives, or `otherwise` if that is a mistake."""
        try:
            return read(*args, **kwargs)
        except DescriptionError as error:
            self.add(error)
            return otherwise

    def each(self, read: Callable[[T], V], items: Iterable[T]) -> list[V]:
        """What `read` makes of every item. Raises a ConsequenceError where one of them is a mistake."""
        values: list[V] = []
        failed = False
        for item in items:
            try:
                values.append(read(item))
            except DescriptionError as error:
                self.add(error)
                failed = True
        if failed:
            raise ConsequenceError("found a mistake in a part, expected none")
        return values

    def stop(self) -> None:
        """Raise the mistakes there are, if any, as one DescriptionError: the first of the file with the others."""
        if self.found:
            raise self.whole()

    def whole(self) -> DescriptionError:
        """The mistakes there are as one error."""
        first, *others = sorted(self.found, key=lambda error: (error.line, error.column))
        for error in others:
            error.others = ()
        first.others = tuple(others)
        return first

    def ended(self, error: DescriptionError, text: str) -> DescriptionError:
        """The mistakes there are in a text when one has ended its reading, as one error with the lines shown."""
        if not any(error is known for known in self.found):
            self._keep(error)
        lines = LINE_BREAK.split(text.removeprefix("\ufeff"))
        for known in self.found:
            known.excerpt = excerpt(lines, known.line, known.column, known.width)
        return self.whole() if self.found else error
