"""Tables for eyes, drawn by Rich. Off a terminal they have no colour and are never cut short."""

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

WIDTH = 80
"""Columns of a page when nobody's terminal says otherwise."""


def table(title: str = "", caption: str = "") -> Table:
    """An empty table in the house's style."""
    return Table(
        title=title or None,
        caption=caption or None,
        box=box.SIMPLE_HEAD,
        title_justify="left",
        caption_justify="left",
        title_style="bold",
        caption_style="dim",
        header_style="bold",
        pad_edge=False,
        show_edge=False,
    )


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
    """A line that says what follows."""
    line = Text(text, style="bold")
    if rest:
        line.append(f"  {rest}", style="not bold dim")
    return line


def render(*parts: Table | Text | str) -> bytes:
    """The parts one below the other, as standard output takes them."""
    terminal = sys.stdout.isatty()
    text = io.StringIO()
    console = Console(file=text, force_terminal=terminal, width=None if terminal else WIDTH, highlight=False)
    if not terminal:
        console.no_color = True
    for part in parts:
        drawn = Text(part) if isinstance(part, str) else part
        # Numbers are never cut: a table that needs more room gets it, and a narrow terminal wraps lines.
        least = Measurement.get(console, console.options.update(max_width=10_000), drawn).minimum
        width = max(console.width, least) if isinstance(drawn, Table) else console.width
        console.print(drawn, width=width, soft_wrap=isinstance(drawn, Text) and not terminal)
    # Rich pads cells up to the edge; what is copied from a terminal should have no blanks at its end.
    lines = text.getvalue().split("\n")
    return "\n".join(line if terminal else line.rstrip() for line in lines).encode()
