"""Orientations tried at places: which of them can be reached within the limits, by inverse kinematics."""

from __future__ import annotations

from functools import partial

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.inverse.analysis import Task, analysis_of
from robokin.inverse.numeric.closing import closing_nearest, exact_within
from robokin.inverse.plain_targets import quick_within
from robokin.inverse.solve_blocks import BLOCK, quick_block, solve_block
from robokin.inverse.verify import Found, within_limits
from robokin.jobs.ordered_map import ordered_map
from robokin.kernel.chain import chain_of
from robokin.kernel.frames import pose
from robokin.model import CoupledRobot
from robokin.spatial import transform
from robokin.workspace.attitudes import Attitudes
from robokin.workspace.geared_form import unwinding_of
from robokin.workspace.pose_descent import searched, sought_poses
from robokin.workspace.space import Space

ABOUT, BESIDE = 1.7, 3
"""How far an orientation may be from a reached one to be sought from there, in the grid's spacing; from how many."""


def tried_by_forms(space: Space, task: Task) -> bool:
    """Whether closed forms tell which orientations can be reached: where joints hang on each other only those of arms
    without joints to spare, each of whose joints' values has its variables."""
    robot = space.robot
    if not isinstance(robot, CoupledRobot):
        return True
    return robot.drive.invertible and not analysis_of(space.arm, task).redundancy


def reached(space: Space, tried: Attitudes, points: Array, which: Index) -> Flags:
    """(m,) whether points (m, 3) [m] are reached with the orientations `which` (m,) within the limits."""
    return reached_with(space, tried.task, points, tried.rotations[which])


def reached_with(space: Space, task: Task, points: Array, rotations: Array) -> Flags:
    """(m,) whether points (m, 3) [m] are reached with rotations (m, 3, 3) of the tool within the limits."""
    return configurations(space, task, points, rotations)[0]


def configurations(space: Space, task: Task, points: Array, rotations: Array) -> tuple[Flags, Array]:
    """(m,) the same, and a configuration of the space's arm for each, (m, n) [rad | m], NaN where there is none."""
    if searched(space, task):
        return sought_poses(space, task, points, rotations)
    robot = space.arm
    analysis = analysis_of(robot, task)
    rest = np.clip(0.0, robot.limits[:, 0], robot.limits[:, 1])
    answers, values = np.zeros(len(points), dtype=bool), np.full((len(points), robot.n), np.nan)
    for start in range(0, len(points), BLOCK):
        part = slice(start, start + BLOCK)
        T = transform(rotations[part], points[part])
        known = quick_within(robot, analysis, T) if space.gears is None else None
        left = np.arange(start, start + len(T))
        if known is not None:
            plain, there, q = known
            answers[left[there]], values[left[there]] = True, q[there]
            T, left = T[~plain], left[~plain]
            if not len(left):
                continue
        found = quick_block(analysis, T, robot.limits, rest)
        if space.gears is not None:
            index, q = unwinding_of(space)(found.index, found.q)
            answers[start + index], values[start + index] = True, q
            continue
        q, inside = within_limits(found.q, robot.revolute, robot.limits, None)
        answers[left[found.index[inside]]] = True
        values[left[found.index[inside]]] = q[inside]
    return answers, values


def reached_with_more(space: Space, task: Task, points: Array, rotations: Array) -> Flags:
    """(m,) as `reached_with`; of an arm with a joint to spare with more values of it where the usual ones do not do."""
    there = reached_with(space, task, points, rotations)
    robot, analysis = space.arm, analysis_of(space.arm, task)
    left = np.flatnonzero(~there) if _spare_in_closed_form(space, task) else np.zeros(0, dtype=np.intp)
    rest = np.clip(0.0, robot.limits[:, 0], robot.limits[:, 1])
    for start in range(0, len(left), BLOCK):
        some = left[start : start + BLOCK]
        T = transform(rotations[some], points[some])
        found, _ = solve_block(analysis, T, robot.limits, None, rest, more=True, thorough=False)
        _, inside = within_limits(found.q, robot.revolute, robot.limits, None)
        there[some[found.index[inside]]] = True
    return there


def reached_by_search(space: Space, task: Task, points: Array, rotations: Array) -> tuple[Flags, Array]:
    """(m,) as `reached_with`, and a configuration of each (m, n); what the closed forms of an arm with a joint to
    spare do not give is searched for."""
    there, q = configurations(space, task, points, rotations)
    robot, analysis = space.arm, analysis_of(space.arm, task)
    left = np.flatnonzero(~there)
    if analysis.redundancy and len(left):
        rest = np.clip(0.0, robot.limits[:, 0], robot.limits[:, 1])
        T = transform(rotations[left], points[left])
        found = closing_nearest(analysis, T, robot.limits, rest, 0, thorough=False)
        there[left[found.index]], q[left[found.index]] = True, found.q
    return there, q


def reached_beside(space: Space, task: Task, points: Array, rotations: Array, beside: Array) -> tuple[Flags, Array]:
    """(m,) as `reached_with`, and a configuration of each (m, n); of an arm with a joint to spare by Newton's steps
    from configurations `beside` (m, n) too."""
    there, q = configurations(space, task, points, rotations)
    analysis = analysis_of(space.arm, task)
    left = np.flatnonzero(~there)
    if analysis.redundancy and len(left):
        T = transform(rotations[left], points[left])
        found = _stepped(space, task, T, beside[left])
        there[left[found.index]], q[left[found.index]] = True, found.q
    return there, q


def _stepped(space: Space, task: Task, T: Array, beside: Array) -> Found:
    """Solutions for poses T (m, 4, 4) by Newton's steps within the limits from configurations `beside` (m, n)."""
    analysis = analysis_of(space.arm, task)
    limits = np.concatenate([space.arm.limits, np.tile([-np.inf, np.inf], (analysis.open, 1))])
    begin = np.zeros((len(T), analysis.chain.n))
    begin[:, : space.arm.n] = beside
    return exact_within(analysis, T, np.arange(len(T)), begin, limits, np.inf)


def at_one_place(space: Space, tried: Attitudes, point: Array) -> Flags:
    """(k,) which orientations can be reached at a point (3,) [m], sought more thoroughly than `table` does.

    The closed forms of an arm with a joint to spare are tried at some of its values only, and a narrow range of them
    may lie between these. So from an orientation that is reached Newton's steps within the limits go on to those
    beside it that are not, and from those that this reaches again, until there are no more.
    """
    k = len(tried.rotations)
    flags, q = configurations(space, tried.task, np.tile(point, (k, 1)), tried.rotations)
    if not analysis_of(space.arm, tried.task).redundancy:
        return flags
    entries = tried.rotations[:, :, 2] if tried.group == "S2" else tried.rotations.reshape(k, 9)
    new = np.flatnonzero(flags)
    # The product of two directions is cos θ, that of two rotations 1 + 2 cos θ.
    least = np.cos(min(ABOUT * tried.spacing, np.pi))
    least = least if tried.group == "S2" else 1.0 + 2.0 * least
    while len(new) and not flags.all():
        left = np.flatnonzero(~flags)
        alike = entries[left] @ entries[new].T
        nearest = np.argsort(-alike, axis=1)[:, :BESIDE]
        row, column = np.nonzero(np.take_along_axis(alike, nearest, axis=1) >= least)
        target, start = left[row], new[nearest[row, column]]
        T = transform(_rolled(space, tried, target, q[start]), np.tile(point, (len(target), 1)))
        found = _stepped(space, tried.task, T, q[start])
        reached = target[found.index]
        q[reached] = found.q
        new = np.unique(reached)
        flags[new] = True
    return flags


def _rolled(space: Space, tried: Attitudes, target: Index, q: Array) -> Array:
    """(m, 3, 3) the target's rotations; of those that only point somewhere that which is nearest to the tool's at q."""
    R = tried.rotations[target]
    if tried.group != "S2":
        return R
    z = R[:, :, 2]
    x = pose(chain_of(space.arm), q)[:, :3, 0]
    x = x - np.sum(x * z, axis=1)[:, None] * z
    x /= np.linalg.norm(x, axis=1)[:, None]
    return np.stack([x, np.cross(z, x), z], axis=2)


def fractions(space: Space, tried: Attitudes, points: Array, cores: int | None = 1) -> Array:
    """(m,) the part of the orientations that each of points (m, 3) [m] can be reached with."""
    size = max(4 * BLOCK // len(tried.rotations), 1)
    blocks = [points[start : start + size] for start in range(0, len(points), size)]
    tables = ordered_map(partial(table, space, tried), blocks, cores)
    return np.concatenate([np.zeros(0), *(np.mean(flags, axis=1) for flags in tables)])


def table(space: Space, tried: Attitudes, points: Array) -> Flags:
    """(m, k) which orientation can be reached at which of points (m, 3) [m]."""
    k = len(tried.rotations)
    flags = reached(space, tried, np.repeat(points, k, axis=0), np.tile(np.arange(k), len(points)))
    return flags.reshape(len(points), k)


def every(space: Space, tried: Attitudes, order: Index, points: Array) -> Flags:
    """(m,) at which of points (m, 3) [m] all orientations can be reached; the first of the order decide most."""
    alive = np.arange(len(points))
    start, step = 0, 4
    while start < len(order) and len(alive):
        part = order[start : start + step]
        flags = reached(space, tried, np.repeat(points[alive], len(part), axis=0), np.tile(part, len(alive)))
        alive = alive[_all_with_more(space, tried, points[alive], part, flags.reshape(len(alive), len(part)))]
        start, step = start + len(part), min(2 * step, max(4 * BLOCK // max(len(alive), 1), 4))
    passed = np.zeros(len(points), dtype=bool)
    passed[alive] = True
    return passed


def _all_with_more(space: Space, tried: Attitudes, points: Array, which: Index, flags: Flags) -> Flags:
    """(m,) at which of points (m, 3) [m] all of some orientations are reached, of which flags (m, k) are known to be;
    of an arm with a joint to spare the first that is not is tried with more values of it before a point is given up."""
    if _spare_in_closed_form(space, tried.task):
        flags = flags.copy()
        left = np.flatnonzero(~np.all(flags, axis=1))
        while len(left):
            first = np.argmin(flags[left], axis=1)
            there = reached_with_more(space, tried.task, points[left], tried.rotations[which[first]])
            left, first = left[there], first[there]
            flags[left, first] = True
            left = left[~np.all(flags[left], axis=1)]
    return np.asarray(np.all(flags, axis=1))


def _spare_in_closed_form(space: Space, task: Task) -> bool:
    """Whether an arm has joints to spare that are held at some values, of which there are more."""
    return analysis_of(space.arm, task).redundancy > 0 and not searched(space, task)


def telling_order(flags: Flags, seed: int) -> Index:
    """(k,) orientations, first those that together rule out most of the points of a table (m, k)."""
    failed = ~flags
    left = np.any(failed, axis=1)
    first: list[int] = []
    while left.any():
        first.append(int(np.argmax(np.sum(failed[left], axis=0))))
        left &= ~failed[:, first[-1]]
    # Of the others the next to fail are those that failed most, ties in any order.
    rest = np.random.default_rng((seed, 0x0DE2)).permutation(flags.shape[1])
    rest = rest[np.argsort(-np.sum(failed[:, rest], axis=0), kind="stable")]
    return np.concatenate([np.array(first, dtype=np.intp), rest[~np.isin(rest, first)]])
