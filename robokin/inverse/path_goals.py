"""Where paths go, and which configurations they take there.

Statement. Give the curve of the tool to a goal; or, for joints that move together, the configurations at all goals.
Derivation. Of the solutions at each pose of a path those are taken with which the farthest moves of a joint, added up
from point to point, are least (dynamic programming): the nearest one at each point may lead to where the next one is
far. Full turns of joints within the limits are other solutions.
Degenerate case. Of infinitely many solutions at a pose the nearest to the last configuration is taken.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from robokin.arrays import Array
from robokin.errors import InputError
from robokin.inverse.analysis import analysis_of
from robokin.inverse.follow import HALVINGS
from robokin.inverse.followed_curves import joint_scale
from robokin.inverse.frame_motions import FARTHEST
from robokin.inverse.full_turns import equivalents, turns_of_limits
from robokin.inverse.joint_paths import PathTask, line_task
from robokin.inverse.rounded_curves import CornerRounding, rounded
from robokin.inverse.solutions import Result
from robokin.inverse.solve import solve_ik
from robokin.inverse.tool_curves import CircularArc, Line, ToolCurve
from robokin.kinematics.forward import forward_kinematics
from robokin.kinematics.structure import arm_size
from robokin.model import CoupledRobot, Robot
from robokin.spatial.angles import circled

if TYPE_CHECKING:
    from robokin.inverse.trajectories import Timing

Way = Literal["joint", "line", "arc"]

OTHERS = 1e-6
"""Weight of all joints' moves beside the farthest one's, which tells equals apart."""

MOST_TURNED = 1000
"""Solutions with full turns at a pose that are compared at most; else each is turned near to the last."""


@dataclass(frozen=True, eq=False)
class Goal:
    """Where a path goes: joint values q (n,), or a pose T (4, 4) [m] with its task, as `solve_ik` has it.

    via: (3,) [m] a place by which the tool goes there on a circle, None for a straight line.
    """

    q: Array | None = None
    T: Array | None = None
    task: str = "pose"
    via: Array | None = None


@dataclass(frozen=True, eq=False)
class Manner:
    """How a path gets there.

    way: all joints together, or the tool along straight lines, or also arcs; limits: whether it ends where a joint
    leaves them; follows: what follows a line, the whole pose or the position; timing: None for a path without a
    duration, whose t is from 0 to 1; halvings: as `follow_curve` has it; rounding: how the tool passes by the points
    between, None where it stops at them.
    """

    way: Way = "joint"
    limits: bool = True
    follows: PathTask | None = None
    timing: Timing | None = None
    halvings: int = HALVINGS
    rounding: CornerRounding | None = None


Leg = Sequence[Goal]
"""Goals to which the tool goes without a stop between them: one, or all where their corners are rounded."""


def expect_near(robot: Robot, goals: Sequence[Goal]) -> None:
    """Raise InputError for joint values whose pose is too far away: squares of what is larger are no numbers."""
    with np.errstate(over="ignore", invalid="ignore"):
        poses = [forward_kinematics(robot, goal.q) for goal in goals if goal.q is not None]
    if any(not np.all(np.abs(T) < FARTHEST) for T in poses):
        raise InputError("the pose is too far away for a number, expected less")


def tool_curve(robot: Robot, start: Array, leg: Leg, manner: Manner) -> tuple[ToolCurve, PathTask | None] | str:
    """The curve from joint values start (n,) to goals without a stop, and what follows it; or why one is not reached.

    Raises InputError for an arc that is none, and for corners that cannot be rounded.
    """
    T = forward_kinematics(robot, start)
    follows = manner.follows
    curves: list[Line | CircularArc] = []
    for goal in leg:
        first, T = T, np.eye(4)
        if goal.q is not None:
            T = forward_kinematics(robot, goal.q)
        else:
            T, task = _asked(robot, first, goal, manner)
            if goal.task == "position" and line_task(robot) == "position":
                follows = follows or "position"
            if task == "approach":
                # The roll about the tool's axis is free: that of the solution nearest to the start.
                found = nearest_to(robot, start, T, "approach", manner.limits)
                if not found.solutions:
                    return found.reason or "not reached"
                T = forward_kinematics(robot, found.solutions[0].q)
        curves.append(Line(first, T) if goal.via is None else CircularArc(first, goal.via, T))
    if manner.rounding is None:
        return curves[0], follows
    return rounded(curves, manner.rounding, arm_size(robot)), follows


def points_through(robot: Robot, stages: Sequence[Goal], manner: Manner) -> list[Array] | str:
    """Joint values (n,) at all stages of a path by joints, or why one of them is not reached."""
    scale = joint_scale(robot)
    # For each stage the configurations, the least sum of moves to each, and from which of the stage before.
    rows: list[Array] = []
    sums: list[Array] = []
    came: list[Array] = []
    for k, stage in enumerate(stages):
        guess = rows[-1][int(np.argmin(sums[-1]))] if k else robot.poses.get("home", np.zeros(robot.n))
        found = stage.q[None] if stage.q is not None else _solutions(robot, guess, stage, manner, k == 0)
        if isinstance(found, str):
            return found
        if not k:
            rows, sums, came = [found], [np.zeros(len(found))], [np.zeros(len(found), dtype=np.intp)]
            continue
        moves = np.abs(found[None] - rows[-1][:, None]) / scale
        total = sums[-1][:, None] + np.max(moves, axis=2) + OTHERS * np.sum(moves, axis=2)
        best = np.argmin(total, axis=0)
        rows.append(found)
        sums.append(total[best, np.arange(len(found))])
        came.append(best)
    place = int(np.argmin(sums[-1]))
    points = []
    for k in range(len(stages) - 1, -1, -1):
        points.append(rows[k][place])
        place = int(came[k][place])
    return points[::-1]


def _solutions(robot: Robot, last: Array, stage: Goal, manner: Manner, first: bool) -> Array | str:
    """The configurations (k, n) for a stage of a path by joints, from about joint values last (n,); or why none."""
    T, task = _asked(robot, forward_kinematics(robot, last), stage, manner)
    analysis = analysis_of(robot, task)  # type: ignore[arg-type]
    near = nearest_to(robot, last, T, task, manner.limits)
    if not near.solutions:
        return near.reason or "not reached"
    whole = solve_ik(robot, T, limits=manner.limits, task=task) if not analysis.redundancy else near  # type: ignore[arg-type]
    assert isinstance(whole, Result)
    if analysis.redundancy or analysis.idle or analysis.solver is None or whole.families:
        return near.solutions[0].q[None]
    q = np.array([one.q for one in whole.solutions])
    if isinstance(robot, CoupledRobot):
        return np.concatenate([near.solutions[0].q[None], q])
    turned = last + circled(q - last, robot.revolute)
    if manner.limits:
        if turns_of_limits(robot) * len(q) <= MOST_TURNED:
            return equivalents(robot, q)[0]
        turned = turned[robot.within_limits(turned)]
    return np.concatenate([near.solutions[0].q[None], turned, q] if not first else [near.solutions[0].q[None], q])


def _asked(robot: Robot, before: Array, goal: Goal, manner: Manner) -> tuple[Array, str]:
    """The pose (4, 4) that a goal comes to from the pose `before` (4, 4), and its task."""
    assert goal.T is not None
    if goal.task == "position" and line_task(robot) == "pose":
        T = goal.T.copy()
        T[:3, :3] = before[:3, :3]
        return T, manner.follows or line_task(robot)
    return goal.T, "approach" if goal.task == "approach" else manner.follows or line_task(robot)


def nearest_to(robot: Robot, start: Array, T: Array, task: str, limits: bool) -> Result:
    """The answer with the solution nearest to the start alone."""
    result = solve_ik(robot, T, limits=limits, near=start, task=task, most=1)  # type: ignore[arg-type]
    assert isinstance(result, Result)
    return result
