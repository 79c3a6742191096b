"""Paths of the tool along a curve, the joints on one branch.

A straight line: the position moves linearly with s, the rotation about one fixed axis (slerp). Of all inverse
kinematics solutions at a pose the one nearest to where the last configurations lead is taken. Where that moves a joint
by more than `NEAR`, the step is halved, again and again: near a singularity a joint may move fast, and a finer step
shows that it still moves; a step that stays large however fine it is made is a jump to another branch, and the line
ends before it.
Where the start is singular the ways on are told by the solutions a little way along. If none begins at the start itself
the line begins from another configuration with its pose, which joints turn to while the tool stands still; of several
ways the one that gets farthest is taken, and of those that reach the end that with the least travel of a joint.
Redundant arms, and arms that lack directions that the task leaves open, are followed by steps of least joint motion.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import cast

import numpy as np

from robokin.arrays import Array
from robokin.expected import expect_choice, expect_flag
from robokin.inverse.follow import BEGUN, CONTINUES, HALVINGS, ITSELF
from robokin.inverse.followers import Follows, follower_of
from robokin.inverse.joint_paths import (
    NEARLY,
    Event,
    Path,
    PathTask,
    leaves_between,
    limited_values,
    line_task,
    path_of_rows,
)
from robokin.inverse.solve import solve_many
from robokin.inverse.tool_curves import ToolCurve
from robokin.kernel.ranks import RANK
from robokin.kinematics.forward import forward_kinematics
from robokin.kinematics.structure import arm_size
from robokin.kinematics.velocity import TaskName, dexterity, differential_kinematics, motion_task
from robokin.model import Robot
from robokin.spatial.angles import circled

BISECTIONS = 40
"""Halvings that place an event on the path: to 1e-12 of it, as long as steps are a hundredth."""

LOOKED_AT = 65
"""Configurations of a turn of joints at which the tool must stand still."""

STANDS = 1e-9
"""How far it may be off [size and rad]: rounding of a configuration that is read off solutions beside it."""

ELSEWHERE = "it goes on only from another configuration with this pose"


def follow_curve(
    robot: Robot,
    first: Array,
    curve: ToolCurve,
    t: Array,
    s: Array,
    limits: bool,
    task: PathTask | None,
    halvings: int = HALVINGS,
) -> Path:
    """The tool along a curve from where it is at first (n,) [rad | m], at parts s (m,) of the way and times t (m,).

    `task` is what follows the curve: the whole pose, or the position alone, as is taken for arms of up to three joints
    that place a point. The path ends where a joint leaves its limits (with `limits`), where there is no solution, or
    where a joint would jump. It may begin with another configuration than `first`, with the same pose: one that
    `keeps_pose` on the way to it. halvings: how often a step is halved at most until it is a jump.
    """
    limits = expect_flag(limits, "limits")
    chosen = line_task(robot) if task is None else cast(PathTask, expect_choice(task, ("pose", "position"), "task"))
    follower = follower_of(robot, curve.at, chosen, s, halvings)
    ways: Sequence[tuple[Array, Array | None]] = follower.beginnings(first)
    scale = joint_scale(robot)
    if ways:
        tracks = [
            _track(robot, follower, s, begin, begun, limits, chosen)
            for begin, begun in ways
            if keeps_pose(robot, first, begin, chosen)
        ]
        tracks = tracks or [_Track(first[None], 0.0, Event("jump", 0.0, ELSEWHERE))]
    else:
        tracks = [_track(robot, follower, s, first, None, limits, chosen)]
    track = min(tracks, key=lambda one: (-one.fraction, joint_travel(one.rows, scale)))
    rows = track.rows
    if np.max(np.abs(rows[0] - first) / scale) <= ITSELF:
        rows[0] = first
    m = len(rows)
    counted: TaskName | None = "position" if chosen == "position" else None
    return path_of_rows(robot, t[:m], s[:m], rows, track.fraction, track.event, len(s) - 1, counted)


def rows_from(robot: Robot, q: Array, curve: ToolCurve, s: Array, task: PathTask) -> Array:
    """Rows (k, n) at parts s (m,) of the way from q (n,) at the first of them, as far as they can be followed."""
    return _track(robot, follower_of(robot, curve.at, task, s), s, q, None, False, task).rows


def branch_starts(robot: Robot, curve: ToolCurve, task: PathTask) -> Array:
    """Where branches along a curve may begin: configurations (k, n) [rad | m], also outside the limits.

    All solutions at the curve's first pose; where that is singular, those that the solutions a little way on come from.
    Of an arm with joints to spare some.
    """
    first = solve_many(robot, curve.at(np.zeros(1)), limits=False, task=task)
    rows = first.q[0, : first.count[0]]
    if not len(rows):
        return rows
    least, _ = dexterity(robot, rows, "position" if task == "position" else None)
    if least.min() > RANK:
        return rows
    begun = solve_many(robot, curve.at(np.array([BEGUN])), limits=False, task=task)
    starts = []
    for other in begun.q[0, : begun.count[0]]:
        near = solve_many(robot, curve.at(np.zeros(1)), limits=False, near=other, task=task, most=1)
        if near.count[0] and np.max(np.abs(circled(near.q[0, 0] - other, robot.revolute))) <= CONTINUES:
            starts.append(near.q[0, 0])
    return np.array(starts).reshape(-1, robot.n)


def passable(robot: Robot, curve: ToolCurve, task: PathTask, steps: int) -> bool:
    """Whether there are solutions, within the limits or not, at all of some even steps of a curve."""
    found = solve_many(robot, curve.at(np.linspace(0.0, 1.0, steps + 1)), limits=False, task=task, most=1)
    return bool((found.count > 0).all())


def keeps_pose(robot: Robot, first: Array, last: Array, task: PathTask) -> bool:
    """Whether what follows a line stands still while joints turn in proportion from first (n,) to last (n,)."""
    q = first + np.linspace(0.0, 1.0, LOOKED_AT)[:, None] * (last - first)
    T = forward_kinematics(robot, q)
    off = np.abs(T - T[0])
    turned = 0.0 if task == "position" else float(np.max(off[:, :3, :3]))
    return max(float(np.max(off[:, :3, 3])) / arm_size(robot), turned) <= STANDS


def joint_scale(robot: Robot) -> Array:
    """(n,) what moves of joints are compared in: 1 rad, or the arm's size [m]."""
    return np.where(robot.revolute, 1.0, arm_size(robot))


def joint_travel(q: Array, scale: Array) -> float:
    """How far the joint that travels farthest goes on rows q (m, n), both ways counted [rad | size]."""
    return float(np.max(np.sum(np.abs(np.diff(q, axis=0)), axis=0) / scale))


@dataclass(frozen=True, eq=False)
class _Track:
    """Rows (m, n) as far as they can be followed, the part of the way, and what ends them."""

    rows: Array
    fraction: float = 1.0
    event: Event | None = None


def _track(
    robot: Robot, follower: Follows, s: Array, first: Array, begun: Array | None, limits: bool, task: PathTask
) -> _Track:
    """One branch from first (n,), which at the part `BEGUN` is where `begun` (n,) says, if it does."""
    rows, i, q, at = [first[None]], 1, first, float(s[0])
    if limits and not robot.within_limits(first):
        fraction, event = leaves_between(robot, first, first)
        if event is not None:
            return _Track(first[None], fraction, event)
    if begun is not None:
        while i < len(s) and s[i] <= BEGUN:
            found = follower.nearest(begun, float(s[i]))
            rows.append((begun if found is None else found)[None])
            i += 1
        q, at = begun, BEGUN
    follower.begin(q)
    while i < len(s):
        ahead = follower.run(q, i)
        if not len(ahead):
            reached, found, why = follower.advance(q, at, i)
            if why and (not limits or robot.within_limits(found)):
                return _Track(np.concatenate(rows), reached, _stopped(robot, reached, found, why, task))
            ahead = found[None]
        else:
            reached = float(s[i])
        inside = robot.within_limits(ahead) if limits else np.ones(len(ahead), dtype=bool)
        good = len(ahead) if inside.all() else int(np.argmin(inside))
        if good:
            rows.append(ahead[:good])
            q, i = ahead[good - 1], i + good
            at = float(s[i - 1])
        if good < len(ahead):
            end = reached if not good else float(s[i])
            return _Track(np.concatenate(rows), *_limit_event(robot, follower, q, at, end))
    return _Track(np.concatenate(rows))


def _limit_event(robot: Robot, follower: Follows, q: Array, s: float, reached: float) -> tuple[float, Event]:
    """Where between s, with q, and `reached` the first joint leaves its limits."""
    low, high = s, reached
    outside = q
    for _ in range(BISECTIONS):
        middle = (low + high) / 2.0
        if middle in (low, high):
            break
        found = follower.stepped(q, middle)
        found = follower.nearest(q, middle) if found is None else found
        if found is not None and robot.within_limits(found):
            low, q = middle, found
        else:
            high, outside = middle, outside if found is None else found
    values, _, limits, words = limited_values(robot, np.stack([outside, outside]))
    k = int(np.argmax(np.maximum(values - limits[:, 1], limits[:, 0] - values)))
    value = float(limits[k, 1] if values[k] > limits[k, 1] else limits[k, 0])
    return low, Event("limit", low, f"{words[k]} leaves its limits", k + 1 if k < robot.n else None, value)


def _stopped(robot: Robot, s: float, q: Array, why: str, task: PathTask) -> Event:
    """What ends a line at s with the configuration q."""
    found = differential_kinematics(robot, q, task=cast(TaskName, task))
    lost = ""
    if found.singular_values[-1] < NEARLY:
        # The end is near a singularity, not on it: what is lost there is what moves least here.
        M = found.task.dimension
        lost = f" at a singularity, rank {min(int(np.sum(found.singular_values >= NEARLY)), M - 1)} of {M}"
    if why == "jump":
        return Event("jump", s, f"no solution follows the last one without a jump{lost}")
    if task == "pose" and motion_task(robot).dimension < 6 and not lost:
        return Event("unreachable", s, "no solution with the orientation of the line (task position leaves it free)")
    return Event("unreachable", s, f"the arm reaches no further{lost}")
