"""A self-motion as a function of one place on it, with the joint limits: what arcs and nearest members are found on.

Statement. Give the configuration at any place of a followed curve, its distance from the joint limits, and the places
where a function of the configuration vanishes or is least.
Derivation. A place u is the number of a point and a fraction: the cubic through two neighbouring points with their
tangents, brought back to the pose in the plane at right angles to the tangent, gives the configuration x(u). The margin
is the least distance of a joint from its limits, negative outside. Between two samples x(u) is smooth, and the
polynomial through some exact configurations at Chebyshev's places gives all others to rounding: zeros and least values
are then sought by dividing intervals of polynomials, all at once.
Degenerate case. A function that is the greatest of several has kinks: dividing intervals finds these as well.
Reference: L. N. Trefethen, "Approximation Theory and Approximation Practice", SIAM 2013, chapters 2, 3, 8.

Here x are joint values [rad | size] and lengths are in the arm's size.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from robokin.inverse.curve_tracing import MOVES, Curve
from robokin.inverse.fronts import TURN
from robokin.inverse.null_motion import corrected, scale_of
from robokin.kinematics.chain import Chain
from robokin.model.robot import LIMIT_TOLERANCE

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

PARTS = 8
"""Samples a piece between two points: some 0.02 [rad | size] apart."""

NEARLY = 2e-3
"""Margins [rad | size] below this are made exact: the cubics are off by some 1e-5, and more where a curve bends at
once."""

KINK = 0.03
"""How far [rad | size] the margin's greatest value may be above its samples: it falls like the joints move."""

ROUNDING = 1e-15
"""Error [size and rad] at which points of a curve are exact."""

CROSSING = 1e-8
"""Singular values below this are zero where a point of a curve is made exact. Near a crossing, at a distance δ, one is
of the size of δ; where it is left out, the point is off by the cubic's error."""

BESIDE_POINT = 2e-4
"""A place nearer than this to a point of the curve is on the cubic to 1e-12. At a crossing, which its seed often is, it
is much nearer than what Newton steps can tell there."""

DEGREE = 8
"""Degree of the polynomials between two samples: at 0.02 apart they are exact to rounding."""

CUTS = 16
"""Parts that an interval is cut into in each round of a search."""

ROUNDS = 12
"""Rounds of such a search: 8⁻¹² of the interval is left, less than rounding."""

NODES = 0.5 - 0.5 * np.cos(np.pi * np.arange(DEGREE + 1) / DEGREE)
"""Chebyshev's places on [0, 1]."""

FROM_NODES = np.linalg.inv(chebyshev.chebvander(2.0 * NODES - 1.0, DEGREE))
"""Values at the places to coefficients."""


class Track:
    """A curve as a function of the place u, with its limits.

    Of a closed curve places beyond its last are those of the next time round, full turns added.
    """

    def __init__(self, curve: Curve, chain: Chain, T: Array, limits: Array, size: float) -> None:
        self.chain, self.T, self.size, self.curve = chain, T, size, curve
        self.own = len(limits)
        self.scale = scale_of(chain, size)
        self.points, self.tangents = curve.x, curve.tangents
        self.last = len(self.points) - 1
        self.round = self.points[-1] - self.points[0] if curve.closed else np.zeros(chain.n)
        wide = np.tile([-np.inf, np.inf], (chain.n - len(limits), 1))
        self.low, self.high = (np.concatenate([limits, wide]) / self.scale[:, None]).T
        self.tolerance = LIMIT_TOLERANCE / self.scale
        with np.errstate(invalid="ignore"):  # of an unlimited joint: inf - inf
            middle = 0.5 * (self.low + self.high)
        self.middle = np.where(np.isfinite(middle), middle, 0.0)
        # An angle that is unlimited one way can be turned to where it is within.
        both = np.isfinite(self.low) & np.isfinite(self.high)
        self.turning = chain.revolute & both
        self.bounded = both | (~chain.revolute & (np.isfinite(self.low) | np.isfinite(self.high)))
        # A joint that stands still is within its limits everywhere or nowhere; its margin has no zero.
        self.still = np.ptp(self.points, axis=0) <= MOVES
        self.moving = self.bounded & ~self.still

    def cubic(self, u: Array) -> tuple[Array, Array]:
        """Points (m, n) near the curve at places u (m,), and its tangents (m, n)."""
        if self.last == 0:
            return np.tile(self.points[0], (len(u), 1)), np.tile(self.tangents[0], (len(u), 1))
        rounds = np.floor(u / self.last) if self.curve.closed else np.zeros(len(u))
        u = u - rounds * self.last
        i = np.clip(np.floor(u).astype(np.intp), 0, self.last - 1)
        f = (u - i)[:, None]
        a, chord = self.points[i], self.points[i + 1] - self.points[i]
        length = np.linalg.norm(chord, axis=1, keepdims=True)
        s, t = self.tangents[i] * length, self.tangents[i + 1] * length
        x = a + f * (s + f * (3.0 * chord - 2.0 * s - t + f * (s + t - 2.0 * chord)))
        way = (1.0 - f) * self.tangents[i] + f * self.tangents[i + 1]
        way /= np.maximum(np.linalg.norm(way, axis=1, keepdims=True), 1e-12)
        return x + rounds[:, None] * self.round, way

    def at(self, u: Array) -> Array:
        """The curve's points (m, n) at places u (m,), exactly."""
        x, way = self.cubic(u)
        if self.last == 0:
            return x
        rows = np.flatnonzero(np.abs(u - np.round(u)) > BESIDE_POINT)
        many = np.broadcast_to(self.T, (len(rows), 4, 4))
        x[rows] = corrected(self.chain, many, x[rows], self.size, way[rows, None], settled=ROUNDING, zero=CROSSING)[0]
        return x

    def turned(self, x: Array) -> Array:
        """(m, n) the full turns [rad] that bring each angle of x (m, n) nearest to the middle of its limits."""
        return np.where(self.turning, -TURN * np.round((x - self.middle) / TURN), 0.0)

    def margin(self, x: Array, turns: Array | None = None) -> Array:
        """(m,) the least distance of moving joints from their limits at x (m, n), with these full turns or the best."""
        x = x + (self.turned(x) if turns is None else turns)
        inside = np.minimum(x - self.low, self.high - x)
        return np.asarray(np.min(inside, axis=1, initial=np.inf, where=self.moving))

    def is_inside(self, x: Array, turns: Array | None = None) -> Flags:
        """(m,) whether x (m, n) is within the limits and their tolerance."""
        x = x + (self.turned(x) if turns is None else turns)
        fits = (x >= self.low - self.tolerance) & (x <= self.high + self.tolerance)
        return np.asarray(np.all(fits | ~self.bounded, axis=1))

    @cached_property
    def samples(self) -> tuple[Array, Array]:
        """Places u (m,) in order and points x (m, n), exact wherever the margin's sign could depend on it.

        They lie so close that between two the margin changes its sign once at most.
        """
        u = np.linspace(0.0, self.last, self.last * PARTS + 1)
        x, _ = self.cubic(u)
        margin = self.margin(x)
        rough = (np.abs(margin) <= NEARLY) & (u != np.round(u))
        if rough.any():
            x[rough] = self.at(u[rough])
            margin = self.margin(x)
        if len(u) < 3:
            return u, x
        before, after = np.r_[margin[0], margin[:-1]], np.r_[margin[1:], margin[-1]]
        if self.curve.closed:
            before[0], after[-1] = margin[-2], margin[1]
        # The margin is the least of several smooth functions: its kinks point upwards.
        peaks = (margin >= before) & (margin >= after) & (margin < 0.0) & (margin > -KINK)
        dips = (margin <= before) & (margin <= after) & (margin >= 0.0) & (margin < NEARLY)
        peaks &= (margin > before) | (margin > after)
        dips &= (margin < before) | (margin < after)
        extra = [self._between(u, np.flatnonzero(peaks), -1.0), self._between(u, np.flatnonzero(dips), 1.0)]
        more = np.setdiff1d(np.concatenate(extra), u)
        if len(more):
            u, x = np.append(u, more), np.concatenate([x, self.at(more)])
            order = np.argsort(u, kind="stable")
            u, x = u[order], x[order]
        return u, x

    def _between(self, u: Array, places: NDArray[np.intp], sign: float) -> Array:
        """The places beside samples at which sign · margin is least."""
        sides = [(i, j) for i in places.tolist() for j in (i - 1, i + 1) if 0 <= j < len(u)]
        if not sides:
            return np.empty(0)
        a, b = np.sort(u[np.array(sides)], axis=1).T
        return least(self, a, b, lambda x: sign * self.margin(x))[0]


def spans(track: Track, a: Array, b: Array) -> Array:
    """Coefficients (m, DEGREE + 1, n) of the points between places a and b (m,), between which no point stands."""
    u = a[:, None] + (b - a)[:, None] * NODES
    # A place that is a point ends one piece and begins the next: it belongs to this one.
    x = track.at(u.reshape(-1)).reshape(len(a), DEGREE + 1, -1)
    return np.asarray(FROM_NODES @ x)


def on_spans(coefficients: Array, f: Array) -> Array:
    """Points (m, p, n) at fractions f (m, p) of spans."""
    return np.asarray(chebyshev.chebvander(2.0 * f - 1.0, DEGREE) @ coefficients)


def least(track: Track, a: Array, b: Array, value: Callable[[Array], Array]) -> tuple[Array, Array]:
    """The places (m,) between a and b (m,) at which `value` of the points is least, and the values (m,) there."""
    coefficients = spans(track, a, b)
    low, high = np.zeros(len(a)), np.ones(len(a))
    cuts = np.linspace(0.0, 1.0, CUTS + 1)
    rows = np.arange(len(a))
    best, lowest = low, np.full(len(a), np.inf)
    for _ in range(ROUNDS):
        f = low[:, None] + (high - low)[:, None] * cuts
        found = value(on_spans(coefficients, f).reshape(f.size, -1)).reshape(f.shape)
        i = np.argmin(found, axis=1)
        best, lowest = f[rows, i], found[rows, i]
        low, high = f[rows, np.maximum(i - 1, 0)], f[rows, np.minimum(i + 1, CUTS)]
    return a + (b - a) * best, lowest


def zeros(track: Track, inside: Array, outside: Array, turns: Array) -> Array:
    """The places (m,) between those inside and outside (m,) at which the margin, with full turns (m, n), vanishes."""
    coefficients = spans(track, inside, outside)
    low, high = np.zeros(len(inside)), np.ones(len(inside))
    cuts = np.linspace(0.0, 1.0, CUTS + 1)
    rows = np.arange(len(inside))
    many = np.repeat(turns, CUTS + 1, axis=0)
    for _ in range(ROUNDS):
        f = low[:, None] + (high - low)[:, None] * cuts
        margin = track.margin(on_spans(coefficients, f).reshape(f.size, -1), many).reshape(f.shape)
        margin[:, 0], margin[:, -1] = np.inf, -np.inf
        i = np.argmax(margin < 0.0, axis=1)
        low, high = f[rows, i - 1], f[rows, i]
    return np.asarray(inside + (outside - inside) * low)
