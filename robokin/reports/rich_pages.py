"""Pages drawn by Rich: in colour, on a terminal, or with letters that take more room than one."""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import Any

from rich import box
from rich.console import Console
from rich.table import Table as RichTable
from rich.text import Text

from robokin.errors import visible
from robokin.reports.page_parts import WIDTH, Fitted, Heading, Table


def rich_page(parts: Sequence[Fitted], page: int, terminal: bool) -> str:
    """The parts one below the other, on a page of so many columns."""
    text = io.StringIO()
    # Names come from files: what they say is text, never a style. Without a height Rich takes 80 columns on a terminal
    # that calls itself dumb, and cuts what is wider.
    console = Console(
        file=text, force_terminal=terminal, width=page, height=24, highlight=False, markup=False, emoji=False,
        legacy_windows=False,
    )  # fmt: skip
    for part, gap, widths in parts:
        if isinstance(part, Table):
            console.width = max(page, sum(widths) + gap * len(widths))
            console.print(_drawn(part, gap, widths))
            console.width = page
        elif isinstance(part, Heading):
            console.print(_line(part, min(page, WIDTH)), soft_wrap=not terminal)
        else:
            console.print(Text(visible(part, lines=True)), soft_wrap=not terminal)
    return text.getvalue()


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
