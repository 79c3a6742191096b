"""Paths: joint by joint, and along a straight line of the tool.

Time law. s(t) = 10 t³ - 15 t⁴ + 6 t⁵ for t from 0 to 1: velocity and acceleration are zero at both ends (B. Siciliano
et al., Robotics: Modelling, Planning and Control, 2009, section 4.2).

A straight line: the position moves linearly with s, the rotation about one fixed axis (slerp). Of all inverse
kinematics solutions at a pose the one nearest to the last configuration is taken. Where that moves a joint by more than
NEAR, the step is halved, again and again: near a singularity a joint may move fast, and a finer step shows that it
still moves; a step that stays large however fine it is made is a jump to another branch, and the line ends before it.
Where the start is singular the line may begin from another configuration with its pose, to which joints turn while the
tool stands still: the second row then stands for that motion too.
Redundant arms, and arms that lack directions that the task leaves open, are followed by steps of least joint motion.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal, cast

import numpy as np
from numpy.typing import ArrayLike

from robokin.arrays import Array
from robokin.brief import Answer
from robokin.errors import InputError
from robokin.expected import expect_choice, expect_finite, expect_flag, expect_whole
from robokin.inverse.follow import MOST, Follows, follower_of
from robokin.inverse.solve import target_poses
from robokin.inverse.tool_curves import Line, ToolCurve
from robokin.kernel.ranks import RANK
from robokin.kinematics.forward import forward_kinematics
from robokin.kinematics.velocity import TaskName, differential_kinematics, lost_directions, motion_task
from robokin.model import CoupledRobot, Robot, expect_robot
from robokin.model.robot import LIMIT_TOLERANCE

PathTask = Literal["pose", "position"]

NEARLY = 1e-2
"""A least singular value (lengths in the arm's size) below which a path passes a singularity: joints then move a
hundred times faster than the tool."""

BISECTIONS = 40
"""Halvings that place an event on the path: to 1e-12 of it, as long as steps are a hundredth."""


@dataclass(frozen=True)
class Event:
    """Something on the way. `fraction` of the path (s, not t); joint from 1 and its value [rad | m] for a limit."""

    kind: Literal["limit", "singularity", "unreachable", "jump"]
    fraction: float
    words: str
    joint: int | None = None
    value: float | None = None


@dataclass(frozen=True, eq=False, repr=False)
class Path(Answer):
    """A path, as far as it can be followed.

    t: (m,) time from 0 to 1; s: (m,) fraction of the path; q: (m, n) [rad | m]; T: (m, 4, 4) [m]; fraction: of the path
    that can be followed, 1 if all; events: in the order in which they come; manipulability: (m,) [SI]; steps: how many
    were asked for, so that m is steps + 1 if all can be followed; kind: whether the joints move together or the tool
    in a line or an arc. Of a path in time t is in seconds, from 0 to its duration [s] if all can be followed, and
    velocity and acceleration are (m, n) [rad/s | m/s, per s²]; else these three are None.
    """

    t: Array
    s: Array
    q: Array
    T: Array
    fraction: float
    events: tuple[Event, ...]
    manipulability: Array
    steps: int
    robot: Robot
    kind: Literal["joint", "line", "arc"] = "joint"
    duration: float | None = None
    velocity: Array | None = None
    acceleration: Array | None = None

    @property
    def complete(self) -> bool:
        """Whether the end is reached."""
        return self.fraction >= 1.0

    @property
    def length(self) -> float:
        """How far the tool's origin travels [m], by straight pieces from row to row."""
        return float(np.sum(np.linalg.norm(np.diff(self.T[:, :3, 3], axis=0), axis=1)))

    def __len__(self) -> int:
        """The number of rows."""
        return len(self.t)

    def __repr__(self) -> str:
        """A line: what moves, how far, and how much of it can be followed."""
        what = "joints" if self.kind == "joint" else self.kind
        how = "" if self.complete else f", followed up to {self.fraction:.4g}"
        return f"<path of {self.robot.id or self.robot.name} ({what}): {len(self)} rows, {self.length:.6g} m{how}>"


def time_law(t: ArrayLike) -> Array:
    """s (...) at times t (...) from 0 to 1."""
    t = np.asarray(t, dtype=np.float64)
    return np.asarray(t * t * t * (10.0 + t * (6.0 * t - 15.0)))


def interpolate_joints(robot: Robot, start: ArrayLike, end: ArrayLike, steps: int = 100, limits: bool = True) -> Path:
    """All joints from `start` to `end` together, each value linear in s.

    start, end: (n,) [rad | m]. With `limits` the path ends before a joint leaves them. Raises InputError for other
    shapes and for `steps` below 1.
    Source of the time law s(t) = 10 t³ - 15 t⁴ + 6 t⁵: B. Siciliano et al., Robotics: Modelling, Planning and Control,
    2009, section 4.2.
    """
    first, last = _configuration(robot, start, "start"), _configuration(robot, end, "end")
    t = _times(steps)
    s = time_law(t)
    q = first + s[:, None] * (last - first)
    fraction, event = 1.0, None
    if expect_flag(limits, "limits"):
        fraction, event = _leaves(robot, first, last)
    kept = s <= fraction
    return _path(robot, t[kept], s[kept], q[kept], fraction, event, steps, None)


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
    `limits`), where there is no solution, or where a joint would jump. Raises InputError for other shapes, for what is
    no pose and for `steps` below 1. The time law is that of `interpolate_joints`.
    """
    first = _configuration(robot, start, "start")
    target = target_poses(T)
    if target.ndim != 2:
        raise InputError(f"found targets of shape {target.shape}, expected one, (4, 4)")
    t = _times(steps)
    path = follow_curve(robot, first, Line(forward_kinematics(robot, first), target), t, time_law(t), limits, task)
    return replace(path, kind="line")


def follow_curve(
    robot: Robot, first: Array, curve: ToolCurve, t: Array, s: Array, limits: bool, task: PathTask | None
) -> Path:
    """The tool along a curve from where it is at first (n,), at parts s (m,) of the way: see `follow_line`."""
    limits = expect_flag(limits, "limits")
    chosen = line_task(robot) if task is None else cast(PathTask, expect_choice(task, ("pose", "position"), "task"))
    follower = follower_of(robot, curve.at, chosen, s)
    rows, fraction, event = [first], 1.0, None
    if limits and not robot.within_limits(first):
        fraction, event = _leaves(robot, first, first)
        rows = rows if event is None else [first]
    for i in range(1, len(s)):
        if event is not None:
            break
        reached, q, why = follower.advance(rows[-1], float(s[i - 1]), i)
        if why == "jump" and i == 1:
            turned = follower.turned_start(first, i)
            if turned is not None:
                reached, q, why = follower.advance(turned, float(s[0]), i)
        if limits and not robot.within_limits(q):
            fraction, event = _limit_event(robot, follower, rows[-1], float(s[i - 1]), reached)
        elif why:
            fraction, event = reached, _stopped(robot, reached, q, why, chosen)
        else:
            rows.append(q)
    m = len(rows)
    counted: TaskName | None = "position" if chosen == "position" else None
    return _path(robot, t[:m], s[:m], np.array(rows), fraction, event, len(s) - 1, counted)


def no_path(robot: Robot, start: ArrayLike, reason: str, steps: int = 100) -> Path:
    """What is said where the end cannot be reached: the start (n,) alone, and why."""
    q = _configuration(robot, start, "start")[None]
    at = np.zeros(1)
    return _path(robot, at, at, q, 0.0, Event("unreachable", 0.0, f"the end is {reason}"), steps, None)


def line_task(robot: Robot) -> PathTask:
    """What follows a line if nothing is said: the position for arms that place a point, the pose for others."""
    return "position" if motion_task(robot).name == "position" else "pose"


def _times(steps: int) -> Array:
    steps = expect_whole(steps, "steps", 1, MOST)
    return np.arange(steps + 1) / steps


def _configuration(robot: Robot, q: ArrayLike, name: str) -> Array:
    robot = expect_robot(robot)
    values = expect_finite(q, name, f"{robot.n} finite joint values", (robot.n,))
    if not robot.n:
        raise InputError(f"{robot.name} has no joints, expected a robot that can move")
    return values


def _leaves(robot: Robot, first: Array, last: Array) -> tuple[float, Event | None]:
    """Up to which fraction the segment from first to last (n,) stays within the limits, and what ends it."""
    worst, event = 1.0, None
    begins, ends, limits, words = _limited(robot, np.stack([first, last]))
    for k, said in enumerate(words):
        for limit, side in zip(limits[k], (-1.0, 1.0), strict=True):
            before, after = side * (begins[k] - limit), side * (ends[k] - limit)
            if max(before, after) <= LIMIT_TOLERANCE:
                continue
            at = 0.0 if before > LIMIT_TOLERANCE else float(-before / (after - before))
            if event is None or at < worst:
                value = float(begins[k] if at == 0.0 and before > 0.0 else limit)
                worst, event = (
                    at,
                    Event("limit", at, f"{said} leaves its limits", k + 1 if k < robot.n else None, value),
                )
    return worst, event


def _limited(robot: Robot, q: Array) -> tuple[Array, Array, Array, list[str]]:
    """Of two configurations q (2, n) the values (k,) that have limits, these (k, 2), and what each value is called.

    Beside the variables these are the joints that hang on several of them.
    """
    names = [f"joint {k + 1}" for k in range(robot.n)]
    if not isinstance(robot, CoupledRobot):
        return q[0], q[1], robot.limits, names
    moved = [row.name for row in robot.free_motion.joints]
    values = np.concatenate([q, robot.drive.motions(q)], axis=1)
    limits = np.concatenate([robot.limits, robot.drive.limits])
    return values[0], values[1], limits, names + [f"the motion of joint {name}" for name in moved]


def _limit_event(robot: Robot, follower: Follows, q: Array, s: float, reached: float) -> tuple[float, Event | None]:
    """Where between s, with q, and `reached` the first joint leaves its limits."""
    low, high = s, reached
    outside = q
    for _ in range(BISECTIONS):
        middle = (low + high) / 2.0
        if middle in (low, high):
            break
        found = follower.nearest(q, middle)
        if found is not None and robot.within_limits(found):
            low, q = middle, found
        else:
            high, outside = middle, outside if found is None else found
    values, _, limits, words = _limited(robot, np.stack([outside, outside]))
    k = int(np.argmax(np.maximum(values - limits[:, 1], limits[:, 0] - values)))
    value = float(limits[k, 1] if values[k] > limits[k, 1] else limits[k, 0])
    return low, Event("limit", low, f"{words[k]} leaves its limits", k + 1 if k < robot.n else None, value)


def _stopped(robot: Robot, s: float, q: Array, why: str, task: PathTask) -> Event:
    """What ends a line at s with the configuration q."""
    found = differential_kinematics(robot, q, task=cast(TaskName, task))
    lost = ""
    if found.singular_values[-1] < NEARLY:
        # The end is near a singularity, not on it: what is lost there is what moves least here.
        lost = " at a singularity"
    if why == "jump":
        return Event("jump", s, f"no solution follows the last one without a jump{lost}")
    if task == "pose" and motion_task(robot).dimension < 6 and not lost:
        return Event("unreachable", s, "no solution with the orientation of the line (task position leaves it free)")
    return Event("unreachable", s, f"the arm reaches no further{lost}")


def _path(
    robot: Robot, t: Array, s: Array, q: Array, fraction: float, event: Event | None, steps: int, task: TaskName | None
) -> Path:
    T = forward_kinematics(robot, q)
    found = differential_kinematics(robot, q, task=task)
    events = singularities(robot, s, q, found.singular_values, task)
    if event is not None:
        events.append(event)
    return Path(t, s, q, T, fraction, tuple(events), found.manipulability, steps, robot)


def singularities(robot: Robot, s: Array, q: Array, values: Array, task: TaskName | None) -> list[Event]:
    """The rows where the least singular value has a minimum below NEARLY, one for each pass."""
    least = values[:, -1] if values.shape[1] else np.full(len(s), np.inf)
    near = np.flatnonzero(least < NEARLY)
    events = []
    for part in np.split(near, np.flatnonzero(np.diff(near) > 1) + 1) if len(near) else []:
        i = int(part[np.argmin(least[part])])
        lost = lost_directions(robot, q[i], task=task)
        words = f": no {lost[0].words}" if lost else ""
        how = "singular" if least[i] < RANK else f"nearly singular, least singular value {least[i]:.1e}"
        events.append(Event("singularity", float(s[i]), f"{how}{words}"))
    return events
