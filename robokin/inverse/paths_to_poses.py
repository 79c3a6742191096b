"""Paths from a configuration through others and poses: which solutions they take, and how they get there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from robokin.arrays import Array
from robokin.errors import InputError
from robokin.inverse.joint_paths import (
    Path,
    PathTask,
    follow_curve,
    interpolate_joints,
    line_task,
    no_path,
    time_law,
)
from robokin.inverse.solutions import Result
from robokin.inverse.solve import solve_ik
from robokin.inverse.tool_curves import CircularArc, Line, ToolCurve
from robokin.inverse.trajectories import Timing, joined, row_times, timed_curve, trajectory
from robokin.kinematics.forward import forward_kinematics
from robokin.model import Robot

Way = Literal["joint", "line", "arc"]


@dataclass(frozen=True, eq=False)
class Goal:
    """Where a path goes: joint values q (n,), or a pose T (4, 4) [m] with its task, as `solve_ik` has it."""

    q: Array | None = None
    T: Array | None = None
    task: str = "pose"


@dataclass(frozen=True, eq=False)
class Manner:
    """How a path gets there.

    way: all joints together, or the tool along straight lines or an arc, which goes by the place `via` (3,) [m];
    limits: whether it ends where a joint leaves them; follows: what follows a line, the whole pose or the position;
    timing: None for a path without a duration, whose t is from 0 to 1.
    """

    way: Way = "joint"
    via: Array | None = None
    limits: bool = True
    follows: PathTask | None = None
    timing: Timing | None = None


def path_through(robot: Robot, start: Array, goals: Sequence[Goal], steps: int, manner: Manner) -> Path:
    """A path from joint values start (n,) [rad | m] through all goals, to a pose by the solution nearest to the last.

    A position alone keeps the orientation of what was before, where the arm can turn its tool. A pose that is not
    reached makes a path of its start alone. steps: of the whole path by joints, of each piece of a line. A duration is
    of the whole path: pieces of a line share it like the least times that limits allow them, evenly without limits.
    """
    if manner.way == "joint":
        return _by_joints(robot, start, goals, steps, manner)
    if manner.way == "arc" and len(goals) > 1:
        raise InputError(f"found {len(goals)} ends of an arc, expected one")
    paths = _pieces(robot, start, goals, steps, manner)
    # What is not reached counts as a part of the way.
    paths_left = len(goals) - len(paths)
    whole = joined(paths, manner.timing.rate if manner.timing is not None else None)
    if not paths_left:
        return whole
    share = len(paths) / len(goals)
    events = tuple(replace(event, fraction=event.fraction * share) for event in whole.events)
    asked = manner.timing.duration if manner.timing is not None else None
    duration = whole.duration if asked is None else asked
    return replace(whole, s=whole.s * share, fraction=whole.fraction * share, events=events, duration=duration)


def _pieces(robot: Robot, start: Array, goals: Sequence[Goal], steps: int, manner: Manner) -> list[Path]:
    """The tool along a line to each goal, or along an arc, as far as it gets."""
    timing = manner.timing
    if timing is None or timing.duration is None or len(goals) == 1:
        return _followed(robot, start, goals, steps, [manner] * len(goals))
    # The pieces as fast as they may be say how they share the duration.
    free = replace(manner, timing=replace(timing, duration=None, rate=None))
    fastest = [path.duration or 1.0 for path in _followed(robot, start, goals, steps, [free] * len(goals))]
    longer = timing.duration / (sum(fastest) * len(goals) / len(fastest))
    bounded = bool(np.isfinite([timing.limits.velocity, timing.limits.acceleration]).any())
    if bounded and longer < 1.0 - 1e-9:
        least = timing.duration / longer
        found = f"found a duration of {timing.duration:g} s"
        raise InputError(f"{found}, expected at least {least:.6g} s within the limits")
    longer = max(longer, 1.0) if bounded else longer
    manners = [replace(manner, timing=replace(timing, duration=longer * time)) for time in fastest]
    return _followed(robot, start, goals, steps, manners)


def _followed(robot: Robot, start: Array, goals: Sequence[Goal], steps: int, manners: Sequence[Manner]) -> list[Path]:
    """The tool to each goal in its manner, as far as it gets."""
    paths: list[Path] = []
    for goal, manner in zip(goals, manners, strict=False):
        timing = manner.timing
        if timing is not None:
            since = sum(path.duration or 1.0 for path in paths)
            manner = replace(manner, timing=replace(timing, since=since))
        paths.append(path := _by_tool(robot, paths[-1].q[-1] if paths else start, goal, steps, manner))
        if not path.complete:
            break
    return paths


def _by_joints(robot: Robot, start: Array, goals: Sequence[Goal], steps: int, manner: Manner) -> Path:
    """All joints together, from point to point."""
    points = [start]
    for goal in goals:
        if goal.q is not None:
            points.append(goal.q)
            continue
        found = _nearest(robot, points[-1], *_asked(robot, points[-1], goal, manner), manner.limits)
        if not found.solutions:
            return no_path(robot, start, found.reason or "not reached", steps)
        points.append(found.solutions[0].q)
    timing = manner.timing
    if timing is None and len(points) == 2:
        return interpolate_joints(robot, points[0], points[1], steps, manner.limits)
    told: dict[str, Any] = {}
    if timing is not None:
        told = {name: getattr(timing, name) for name in ("duration", "profile", "passing", "blend", "rate")}
        told |= {"max_velocity": timing.limits.velocity, "max_acceleration": timing.limits.acceleration}
    path = trajectory(robot, np.array(points), steps=steps, limits=manner.limits, **told)
    return path if timing is not None else replace(path, duration=None, velocity=None, acceleration=None)


def _by_tool(robot: Robot, start: Array, goal: Goal, steps: int, manner: Manner) -> Path:
    """The tool along a line or an arc."""
    first = forward_kinematics(robot, start)
    follows = manner.follows
    if goal.q is not None:
        T = forward_kinematics(robot, goal.q)
    else:
        T, task = _asked(robot, start, goal, manner)
        if goal.task == "position" and line_task(robot) == "position":
            follows = follows or "position"
        if task == "approach":
            # The roll about the tool's axis is free: that of the solution nearest to the start.
            found = _nearest(robot, start, T, "approach", manner.limits)
            if not found.solutions:
                path = no_path(robot, start, found.reason or "not reached", steps)
                return replace(path, kind=manner.way)
            T = forward_kinematics(robot, found.solutions[0].q)
    curve: ToolCurve = Line(first, T) if manner.via is None else CircularArc(first, manner.via, T)
    if manner.timing is None:
        t = row_times(1.0, steps, None)
        path = follow_curve(robot, start, curve, t, time_law(t), manner.limits, follows)
    else:
        path = timed_curve(robot, start, curve, manner.timing, steps, manner.limits, follows)
    return replace(path, kind=manner.way)


def _asked(robot: Robot, start: Array, goal: Goal, manner: Manner) -> tuple[Array, str]:
    """The pose (4, 4) that a goal comes to from joint values start (n,), and its task."""
    assert goal.T is not None
    if goal.task == "position" and line_task(robot) == "pose":
        T = goal.T.copy()
        T[:3, :3] = forward_kinematics(robot, start)[:3, :3]
        return T, manner.follows or line_task(robot)
    return goal.T, "approach" if goal.task == "approach" else manner.follows or line_task(robot)


def _nearest(robot: Robot, start: Array, T: Array, task: str, limits: bool) -> Result:
    """The answer with the solution nearest to the start alone."""
    result = solve_ik(robot, T, limits=limits, near=start, task=task, most=1)  # type: ignore[arg-type]
    assert isinstance(result, Result)
    return result
