"""Questions of inverse kinematics: joint values for a pose, one solution or all."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from robokin.arrays import Array
from robokin.errors import InputError
from robokin.grading.answers.answer_tasks import JointReader
from robokin.grading.answers.answered_poses import AnsweredPose, pose_from
from robokin.grading.configuration_marks import joints_outside, solutions_near, solutions_near_each
from robokin.grading.joint_marks import JointCheck, task_of
from robokin.grading.marking import GivenAnswer
from robokin.grading.pose_difference import PASS, pose_errors, pose_status
from robokin.grading.questions.drawn_joints import clear_of_limits
from robokin.grading.questions.exercise import AskedQuantity, Given, RobotExercise
from robokin.grading.questions.pose_forms import REGULAR, PoseForm, given_values, regularity, target_form
from robokin.grading.questions.seeded_numbers import SeededNumbers
from robokin.grading.questions.typed_numbers import angle_text, decimal_text, decimals_for, whole_turn
from robokin.grading.tolerance import Tolerance
from robokin.inverse.solutions import Result
from robokin.inverse.solve import solve_many
from robokin.kinematics.forward import forward_kinematics
from robokin.kinematics.jacobian import jacobian
from robokin.model.joint_units import in_units, joint_factors

if TYPE_CHECKING:
    from robokin.grading.answers.answer_files import Row

APART = 20.0
"""Solutions are so many times the tolerance apart, in some joint."""

SLACK = 0.25
"""The values that a target was made of reach it, as it is printed, within this part of the tolerance."""

COARSE, FINE = 0.4, 0.004
"""Targets are rounded by no more than half of this part of the tolerance; finely for an arm of few joints, whose
nearest pose to a rounded target may be many times farther off than the rounding."""

MANY = 16
"""Solutions that somebody may be asked to type."""


@dataclass(frozen=True, eq=False)
class JointExercise(RobotExercise):
    """Joint values for a target: any solution."""

    kind: ClassVar[str] = "ik"
    every: ClassVar[bool] = False

    @cached_property
    def form(self) -> PoseForm:
        """How the target is said."""
        return target_form(self.robot)

    @property
    def check(self) -> str:
        """What marks it."""
        return "ik"

    @property
    def redundant(self) -> bool:
        """Whether the arm reaches a target in infinitely many ways."""
        return self.robot.n > len(self.form.rows)

    @property
    def scarce(self) -> bool:
        """Whether the arm has too few joints for any target: a rounded one is just beside what it reaches."""
        return self.robot.n < len(self.form.rows)

    def candidate(self, numbers: SeededNumbers) -> Given | None:
        """A target that joint values reach, rounded: `made_of` are these, which the student does not see."""
        q = self.choices.draw(numbers)
        T = forward_kinematics(self.robot, self.si(q))
        if not self.form.fits(T):
            return None
        texts = self.form.texts(T, self.robot.units, self.decimals(FINE if self.scarce else COARSE))
        return {name: float(text) for name, text in texts.items()} | {"made_of": q}

    def accepted(self, candidates: Sequence[Given]) -> list[bool]:
        """Which have all their solutions away from each other, from limits and from singular configurations."""
        if not candidates:
            return []
        q = np.array([self.si(given["made_of"]) for given in candidates])
        regular = regularity(self.robot, q, self.form.rows) > REGULAR
        poses = forward_kinematics(self.robot, q)
        targets = {i: self.question(candidates[i]) for i in np.flatnonzero(regular).tolist()}
        good = [i in targets and self._reached(targets[i], q[i], poses[i]) for i in range(len(candidates))]
        if not self.redundant:
            chosen = [i for i, one in enumerate(good) if one]
            results = dict(zip(chosen, self._all([targets[i] for i in chosen], poses[chosen]), strict=True))
            for i, result in results.items():
                good[i] = self.clear(result, q[i])
            self._keep({i: candidates[i] for i in chosen if good[i]}, targets)
            for i, result in results.items() if self.scarce else ():
                if good[i]:
                    every = np.array([solution.q for solution in result.solutions])
                    exact = [*every[self.robot.within_limits(every)]]
                    good[i] = len(self.solutions(candidates[i])) == len(exact)
                    # Of the rounded target only something near is known, of the pose before rounding the solutions.
                    self.known[tuple(given_values(self.form, candidates[i]))] = exact
        return good

    @cached_property
    def known(self) -> dict[tuple[float, ...], list[Array]]:
        """The solutions within the limits of targets that were drawn."""
        return {}

    def _keep(self, chosen: Mapping[int, Given], targets: Mapping[int, AnsweredPose]) -> None:
        """Note the solutions of some targets, found together: one by one they take ten times as long."""
        if not chosen:
            return
        poses = np.array([targets[i].T for i in chosen])
        found = solutions_near_each(self.robot, poses, self.allowed, task_of(next(iter(targets.values()))))
        for given, result in zip(chosen.values(), found, strict=True):
            self.known[tuple(given_values(self.form, given))] = [solution.q for solution in result.solutions]

    def _reached(self, target: AnsweredPose, q: Array, T: Array) -> bool:
        """Whether joint values, drawn within the limits, whose pose is T (4, 4) [m] are well within the tolerance."""
        errors = pose_errors(target.T, T, task_of(target))
        return pose_status(*errors, self.tight, target.T) == PASS and not joints_outside(self.robot, q)

    @cached_property
    def tight(self) -> Tolerance:
        """How far a rounded target may be from what it was made of."""
        return replace(self.allowed, position=SLACK * self.allowed.position, angle=SLACK * self.allowed.angle)

    def _all(self, targets: Sequence[AnsweredPose], made_of: Array) -> Sequence[Result]:
        """All solutions of targets, whatever the limits; made_of: (m, 4, 4) [m], the poses before rounding."""
        if not targets:
            return []
        poses = made_of if self.scarce else np.array([one.T for one in targets])
        batch = solve_many(self.robot, poses, limits=False, task=task_of(targets[0]))
        return [batch[i] for i in range(len(targets))]

    def clear(self, result: Result, made_of: Array) -> bool:
        """Whether nothing of an answer (of all solutions, whatever the limits) hangs on a last digit."""
        if not result.complete or result.families or not result.solutions:
            return False
        q = np.array([solution.q for solution in result.solutions])
        if len(q) > MANY or not clear_of_limits(self.robot, q).all():
            return False
        if not (regularity(self.robot, q, self.form.rows) > REGULAR).all():
            return False
        revolute = self.robot.revolute
        far = np.where(revolute, APART * self.allowed.angle, APART * self.allowed.position)
        apart = np.abs(whole_turn(q[:, None] - q[None], revolute)) / far
        pairs = np.max(apart, axis=2)[~np.eye(len(q), dtype=bool)]
        if len(pairs) and np.min(pairs) <= 1.0:
            return False
        near = np.max(np.abs(whole_turn(q - made_of, revolute)) / far, axis=1)
        return bool(np.min(near) < 1.0)

    def quantities(self, given: Given) -> tuple[AskedQuantity, ...]:
        """The joint values."""
        return self.joint_quantities()

    def answers(self, given: Given) -> list[str]:
        """The values of the solution that the target was made of."""
        made_of = self.si(given["made_of"])
        if self.redundant:
            return self.texts(made_of)
        return self.texts(self.nearest(self.solutions(given), made_of))

    def solutions(self, given: Given) -> list[Array]:
        """All solutions within the limits, (n,) [rad | m] each."""
        known = self.known.get(tuple(given_values(self.form, given)))
        if known is not None:
            return known
        target = self.question(given)
        found = solutions_near(self.robot, target.T, self.allowed, task_of(target))
        return [solution.q for solution in found.solutions]

    def nearest(self, solutions: Sequence[Array], made_of: Array) -> Array:
        """The solution nearest to joint values, (n,) [rad | m] both."""
        return min(solutions, key=lambda q: float(np.max(np.abs(whole_turn(q - made_of, self.robot.revolute)))))

    def texts(self, q: Array) -> list[str]:
        """Joint values (n,) [rad | m] in the units, as an answer gives them."""
        units, (lengths, angles) = self.robot.units, self.answer_decimals
        values = in_units(q, joint_factors(self.robot, units))
        return [
            angle_text(value, angles, units) if turns else decimal_text(value, lengths)
            for value, turns in zip(values, self.robot.revolute, strict=True)
        ]

    def enough_decimals(self, given: Given) -> tuple[int, int]:
        """Decimals of lengths and of angles with which no solution, rounded, is outside the tolerance.

        All angles together move the end effector by half the tolerance at most, each length by a twentieth.
        """
        solutions = [self.si(given["made_of"])] if self.redundant else self.solutions(given)
        turning, units = self.robot.revolute, self.robot.units
        levers = np.linalg.norm(jacobian(self.robot, np.array(solutions))[:, :3, turning], axis=1)
        off = self.allowed.position / max(float(np.max(np.sum(levers, axis=1), initial=0.0)), 1e-300)
        if self.form.turns:
            off = min(off, self.allowed.angle / max(int(np.count_nonzero(turning)), 1))
        return self.answer_decimals[0], decimals_for(off / units.radians)

    def subject(self, given: Given) -> JointCheck:
        """The check of joint values."""
        return JointCheck(self.robot, self.robot.units, self.allowed, True, self.every)

    def question(self, given: Given) -> AnsweredPose:
        """The target."""
        return pose_from(given_values(self.form, given), self.form.kind, self.robot, self.robot.units).as_target()

    def answer(self, given: Given, row: Row) -> tuple[GivenAnswer, ...]:
        """The joint values that were answered, or that there are none."""
        return (JointReader(self.robot, self.robot.units).answer(row),)


@dataclass(frozen=True, eq=False)
class SolutionsExercise(JointExercise):
    """All solutions for a target; how many there are is said."""

    kind: ClassVar[str] = "ik-all"
    every: ClassVar[bool] = True

    def accepted(self, candidates: Sequence[Given]) -> list[bool]:
        """The same; of what is accepted the number of solutions is noted."""
        if self.redundant:
            raise InputError(
                f"question {self.id}: {self.about} reaches a pose in infinitely many ways, expected ik, which asks for "
                "one solution"
            )
        good = super().accepted(candidates)
        for given, one in zip(candidates, good, strict=True):
            if one:
                given["count"] = len(self.solutions(given))
        return good

    def quantities(self, given: Given) -> tuple[AskedQuantity, ...]:
        """The joint values of each solution."""
        return tuple(
            one for number in range(1, given["count"] + 1) for one in self.joint_quantities(f"solution {number} ")
        )

    def answers(self, given: Given) -> list[str]:
        """The values of all solutions."""
        return [text for q in self.solutions(given) for text in self.texts(q)]

    def answer(self, given: Given, row: Row) -> tuple[GivenAnswer, ...]:
        """The solutions that were answered; one of which no value is given is left out."""
        reader, names, found = JointReader(self.robot, self.robot.units), self.joint_quantities(), []
        for number in range(1, given["count"] + 1):
            cells = {one.name: row.cells.get(f"solution {number} {one.name}", "") for one in names}
            if row.fault or any(cell.strip() for cell in cells.values()):
                found.append(reader.answer(replace(row, cells=cells)))
        return tuple(found)
