"""Which of many configurations are the same as one before, in a time that grows with their number and no faster."""

from __future__ import annotations

from itertools import product

import numpy as np

from robokin.arrays import Array
from robokin.grading.tolerance import Tolerance
from robokin.model import Robot

SHADOWS = 3
"""Dimensions of the space of cells in which neighbours are looked for: enough to tell configurations apart, and a
cell has few neighbours."""


def apart(robot: Robot, q: Array, others: Array, allowed: Tolerance, free: frozenset[int] = frozenset()) -> Array:
    """(k,) the greatest difference [rad] of q (n,) and others (k, n), angles modulo 360°, lengths in the arm's size.

    free: joints (from 0) whose values do not count.
    """
    gap = np.abs(q - others)
    turns = np.abs((q - others + np.pi) % (2.0 * np.pi) - np.pi)
    each = np.where(robot.revolute, turns, gap / allowed.size)
    return np.asarray(np.max(np.delete(each, list(free), axis=1), axis=1, initial=0.0))


def firsts(robot: Robot, configurations: Array, allowed: Tolerance) -> list[int]:
    """For each of some configurations (m, n) [rad | m] the first one that it is the same as, itself if there is none.

    Same is what is within the tolerance of one that is kept. Each is compared with those kept in its cell and the
    cells beside it, of a grid in a space of few dimensions into which all are projected (the angles as points of a
    circle); what is within the tolerance cannot be farther off there.
    """
    near = max(allowed.angle, allowed.position / allowed.size)
    n = configurations.shape[1]
    rows = np.concatenate(
        [
            np.where(robot.revolute, np.cos(configurations), configurations / allowed.size),
            np.where(robot.revolute, np.sin(configurations), 0.0),
        ],
        axis=1,
    )
    # An arbitrary seed: any directions do, and these are nobody's axes.
    ways = np.random.default_rng(7).normal(size=(2 * n, SHADOWS))
    widest = near * float(np.max(np.sum(np.hypot(ways[:n], ways[n:]), axis=0)))
    cells = np.floor(rows @ ways / max(widest, 1e-12)).astype(np.int64).tolist()
    beside = list(product((-1, 0, 1), repeat=SHADOWS))
    kept: dict[tuple[int, ...], list[int]] = {}
    found = []
    for i, cell in enumerate(cells):
        close = [k for step in beside for k in kept.get(tuple(map(sum, zip(cell, step, strict=True))), ())]
        close.sort()
        same = np.flatnonzero(apart(robot, configurations[i], configurations[close], allowed) <= near)
        if len(same):
            found.append(close[same[0]])
        else:
            found.append(i)
            kept.setdefault(tuple(cell), []).append(i)
    return found
