"""The boundary of a plane set that is known by asking which points are in it.

Marching squares (W. Lorensen and H. Cline, "Marching cubes", SIGGRAPH 1987, in the plane) on a grid of points; where
the boundary crosses a side of the grid, and halfway between two crossings, it is found by bisection, so that the
curve is smooth at any size. What is narrower than a cell of the grid may be missed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array, Flags, Whole

Oracle = Callable[[Array], Flags]

CELLS = 160
"""Cells of the grid along the longer side: half a millimetre of a picture of a page's width."""

HALVINGS = 10
"""Bisections of a grid's side: the crossing is found to a thousandth of a cell, far below a line's width."""


@dataclass(frozen=True, eq=False)
class Outline:
    """A plane set by its boundary.

    loops: closed curves, each (k, 2) [m] with the set on its left: round the outside anticlockwise, round a
    hole clockwise. cell: the grid's step [m].
    """

    loops: tuple[Array, ...]
    cell: float

    @property
    def area(self) -> float:
        """Area [m²] within the curves."""
        return float(sum(signed_area(loop) for loop in self.loops))

    @property
    def pieces(self) -> int:
        """Separate parts of the set."""
        return sum(signed_area(loop) > 0.0 for loop in self.loops)

    @property
    def holes(self) -> tuple[Array, ...]:
        """The curves round what is missing within."""
        return tuple(loop for loop in self.loops if signed_area(loop) < 0.0)


def signed_area(loop: Array) -> float:
    """Area [m²] within a closed curve (k, 2) [m], negative if it is clockwise."""
    x, y = loop.T
    return float(0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))


def trace(
    inside: Oracle,
    low: Array,
    high: Array,
    cells: int = CELLS,
    halvings: int = HALVINGS,
) -> Outline:
    """The outline of the set of points (m, 2) [m] for which `inside` is true, within the box low, high (2,) [m]."""
    cell = float(np.max(high - low)) / cells
    counts = np.maximum(np.ceil((high - low) / cell - 1e-9).astype(int), 1) + 3
    # A ring of cells about the box, so that a set that fills it has its boundary on the grid.
    first = 0.5 * (low + high) - 0.5 * (counts - 1) * cell
    x, y = (first[i] + cell * np.arange(counts[i]) for i in range(2))
    points = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)
    mask = np.zeros(tuple(counts), dtype=bool)
    mask[1:-1, 1:-1] = inside(points[1:-1, 1:-1].reshape(-1, 2)).reshape(tuple(counts - 2))
    if not mask.any():
        return Outline((), cell)
    starts, ends = _segments(inside, points, mask)
    sides, place = np.unique(np.concatenate([starts, ends]), return_inverse=True)
    crossings = _crossings(inside, points, mask, sides, halvings)
    following = np.empty(len(sides), dtype=int)
    following[place[: len(starts)]] = place[len(starts) :]
    middles = _middles(inside, crossings, crossings[following], cell, halvings)
    return Outline(tuple(_loops(crossings, middles, following)), cell)


# The sides of the grid are numbered: 2 v is the side from point v along the first axis, 2 v + 1 along the second.


def _segments(inside: Oracle, points: Array, mask: Flags) -> tuple[Whole, Whole]:
    """The numbers of the sides between which the boundary runs, the set on the left: starts (s,), ends (s,)."""
    rows, columns = mask.shape
    v = np.arange(rows * columns).reshape(rows, columns)
    corner = v[:-1, :-1]
    # Corners and sides anticlockwise from the lower left corner; side k leads from corner k to the next.
    corners = np.stack([mask[:-1, :-1], mask[1:, :-1], mask[1:, 1:], mask[:-1, 1:]])
    sides = np.stack([2 * corner, 2 * v[1:, :-1] + 1, 2 * v[:-1, 1:], 2 * corner + 1])
    leaves = corners & ~np.roll(corners, -1, axis=0)
    enters = ~corners & np.roll(corners, -1, axis=0)
    saddle = np.sum(leaves, axis=0) == 2
    simple = (np.sum(leaves, axis=0) == 1)[None]
    starts = [sides.transpose(1, 2, 0)[(leaves & simple).transpose(1, 2, 0)]]
    ends = [sides.transpose(1, 2, 0)[(enters & simple).transpose(1, 2, 0)]]
    i, j = np.nonzero(saddle)
    if len(i):
        joined = inside(0.5 * (points[i, j] + points[i + 1, j + 1]))
        for k in range(4):
            at = leaves[k, i, j]
            starts.append(sides[k, i[at], j[at]])
            ends.append(np.where(joined, sides[(k + 1) % 4, i, j], sides[(k - 1) % 4, i, j])[at])
    return np.concatenate(starts), np.concatenate(ends)


def _crossings(inside: Oracle, points: Array, mask: Flags, sides: Whole, halvings: int) -> Array:
    """Where the boundary crosses sides of the grid: (s, 2)."""
    columns = mask.shape[1]
    i, j = np.divmod(sides // 2, columns)
    k, m = i + (sides % 2 == 0), j + sides % 2
    begins_inside = mask[i, j]
    within = np.where(begins_inside[:, None], points[i, j], points[k, m])
    without = np.where(begins_inside[:, None], points[k, m], points[i, j])
    return _bisect(inside, within, without, halvings)


def _bisect(inside: Oracle, within: Array, without: Array, halvings: int) -> Array:
    """The boundary between points inside and points outside (s, 2)."""
    for _ in range(halvings):
        middle = 0.5 * (within + without)
        at = inside(middle)[:, None]
        within, without = np.where(at, middle, within), np.where(at, without, middle)
    return 0.5 * (within + without)


def _middles(inside: Oracle, a: Array, b: Array, cell: float, halvings: int) -> Array:
    """Points of the boundary near the middles of segments a to b (s, 2): it bulges or has a corner there."""
    middle, along = 0.5 * (a + b), b - a
    length = np.maximum(np.linalg.norm(along, axis=1), 1e-9 * cell)
    # Half of a segment either way holds a right-angled corner that the segment cuts off.
    left = np.stack([-along[:, 1], along[:, 0]], axis=1) * (0.55 * np.minimum(length, cell) / length)[:, None]
    within, without = middle + left, middle - left
    good = inside(within) & ~inside(without)
    found = middle.copy()
    if np.any(good):
        found[good] = _bisect(inside, within[good], without[good], halvings)
    return found


def _loops(crossings: Array, middles: Array, following: Whole) -> list[Array]:
    left = np.ones(len(following), dtype=bool)
    order = following.tolist()
    loops = []
    for first in range(len(order)):
        if not left[first]:
            continue
        ring, at = [], first
        while left[at]:
            left[at] = False
            ring.append(at)
            at = order[at]
        pairs = np.stack([crossings[ring], middles[ring]], axis=1)
        loops.append(pairs.reshape(-1, 2))
    return loops
