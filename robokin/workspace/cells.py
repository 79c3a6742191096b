"""The size of a set that only answers "is this point inside?", with a bound of the error.

A coarse grid of cells is laid over a region and one point of each is looked at, at random within the cell. Where
neighbours disagree the set's boundary passes, and those cells with a ring about them are split into 2^d, level by
level, while the budget lasts; all others are settled. The last level's unsettled cells are looked at in several
points each: independent, uniform in each cell, an estimate without bias that is as exact as the cells are small.

That a settled cell is wholly in or out is a guess, and is tested: fresh points are drawn all over the settled
cells. What they contradict corrects the sum, without bias, and what they may have missed by chance is bounded by
the upper limit of a Poisson variable (none seen in m: at most -ln(δ) / m of it). The error of the unsettled
cells' sum is that of a normal variable where many cells take part, else bounded by Hoeffding's inequality or the
empirical Bernstein bound (A. Maurer and M. Pontil, "Empirical Bernstein bounds and sample variance penalization",
COLT 2009, theorem 4), whichever is less.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from itertools import product
from math import exp, log, sqrt

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

RISK = 0.005
"""Chance that either of the error's two parts is greater than said: together 1 %."""

MANY, NORMAL = 100, 3.0
"""From so many cells on that are partly in the set their sum is normal, and off by less than so many of its standard
deviations but for a chance of 0.3 %: less than RISK, since the deviation is itself estimated."""

CHECKS = 0.125
"""This part of the budget tests settled cells at the end, and half as much on the way."""

COARSE = 12
"""One in so many points of the budget goes to the first grid."""

METHOD = "membership of points in cells, split where they differ"

CHUNK, LEAST, PARTS = 4096, 128, 16
"""Points that an oracle is asked about at a time, at most and at least, and tasks that a question is cut into."""


@dataclass(frozen=True, eq=False)
class Cells:
    """Cells that fill a region: low, high (c, d) their corners [m]; fraction (c,) of each that is in the set;
    settled (c,) whether that is 0 or 1 because all about the cell is alike; missed: what the settled ones have
    too little [m, m² or m³], as far as the test of them says."""

    region: Region
    low: Array
    high: Array
    fraction: Array
    settled: Flags
    missed: float


def set_measure(inside: Oracle, region: Region, budget: int, seed: int = 0, cores: int | None = 1) -> Measure:
    """The size of the set of a region's points where `inside` holds: `cells_of` without the cells."""
    return cells_of(inside, region, budget, seed, cores)[0]


def cells_of(
    inside: Oracle,
    region: Region,
    budget: int,
    seed: int = 0,
    cores: int | None = 1,
    proof: Oracle | None = None,
    tests: int | None = None,
) -> tuple[Measure, Cells]:
    """The size of a set, and the cells that show it.

    inside: whether points (m, 3) [m] are in the set, (m,). `budget`: points that may be looked at. proof: an oracle
    that is asked in the test of the settled cells, where `inside` is a cheaper one that is nearly the same; what
    they differ by in the unsettled cells is not seen. tests: the points of that test, which are then not of the
    budget. The answer depends on the seed and the budget only, not on the number of cores.
    """
    ask, prove = partial(answers, inside, region, cores), partial(answers, proof or inside, region, cores)
    d = len(region.low)
    sides = region.high - region.low
    edge = float(np.prod(sides) * COARSE / max(budget, COARSE)) ** (1.0 / d)
    shape = np.maximum(np.round(sides / edge), 1).astype(np.int64)
    cells = np.stack(np.meshgrid(*map(np.arange, shape), indexing="ij"), axis=-1).reshape(-1, d).astype(np.int64)
    final, on_the_way = int(CHECKS * budget) if tests is None else 0, int(0.5 * CHECKS * budget)
    left = budget - final - on_the_way
    settled: list[tuple[Array, Array, Flags]] = []
    used = level = 0
    while True:
        low, high = _corners(region, cells, shape)
        rng = np.random.default_rng((seed, level, 0xCE11))
        value = ask(region.drawn(low, high, rng))
        pairs = list(_pairs(cells, shape))
        differ = _disagree(value, pairs) | (value & _at_edge(cells, shape, region.radial))
        open_ = _spread(differ, pairs)
        # Some of the settled cells are looked at once more: a feature smaller than they are may be found.
        calm = np.flatnonzero(~open_)
        tested = rng.permutation(calm)[: min(len(calm), max(on_the_way // 2, 1))]
        found = tested[ask(region.drawn(low[tested], high[tested], rng)) != value[tested]]
        on_the_way -= len(tested)
        marked = np.zeros(len(cells), dtype=bool)
        marked[found] = True
        open_ |= _spread(marked, pairs)
        left -= len(cells)
        used += len(cells) + len(tested)
        settled.append((low[~open_], high[~open_], value[~open_]))
        cells = cells[open_]
        # A further level costs its own points and, at its end, two for each cell that is open still.
        if not len(cells) or 3 * len(cells) << d > left or np.max(shape) > 1 << 20:
            break
        cells, shape, level = _split(cells), 2 * shape, level + 1
    low, high = _corners(region, cells, shape)
    rng = np.random.default_rng((seed, level, 0xED6E))
    each = min(max(2, left // max(len(cells), 1)), 4 << d)
    hits = np.zeros(len(cells))
    for _ in range(each):
        hits += ask(region.drawn(low, high, rng))
    if tests is None:
        tests = final + max(on_the_way, 0) + max(left - each * len(cells), 0)
    inner, slack = _sum_with_bound(hits, each, region.sizes(low, high))
    calm_low, calm_high, values = (np.concatenate(parts) for parts in zip(*settled, strict=True))
    weights = region.sizes(calm_low, calm_high)
    missed, doubt = _checked(prove, region, calm_low, calm_high, values, weights, tests, rng)
    used += each * len(cells) + tests * bool(len(weights))
    size = max(float(np.sum(weights[values])) + inner + missed, 0.0)
    measure = Measure(size, slack + doubt, METHOD, used)
    fraction = np.concatenate([values.astype(np.float64), hits / max(each, 1)])
    corners = np.concatenate([calm_low, low]), np.concatenate([calm_high, high])
    return measure, Cells(region, *corners, fraction, np.repeat([True, False], [len(values), len(cells)]), missed)


def answers(inside: Oracle, region: Region, cores: int | None, u: Array) -> Flags:
    """Whether points u: (m, d) are in the set."""
    if not len(u):
        return np.zeros(0, dtype=bool)
    points = region.points(u)
    least = getattr(inside, "least", LEAST)  # an oracle may say how many it works best on
    size = min(CHUNK, max(least, -(-len(points) // PARTS)))
    blocks = [points[start : start + size] for start in range(0, len(points), size)]
    return np.concatenate([np.asarray(part, dtype=bool) for part in in_order(inside, blocks, cores)])


def _corners(region: Region, cells: Whole, shape: Whole) -> tuple[Array, Array]:
    """Corners (c, d) of the cells with numbers `cells` (c, d) of a grid of `shape` cells: neighbours' are the same."""
    step = (region.high - region.low) / shape
    return region.low + cells * step, region.low + (cells + 1) * step


def _split(cells: Whole) -> Whole:
    """The 2^d parts of each cell."""
    parts = np.array(list(product((0, 1), repeat=cells.shape[1])), dtype=np.int64)
    return (2 * cells[:, None, :] + parts).reshape(-1, cells.shape[1])


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


def _disagree(value: Flags, pairs: list[tuple[Whole, Whole]]) -> Flags:
    """Which cells have a neighbour of another value."""
    marked = np.zeros(len(value), dtype=bool)
    for a, b in pairs:
        differ = value[a] != value[b]
        marked[a[differ]] = True
        marked[b[differ]] = True
    return marked


def _at_edge(cells: Whole, shape: Whole, radial: bool) -> Flags:
    """Which cells lie at the region's edge, beyond which nothing is of the set; an axis of symmetry is none."""
    first, last = cells == 0, cells == shape - 1
    if radial:
        first[:, 0] = False
    return np.asarray(np.any(first | last, axis=1))


def _spread(marked: Flags, pairs: list[tuple[Whole, Whole]]) -> Flags:
    """The marked cells and their neighbours."""
    wider = marked.copy()
    if marked.any():
        for a, b in pairs:
            wider[a[marked[b]]] = True
            wider[b[marked[a]]] = True
    return wider


def _sum_with_bound(hits: Array, each: int, sizes: Array) -> tuple[float, float]:
    """Σ size · hits / each, and a bound of its error that holds but for a chance of RISK."""
    if not len(hits):
        return 0.0, 0.0
    part = hits / each
    hoeffding = sqrt(log(2.0 / RISK) * float(np.sum(sizes**2)) / (2.0 * each))
    variance = float(np.sum(sizes**2 * part * (1.0 - part))) / (each - 1)
    if np.sum((hits > 0) & (hits < each)) >= MANY:
        return float(np.sum(sizes * part)), min(hoeffding, NORMAL * sqrt(variance))
    tail = log(4.0 / RISK)
    bernstein = sqrt(2.0 * variance * tail) + 7.0 / 3.0 * tail * float(np.max(sizes)) / each
    return float(np.sum(sizes * part)), min(hoeffding, bernstein)


def _checked(
    ask: Oracle,
    region: Region,
    low: Array,
    high: Array,
    values: Flags,
    sizes: Array,
    checks: int,
    rng: np.random.Generator,
) -> tuple[float, float]:
    """What settled cells have too little, by `checks` fresh points all over them, and the bound of its error."""
    whole = float(np.sum(sizes))
    if not len(sizes) or not checks:
        return 0.0, whole
    u, chosen = points_in(region, low, high, checks, rng)
    found = ask(u)
    more, less = int(np.sum(found & ~values[chosen])), int(np.sum(~found & values[chosen]))
    bound = poisson_limit(more + less, RISK) - (more + less)
    return whole * (more - less) / checks, whole * bound / checks


def points_in(
    region: Region, low: Array, high: Array, count: int, rng: np.random.Generator
) -> tuple[Array, NDArray[np.intp]]:
    """Points u: (count, d) all over some cells, uniform in the world, and the cell (count,) of each."""
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
