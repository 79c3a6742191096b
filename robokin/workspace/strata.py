"""The integral of a function of two variables that jumps along curves, with a bound of the error that is honest.

A rectangle's values at its corners and its middle tell what lies between them, by linear interpolation in the four
triangles from the middle to the sides. Where the middle contradicts the corners the rectangle is split into four, the
worst ones first, so that small ones gather at the curves. Then each rectangle's interpolation is integrated, and fresh
points at random, two in each, correct what it misses: whatever the function looks like the sum has no bias, and the
two points' difference tells the sum's variance (stratified sampling with a control variate: W. G. Cochran, Sampling
Techniques, 3rd ed. 1977, chapters 5 and 7). The bound is that of Student's t, whose degrees of freedom are those of
F. E. Satterthwaite, Biometrics Bulletin 2, 1946: few rectangles with most of the variance tell it badly.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from robokin.arrays import Array, Flags, Index, Whole

Function = Callable[[Array], Array]

COARSE, HALF = 16, 2
"""One in COARSE of the values goes to the first rectangles, and one in HALF to all before the random points."""

MOST_KNOWN = 1 << 21
"""Values that are kept at most, whatever the budget: some 300 MB. What is left goes to further random points."""

DEPTH = 20
"""Times that a rectangle can be split."""

MOST_SIDES = 1 << 10
"""First rectangles along a side at most: with DEPTH a corner's number has 31 bits along each side."""

ROUNDS = 4
"""A round of splitting takes one in so many of the values that are left: the worst come first, many at a time."""

LEAST_ROUND = 512
"""And a rectangle for so many of all values at least."""

TREMBLE = 0.25
"""The lines between the first rectangles are moved at random by this part of their distance: a jump is then hardly
ever on one of them, where it could not be seen at the corners."""

SIDES = 7
"""About how many new values the four parts of a rectangle need: their middles, and the middles of its sides, which some
neighbours have as well."""

MARGIN = 1.2
"""The bound is so much wider: two points in a rectangle that a jump passes are not normally distributed."""

# Student's t for 99 % on both sides, by the degrees of freedom.
_FREEDOM = (1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 15.0, 20.0, 30.0, 60.0, 120.0, np.inf)
_STUDENT = (63.657, 9.925, 5.841, 4.604, 4.032, 3.707, 3.355, 3.169, 2.947, 2.845, 2.750, 2.660, 2.617, 2.576)


@dataclass(frozen=True)
class Integral:
    """A value, the bound of its error with 99 % confidence, and how many values of the function were looked at.

    greatest: the greatest value that was found in the middle of a rectangle.
    """

    value: float
    error: float
    evaluations: int
    greatest: float


class _Known:
    """Values of the function at corners, by their numbers along both sides."""

    def __init__(self, f: Function, lines: tuple[Array, Array]) -> None:
        self.f, self.lines, self.count = f, lines, 0
        self.keys, self.values = np.zeros(0, dtype=np.int64), np.zeros(0)

    def at(self, x: Whole, y: Whole) -> Array:
        """Coordinates (2, m) of numbers x, y (m,)."""
        pairs = zip((x, y), self.lines, strict=True)
        return np.stack([np.interp(part / 2.0**DEPTH, np.arange(len(lines)), lines) for part, lines in pairs])

    def numbers(self, points: Array) -> tuple[Whole, Whole]:
        """Numbers (k,), (k,) of points (2, k)."""
        found = []
        for part, lines in zip(points, self.lines, strict=True):
            number = np.interp(part, lines, np.arange(len(lines))) * 2.0**DEPTH
            found.append(np.clip(number, 0, ((len(lines) - 1) << DEPTH) - 1).astype(np.int64))
        return found[0], found[1]

    def __call__(self, x: Whole, y: Whole) -> Array:
        """Values at numbers x, y, of any shape, each point being looked at once."""
        keys, place = np.unique((x.astype(np.int64) << 31) | y, return_inverse=True)
        there = np.minimum(np.searchsorted(self.keys, keys), max(len(self.keys) - 1, 0))
        new = self.keys[there] != keys if len(self.keys) else np.ones(len(keys), dtype=bool)
        values = np.empty(len(keys))
        if len(self.keys):
            values[~new] = self.values[there[~new]]
        if new.any():
            fresh = keys[new]
            values[new] = self.f(self.at(fresh >> 31, fresh & ((1 << 31) - 1)))
            self.count += len(fresh)
            order = np.argsort(np.concatenate([self.keys, fresh]), kind="stable")
            self.keys = np.concatenate([self.keys, fresh])[order]
            self.values = np.concatenate([self.values, values[new]])[order]
        return np.asarray(values[place].reshape(x.shape))


@dataclass(eq=False)
class _Cells:
    """Rectangles: x, y (c,) the numbers of their lower corners, side (c,) in the same numbers; corner (c, 4) the values
    at the corners, in the order of (0, 0), (0, 1), (1, 0), (1, 1), and middle (c,); pressed (c,): how far a small
    neighbour's middle is from its corners."""

    x: Whole
    y: Whole
    side: Whole
    corner: Array
    middle: Array
    pressed: Array
    PARTS: ClassVar = ("x", "y", "side", "corner", "middle", "pressed")

    @property
    def off(self) -> Array:
        """(c,) how far the middle is from the corners' mean."""
        return np.asarray(np.abs(self.middle - np.mean(self.corner, axis=1)))

    def taken(self, which: Flags) -> _Cells:
        return _Cells(*(getattr(self, name)[which] for name in self.PARTS))

    def joined(self, other: _Cells) -> _Cells:
        parts = ((getattr(self, name), getattr(other, name)) for name in self.PARTS)
        return _Cells(*(np.concatenate(pair) for pair in parts))

    def box(self, known: _Known) -> tuple[Array, Array]:
        """Lower corners (2, c) and sides (2, c)."""
        low = known.at(self.x, self.y)
        return low, known.at(self.x + self.side, self.y + self.side) - low


def _cells(known: _Known, x: Whole, y: Whole, side: Whole) -> _Cells:
    across = np.array([0, 0, 1, 1]), np.array([0, 1, 0, 1])
    half = side // 2
    all_x = np.concatenate([x[:, None] + side[:, None] * across[0], (x + half)[:, None]], axis=1)
    all_y = np.concatenate([y[:, None] + side[:, None] * across[1], (y + half)[:, None]], axis=1)
    values = known(all_x, all_y)
    return _Cells(x, y, side, values[:, :4], values[:, 4], np.zeros(len(x)))


def stratified(f: Function, low: Array, high: Array, most: int, seed: int, marks: Array | None = None) -> Integral:
    """∫ f over the rectangle from low (2,) to high (2,).

    f: (2, m) -> (m,), never negative. most: how many values may be looked at, but for some that are needed at least.
    marks (2, k): points through which the curves go that f may jump along, as far as they are known.
    """
    rng = np.random.default_rng((seed, 0x57A7))
    known, cells = _first(f, low, high, most, rng)
    numbers = known.numbers(np.zeros((2, 0)) if marks is None else marks)
    while True:
        left = min(most // HALF, MOST_KNOWN) - known.count
        count = min(max(left // (ROUNDS * SIDES), most // LEAST_ROUND), left // SIDES)
        if count < 1:
            break
        doubt = np.where(cells.side > 2, _doubt(known, cells, numbers), 0.0)
        order = np.argsort(-doubt, kind="stable")[:count]
        order = order[doubt[order] > 0.0]
        if not len(order):
            break
        kept = np.ones(len(cells.x), dtype=bool)
        kept[order] = False
        half = cells.side[order] // 2
        x = (cells.x[order][:, None] + half[:, None] * np.array([0, 0, 1, 1])).ravel()
        y = (cells.y[order][:, None] + half[:, None] * np.array([0, 1, 0, 1])).ravel()
        new = _cells(known, x, y, np.repeat(half, 4))
        cells = cells.taken(kept).joined(new)
        _press(cells, new)
    return _summed(f, known, cells, most, rng)


def _first(f: Function, low: Array, high: Array, most: int, rng: np.random.Generator) -> tuple[_Known, _Cells]:
    """The first rectangles, as many along each side."""
    count = int(min(max(np.sqrt(most / (2.0 * COARSE)), 1.0), MOST_SIDES))
    lines = []
    for a, b in zip(low, high, strict=True):
        moved = np.arange(count + 1) + TREMBLE * rng.uniform(-1.0, 1.0, count + 1)
        moved[[0, -1]] = 0.0, count
        lines.append(a + (b - a) / count * moved)
        lines[-1][-1] = b
    known = _Known(f, (lines[0], lines[1]))
    x, y = (grid.ravel() << DEPTH for grid in np.meshgrid(*2 * [np.arange(count)], indexing="ij"))
    return known, _cells(known, x, y, np.full(len(x), 1 << DEPTH))


def _doubt(known: _Known, cells: _Cells, marks: tuple[Whole, Whole]) -> Array:
    """(c,) how much of the integral may be wrong in each cell."""
    off = np.maximum(cells.off, cells.pressed)
    marked, _ = _holding(cells, *marks)
    off[marked] = np.maximum(off[marked], 0.25 * cells.middle[marked])
    return np.asarray(off * np.prod(cells.box(known)[1], axis=0))


def _press(cells: _Cells, new: _Cells) -> None:
    """A curve through new cells goes on in their neighbours: much larger ones are to be looked into."""
    half = new.side // 2
    for x, y in ((-1, half), (new.side, half), (half, -1), (half, new.side)):
        which, place = _holding(cells, new.x + x, new.y + y)
        wide = cells.side[which] >= 4 * new.side[place]
        np.maximum.at(cells.pressed, which[wide], new.off[place[wide]])


def _holding(cells: _Cells, x: Whole, y: Whole) -> tuple[Index, Index]:
    """Which cells hold points of numbers x, y (k,), and which of the points."""
    found, places = [np.zeros(0, dtype=np.intp)], [np.zeros(0, dtype=np.intp)]
    for side in np.unique(cells.side):
        which = np.flatnonzero(cells.side == side)
        keys = (cells.x[which] << 31) | cells.y[which]
        order = np.argsort(keys)
        wanted = ((x // side * side) << 31) | (y // side * side)
        place = order[np.minimum(np.searchsorted(keys, wanted, sorter=order), len(keys) - 1)]
        there = np.flatnonzero((keys[place] == wanted) & (x >= 0) & (y >= 0))
        found.append(which[place[there]])
        places.append(there)
    return np.concatenate(found), np.concatenate(places)


def _summed(f: Function, known: _Known, cells: _Cells, most: int, rng: np.random.Generator) -> Integral:
    """The interpolation's integral, corrected by two points at random in each cell, or as many times two as may be."""
    low, sides = cells.box(known)
    area = np.prod(sides, axis=0)
    guess = float(area @ (2.0 * np.mean(cells.corner, axis=1) + cells.middle)) / 3.0
    times = max((most - known.count) // (2 * len(area)), 1)
    missed, off = 0.0, np.zeros(len(area))
    for _ in range(times):
        pair = []
        for _ in range(2):
            part = rng.random(low.shape)
            pair.append(area * (f(low + part * sides) - _between(cells, part)))
        missed += 0.5 * float(np.sum(pair[0] + pair[1])) / times
        off += (0.5 / times * (pair[0] - pair[1])) ** 2
    variance = float(np.sum(off))
    freedom = variance**2 / float(np.sum(off * off)) if variance > 0.0 else np.inf
    student = float(np.interp(-1.0 / freedom, -1.0 / np.array(_FREEDOM), _STUDENT))
    bound = MARGIN * student * float(np.sqrt(variance))
    return Integral(max(guess + missed, 0.0), bound, known.count + 2 * times * len(area), float(np.max(cells.middle)))


def _between(cells: _Cells, part: Array) -> Array:
    """(c,) the interpolation at a point of each cell, at parts (2, c) of its sides."""
    away = 2.0 * part - 1.0
    r = np.maximum(np.max(np.abs(away), axis=0), 1e-300)
    x, y = 0.5 + 0.5 * away / r
    a, b, c, d = cells.corner.T
    edge = (1.0 - x) * ((1.0 - y) * a + y * b) + x * ((1.0 - y) * c + y * d)
    return np.asarray((1.0 - r) * cells.middle + r * edge)
