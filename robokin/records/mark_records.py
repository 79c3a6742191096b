"""Marks to plain data: the documents of `robokin check`, rows of its CSV, and the results that autograders read.

What a level of feedback does not tell is null.
"""

from __future__ import annotations

from typing import Any

from robokin.errors import counted
from robokin.grading.feedback import ANSWER, DISTANCE, PART, VERDICT, tells
from robokin.grading.mark_items import Item, Report, said_status
from robokin.records.envelope import envelope

TOLD = {"needs": PART, "signs": PART, "zeros": DISTANCE, "missing": ANSWER, "complete": ANSWER}
"""From which level on a key that belongs to a kind of check is told; others are at all."""


def item_record(item: Item, level: str = ANSWER) -> dict[str, Any]:
    """An item as JSON has it."""
    record: dict[str, Any] = {"id": item.id}
    if item.student is not None:
        record["student"] = item.student
    expected = item.expected if tells(level, ANSWER) else None
    record |= {"status": item.said_status(level), "score": item.score, "expected": expected, "got": item.got}
    more = {name: _told(name, value, level) for name, value in item.more.items()}
    record |= {"error": item.errors(level), **more, "detail": item.detail(level)}
    record |= {"decided": item.decided, "counted": item.counted}
    record["mistake"] = item.mistake if tells(level, PART) else None
    if item.line is not None:
        record["line"] = item.line
    return record


def _told(name: str, value: Any, level: str) -> Any:
    """The value of a key as a level tells it."""
    if not tells(level, TOLD.get(name, VERDICT)):
        return None
    if name == "answers":
        return [one | {"status": said_status(one["status"], level), "detail": one["detail"].at(level)} for one in value]
    if name in ("differences", "cells"):
        hidden = [part for part, of in (("found", DISTANCE), ("expected", ANSWER)) if not tells(level, of)]
        return [one | dict.fromkeys(hidden) for one in value] if tells(level, PART) else []
    return value


def report_head(report: Report) -> dict[str, Any]:
    """What is said of all items, without them."""
    key = "sheet" if report.check == "sheet" else "robot"
    return envelope(key, report.robot, report.units) | {"check": report.check, "tolerance": report.tolerance}


def report_record(report: Report, level: str = ANSWER) -> dict[str, Any]:
    """The document of a report."""
    record = report_head(report) | _sums(report)
    if students := report.students():
        record["students"] = [{"student": name, **_sums(own)} for name, own in students.items()]
    return record | {"items": [item_record(item, level) for item in report.items]}


def _sums(report: Report) -> dict[str, Any]:
    total, undecided = len(report.counted), report.undecided
    return {"passed": report.passed, "total": total, "score": report.score, "undecided": undecided}


def report_rows(report: Report, level: str = ANSWER) -> tuple[list[str], list[list[Any]]]:
    """The headings and the rows of a CSV, one an item, with the errors in columns of their own."""
    errors, students = error_names(report), any(item.student is not None for item in report.items)
    sheet = ["kind", "about"] if report.check == "sheet" else []
    rows = []
    for item in report.items:
        told = item.errors(level)
        cells = [item.id, *([item.student] if students else []), *(item.more[name] for name in sheet)]
        cells += [item.said_status(level), item.score]
        cells += [told.get(name) for name in errors]
        rows.append(["" if cell is None else cell for cell in [*cells, item.detail(level)]])
    headings = [
        "id",
        *(["student"] if students else []),
        *sheet,
        "status",
        "score",
        *(f"{name}_error" for name in errors),
    ]
    return [*headings, "detail"], rows


def error_names(report: Report) -> list[str]:
    """The names of the errors that the items of a report have."""
    return list(dict.fromkeys(name for item in report.items for name in item.error))


def item_name(item: Item) -> str:
    """An item's id, with the student where one is named."""
    return item.id if item.student is None else f"{item.student}, {item.id}"


def summary(report: Report) -> str:
    """How many are right, and how many could not be decided."""
    said = f"{report.passed} of {counted(len(report.counted), 'answer')} right"
    return said + (f", {report.undecided} not decided" if report.undecided else "")


def _test_name(item: Item, report: Report) -> str:
    """What an autograder's test is called; of a sheet each is about something else."""
    if report.check == "sheet":
        return f"{item.id}: {item.more['kind']} {item.more['about']}"
    return item_name(item)


def autograder_record(report: Report, points: float | None, visibility: str | None, level: str) -> dict[str, Any]:
    """The results that autograders read: a test an item, its score a part of what the item is worth.

    points: what all of it is worth, one an item if None; level: how much the students are told; repetitions are no
    tests. Source: Gradescope, Autograder specifications (Output format).
    """
    worth = 1.0 if points is None else points / max(len(report.counted), 1)
    tests = []
    for item in report.counted:
        said = item.detail(level)
        test: dict[str, Any] = {
            "name": _test_name(item, report),
            "score": item.score * worth,
            "max_score": worth,
            "status": "passed" if item.passed else "failed",
            "output": item.said_status(level) + (f": {said}" if said else ""),
        }
        tests.append(test if visibility is None else test | {"visibility": visibility})
    return {"score": report.score * worth * len(report.counted), "output": summary(report), "tests": tests}
