"""What `robokin check statistics` prints."""

from __future__ import annotations

from typing import Any

from robokin.errors import counted
from robokin.reports.page_parts import Part
from robokin.reports.page_tables import heading, render, table


def statistics_page(record: dict[str, Any]) -> bytes:
    """The page of a class's statistics, from their document."""
    return render(*statistics_parts(record))


def statistics_parts(record: dict[str, Any]) -> list[Part]:
    """The same as the parts of a page."""
    parts: list[Part] = [heading(f"check statistics: {counted(record['students'], 'student')}", "")]
    parts += ["", question_table(record)]
    if record["mistakes"]:
        parts += ["", mistake_table(record)]
    said = f"{record['right']} of {counted(record['answers'], 'answer')} right, score {record['score']:.2f}"
    if record["wrong"]:
        said += f"; of {record['wrong']} wrong, {record['known']} with a known mistake"
    scores = f"students: lowest {record['lowest']:.2f}, median {record['median']:.2f}, highest {record['highest']:.2f}"
    return [*parts, "", said, scores]


def question_table(record: dict[str, Any]) -> Any:
    """A line for each question: how many were right, and the mistake that was made most often."""
    drawn = table()
    for name, right in (("id", False), ("kind", False), ("about", False), ("right", True), ("of", True),
                        ("blank", True), ("score", True), ("mistake", False)):  # fmt: skip
        drawn.add_column(name, justify="right" if right else "left")
    for one in record["questions"]:
        first = one["mistakes"][0] if one["mistakes"] else None
        most = f"{first['mistake']} ({first['answers']})" if first else ""
        numbers = [str(one[name]) for name in ("right", "answers", "unanswered")]
        drawn.add_row(one["id"], one["kind"], one["about"], *numbers, f"{one['score']:.2f}", most)
    return drawn


def mistake_table(record: dict[str, Any]) -> Any:
    """A line for each known mistake: how often it was made, by how many students, where."""
    drawn = table()
    for name in ("mistake", "answers", "of wrong", "students", "questions"):
        drawn.add_column(name, justify="left" if name in ("mistake", "questions") else "right")
    for one in record["mistakes"]:
        where = ", ".join(f"{own['id']} ({own['answers']})" for own in one["questions"])
        part = f"{100.0 * one['part']:.0f} %"
        drawn.add_row(one["mistake"], str(one["answers"]), part, str(one["students"]), where)
    return drawn
