"""Paths: what they are made of, and those joint by joint.

Time law. s(t) = 10 t³ - 15 t⁴ + 6 t⁵ for t from 0 to 1: velocity and acceleration are zero at both ends (B. Siciliano
et al., Robotics: Modelling, Planning and Control, 2009, section 4.2).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal, SupportsIndex

import numpy as np
from numpy.typing import ArrayLike

from robokin.arrays import Array
from robokin.brief import Answer, Brief
from robokin.errors import InputError, counted
from robokin.expected import expect_finite, expect_flag, expect_whole
from robokin.inverse.follow import ITSELF, MOST
from robokin.inverse.hold import HeldArm
from robokin.inverse.rounded_curves import PathBlend
from robokin.kinematics.forward import forward_kinematics
from robokin.kinematics.velocity import TaskName, dexterity, differential_kinematics, lost_directions, motion_task
from robokin.model import CoupledRobot, Robot, expect_robot
from robokin.model.named_values import plain_joint_values
from robokin.model.robot import LIMIT_TOLERANCE

PathTask = Literal["pose", "position"]

NEARLY = 1e-2
"""A least singular value (lengths in the arm's size) below which a path passes a singularity: joints then move a
hundred times faster than the tool."""


@dataclass(frozen=True)
class Event:
    """Something on the way. `fraction` of the path (s, not t); joint from 1 and its value [rad | m] for a limit."""

    kind: Literal["limit", "singularity", "unreachable", "jump"]
    fraction: float
    words: str
    joint: int | None = None
    value: float | None = None


@dataclass(frozen=True, eq=False, repr=False)
class PathBranch(Brief):
    """A branch that was tried for a path.

    name: of the posture at its start, empty where the arm has no words; start: (n,) [rad | m]; fraction: of the lines
    or the arc that can be followed, 1 if all; event: what ends it, None for nothing; travel: (n,) how far each joint
    goes, both ways counted [rad | m]; chosen: whether the path takes it.
    """

    name: str
    start: Array
    fraction: float
    event: Event | None
    travel: Array
    chosen: bool = False

    @property
    def complete(self) -> bool:
        """Whether it reaches the end."""
        return self.fraction >= 1.0


@dataclass(frozen=True, eq=False, repr=False)
class PathTurn(Brief):
    """A turn of joints while the tool stands still, to where a line goes on from.

    fraction: of the path where it begins; row: the first of its rows, from 0; steps: how many steps of rows it takes;
    start, end: (n,) the configurations between which joints turn in proportion [rad | m].
    """

    fraction: float
    row: int
    steps: int
    start: Array
    end: Array

    @property
    def joints(self) -> list[int]:
        """The joints that turn, from 1."""
        return [int(j) + 1 for j in np.flatnonzero(np.abs(self.end - self.start) > ITSELF)]

    @property
    def words(self) -> str:
        """The same in words."""
        joints = " and ".join(str(joint) for joint in self.joints)
        turn = f"joints {joints} turn" if len(self.joints) > 1 else f"joint {joints} turns"
        how = f"in {counted(self.steps, 'step')} with the tool at rest, to where the path goes on from"
        return f"{turn}, {how}" if self.fraction else f"{turn} first, {how}"


@dataclass(frozen=True, eq=False, repr=False)
class Path(Answer):
    """A path, as far as it can be followed.

    t: (m,) time from 0 to 1; s: (m,) fraction of the path; q: (m, n) [rad | m]; T: (m, 4, 4) [m]; fraction: of the path
    that can be followed, 1 if all; events: in the order in which they come; manipulability: (m,) [SI]; steps: how many
    were asked for, so that m is steps + 1 if all can be followed; kind: whether the joints move together or the tool
    in a line or an arc. Of a path in time t is in seconds, from 0 to its duration [s] if all can be followed, and
    velocity and acceleration are (m, n) [rad/s | m/s, per s²]; else these three are None. reorientation: how many steps
    at the beginning turn joints while the tool stands still, where a line goes on from no other configuration;
    turns: all such turns, also those at points between;
    branches: those that were tried, the best first: of a line or an arc from a pose, or that does not reach its end;
    blends: points between that the tool passes by; choices: sentences on what might have been otherwise as well;
    held: joints that are held, and the arm of the others, None for none: manipulability and postures are of that.
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
    reorientation: int = 0
    branches: tuple[PathBranch, ...] = ()
    turns: tuple[PathTurn, ...] = ()
    blends: tuple[PathBlend, ...] = ()
    choices: tuple[str, ...] = ()
    held: HeldArm | None = None

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

    def __getitem__(self, i: SupportsIndex | slice) -> Array:
        """The joint values (n,) [rad | m] of row i, or (k, n) of some. Raises IndexError."""
        return np.asarray(self.q[i])

    def __iter__(self) -> Iterator[Array]:
        """The joint values (n,) [rad | m] row by row."""
        return iter(self.q)

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
    first, last = one_configuration(robot, start, "start"), one_configuration(robot, end, "end")
    t = even_times(steps)
    s = time_law(t)
    q = first + s[:, None] * (last - first)
    fraction, event = 1.0, None
    if expect_flag(limits, "limits"):
        fraction, event = leaves_between(robot, first, last)
    kept = s <= fraction
    return path_of_rows(robot, t[kept], s[kept], q[kept], fraction, event, steps, None)


def no_path(robot: Robot, start: ArrayLike, reason: str, steps: int = 100) -> Path:
    """What is said where the end cannot be reached: the start (n,) alone, and why."""
    q = one_configuration(robot, start, "start")[None]
    at = np.zeros(1)
    return path_of_rows(robot, at, at, q, 0.0, Event("unreachable", 0.0, f"the end is {reason}"), steps, None)


def line_task(robot: Robot) -> PathTask:
    """What follows a line if nothing is said: the position for arms that place a point, the pose for others."""
    return "position" if motion_task(robot).name == "position" else "pose"


def even_times(steps: int) -> Array:
    """Times (m,) from 0 to 1 in even steps."""
    steps = expect_whole(steps, "steps", 1, MOST)
    return np.arange(steps + 1) / steps


def one_configuration(robot: Robot, q: ArrayLike, name: str) -> Array:
    """One configuration (n,) [rad | m] of a robot that can move. Raises InputError for anything else."""
    robot = expect_robot(robot)
    values = expect_finite(plain_joint_values(robot, q, name), name, f"{robot.n} finite joint values", (robot.n,))
    if not robot.n:
        raise InputError(f"{robot.name} has no joints, expected a robot that can move")
    return values


def leaves_between(robot: Robot, first: Array, last: Array) -> tuple[float, Event | None]:
    """Up to which fraction the segment from first to last (n,) stays within the limits, and what ends it."""
    worst, event = 1.0, None
    begins, ends, limits, words = limited_values(robot, np.stack([first, last]))
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


def limited_values(robot: Robot, q: Array) -> tuple[Array, Array, Array, list[str]]:
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


def path_of_rows(
    robot: Robot, t: Array, s: Array, q: Array, fraction: float, event: Event | None, steps: int, task: TaskName | None
) -> Path:
    """A path of rows q (m, n) [rad | m] at times t (m,) and parts s (m,) of the way, with what happens on it."""
    T = forward_kinematics(robot, q)
    least, manipulability = dexterity(robot, q, task, NEARLY)
    events = singularities(robot, s, q, least, task)
    if event is not None:
        events.append(event)
    return Path(t, s, q, T, fraction, tuple(events), manipulability, steps, robot)


def singularities(robot: Robot, s: Array, q: Array, least: Array, task: TaskName | None) -> list[Event]:
    """The rows (m,) where the least singular value has a minimum below NEARLY, one for each pass."""
    near = np.flatnonzero(least < NEARLY)
    events = []
    for part in np.split(near, np.flatnonzero(np.diff(near) > 1) + 1) if len(near) else []:
        i = int(part[np.argmin(least[part])])
        lost = lost_directions(robot, q[i], task=task)
        words = f": no {lost[0].words}" if lost else ""
        found = differential_kinematics(robot, q[i], task=task)
        rank = f"singular, rank {int(found.rank)} of {found.task.dimension}"
        how = rank if found.rank < found.task.dimension else f"nearly singular, least singular value {least[i]:.1e}"
        events.append(Event("singularity", float(s[i]), f"{how}{words}"))
    return events
