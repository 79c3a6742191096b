"""Sets of values that linear inequalities G u <= h cut out of space: shadows, hulls, and points spread over them.

Statement. The values of some variables for which others exist that satisfy G u <= h form such a set again.
Derivation. A variable is taken out by adding each inequality that bounds it from above to each that bounds it from
below, scaled so that it cancels (J. Fourier; A. Schrijver, Theory of Linear and Integer Programming, 1986, section
12.2). What is left when all but one are out is the hull of that one; the ranges that one variable after another has,
given those before, lead from the unit box onto the whole set.
Degenerate case. An inequality without variables and with h < 0 says that there is nothing; what lacks less than
rounding may make is taken for something.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array, Flags
from robokin.brief import Brief

ROUNDING = 1e-12
"""What an inequality may lack and yet hold, its greatest coefficient being 1 [rad | m]."""


@dataclass(frozen=True, eq=False, repr=False)
class HalfSpaces(Brief):
    """G u <= h of variables u: G (c, n) with greatest coefficients of 1 (or 0), h (c,)."""

    G: Array
    h: Array

    @classmethod
    def of(cls, G: Array, h: Array) -> HalfSpaces:
        """Inequalities with any coefficients; those that bound nothing are left out, and of alike ones all but the
        tightest."""
        scale = np.max(np.abs(G), axis=1, initial=0.0)
        scale = np.where(scale > 0.0, scale, 1.0)
        G, h = G / scale[:, None], h / scale
        keep = np.isfinite(h)
        G, h = G[keep], h[keep]
        if not len(h):
            return cls(G, h)
        order = np.lexsort((h, *np.round(G, 12).T))
        G, h = G[order], h[order]
        new = np.ones(len(h), dtype=bool)
        new[1:] = np.any(np.round(G[1:], 12) != np.round(G[:-1], 12), axis=1)
        return cls(G[new], h[new])

    @classmethod
    def box(cls, low: Array, high: Array) -> HalfSpaces:
        """low <= u <= high, (n,), either of which may be infinite."""
        unit = np.eye(len(low))
        return cls.of(np.concatenate([unit, -unit]), np.concatenate([high, -low]))

    def joined(self, other: HalfSpaces) -> HalfSpaces:
        """What satisfies both."""
        return HalfSpaces.of(np.concatenate([self.G, other.G]), np.concatenate([self.h, other.h]))

    @property
    def linked(self) -> Flags:
        """(n,) which variables any of them mentions."""
        return np.asarray(np.any(self.G != 0.0, axis=0))

    @property
    def empty(self) -> bool:
        """Whether one of them says that there is nothing, by itself."""
        return bool(np.any(~np.any(self.G != 0.0, axis=1) & (self.h < -ROUNDING)))

    def contains(self, u: Array) -> Flags:
        """(k,) whether values u (n, k) satisfy them."""
        return np.asarray(np.all(self.G @ u <= self.h[:, None] + ROUNDING, axis=0))

    def without(self, j: int) -> HalfSpaces:
        """The shadow along variable j, which stays in place and is mentioned no more."""
        column = self.G[:, j]
        up, down = np.flatnonzero(column > 0.0), np.flatnonzero(column < 0.0)
        rest = column == 0.0
        above = np.column_stack([self.G[up], self.h[up]]) / column[up, None]
        below = np.column_stack([self.G[down], self.h[down]]) / -column[down, None]
        both = (above[:, None] + below[None, :]).reshape(-1, len(self.G[0]) + 1) if len(up) and len(down) else above[:0]
        both[:, j] = 0.0
        both[np.abs(both) < 1e-15] = 0.0
        return HalfSpaces.of(np.concatenate([self.G[rest], both[:, :-1]]), np.concatenate([self.h[rest], both[:, -1]]))

    def shadow(self, kept: Sequence[int]) -> HalfSpaces:
        """The shadow on the variables `kept`: no others are mentioned."""
        left = self
        for j in range(self.G.shape[1]):
            if j not in kept:
                left = left.without(j)
        return left

    def at(self, j: int, value: float) -> HalfSpaces:
        """Those of the others where variable j has a value; it is mentioned no more."""
        G = self.G.copy()
        G[:, j] = 0.0
        return HalfSpaces.of(G, self.h - self.G[:, j] * value)

    def ranges(self, j: int, u: Array) -> tuple[Array, Array]:
        """The least and the greatest value (k,) of variable j, the others being u (n, k)."""
        column = self.G[:, j]
        rest = self.h[:, None] - np.delete(self.G, j, axis=1) @ np.delete(u, j, axis=0)
        low, high = np.full(u.shape[1], -np.inf), np.full(u.shape[1], np.inf)
        if np.any(column > 0.0):
            high = np.min(rest[column > 0.0] / column[column > 0.0, None], axis=0)
        if np.any(column < 0.0):
            low = np.max(rest[column < 0.0] / column[column < 0.0, None], axis=0)
        return low, high

    def hull(self, low: Array, high: Array) -> tuple[Array, Array]:
        """The box (n,), (n,) that holds what is left of a box; its ends are the wrong way round where nothing is."""
        whole = self.joined(HalfSpaces.box(low, high))
        low, high = low.copy(), high.copy()
        for j in np.flatnonzero(self.linked).tolist():
            one = whole.shadow([j])
            least, greatest = one.ranges(j, np.zeros((len(low), 1)))
            low[j], high[j] = (np.inf, -np.inf) if one.empty else (float(least[0]), float(greatest[0]))
        return low, high

    def cutting(self, low: Array, high: Array) -> HalfSpaces:
        """Those that take something off a box (n,), (n,)."""
        with np.errstate(invalid="ignore"):
            ends = np.where(self.G > 0.0, self.G * high, self.G * low)
        most = np.sum(np.where(self.G == 0.0, 0.0, ends), axis=1)
        keep = ~(most <= self.h + ROUNDING)
        return HalfSpaces(self.G[keep], self.h[keep])

    def filled(self, u: Array, low: Array, high: Array) -> Array:
        """Values (n, k) within these and a box, one for each point u (n, k) of the unit box: each variable that they
        mention is put into the range that those before it leave."""
        whole = self.joined(HalfSpaces.box(low, high))
        linked = np.flatnonzero(self.linked).tolist()
        q = low[:, None] + (high - low)[:, None] * u
        shadows = [whole] if linked else []
        for j in linked[:0:-1]:
            shadows.append(shadows[-1].without(j))
        for j, shadow in zip(linked, reversed(shadows), strict=True):
            least, greatest = shadow.ranges(j, np.where(np.arange(len(q))[:, None] < j, q, 0.0))
            q[j] = least + (greatest - least) * u[j]
        return q
