"""The list of a class: who is in it."""

from __future__ import annotations

import unicodedata

from robokin.errors import InputError, shown
from robokin.files import open_input
from robokin.grading.answers.answer_records import SheetReader
from robokin.tables.text_source import Say

STUDENTS = ("student", "id", "sid", "email", "name")
"""Columns that say who is in a class; the first of them that is there does."""

LONGEST = 200
"""Characters of a student's id."""

MOST = 10000
"""Students of a class."""


def class_list(source: str, say: Say) -> list[str]:
    """The students of a CSV with a header, in its order. Raises InputError for none, a blank, or the same one twice."""
    with open_input(source, "a CSV of students") as (stream, name):
        records = list(SheetReader(stream, name, say).rows())
    header = [cell.casefold() for cell in records[0].cells] if records else []
    column = next((header.index(name) for name in STUDENTS if name in header), None)
    if column is None:
        found = f"the columns {shown(', '.join(header), 200)}" if header else "nothing"
        raise InputError(f"{name}: found {found}, expected a header with the column student")
    students: dict[str, int] = {}
    for cells, line, fault, _ in records[1:]:
        if fault:
            raise InputError(f"{name}, line {line}: {fault}")
        student = unicodedata.normalize("NFC", cells[column])
        place = f"{name}, line {line}"
        if not student:
            raise InputError(f"{place}: found no student, expected one in the column {header[column]}")
        if len(student) > LONGEST or not student.isprintable():
            raise InputError(f"{place}: found '{shown(student)}', expected up to {LONGEST} characters that can be seen")
        if student in students:
            raise InputError(
                f"{place}: found the student '{shown(student)}' a second time (line {students[student]}), expected "
                "each once"
            )
        students[student] = line
    if not students:
        raise InputError(f"{name}: found a header alone, expected a student a line below it")
    if len(students) > MOST:
        raise InputError(f"{name}: found {len(students)} students, expected at most {MOST}")
    return [*students]
