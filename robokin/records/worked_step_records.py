"""The worked steps behind an answer of `robokin ik` as plain data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from robokin.arrays import Array
from robokin.derivation.explain import End, Lesson, explain_ik
from robokin.derivation.worked_steps import Quantity
from robokin.inverse.solution_names import branch_names
from robokin.inverse.solutions import Result
from robokin.inverse.verify import SAME, wrapped
from robokin.model import Robot
from robokin.model.joint_units import joint_factors
from robokin.units import Units


@dataclass(frozen=True, eq=False)
class Explanation:
    """Worked steps with the answer that they explain, in units."""

    robot: Robot
    units: Units
    lesson: Lesson
    result: Result

    def record(self) -> dict[str, Any]:
        """The value of the key `explanation` in the JSON document."""
        return {
            "title": self.lesson.title,
            "given": self.values(self.lesson.given),
            "steps": [
                {
                    "name": step.name,
                    "formula": f"{step.name} = {step.formula}",
                    "values": self.values(step.values),
                    "result": self.plain(step.result),
                    "branch": step.branch,
                    "note": step.note,
                }
                for step in self.lesson.steps
            ],
            "branches": [
                {
                    "branch": end.branch,
                    "name": name,
                    "q": None if end.q is None else self.joints(end.q),
                    "solution": number,
                    "reason": self.reason(end, number) or None,
                }
                for end, name, number in zip(self.lesson.ends, self.names, self.numbers, strict=True)
            ],
        }

    def values(self, quantities: Mapping[str, Quantity]) -> dict[str, Any]:
        """Named values in the units."""
        return {name: self.plain(quantity) for name, quantity in quantities.items()}

    def plain(self, quantity: Quantity) -> Any:
        """A value in the units: a number or lists of numbers."""
        value = np.array(quantity.value, dtype=np.float64)
        if quantity.kind == "pose":
            value[:3, 3] /= self.units.metres
        elif quantity.kind == "angle":
            value /= self.units.radians
        elif quantity.kind in ("length", "point"):
            value /= self.units.metres
        return (value + 0.0).tolist()

    def joints(self, q: Array) -> Any:
        """Joint values q: (n,) [rad | m] in the units."""
        return (q / joint_factors(self.robot, self.units) + 0.0).tolist()

    @cached_property
    def names(self) -> list[str]:
        """What the posture at each end is called, or ""."""
        found = [end.q for end in self.lesson.ends if end.q is not None]
        words = iter(branch_names(self.robot, np.array(found)) if found else [])
        return ["" if end.q is None else next(words) for end in self.lesson.ends]

    @cached_property
    def numbers(self) -> list[int | None]:
        """Which of the listed solutions each end is, from 1."""
        return [self.number(end) for end in self.lesson.ends]

    def number(self, end: End) -> int | None:
        """Which of the listed solutions an end is."""
        if end.q is None or end.reason:
            return None
        for k, solution in enumerate(self.result.solutions, start=1):
            if np.max(np.abs(wrapped((solution.q - end.q)[None], self.robot.revolute))) < SAME:
                return k
        return None

    def reason(self, end: End, number: int | None) -> str:
        """Why an end is no listed solution, or ""."""
        if number is not None or end.reason:
            return end.reason
        if any(solution.free for solution in self.result.solutions):
            return "one of infinitely many, for which another one is listed"
        return "not among the solutions that are listed"


def explanation_of(robot: Robot, units: Units, target: Array, result: Result, **options: Any) -> Explanation:
    """The worked steps of the closed form behind the answer to a target: (4, 4) [m].

    `options` are those that the answer was asked for with. Raises InputError where the arm has no closed form.
    """
    asked = {name: options[name] for name in ("task", "limits", "near") if name in options}
    return Explanation(robot, units, explain_ik(robot, target, **asked), result)
