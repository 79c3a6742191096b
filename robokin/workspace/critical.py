"""Places with every orientation, and the orientations that fail first where a set of them ends.

A grid misses what fails between its orientations, so that a set found with it is too large: by the square of the
grid's spacing where a cap of directions begins to fail, by the spacing itself where a wrist's limits cut off a corner.
But which orientations fail first changes little along the boundary. So they are sought at places just beyond it, where
the grid says roughly which they are: with a fine lattice of orientations about one that fails there, of whose failures
the middle is taken. At any other place those of the nearest such places are tried besides the grid.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from itertools import product

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.jobs.ordered_map import ordered_map
from robokin.spatial import rotation_from_axis_angle
from robokin.workspace.attitudes import Attitudes, small_turns
from robokin.workspace.space import Space
from robokin.workspace.trials import every, reached_with, reached_with_more, table

STEP = {1: 0.1, 2: 0.2, 3: 0.25}
"""Step of the lattice of orientations, its radius being 1, by the ways to turn."""

NEAREST = 4
"""Places beyond the boundary whose worst orientations are tried at a place."""

LEAST_TURN = 1e-9
"""A turn [rad] of which only the angle counts."""


@dataclass(frozen=True, eq=False)
class Worst:
    """Places (k, 3) [m] next to a set's boundary, and the orientation of the tool (k, 3, 3) that fails at each."""

    points: Array
    rotations: Array

    def near(self, points: Array) -> Array:
        """(m, c, 3, 3) the orientations that fail at the places nearest to points (m, 3)."""
        count = min(NEAREST, len(self.points))
        far = np.sum(points * points, axis=1)[:, None] - 2.0 * points @ self.points.T + np.sum(self.points**2, axis=1)
        nearest = np.argpartition(far, count - 1, axis=1)[:, :count] if count else np.zeros((len(points), 0), np.intp)
        return np.asarray(self.rotations[nearest])


NOTHING = Worst(np.zeros((0, 3)), np.zeros((0, 3, 3)))


@dataclass(frozen=True, eq=False)
class Every:
    """Whether places have every orientation: the worst of the places near them, and those of a grid, in an order by
    which the first decide most."""

    space: Space
    tried: Attitudes
    order: Index
    worst: Worst = NOTHING

    def __call__(self, points: Array) -> Flags:
        """(m,) whether each of points (m, 3) [m] has every orientation that is tried."""
        near = self.worst.near(points)
        passed = np.ones(len(points), dtype=bool)
        for k in range(near.shape[1]):
            left = np.flatnonzero(passed)
            passed[left] = reached_with_more(self.space, self.tried.task, points[left], near[left, k])
        passed[passed] = every(self.space, self.tried, self.order, points[passed])
        return passed

    def failing(self, points: Array) -> tuple[Flags, Array]:
        """(m,) whether an orientation fails at points (m, 3) [m], and one that does (m, 3, 3)."""
        near = self.worst.near(points)
        m, k = near.shape[:2]
        task = self.tried.task
        bad = ~reached_with(self.space, task, np.repeat(points, k, axis=0), near.reshape(-1, 3, 3)).reshape(m, k)
        first = np.argmax(np.append(bad, np.ones((m, 1), dtype=bool), axis=1), axis=1)
        rotations, fails = np.zeros((m, 3, 3)), first < k
        rotations[fails] = near[fails, first[fails]]
        left = np.flatnonzero(~fails)
        bad = ~table(self.space, self.tried, points[left])[:, self.order]
        rotations[left] = self.tried.rotations[self.order[np.argmax(bad, axis=1)]]
        fails[left] = np.any(bad, axis=1)
        return fails, rotations


def worst_beyond(oracle: Every, points: Array, radius: float, most: int, cores: int | None) -> Worst:
    """The worst orientations at points (m, 3) [m] just beyond the set of an oracle, or at `most` of them spread over
    all, within `radius` [rad] of one that fails."""
    count = min(len(points), most)
    chosen = points[(np.arange(count) * len(points)) // max(count, 1)]
    blocks = np.array_split(chosen, max(min(count // 50, 32), 1))
    found = list(ordered_map(partial(_worst, oracle, radius), blocks, cores))
    return Worst(*(np.concatenate(parts) for parts in zip(*found, strict=True)))


def _worst(oracle: Every, radius: float, points: Array) -> tuple[Array, Array]:
    """Those of points (m, 3) at which something fails, and the middle of what does (k, 3, 3)."""
    fails, rotations = oracle.failing(points)
    points, rotations = points[fails], rotations[fails]
    turns = small_turns(oracle.tried, rotations)
    lattice = radius * _lattice(turns.shape[1])
    about = np.einsum("pc,mcx->mpx", lattice, turns)
    m, p = about.shape[:2]
    tried = _turned(about.reshape(-1, 3), np.repeat(rotations, p, axis=0))
    task = oracle.tried.task
    bad = ~reached_with(oracle.space, task, np.repeat(points, p, axis=0), tried).reshape(m, p)
    middle = np.einsum("mp,mpx->mx", bad.astype(np.float64), about) / np.maximum(np.sum(bad, axis=1), 1)[:, None]
    return points, _turned(middle, rotations)


def _turned(about: Array, rotations: Array) -> Array:
    """Rotations (m, 3, 3) turned further by rotation vectors (m, 3) [rad] of the world."""
    angle = np.linalg.norm(about, axis=1)
    axis = np.where(angle[:, None] > LEAST_TURN, about, [1.0, 0.0, 0.0])
    return np.asarray(rotation_from_axis_angle(axis, angle) @ rotations)


def _lattice(dimensions: int) -> Array:
    """(p, c) a lattice's points in the unit ball, its middle among them."""
    step = STEP[dimensions]
    along = step * np.arange(-round(1.0 / step), round(1.0 / step) + 1)
    points = np.array(list(product(along, repeat=dimensions)))
    return np.asarray(points[np.sum(points * points, axis=1) <= 1.0 + 1e-9])
