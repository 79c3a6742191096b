"""JSON that others wrote, read without a guess: no key stands twice, and nothing is NaN or infinite."""

from __future__ import annotations

import json
from math import isfinite
from typing import Any

from robokin.errors import InputError, shown


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """An object. Raises InputError for a key that stands twice: JSON does not say which of its values holds."""
    made = dict(pairs)
    if len(made) < len(pairs):
        keys = [key for key, _ in pairs]
        twice = next(key for i, key in enumerate(keys) if key in keys[:i])
        raise InputError(f"found the key '{shown(twice)}' twice in an object, expected it once")
    return made


def _no_number(word: str) -> Any:
    raise InputError(f"found {word}, expected a finite number")


DECODER = json.JSONDecoder(object_pairs_hook=_once, parse_constant=_no_number)
"""Raises InputError for what has no meaning, json.JSONDecodeError, ValueError or RecursionError for what is no JSON."""


def value_in(text: str) -> Any:
    """What a JSON text says. Raises as `DECODER` does. Numbers such as 1e999 are infinite: see `finite`."""
    return DECODER.decode(text)


def finite(value: Any) -> Any:
    """A value that is written as it was read. Raises InputError for one that holds a number that is too large."""
    if isinstance(value, float) and not isfinite(value):
        raise InputError("found a number that is too large, expected a finite one")
    if isinstance(value, (dict, list)):
        for one in value.values() if isinstance(value, dict) else value:
            finite(one)
    return value
