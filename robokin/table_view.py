"""A robot's table to look at: what `robokin show` prints, and its rows as plain data."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any, SupportsIndex, overload

from robokin.documents import Document, show
from robokin.errors import counted
from robokin.model import Robot
from robokin.reports.description_tables import row_heading, row_table
from robokin.reports.html_pages import html_page
from robokin.reports.page_parts import Table
from robokin.reports.page_tables import plain_text

MOST_LINES = 5
"""Lines of a table on a console: with more rows than fit some are left out, and `print` has all."""


@dataclass(frozen=True, eq=False, repr=False)
class TableView:
    """The table of a robot in its description's units: a sequence of rows, as `robokin show --json` has them."""

    robot: Robot

    @cached_property
    def _document(self) -> Document:
        return show(self.robot)

    @cached_property
    def _drawn(self) -> Table:
        return row_table(self._document)

    def __len__(self) -> int:
        """The number of rows."""
        return len(self.robot.rows)

    @overload
    def __getitem__(self, i: SupportsIndex) -> dict[str, Any]: ...
    @overload
    def __getitem__(self, i: slice) -> list[dict[str, Any]]: ...
    def __getitem__(self, i: SupportsIndex | slice) -> dict[str, Any] | list[dict[str, Any]]:
        """Row i, or some. Raises IndexError."""
        rows: list[dict[str, Any]] = self._document["rows"]
        return rows[i]

    def __iter__(self) -> Iterator[dict[str, Any]]:
        """The rows from the base on."""
        return iter(self._document["rows"])

    def __str__(self) -> str:
        """The whole table, below what its numbers are in."""
        return plain_text(row_heading(self._document), "", self._drawn)

    def __repr__(self) -> str:
        """The table, or as many of its rows as five lines hold."""
        lines = plain_text(self._drawn).split("\n")
        if len(lines) <= MOST_LINES:
            return "\n".join(lines)
        kept = lines[: MOST_LINES - 1]
        return "\n".join([*kept, f"… {counted(len(lines) - len(kept), 'more row')}: print() shows all"])

    def _repr_html_(self) -> str:
        return html_page(row_heading(self._document), self._drawn)
