"""What happens to every solver's candidates: proof by forward kinematics, limits, duplicates, order.

Written once and shared by all solvers. Everything works on flat lists: s configurations and, for each, the
index of the target in the block that it is for.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robokin.inverse.loop import Candidates, Loop
from robokin.inverse.newton import refine
from robokin.kinematics.chain import Chain
from robokin.kinematics.columns import BLOCK, Constant, Plan
from robokin.model.robot import LIMIT_TOLERANCE

Array = NDArray[np.float64]
Index = NDArray[np.intp]

CLOSES = 1e-9
"""A solution's greatest residual, in the arm's size and in radians: what is listed closes to this."""

EXACT_ENOUGH = 1e-12
"""Residual above which a candidate gets Newton steps before it is judged; closed forms give 1e-15."""

NEWTON_STEPS = 12
"""Steps of the polish. From 1e-4 two are enough; at double roots each step halves the error."""

SAME = 1e-6
"""Configurations that differ by less in every joint [rad | size] are one. Rounding moves a solution by 1e-9 at
a singular pose at most once it closes; different solutions are rarely nearer than 1e-4 to each other."""

VIRTUAL = 1e-8
"""A virtual joint at less than this [rad | size] stands still: the arm reaches the pose without it."""


@dataclass(frozen=True, eq=False)
class Found:
    """Verified configurations, sorted by target.

    index: (s,); q: (s, n) [rad | m]; position, angle: (s,) residuals [m, rad].
    """

    index: Index
    q: Array
    position: Array
    angle: Array

    def __len__(self) -> int:
        """How many configurations."""
        return len(self.index)

    def pick(self, which: Index | NDArray[np.bool_]) -> Found:
        """Some of them."""
        return Found(self.index[which], self.q[which], self.position[which], self.angle[which])


def nothing(n: int) -> Found:
    """No configuration."""
    return Found(np.empty(0, dtype=np.intp), np.empty((0, n)), np.empty(0), np.empty(0))


class Poses:
    """Forward kinematics of a chain (base, joints, virtual joints, tool) in blocks."""

    def __init__(self, chain: Chain) -> None:
        segments = [[Constant(C, mark=i == chain.n)] for i, C in enumerate(chain.constants)]
        self.plan = Plan(segments, chain.revolute, chain.offsets)

    def __call__(self, q: Array) -> Array:
        """Poses (s, 4, 4) at q (s, n)."""
        out = np.empty((len(q), 1, 4, 4))
        for start in range(0, len(q), BLOCK):
            self.plan.frames(q[start : start + BLOCK], out[start : start + BLOCK])
        return out[:, 0]


def residuals(T: Array, found: Array) -> tuple[Array, Array]:
    """Distances (s,) [m] and angles (s,) [rad] between poses (s, 4, 4).

    The angle comes from the chord |R_a - R_b| = 2 √2 sin(angle / 2), which keeps all digits of small ones.
    """
    difference = T[:, :3] - found[:, :3]
    position = np.sqrt(np.einsum("si,si->s", difference[:, :, 3], difference[:, :, 3]))
    chord = np.sqrt(np.einsum("sij,sij->s", difference[:, :, :3], difference[:, :, :3]))
    return position, 2.0 * np.arcsin(np.minimum(chord / np.sqrt(8.0), 1.0))


def verified(loop: Loop, chain: Chain, poses: Poses, T: Array, closing: Array, candidates: Candidates) -> Found:
    """The candidates that close, after a polish of those that close only nearly.

    T: (m, 4, 4) the targets [m]; closing: (m, 4, 4) the same as the loop's last link.
    """
    index, values = candidates.index, candidates.values
    scale = np.where(chain.revolute, 1.0, loop.size)
    q = values * scale - chain.offsets
    position, angle = residuals(T[index], poses(q))
    rough = (position > EXACT_ENOUGH * loop.size) | (angle > EXACT_ENOUGH)
    if rough.any():
        polished, _, _ = refine(loop, closing, index[rough], values[rough], NEWTON_STEPS)
        q[rough] = polished * scale - chain.offsets
        position[rough], angle[rough] = residuals(T[index[rough]], poses(q[rough]))
    closes = (position <= CLOSES * loop.size) & (angle <= CLOSES)
    return Found(index, q, position, angle).pick(closes)


def wrapped(q: Array, revolute: NDArray[np.bool_]) -> Array:
    """Joint values with every angle in [-π, π]."""
    return np.where(revolute, q - 2.0 * np.pi * np.round(q / (2.0 * np.pi)), q)


def distinct(found: Found, revolute: NDArray[np.bool_], size: float) -> Found:
    """One configuration of each set of equal ones, angles in [-π, π], by target and then by q1, q2, … .

    Of equal ones that with the least residual stays. The order is by q1 to q4 as rounded to a few
    hundredths of a degree (one number holds the four), so that no last digit decides.
    """
    if not len(found):
        return found
    by_target = np.argsort(found.index.astype(np.uint16), kind="stable")  # of 16 bits: counted, not compared
    index, q = found.index[by_target], wrapped(found.q[by_target], revolute)
    first = np.flatnonzero(np.diff(index, prepend=-1))
    counts = np.diff(np.append(first, len(index)))
    most = int(counts.max())
    scaled = q.T / np.where(revolute, np.pi, size)[:, None]
    # Equal configurations have nearly equal sums of |q|, weighted so that different ones hardly ever do: sorted
    # target by target, only where two neighbours agree is looked at closely.
    weights = 1.0 + np.modf(np.arange(1.0, len(scaled) + 1.0) * 0.6180339887498949)[0]
    table = np.full((len(first), most), np.inf)
    filled = np.arange(most) < counts[:, None]
    table[filled] = weights @ np.abs(scaled)
    table.sort(axis=1)
    with np.errstate(invalid="ignore"):
        alike = np.any(np.diff(table, axis=1) < SAME * weights.sum(), axis=1)
    key = np.zeros(len(index))
    for cells, value in zip(KEY_CELLS, scaled, strict=False):
        key = key * cells + np.round((np.clip(value, -1.0, 1.0) + 1.0) * (0.5 * (cells - 1)))
    table[:] = np.inf
    table[filled] = key
    order = (first[:, None] + np.argsort(table, axis=1, kind="stable"))[filled]
    arranged = Found(index, q[order], found.position[by_target][order], found.angle[by_target][order])
    if not alike.any():
        return arranged
    close = np.repeat(alike, counts)
    keep = np.ones(len(index), dtype=bool)
    keep[close] = _first_of_equals(arranged.pick(close), revolute, size)
    return arranged.pick(keep)


KEY_CELLS = (2.0**14, 2.0**13, 2.0**13, 2.0**13)
"""Parts that the ranges of q1 … q4 are cut into for the order; their product is a whole number below 2⁵³."""


def _first_of_equals(found: Found, revolute: NDArray[np.bool_], size: float) -> NDArray[np.bool_]:
    """(s,) which configurations equal none with a lesser residual, found being sorted by target."""
    order = np.lexsort((found.position / size + found.angle, found.index))
    first = np.flatnonzero(np.diff(found.index[order], prepend=-1))
    counts = np.diff(np.append(first, len(order)))
    # Each target's configurations side by side (targets, k, n), missing ones NaN, which equal nothing.
    place = np.arange(len(order)) - np.repeat(first, counts)
    row = np.repeat(np.arange(len(first)), counts)
    table = np.full((len(first), counts.max(), found.q.shape[1]), np.nan)
    table[row, place] = found.q[order] / np.where(revolute, 1.0, size)
    kept = np.ones(table.shape[:2], dtype=bool)
    for j in range(1, table.shape[1]):
        gap = np.abs(table[:, :j] - table[:, j : j + 1])
        gap = np.where(revolute, np.minimum(gap, 2.0 * np.pi - gap), gap)
        kept[:, j] = ~np.any((np.max(gap, axis=2) < SAME) & kept[:, :j], axis=1)
    keep = np.empty(len(order), dtype=bool)
    keep[order] = kept[row, place]
    return keep


def within_limits(
    q: Array, revolute: NDArray[np.bool_], limits: Array, near: Array | None
) -> tuple[Array, NDArray[np.bool_]]:
    """Joint values (s, n), angles in [-π, π], with each turned by ±360° into its limits; whether all are within.

    Among the turns that are within the limits the one nearest to `near` (n,), or to zero, is taken;
    where none is, the angle stays in [-π, π].
    """
    turn = 2.0 * np.pi
    if np.all(np.isinf(limits)) and near is None:
        return q, np.ones(len(q), dtype=bool)
    if near is not None:
        q = np.where(revolute, q + turn * np.round((near - q) / turn), q)
    given = q
    low, high = limits[:, 0] - LIMIT_TOLERANCE, limits[:, 1] + LIMIT_TOLERANCE
    inside = np.ones(len(q), dtype=bool)
    for i in np.flatnonzero(np.isfinite(limits).any(axis=1)):
        column = q[:, i]
        fits = (column >= low[i]) & (column <= high[i])
        beyond = near is not None or low[i] < -np.pi or high[i] > np.pi
        if revolute[i] and beyond and not fits.all():
            # The least and the greatest turn that are within the limits; the nearest to the wish lies between them.
            with np.errstate(invalid="ignore"):
                least, most = np.ceil((low[i] - column) / turn), np.floor((high[i] - column) / turn)
            turned = column + turn * np.where(least <= most, np.clip(0.0, least, most), 0.0)
            fits = (turned >= low[i]) & (turned <= high[i])
            q = q.copy() if q is given else q
            q[:, i] = turned
        inside &= fits
    return q, inside
