"""Paths of an arm with some joints held: those of the arm of the others, told as paths of the whole arm.

Statement. Some joints stand still at given values; give the path of the others through goals, and as one of all joints.
Derivation. What is left is an arm of its own (`hold`), which takes branches, limits and durations as any other. Its
rows get the held values, with no velocity and no acceleration, and its joints their numbers in the whole arm.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from robokin.arrays import Array
from robokin.errors import InputError
from robokin.inverse.hold import HeldArm, check_held_limits, held_arm
from robokin.inverse.joint_paths import Event, Path
from robokin.inverse.path_goals import Goal, Manner
from robokin.inverse.paths_to_poses import path_through
from robokin.inverse.time_profiles import MotionLimits
from robokin.kinematics.forward import forward_kinematics
from robokin.model import Robot

SAME = 1e-9
"""Joint values [rad | m] that differ by less are one."""

JOINT = re.compile(r"(?<!of )\bjoint (\d+)\b")
"""How a joint is named in sentences by its number; the motion of a joint that follows others has its name."""


def path_with_held_joints(
    robot: Robot, hold: Mapping[int, float], start: Array | Goal, goals: Sequence[Goal], steps: int, manner: Manner
) -> Path:
    """The path with joints (from 0) held at values [rad | m]: see `path_through`, and `hold` of `solve_ik`.

    Raises InputError for held values outside their limits, and for joint values of the path that are others.
    """
    arm = held_arm(robot, hold)
    if manner.limits:
        check_held_limits(robot, arm)
    begin: Array | Goal = replace(start, q=_own(arm, start.q)) if isinstance(start, Goal) else arm.own(start)
    if not isinstance(start, Goal):
        _own(arm, start)
    own = [replace(goal, q=_own(arm, goal.q)) for goal in goals]
    timing = manner.timing
    if timing is not None:
        limits = MotionLimits(arm.own(timing.limits.velocity), arm.own(timing.limits.acceleration))
        manner = replace(manner, timing=replace(timing, limits=limits))
    try:
        path = path_through(arm.part, begin, own, steps, manner)
    except InputError as error:
        raise InputError(_renumbered(arm, str(error))) from None
    return _whole_path(robot, arm, path)


def _own(arm: HeldArm, q: Array | None) -> Array | None:
    """The part's own of joint values (n,), whose others are the held ones."""
    if q is None:
        return None
    off = np.flatnonzero(np.abs(q[arm.joints] - arm.values) > SAME)
    if len(off):
        k = int(off[0])
        joint, held, found = int(arm.joints[k]) + 1, float(arm.values[k]), float(q[arm.joints[k]])
        raise InputError(f"q{joint} is held at {held:.6g} and is {found:.6g} where the path goes, expected one value")
    return arm.own(q)


def _whole_path(robot: Robot, arm: HeldArm, path: Path) -> Path:
    """The path of the part as one of the robot."""
    q = arm.whole(path.q)
    rates: dict[str, Any] = {}
    for name in ("velocity", "acceleration"):
        if (part := getattr(path, name)) is not None:
            rates[name] = _with_zeros(arm, part)
    branches = tuple(
        replace(
            one, start=arm.whole(one.start), travel=_with_zeros(arm, one.travel),
            event=None if one.event is None else _whole_event(arm, one.event),
        )
        for one in path.branches
    )  # fmt: skip
    turns = tuple(replace(one, start=arm.whole(one.start), end=arm.whole(one.end)) for one in path.turns)
    events = tuple(_whole_event(arm, event) for event in path.events)
    return replace(
        path, robot=robot, q=q, T=forward_kinematics(robot, q), events=events, branches=branches, turns=turns, held=arm,
        **rates,
    )  # fmt: skip


def _with_zeros(arm: HeldArm, values: Array) -> Array:
    """What the joints of the part do (..., n - h), and the held ones do not."""
    out = np.zeros((*values.shape[:-1], arm.n))
    out[..., arm.free] = values
    return out


def _whole_event(arm: HeldArm, event: Event) -> Event:
    joint = None if event.joint is None else arm.numbers((event.joint,))[0]
    return replace(event, joint=joint, words=_renumbered(arm, event.words))


def _renumbered(arm: HeldArm, words: str) -> str:
    """A sentence about joints of the part with their numbers in the whole arm."""
    return JOINT.sub(lambda found: f"joint {arm.numbers((int(found[1]),))[0]}", words)
