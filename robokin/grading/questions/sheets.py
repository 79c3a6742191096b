"""A sheet of questions: which there are, drawn for each student of a class."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from robokin.errors import InputError, did_you_mean, shown
from robokin.grading.questions.count_exercise import CountExercise, pairs_of
from robokin.grading.questions.exercise import Exercise, Given, drawn
from robokin.grading.questions.jacobian_exercise import JacobianExercise
from robokin.grading.questions.joint_exercise import JointExercise, SolutionsExercise
from robokin.grading.questions.pose_exercise import PoseExercise
from robokin.grading.questions.table_exercise import TableExercise, bare
from robokin.grading.tolerance import Tolerance, default_tolerance
from robokin.model import Mechanism, Robot

KINDS: Mapping[str, type[Exercise]] = {
    one.kind: one
    for one in (PoseExercise, JointExercise, SolutionsExercise, TableExercise, JacobianExercise, CountExercise)
}
"""What can be asked, by its word."""

MOST = 100
"""Questions of a sheet."""


@dataclass(frozen=True)
class WantedQuestion:
    """A question that is wanted: its kind, and what it is to be about, "" for what there is."""

    kind: str
    about: str = ""


def wanted_questions(text: str) -> list[WantedQuestion]:
    """The questions of a text such as `fk:2,ik@puma560,dof`. Raises InputError."""
    found: list[WantedQuestion] = []
    for part in text.replace(" ", "").split(","):
        start, _, about = part.partition("@")
        kind, colon, count = start.partition(":")
        if kind not in KINDS:
            hint = did_you_mean(kind, KINDS) or f", expected some of {', '.join(KINDS)} with commas"
            raise InputError(f"--questions: found '{shown(kind)}'{hint}")
        if colon and not (count.isascii() and count.isdecimal() and 0 < len(count) < 4 and int(count) > 0):
            raise InputError(f"--questions: found '{shown(part)}', expected a count from 1, such as {kind}:2")
        found += [WantedQuestion(kind, about)] * (int(count) if colon else 1)
    if len(found) > MOST:
        raise InputError(f"--questions: found {len(found)} questions, expected at most {MOST}")
    return found


@dataclass(frozen=True)
class StudentQuestion:
    """A question of one student: its numbers, and the exercise that they belong to."""

    student: str
    exercise: Exercise
    given: Given

    @property
    def id(self) -> str:
        """The question's number on the sheet."""
        return self.exercise.id


@dataclass(frozen=True, repr=False)
class Sheet:
    """A sheet: its exercises, the students, the seed, and the numbers of each student's questions, in their order."""

    exercises: tuple[Exercise, ...]
    students: tuple[str, ...]
    seed: str
    numbers: tuple[tuple[Given, ...], ...]

    def __repr__(self) -> str:
        return f"Sheet({len(self.exercises)} questions, {len(self.students)} students, seed {self.seed!r})"

    def questions(self, student: int) -> list[StudentQuestion]:
        """The questions of a student, by the number in the class, from 0."""
        name = self.students[student]
        return [StudentQuestion(name, one, own) for one, own in zip(self.exercises, self.numbers[student], strict=True)]

    def __iter__(self) -> Iterator[StudentQuestion]:
        """All questions, student by student."""
        for i in range(len(self.students)):
            yield from self.questions(i)


def exercise_of(
    kind: str, id: str, name: str, subject: Robot | Mechanism | None, allowed: Tolerance | None = None
) -> Exercise:
    """The exercise of a kind about a robot or a mechanism. Raises InputError where it cannot be about that."""
    if kind == CountExercise.kind:
        pairs = pairs_of(subject) if isinstance(subject, Mechanism) else None
        if pairs is None:
            raise InputError(
                f"question {id}: {name} is no mechanism of plain joints (R, P, C, U, S), expected one for dof"
            )
        return CountExercise(id, name, pairs)
    if not isinstance(subject, Robot):
        raise InputError(f"question {id}: {name} is a mechanism, expected a robot for {kind}")
    if not subject.n:
        raise InputError(f"question {id}: {name} has no joints, expected a robot that can move")
    made = KINDS[kind]
    if made is TableExercise:
        table = TableExercise(id, name, subject, default_tolerance(subject))
        table.require()
        return replace(table, robot=bare(subject))
    return made(id, name, subject, allowed or default_tolerance(subject))  # type: ignore[call-arg]


def drawn_sheet(exercises: Sequence[Exercise], students: Sequence[str], seed: str) -> Sheet:
    """The sheet with the numbers of each student. Raises InputError where a question is not to be had.

    A student's numbers follow from the seed, the student's id, and the question's number and kind alone.
    """
    columns = [drawn(one, students, seed) for one in exercises]
    rows: list[tuple[Any, ...]] = [*zip(*columns, strict=True)] if columns else [() for _ in students]
    return Sheet(tuple(exercises), tuple(students), seed, tuple(rows))
