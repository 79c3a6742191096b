"""Pages without colour, as they go into files and pipes: what Rich would draw, without loading it.

Only of letters that take one column each: of others Rich is asked.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from robokin.errors import visible
from robokin.reports.page_parts import WIDTH, Fitted, Heading, Table

NARROW = re.compile("[ -~\u00a0-\u00ac\u00ae-\u02ff\u0391-\u03c9\u2010-\u2027\u2212\u2500-\u257f]*")
"""Texts whose letters all take one column: Latin and Greek ones, dashes, quotation marks, rules."""

WORD = re.compile(r"\s*\S+\s*")
"""A word with the blanks around it."""


def width_of(text: str) -> int:
    """The columns that a text takes on a terminal."""
    if NARROW.fullmatch(text):
        return len(text)
    from rich.cells import cell_len

    return cell_len(text)


def plain_page(parts: Sequence[Fitted]) -> str | None:
    """The parts one below the other; None where Rich must draw them."""
    lines: list[str] = []
    for part, gap, widths in parts:
        if isinstance(part, Table):
            lines += _table_lines(part, gap, widths)
        elif isinstance(part, Heading):
            apart = "  " if len(part.text) + len(part.rest) + 2 <= WIDTH else "\n"
            lines.append(part.text + (apart + part.rest if part.rest else ""))
        else:
            lines.append(visible(part, lines=True))
    page = "\n".join([*lines, ""])
    return page if all(NARROW.fullmatch(line) for line in page.split("\n")) else None


def _table_lines(part: Table, gap: int, widths: Sequence[int]) -> Iterator[str]:
    """A table's lines: its headings above a rule, its rows, each as high as its highest cell."""
    blanks = " " * gap
    sides = [column.justify for column in part.columns]
    if part.headed:
        yield from _row_lines([column.header for column in part.columns], sides, widths, blanks, below=True)
        yield "─" * (sum(widths) + gap * (len(widths) - 1))
    for i, (cells, _) in enumerate(part.rows, start=1):
        whole = [*cells, *[""] * (len(widths) - len(cells))]
        yield from _row_lines(whole, sides, widths, blanks)
        if part.headed and i in part.sections and i < len(part.rows):
            yield ""


def _row_lines(
    cells: Sequence[str], sides: Sequence[str], widths: Sequence[int], blanks: str, below: bool = False
) -> Iterator[str]:
    """The lines of a row; where cells have fewer than others they stand above, or `below`."""
    columns = [_wrapped(cell, width) for cell, width in zip(cells, widths, strict=True)]
    high = max(map(len, columns), default=0)
    for column, side, width in zip(columns, sides, widths, strict=True):
        more = [""] * (high - len(column))
        placed = [*more, *column] if below else [*column, *more]
        column[:] = [line.rstrip().rjust(width) if side == "right" else line[:width].ljust(width) for line in placed]
    yield from map(blanks.join, zip(*columns, strict=True))


def _wrapped(text: str, width: int) -> list[str]:
    """A text in lines of at most a width, broken between words, and within those that are longer."""
    if len(text) <= width:
        return [text]
    lines = [""]
    for word in WORD.findall(text):
        letters = len(word.rstrip())
        if len(lines[-1]) + letters <= width:
            lines[-1] += word
        elif letters <= width:
            lines.append(word)
        else:
            pieces = [word[k : k + width] for k in range(0, len(word), width)]
            lines = [*lines, *pieces] if lines[0] else pieces
    return [line.rstrip() if len(line) > width else line for line in lines]
