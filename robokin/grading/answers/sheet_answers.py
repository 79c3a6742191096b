"""Answers to a sheet, in the form that students fill in: a line for each number.

Whose they are: in a folder the outermost folder that is called like a student, else the file's name; where neither is,
the column `student`. So nobody answers for another one who has a file.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from robokin.errors import InputError, shown
from robokin.grading.answers.answer_files import NOTES, AnswerFile, Row, read_answers
from robokin.grading.answers.sheet_keys import SheetKey
from robokin.grading.answers.submissions import files_inside, is_answer_folder
from robokin.grading.marking import AnswerTask, Marker
from robokin.tables.text_source import Say

COLUMNS = ("student", "id", "quantity", "unit", "answer")
"""The columns of the form; `student` and `unit` may be left out."""


@dataclass(frozen=True, eq=False)
class SheetTask(AnswerTask):
    """What one student answers to one question, with what it is marked against."""

    marker: Marker | None = None


@dataclass
class SheetAnswers:
    """The answers of a class to a key's questions, as they are found file by file."""

    key: SheetKey
    say: Say
    cells: dict[tuple[str, str], dict[str, tuple[Row, str]]] = field(default_factory=dict)
    """By student and question each quantity's line, and what is answered there."""
    unmarked: dict[tuple[str, str], list[int]] = field(default_factory=dict)
    """By file and reason the lines that are not marked."""
    owned: set[str] = field(default_factory=set)
    """Students who have a file of their own."""

    def __post_init__(self) -> None:
        """Know students by their ids and by their files' names, whatever the case where that is one student's."""
        self.known: dict[str, str] = {}
        for student, name in self.key.students.items():
            self.known[student] = student
            self.known[name] = student
        folded: dict[str, set[str]] = {}
        for name, student in self.known.items():
            folded.setdefault(name.casefold(), set()).add(student)
        self.folded = {name: own.pop() for name, own in folded.items() if len(own) == 1}
        self.asked: dict[tuple[str, str], dict[str, None]] = {}

    def quantities(self, student: str, id: str) -> dict[str, None]:
        """The names of what a question asks of a student, in their order; worked out once, and asked for every line."""
        own = self.asked.get((student, id))
        if own is None:
            asked = self.key.exercises[id].quantities(self.key.numbers[student, id])
            own = self.asked[student, id] = dict.fromkeys(one.name for one in asked)
        return own

    def student(self, name: str) -> str | None:
        """The student who is called so, or None."""
        return self.known.get(name.strip()) or self.folded.get(name.strip().casefold())

    def add(self, sheet: AnswerFile, owner: str | None) -> None:
        """The lines of a file; owner: whose it is, whatever it says, or None. Raises InputError for missing columns."""
        sheet.require(("id", "quantity", "answer"), "the form of robokin check new")
        if owner is None and "student" not in sheet.columns:
            raise InputError(f"{sheet.name}: found no column student, expected it, or a file called like the student")
        for row in sorted(sheet.rows, key=lambda row: row.doubt):
            said = row.cells.get("student", "")
            who = self.student(said) if said else owner
            if who is None:
                why = f"there is no student '{shown(said)}'"
            elif owner is not None and who != owner:
                why = f"this is the file of {shown(owner)}"
            elif owner is None and who in self.owned:
                why = f"{shown(who)} has a file"
            elif row.cells["id"] not in self.key.exercises:
                why = f"there is no question '{shown(row.cells['id'])}'"
            else:
                why = self._line(who, row)
            if why:
                self.unmarked.setdefault((sheet.name, why), []).append(row.line)

    def _line(self, who: str, row: Row) -> str:
        """Take a line; why it is not marked, or ""."""
        id, name = row.cells["id"], " ".join(row.cells["quantity"].split())
        if name not in self.quantities(who, id):
            return f"question {id} asks for no '{shown(name)}'"
        own = self.cells.setdefault((who, id), {})
        before, answer = own.get(name), row.cells["answer"]
        if before is None or (not before[1].strip() and not row.fault):
            own[name] = row, answer
        elif answer.strip() and answer.strip() != before[1].strip() and before[0].doubt == row.doubt:
            said = f"found two answers for {name}, here and in line {row.line}, expected one"
            own[name] = replace(before[0], fault=said), before[1]
        return ""

    def tasks(self, students: Sequence[str]) -> list[SheetTask]:
        """What is marked: each question of each student, answered or not."""
        for (name, why), lines in [*self.unmarked.items()][:NOTES]:
            more = f" and {len(lines) - 1} more" if len(lines) > 1 else ""
            self.say(f"{name}, line {lines[0]}{more}: {why}; not marked")
        if len(self.unmarked) > NOTES:
            self.say(f"and {len(self.unmarked) - NOTES} more reasons why lines are not marked")
        return [self._task(student, id) for student in students for id in self.key.exercises]

    def _task(self, student: str, id: str) -> SheetTask:
        exercise, given = self.key.exercises[id], self.key.numbers[student, id]
        found, row = self.cells.get((student, id)), None
        if found:
            first = min((one for one, _ in found.values()), key=lambda one: one.line)
            fault = next((one.fault for one, _ in found.values() if one.fault), "")
            cells = {name: found[name][1] if name in found else "" for name in self.quantities(student, id)}
            row = replace(first, cells=cells, fault=fault)
        task = exercise.task(given, row, student)
        return SheetTask(task.id, task.question, task.answers, student, task.line, marker=exercise.subject(given))


def sheet_tasks(
    key: SheetKey, places: Sequence[str], say: Say, *, follow: bool = False, student: str | None = None
) -> list[SheetTask]:
    """The answers in files and folders to a key's questions. Raises InputError for what is none.

    student: whose answers all of them are; then that student's questions alone are marked.
    """
    answers = SheetAnswers(key, say)
    files: list[tuple[str, str | None, bool]] = []
    for place in places:
        if is_answer_folder(place, follow):
            inside = [*files_inside(place, follow, (".csv",))]
            if not inside:
                raise InputError(f"{shown(place)}: found no file that ends with .csv in the folder, expected answers")
            # Not by pathlib: sentences show places as they were typed.
            files += [(os.path.join(place, name), _owner(answers, name), True) for name in inside]  # noqa: PTH118
        else:
            files.append((place, None, False))
    if student is not None:
        files = [(place, student, within) for place, _, within in files]
    answers.owned = {owner for _, owner, _ in files if owner is not None}
    for place, owner, within in files:
        try:
            answers.add(read_answers(place, say, follow=follow), owner)
        except InputError as error:
            if not within:
                raise
            say(f"{error}; not marked")  # one file among those of a class is nobody else's trouble
    return answers.tasks([student] if student is not None else [*key.students])


def _owner(answers: SheetAnswers, name: str) -> str | None:
    """The student whom a path in a folder names: by the outermost folder, which no student chose, else by the file."""
    *folders, file = Path(name).parts
    for part in (*folders, file[: -len(".csv")]):
        if (student := answers.student(part)) is not None:
            return student
    return None


def whose(key: SheetKey, names: Sequence[Sequence[str]]) -> str:
    """The one student of a key whom some names mean. Raises InputError for none and for several.

    names: the surest first; those of a group are looked at only where no group before it means anybody.
    """
    answers = SheetAnswers(key, lambda said: None)
    found: dict[str, None] = {}
    for group in names:
        found = found or {student: None for name in group if (student := answers.student(name)) is not None}
    if len(found) != 1:
        listed = shown(", ".join(name for group in names for name in group), 200) or "nobody"
        raise InputError(f"found {len(found)} students of the sheet in {listed}, expected one")
    return next(iter(found))
