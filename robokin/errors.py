"""What can go wrong, said in a sentence that ends with what would have been right.

Every error a user can cause is a `RobokinError`. The command line prints its sentence and ends with
status 2; from Python an `InputError` is also a `ValueError`.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import islice

MAX_SHOWN = 60
"""Characters of what was given that a message repeats."""

MAX_LISTED = 20
"""Mistakes of a description that a text lists; who has more mends these first."""

NEAR = 0.7
"""Likeness (0 to 1) from which a known name is worth a suggestion: one letter of four may be another, and "alpah" for
"alpha" is 0.8; "quat" for "q" or "forward" for "frame" are no slips of the key."""


class RobokinError(Exception):
    """Something robokin was asked to do cannot be done; the message is a whole sentence."""


class InputError(RobokinError, ValueError):
    """What was given is wrong: a name, a number, a shape, a file."""


class InputTypeError(InputError, TypeError):
    """What was given is of the wrong type: a string where a robot is expected, say."""


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
    """A description is wrong at one known place or at several.

    The first place is `message`, `line` and `column` (both count from 1), `width` the characters that are meant there;
    `excerpt` shows the line with the place marked below it, "" where no text is at hand. `others` are the mistakes
    at the places after it. The text has them all: `file:line:column: found …, expected …`, then the excerpt, for each.
    """

    def __init__(self, message: str, file: str = "", line: int = 0, column: int = 0, width: int = 1) -> None:
        super().__init__(message)
        self.message = message
        self.file = file
        self.line = line
        self.column = column
        self.width = width
        self.excerpt = ""
        self.others: tuple[DescriptionError, ...] = ()

    @property
    def sentence(self) -> str:
        """The first mistake on one line: `file:line:column: message`, as editors and compilers write it."""
        return placed(self.message, self.file, self.line, self.column)

    @property
    def errors(self) -> tuple[DescriptionError, ...]:
        """Every mistake, in the order of the file."""
        return (self, *self.others)

    def __str__(self) -> str:
        """Every mistake with its line, as far as `MAX_LISTED`."""
        parts = ["\n".join(filter(None, (error.sentence, error.excerpt))) for error in self.errors[:MAX_LISTED]]
        more = len(self.errors) - MAX_LISTED
        return "\n".join([*parts, f"and {more} more"] if more > 0 else parts)


@dataclass(frozen=True)
class Note:
    """What looks wrong in a description that can be read; line and column count from 1."""

    message: str
    file: str = ""
    line: int = 0
    column: int = 0

    def __str__(self) -> str:
        """`file:line:column: message`."""
        return placed(self.message, self.file, self.line, self.column)


def placed(message: str, file: str, line: int, column: int) -> str:
    """`file:line:column: message`."""
    place = ":".join(str(part) for part in (visible(file), line, column) if part)
    return f"{place}: {message}" if place else message


MOST_KNOWN = 2000
"""Names that are compared with a wrong one; only a hostile file has more."""

WHOLE_START = 3
"""Letters from which the start of a name counts as near to it."""


def shown(text: str, most: int = MAX_SHOWN) -> str:
    """A text as a message repeats it: on one line, of at most `most` characters, nothing that steers a terminal."""
    start = " ".join(text[: 2 * most].split())
    cut = start[: most - 3] + "..." if len(start) > most or len(text) > 2 * most else start
    return visible(cut)


def visible(text: str, lines: bool = False) -> str:
    """A text with all that would steer a terminal, or the order in which letters are read, written as `\\x1b`.

    `lines` keeps line breaks.
    """
    if text.isprintable() or (lines and text.replace("\n", "").isprintable()):
        return text
    from unicodedata import category  # hardly any text needs it

    return "".join(
        c if c.isprintable() or category(c) == "Zs" or (lines and c == "\n") else c.encode("unicode_escape").decode()
        for c in text
    )


def nearest(name: str, known: Iterable[str], count: int = 3) -> list[str]:
    """The `count` known names that `name` may be a slip of, best first; empty where there is none.

    A name that goes on where the other stops (`puma560` for `puma`), or that differs in one character, is near too.
    """
    import difflib  # only a user who mistyped pays for it

    if len(name) > MAX_SHOWN:  # no name is so long, and the comparison takes its time
        return []
    fold = name.casefold()
    by_fold = {candidate.casefold(): candidate for candidate in islice(known, MOST_KNOWN)}
    close = difflib.get_close_matches(fold, by_fold, n=count, cutoff=NEAR)
    close += sorted((other for other in by_fold if other not in close and _one_off(fold, other)), key=len)
    return [by_fold[match] for match in close[:count]]


def _one_off(name: str, other: str) -> bool:
    """Whether one of the names goes on where the other stops, or they differ in one character."""
    if len(name) == len(other) > 1:
        return sum(a != b for a, b in zip(name, other, strict=True)) == 1
    shorter = min(len(name.lstrip("-")), len(other.lstrip("-")))
    return shorter >= WHOLE_START and (other.startswith(name) or name.startswith(other))


def counted(number: int, noun: str) -> str:
    """`1 value`, `2 values`."""
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def or_list(names: Iterable[str]) -> str:
    """`a, b or c`."""
    items = list(names)
    return items[0] if len(items) == 1 else f"{', '.join(items[:-1])} or {items[-1]}" if items else ""


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """`; did you mean 'a' or 'b'?`, or nothing when no known name is near."""
    close = nearest(name, known)
    return f"; did you mean {or_list(repr(match) for match in close)}?" if close else ""
