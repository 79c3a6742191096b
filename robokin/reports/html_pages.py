"""The parts of a page as HTML, for notebooks: nothing in a text is markup, whoever wrote it."""

from __future__ import annotations

from html import escape

from robokin.errors import counted
from robokin.reports.page_parts import Heading, Part, Table

MOST_ROWS = 50
"""Rows of a table: more are counted below it."""

SIDES = {"left": ' style="text-align: left"', "right": ' style="text-align: right"'}


def html_page(*parts: Part) -> str:
    """Tables, headings and texts below one another; blank lines between them are the notebook's own affair."""
    return "".join(map(_part, parts))


def _part(part: Part) -> str:
    if isinstance(part, Table):
        return html_table(part)
    if isinstance(part, Heading):
        rest = f"<br>{escape(part.rest)}" if part.rest else ""
        return f"<p><b>{escape(part.text)}</b>{rest}</p>"
    if "\n" in part.strip():
        return html_text(part)
    return f"<p>{escape(part)}</p>" if part else ""


def html_text(text: str) -> str:
    """A text whose letters stand below one another, also where a notebook's own style would have it otherwise."""
    return f'<pre style="font-family: monospace; line-height: 1.2">{escape(text)}</pre>'


def html_table(drawn: Table, whole: int | None = None) -> str:
    """A table; `whole` is how many rows there are, if not all were added."""
    sides = [SIDES[column.justify] for column in drawn.columns]
    head = "".join(f"<th{side}>{escape(column.header)}</th>" for side, column in zip(sides, drawn.columns, strict=True))
    body = "".join(
        "<tr>" + "".join(f"<td{side}>{escape(cell)}</td>" for side, cell in zip(sides, cells, strict=False)) + "</tr>"
        for cells, _ in drawn.rows[:MOST_ROWS]
    )
    more = (len(drawn.rows) if whole is None else whole) - min(len(drawn.rows), MOST_ROWS)
    foot = f"<p>and {counted(more, 'row')} more</p>" if more > 0 else ""
    above = f"<thead><tr>{head}</tr></thead>" if drawn.headed else ""
    return f"<table>{above}<tbody>{body}</tbody></table>{foot}"
