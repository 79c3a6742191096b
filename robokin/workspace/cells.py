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

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import permutations, product
from math import exp, factorial, log, sqrt

import numpy as np
from numpy.typing import NDArray

from robokin.workspace.parallel import in_order
from robokin.workspace.region import Region
from robokin.workspace.region import region_of as region_of
from robokin.workspace.result import Measure

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Whole = NDArray[np.int64]
Oracle = Callable[[Array], Flags]
Lacks = Callable[[Array], Array]

RISK = 0.005
"""Chance that either of the error's two parts is greater than said: together 1 %."""

OUTLINE = {1: 0.15, 2: 0.3, 3: 0.55}
"""This part of the budget finds the boundary, by the number of dimensions; the rest tests what is made of it."""

ALONG = {1: 0.05, 2: 0.15, 3: 0.4}
"""This part of the tests goes to the cells with the boundary."""

COARSE = 12
"""One in so many points of the budget goes to the first lattice."""

CHECKS = 0.06
"""This part of the boundary's budget looks into cells while they are split: small features may be found."""

HALVINGS = 5
"""Times that a crossing's interval is halved where there are many: their errors cancel, and cells cost as much."""

MOST_HALVINGS = 24
"""The same where there are few, as in one dimension: to rounding."""

SECTIONS = 8
"""Parts of an edge, at most, whose ends are asked about all at once where distances do not tell the crossing."""

METHOD = "membership of points: cells split along the boundary, tested by points at random"

CHUNK, LEAST, PARTS = 4096, 128, 16
"""Points that an oracle is asked about at a time, at most and at least, and tasks that a question is cut into."""

FINEST = {1: 1 << 12, 2: 1 << 20, 3: 1 << 20}
"""Cells along a side at most: on a line halving an interval is all that is left to do."""

BESIDE = 1e-6
"""Corners on an axis of symmetry are looked at this part of a cell beside it, where an arm is not singular."""


def set_measure(inside: Oracle, region: Region, budget: int, seed: int = 0, cores: int | None = 1) -> Measure:
    """The size of the set of a region's points where `inside` holds: `cells_of` without the cells."""
    return cells_of(inside, region, budget, seed, cores)[0]


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
    ask = _Asked(inside, region, cores)
    level, settled = _outlined(ask, region, most, budget, seed)
    crossings = level.crossings(ask, most - ask.count)
    return Cells(level, crossings, settled, ask.count)


@dataclass(frozen=True, eq=False)
class _Guess:
    """What is thought of cells: low, high (c, d) their corners, holds: whether points u (m, d), each of a cell (m,),
    are in the set; and how many points shall test it."""

    low: Array
    high: Array
    tests: int
    holds: Callable[[Array, NDArray[np.intp]], Flags]


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


def answers(inside: Oracle, region: Region, cores: int | None, u: Array) -> Flags:
    """Whether points u: (m, d) are in the set."""
    if not len(u):
        return np.zeros(0, dtype=bool)
    blocks = _blocks(region.points(u), inside)
    return np.concatenate([np.asarray(part, dtype=bool) for part in in_order(inside, blocks, cores)])


def _blocks(points: Array, inside: Oracle) -> list[Array]:
    """The parts of points (m, 3) that an oracle is asked about at a time."""
    size = min(CHUNK, max(getattr(inside, "least", LEAST), -(-len(points) // PARTS)))
    return np.array_split(points, max(len(points) // size, 1))


class _Asked:
    """An oracle about a region's coordinates, which counts what it is asked."""

    def __init__(self, inside: Oracle, region: Region, cores: int | None) -> None:
        self.inside, self.region, self.cores = inside, region, cores
        self.lacks: Lacks | None = getattr(inside, "lacks", None)
        self.count = 0

    def __call__(self, u: Array) -> Flags:
        """Whether points u: (m, d) are in the set."""
        self.count += len(u)
        return answers(self.inside, self.region, self.cores, u)

    def lacking(self, u: Array) -> tuple[Flags, Array]:
        """The same, and the vectors (m, 3) [m] from the set, where the oracle knows them, else NaN."""
        if self.lacks is None or not len(u):
            return self(u), np.full((len(u), 3), np.nan)
        self.count += len(u)
        blocks = _blocks(self.region.points(u), self.inside)
        away = np.concatenate(list(in_order(self.lacks, blocks, self.cores)))
        return ~np.any(away, axis=1), away


# The lattice ----------------------------------------------------------------------------------------------


def _outlined(ask: _Asked, region: Region, left: int, budget: int, seed: int) -> tuple[_Level, list[_Settled]]:
    """The last level, all of whose cells have the boundary within, and those settled on the way, level by level;
    left: how many points may be looked at."""
    d = len(region.low)
    sides = region.high - region.low
    edge = float(np.prod(sides) * COARSE / max(budget, COARSE)) ** (1.0 / d)
    shape = np.maximum(np.round(sides / edge), 1).astype(np.int64)
    cells = np.stack(np.meshgrid(*map(np.arange, shape), indexing="ij"), axis=-1).reshape(-1, d).astype(np.int64)
    settled: list[_Settled] = []
    level = _Level(region, shape, cells)
    checks = int(CHECKS * left)
    each = HALVINGS if ask.lacks is None else SECTIONS - 1
    last = False
    while True:
        # Some cells are looked into as well: what their corners say may not be all.
        rng = np.random.default_rng((seed, int(np.max(level.shape)), 0xCE11))
        tested = rng.permutation(len(level.cells))[: 0 if last else max(checks // 2, 1)]
        checks -= len(tested)
        found = level.look(ask, region.drawn(*level.corners_of(tested), rng))
        open_ = level.cut.copy()
        open_[tested[found != level.first[tested]]] = True
        more = left - ask.count - (each << (d - 1)) * level.untold
        wide = _spread(open_, list(_pairs(level.cells, level.shape)))
        fits = [_new_corners(int(np.sum(part)), d) <= more for part in (wide, open_)]
        if last or not any(fits) or not open_.any() or np.max(level.shape) >= FINEST[d]:
            break
        last = not fits[0]
        split = open_ if last else wide
        settled.append(_Settled(level, ~split))
        level = level.split(split)
    settled.append(_Settled(level, ~level.cut))
    return level.kept(level.cut), settled


def _new_corners(cells: int, d: int) -> int:
    """About how many new corners the parts of so many cells have, most of them in common with others."""
    return int(1.2 * ((1 << d) - 1) * cells)


class _Level:
    """Cells of one level: region, shape (d,) of the whole lattice, cells (c, d) their numbers; of their corners, nodes
    (u, d) the numbers, of (c, 2^d) which belong to which cell, values (u,) whether they are in the set, away (u, 3)
    how they lie from it [m], NaN where that is not known."""

    def __init__(
        self, region: Region, shape: Whole, cells: Whole, known: tuple[Whole, Flags, Array] | None = None
    ) -> None:
        self.region, self.shape, self.cells = region, shape, cells
        d = len(shape)
        self.strides = np.append(np.cumprod((shape + 1)[::-1])[-2::-1], 1) if d > 1 else np.ones(1, dtype=np.int64)
        keys = (cells[:, None, :] + _corners(d)) @ self.strides
        nodes, of = np.unique(keys, return_inverse=True)
        self.of = of.reshape(keys.shape)
        self.nodes = nodes[:, None] // self.strides % (shape + 1)
        self.values, self.away = np.zeros(len(nodes), dtype=bool), np.full((len(nodes), 3), np.nan)
        self.unknown = np.ones(len(nodes), dtype=bool)
        if known is not None:
            place = np.searchsorted(nodes, known[0] @ self.strides)
            self.values[place], self.away[place], self.unknown[place] = known[1], known[2], False

    def look(self, ask: _Asked, others: Array) -> Flags:
        """Ask about the corners that are not known yet, and of other points (k, d) too, whose answer (k,) is given."""
        new = np.flatnonzero(self.unknown)
        values, away = ask.lacking(np.concatenate([self.at(new), others]))
        self.values[new], self.away[new], self.unknown[new] = values[: len(new)], away[: len(new)], False
        return values[len(new) :]

    def at(self, nodes: NDArray[np.intp]) -> Array:
        """Coordinates (k, d) [m] of corners."""
        step = (self.region.high - self.region.low) / self.shape
        u = self.region.low + self.nodes[nodes] * step
        if self.region.radial:
            u[:, 0] = np.maximum(u[:, 0], self.region.low[0] + BESIDE * step[0])
        return np.asarray(u)

    def corners_of(self, which: Flags | NDArray[np.intp]) -> tuple[Array, Array]:
        """Least and greatest coordinates (k, d) [m] of some of the cells: those of neighbours are the same."""
        step = (self.region.high - self.region.low) / self.shape
        cells = self.cells[which]
        return self.region.low + cells * step, self.region.low + (cells + 1) * step

    @property
    def first(self) -> Flags:
        """(c,) the value of each cell's first corner: of a cell that is not cut that of all of them."""
        return self.values[self.of[:, 0]]

    @cached_property
    def cut(self) -> Flags:
        """(c,) which cells have corners in the set and others out of it."""
        inside = self.values[self.of]
        return np.asarray(np.any(inside, axis=1) & ~np.all(inside, axis=1))

    @cached_property
    def edges(self) -> NDArray[np.intp]:
        """(e, 2) the edges, by their corners, whose ends disagree."""
        ends = self.of[self.cut][:, _edges(len(self.shape))[0]].reshape(-1, 2)
        ends = ends[self.values[ends[:, 0]] != self.values[ends[:, 1]]]
        keys = np.unique(ends[:, 0] * len(self.values) + ends[:, 1])
        return np.stack([keys // len(self.values), keys % len(self.values)], axis=1)

    @property
    def untold(self) -> int:
        """How many crossings of edges must be asked for."""
        return int(np.sum(np.isnan(self._told(*self._ends()))))

    def split(self, which: Flags) -> _Level:
        """The next level's: the 2^d parts of some of these cells."""
        cells = (2 * self.cells[which][:, None, :] + _corners(len(self.shape))).reshape(-1, len(self.shape))
        known = np.unique(self.of[which])
        return _Level(self.region, 2 * self.shape, cells, (2 * self.nodes[known], self.values[known], self.away[known]))

    def kept(self, which: Flags) -> _Level:
        """Some of the cells alone."""
        known = np.unique(self.of[which])
        kept = self.nodes[known], self.values[known], self.away[known]
        return _Level(self.region, self.shape, self.cells[which], kept)

    def crossings(self, ask: _Asked, left: int) -> _Crossings:
        """Where the boundary crosses the edges whose ends disagree; left: points that may be asked about."""
        outer, start, along = self._ends()
        part, beyond = self._told(outer, start, along), start.copy()
        open_ = np.flatnonzero(np.isnan(part))
        if ask.lacks is not None:
            sections = min(SECTIONS, max(left // max(len(open_), 1) + 1, 2))
            ends = np.arange(1, sections) / sections
            u = start[open_, None] + ends[:, None] * along[open_, None]
            there = np.ones((len(open_), sections), dtype=bool)
            there[:, :-1] = ask(u.reshape(-1, u.shape[2])).reshape(u.shape[:2])
            part[open_] = (np.argmax(there, axis=1) + 0.5) / sections
        else:
            most = HALVINGS if len(self.shape) > 1 else MOST_HALVINGS
            low, high = np.zeros(len(open_)), np.ones(len(open_))
            for _ in range(min(left // len(open_), most) if len(open_) else 0):
                middle = 0.5 * (low + high)
                there = ask(start[open_] + middle[:, None] * along[open_])
                low, high = np.where(there, low, middle), np.where(there, middle, high)
            part[open_] = 0.5 * (low + high)
            beyond[open_] += low[:, None] * along[open_]
        keys = self.edges[:, 0] * len(self.values) + self.edges[:, 1]
        return _Crossings(keys, np.where(outer == self.edges[:, 0], part, 1.0 - part), beyond)

    def _ends(self) -> tuple[NDArray[np.intp], Array, Array]:
        """Of the edges whose ends disagree the outer ends (e,), where they are, the ways to the inner ones (e, d)."""
        inner = np.where(self.values[self.edges[:, 0]], self.edges[:, 0], self.edges[:, 1])
        outer = np.sum(self.edges, axis=1) - inner
        start = self.at(outer)
        return outer, start, self.at(inner) - start

    def _told(self, outer: NDArray[np.intp], start: Array, along: Array) -> Array:
        """(e,) the part of each edge from its outer end `start` (e, d) that is out of the set, as the outer end's
        distance tells: the plane through the nearest point that is square to it. NaN where it does not."""
        away, ahead = self.away[outer], self.region.points(start + along) - self.region.points(start)
        with np.errstate(invalid="ignore", divide="ignore"):
            part = -np.sum(away * away, axis=1) / np.sum(away * ahead, axis=1)
            return np.asarray(np.where((part > 0.0) & (part < 1.0), part, np.nan))


class _Settled:
    """Cells of a level that are not split further: low, high (c, d) their corners [m], values (c,) whether they are in
    the set; shape (d,) of the whole lattice, keys (c,) their numbers in it."""

    def __init__(self, level: _Level, which: Flags) -> None:
        self.shape, self.values = level.shape, level.first[which]
        self.low, self.high = level.corners_of(which)
        self.keys = _keys(level.cells[which], level.shape)

    def of(self, part: Array) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Which of points, at parts (m, d) of the region's sides, are in these cells, and in which of them."""
        return _found(_keys(np.floor(part * self.shape).astype(np.int64), self.shape), self.keys)


def _keys(cells: Whole, shape: Whole) -> Whole:
    """(c,) a number for each cell (c, d) of a lattice."""
    return np.asarray(np.ravel_multi_index(tuple(np.clip(cells, 0, shape - 1).T), tuple(shape)))


def _found(wanted: Whole, keys: Whole) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Which of some numbers (m,) are among others (c,), and the place of each of these there."""
    order = np.argsort(keys)
    place = np.minimum(np.searchsorted(keys, wanted, sorter=order), max(len(keys) - 1, 0))
    there = np.flatnonzero(keys[order[place]] == wanted) if len(keys) else np.zeros(0, dtype=np.intp)
    return there, order[place[there]] if len(keys) else there


@dataclass(frozen=True, eq=False)
class _Crossings:
    """keys (e,) of edges, in order; part (e,) of the way from an edge's lower corner at which it leaves or enters the
    set; beyond (e, d) the nearest points to there that are known not to be in the set."""

    keys: NDArray[np.intp]
    part: Array
    beyond: Array


# The boundary in the last cells ---------------------------------------------------------------------------


class Cells:
    """A guess at a set: cells that fill a region, and the boundary in those that it passes.

    low, high (c, d) the cells' corners [m]; fraction (c,) of each in the set; settled: how many of them, the first
    ones, are alike at all corners; beyond (e, d): points next to the boundary that are not in the set; size [m, m² or
    m³] of the set; spent: how many points were looked at.

    In a simplex with vertices within and without, the set is bounded by the crossings of its edges. `far` is the part
    of an edge from a vertex within to the crossing.
    """

    def __init__(self, level: _Level, crossings: _Crossings, settled: list[_Settled], spent: int) -> None:
        self.region, self.spent, self.beyond = level.region, spent, crossings.beyond
        self.d = d = len(level.shape)
        low, high, values = (
            np.concatenate([getattr(part, name) for part in settled]) for name in ("low", "high", "values")
        )
        self.parts, self.cut_shape, self.cut_keys = settled, level.shape, _keys(level.cells, level.shape)
        self.settled = len(values)
        self.cut = level.corners_of(np.ones(len(level.cells), dtype=bool))
        self.low, self.high = np.concatenate([low, self.cut[0]]), np.concatenate([high, self.cut[1]])
        self.inside = level.values[level.of]
        ends, self.number = _edges(d)
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
        there, which = _found(_keys(np.floor(part * self.cut_shape).astype(np.int64), self.cut_shape), self.cut_keys)
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

    def _alike(self, u: Array, which: NDArray[np.intp]) -> Flags:
        """(m,) whether points u (m, d), each of a settled cell `which` (m,), are in the set."""
        return np.asarray(self.fraction[which] == 1.0)

    def _holds(self, u: Array, which: NDArray[np.intp]) -> Flags:
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

    def _sorted(self, vertices: NDArray[np.intp], which: NDArray[np.intp]) -> tuple[NDArray[np.intp], ...]:
        """An order (m, d + 1) of simplices' vertices by which those within come first, the vertices in that order, and
        how many are within (m,)."""
        inside = self.inside[which[:, None], vertices]
        order = np.argsort(~inside, axis=1, kind="stable")
        return order, np.take_along_axis(vertices, order, axis=1), np.sum(inside, axis=1)

    def _radii(self, vertices: NDArray[np.intp]) -> Array:
        """(c, d + 1) the first coordinate of each cell's vertices."""
        return np.where(vertices & 1, self.cut[1][:, :1], self.cut[0][:, :1])

    def _far(self, vertices: NDArray[np.intp], which: NDArray[np.intp], k: int) -> Array:
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


def _corners(d: int) -> Whole:
    """(2^d, d) a cell's corners: of corner i those coordinates are 1 whose bits are set."""
    return np.array([[i >> axis & 1 for axis in range(d)] for i in range(1 << d)], dtype=np.int64)


def _edges(d: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """(e, 2) the edges of a cell's simplices, each from corner a to corner b, a's bits being among b's; and for two
    corners in any order (2^d, 2^d) the number of their edge."""
    ends = [(a, b) for a, b in product(range(1 << d), repeat=2) if a < b and a & b == a]
    number = np.zeros((1 << d, 1 << d), dtype=np.intp)
    for i, (a, b) in enumerate(ends):
        number[a, b] = number[b, a] = i
    return np.array(ends, dtype=np.intp), number


def _pairs(cells: Whole, shape: Whole) -> Iterator[tuple[Whole, Whole]]:
    """Each two neighbouring cells once, corners included, as indices into cells."""
    d = cells.shape[1]
    # One empty cell beyond each side keeps neighbours apart from the next row's cells.
    strides = np.append(np.cumprod((shape + 2)[::-1])[-2::-1], 1) if d > 1 else np.ones(1, dtype=np.int64)
    keys = (cells + 1) @ strides
    order = np.argsort(keys)
    ordered = keys[order]
    for offset in product((-1, 0, 1), repeat=d):
        if offset <= (0,) * d:
            continue
        wanted = keys + int(np.dot(offset, strides))
        place = np.minimum(np.searchsorted(ordered, wanted), len(ordered) - 1)
        there = np.flatnonzero(ordered[place] == wanted)
        yield there, order[place[there]]


def _spread(marked: Flags, pairs: list[tuple[Whole, Whole]]) -> Flags:
    """The marked cells and their neighbours."""
    wider = marked.copy()
    if marked.any():
        for a, b in pairs:
            wider[a[marked[b]]] = True
            wider[b[marked[a]]] = True
    return wider


# Chance ---------------------------------------------------------------------------------------------------


def points_in(
    region: Region, low: Array, high: Array, count: int, rng: np.random.Generator
) -> tuple[Array, NDArray[np.intp]]:
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
