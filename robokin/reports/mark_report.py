"""Marks to bytes: a page, JSON, JSON lines, CSV, and the results.json of an autograder."""

from __future__ import annotations

import json
import textwrap

from robokin.grading.feedback import ANSWER, DISTANCE, tells
from robokin.grading.mark_items import Item, Report
from robokin.number_text import show
from robokin.records.mark_records import (
    autograder_record,
    error_names,
    item_name,
    item_record,
    report_head,
    report_record,
    report_rows,
    summary,
)
from robokin.reports.page_parts import Part
from robokin.tables.written_rows import csv_without_formulas, encode, json_document, json_line


def written(report: Report, kind: str, level: str = ANSWER) -> bytes:
    """The report in a format, as a level of feedback tells it."""
    if kind == "json":
        return json_document(report_record(report, level))
    if kind == "jsonl":
        head = report_head(report)
        return b"".join(json_line(head | item_record(item, level)) for item in report.items)
    if kind == "csv":
        return csv_without_formulas(*report_rows(report, level))
    if report.check == "sheet":
        from robokin.reports.sheet_report import sheet_page

        return sheet_page(report, level)
    return _page(report, level)


def _page(report: Report, level: str) -> bytes:
    """The marks for eyes, as a level of feedback tells them."""
    from robokin.reports.page_tables import render

    return render(*report_parts(report, level))


def report_parts(report: Report, level: str = ANSWER) -> list[Part]:
    """The same as the parts of a page."""
    from robokin.reports.page_tables import heading, table

    units = report.units
    said = f"lengths in {units.length}, angles in {units.angle}" if units is not None else ""
    parts: list[Part] = [heading(f"check {report.check}: {report.robot}", said)]
    if report.tolerance:
        parts.append(f"tolerance: {_tolerance(report)}")
    parts.append("")
    errors = error_names(report) if tells(level, DISTANCE) else []
    students = any(item.student is not None for item in report.items)
    drawn = table()
    for name in ["id", *(["student"] if students else []), "status"]:
        drawn.add_column(name)
    for name in ["score", *(f"{name} error" for name in errors)]:
        drawn.add_column(name, justify="right", no_wrap=True)
    for item in report.items:
        score = f"{item.score:.2f}" if item.counted else "–"
        cells = [item.id, *([item.student or ""] if students else []), item.said_status(level), score]
        drawn.add_row(*cells, *(_error(item, name) for name in errors), style=None if item.passed else "red")
    parts.append(drawn)
    notes = [f"{item_name(item)}: {said}" for item in report.items if (said := item.detail(level))]
    if notes:
        # Wrapped here: off a terminal nothing else does, and on one the indent would be lost.
        parts += ["", *(textwrap.fill(note, 80, subsequent_indent="  ", break_on_hyphens=False) for note in notes)]
    if marks := report.students():
        sums = table()
        for name in ("student", "right", "of", "score"):
            sums.add_column(name, justify="left" if name == "student" else "right")
        for name, own in marks.items():
            sums.add_row(name, str(own.passed), str(len(own.counted)), f"{own.score:.2f}")
        parts += ["", sums]
    parts += ["", f"{summary(report)}, score {report.score:.2f}"]
    return parts


def _error(item: Item, name: str) -> str:
    value = item.error.get(name)
    if value is None:
        return "–"
    return show(value) if value == 0.0 or abs(value) >= 1e-6 else f"{value:.0e}"


def _tolerance(report: Report) -> str:
    unit = report.units
    parts = []
    for name, value in report.tolerance.items():
        suffix = {"position": unit.length, "angle": unit.angle}.get(name, "") if unit is not None else ""
        parts.append(f"{name} {value:g} {suffix}".rstrip())
    return ", ".join(parts)


def results(report: Report, points: float | None, visibility: str | None, level: str) -> bytes:
    """The results.json of an autograder."""
    document = autograder_record(report, points, visibility, level)
    return encode(json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False) + "\n")
