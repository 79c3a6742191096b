"""What the questions of a sheet are about: robots and mechanisms, by the names that a teacher typed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from robokin.errors import InputError
from robokin.formats.read import read_text
from robokin.formats.written_robot import written
from robokin.grading.questions.count_exercise import CountExercise
from robokin.grading.questions.exercise import Exercise
from robokin.grading.questions.sheets import WantedQuestion, exercise_of
from robokin.grading.questions.student_names import PLAIN, file_names
from robokin.model import Mechanism, Robot

MECHANISMS = (
    "four-bar", "slider-crank", "six-bar", "stephenson", "five-bar", "3-rrr", "whitworth", "rssr", "6-sps", "3-rps",
    "sarrus", "delta",
)  # fmt: skip
"""Mechanisms of the library that are taken in turn where none is named."""


def sheet_exercises(
    wanted: Sequence[WantedQuestion], names: Sequence[str], load: Callable[[str], Any]
) -> list[Exercise]:
    """The exercises of a sheet. names: robots and mechanisms, taken in turn; load: gives what is called so.

    Raises InputError where a question has nothing to be about.
    """
    loaded: dict[str, Robot | Mechanism] = {}
    called: dict[str, str] = {}

    def subject(name: str) -> Robot | Mechanism:
        if name not in loaded:
            found = load(name)
            if not isinstance(found, (Robot, Mechanism)):
                raise InputError(f"{name} is neither an arm nor a mechanism, expected one of them")
            # Marks follow from the description in the key: what is drawn is about the same robot, to the last digit.
            again = read_text(written(found), name) if isinstance(found, Robot) else found
            assert isinstance(again, (Robot, Mechanism))
            loaded[name] = again
            called[name] = _short_name(found.id or Path(name).stem, [*called.values()])
        return loaded[name]

    turn = {True: [], False: []}  # type: dict[bool, list[str]]
    for name in names:
        turn[isinstance(subject(name), Mechanism)].append(name)
    turn[True] = turn[True] or [*MECHANISMS]
    taken = {True: 0, False: 0}
    exercises = []
    for i, one in enumerate(wanted, start=1):
        counts, name = one.kind == CountExercise.kind, one.about
        if not name:
            if not turn[counts]:
                raise InputError(f"question {i}: ROBOT is missing, expected a robot for {one.kind}")
            name = turn[counts][taken[counts] % len(turn[counts])]
            taken[counts] += 1
        about = subject(name)
        exercises.append(exercise_of(one.kind, str(i), called[name], about))
    return exercises


def _short_name(name: str, before: Sequence[str]) -> str:
    """A name for files and texts of a sheet, not one of those before."""
    plain = name if PLAIN.fullmatch(name) else file_names([name])[name]
    number, found = 1, plain
    while found in before:
        number += 1
        found = f"{plain}-{number}"
    return found
