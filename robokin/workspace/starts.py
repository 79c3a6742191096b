"""Sampled configurations kept by where they put the tool's origin: a start near any point that is asked about.

The first moving joint only turns or shifts all that follows. So what is kept is where the others put the
origin seen from it: distance from its axis and height along it, or the plane across its slide. That makes a
thin set of samples a dense one, and the value of the first joint follows from the point.
"""

from __future__ import annotations

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.jobs.sequences import unit_points
from robokin.kernel.chain import Chain
from robokin.kernel.geometric_jacobian import motion
from robokin.spatial.angles import TURN

KEPT = 1 << 15
"""Sampled configurations."""

EACH = 14
"""Samples in a cell of the table's square, of which a set fills a part."""

BEYOND = 0.15
"""Part of its range by which a joint's sample may pass each limit, to be put back to it: much of a set's boundary
is reached with joints at their limits, which samples of the inside never are."""

ALONE = 2
"""Cells between a point and the nearest cell with a sample from which on the point is out of reach: a cell that can
be reached has ten samples on average, and half of all lie on limits, where boundaries are."""

LOOKED_AT = 12
"""Samples of a cell among which the best is chosen."""

THIN = 1e-6
"""Least side of a table, as a part of how far from the axis it lies: what the first joint leaves alone may be one
point, of which samples differ by rounding."""


class Starts:
    """A table of configurations, `kept` sampled ones and `more` (n, k), by cells of what the first joint leaves alone.

    low, high: (n,) the box [rad | m] that is sampled: of a face of the joint box one of them has one value.
    """

    def __init__(self, chain: Chain, low: Array, high: Array, more: Array | None = None, kept: int = KEPT) -> None:
        self.turns = bool(chain.revolute[0])
        self.low, self.high = low, high
        n = len(low)
        more = np.zeros((n, 0)) if more is None else more
        u = unit_points("sobol", n, 0, 0, kept, kept) if kept else np.zeros((n, 0))
        # Every other sample may come to lie on limits.
        u[:, ::2] = np.clip((1.0 + 2.0 * BEYOND) * u[:, ::2] - BEYOND, 0.0, 1.0)
        q = low[:, None] + (high - low)[:, None] * u
        q = np.concatenate([q, more], axis=1)
        q[0] = 0.5 * (low[0] + high[0])
        p = motion(chain, q).tool[3]
        # The first axis is the same at every configuration.
        self.foot, self.frame = _axis(chain)
        seen, value = self._seen(p)
        self.offset = value - q[0]
        self.q, self.seen = q, seen
        self.corner = seen.min(axis=1)
        spread = max(float(np.max(seen.max(axis=1) - self.corner)), THIN * float(np.max(np.abs(seen)))) or 1.0
        self.step = spread / np.sqrt((kept or more.shape[1]) / EACH) * (1.0 + 1e-9)
        self.shape = np.maximum(np.ceil((seen.max(axis=1) - self.corner) / self.step), 1).astype(np.intp)
        cells = self._cell(seen)
        self.order = np.argsort(cells, kind="stable")
        count = np.bincount(cells, minlength=int(np.prod(self.shape)))
        first = np.cumsum(count) - count
        occupied = count.reshape(self.shape) > 0
        self.far = ~_grown(occupied, ALONE).reshape(-1)
        nearest = _nearest_occupied(occupied).reshape(-1)
        self.first, self.count = first[nearest], count[nearest]

    def near(self, points: Array, near: int, far: int) -> Array:
        """Starts (near + far, n, m) for points (3, m) [m]: some from the point's cell, the most promising first, and
        some from anywhere, so that not all stand before the same barrier."""
        seen, value = self._seen(points)
        cells = self._cell(seen)
        first, kept = self.first[cells], self.count[cells]
        picked = self.order[first + np.arange(LOOKED_AT)[:, None] % kept]
        off = np.sum((self.seen[:, picked] - seen[:, None, :]) ** 2, axis=0)
        lacking = self._within(value - self.offset[picked])[1]
        off += (lacking * (seen[0] if self.turns else 1.0)) ** 2
        rank = np.argsort(off, axis=0, kind="stable")[:near]
        # Which of all is for a point to decide, so that its answer does not depend on the others asked about.
        scattered = (np.arange(1, far + 1)[:, None] * 0.6180339887498949 + np.sum(seen, axis=0) / self.step) % 1.0
        anywhere = (scattered * len(self.order)).astype(np.intp)
        chosen = np.concatenate([np.take_along_axis(picked, rank, axis=0), anywhere])
        starts = self.q[:, chosen].transpose(1, 0, 2).copy()
        starts[:, 0] = self._within(value - self.offset[chosen])[0]
        return starts

    def beyond(self, points: Array) -> Flags:
        """(m,) whether points (3, m) [m] lie so far from every sample that none can be reached."""
        seen, _ = self._seen(points)
        outside = np.any((seen < self.corner[:, None] - ALONE * self.step), axis=0)
        outside |= np.any(seen > self.corner[:, None] + (np.array(self.shape)[:, None] + ALONE) * self.step, axis=0)
        return np.asarray(outside | self.far[self._cell(seen)])

    def _within(self, joint: Array) -> tuple[Array, Array]:
        """Values of the first joint brought into its limits, and how far outside they were."""
        low, high = self.low[0], self.high[0]
        if self.turns:
            middle = 0.5 * (low + high)
            joint = joint - TURN * np.round((joint - middle) / TURN)
        inside = np.clip(joint, low, high)
        return inside, np.abs(joint - inside)

    def _seen(self, p: Array) -> tuple[Array, Array]:
        """What the first joint leaves alone of points (3, m), (2, m) [m], and what it changes, (m,) [rad | m]."""
        x, y, z = self.frame.T @ (p - self.foot[:, None])
        if self.turns:
            return np.stack([np.hypot(x, y), z]), np.arctan2(y, x)
        return np.stack([x, y]), z

    def _cell(self, seen: Array) -> Index:
        # Kept to the table before they become whole numbers: a point may be farther off than these go.
        last = self.shape[:, None] - 1.0
        i, j = np.clip((seen - self.corner[:, None]) / self.step, 0.0, last).astype(np.intp)
        cells: Index = i * self.shape[1] + j
        return cells


def _axis(chain: Chain) -> tuple[Array, Array]:
    """A point of the first joint's axis (3,) and a frame (3, 3) whose z it is; the base and nothing else moves it."""
    constant = chain.constants[0]
    return constant[:3, 3], constant[:3, :3]


def _grown(occupied: Flags, by: int) -> Flags:
    """Cells that are occupied or at most `by` cells from one that is."""
    rows, columns = occupied.shape
    padded = np.pad(occupied, by)
    grown = np.zeros_like(occupied)
    for i in range(2 * by + 1):
        for j in range(2 * by + 1):
            grown |= padded[i : i + rows, j : j + columns]
    return grown


def _nearest_occupied(occupied: Flags) -> Index:
    """For each cell of a table the number of an occupied cell near it, its own if it is occupied."""
    rows, columns = occupied.shape
    number = np.where(occupied, np.arange(rows * columns).reshape(rows, columns), -1)
    while np.any(number < 0):
        padded = np.pad(number, 1, constant_values=-1)
        for di, dj in ((0, 1), (1, 0), (1, 2), (2, 1), (0, 0), (0, 2), (2, 0), (2, 2)):
            beside = padded[di : di + rows, dj : dj + columns]
            number = np.where(number < 0, beside, number)
    return number
