"""Schemas of `robokin check new`, `sheet` and `statistics`."""

from __future__ import annotations

from typing import Any

from robokin.records.schema_words import Schema, documents, flag, head, items, maybe, number, record, text, whole

KIND = text("What was asked: fk, ik, ik-all, dh, jacobian or dof.")
ABOUT = text("The robot or the mechanism that it is about.")
ANY: dict[str, Any] = {"description": "As the check of its kind has it, or null."}


def _question() -> Schema:
    return record("A question of the sheet.", {"id": text("Its number."), "kind": KIND, "about": ABOUT})


def new() -> Schema:
    """Documents of `robokin check new`."""
    made = record(
        "A sheet that was made.",
        {
            **head("sheet", text("The sheet's name, which is its folder's."), units=False),
            "folder": text("The folder that was made."),
            "seed": text("The seed."),
            "students": whole("How many students.", 1),
            "questions": items(_question(), "The questions."),
            "moodle": maybe(text("The Moodle quiz."), "where none was asked for"),
            "autograder": maybe(text("The Gradescope autograder."), "where none was asked for"),
        },
    )
    return documents("check new", "A sheet of questions.", [], sheet=made)


def sheet() -> Schema:
    """Documents of `robokin check sheet`."""
    error = maybe(number("How far off."), "where nothing could be compared, or it is not told")
    units = {
        "description": "The units of lengths and angles; null where there are none.",
        "anyOf": [
            record("The units.", {"length": text("Of lengths."), "angle": text("Of angles.")}),
            {"type": "null"},
        ],
    }
    item = {
        "id": text("The question."),
        "student": text("Who answered."),
        "status": text("pass, or what is wrong."),
        "score": number("From 0 to 1 [1].", 0.0),
        "expected": ANY,
        "got": ANY,
        "error": record("The errors.", {}, dict.fromkeys(("position", "angle", "linear", "angular", "count"), error)),
        "kind": KIND,
        "about": ABOUT,
        "units": units,
        "detail": text("What is wrong, in words."),
        "decided": flag("Whether it is known to be right or wrong."),
        "counted": flag("Whether it counts."),
        "mistake": maybe(text("The known mistake."), "for a right answer and any other mistake"),
    }
    also = {"line": whole("Where the answer stands in its file, from 1.", 1)}
    counts = {
        "passed": whole("Right answers.", 0),
        "total": whole("Questions.", 0),
        "score": number("Mean of the questions' scores, from 0 to 1 [1].", 0.0),
        "undecided": whole("Answers that are neither right nor wrong.", 0),
    }
    about = {
        **head("sheet", text("The sheet's name."), units=False),
        "check": {"const": "sheet", "description": "What is marked."},
        "tolerance": record("Empty: each robot of the key has its own.", {}),
    }
    student = record("A student's marks.", {"student": text("Who."), **counts})
    marks = items(record("A mark.", item, also), "A mark for each question of each student.")
    whole_report = record(
        "All marks.", {**about, **counts, "students": items(student, "The marks of each student."), "items": marks}
    )
    line = record("One mark; `id` is the question's.", {**about, **item}, also)
    return documents("check sheet", "Marks; a line of JSON lines holds one.", [], report=whole_report, mark=line)


def statistics() -> Schema:
    """Documents of `robokin check statistics`."""
    answers = whole("How many answers.", 0)
    score = number("The mean score, from 0 to 1 [1].", 0.0)
    mistake = text("A known mistake.")
    question = record(
        "What the class did with a question.",
        {
            "id": text("The question."),
            "kind": KIND,
            "about": ABOUT,
            "answers": answers,
            "right": whole("How many are right.", 0),
            "unanswered": whole("How many are blank or missing.", 0),
            "score": score,
            "statuses": items(
                record("A status.", {"status": text("Its word."), "answers": answers}), "How often each status."
            ),
            "mistakes": items(record("A mistake.", {"mistake": mistake, "answers": answers}), "Known mistakes."),
        },
    )
    place = record("A question.", {"id": text("Its number."), "answers": answers})
    made = record(
        "A known mistake in the whole class.",
        {
            "mistake": mistake,
            "answers": answers,
            "part": number("As a part of all wrong answers [1].", 0.0),
            "students": whole("By how many students.", 0),
            "questions": items(place, "In which questions."),
        },
    )
    found = record(
        "The statistics.",
        {
            **head("file", text("The files of marks."), units=False),
            "students": whole("How many students.", 0),
            "answers": answers,
            "right": whole("How many are right.", 0),
            "wrong": whole("How many were given and are not right.", 0),
            "score": score,
            "median": number("The median of the students' scores [1].", 0.0),
            "lowest": number("The lowest of them [1].", 0.0),
            "highest": number("The highest of them [1].", 0.0),
            "known": whole("Wrong answers with a known mistake.", 0),
            "questions": items(question, "Each question."),
            "mistakes": items(made, "Known mistakes, the most frequent first."),
        },
    )
    return documents("check statistics", "What a class did.", [], statistics=found)
