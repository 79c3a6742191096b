"""Orientations tried at places: which of them can be reached within the limits, by inverse kinematics."""

from __future__ import annotations

from functools import partial

import numpy as np
from numpy.typing import NDArray

from robokin.inverse.analysis import Task, analysis_of
from robokin.inverse.blocks import BLOCK, quick_block
from robokin.inverse.verify import within_limits
from robokin.spatial import transform
from robokin.workspace.attitudes import Attitudes
from robokin.workspace.parallel import in_order
from robokin.workspace.space import Space

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]


def reached(space: Space, tried: Attitudes, points: Array, which: NDArray[np.intp]) -> Flags:
    """(m,) whether points (m, 3) [m] are reached with the orientations `which` (m,) within the limits."""
    return reached_with(space, tried.task, points, tried.rotations[which])


def reached_with(space: Space, task: Task, points: Array, rotations: Array) -> Flags:
    """(m,) whether points (m, 3) [m] are reached with rotations (m, 3, 3) of the tool within the limits."""
    robot = space.arm
    analysis = analysis_of(robot, task)
    rest = np.clip(0.0, robot.limits[:, 0], robot.limits[:, 1])
    answers = np.zeros(len(points), dtype=bool)
    for start in range(0, len(points), BLOCK):
        part = slice(start, start + BLOCK)
        T = transform(rotations[part], points[part])
        found = quick_block(analysis, T, robot.limits, rest)
        _, inside = within_limits(found.q, robot.revolute, robot.limits, None)
        answers[start + found.index[inside]] = True
    return answers


def fractions(space: Space, tried: Attitudes, points: Array, cores: int | None = 1) -> Array:
    """(m,) the part of the orientations that each of points (m, 3) [m] can be reached with."""
    size = max(4 * BLOCK // len(tried.rotations), 1)
    blocks = [points[start : start + size] for start in range(0, len(points), size)]
    tables = in_order(partial(table, space, tried), blocks, cores)
    return np.concatenate([np.zeros(0), *(np.mean(flags, axis=1) for flags in tables)])


def table(space: Space, tried: Attitudes, points: Array) -> Flags:
    """(m, k) which orientation can be reached at which of points (m, 3) [m]."""
    k = len(tried.rotations)
    flags = reached(space, tried, np.repeat(points, k, axis=0), np.tile(np.arange(k), len(points)))
    return flags.reshape(len(points), k)


def every(space: Space, tried: Attitudes, order: NDArray[np.intp], points: Array) -> Flags:
    """(m,) at which of points (m, 3) [m] all orientations can be reached; the first of the order decide most."""
    alive = np.arange(len(points))
    start, step = 0, 4
    while start < len(order) and len(alive):
        part = order[start : start + step]
        flags = reached(space, tried, np.repeat(points[alive], len(part), axis=0), np.tile(part, len(alive)))
        alive = alive[np.all(flags.reshape(len(alive), len(part)), axis=1)]
        start, step = start + len(part), min(2 * step, max(4 * BLOCK // max(len(alive), 1), 4))
    passed = np.zeros(len(points), dtype=bool)
    passed[alive] = True
    return passed


def telling_order(flags: Flags, seed: int) -> NDArray[np.intp]:
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
