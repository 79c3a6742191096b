"""Marks that `robokin check` wrote, read again: its document, or its JSON lines."""

from __future__ import annotations

import json
from typing import Any

from robokin.errors import InputError
from robokin.files import open_input, read_up_to
from robokin.json_text import value_in

LARGEST = 1 << 30
"""Bytes of a file of marks."""


def read_marks(source: str) -> list[dict[str, Any]]:
    """The marks of a file, each with what the document's head says of it. Raises InputError for what is none."""
    with open_input(source, "marks in JSON") as (stream, name):
        data = read_up_to(stream, name, LARGEST, "marks in JSON")
    expected = "expected the .json or .jsonl of robokin check"
    try:
        text = data.decode("utf-8")
        try:
            documents = [value_in(text)]
        except json.JSONDecodeError:
            documents = [value_in(line) for line in text.splitlines() if line.strip()]
    except InputError as error:
        raise InputError(f"{name}: {error}") from None
    except (ValueError, RecursionError):
        raise InputError(f"{name}: found no JSON, {expected}") from None
    marks: list[dict[str, Any]] = []
    for document in documents:
        if not isinstance(document, dict):
            raise InputError(f"{name}: found no marks, {expected}")
        items = document.get("items", [document])
        head = {key: document.get(key) for key in ("check", "robot")}
        if not isinstance(items, list):
            raise InputError(f"{name}: found no marks, {expected}")
        for item in items:
            if not (isinstance(item, dict) and {"id", "status", "score"} <= item.keys() and _is_score(item["score"])):
                raise InputError(f"{name}: found an item that is no mark, {expected}")
            marks.append(head | item)
    if not marks:
        raise InputError(f"{name}: found no marks, {expected}")
    return marks


def _is_score(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and 0.0 <= value <= 1.0
