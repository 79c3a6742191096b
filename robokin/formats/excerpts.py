"""The line of a text that a mistake stands on, with the place marked below it."""

from __future__ import annotations

import re
import unicodedata

LINE_BREAK = re.compile("\r\n|[\n\r\x85\u2028\u2029]")
"""What ends a line in YAML 1.1."""

WIDEST = 100
"""Characters of a line that are shown; a longer one is cut around the place."""

BEFORE = 60
"""Characters before the place that are shown of a line that is cut."""


def excerpt(lines: list[str], line: int, column: int, width: int) -> str:
    """Two lines, `   5 | text` and `     |  ^~~~`; line and column count from 1. "" where there is nothing to show."""
    if not 1 <= line <= len(lines):
        return ""
    text = lines[line - 1]
    at = min(column - 1, len(text))
    start = max(0, at - BEFORE) if len(text) > WIDEST else 0
    end = start + WIDEST
    if not text[start:end].strip():
        return ""
    before, place, after = text[start:at], text[at : min(at + width, end)], text[min(at + width, end) : end]
    before, place, after = (_shown(part) for part in (before, place, after))
    before = "…" + before if start else before
    after = after + "…" if end < len(text) else after
    gutter = f"{line:>4} | "
    mark = "^" + "~" * (_columns(place) - 1)
    return f"{gutter}{(before + place + after).rstrip()}\n{'| ':>{len(gutter)}}{'':{_columns(before)}}{mark}"


def _shown(text: str) -> str:
    """A text as a terminal may have it: nothing that steers it, and of a width that is known."""
    text = text.replace("\t", " ")
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def _columns(text: str) -> int:
    """Columns of a terminal that a text takes."""
    wide = sum(unicodedata.east_asian_width(c) in "WF" for c in text)
    return len(text) + wide - sum(bool(unicodedata.combining(c)) for c in text)
