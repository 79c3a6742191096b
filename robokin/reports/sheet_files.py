"""The files of a sheet: each student's questions and form, and the key beside them."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from robokin.formats.written_robot import written
from robokin.grading.answers.sheet_answers import COLUMNS
from robokin.grading.answers.sheet_keys import QUESTIONS, SHEET
from robokin.grading.questions.exercise import RobotExercise
from robokin.grading.questions.sheets import Sheet, StudentQuestion
from robokin.grading.questions.student_names import file_names
from robokin.records.sheet_records import key_record, numbers_record
from robokin.reports.question_markup import latex, markdown
from robokin.reports.question_texts import robots_of, sheet_text, sketch_of
from robokin.tables.written_rows import csv_records, encode

STUDENTS, KEY = "students", "key"
"""Folders of a sheet: one for each student in the first, what no student may see in the second."""

ANSWERS = "answers.csv"


def sheet_files(sheet: Sheet, name: str) -> Iterator[tuple[str, bytes]]:
    """All files, each with its path below the sheet's folder, its parts separated by /."""
    folders = file_names(sheet.students)
    sketches = {about: sketch_of(one.robot).svg(one.robot.name) for about, one in robots_of(sheet.exercises).items()}
    right: list[list[Any]] = []
    for i, student in enumerate(sheet.students):
        questions = sheet.questions(i)
        place = f"{STUDENTS}/{folders[student]}"
        text = sheet_text(name, student, questions)
        yield f"{place}/questions.md", markdown(text)
        yield f"{place}/questions.tex", latex(text)
        filled = form_rows(folders[student], questions)
        yield f"{place}/{ANSWERS}", csv_records(COLUMNS, [[*row[:-1], ""] for row in filled])
        for about, sketch in sketches.items():
            yield f"{place}/{about}.svg", sketch
        right += filled
    yield f"{KEY}/{ANSWERS}", csv_records(COLUMNS, right)
    yield from key_files(sheet, name, folders)


def key_files(sheet: Sheet, name: str, folders: dict[str, str]) -> Iterator[tuple[str, bytes]]:
    """The files that marking needs."""
    document = json.dumps(key_record(sheet, name, folders), indent=1, ensure_ascii=False, allow_nan=False)
    yield f"{KEY}/{SHEET}", encode(document + "\n")
    lines = (json.dumps(numbers_record(one), ensure_ascii=False, allow_nan=False) for one in sheet)
    yield f"{KEY}/{QUESTIONS}", encode("".join(f"{line}\n" for line in lines))
    for one in {one.about: one for one in sheet.exercises if isinstance(one, RobotExercise)}.values():
        yield f"{KEY}/robots/{one.about}.yaml", encode(written(one.robot))


def key_only(sheet: Sheet, name: str) -> Iterator[tuple[str, bytes]]:
    """The files that marking needs, of a sheet by itself."""
    return key_files(sheet, name, file_names(sheet.students))


def sheet_name(folder: Path) -> str:
    """What a sheet is called: as its folder."""
    return folder.resolve().name or "sheet"


def form_rows(name: str, questions: list[StudentQuestion]) -> list[list[Any]]:
    """The lines of a student's form with the right answers, which are the last column."""
    return [
        [name, one.id, quantity.name, quantity.unit, answer]
        for one in questions
        for quantity, answer in zip(one.exercise.quantities(one.given), one.exercise.answers(one.given), strict=True)
    ]
