"""Sheets of questions for a class from Python: made, handed out, marked and counted as `robokin check` does."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from robokin.brief import Brief
from robokin.errors import InputError, InputTypeError, counted, shown
from robokin.expected import described, expect_flag, expect_kind, expect_number
from robokin.formats.library import load_any
from robokin.grading.answers.class_list import expect_students
from robokin.grading.answers.mark_files import read_marks
from robokin.grading.answers.sheet_answers import sheet_tasks, whose
from robokin.grading.answers.sheet_keys import read_sheet_key
from robokin.grading.answers.sheet_subjects import sheet_exercises
from robokin.grading.class_marks import expect_rules
from robokin.grading.class_statistics import ClassStatistics, class_statistics
from robokin.grading.mark_items import Report
from robokin.grading.questions.sheet_marks import sheet_report
from robokin.grading.questions.sheets import Sheet, drawn_sheet, wanted_questions
from robokin.model import Mechanism, Robot, Tree
from robokin.records.mark_records import item_record, report_head
from robokin.records.sheet_records import new_sheet_record, question_record
from robokin.reports.autograder_files import autograder_options, autograder_zip
from robokin.reports.moodle_quiz import moodle_quiz
from robokin.reports.sheet_files import key_only, sheet_files
from robokin.tables.folder_sink import expect_new_folder, write_folder

PRACTICE = ("practice",)
"""The students of a sheet for nobody in particular."""

BIGGEST = 10**100
"""Seeds are below this, as in the shell."""


@dataclass(frozen=True, eq=False, repr=False)
class QuestionSheet(Brief):
    """Questions with other numbers for each student, and their key: `name` is what the sheet is called on paper."""

    name: str
    sheet: Sheet

    @property
    def students(self) -> tuple[str, ...]:
        """The students, in their order."""
        return self.sheet.students

    @property
    def questions(self) -> list[dict[str, Any]]:
        """What is asked: of each question its id, its kind and what it is about."""
        return [question_record(self.sheet, i) for i in range(len(self.sheet.exercises))]

    def files(self) -> dict[str, bytes]:
        """All files that `robokin check new` writes, by their paths: those below `key` are not for students."""
        return dict(sheet_files(self.sheet, self.name))

    def write(self, folder: str | Path) -> None:
        """Write the files into a new folder, which is whole or absent. Raises InputError where there is anything."""
        place = _text(folder, "folder")
        write_folder(expect_new_folder(place, "folder"), sheet_files(self.sheet, self.name), "folder")

    def moodle(self) -> bytes:
        """The questions as a Moodle quiz (XML); a warning says which are left out, and why."""
        quiz, notes = moodle_quiz(self.sheet, self.name)
        _warn(notes)
        return quiz

    def autograder(self, partial: float | None = None, points: float | None = None) -> bytes:
        """The .zip of a Gradescope autograder.

        partial: the least score, 0 to 1, of an answer with a known mistake. points: in total, by default 1 a question.
        Raises InputError.
        """
        for name, value in (("partial", partial), ("points", points)):
            if value is not None and expect_number(value, name, "a number of 0 or more, or None") < 0.0:
                raise InputError(f"{name}: found {value:g}, expected a number of 0 or more, or None")
        return autograder_zip(key_only(self.sheet, self.name), autograder_options(partial, points))

    def record(self, folder: str | None = None) -> dict[str, Any]:
        """The document that `robokin check new` prints of it, with the folder that it was written to."""
        others = {"moodle": None, "autograder": None}
        return new_sheet_record(self.sheet, self.name, self.name if folder is None else folder, dict(others))

    def __repr__(self) -> str:
        """A line: how many questions for how many students, from which seed."""
        asked, students = counted(len(self.sheet.exercises), "question"), counted(len(self.students), "student")
        return f"<sheet {self.name!r}: {asked} for {students}, seed {self.sheet.seed}>"


def question_sheet(
    about: str | Robot | Mechanism | Sequence[str | Robot | Mechanism], questions: str = "fk", *, seed: int,
    students: Sequence[str] | None = None, name: str = "sheet",
) -> QuestionSheet:  # fmt: skip
    """Questions with other numbers for each student, and their key, as `robokin check new` makes them.

    about: robots and, for dof, mechanisms, taken in turn: names of the library, paths, or what `load` and
    `load_mechanism` give. questions: kinds with counts, such as "fk:2,ik,ik-all,dh,jacobian,dof@four-bar". students:
    their names, by default one sheet for `practice`. The numbers follow from the seed, the student and the question's
    number and kind alone: the same call gives the same bytes, those of the shell for a folder of that name.
    Raises InputError.
    """
    if isinstance(seed, bool) or not isinstance(seed, int):
        said = "expected a whole number: the same one gives the same sheet"
        raise InputTypeError(f"seed: found {described(seed)}, {said}")
    if abs(seed) >= BIGGEST:
        raise InputError("seed: found a number of more than 100 digits, expected a shorter one")
    wanted = wanted_questions(expect_kind(questions, str, "questions", "kinds of questions, such as 'fk:2,ik'"))
    called = expect_kind(name, str, "name", "what the sheet is called")
    if not called.strip() or not called.isprintable() or "/" in called:
        raise InputError(f"name: found '{shown(called)}', expected what a folder may be called")
    given: dict[str, Robot | Mechanism] = {}
    names = [_named(one, given) for one in _several(about, "about")]
    class_ = PRACTICE if students is None else expect_students(_several(students, "students"))
    exercises = sheet_exercises(wanted, names, lambda one: given[one] if one in given else _loaded(one))
    return QuestionSheet(name, drawn_sheet(exercises, class_, str(seed)))


def mark_sheet(
    key: str | Path, answers: str | Path | Sequence[str | Path], *, student: str | None = None,
    budget: float | None = 10.0, partial: float | None = None, follow: bool = False,
) -> Report:  # fmt: skip
    """The marks of a class's answers to a sheet, as `robokin check sheet` gives them.

    key: the folder `key` of the sheet. answers: files, and folders of them, in the form answers.csv. student: whose
    answers all of them are; then that student's questions alone are marked. budget, partial: as for
    `robokin.grading.grade_poses`, but that each answer has 10 seconds unless it is said otherwise. follow: read what
    symbolic links point to. A warning names lines that are not marked. Raises InputError.
    """
    rules, follow = expect_rules(budget, partial), expect_flag(follow, "follow")
    known = read_sheet_key(_text(key, "key"))
    places = [_text(one, "answers") for one in _several(answers, "answers")]
    if not places:
        raise InputError("answers: found none, expected a file of answers, or a folder of them")
    own = None if student is None else whose(known, [[expect_kind(student, str, "student", "a student's name")]])
    notes: list[str] = []
    tasks = sheet_tasks(known, places, notes.append, follow=follow, student=own)
    _warn(notes)
    return sheet_report(known.name, known.exercises, tasks, rules)


def statistics_of(marks: str | Path | Report | Sequence[str | Path | Report]) -> ClassStatistics:
    """What a class did: how hard each question was, which known mistakes were made how often.

    marks: those that `mark_sheet` or `robokin.grading` give, files of marks (.json, .jsonl) of `robokin check`, or
    several of both. Raises InputError.
    """
    found: list[dict[str, Any]] = []
    names = []
    for one in [marks] if isinstance(marks, Report) else _several(marks, "marks"):
        if isinstance(one, Report):
            found += [report_head(one) | item_record(item) for item in one]
            names.append(one.robot)
        else:
            place = _text(one, "marks")
            found += read_marks(place)
            names.append(place)
    if not found:
        raise InputError("marks: found none, expected those of one answer or more")
    return class_statistics(found, " ".join(names))


def _several(value: Any, argument: str) -> list[Any]:
    """A value by itself, or the values of a sequence."""
    if isinstance(value, str | Path | Robot | Mechanism):
        return [value]
    try:
        return list(value)
    except TypeError:
        raise InputTypeError(f"{argument}: found {described(value)}, expected one or a list of several") from None


def _named(one: Any, given: dict[str, Robot | Mechanism]) -> str:
    """What a robot or a mechanism is called; of a value it is noted in `given`."""
    if not isinstance(one, Robot | Mechanism):
        return _text(one, "about")
    name, number = one.id or one.name, 1
    while given.get(name, one) is not one:
        number += 1
        name = f"{one.id or one.name}-{number}"
    given[name] = one
    return name


def _loaded(name: str) -> Any:
    found = load_any(name)
    return found.robot() if isinstance(found, Tree) else found


def _text(place: Any, argument: str) -> str:
    """A path or a name as text."""
    if not isinstance(place, str | Path):
        raise InputTypeError(f"{argument}: found {described(place)}, expected a name or the path of a file or folder")
    return str(place)


def _warn(notes: Sequence[str]) -> None:
    for note in notes:
        warnings.warn(note, UserWarning, stacklevel=3)
