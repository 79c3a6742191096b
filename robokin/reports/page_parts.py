"""What a page for eyes is made of: tables of texts, and headings."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from robokin.errors import visible

WIDTH = 80
"""Columns of a page when nobody's terminal says otherwise."""

GAPS = (3, 2, 1)
"""Blanks between columns; a table that does not fit the page has fewer."""


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


Part = Table | Heading | str
"""A part of a page."""

Fitted = tuple[Part, int, list[int]]
"""A part of a page; of a table also the blanks between its columns, and each column's width."""
