"""Questions as lines: the command line's words, or JSON, to words."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from math import isfinite
from typing import Any

from robokin.errors import InputError, shown
from robokin.json_text import finite, value_in

LONGEST_LINE = 1 << 20
"""Bytes of a line that is read; a longer one is refused."""

OWN = ("id", "words", "command", "robot", "arguments")
"""Keys of a question that are no options."""

SEVERAL = ("q", "to", "at", "point")
"""Options of which each of several vectors is one; of others, rows of numbers are a matrix."""

KEY = re.compile(r"[a-z][a-z0-9]*([-_][a-z0-9]+)*")
QUOTED = re.compile(r"[\"'\\]")


class AskedLine:
    """A question: its words, and whether it has an `id`, which is any value of JSON."""

    def __init__(self) -> None:
        self.words: list[str] = []
        self.numbered = False
        self.id: Any = None

    def read(self, line: bytes) -> bool:
        """Take a line; whether it asks anything: an empty one and one that begins with # do not. Raises InputError."""
        if len(line) > LONGEST_LINE:
            raise InputError(f"found a line of more than {LONGEST_LINE} bytes, expected a question")
        try:
            text = line.decode("utf-8-sig").strip()
        except UnicodeDecodeError as error:
            raise InputError(f"found the byte 0x{line[error.start]:02x}, expected text in UTF-8") from None
        if not text or text[0] == "#":
            return False
        if text[0] == "{":
            self._take(text)
        else:
            self.words = _words(text)
        if self.words[:1] == ["robokin"]:
            del self.words[0]
        if not self.words or self.words[0].startswith("-"):
            raise InputError("a command is missing, expected one such as fk")
        return True

    def _take(self, text: str) -> None:
        try:
            asked = value_in(text)
        except InputError:
            raise
        except (ValueError, RecursionError) as error:
            at = f" at column {error.colno}" if isinstance(error, json.JSONDecodeError) else ""
            raise InputError(f"found no JSON{at}, expected an object, or the words of a command") from None
        if "id" in asked:
            self.numbered, self.id = True, finite(asked["id"])
        self.words = [*_question_words(asked)]


def _words(text: str) -> list[str]:
    """The words of a line, quoted as in a shell."""
    if not QUOTED.search(text):
        return text.split()
    import shlex

    try:
        return shlex.split(text)
    except ValueError:
        raise InputError("found a quotation that does not end, expected its second mark") from None


def _question_words(asked: dict[str, Any]) -> Iterator[str]:
    """The words that a question of JSON stands for. Raises InputError."""
    if "words" in asked:
        words, more = asked["words"], [key for key in asked if key not in ("id", "words")]
        if more:
            raise InputError(f"found '{shown(more[0])}' beside words, expected nothing but an id")
        if not isinstance(words, list) or not all(isinstance(word, str) for word in words):
            raise InputError("words: expected a list of texts")
        yield from words
        return
    command = asked.get("command")
    if not isinstance(command, str) or not command.split():
        raise InputError('a command is missing, expected one such as "command": "fk"')
    yield from command.split()
    arguments = asked.get("arguments") or []
    if not isinstance(arguments, list):
        raise InputError("arguments: expected a list of texts")
    if asked.get("robot") is not None:
        arguments = [asked["robot"], *arguments]
    for key, value in asked.items():
        if key not in OWN:
            yield from _option(key, value)
    words = [_text("arguments", one) for one in arguments]
    if any(word.startswith("-") for word in words):
        yield "--"
    yield from words


def _option(key: str, value: Any) -> Iterator[str]:
    """The words of an option: a flag, or a value, or several."""
    if not KEY.fullmatch(key):
        raise InputError(f"found the key '{shown(key)}', expected the name of an option, such as q or no_limits")
    name = f"--{key.replace('_', '-')}"
    if value is None or value is False:
        return
    if value is True:
        yield name
    elif isinstance(value, dict):
        for one, of_one in value.items():
            yield f"{name}={one}={_vector(key, of_one)}"
    elif isinstance(value, list) and value and isinstance(value[0], list) and key not in SEVERAL:
        yield f"{name}=[{','.join(f'[{_vector(key, row)}]' for row in value)}]"
    elif isinstance(value, list) and value and isinstance(value[0], list | str):
        for one in value:
            yield f"{name}={_vector(key, one)}"
    else:
        yield f"{name}={_vector(key, value)}"


def _vector(key: str, value: Any) -> str:
    """A value as a text: of a list its numbers between commas."""
    if isinstance(value, list):
        return ",".join([_text(key, one) for one in value])
    return _text(key, value)


def _text(key: str, value: Any) -> str:
    if isinstance(value, str):
        return value
    if isinstance(value, int) and not isinstance(value, bool):
        return str(value)
    if isinstance(value, float) and isfinite(value):
        return repr(value)
    raise InputError(f"{key}: found {shown(json.dumps(value))}, expected a text or a number")
