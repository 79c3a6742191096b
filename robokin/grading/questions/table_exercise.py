"""Questions about Denavit-Hartenberg tables: the table of an arm whose joints' axes are given.

The arm is that of a robot with other lengths and other senses of twists, without its base and its tool. The student
reads where the axes are with all joints at zero; any table that moves the last frame as the arm's does is right.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from robokin.arrays import Array
from robokin.errors import InputError
from robokin.grading.marking import GivenAnswer
from robokin.grading.questions.exercise import AskedQuantity, Given, RobotExercise
from robokin.grading.questions.pose_forms import REGULAR, asked_form, regularity, samples
from robokin.grading.questions.seeded_numbers import SeededNumbers
from robokin.grading.questions.typed_numbers import decimal_text, multiples, round_step
from robokin.grading.table_marks import TableCheck
from robokin.grading.tolerance import default_tolerance
from robokin.kinematics.forward import link_frames
from robokin.model import CoupledRobot, Joint, JointType, Robot

if TYPE_CHECKING:
    from robokin.grading.answers.answer_files import Row

COLUMNS = ("theta", "d", "a", "alpha")

SQUARE = 1e-9
"""Radians that a twist may be off from a multiple of a right angle."""


@dataclass(frozen=True, eq=False)
class TableExercise(RobotExercise):
    """The table of an arm like a robot."""

    kind: ClassVar[str] = "dh"

    @cached_property
    def lengths(self) -> list[float]:
        """The lengths that cells are given, in the units, all positive."""
        greatest = max(max(abs(row.a), abs(row.d)) for row in self.robot.rows) / self.robot.units.metres
        step = round_step(greatest / 10.0)
        return multiples(step, 0.29 * greatest, 1.51 * greatest)

    def require(self) -> None:
        """Raise InputError for a robot of which no table can be asked for."""
        expected = "expected another robot for dh"
        if isinstance(self.robot, CoupledRobot) or self.robot.convention not in ("standard", "modified"):
            raise InputError(f"question {self.id}: {self.about} has no Denavit-Hartenberg table, {expected}")
        if not all(row.moves and row.sense == 1 for row in self.robot.rows):
            raise InputError(f"question {self.id}: {self.about} has fixed or reversed rows, {expected}")
        for row in self.robot.rows:
            for angle in (row.alpha, row.theta, row.offset if row.type is JointType.REVOLUTE else 0.0):
                quarter = angle / (0.5 * np.pi)
                if abs(quarter - round(quarter)) > SQUARE:
                    raise InputError(
                        f"question {self.id}: {self.about} has an angle that is no multiple of 90°, {expected}"
                    )
        if not any(row.a or row.d for row in self.robot.rows):
            raise InputError(f"question {self.id}: {self.about} has no lengths, {expected}")

    def candidate(self, numbers: SeededNumbers) -> Given:
        """The rows of a table: other lengths where there are some, each right-angled twist to either side."""
        rows = []
        for row in self.robot.rows:
            quarter = round(row.alpha / (0.5 * np.pi))
            alpha = quarter * numbers.choice((1, -1)) if quarter % 2 else quarter
            theta = row.offset if row.type is JointType.REVOLUTE else row.theta
            slides = row.type is JointType.PRISMATIC
            drawn: dict[str, Any] = {
                "type": row.type.letter,
                "theta": float(round(theta / (0.5 * np.pi)) * 90),
                "d": self._length(row.offset if slides else row.d, numbers, sign=not slides),
                "a": self._length(row.a, numbers),
                "alpha": float(alpha * 90),
            }
            if not self.robot.units.degrees:
                for name in ("theta", "alpha"):
                    drawn[name] = float(np.radians(drawn[name]))
            rows.append(drawn)
        return {"rows": rows}

    def _length(self, value: float, numbers: SeededNumbers, *, sign: bool = False) -> float:
        """Another length in the place of one; none for none."""
        if not value:
            return 0.0
        return numbers.choice(self.lengths) * (numbers.choice((1.0, -1.0)) if sign else 1.0)

    def accepted(self, candidates: Sequence[Given]) -> list[bool]:
        """Which make an arm that can move as the robot does."""
        rows, good = asked_form(self.robot).rows, []
        own = float(np.max(regularity(self.robot, samples(self.robot), rows)))
        for given in candidates:
            arm = self.arm(given["rows"])
            good.append(float(np.max(regularity(arm, samples(arm), rows))) > min(REGULAR, 0.5 * own))
        return good

    def arm(self, rows: Sequence[dict[str, Any]]) -> Robot:
        """The arm of a table's rows, in the units of the robot."""
        units = self.robot.units
        joints = []
        for own, row in zip(self.robot.rows, rows, strict=True):
            theta, alpha = row["theta"] * units.radians, row["alpha"] * units.radians
            d, a = row["d"] * units.metres, row["a"] * units.metres
            turns = own.type is JointType.REVOLUTE
            cells = {"theta": 0.0, "offset": theta, "d": d} if turns else {"theta": theta, "offset": d, "d": 0.0}
            joints.append(Joint(own.name, own.type, a=a, alpha=alpha, **cells))
        assert self.robot.convention != "frames"
        return Robot(self.robot.name, tuple(joints), self.robot.convention, id=self.robot.id, units=units)

    def axes(self, given: Given) -> tuple[list[tuple[Array, Array]], Array]:
        """A point (3,) in the units and the direction (3,) of each joint's axis at zero, and the last frame (4, 4)."""
        arm = self.arm(given["rows"])
        frames = np.array(link_frames(arm, np.zeros(arm.n)))
        frames[:, :3, 3] /= self.robot.units.metres
        first = 0 if arm.convention == "standard" else 1
        return [(T[:3, 3], T[:3, 2]) for T in frames[first : first + arm.n]], frames[-1]

    def quantities(self, given: Given) -> tuple[AskedQuantity, ...]:
        """The cells, row by row; theta of a joint that turns, and d of one that slides, is its value at zero."""
        units = self.robot.units
        return tuple(
            AskedQuantity(f"row {i} {name}", units.length if name in "da" else units.angle)
            for i in range(1, self.robot.n + 1) for name in COLUMNS
        )  # fmt: skip

    def answers(self, given: Given) -> list[str]:
        """The cells of the arm's own table."""
        return [decimal_text(row[name], 9) for row in given["rows"] for name in COLUMNS]

    def subject(self, given: Given) -> TableCheck:
        """The check of tables."""
        arm = self.arm(given["rows"])
        return TableCheck(arm, arm.units, default_tolerance(arm, table=True))

    def question(self, given: Given) -> None:
        """There is nothing to ask beside the arm."""

    def answer(self, given: Given, row: Row) -> tuple[GivenAnswer, ...]:
        """The table that was answered."""
        return (GivenAnswer(partial(self._read, row), line=row.line),)

    def _read(self, row: Row) -> Robot:
        names = [f"row {i} {name}" for i in range(1, self.robot.n + 1) for name in COLUMNS]
        angles = [name.endswith(("theta", "alpha")) for name in names]
        values = row.numbers(names, angles, self.robot.units).reshape(-1, len(COLUMNS))
        rows = [dict(zip(COLUMNS, map(float, line), strict=True)) for line in values]
        return self.arm(rows)


def bare(robot: Robot) -> Robot:
    """A robot without its base, its tool and its limits, as its table alone has it."""
    return replace(robot, base=np.eye(4), tool=np.eye(4), rows=tuple(replace(row, texts=()) for row in robot.rows))
