"""The list of a class: who is in it."""

from __future__ import annotations

import unicodedata
from collections.abc import Sequence

from robokin.errors import InputError, InputTypeError, shown
from robokin.expected import described
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
    students: dict[str, str] = {}
    for cells, line, fault, _ in records[1:]:
        if fault:
            raise InputError(f"{name}, line {line}: {fault}")
        if not cells[column]:
            expected = f"expected one in the column {header[column]}"
            raise InputError(f"{name}, line {line}: found no student, {expected}")
        _take(students, cells[column], f"{name}, line {line}", f"line {line}")
    if not students:
        raise InputError(f"{name}: found a header alone, expected a student a line below it")
    if len(students) > MOST:
        raise InputError(f"{name}: found {len(students)} students, expected at most {MOST}")
    return [*students]


def expect_students(names: Sequence[object]) -> list[str]:
    """The students of a list. Raises InputError for none, a blank, what is no text, or the same one twice."""
    students: dict[str, str] = {}
    for i, one in enumerate(names):
        if not isinstance(one, str) or not one.strip():
            raise InputTypeError(f"students[{i}]: found {described(one)}, expected a student's name")
        _take(students, one, f"students[{i}]", f"students[{i}]")
    if not 0 < len(students) <= MOST:
        raise InputError(f"students: found {len(students) or 'none'}, expected 1 to {MOST}")
    return [*students]


def _take(students: dict[str, str], student: str, place: str, here: str) -> None:
    """Note a student of a class and where it says so. Raises InputError."""
    student = unicodedata.normalize("NFC", student)
    if len(student) > LONGEST or not student.isprintable():
        raise InputError(f"{place}: found '{shown(student)}', expected up to {LONGEST} characters that can be seen")
    if student in students:
        raise InputError(
            f"{place}: found the student '{shown(student)}' a second time ({students[student]}), expected each once"
        )
    students[student] = here
