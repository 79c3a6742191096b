"""Schemas of `robokin check fk`, `ik`, `dh`, `jacobian` and `dof`."""

from __future__ import annotations

from collections.abc import Callable

from robokin.records import sheet_schemas
from robokin.records.pose_schemas import POSITION, RPY
from robokin.records.schema_words import (
    Q,
    Schema,
    documents,
    flag,
    head,
    items,
    mapping,
    matrix,
    maybe,
    number,
    numbers,
    record,
    rows,
    text,
    texts,
    whole,
    word,
)

VALUE = record(
    "A pose, as far as it is compared.",
    {},
    {
        "position": POSITION,
        "rpy": RPY,
        "approach": numbers("The direction of the tool's z axis [1].", 3),
        "matrix": matrix("What is no rotation, as it was given"),
        "task": word("What of it counts.", "pose", "approach", "position"),
    },
)
ERROR = maybe(number("How far off."), "where nothing could be compared")
NO_ANSWER = "where there is none to read"
UNTOLD = "where --feedback does not tell it"
UNDECIDED = "where the answer is not decided"


def _any(about: str, *schemas: Schema) -> Schema:
    return {"description": about, "anyOf": list(schemas)}


NULL: Schema = {"type": "null"}


def _documents(kind: str, expected: Schema, got: Schema, errors: dict[str, Schema], more: dict[str, Schema],
               extra: dict[str, Schema] | None = None) -> Schema:  # fmt: skip
    """Documents of a check: all marks, or one a line."""
    robot = text("What the answers are marked against.")
    lengths = {} if kind == "dof" else {"units": head("robot", robot)["units"]}
    tolerance = record(
        "What was allowed.", {},
        {
            "position": number("Of positions [length].", 0.0),
            "angle": number("Of orientations [angle].", 0.0),
            "relative": number("A part of the right value, added to them [1].", 0.0),
        },
    )  # fmt: skip
    about = {
        **head("robot", robot, units=False),
        **lengths,
        "check": {"const": kind, "description": "What is marked."},
        "tolerance": tolerance,
    }
    item = {
        "id": text("The question or the answer."),
        "status": text("pass, or what is wrong."),
        "score": number("From 0 to 1 [1].", 0.0),
        "expected": expected,
        "got": got,
        "error": record("The errors.", {}, errors),
        **more,
        "detail": text("The same in words."),
        "decided": flag("Whether it is known to be right or wrong; not where it took more than its budget."),
        "counted": flag("Whether it counts; not where it repeats an answer before."),
        "mistake": maybe(text("The known mistake, such as `length unit`."), "for a right answer and any other mistake"),
    }
    also = {
        "student": text("Who answered."),
        "line": whole("Where the answer stands in its file, from 1.", 1),
        **(extra or {}),
    }
    counts = {
        "passed": whole("Answers that are right.", 0),
        "total": whole("Answers that count.", 0),
        "score": number("Mean of the questions' scores, from 0 to 1 [1].", 0.0),
        "undecided": whole("Answers that are neither right nor wrong.", 0),
    }
    student = record("A student's marks.", {"student": text("Who."), **counts})
    whole_report = record(
        "All marks.",
        {**about, **counts, "items": items(record("A mark.", item, also), "A mark for each answer.")},
        {"students": items(student, "The marks of each student.")},
    )
    line = record("One mark; `id` is the answer's.", {**about, **item}, also)
    return documents(f"check {kind}", "Marks; a line of JSON lines holds one.", [], report=whole_report, mark=line)


def _fk() -> Schema:
    pose = _any("The right pose, or null.", VALUE, NULL)
    got = _any("The answered pose, or the cells that could not be read.", VALUE, mapping(text("A cell."), "Cells."),
               text("What was given."), NULL)  # fmt: skip
    more = {
        "q": maybe(Q, "where there are none"),
        "compared": maybe(word("What of the pose.", "pose", "position"), NO_ANSWER),
    }
    return _documents("fk", pose, got, {"position": ERROR, "angle": ERROR}, more)


def _ik() -> Schema:
    expected = _any("The target, or all solutions.", VALUE, rows("All solutions [joint]."), NULL)
    got = _any("The answered values, all of them, or `none`.", Q, rows("All answers [joint]."), text("none"), NULL)
    answer = record(
        "An answer of a set.",
        {"q": maybe(Q, NO_ANSWER), "status": text("pass, or what is wrong."), "detail": text("The same in words.")},
    )
    extra = {
        "complete": maybe(flag("Whether every solution is known."), UNTOLD),
        "answers": items(answer, "Each answer of the set."),
        "missing": maybe(rows("Solutions that are not answered [joint]."), UNTOLD),
    }
    return _documents("ik", expected, got, {"position": ERROR, "angle": ERROR}, {}, extra)


def _dh() -> Schema:
    value = number("A value, in the unit of what it is.")
    difference = record(
        "Where the table differs.",
        {
            "joint": maybe(whole("The joint, from 1.", 1), "where it is base or tool"),
            "what": text("What differs."),
            "found": maybe(value, "where there is none"),
            "expected": maybe(value, "where there is none"),
        },
    )
    cell = record(
        "A wrong cell.",
        {
            "row": whole("The row of the table, from 1.", 1),
            "column": word("The column.", "theta", "d", "a", "alpha", "offset"),
            "found": maybe(value, UNTOLD),
            "expected": maybe(value, UNTOLD),
        },
    )
    more = {
        "cells": items(cell, "The cells that are wrong, where these are all that is."),
        "needs": maybe(texts("What --up-to would have to leave open."), "where that does not help"),
        "differences": items(difference, "The differences."),
        "zeros": maybe(numbers("Shifts of the joints' zeros [joint]."), "where they could not be compared"),
        "signs": maybe(items(whole("1 or -1."), "The joints' senses."), "where they could not be compared"),
    }
    types = text("The joints' types, such as RRRRRR.")
    return _documents("dh", maybe(types, UNTOLD), maybe(types, NO_ANSWER), {}, more)


def _jacobian() -> Schema:
    entries = rows("6×n, linear rows before angular [length/rad or 1; 1].", 6)
    more = {"q": maybe(Q, UNDECIDED), "frame": maybe(word("Whose axes.", "base", "tool"), UNDECIDED)}
    return _documents(
        "jacobian", maybe(entries, UNTOLD), maybe(entries, NO_ANSWER), {"linear": ERROR, "angular": ERROR}, more
    )


def _dof() -> Schema:
    return _documents(
        "dof", maybe(whole("The right number."), UNTOLD), maybe(whole("The answer."), NO_ANSWER), {"count": ERROR}, {}
    )


CHECKS: dict[str, Callable[[], Schema]] = {
    "fk": _fk, "ik": _ik, "dh": _dh, "jacobian": _jacobian, "dof": _dof, "new": sheet_schemas.new,
    "sheet": sheet_schemas.sheet, "statistics": sheet_schemas.statistics,
}  # fmt: skip
"""The schemas by what is checked."""
