"""`explain_ik`: the closed-form steps from a pose to every joint configuration, with the numbers in them.

What a lesson says is what was computed: each result is the value of the printed formula (formulas.py), and each end is
put through forward kinematics.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from robokin.arrays import Array
from robokin.derivation.derivation_of import Derivation, first_steps, plan_of
from robokin.derivation.worked_steps import Kind, Quantity, Step, WorkedSteps, follow, index
from robokin.errors import InputError
from robokin.inverse.analysis import Task
from robokin.inverse.solve import target_poses
from robokin.inverse.verify import CLOSES, residuals, within_limits, wrapped
from robokin.kernel.chain import chain_of, chain_size
from robokin.kinematics.forward import forward_kinematics
from robokin.model import Robot
from robokin.model.robot import LIMIT_TOLERANCE

FAMILIES = (
    "planar 2R and 3R arms; anthropomorphic, spherical, cylindrical, Cartesian and SCARA arms; a spherical wrist; "
    "such an arm of three joints with a spherical wrist"
)
"""The arms that have a lesson."""

ZERO = 1e-12
"""A joint's zero [rad | m] below this is rounding, and is not worth a step."""


@dataclass(frozen=True, eq=False)
class End:
    """Where one way of a lesson ends: the signs chosen, and q (n,) [rad | m], or None and the reason.

    With q, a reason says why it is no solution: the limits, or what a positioning arm cannot choose.
    """

    branch: str
    q: Array | None
    reason: str


@dataclass(frozen=True, eq=False)
class Lesson:
    """title: the family and its way; given: the geometry; steps: all, one way after the other; ends: one a way."""

    title: str
    given: Mapping[str, Quantity]
    steps: tuple[Step, ...]
    ends: tuple[End, ...]


def require_lesson(robot: Robot, task: Task) -> Derivation:
    """The plan of a robot's lesson. Raises InputError if it has none, or none for that task."""
    return _plan(robot, task, _held(robot, None))


def explain_ik(
    robot: Robot, T: ArrayLike, task: Task = "pose", limits: bool = True, near: ArrayLike | None = None
) -> Lesson:
    """The lesson behind `solve_ik` for one pose of the tool.

    T: (4, 4) [m]; `near`: (n,) [rad | m] where a free joint is held; the others as for `solve_ik`. Raises InputError
    for an arm without a lesson, or a target with less than its lesson starts from.
    """
    pose = target_poses(T)
    if pose.shape != (4, 4):
        raise InputError(f"T: found poses of shape {pose.shape}, expected one (4, 4)")
    near = None if near is None else np.asarray(near, dtype=np.float64)
    plan = _plan(robot, task, _held(robot, near))
    steps, sheets = follow(first_steps(plan, pose), plan.stages)
    ends = []
    for sheet in sheets:
        if sheet.reason:
            ends.append(End(sheet.branch, None, sheet.reason))
            continue
        q, inside, more = _joints(robot, plan, sheet, near)
        place = max((k for k, step in enumerate(steps) if step.branch == sheet.branch), default=-1) + 1
        steps[place:place] = more
        reason = _failure(robot, pose, q, task)
        if not reason and limits and not inside.all():
            names = ", ".join(f"q{index(int(i) + 1)}" for i in np.flatnonzero(np.logical_not(inside)))
            reason = f"outside the joint limits: {names}"
        ends.append(End(sheet.branch, q, reason))
    given = dict(plan.known)
    given |= {f"o{index(i + 1)}": Quantity(o, _kind(robot, i)) for i, o in enumerate(plan.zeros) if abs(o) > ZERO}
    given |= {name: value for name, value in steps[0].values.items() if name not in ("p", steps[0].formula)}
    return Lesson(plan.title, given, tuple(steps), tuple(ends))


def _plan(robot: Robot, task: Task, held: Array) -> Derivation:
    plan = plan_of(robot, held)
    if plan is None:
        raise InputError(f"{robot.name} has no lesson, expected one of these: {FAMILIES}")
    if plan.whole and task != "pose":
        raise InputError(
            f"the lesson of {robot.name} starts from the whole pose, and the target leaves the orientation open, "
            "expected one with an orientation"
        )
    return plan


def _held(robot: Robot, near: Array | None) -> Array:
    """(n,) where a free joint is put: at near, or at zero, or amid its limits."""
    if near is not None:
        return near
    low, high = robot.limits.T
    with np.errstate(invalid="ignore"):
        amid = np.where(np.isfinite(low) & np.isfinite(high), (low + high) / 2.0, np.clip(0.0, low, high))
    return np.where((low <= 0.0) & (high >= 0.0), 0.0, amid)


def _kind(robot: Robot, i: int) -> Kind:
    return "angle" if robot.revolute[i] else "length"


def _joints(robot: Robot, plan: Derivation, sheet: WorkedSteps, near: Array | None) -> tuple[Array, Array, list[Step]]:
    """The joint values of a way's last sheet, which are within the limits, and the steps from the variables to them."""
    bare = np.array([sheet[name] for name in plan.variables]) - plan.zeros
    turned, _ = within_limits(wrapped(bare[None], robot.revolute), robot.revolute, robot.limits, near)
    sheet = WorkedSteps(sheet.known, branch=sheet.branch)
    for i, name in enumerate(plan.variables):
        kind = _kind(robot, i)
        turn, zero = float(turned[0, i] - bare[i]), plan.zeros[i]
        formula, note = name, ""
        if abs(zero) > ZERO:
            sheet = sheet.given(kind, **{f"o{index(i + 1)}": zero})
            formula += f" − o{index(i + 1)}"
            note = "from the joint's own zero"
        if abs(turn) > 1.0 and robot.revolute[i]:
            full = 2.0 * np.pi * round(turn / (2.0 * np.pi))
            sheet = sheet.given("angle", **{f"t{index(i + 1)}": full})
            formula += f" + t{index(i + 1)}"
            note = "by a full turn"
        sheet = sheet.step(f"q{index(i + 1)}", formula, kind, note)
    q = np.array([sheet[f"q{index(i + 1)}"] for i in range(robot.n)])
    low, high = robot.limits.T
    inside = (q >= low - LIMIT_TOLERANCE) & (q <= high + LIMIT_TOLERANCE)
    return q, inside, [step for step in sheet.steps if step.formula not in plan.variables]


def _failure(robot: Robot, T: Array, q: Array, task: Task) -> str:
    """What of the target the configuration q misses, in words, or nothing."""
    reached = forward_kinematics(robot, q)
    position, angle = (float(error[0]) for error in residuals(T[None], reached[None]))
    if position > CLOSES * chain_size(chain_of(robot)):
        return "misses the position: the arm has no joint for what is left"
    if task == "approach":
        angle = float(np.linalg.norm(T[:3, 2] - reached[:3, 2]))
    if task != "position" and angle > CLOSES:
        return "reaches the position, and not the orientation"
    return ""
