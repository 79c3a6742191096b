"""What a question of a sheet is about, and all that follows from it: numbers, the right answer, the marking.

An exercise is one question of the sheet, the same for all students but for its numbers. It draws the numbers (`draw`),
says what is asked for (`quantities`), what is right (`answers`), and marks (`task`, `subject`). What is drawn is
JSON: numbers in the robot's units, just as they are printed, so that what is marked follows from what the student read.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from robokin.arrays import Array
from robokin.errors import InputError
from robokin.grading.mark_items import BLANK, NOT_ANSWERED
from robokin.grading.marking import AnswerTask, GivenAnswer, GivenValue, Marker, NoAnswerError
from robokin.grading.questions.drawn_joints import JointChoices, joint_choices
from robokin.grading.questions.seeded_numbers import SeededNumbers
from robokin.grading.questions.typed_numbers import decimals_for
from robokin.grading.tolerance import Tolerance
from robokin.kernel.facts import fact
from robokin.model import Robot
from robokin.model.joint_units import joint_factors

if TYPE_CHECKING:
    from robokin.grading.answers.answer_files import Row

Given = dict[str, Any]
"""The numbers of a student's question."""

ATTEMPTS = 400
"""Draws until a question counts as not to be had: of the library's arms one of ten is good, or better."""


@dataclass(frozen=True)
class AskedQuantity:
    """One number that is asked for: its name, and its unit, "" for none."""

    name: str
    unit: str = ""


@dataclass(frozen=True, eq=False)
class Exercise:
    """A question of a sheet: its id, and what it is about, a robot's or a mechanism's name on the sheet."""

    id: str
    about: str

    kind: ClassVar[str] = ""
    """What --questions calls it."""

    wanting: ClassVar[str] = "away from limits and singular configurations"
    """What its numbers must be."""

    @property
    def check(self) -> str:
        """What marks it: fk, ik, dh, jacobian or dof."""
        return self.kind

    def candidate(self, numbers: SeededNumbers) -> Given | None:
        """Numbers for the question, before `accepted` has looked at them; None where they will not do."""
        raise NotImplementedError

    def accepted(self, candidates: Sequence[Given]) -> list[bool]:
        """Which of them make a question with one clear answer."""
        return [True] * len(candidates)

    def quantities(self, given: Given) -> tuple[AskedQuantity, ...]:
        """What is asked for."""
        raise NotImplementedError

    def answers(self, given: Given) -> list[str]:
        """The right answer: a text for each quantity."""
        raise NotImplementedError

    def subject(self, given: Given) -> Marker:
        """What answers are marked against."""
        raise NotImplementedError

    def question(self, given: Given) -> Any:
        """What `subject` is asked."""
        raise NotImplementedError

    def answer(self, given: Given, row: Row) -> tuple[GivenAnswer, ...]:
        """What stands in a row whose cells are the quantities'."""
        raise NotImplementedError

    def task(self, given: Given, row: Row | None, student: str) -> AnswerTask:
        """What is marked of a student's answer; None for a row that is not there."""
        question = GivenValue(self.question(given))
        if row is None:
            nothing = GivenAnswer(GivenValue(NoAnswerError(NOT_ANSWERED, "no line answers it")))
            return AnswerTask(self.id, question, (nothing,), student)
        if not row.fault and not any(cell.strip() for cell in row.cells.values()):
            blank = GivenAnswer(GivenValue(NoAnswerError(BLANK, f"line {row.line}: no answer")))
            return AnswerTask(self.id, question, (blank,), student, row.line)
        return AnswerTask(self.id, question, self.answer(given, row), student, row.line)


@dataclass(frozen=True, eq=False)
class RobotExercise(Exercise):
    """A question about a robot; `allowed` is how far answers may be off."""

    robot: Robot
    allowed: Tolerance

    @property
    def choices(self) -> JointChoices:
        """The values that joints may be given."""
        return choices_of(self.robot)

    @property
    def answer_decimals(self) -> tuple[int, int]:
        """Decimals of lengths and of angles of a right answer: to a twentieth of the tolerance."""
        return self.decimals(0.1)

    def decimals(self, part: float) -> tuple[int, int]:
        """Decimals of lengths and of angles, so that rounding is off by no more than half a part of the tolerance."""
        units = self.robot.units
        return (
            decimals_for(part * self.allowed.position / units.metres),
            decimals_for(part * self.allowed.angle / units.radians),
        )

    def si(self, q: Sequence[float]) -> Array:
        """Joint values in the units as (n,) [rad | m]."""
        return np.asarray(np.array(q, dtype=float) * joint_factors(self.robot, self.robot.units))

    def joint_quantities(self, prefix: str = "") -> tuple[AskedQuantity, ...]:
        """The joint values as quantities."""
        units = self.robot.units
        return tuple(
            AskedQuantity(f"{prefix}q{i}", units.angle if turns else units.length)
            for i, turns in enumerate(self.robot.revolute, start=1)
        )


@fact
def choices_of(robot: Robot) -> JointChoices:
    """The values that a robot's joints may be given. Raises InputError."""
    return joint_choices(robot)


def drawn(exercise: Exercise, students: Sequence[str], seed: str) -> list[Given]:
    """The numbers of one question for each student. Raises InputError where the question is not to be had.

    Each student's numbers come from a stream of their own: the first of them that are accepted.
    """
    streams = {i: SeededNumbers(seed, student, exercise.id, exercise.kind) for i, student in enumerate(students)}
    found: dict[int, Given] = {}
    for _ in range(ATTEMPTS):
        left = [i for i in streams if i not in found]
        if not left:
            break
        tried = {i: exercise.candidate(streams[i]) for i in left}
        ready = {i: given for i, given in tried.items() if given is not None}
        for (i, given), good in zip(ready.items(), exercise.accepted(list(ready.values())), strict=True):
            if good:
                found[i] = given
    if len(found) < len(students):
        raise InputError(
            f"question {exercise.id}: found no numbers for {exercise.kind} of {exercise.about} in {ATTEMPTS} tries "
            f"that are {exercise.wanting}, expected another robot or kind"
        )
    return [found[i] for i in range(len(students))]


def named_values(names: Sequence[str], values: Sequence[float]) -> Mapping[str, float]:
    """Values by their names."""
    return dict(zip(names, values, strict=True))
