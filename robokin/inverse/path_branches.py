"""Which branch of inverse kinematics a path of the tool takes: the best over the whole path.

Statement. A tool is to go along lines or an arc. Of all configurations with its first pose, find those from which the
joints get to the end without a jump and within their limits, and which of them does it best.
Derivation. Each solution at the first pose is followed over the whole path without limits; full turns are then added to
each joint's values so that they lie within its limits, if they can: nearest to their middle, or to zero without limits.
Of the branches that reach the end the best is that whose joint that travels farthest travels least (radians, or parts
of the arm's size); where these are equal, that whose joints travel least together.
Degenerate case. Where none reaches the end the one that gets farthest is the best. Of arms with joints to spare only
some starts are tried.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from robokin.arrays import Array
from robokin.inverse.follow import ITSELF
from robokin.inverse.followed_curves import joint_scale
from robokin.inverse.joint_paths import Path, PathBranch
from robokin.inverse.solution_names import branch_names
from robokin.model import CoupledRobot, Robot
from robokin.model.robot import tolerated
from robokin.spatial.angles import TURN, circled

ONE = 1e-6
"""Paths whose joint values [rad | size] differ by less everywhere are one."""

TIE = 1e-6
"""Travels [rad | size] that differ by less are equal."""

Follow = Callable[[Array, bool], Path]
"""The path from joint values (n,), with or without limits."""


def branches_of(robot: Robot, starts: Array, follow: Follow, limits: bool) -> tuple[PathBranch, ...]:
    """Each branch that begins at one of starts (k, n) [rad | m], the best first."""
    scale = joint_scale(robot)
    paths: list[Path] = []
    for start in starts:
        path = follow(start, False)
        if any(_same(robot, path, other, scale) for other in paths):
            continue
        paths.append(path)
    found = []
    for path in paths:
        if limits:
            turned = path.q + _turns(robot, path.q)
            inside = bool(robot.within_limits(turned).all())
            path = replace(path, q=turned) if inside else follow(turned[0], True)
        travel = np.sum(np.abs(np.diff(path.q, axis=0)), axis=0)
        ended = None if path.complete else path.events[-1]
        found.append(PathBranch(posture(robot, path.q[0]), path.q[0], path.fraction, ended, travel))
    return tuple(sorted(found, key=lambda one: _rank(one, scale)))


def posture(robot: Robot, q: Array) -> str:
    """The name of the posture of joint values q (n,), empty where the arm has none."""
    if isinstance(robot, CoupledRobot):
        return branch_names(robot.free_motion, robot.drive.motions(q[None]))[0] if robot.drive.invertible else ""
    return branch_names(robot, q[None])[0]


def with_chosen(robot: Robot, branches: tuple[PathBranch, ...], path: Path, fraction: float) -> tuple[PathBranch, ...]:
    """The branches, that of the path marked as the chosen one; one is added where it is none of them.

    fraction: of its lines or its arc, without turns of joints between, that the path can follow.
    """
    q = path.q[path.reorientation :]
    start = path.turns[0].end if path.reorientation else q[0]
    travel = np.sum(np.abs(np.diff(q, axis=0)), axis=0)
    event = None if path.complete else path.events[-1]
    own = PathBranch(posture(robot, start), start, fraction, event, travel, True)
    mine = [bool(np.max(np.abs(one.start - start) / joint_scale(robot)) <= ITSELF) for one in branches]
    if not any(mine):
        return (*branches, own) if branches else ()
    place = mine.index(True)
    return (*branches[:place], own, *branches[place + 1 :])


def _rank(one: PathBranch, scale: Array) -> tuple[float, float, float]:
    travel = one.travel / scale
    return -one.fraction, round(float(np.max(travel)) / TIE), float(np.sum(travel))


def _same(robot: Robot, path: Path, other: Path, scale: Array) -> bool:
    m = min(len(path), len(other))
    gap = circled(path.q[:m] - other.q[:m], robot.revolute) / scale
    return bool(np.max(np.abs(gap)) <= ONE)


def _turns(robot: Robot, q: Array) -> Array:
    """What full turns (n,) [rad] bring joint values (m, n) within the limits, or keep them there for longest."""
    turns = np.zeros(robot.n)
    if isinstance(robot, CoupledRobot):
        return turns
    low, high = tolerated(robot.limits)
    for j in np.flatnonzero(robot.revolute):
        limited = np.isfinite(robot.limits[j]).all()
        middle = float(np.mean(robot.limits[j])) if limited else 0.0
        about = round((middle - float(np.mean((q[:, j].min(), q[:, j].max())))) / TURN)
        best = (-1, 0.0)
        for k in sorted((about - 1, about, about + 1, 0), key=lambda k: abs(k - about)):
            values = q[:, j] + TURN * k
            inside = (values >= low[j]) & (values <= high[j])
            lasts = len(inside) if inside.all() else int(np.argmin(inside))
            if lasts > best[0]:
                best = lasts, TURN * k
        turns[j] = best[1]
    return turns
