"""What `robokin check sheet` prints: of one student each answer, of a class each student, and the questions."""

from __future__ import annotations

import textwrap
from typing import Any

from robokin.grading.class_statistics import class_statistics
from robokin.grading.mark_items import Report
from robokin.records.mark_records import item_name, item_record, summary
from robokin.records.statistics_records import statistics_record
from robokin.reports.page_tables import heading, render, table
from robokin.reports.statistics_page import mistake_table, question_table

MOST_NOTES = 40
"""Sentences about wrong answers of a class that a page shows."""


def sheet_page(report: Report, level: str) -> bytes:
    """The page of a sheet's marks, as a level of feedback tells them."""
    students = report.students()
    parts: list[Any] = [heading(f"check sheet: {report.robot}", ""), ""]
    if len(students) == 1:
        drawn = table()
        for name in ("id", "kind", "about", "status"):
            drawn.add_column(name)
        drawn.add_column("score", justify="right")
        for item in report.items:
            cells = [item.id, item.more["kind"], item.more["about"], item.said_status(level)]
            drawn.add_row(*cells, f"{item.score:.2f}", style=None if item.passed else "red")
        parts.append(drawn)
    else:
        record = statistics_record(class_statistics(item_record(item, level) for item in report.items))
        sums = table()
        for name in ("student", "right", "of", "score"):
            sums.add_column(name, justify="left" if name == "student" else "right")
        for name, own in students.items():
            sums.add_row(name, str(own.passed), str(len(own.counted)), f"{own.score:.2f}")
        parts += [sums, "", question_table(record)]
        parts += ["", mistake_table(record)] if record["mistakes"] else []
    notes = [f"{item_name(item)}: {said}" for item in report.items if (said := item.detail(level))]
    if notes:
        shown = notes if len(students) == 1 else notes[:MOST_NOTES]
        parts += ["", *(textwrap.fill(note, 80, subsequent_indent="  ", break_on_hyphens=False) for note in shown)]
        if len(notes) > len(shown):
            parts.append(f"and {len(notes) - len(shown)} more, which -f csv and --json have")
    parts += ["", f"{summary(report)}, score {report.score:.2f}"]
    return render(*parts)
