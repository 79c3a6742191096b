"""A row of a pasted table."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class PastedRow:
    """The cells of a row, and its line in the text (from 1)."""

    line: int
    cells: tuple[str, ...]
