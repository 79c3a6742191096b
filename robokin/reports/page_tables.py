"""Tables for eyes, drawn by Rich on a terminal. Off it they have no colour; no number in them is ever cut.

How wide each column is, is decided here: Rich would cut the numbers of one column for the words of another.
"""

from __future__ import annotations

import re
import shutil
import sys
from collections.abc import Sequence

from robokin.errors import visible
from robokin.number_text import show_column
from robokin.reports.page_parts import GAPS, WIDTH, Column, Heading, Part, Table
from robokin.reports.plain_pages import plain_page, width_of
from robokin.tables.written_rows import encode

NUMBER = re.compile(r"(?<!\w)\d")
"""The start of a number, which is none within a name such as joint3. Words with it are not broken."""

LONG_WORD = 24
"""Longer words than this may be broken."""


def table() -> Table:
    """An empty table in the house's style."""
    return Table()


def narrow_table() -> Table:
    """An empty table with a single blank between its columns, for rows that just fit a page."""
    return Table(gap=1)


def number_table(columns: Sequence[str], rows: Sequence[Sequence[float]], labels: Sequence[str] = ()) -> Table:
    """Numbers in columns with aligned decimals, each row after its label."""
    drawn = table()
    if labels:
        drawn.add_column("", style="cyan", no_wrap=True)
    for name in columns:
        drawn.add_column(name, justify="right", no_wrap=True)
    shown = [show_column(column) for column in zip(*rows, strict=True)]
    for i, row in enumerate(zip(*shown, strict=True)):
        drawn.add_row(*([labels[i]] if labels else []), *row)
    return drawn


def pairs(entries: Sequence[tuple[str, str]]) -> Table:
    """Names and what belongs to them, in two columns."""
    drawn = Table(gap=2, headed=False)
    drawn.add_column(style="cyan")
    drawn.add_column()
    for name, value in entries:
        drawn.add_row(name, value)
    return drawn


def heading(text: str, rest: str = "") -> Heading:
    """A line that says what follows, or two when they are long."""
    return Heading(visible(text), visible(rest))


def render(*parts: Part) -> bytes:
    """The parts one below the other, as standard output takes them."""
    terminal = sys.stdout is not None and sys.stdout.isatty()
    page = max(shutil.get_terminal_size((WIDTH, 24)).columns if terminal else WIDTH, 1)
    return encode(_text(parts, page, terminal))


def plain_text(*parts: Part) -> str:
    """The same as text of 80 columns without colour, and without the end of the last line."""
    return _text(parts, WIDTH, False).rstrip("\n")


def _text(parts: Sequence[Part], page: int, terminal: bool) -> str:
    fitted = [(part, *_fit(part, page)) if isinstance(part, Table) else (part, 0, []) for part in parts]
    text = None if terminal else plain_page(fitted)
    if text is None:
        from robokin.reports.rich_pages import rich_page

        text = rich_page(fitted, page, terminal)
    # Rich pads cells up to the edge; there should be no blanks at the ends of lines.
    return "\n".join(line if terminal else line.rstrip() for line in text.split("\n"))


def _fit(drawn: Table, page: int) -> tuple[int, list[int]]:
    """The blanks between columns, and each column's width.

    The widest columns that may wrap are wrapped until the table fits the page, but no number is broken; what does not
    fit so has fewer blanks between its columns, and at last more room than the page has.
    """
    spans = [_span(column, [cells[i] for cells, _ in drawn.rows if i < len(cells)])
             for i, column in enumerate(drawn.columns)]  # fmt: skip
    gap, widths = drawn.gap, []
    for gap in (drawn.gap, *(fewer for fewer in GAPS if fewer < drawn.gap)):
        room = page - gap * (len(spans) - 1)
        widths = [most if least >= page else min(most, page) for least, most in spans]
        while sum(widths) > room and (loose := [i for i, (least, _) in enumerate(spans) if widths[i] > least]):
            widths[max(loose, key=widths.__getitem__)] -= 1
        if sum(widths) <= room:
            break
    return gap, widths


def _span(column: Column, cells: Sequence[str]) -> tuple[int, int]:
    """The least and the greatest width of a column, between which its cells wrap without breaking a number."""
    most = max(map(width_of, (column.header, *cells)))
    if column.no_wrap:
        return max(1, most), max(1, most)
    words = {word for text in (column.header, *cells) for word in text.split()}
    widths = [(width_of(word), word) for word in words]
    least = max((width if NUMBER.search(word) else min(width, LONG_WORD) for width, word in widths), default=0)
    if column.max_width is not None:
        most = min(most, column.max_width)
    return max(1, min(least, most)), max(1, most)
