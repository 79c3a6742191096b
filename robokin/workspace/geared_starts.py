"""Starts near any point for robots whose joints hang on each other: configurations kept by where they put the tool.

The first variable may move more than one joint, so that nothing is known of the rest without it: the table has the
coordinates of the set's own line or plane, or all three.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import combinations, product

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.jobs.sequences import unit_points
from robokin.workspace.faces import EDGE, FACE, MANY, SECTIONS, held_values
from robokin.workspace.half_spaces import HalfSpaces
from robokin.workspace.sampling import moving_cuts
from robokin.workspace.space import Space
from robokin.workspace.starts import ALONE, BEYOND, EACH, THIN

PLACED = 1 << 17
"""Configurations in the table of a whole box: variables may make many turns, and the set lie in many sheets."""

LOOKED_AT = 48
"""Configurations of a cell among which the best are chosen."""

MOST_CELLS = 40
"""Cells along a side of a table of a curve or a surface in space, which fills few of them, at most."""

AWAY = 0.08
"""And this part of a table's greatest side from the nearest configuration a point is out of reach: with variables to
spare few configurations come near the boundary."""

Place = Callable[[Array], Array]


class PlacedStarts:
    """A table of configurations q (n, k) by cells of where `place` says that they put the tool's origin.

    basis: (3, d) the directions whose coordinates count; dimension: of the set that they put it on.
    """

    def __init__(self, place: Place, basis: Array, dimension: int, q: Array) -> None:
        self.q, self.basis, self.dimension = q, basis, dimension
        self.seen = basis.T @ place(q)
        self.corner = self.seen.min(axis=1)
        spread = max(float(np.max(np.ptp(self.seen, axis=1))), THIN * float(np.max(np.abs(self.seen)))) or 1.0
        along = (q.shape[1] / EACH) ** (1.0 / dimension)
        self.step = spread / (min(along, MOST_CELLS) if dimension < len(self.seen) else along) * (1.0 + 1e-9)
        self.shape = np.maximum(np.ceil(np.ptp(self.seen, axis=1) / self.step), 1).astype(np.intp)
        cells = self._cell(self.seen)
        self.order = np.argsort(cells, kind="stable")
        count = np.bincount(cells, minlength=int(np.prod(self.shape)))
        first = np.cumsum(count) - count
        occupied = (count > 0).reshape(self.shape)
        self.alone = max(ALONE, int(np.ceil(AWAY * np.max(self.shape))))
        self.far = ~_grown(occupied, self.alone).reshape(-1)
        nearest = _nearest_occupied(occupied).reshape(-1)
        self.first, self.count = first[nearest], count[nearest]

    def near(self, points: Array, near: int, far: int) -> Array:
        """Starts (near + far, n, m) for points (3, m) [m]; see `Starts.near`."""
        seen = self.basis.T @ points
        cells = self._cell(seen)
        first, kept = self.first[cells], self.count[cells]
        # Spread over the cell, of which a curve may have a great many.
        picked = self.order[first + np.arange(LOOKED_AT)[:, None] * np.maximum(kept // LOOKED_AT, 1) % kept]
        off = np.sum((self.seen[:, picked] - seen[:, None, :]) ** 2, axis=0)
        rank = np.argsort(off, axis=0, kind="stable")[:near]
        scattered = (np.arange(1, far + 1)[:, None] * 0.6180339887498949 + np.sum(seen, axis=0) / self.step) % 1.0
        anywhere = (scattered * len(self.order)).astype(np.intp)
        chosen = np.concatenate([np.take_along_axis(picked, rank, axis=0), anywhere])
        return np.ascontiguousarray(self.q[:, chosen].transpose(1, 0, 2))

    def beyond(self, points: Array) -> Flags:
        """(m,) whether points (3, m) [m] lie so far from every configuration's that none can be reached."""
        seen = self.basis.T @ points
        outside = np.any(seen < self.corner[:, None] - self.alone * self.step, axis=0)
        outside |= np.any(seen > self.corner[:, None] + (self.shape[:, None] + self.alone) * self.step, axis=0)
        return np.asarray(outside | self.far[self._cell(seen)])

    def _cell(self, seen: Array) -> Index:
        # Kept to the table before they become whole numbers: a point may be farther off than these go.
        last = self.shape[:, None] - 1.0
        place = np.clip((seen - self.corner[:, None]) / self.step, 0.0, last).astype(np.intp)
        return np.asarray(np.ravel_multi_index(tuple(place), tuple(self.shape)))


def geared_tables(space: Space, place: Place) -> tuple[PlacedStarts, list[PlacedStarts], list[PlacedStarts]]:
    """The table of configurations of a space's moving variables, those with one variable at a limit, and with two."""
    moving = list(space.moving)
    low, high, full, n = space.low[moving], space.high[moving], space.full[moving], len(moving)
    basis = space.basis if space.basis is not None else np.eye(3)
    cuts = moving_cuts(space)

    def table(hold: tuple[tuple[int, float], ...], kept: int) -> PlacedStarts:
        own, least, greatest = cuts, low.copy(), high.copy()
        for i, value in hold:
            own = own.at(i, value)
            least[i] = greatest[i] = value
        return PlacedStarts(place, basis, space.dimension, spread_to_limits(own, least, greatest, kept))

    singles = [((i, value),) for i in range(n) for value in held_values(low, high, full, i, SECTIONS[0])]
    each = [[(i, value) for value in held_values(low, high, full, i, SECTIONS[1])] for i in range(n)]
    pairs = [pair for i, j in combinations(range(n), 2) for pair in product(each[i], each[j])] if n <= MANY else []
    return table((), PLACED), [table(hold, FACE) for hold in singles], [table(hold, EDGE) for hold in pairs]


def spread_to_limits(cuts: HalfSpaces, low: Array, high: Array, count: int, scramble: int = 0, seed: int = 0) -> Array:
    """(n, count) values within cuts and a box (n,), (n,), of every other of which some are at limits."""
    u = unit_points("sobol", len(low), seed, 0, count, count, scramble)
    u[:, ::2] = np.clip((1.0 + 2.0 * BEYOND) * u[:, ::2] - BEYOND, 0.0, 1.0)
    return cuts.filled(u, low, high)


def _grown(occupied: Flags, by: int) -> Flags:
    """Cells that are occupied or at most `by` cells from one that is."""
    for axis in range(occupied.ndim):
        grown = occupied.copy()
        for shift in range(1, by + 1):
            before, after = (
                [slice(None)] * axis + [part] for part in (slice(None, -shift), slice(shift, None))
            )  # fmt: skip
            grown[tuple(after)] |= occupied[tuple(before)]
            grown[tuple(before)] |= occupied[tuple(after)]
        occupied = grown
    return occupied


def _nearest_occupied(occupied: Flags) -> Index:
    """For each cell of a table the number of an occupied cell near it, its own if it is occupied."""
    number = np.where(occupied, np.arange(occupied.size).reshape(occupied.shape), -1)
    while np.any(number < 0):
        padded = np.pad(number, 1, constant_values=-1)
        for shift in product((1, 0, 2), repeat=occupied.ndim):
            beside = padded[tuple(slice(k, k + side) for k, side in zip(shift, occupied.shape, strict=True))]
            number = np.where(number < 0, beside, number)
    return np.asarray(number)
