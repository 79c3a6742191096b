"""Marks to bytes: a page, JSON, JSON lines, CSV, and the results.json of an autograder."""

from __future__ import annotations

import json
import textwrap
from typing import Any

from robokin.cli.checks import Item, Report
from robokin.cli.output.numbers import counted, show
from robokin.cli.output.text import csv_records, encode, json_document, json_line
from robokin.grading.feedback import ANSWER, DISTANCE, tells

VISIBILITIES = ("visible", "hidden", "after_due_date", "after_published")
"""Who sees a test of an autograder, and when: the words of Gradescope's format."""


def written(report: Report, kind: str, level: str = ANSWER) -> bytes:
    """The report in a format, as a level of feedback tells it."""
    if kind == "json":
        return json_document(report.record(level))
    if kind == "jsonl":
        head = report.head()
        return b"".join(json_line(head | item.record(level)) for item in report.items)
    return _csv(report, level) if kind == "csv" else _page(report, level)


def _csv(report: Report, level: str) -> bytes:
    """A line an item; the errors in columns of their own."""
    errors = list(dict.fromkeys(name for item in report.items for name in item.error))
    students = any(item.student is not None for item in report.items)
    columns = ["id", *(["student"] if students else []), "status", "score"]
    rows = []
    for item in report.items:
        told = item.errors(level)
        cells = [item.id, *([item.student] if students else []), item.said_status(level), item.score]
        cells += [told.get(name) for name in errors]
        rows.append(["" if cell is None else cell for cell in [*cells, item.detail(level)]])
    return csv_records([*columns, *(f"{name}_error" for name in errors), "detail"], rows)


# Pages ----------------------------------------------------------------------------------------------------


def _page(report: Report, level: str) -> bytes:
    """The marks for eyes, as a level of feedback tells them."""
    from robokin.cli.output.tables import heading, render, table

    units = report.units
    said = f"lengths in {units.length}, angles in {units.angle}" if units is not None else ""
    parts: list[Any] = [heading(f"check {report.check}: {report.robot}", said)]
    if report.tolerance:
        parts.append(f"tolerance: {_tolerance(report)}")
    parts.append("")
    told = tells(level, DISTANCE)
    errors = list(dict.fromkeys(name for item in report.items for name in item.error if told))
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
    notes = [f"{_name(item)}: {said}" for item in report.items if (said := item.detail(level))]
    if notes:
        # Wrapped here: off a terminal nothing else does, and on one the indent would be lost.
        parts += ["", *(textwrap.fill(note, 80, subsequent_indent="  ", break_on_hyphens=False) for note in notes)]
    marks = report.students()
    if marks:
        sums = table()
        for name in ("student", "right", "of", "score"):
            sums.add_column(name, justify="left" if name == "student" else "right")
        for mark in marks:
            sums.add_row(mark["student"], str(mark["passed"]), str(mark["total"]), f"{mark['score']:.2f}")
        parts += ["", sums]
    parts += ["", f"{_sum(report)}, score {report.score:.2f}"]
    return render(*parts)


def _sum(report: Report) -> str:
    """How many are right, and how many could not be decided."""
    said = f"{report.passed} of {counted(len(report.counted), 'answer')} right"
    return said + (f", {report.undecided} not decided" if report.undecided else "")


def _name(item: Item) -> str:
    return item.id if item.student is None else f"{item.student}, {item.id}"


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


# Autograders ----------------------------------------------------------------------------------------------


def gradescope(report: Report, points: float | None, visibility: str | None, level: str) -> bytes:
    """The results.json that autograders read: a test an item, its score a part of what the item is worth.

    points: what all of it is worth, one an item if None; level: how much the students are told; repetitions are no
    tests. Source: Gradescope, Autograder specifications (Output format).
    """
    worth = 1.0 if points is None else points / max(len(report.counted), 1)
    tests = []
    for item in report.counted:
        said = item.detail(level)
        test: dict[str, Any] = {
            "name": _name(item),
            "score": item.score * worth,
            "max_score": worth,
            "status": "passed" if item.passed else "failed",
            "output": item.said_status(level) + (f": {said}" if said else ""),
        }
        if visibility is not None:
            test["visibility"] = visibility
        tests.append(test)
    total = report.score * worth * len(report.counted)
    document = {"score": total, "output": _sum(report)}
    return encode(json.dumps(document | {"tests": tests}, indent=2, ensure_ascii=False, allow_nan=False) + "\n")
