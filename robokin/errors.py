"""What can go wrong, said in a sentence that ends with what would have been right.

Every error a user can cause is a `RobokinError`. The command line prints its sentence and ends with
status 2; from Python an `InputError` is also a `ValueError`.
"""

from __future__ import annotations

from collections.abc import Iterable

MAX_SHOWN = 60
"""Characters of what was given that a message repeats."""


class RobokinError(Exception):
    """Something robokin was asked to do cannot be done; the message is a whole sentence."""


class InputError(RobokinError, ValueError):
    """What was given is wrong: a name, a number, a shape, a file."""


class OutputError(RobokinError):
    """What was computed cannot be written where it was meant to go."""


class ExpressionError(InputError):
    """An expression cannot be read or has no value.

    `text` is the expression, `position` the index in it where the trouble is, and `parameter` the
    parameter that the expression belongs to, if it does.
    """

    def __init__(self, message: str, text: str = "", position: int = 0, parameter: str = "") -> None:
        super().__init__(message)
        self.message = message
        self.text = text
        self.position = position
        self.parameter = parameter

    def __str__(self) -> str:
        """The sentence, with the place in the expression where it is worth showing."""
        text = " ".join(self.text.split())
        if not text or text in self.message or len(text) > MAX_SHOWN:
            return self.message
        return f"{self.message} (in '{shown(text)}')"


class DescriptionError(InputError):
    """A description is wrong at a known place.

    The message reads `file:line:column: found …, expected …`; lines and columns count from 1.
    """

    def __init__(self, message: str, file: str = "", line: int = 0, column: int = 0) -> None:
        super().__init__(message)
        self.message = message
        self.file = file
        self.line = line
        self.column = column

    def __str__(self) -> str:
        """`file:line:column: message`, as editors and compilers write it."""
        place = ":".join(str(part) for part in (self.file, self.line, self.column) if part)
        return f"{place}: {self.message}" if place else self.message


def shown(text: str, most: int = MAX_SHOWN) -> str:
    """A text as a message repeats it: on one line, of at most `most` characters, nothing that steers a terminal."""
    start = " ".join(text[: 2 * most].split())
    cut = start[: most - 3] + "..." if len(start) > most or len(text) > 2 * most else start
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in cut)


def nearest(name: str, known: Iterable[str], count: int = 3) -> list[str]:
    """The `count` known names that look most like `name`, best first; empty when none does."""
    import difflib  # only a user who mistyped pays for it

    if len(name) > MAX_SHOWN:  # no name is so long, and the comparison takes its time
        return []
    by_fold = {candidate.casefold(): candidate for candidate in known}
    close = difflib.get_close_matches(name.casefold(), by_fold, n=count, cutoff=0.5)
    return [by_fold[match] for match in close]


def or_list(names: Iterable[str]) -> str:
    """`a, b or c`."""
    items = list(names)
    return items[0] if len(items) == 1 else f"{', '.join(items[:-1])} or {items[-1]}" if items else ""


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """`; did you mean 'a' or 'b'?`, or nothing when no known name is near."""
    close = nearest(name, known)
    return f"; did you mean {or_list(repr(match) for match in close)}?" if close else ""
