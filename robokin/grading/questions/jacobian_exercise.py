"""Questions about the Jacobian at joint values."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, partial
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from robokin.arrays import Array
from robokin.grading.jacobian_marks import ROWS, JacobianCheck
from robokin.grading.marking import GivenAnswer
from robokin.grading.questions.exercise import AskedQuantity, Given
from robokin.grading.questions.pose_exercise import PoseExercise
from robokin.grading.questions.typed_numbers import decimal_text, decimals_for
from robokin.kinematics.flat_arm import flat_arm

if TYPE_CHECKING:
    from robokin.grading.answers.answer_files import Row


@dataclass(frozen=True, eq=False)
class JacobianExercise(PoseExercise):
    """The geometric Jacobian in the base's axes, of an arm in the plane its rows vx, vy, wz."""

    kind: ClassVar[str] = "jacobian"

    @cached_property
    def rows(self) -> list[int]:
        """Which of the six rows are asked for."""
        return [0, 1, 5] if flat_arm(self.robot) is not None else list(range(6))

    def _linear(self, i: int, k: int) -> bool:
        """Whether an entry is a length."""
        return i < 3 and bool(self.robot.revolute[k])

    def quantities(self, given: Given) -> tuple[AskedQuantity, ...]:
        """The entries, row by row."""
        return self.entries

    @cached_property
    def entries(self) -> tuple[AskedQuantity, ...]:
        """The same for all students."""
        return tuple(
            AskedQuantity(f"{ROWS[i]} q{k + 1}", self.robot.units.length if self._linear(i, k) else "")
            for i in self.rows for k in range(self.robot.n)
        )  # fmt: skip

    def answers(self, given: Given) -> list[str]:
        """The entries."""
        check = self.subject(given)
        J = check.right(self.question(given)) / check.scale(range(6))
        pure, length = decimals_for(0.1 * self.allowed.angle), self.answer_decimals[0]
        return [
            decimal_text(J[i, k], length if self._linear(i, k) else pure)
            for i in self.rows for k in range(self.robot.n)
        ]  # fmt: skip

    def subject(self, given: Given) -> JacobianCheck:  # type: ignore[override]
        """The check of Jacobians."""
        return JacobianCheck(self.robot, self.robot.units, self.allowed, "base")

    def answer(self, given: Given, row: Row) -> tuple[GivenAnswer, ...]:
        """The entries that were answered."""
        return (GivenAnswer(partial(self._read, row), line=row.line),)

    def _read(self, row: Row) -> Array:
        names = [f"{ROWS[i]} q{k + 1}" for i in self.rows for k in range(self.robot.n)]
        values = row.numbers(names, [False] * len(names), self.robot.units)
        return np.asarray(values.reshape(len(self.rows), self.robot.n))
