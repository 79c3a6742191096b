"""Tables for eyes, drawn by Rich. Off a terminal they have no colour; they are never cut short."""

from __future__ import annotations

import io
import sys
from collections.abc import Sequence

from rich import box
from rich.console import Console
from rich.measure import Measurement
from rich.table import Table
from rich.text import Text

from robokin.cli.output.numbers import show_column
from robokin.cli.output.text import encode

WIDTH = 80
"""Columns of a page when nobody's terminal says otherwise."""


def table() -> Table:
    """An empty table in the house's style."""
    return Table(box=box.SIMPLE_HEAD, header_style="bold", pad_edge=False, show_edge=False)


def narrow_table() -> Table:
    """An empty table with a single blank between its columns, for rows that just fit a page."""
    return Table(box=box.SIMPLE_HEAD, padding=(0, 0), pad_edge=False, show_edge=False, header_style="bold")


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
    drawn = Table(box=None, show_header=False, pad_edge=False, padding=(0, 2, 0, 0))
    drawn.add_column(style="cyan", no_wrap=True)
    drawn.add_column(overflow="fold")
    for name, value in entries:
        drawn.add_row(name, Text(value))
    return drawn


def heading(text: str, rest: str = "") -> Text:
    """A line that says what follows, or two when they are long."""
    line = Text(text, style="bold")
    if rest:
        line.append("  " if len(text) + len(rest) + 2 <= WIDTH else "\n").append(rest, style="not bold dim")
    return line


def render(*parts: Table | Text | str) -> bytes:
    """The parts one below the other, as standard output takes them."""
    terminal = sys.stdout.isatty()
    text = io.StringIO()
    # Names come from files: what they say is text, never a style.
    console = Console(
        file=text,
        force_terminal=terminal,
        width=None if terminal else WIDTH,
        highlight=False,
        markup=False,
        emoji=False,
        legacy_windows=False,
    )
    page = console.width
    for part in parts:
        drawn = Text(part) if isinstance(part, str) else part
        if isinstance(drawn, Table):
            # Nothing is cut: a table that needs more room gets it, and a narrow terminal wraps its lines.
            console.width = max(page, Measurement.get(console, console.options.update(max_width=10_000), drawn).minimum)
        console.print(drawn, soft_wrap=isinstance(drawn, Text) and not terminal)
        console.width = page
    # Rich pads cells up to the edge; what goes into a file should have no blanks at its lines' ends.
    lines = text.getvalue().split("\n")
    return encode("\n".join(line if terminal else line.rstrip() for line in lines))
