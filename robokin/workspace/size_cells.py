"""The size of a set that only answers "is this point inside?", with a bound of the error.

The corners of a lattice over a region are looked at. Where the corners of a cell disagree the set's boundary passes;
such a cell and its neighbours are split into 2^d, level by level, while the budget lasts. In the last level's cells
the boundary is followed by linear interpolation: each cell is cut into the d! simplices of H. Freudenthal
("Simplizialzerlegungen von beschränkter Flachheit", Annals of Mathematics 43, 1942), the crossing on each edge whose
ends disagree is found, and through the crossings a line or plane is laid: it is off by the square of the cells' side.
(In two dimensions that is "marching squares", in three "marching tetrahedra".) A crossing is found by bisection; but
where it is known how far the outer end is from the set, the plane that is square to that distance tells it at once.

All that is a guess about every point of the region, and is tested: fresh points are drawn at random, both in the
cells that are all alike and in those with the boundary. What they contradict corrects the sum, so that it is without
bias however the set looks, and what they may have missed by chance is bounded by the upper limit of a Poisson variable
(none seen in m: at most -ln(δ) / m of the cells).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import permutations
from math import exp, factorial, log, sqrt

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.workspace.lattice import (
    CountedOracle,
    Crossings,
    Level,
    Oracle,
    Settled,
    answers,
    cell_keys,
    looked_up,
    outlined,
    simplex_edges,
)
from robokin.workspace.region import Region
from robokin.workspace.sizes import Measure

RISK = 0.005
"""Chance that either of the error's two parts is greater than said: together 1 %."""

OUTLINE = {1: 0.15, 2: 0.3, 3: 0.55}
"""This part of the budget finds the boundary, by the number of dimensions; the rest tests what is made of it."""

ALONG = {1: 0.05, 2: 0.15, 3: 0.4}
"""This part of the tests goes to the cells with the boundary."""


METHOD = "membership of points: cells split along the boundary, tested by points at random"


def cells_of(
    inside: Oracle, region: Region, budget: int, seed: int = 0, cores: int | None = 1
) -> tuple[Measure, Cells]:
    """The size of a set, and the cells that show it, from `budget` points that may be looked at.

    The answer depends on the seed and the budget only, not on the number of cores.
    """
    cells = split_cells(inside, region, int(OUTLINE[len(region.low)] * budget), budget, seed, cores)
    return checked(inside, cells, max(budget - cells.spent, 0), seed, cores).measure, cells


def split_cells(inside: Oracle, region: Region, most: int, budget: int, seed: int = 0, cores: int | None = 1) -> Cells:
    """A guess at a set: cells and the boundary in them.

    inside: whether points (m, 3) [m] are in the set, (m,). most: points that may be looked at; budget: those of all
    that is done with the set, by which the first lattice is made. An oracle may have a method `lacks(points)` that
    gives the vectors (m, 3) [m] from the nearest points of the set, zero within it, and a number `least` of points
    that it should be asked about at a time.
    """
    ask = CountedOracle(inside, region, cores)
    level, settled = outlined(ask, region, most, budget, seed)
    crossings = level.crossings(ask, most - ask.count)
    return Cells(level, crossings, settled, ask.count)


@dataclass(frozen=True, eq=False)
class _Guess:
    """What is thought of cells: low, high (c, d) their corners, holds: whether points u (m, d), each of a cell (m,),
    are in the set; and how many points shall test it."""

    low: Array
    high: Array
    tests: int
    holds: Callable[[Array, Index], Flags]


@dataclass(frozen=True, eq=False)
class Check:
    """What points at random say of such cells: the size of the set, and those points of them refuted (r, 3) [m] that
    were thought to be in it, each of which stands for `share` (r,) of the size."""

    measure: Measure
    refuted: Array
    share: Array


def checked(inside: Oracle, cells: Cells, tests: int, seed: int = 0, cores: int | None = 1) -> Check:
    """The size of a set of which cells give a good guess, by so many points at random.

    `inside` may be another oracle than the cells were found with: it is its set that is measured.
    """
    rng = np.random.default_rng((seed, 0x7E57))
    region, guesses = cells.region, cells.guesses(tests)
    counts = [guess.tests if len(guess.low) else 0 for guess in guesses]
    drawn = [points_in(region, guess.low, guess.high, k, rng) for guess, k in zip(guesses, counts, strict=True)]
    found = np.split(answers(inside, region, cores, np.concatenate([u for u, _ in drawn])), np.cumsum(counts)[:-1])
    missed = doubt = 0.0
    refuted, share = [np.zeros((0, 3))], [np.zeros(0)]
    for guess, count, (u, which), there in zip(guesses, counts, drawn, found, strict=True):
        whole = float(np.sum(region.sizes(guess.low, guess.high)))
        if not count:
            doubt += whole
            continue
        thought = guess.holds(u, which)
        more, less = int(np.sum(there & ~thought)), int(np.sum(~there & thought))
        missed += whole * (more - less) / count
        doubt += whole * (poisson_limit(more + less, RISK) - (more + less)) / count
        refuted.append(region.points(u[~there & thought]))
        share.append(np.full(less, whole / count))
    measure = Measure(max(cells.size + missed, 0.0), doubt, METHOD, cells.spent + sum(counts))
    return Check(measure, np.concatenate(refuted), np.concatenate(share))


class Cells:
    """A guess at a set: cells that fill a region, and the boundary in those that it passes.

    low, high (c, d) the cells' corners [m]; fraction (c,) of each in the set; settled: how many of them, the first
    ones, are alike at all corners; beyond (e, d): points next to the boundary that are not in the set; size [m, m² or
    m³] of the set; spent: how many points were looked at.

    In a simplex with vertices within and without, the set is bounded by the crossings of its edges. `far` is the part
    of an edge from a vertex within to the crossing.
    """

    def __init__(self, level: Level, crossings: Crossings, settled: list[Settled], spent: int) -> None:
        self.region, self.spent, self.beyond = level.region, spent, crossings.beyond
        self.d = d = len(level.shape)
        low, high, values = (
            np.concatenate([getattr(part, name) for part in settled]) for name in ("low", "high", "values")
        )
        self.parts, self.cut_shape, self.cut_keys = settled, level.shape, cell_keys(level.cells, level.shape)
        self.settled = len(values)
        self.cut = level.corners_of(np.ones(len(level.cells), dtype=bool))
        self.low, self.high = np.concatenate([low, self.cut[0]]), np.concatenate([high, self.cut[1]])
        self.inside = level.values[level.of]
        ends, self.number = simplex_edges(d)
        keys = level.of[:, ends[:, 0]] * len(level.values) + level.of[:, ends[:, 1]]
        place = np.minimum(np.searchsorted(crossings.keys, keys), max(len(crossings.keys) - 1, 0))
        self.part = crossings.part[place] if len(crossings.keys) else np.zeros(keys.shape)
        self.fraction = np.concatenate([values.astype(np.float64), self._fractions()])
        self.size = float(self.region.sizes(self.low, self.high) @ self.fraction)

    def contains(self, u: Array) -> Flags:
        """(m,) whether points u: (m, d) of the region are in the set; none beyond it is."""
        low, high = self.region.low, self.region.high
        within = np.flatnonzero(np.all((u >= low) & (u <= high), axis=1))
        part = (u[within] - low) / (high - low)
        inside = np.zeros(len(u), dtype=bool)
        for settled in self.parts:
            there, which = settled.of(part)
            inside[within[there]] = settled.values[which]
        there, which = looked_up(
            cell_keys(np.floor(part * self.cut_shape).astype(np.int64), self.cut_shape), self.cut_keys
        )
        inside[within[there]] = self._holds(u[within[there]], which)
        return inside

    def guesses(self, tests: int) -> list[_Guess]:
        """What is thought of the cells without and with the boundary, to be tested by so many points in all."""
        along = int(ALONG[self.d] * tests) if len(self.low) > self.settled else 0
        low, high = self.low[: self.settled], self.high[: self.settled]
        return [
            _Guess(low, high, tests - along, self._alike),
            _Guess(*self.cut, along, self._holds),
        ]

    def _alike(self, u: Array, which: Index) -> Flags:
        """(m,) whether points u (m, d), each of a settled cell `which` (m,), are in the set."""
        return np.asarray(self.fraction[which] == 1.0)

    def _holds(self, u: Array, which: Index) -> Flags:
        """(m,) whether points u (m, d), each of a cell `which` (m,) with the boundary, are in the set."""
        low, high = self.cut
        x = (u - low[which]) / (high - low)[which]
        order = np.argsort(-x, axis=1, kind="stable")
        ordered = np.take_along_axis(x, order, axis=1)
        m = len(u)
        vertices = np.concatenate([np.zeros((m, 1), dtype=np.intp), np.cumsum(1 << order, axis=1)], axis=1)
        one, none = np.ones((m, 1)), np.zeros((m, 1))
        shares = np.concatenate([one, ordered], axis=1) - np.concatenate([ordered, none], axis=1)
        within, vertices, count = self._sorted(vertices, which)
        shares = np.take_along_axis(shares, within, axis=1)
        answer = count == self.d + 1
        for k in range(1, self.d + 1):
            some = np.flatnonzero(count == k)
            if len(some):
                far = self._far(vertices[some], which[some], k)
                answer[some] = _holds(shares[some], far, k)
        return np.asarray(answer)

    def _fractions(self) -> Array:
        """(c,) the part of each cell with the boundary that is in the set."""
        low, high = self.cut
        c, d = low.shape
        total = np.zeros(c)
        every = np.arange(c)
        for axes in permutations(range(d)):
            simplex = np.cumsum([0, *(1 << axis for axis in axes)])
            _, vertices, count = self._sorted(np.tile(simplex, (c, 1)), every)
            # What a unit of the box is in the world: the same everywhere, or in proportion to the first coordinate.
            weight = self._radii(vertices) if self.region.radial else np.ones(vertices.shape)
            whole = np.mean(weight, axis=1)
            total += np.where(count == d + 1, whole, 0.0)
            for k in range(1, d + 1):
                some = np.flatnonzero(count == k)
                if len(some):
                    far = self._far(vertices[some], some, k)
                    total[some] += _part(weight[some], far, k, whole[some])
        middle = 0.5 * (low[:, 0] + high[:, 0]) if self.region.radial else 1.0
        return np.asarray(np.clip(total / factorial(d) / middle, 0.0, 1.0))

    def _sorted(self, vertices: Index, which: Index) -> tuple[Index, ...]:
        """An order (m, d + 1) of simplices' vertices by which those within come first, the vertices in that order, and
        how many are within (m,)."""
        inside = self.inside[which[:, None], vertices]
        order = np.argsort(~inside, axis=1, kind="stable")
        return order, np.take_along_axis(vertices, order, axis=1), np.sum(inside, axis=1)

    def _radii(self, vertices: Index) -> Array:
        """(c, d + 1) the first coordinate of each cell's vertices."""
        return np.where(vertices & 1, self.cut[1][:, :1], self.cut[0][:, :1])

    def _far(self, vertices: Index, which: Index, k: int) -> Array:
        """(m, k, d + 1 - k) the part of each edge from a vertex within to one without that is in the set."""
        a, b = vertices[:, :k, None], vertices[:, None, k:]
        part = self.part[which[:, None, None], self.number[a, b]]
        return np.where(a < b, part, 1.0 - part)


def _part(weight: Array, far: Array, k: int, whole: Array) -> Array:
    """(m,) d! times what simplices with k vertices within hold of the set, by a linear weight (m, d + 1) of their
    vertices, those within first; far: (m, k, d + 1 - k), whole: (m,) that of the entire simplices."""
    d = weight.shape[1] - 1
    if k == 1:
        return _corner(weight, far[:, 0])
    if k == d:
        return whole - _corner(weight[:, ::-1], (1.0 - far[:, ::-1, 0]))
    # Two of four vertices, and the weight is everywhere the same: a wedge is three tetrahedra.
    x, y, u, v = far[:, 0, 0], far[:, 0, 1], far[:, 1, 0], far[:, 1, 1]
    return whole * (x * y + x * v * (1.0 - y) + (1.0 - x) * u * v)


def _corner(weight: Array, far: Array) -> Array:
    """(m,) d! times a simplex's weight between its first vertex and points that lie `far` (m, d) on the way from there
    to the others."""
    mean = weight[:, 0] + np.sum(far * (weight[:, 1:] - weight[:, :1]), axis=1) / weight.shape[1]
    return np.asarray(np.prod(far, axis=1) * mean)


def _holds(shares: Array, far: Array, k: int) -> Flags:
    """(m,) whether points with barycentric coordinates `shares` (m, d + 1), k vertices within first, are in the set."""
    d = shares.shape[1] - 1
    if k == 1:
        return np.asarray(np.sum(shares[:, 1:] / far[:, 0], axis=1) <= 1.0)
    if k == d:
        return np.asarray(np.sum(shares[:, :d] / (1.0 - far[:, :, 0]), axis=1) > 1.0)
    # The three tetrahedra of the wedge: coordinates of the point in each must not be negative.
    la, lb, lc, ld = shares.T
    x, y, u, v = far[:, 0, 0], far[:, 0, 1], far[:, 1, 0], far[:, 1, 1]
    first = la - lc / x * (1.0 - x) - ld / y * (1.0 - y) >= 0.0
    turn = (la - lc / x * (1.0 - x)) / (1.0 - y)
    rest = (ld - turn * y) / v
    second = (turn >= 0.0) & (rest >= 0.0) & (lb - rest * (1.0 - v) >= 0.0)
    turn = la / (1.0 - x)
    rest = (lc - turn * x) / u
    third = (rest >= 0.0) & (lb - rest * (1.0 - u) - ld / v * (1.0 - v) >= 0.0)
    return np.asarray(first | second | third)


def points_in(region: Region, low: Array, high: Array, count: int, rng: np.random.Generator) -> tuple[Array, Index]:
    """Points u: (count, d) all over some cells, uniform in the world, and the cell (count,) of each."""
    if not count:
        return np.zeros((0, low.shape[1])), np.zeros(0, dtype=np.intp)
    # One point in each of as many equal parts of the cells, strung together.
    ends = np.cumsum(region.sizes(low, high))
    place = (np.arange(count) + rng.random(count)) / count * ends[-1]
    chosen = np.minimum(np.searchsorted(ends, place), len(ends) - 1)
    return region.drawn(low[chosen], high[chosen], rng), chosen


def poisson_limit(count: int, risk: float) -> float:
    """The greatest mean of a Poisson variable for which `count` or fewer has a chance of `risk` at least."""
    low, high = float(count), count + 2.0 * sqrt(-2.0 * log(risk) * (count + 1.0)) - 2.0 * log(risk)
    for _ in range(60):
        mean = 0.5 * (low + high)
        # The terms from the last on, so that none is too small for the sum to begin with.
        term, total = 1.0, 1.0
        for k in range(count, 0, -1):
            term *= k / mean
            total += term
            if term < 1e-17 * total:
                break
        chance = exp(-mean + count * log(mean) - _log_factorial(count)) * total
        low, high = (mean, high) if chance > risk else (low, mean)
    return high


def _log_factorial(count: int) -> float:
    return float(np.sum(np.log(np.arange(1, count + 1))))
