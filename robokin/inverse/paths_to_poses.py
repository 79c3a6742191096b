"""Paths from a configuration through others and poses: which solutions they take, and how they get there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, cast

import numpy as np
from numpy.typing import ArrayLike

from robokin.arrays import Array
from robokin.errors import InputError
from robokin.expected import expect_choice, expect_flag, expect_whole
from robokin.inverse.follow import MOST
from robokin.inverse.followed_curves import branch_starts, follow_curve, passable
from robokin.inverse.joined_paths import joined
from robokin.inverse.joint_paths import (
    Path,
    PathBranch,
    PathTask,
    interpolate_joints,
    line_task,
    no_path,
    one_configuration,
    time_law,
)
from robokin.inverse.path_branches import branches_of, with_chosen
from robokin.inverse.path_goals import Goal, Leg, Manner, nearest_to, points_through, tool_curve
from robokin.inverse.rounded_curves import RoundedCurve, choices
from robokin.inverse.solve import target_poses
from robokin.inverse.trajectories import reorientation, row_times, timed_curve, too_short, trajectory
from robokin.kinematics.forward import forward_kinematics
from robokin.kinematics.velocity import is_singular
from robokin.model import Robot

TRIED = 100
"""Steps of each piece with which branches are tried: which is best must not hang on how many rows are asked for."""

TRIED_HALVINGS = 14
"""How often a step of these is halved: where a branch that is not taken ends is known to a millionth of the way."""

NOTHING_BETWEEN = (
    "there is no point between the start and the end: a straight piece with a parabolic blend at both ends"
)
"""What is said of blends of joints that go to one point."""


def follow_line(
    robot: Robot,
    start: ArrayLike,
    T: ArrayLike,
    steps: int = 100,
    limits: bool = True,
    task: PathTask | None = None,
) -> Path:
    """The tool in a straight line from where it is at `start` to T, the joints on one branch.

    start: (n,) [rad | m]; T: (4, 4) [m]. `task` is what follows the line: the whole pose, or the position alone, as is
    taken for arms of up to three joints that place a point. The path ends where a joint leaves its limits (with
    `limits`), where there is no solution, or where a joint would jump. Where the line goes on from another
    configuration with the pose of a singular start, joints first turn to it in as many steps more. Raises
    InputError for other shapes, for what is no pose and for `steps` below 1. The time law is that of
    `interpolate_joints`.
    """
    first = one_configuration(robot, start, "start")
    target = target_poses(T)
    if target.ndim != 2:
        raise InputError(f"T: found poses of shape {target.shape}, expected one (4, 4)")
    expect_whole(steps, "steps", 1, MOST)
    follows = None if task is None else cast(PathTask, expect_choice(task, ("pose", "position"), "task"))
    manner = Manner("line", limits=expect_flag(limits, "limits"), follows=follows)
    return joined(_followed(robot, first, [[Goal(T=target)]], steps, manner))


def path_through(robot: Robot, start: Array | Goal, goals: Sequence[Goal], steps: int, manner: Manner) -> Path:
    """A path from joint values start (n,) [rad | m], or from a pose, through all goals.

    Joints together go to a pose by the solutions with which the farthest moves, added up from point to point, are
    least; of redundant arms by the nearest to the last. The tool along lines or an arc goes on the branch of its start;
    from a pose on that which is best over the whole path, as `path_branches` has it. Where a path does not reach its
    end, the branches that it might have taken are tried too.
    A position alone keeps the orientation of what was before, where the arm can turn its tool. A pose that is not
    reached makes a path of its start alone. steps: of the whole path by joints, of each piece of a line. A duration is
    of the whole path: pieces of a line share it like the least times that limits allow them, evenly without limits.
    With a `rounding` the tool passes by the points between and has one time law from the start to the end.
    """
    if manner.way == "joint":
        return _by_joints(robot, start, goals, steps, manner)
    legs: list[Leg] = [[goal] for goal in goals]
    if manner.rounding is not None:
        if len(goals) == 1:
            raise InputError("found no point between the start and the end, expected one to blend at")
        legs, steps = [goals], expect_whole(steps * len(goals), "steps", 1, MOST)
    if isinstance(start, Goal):
        branches = _branches(robot, start, legs, manner, False)
        if not branches:
            assert start.T is not None
            found = nearest_to(robot, np.zeros(robot.n), start.T, manner.follows or line_task(robot), False)
            raise InputError(f"the start is {found.reason or 'not reached'}, expected a pose that the arm can take")
        first = branches[0].start
        path, fraction = _along(robot, first, legs, steps, manner)
        return replace(path, branches=with_chosen(robot, branches, path, fraction))
    path, fraction = _along(robot, start, legs, steps, manner)
    if path.complete:
        return path
    branches = _branches(robot, Goal(T=forward_kinematics(robot, start)), legs, manner, True)
    return replace(path, branches=with_chosen(robot, branches, path, fraction))


def _branches(robot: Robot, first: Goal, legs: Sequence[Leg], manner: Manner, fixed: bool) -> tuple[PathBranch, ...]:
    """The branches of a path of the tool from a pose; none where no arm could go on and the start is `fixed`."""
    assert first.T is not None
    free = replace(manner, timing=None, halvings=TRIED_HALVINGS)
    guess = nearest_to(robot, np.zeros(robot.n), first.T, manner.follows or line_task(robot), False)
    if not guess.solutions:
        return ()
    q = guess.solutions[0].q
    asked = tool_curve(robot, q, legs[0], free)
    if isinstance(asked, str):
        return ()
    curve, follows = asked
    task = follows or line_task(robot)
    attainable = not fixed or all(_attainable(robot, goal, free) for leg in legs for goal in leg)
    if not attainable or (fixed and not passable(robot, curve, task, TRIED)):
        return ()
    starts = branch_starts(robot, curve, task)

    def follow(start: Array, limits: bool) -> Path:
        paths = _followed(robot, start, legs, TRIED * len(legs[0]), replace(free, limits=limits))
        return replace(_of_all(joined(paths), len(legs), _reached(paths)), fraction=_of_lines(paths, len(legs)))

    return branches_of(robot, starts, follow, manner.limits)


def _attainable(robot: Robot, goal: Goal, manner: Manner) -> bool:
    """Whether a goal has a solution at all, as far as that is known without the way to it."""
    if goal.T is None or goal.task != "pose":
        return True
    return bool(nearest_to(robot, np.zeros(robot.n), goal.T, manner.follows or line_task(robot), False).solutions)


def _along(robot: Robot, start: Array, legs: Sequence[Leg], steps: int, manner: Manner) -> tuple[Path, float]:
    """The tool along lines or an arc from joint values start (n,), and the part of these that is followed."""
    timing = manner.timing
    paths = _followed(robot, start, legs, steps, manner, _durations(robot, start, legs, steps, manner))
    whole = _of_all(joined(paths, timing.rate if timing is not None else None), len(legs), _reached(paths))
    missing = len(legs) - _reached(paths)
    if missing and timing is None:
        whole = replace(whole, t=whole.t * _reached(paths) / len(legs))
    if missing and (timing is None or timing.rate is None):
        whole = replace(whole, steps=whole.steps + missing * steps)
    if timing is not None and timing.duration is not None:
        whole = replace(whole, duration=timing.duration)
    return whole, _of_lines(paths, len(legs))


def _reached(paths: Sequence[Path]) -> int:
    """How many goals paths went to, the last one perhaps not to its end."""
    return sum(not path.reorientation for path in paths)


def _of_lines(paths: Sequence[Path], goals: int) -> float:
    """The part of the lines to all goals that paths follow: turns of joints before them are none."""
    return (_reached(paths) - 1 + paths[-1].fraction) / goals


def _of_all(path: Path, goals: int, reached: int) -> Path:
    """A path to those of its goals that it reached, as a part of the way to all: what is not is as long as a piece."""
    if reached == goals:
        return path
    share = reached / goals
    events = tuple(replace(event, fraction=event.fraction * share) for event in path.events)
    turns = tuple(replace(turn, fraction=turn.fraction * share) for turn in path.turns)
    return replace(path, s=path.s * share, fraction=path.fraction * share, events=events, turns=turns)


def _durations(robot: Robot, start: Array, legs: Sequence[Leg], steps: int, manner: Manner) -> list[float] | None:
    """How long each piece takes [s], where a duration of the whole is to be shared."""
    timing = manner.timing
    if timing is None or timing.duration is None:
        return None
    # The pieces as fast as they may be say how they share the duration.
    free = replace(manner, timing=replace(timing, duration=None))
    fastest = _followed(robot, start, legs, steps, free)
    times = [path.duration or 1.0 for path in fastest]
    if len(times) == len(legs) == 1:
        return [timing.duration]
    whole = len(times) + len(legs) - _reached(fastest)
    longer = timing.duration / (sum(times) * whole / len(times))
    bounded = bool(np.isfinite([timing.limits.velocity, timing.limits.acceleration]).any())
    if bounded and longer < 1.0 - 1e-9:
        least = timing.duration / longer
        raise too_short(timing.duration, least)
    longer = max(longer, 1.0) if bounded else longer
    return [longer * time for time in times]


def _followed(
    robot: Robot,
    start: Array,
    legs: Sequence[Leg],
    steps: int,
    manner: Manner,
    durations: Sequence[float] | None = None,
) -> list[Path]:
    """The tool to each goal, as far as it gets; before a piece perhaps a turn of joints with the tool at rest."""
    paths: list[Path] = []
    q = start
    for number, leg in enumerate(legs, 1):
        first = _begins(robot, q, leg, manner)
        if first is not q:
            turn = reorientation(robot, q, first, _in_turn(manner, paths, durations).timing, steps)
            # That the arm is singular there is said of the piece that begins there.
            paths.append(replace(turn, kind=manner.way, events=()))
        path = _by_tool(robot, first, leg, steps, _in_turn(manner, paths, durations), number)
        paths.append(path)
        q = path.q[-1]
        if not path.complete:
            break
    return paths


def _begins(robot: Robot, q: Array, leg: Leg, manner: Manner) -> Array:
    """From which configuration (n,) with the pose of q (n,) a piece begins: q itself, but at some singular poses."""
    follows = manner.follows or line_task(robot)
    if not is_singular(robot, q, "position" if follows == "position" else None):
        return q
    first = _by_tool(robot, q, leg, TRIED, replace(manner, timing=None)).q[0]
    return first if np.any(first != q) else q


def _in_turn(manner: Manner, paths: Sequence[Path], durations: Sequence[float] | None) -> Manner:
    """The manner of the piece after paths."""
    timing = manner.timing
    if timing is None:
        return manner
    own = None if durations is None else durations[len(paths)]
    return replace(manner, timing=replace(timing, duration=own, since=sum(path.duration or 1.0 for path in paths)))


def _by_joints(robot: Robot, start: Array | Goal, goals: Sequence[Goal], steps: int, manner: Manner) -> Path:
    """All joints together, from point to point."""
    stages = [Goal(q=start) if isinstance(start, np.ndarray) else start, *goals]
    points = points_through(robot, stages, manner)
    if isinstance(points, str):
        if isinstance(start, np.ndarray):
            return no_path(robot, start, points, steps)
        raise InputError(f"a pose of the path is {points}, expected poses that the arm can take")
    timing = manner.timing
    if timing is None and len(points) == 2:
        return interpolate_joints(robot, points[0], points[1], steps, manner.limits)
    told: dict[str, Any] = {}
    if timing is not None:
        told = {name: getattr(timing, name) for name in ("duration", "profile", "passing", "blend", "rate")}
        told |= {"max_velocity": timing.limits.velocity, "max_acceleration": timing.limits.acceleration}
    path = trajectory(robot, np.array(points), steps=steps, limits=manner.limits, **told)
    if timing is not None and timing.passing == "blend" and len(points) == 2:
        path = replace(path, choices=(NOTHING_BETWEEN,))
    return path if timing is not None else replace(path, duration=None, velocity=None, acceleration=None)


def _by_tool(robot: Robot, start: Array, leg: Leg, steps: int, manner: Manner, point: int = 1) -> Path:
    """The tool along a line or an arc to a point (from 1), or along several without a stop."""
    asked = tool_curve(robot, start, leg, manner)
    if isinstance(asked, str):
        return replace(no_path(robot, start, asked, steps), kind=manner.way)
    curve, follows = asked
    if manner.timing is None:
        t = row_times(1.0, steps, None)
        path = follow_curve(robot, start, curve, t, time_law(t), manner.limits, follows, manner.halvings)
    else:
        path = timed_curve(robot, start, curve, manner.timing, steps, manner.limits, follows)
    blends = curve.blends() if isinstance(curve, RoundedCurve) else ()
    passed = tuple(one for one in blends if one.fraction <= path.fraction)
    if (follows or line_task(robot)) == "position":  # how the curve turns is nothing that the tool does
        return replace(path, kind=manner.way, blends=tuple(replace(one, angle=0.0) for one in passed))
    return replace(path, kind=manner.way, blends=passed, choices=choices(curve, point))
