"""Questions of forward kinematics: the pose for joint values."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from robokin.arrays import Array
from robokin.grading.answers.answered_poses import PoseReader
from robokin.grading.marking import GivenAnswer
from robokin.grading.pose_marks import PoseCheck
from robokin.grading.questions.exercise import AskedQuantity, Given, RobotExercise
from robokin.grading.questions.pose_forms import REGULAR, PoseForm, asked_form, regularity
from robokin.grading.questions.seeded_numbers import SeededNumbers
from robokin.kinematics.forward import forward_kinematics

if TYPE_CHECKING:
    from robokin.grading.answers.answer_files import Row

NEAREST = 0.05
"""The end effector is this part of the arm's size from the origin, or farther: near it a slip would not show."""


@dataclass(frozen=True, eq=False)
class PoseExercise(RobotExercise):
    """The pose for joint values."""

    kind: ClassVar[str] = "fk"

    @cached_property
    def form(self) -> PoseForm:
        """How the pose is said."""
        return asked_form(self.robot)

    def candidate(self, numbers: SeededNumbers) -> Given:
        """Joint values."""
        return {"q": self.choices.draw(numbers)}

    def accepted(self, candidates: Sequence[Given]) -> list[bool]:
        """Which are regular, with a pose that can be said."""
        q = np.array([self.si(given["q"]) for given in candidates]).reshape(-1, self.robot.n)
        regular = regularity(self.robot, q, self.form.rows) > REGULAR
        poses = forward_kinematics(self.robot, q)
        far = np.linalg.norm(poses[:, :3, 3], axis=1) > NEAREST * self.allowed.size
        return [bool(a and b and self.form.fits(T)) for a, b, T in zip(regular, far, poses, strict=True)]

    def quantities(self, given: Given) -> tuple[AskedQuantity, ...]:
        """The numbers of the pose."""
        return tuple(AskedQuantity(name, self.form.unit(name, self.robot.units)) for name in self.form.names)

    def answers(self, given: Given) -> list[str]:
        """The pose."""
        T = forward_kinematics(self.robot, self.question(given))
        texts = self.form.texts(T, self.robot.units, self.answer_decimals)
        return [texts[name] for name in self.form.names]

    def subject(self, given: Given) -> PoseCheck:
        """The check of poses."""
        return PoseCheck(self.robot, self.robot.units, self.allowed)

    def question(self, given: Given) -> Array:
        """The joint values (n,) [rad | m]."""
        return self.si(given["q"])

    def answer(self, given: Given, row: Row) -> tuple[GivenAnswer, ...]:
        """The pose that was answered."""
        reader = PoseReader(self.form.kind, self.form.names, self.robot, self.robot.units)
        written: Any = {name: row.cells[name] for name in self.form.names}
        return (GivenAnswer(partial(reader.read, row), written, line=row.line),)
