"""A lattice over a region, split along the boundary of a set that only answers "is this point inside?".

Level by level the cells whose corners disagree are split, and their neighbours; in the last level the boundary crosses
edges of the cells' simplices, and where it does is found by bisection or told by the distance of the outer end.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np

from robokin.arrays import Array, Flags, Index, Whole
from robokin.jobs.ordered_map import ordered_map
from robokin.workspace.region import Region

Oracle = Callable[[Array], Flags]
Lacks = Callable[[Array], Array]

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

CHUNK, LEAST, PARTS = 4096, 128, 16
"""Points that an oracle is asked about at a time, at most and at least, and tasks that a question is cut into."""

FINEST = {1: 1 << 12, 2: 1 << 20, 3: 1 << 20}
"""Cells along a side at most: on a line halving an interval is all that is left to do."""

BESIDE = 1e-6
"""Corners on an axis of symmetry are looked at this part of a cell beside it, where an arm is not singular."""


def answers(inside: Oracle, region: Region, cores: int | None, u: Array) -> Flags:
    """Whether points u: (m, d) are in the set."""
    if not len(u):
        return np.zeros(0, dtype=bool)
    blocks = _blocks(region.points(u), inside)
    return np.concatenate([np.asarray(part, dtype=bool) for part in ordered_map(inside, blocks, cores)])


def _blocks(points: Array, inside: Oracle) -> list[Array]:
    """The parts of points (m, 3) that an oracle is asked about at a time."""
    size = min(CHUNK, max(getattr(inside, "least", LEAST), -(-len(points) // PARTS)))
    return np.array_split(points, max(len(points) // size, 1))


class CountedOracle:
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
        away = np.concatenate(list(ordered_map(self.lacks, blocks, self.cores)))
        return ~np.any(away, axis=1), away


def outlined(ask: CountedOracle, region: Region, left: int, budget: int, seed: int) -> tuple[Level, list[Settled]]:
    """The last level, all of whose cells have the boundary within, and those settled on the way, level by level;
    left: how many points may be looked at."""
    d = len(region.low)
    sides = region.high - region.low
    edge = float(np.prod(sides) * COARSE / max(budget, COARSE)) ** (1.0 / d)
    shape = np.maximum(np.round(sides / edge), 1).astype(np.int64)
    cells = np.stack(np.meshgrid(*map(np.arange, shape), indexing="ij"), axis=-1).reshape(-1, d).astype(np.int64)
    settled: list[Settled] = []
    level = Level(region, shape, cells)
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
        settled.append(Settled(level, ~split))
        level = level.split(split)
    settled.append(Settled(level, ~level.cut))
    return level.kept(level.cut), settled


def _new_corners(cells: int, d: int) -> int:
    """About how many new corners the parts of so many cells have, most of them in common with others."""
    return int(1.2 * ((1 << d) - 1) * cells)


class Level:
    """Cells of one level: region, shape (d,) of the whole lattice, cells (c, d) their numbers; of their corners, nodes
    (u, d) the numbers, of (c, 2^d) which belong to which cell, values (u,) whether they are in the set, away (u, 3)
    how they lie from it [m], NaN where that is not known."""

    def __init__(
        self, region: Region, shape: Whole, cells: Whole, known: tuple[Whole, Flags, Array] | None = None
    ) -> None:
        self.region, self.shape, self.cells = region, shape, cells
        d = len(shape)
        self.strides = np.append(np.cumprod((shape + 1)[::-1])[-2::-1], 1) if d > 1 else np.ones(1, dtype=np.int64)
        keys = (cells[:, None, :] + cell_corners(d)) @ self.strides
        nodes, of = np.unique(keys, return_inverse=True)
        self.of = of.reshape(keys.shape)
        self.nodes = nodes[:, None] // self.strides % (shape + 1)
        self.values, self.away = np.zeros(len(nodes), dtype=bool), np.full((len(nodes), 3), np.nan)
        self.unknown = np.ones(len(nodes), dtype=bool)
        if known is not None:
            place = np.searchsorted(nodes, known[0] @ self.strides)
            self.values[place], self.away[place], self.unknown[place] = known[1], known[2], False

    def look(self, ask: CountedOracle, others: Array) -> Flags:
        """Ask about the corners that are not known yet, and of other points (k, d) too, whose answer (k,) is given."""
        new = np.flatnonzero(self.unknown)
        values, away = ask.lacking(np.concatenate([self.at(new), others]))
        self.values[new], self.away[new], self.unknown[new] = values[: len(new)], away[: len(new)], False
        return values[len(new) :]

    def at(self, nodes: Index) -> Array:
        """Coordinates (k, d) [m] of corners."""
        step = (self.region.high - self.region.low) / self.shape
        u = self.region.low + self.nodes[nodes] * step
        if self.region.radial:
            u[:, 0] = np.maximum(u[:, 0], self.region.low[0] + BESIDE * step[0])
        return np.asarray(u)

    def corners_of(self, which: Flags | Index) -> tuple[Array, Array]:
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
    def edges(self) -> Index:
        """(e, 2) the edges, by their corners, whose ends disagree."""
        ends = self.of[self.cut][:, simplex_edges(len(self.shape))[0]].reshape(-1, 2)
        ends = ends[self.values[ends[:, 0]] != self.values[ends[:, 1]]]
        keys = np.unique(ends[:, 0] * len(self.values) + ends[:, 1])
        return np.stack([keys // len(self.values), keys % len(self.values)], axis=1)

    @property
    def untold(self) -> int:
        """How many crossings of edges must be asked for."""
        return int(np.sum(np.isnan(self._told(*self._ends()))))

    def split(self, which: Flags) -> Level:
        """The next level's: the 2^d parts of some of these cells."""
        cells = (2 * self.cells[which][:, None, :] + cell_corners(len(self.shape))).reshape(-1, len(self.shape))
        known = np.unique(self.of[which])
        return Level(self.region, 2 * self.shape, cells, (2 * self.nodes[known], self.values[known], self.away[known]))

    def kept(self, which: Flags) -> Level:
        """Some of the cells alone."""
        known = np.unique(self.of[which])
        kept = self.nodes[known], self.values[known], self.away[known]
        return Level(self.region, self.shape, self.cells[which], kept)

    def crossings(self, ask: CountedOracle, left: int) -> Crossings:
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
        return Crossings(keys, np.where(outer == self.edges[:, 0], part, 1.0 - part), beyond)

    def _ends(self) -> tuple[Index, Array, Array]:
        """Of the edges whose ends disagree the outer ends (e,), where they are, the ways to the inner ones (e, d)."""
        inner = np.where(self.values[self.edges[:, 0]], self.edges[:, 0], self.edges[:, 1])
        outer = np.sum(self.edges, axis=1) - inner
        start = self.at(outer)
        return outer, start, self.at(inner) - start

    def _told(self, outer: Index, start: Array, along: Array) -> Array:
        """(e,) the part of each edge from its outer end `start` (e, d) that is out of the set, as the outer end's
        distance tells: the plane through the nearest point that is square to it. NaN where it does not."""
        away, ahead = self.away[outer], self.region.points(start + along) - self.region.points(start)
        with np.errstate(invalid="ignore", divide="ignore"):
            part = -np.sum(away * away, axis=1) / np.sum(away * ahead, axis=1)
            return np.asarray(np.where((part > 0.0) & (part < 1.0), part, np.nan))


class Settled:
    """Cells of a level that are not split further: low, high (c, d) their corners [m], values (c,) whether they are in
    the set; shape (d,) of the whole lattice, keys (c,) their numbers in it."""

    def __init__(self, level: Level, which: Flags) -> None:
        self.shape, self.values = level.shape, level.first[which]
        self.low, self.high = level.corners_of(which)
        self.keys = cell_keys(level.cells[which], level.shape)

    def of(self, part: Array) -> tuple[Index, Index]:
        """Which of points, at parts (m, d) of the region's sides, are in these cells, and in which of them."""
        return looked_up(cell_keys(np.floor(part * self.shape).astype(np.int64), self.shape), self.keys)


def cell_keys(cells: Whole, shape: Whole) -> Whole:
    """(c,) a number for each cell (c, d) of a lattice."""
    return np.asarray(np.ravel_multi_index(tuple(np.clip(cells, 0, shape - 1).T), tuple(shape)))


def looked_up(wanted: Whole, keys: Whole) -> tuple[Index, Index]:
    """Which of some numbers (m,) are among others (c,), and the place of each of these there."""
    order = np.argsort(keys)
    place = np.minimum(np.searchsorted(keys, wanted, sorter=order), max(len(keys) - 1, 0))
    there = np.flatnonzero(keys[order[place]] == wanted) if len(keys) else np.zeros(0, dtype=np.intp)
    return there, order[place[there]] if len(keys) else there


@dataclass(frozen=True, eq=False)
class Crossings:
    """keys (e,) of edges, in order; part (e,) of the way from an edge's lower corner at which it leaves or enters the
    set; beyond (e, d) the nearest points to there that are known not to be in the set."""

    keys: Index
    part: Array
    beyond: Array


def cell_corners(d: int) -> Whole:
    """(2^d, d) a cell's corners: of corner i those coordinates are 1 whose bits are set."""
    return np.array([[i >> axis & 1 for axis in range(d)] for i in range(1 << d)], dtype=np.int64)


def simplex_edges(d: int) -> tuple[Index, Index]:
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
