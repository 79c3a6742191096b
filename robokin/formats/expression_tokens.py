"""What expressions are made of: numbers, names and symbols, and what to say of anything else."""

from __future__ import annotations

import re
from dataclasses import dataclass

from robokin.errors import ExpressionError

MAX_LENGTH = 10_000
"""Characters of an expression; a 4×4 matrix of them needs a few hundred."""

TOKEN = re.compile(
    r"(?P<number>(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)(?![\w.])"
    r"|(?P<name>[^\W\d]\w*['′’]*)|(?P<symbol>\*\*|[-+*/(),\[\]])"
)

SPACE = re.compile(r"\s*")

NAME = re.compile(r"[^\W\d]\w*")
"""What a parameter may be called: what `TOKEN` reads as a name, without a prime."""

LOOKALIKES = {
    "−": "-",
    "–": "-",
    "—": "-",
    "·": "*",
    "×": "*",
    "÷": "/",
    "π": "pi",
    "°": "",
    "^": "**",
    ";": ",",
}
"""Characters that a copy from a page brings, and what to write for them."""


@dataclass(slots=True)
class Token:
    """A piece of an expression: kind is number, name, symbol or end."""

    kind: str
    text: str
    position: int


def tokenize(text: str) -> list[Token]:
    """The tokens of an expression, an `end` last. Raises ExpressionError at what is none."""
    if len(text) > MAX_LENGTH:
        raise ExpressionError(f"found an expression of {len(text)} characters, expected at most {MAX_LENGTH}")
    tokens: list[Token] = []
    position = _after_space(text, 0)
    while position < len(text):
        match = TOKEN.match(text, position)
        if match is None:
            raise _unreadable(text, position)
        tokens.append(Token(match.lastgroup or "", match[0], position))
        position = _after_space(text, match.end())
    tokens.append(Token("end", "", len(text)))
    return tokens


def _after_space(text: str, position: int) -> int:
    match = SPACE.match(text, position)
    return match.end() if match else position


def _unreadable(text: str, at: int) -> ExpressionError:
    word = (re.match(r"[\w.]+", text[at:]) or re.match(r".", text[at:], re.DOTALL) or [""])[0]
    if word[:1].isdigit() or word[:1] == ".":
        return ExpressionError(f"found '{word[:40]}', expected a number such as 12, 1.5 or 1e-3", text, at)
    hint = LOOKALIKES.get(word)
    if word == "°":
        return ExpressionError("found '°', expected a bare number: the unit of angles is stated once", text, at)
    if hint is not None:
        return ExpressionError(f"found '{word}', expected '{hint}'", text, at)
    return ExpressionError(f"found {word!r}, expected a number or an expression", text, at)
