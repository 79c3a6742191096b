"""Tables for eyes, drawn by Rich. Off a terminal they have no colour; no number in them is ever cut.

How wide each column is, is decided here: Rich would cut the numbers of one column for the words of another.
"""

from __future__ import annotations

import io
import re
import shutil
import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

from rich import box
from rich.cells import cell_len
from rich.console import Console
from rich.table import Table as RichTable
from rich.text import Text

from robokin.errors import visible
from robokin.number_text import show_column
from robokin.tables.written_rows import encode

WIDTH = 80
"""Columns of a page when nobody's terminal says otherwise."""

GAPS = (3, 2, 1)
"""Blanks between columns; a table that does not fit the page has fewer."""

NUMBER = re.compile(r"(?<!\w)\d")
"""The start of a number, which is none within a name such as joint3. Words with it are not broken."""

LONG_WORD = 24
"""Longer words than this may be broken."""


@dataclass
class Column:
    """A column: its heading, the side at which its cells stand, whether they may be wrapped, how wide they may be."""

    header: str
    justify: Literal["left", "right"] = "left"
    style: str = ""
    no_wrap: bool = False
    max_width: int | None = None


@dataclass
class Table:
    """Rows of texts under headings. `gap` is the number of blanks between columns."""

    gap: int = GAPS[0]
    headed: bool = True
    columns: list[Column] = field(default_factory=list)
    rows: list[tuple[tuple[str, ...], str]] = field(default_factory=list)
    sections: set[int] = field(default_factory=set)
    """Numbers of rows below which there is a blank line."""

    def add_column(
        self, header: str = "", *, justify: Literal["left", "right"] = "left", style: str = "", no_wrap: bool = False,
        max_width: int | None = None,
    ) -> None:  # fmt: skip
        """Add a column."""
        self.columns.append(Column(visible(header), justify, style, no_wrap, max_width))

    def add_row(self, *cells: str, style: str | None = None) -> None:
        """Add a row: a text for each column, in which nothing steers the terminal."""
        self.rows.append((tuple(visible(cell) for cell in cells), style or ""))

    def add_section(self) -> None:
        """Leave a line blank below the rows so far."""
        self.sections.add(len(self.rows))


@dataclass(frozen=True)
class Heading:
    """A line that says what follows, and more about it."""

    text: str
    rest: str


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


def render(*parts: Table | Heading | str) -> bytes:
    """The parts one below the other, as standard output takes them."""
    terminal = sys.stdout is not None and sys.stdout.isatty()
    page = max(shutil.get_terminal_size((WIDTH, 24)).columns if terminal else WIDTH, 1)
    text = io.StringIO()
    # Names come from files: what they say is text, never a style. Without a height Rich takes 80 columns on a terminal
    # that calls itself dumb, and cuts what is wider.
    console = Console(
        file=text, force_terminal=terminal, width=page, height=24, highlight=False, markup=False, emoji=False,
        legacy_windows=False,
    )  # fmt: skip
    for part in parts:
        if isinstance(part, Table):
            gap, widths = _fit(part, page)
            console.width = max(page, sum(widths) + gap * len(widths))
            console.print(_drawn(part, gap, widths))
            console.width = page
        elif isinstance(part, Heading):
            console.print(_line(part, min(page, WIDTH)), soft_wrap=not terminal)
        else:
            console.print(Text(visible(part, lines=True)), soft_wrap=not terminal)
    # Rich pads cells up to the edge; there should be no blanks at the ends of lines.
    lines = text.getvalue().split("\n")
    return encode("\n".join(line if terminal else line.rstrip() for line in lines))


def _line(part: Heading, width: int) -> Text:
    line = Text(part.text, style="bold")
    if part.rest:
        line.append("  " if len(part.text) + len(part.rest) + 2 <= width else "\n").append(part.rest, "not bold dim")
    return line


def _drawn(part: Table, gap: int, widths: Sequence[int]) -> RichTable:
    """The table as Rich draws it, with columns of these widths."""
    # Its line under the headings takes one blank between columns.
    blanks: Any = (0, (gap - 1) // 2, 0, gap // 2) if part.headed else (0, gap, 0, 0)
    drawn = RichTable(
        box=box.SIMPLE_HEAD if part.headed else None, show_header=part.headed, header_style="bold", padding=blanks,
        pad_edge=False, show_edge=False,
    )  # fmt: skip
    for column, width in zip(part.columns, widths, strict=True):
        drawn.add_column(
            Text(column.header), justify=column.justify, style=column.style, width=width, overflow="fold",
            vertical="top",
        )  # fmt: skip
    for i, (cells, style) in enumerate(part.rows, start=1):
        drawn.add_row(*map(Text, cells), style=style, end_section=i in part.sections)
    return drawn


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
    most = max(map(cell_len, (column.header, *cells)))
    if column.no_wrap:
        return max(1, most), max(1, most)
    words = {word for text in (column.header, *cells) for word in text.split()}
    widths = [(cell_len(word), word) for word in words]
    least = max((width if NUMBER.search(word) else min(width, LONG_WORD) for width, word in widths), default=0)
    if column.max_width is not None:
        most = min(most, column.max_width)
    return max(1, min(least, most)), max(1, most)
