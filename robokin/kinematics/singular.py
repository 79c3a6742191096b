"""The singular configurations of an arm, named: shoulder, elbow, wrist, boundary.

The names are geometry. Let P be the wrist centre, or where the last two axes pass nearest to each other, or the hand of
an arm without a wrist:

- shoulder: P lies in the plane through axis 1 that is parallel to axis 2 (on axis 1, for an arm without offsets):
  joint 1, or joint 1 with the wrist, can move and the hand stands still.
- elbow: a joint of the arm stretches or folds it, so that P's distance from the shoulder is greatest or least.
- wrist: the condition is on the last three joints alone.
- boundary: a sliding joint brings P onto an axis before it.
- general: none of these.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array
from robokin.brief import Answer, Brief
from robokin.errors import counted, shown
from robokin.kernel.facts import fact
from robokin.kinematics.forward import joint_frames
from robokin.kinematics.singular_equation import Equation, equation_of, exact_angle, lateral, reference_point
from robokin.kinematics.singular_search import HOLDS, Condition, Search
from robokin.kinematics.structure import structure_of
from robokin.kinematics.velocity import Lost, MotionTask, TaskName, lost_directions, motion_task
from robokin.model import Robot
from robokin.model.robot import LIMIT_TOLERANCE

TRIES = 40
"""Values tried for the joints that do not matter, until an example has lost nothing else and respects the limits."""


@dataclass(frozen=True, eq=False, repr=False)
class Singularity(Brief):
    """A condition on some joints that makes the arm singular, whatever the other joints are.

    joints: in numbers from 1; values: (v, k) [rad | m] their values, k = len(joints), or none (0, k) where the
    condition is an equation; exact: for each row of values the expression that it comes from, or ""; posture: for each
    row stretched, folded or ""; inside: for each row whether the joint limits allow it; equation: what must vanish,
    where that is known; enough: whether the values or the equation alone make the arm singular (else there is another
    equation); example: (n,) [rad | m]; lost: what the tool cannot do at the example.
    """

    name: str
    joints: tuple[int, ...]
    values: Array
    exact: tuple[str, ...]
    posture: tuple[str, ...]
    inside: tuple[bool, ...]
    equation: Equation | None
    enough: bool
    example: Array
    lost: tuple[Lost, ...]


class Singularities(tuple[Singularity, ...], Answer):
    """The conditions that `singular_configurations` found of a robot: a tuple of them.

    `asked` is the task that was asked for, or None, `of` the one that was answered.
    """

    robot: Robot
    asked: TaskName | None
    of: TaskName

    def __repr__(self) -> str:
        """A line: the conditions by name."""
        name = self.robot.id or self.robot.name
        if not self:
            return f"<no singular configuration of {name} was found>"
        return f"<{counted(len(self), 'singular condition')} of {name}: {shown(', '.join(one.name for one in self))}>"


def singular_configurations(robot: Robot, task: TaskName | None = None) -> Singularities:
    """The conditions on the joints under which an arm loses a freedom that it has in general.

    Found by number (`singular_search`), so that a condition on a few joints that lies hidden among the others may be
    missed; what is listed is tested at random values of the joints that it leaves free. `task` is what counts of the
    tool's twist, as in `differential_kinematics`. Raises InputError for a robot without joints.
    """
    kind = motion_task(robot, task)
    found = Singularities(_found(robot, kind))
    found.robot, found.asked, found.of = robot, task, kind.name
    return found


@fact
def _found(robot: Robot, task: MotionTask) -> tuple[Singularity, ...]:
    search = Search(robot, task)
    found = [_named(robot, task, search, condition) for condition in search.conditions()]
    order = ["shoulder", "elbow", "boundary", "wrist", "general"]
    return tuple(sorted(found, key=lambda one: (order.index(one.name), one.joints)))


def _named(robot: Robot, task: MotionTask, search: Search, condition: Condition) -> Singularity:
    joints = condition.joints
    rows = [_in_limits(robot, joints, row) for row in condition.values]
    values = np.array([row for row, _ in rows]).reshape(-1, len(joints))
    exact = tuple(exact_angle(robot, joints[0], float(row[0])) if len(joints) == 1 else "" for row in values)
    name = _name(robot, task, condition)
    posture = _postures(robot, joints[0], values) if name == "elbow" and len(joints) == 1 else ("",) * len(values)
    equation = equation_of(robot, joints, task.size) if name == "shoulder" and not len(values) else None
    enough = bool(len(values)) or (equation is not None and _enough(robot, search, equation))
    example = _example(robot, search, condition, values)
    lost = tuple(lost_directions(robot, example, task=task.name))
    inside = tuple(fits for _, fits in rows)
    return Singularity(
        name, tuple(k + 1 for k in joints), values, exact, posture, inside, equation, enough, example, lost
    )


def _enough(robot: Robot, search: Search, equation: Equation) -> bool:
    """Whether the arm is singular at random configurations that fulfil the equation."""
    # The first joint turns all of it: most values of the others leave one for it.
    joint = min(abs(k) for term in equation.terms for k in term.angles) - 1
    q = equation.solved(search.drawn(TRIES) * search.scale, joint)
    q = q[np.isfinite(q[:, joint])]
    return bool(len(q) and np.max(search.least(q / search.scale)) < HOLDS)


def _in_limits(robot: Robot, joints: tuple[int, ...], row: Array) -> tuple[Array, bool]:
    """Values of joints, each turned by ±360° into its limits if that can be, and whether all are within."""
    out, fits = row.copy(), True
    for i, k in enumerate(joints):
        low, high = robot.limits[k]
        turns = (0.0, -2.0 * np.pi, 2.0 * np.pi) if robot.revolute[k] else (0.0,)
        allowed = [row[i] + turn for turn in turns if low - LIMIT_TOLERANCE <= row[i] + turn <= high + LIMIT_TOLERANCE]
        out[i] = allowed[0] if allowed else row[i]
        fits = fits and bool(allowed)
    return out, fits


def _name(robot: Robot, task: MotionTask, condition: Condition) -> str:
    n, joints, structure = robot.n, condition.joints, structure_of(robot)
    if structure.arm == "spherical wrist" or (n >= 6 and min(joints) >= n - 3):
        return "wrist"
    if len(joints) == 1 and not robot.revolute[joints[0]]:
        return "boundary"
    offset = lateral(robot, condition.met)
    if offset is not None and np.max(np.abs(offset)) < 1e-6 * task.size:
        return "shoulder"
    if n >= 7 and max(joints) <= 2:
        return "shoulder"
    return "elbow" if len(joints) == 1 else "general"


def _postures(robot: Robot, joint: int, values: Array) -> tuple[str, ...]:
    """Stretched or folded: at which value P is farther from where the joint before starts."""
    q = np.zeros((len(values), robot.n))
    q[:, joint] = values[:, 0]
    F = joint_frames(robot, q)
    reach = np.linalg.norm(reference_point(robot, F) - F[:, max(joint - 1, 0), :3, 3], axis=1)
    if len(values) != 2 or abs(reach[0] - reach[1]) < 1e-6 * np.max(reach):
        return ("",) * len(values)
    return ("stretched", "folded") if reach[0] > reach[1] else ("folded", "stretched")


def _example(robot: Robot, search: Search, condition: Condition, values: Array) -> Array:
    """A configuration that fulfils the condition, within the limits and with nothing else lost if that can be."""
    rng = np.random.default_rng(5)
    joints = list(condition.joints)
    low, high = robot.limits.T
    low, high = (
        np.where(np.isfinite(low), low, -np.pi * search.scale),
        np.where(np.isfinite(high), high, np.pi * search.scale),
    )
    free = np.setdiff1d(np.arange(robot.n), joints)
    wanted = values if len(values) else condition.met[:, joints]
    fits = [_in_limits(robot, condition.joints, row) for row in wanted]
    fits.sort(key=lambda pair: not pair[1])
    best, least = np.array(condition.met[0]), np.inf
    for attempt in range(TRIES):
        q = np.empty(robot.n)
        # Round numbers first: an example is for people.
        part = np.radians(5.0) * np.where(robot.revolute, 1.0, np.degrees(0.02) * search.task.size)
        drawn = np.round(rng.uniform(0.8 * low + 0.2 * high, 0.2 * low + 0.8 * high) / part) * part
        q[free] = np.clip(drawn, low, high)[free]
        q[joints] = fits[attempt % len(fits) if not len(values) else 0][0]
        singular = np.linalg.svd(search.matrices(q / search.scale), compute_uv=False) / search.task.dimension
        last = search.task.dimension - 1
        if singular[last] > HOLDS:
            continue
        score = float(not robot.within_limits(q)) + float(last > 0 and singular[last - 1] < 1e-2)
        if score < least:
            best, least = q, score
        if not score:
            break
    return best
