"""Joint values marked: does a configuration reach a target, and are several all the solutions there are?

Whether a configuration is right is decided by forward kinematics alone: it reaches the target within the tolerance,
and its values, or those turned by 360°, are within the limits. Which solution it stands for matters only where all
are asked for: the one nearest to it in the joints, modulo 360°. Each solution is counted once. Near a singular pose,
where rounding can bring an answer nearer to its neighbour, it may stand for that one as well.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from robokin.arrays import Array
from robokin.brief import Brief
from robokin.grading.distinct import apart, firsts
from robokin.grading.pose_difference import PASS, pose_errors, pose_status
from robokin.grading.tolerance import Tolerance
from robokin.inverse.analysis import Task
from robokin.inverse.self_motion.redundant import NOT_FOUND, UNPROVEN
from robokin.inverse.solutions import Result, Solution
from robokin.inverse.solve import solve_many
from robokin.inverse.verify import within_limits
from robokin.kinematics.forward import forward_kinematics
from robokin.model import Robot

OUTSIDE, DUPLICATE, MISSING, EXTRA, BOTH = (
    "outside limits", "duplicate", "missing solution", "extra", "missing and extra",
)  # fmt: skip

NEIGHBOUR = 3.0
"""An answer may stand for a solution up to so many times farther off than the nearest, and four times the angle
tolerance more: what rounding can do where two solutions are close together."""


@dataclass(frozen=True, eq=False, repr=False)
class Reached(Brief):
    """How one configuration q (n,) [rad | m] does: its status, its errors [m, rad], the joints outside (from 1)."""

    q: Array
    status: str
    position: float
    angle: float
    outside: tuple[int, ...] = ()

    @property
    def right(self) -> bool:
        """Whether it solves the task."""
        return self.status == PASS


@dataclass(frozen=True, eq=False, repr=False)
class SetMark(Brief):
    """How several configurations do as the set of all solutions.

    answers: one each, in order; missing: the solutions (n,) [rad | m] that none stands for; `counted` is false
    where there are infinitely many, so that none can be missing; result: what there is to find.
    """

    answers: tuple[Reached, ...]
    missing: tuple[Array, ...]
    counted: bool
    result: Result

    @property
    def status(self) -> str:
        """The set's word."""
        wrong = any(answer.status not in (PASS, DUPLICATE) for answer in self.answers)
        if wrong:
            return BOTH if self.missing else EXTRA
        if self.missing:
            return MISSING
        return DUPLICATE if any(not answer.right for answer in self.answers) else PASS

    @property
    def score(self) -> float:
        """The right answers as a part of all answers and all that is missing."""
        total = len(self.answers) + len(self.missing)
        return sum(answer.right for answer in self.answers) / total if total else 1.0


def reached(robot: Robot, q: Array, T: Array, allowed: Tolerance, task: Task = "pose", limits: bool = True) -> Reached:
    """How a configuration q (n,) [rad | m] does for a target T (4, 4) [m]."""
    position, angle = pose_errors(T, forward_kinematics(robot, q), task)
    status = pose_status(position, angle, allowed, T)
    outside: tuple[int, ...] = ()
    if limits and status == PASS:
        outside = joints_outside(robot, q)
        status = OUTSIDE if outside else PASS
    return Reached(q, status, position, angle, outside)


def joints_outside(robot: Robot, q: Array) -> tuple[int, ...]:
    """The joints (from 1) whose value is outside the limits, also when it is turned by multiples of 360°."""
    if within_limits(q[None], robot.revolute, robot.limits, q)[1][0]:
        return ()
    each = [
        within_limits(q[None, i : i + 1], robot.revolute[i : i + 1], robot.limits[i : i + 1], q[i : i + 1])[1][0]
        for i in range(robot.n)
    ]
    return tuple(i + 1 for i, inside in enumerate(each) if not inside)


def solutions_near(robot: Robot, T: Array, allowed: Tolerance, task: Task = "pose", limits: bool = True) -> Result:
    """Every solution for a target T (4, 4) [m]; where there is none, those of the nearest pose within the tolerance.

    A target whose digits were cut may be just beyond what an arm with few joints can do.
    """
    return solutions_near_each(robot, T[None], allowed, task, limits)[0]


def solutions_near_each(
    robot: Robot, targets: Array, allowed: Tolerance, task: Task = "pose", limits: bool = True
) -> list[Result]:
    """The same for targets (m, 4, 4) [m]: together they take a tenth of the time."""
    arguments: dict[str, Any] = {"limits": limits, "task": task}
    batch = solve_many(robot, targets, **arguments)
    found = [batch[i] for i in range(len(targets))]
    near: dict[int, Solution] = {}
    for i, result in enumerate(found):
        nearest = result.nearest
        if nearest is None or pose_status(nearest.position_error, nearest.angle_error, allowed, targets[i]) != PASS:
            continue
        near[i] = nearest
    if not near:
        return found
    again = solve_many(robot, forward_kinematics(robot, np.array([one.q for one in near.values()])), limits=limits)
    for k, (i, nearest) in enumerate(near.items()):
        if task == "pose" and again[k].solutions:
            found[i] = again[k]
            continue
        usable = nearest.within_limits or not limits
        own = (nearest,) if usable else ()
        found[i] = replace(found[i], solutions=own, complete=False, basis=None, postures=False)
    return found


def countable(result: Result) -> bool:
    """Whether a list names every solution, so that one can be missing: not where solutions lie on a self-motion."""
    return (result.complete and not result.families) or result.postures


def proven_none(result: Result) -> bool:
    """Whether it is proven that a target has no solution: a search that found none proves nothing."""
    return not result.solutions and result.reason not in (None, NOT_FOUND, UNPROVEN)


def mark_set(
    robot: Robot, configurations: list[Array], T: Array, allowed: Tolerance, task: Task = "pose", limits: bool = True,
    known: Result | None = None,
) -> SetMark:  # fmt: skip
    """How configurations (n,) [rad | m] do as the set of all solutions for a target T (4, 4) [m].

    known: what there is to find, if that has been sought before.
    """
    answers = [reached(robot, q, T, allowed, task, limits) for q in configurations]
    result = solutions_near(robot, T, allowed, task, limits) if known is None else known
    counted = countable(result)
    right = [i for i, answer in enumerate(answers) if answer.right]
    if not right:
        missing = tuple(s.q for s in result.solutions) if counted else ()
        return SetMark(tuple(answers), missing, counted, result)
    given = np.array([answers[i].q for i in right])
    if not counted:
        for place, first in enumerate(firsts(robot, given, allowed)):
            if first != place:
                answers[right[place]] = replace(answers[right[place]], status=DUPLICATE)
        return SetMark(tuple(answers), (), False, result)
    free = frozenset(joint - 1 for solution in result.solutions for joint in solution.free)
    far = np.array([apart(robot, s.q, given, allowed, free) for s in result.solutions]).reshape(-1, len(right)).T
    chosen = _matching(far, 4.0 * allowed.angle)
    for i, k in zip(right, chosen, strict=True):
        if k is None and result.solutions:
            answers[i] = replace(answers[i], status=DUPLICATE)
    missing = tuple(s.q for k, s in enumerate(result.solutions) if k not in chosen)
    return SetMark(tuple(answers), missing, True, result)


def _matching(far: Array, more: float) -> list[int | None]:
    """For each row the column that it stands for, each column once and as many rows as can be (Kuhn's augmenting
    paths); far: (m, k) how far they are apart."""
    order = [np.argsort(row, kind="stable").tolist() for row in far]
    may = [[k for k in ks if far[i, k] <= NEIGHBOUR * far[i, ks[0]] + more] for i, ks in enumerate(order)]
    taken: dict[int, int] = {}

    def place(i: int, seen: set[int]) -> bool:
        for k in may[i]:
            if k not in seen:
                seen.add(k)
                if k not in taken or place(taken[k], seen):
                    taken[k] = i
                    return True
        return False

    for i in sorted(range(len(far)), key=lambda i: float(np.min(far[i], initial=np.inf))):
        place(i, set())
    stands: dict[int, int] = {i: k for k, i in taken.items()}
    return [stands.get(i) for i in range(len(far))]
