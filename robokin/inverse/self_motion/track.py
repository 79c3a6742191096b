"""Self-motions as functions of a place on each, with the joint limits: what arcs and nearest members are found on.

Statement. Give the configurations at any places of followed curves, their distances from the joint limits, and the
places where a function of the configuration vanishes or is least: on all curves at once.
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

from collections.abc import Callable, Sequence

import numpy as np
from numpy.polynomial import chebyshev

from robokin.arrays import Array, Flags, Index
from robokin.inverse.self_motion.curve_tracing import MOVES, Curve
from robokin.inverse.self_motion.pose_correction import corrected, scale_of
from robokin.inverse.verify import HALF_TURN
from robokin.kernel.chain import Chain
from robokin.model.robot import LIMIT_TOLERANCE
from robokin.spatial.angles import TURN

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


class Tracks:
    """Curves as functions of the place u, with the limits of the arm, which are the same for all.

    Wherever places are asked for, k says of which curve, from 0, each is. Of a closed curve places beyond its last are
    those of the next time round, full turns added.
    """

    def __init__(self, curves: Sequence[Curve], chain: Chain, T: Array, limits: Array, size: float) -> None:
        """T: (k, 4, 4) the curves' poses; limits: (own, 2) [rad | m] of the arm's own joints."""
        self.chain, self.T, self.size, self.curves = chain, T, size, curves
        self.own = len(limits)
        self.scale = scale_of(chain, size)
        none = np.empty((0, chain.n))
        self.points = np.concatenate([none, *(curve.x for curve in curves)])
        self.tangents = np.concatenate([none, *(curve.tangents for curve in curves)])
        counts = np.array([len(curve.q) for curve in curves], dtype=np.intp)
        self.first, self.last = np.cumsum(counts) - counts, counts - 1
        self.closed = np.array([curve.closed for curve in curves], dtype=bool)
        whole = self.points[self.first + self.last] - self.points[self.first]
        self.round = np.where(self.closed[:, None], whole, 0.0)
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
        if len(curves):
            spread = np.maximum.reduceat(self.points, self.first) - np.minimum.reduceat(self.points, self.first)
        else:
            spread = none
        self.still = spread <= MOVES
        self.moving = self.bounded & ~self.still
        # What joints that stand still move by from a wish, which is the same for many points.
        self.least_moves: tuple[Array, Array] | None = None

    @property
    def of_points(self) -> Index:
        """(p,) the curve of each point."""
        return np.repeat(np.arange(len(self.last)), self.last + 1)

    def cubic(self, k: Index, u: Array) -> tuple[Array, Array]:
        """Points (m, n) near the curves k (m,) at places u (m,), and the tangents (m, n)."""
        last = self.last[k]
        rounds = np.where(self.closed[k], np.floor(u / np.maximum(last, 1)), 0.0)
        u = u - rounds * last
        i = np.clip(np.floor(u).astype(np.intp), 0, np.maximum(last - 1, 0))
        f = (u - i)[:, None]
        here = self.first[k] + i
        ahead = np.minimum(here + 1, self.first[k] + last)
        a, chord = self.points[here], self.points[ahead] - self.points[here]
        length = np.linalg.norm(chord, axis=1, keepdims=True)
        before, after = self.tangents[here], self.tangents[ahead]
        s, t = before * length, after * length
        x = a + f * (s + f * (3.0 * chord - 2.0 * s - t + f * (s + t - 2.0 * chord)))
        way = (1.0 - f) * before + f * after
        way /= np.maximum(np.linalg.norm(way, axis=1, keepdims=True), 1e-12)
        return x + rounds[:, None] * self.round[k], way

    def at(self, k: Index, u: Array) -> Array:
        """The points (m, n) of curves k (m,) at places u (m,), exactly."""
        x, way = self.cubic(k, u)
        rows = np.flatnonzero((np.abs(u - np.round(u)) > BESIDE_POINT) & (self.last[k] > 0))
        if len(rows):
            T, normals = self.T[k[rows]], way[rows, None]
            x[rows] = corrected(self.chain, T, x[rows], self.size, normals, settled=ROUNDING, zero=CROSSING)[0]
        return x

    def turned(self, x: Array) -> Array:
        """(m, n) the full turns [rad] that bring each angle of x (m, n) nearest to the middle of its limits.

        Half a turn off it is above the middle, whatever the last digits say.
        """
        return np.where(self.turning, -TURN * np.ceil((x - self.middle - HALF_TURN) / TURN - 0.5), 0.0)

    def margin(self, k: Index, x: Array, turns: Array | None = None) -> Array:
        """(m,) the least distance of the joints that move on curves k (m,) from their limits at x (m, n).

        turns: the full turns [rad] that count, or the best ones.
        """
        x = x + (self.turned(x) if turns is None else turns)
        inside = np.minimum(x - self.low, self.high - x)
        return np.asarray(np.min(np.where(self.moving[k], inside, np.inf), axis=1, initial=np.inf))

    def is_inside(self, x: Array, turns: Array | None = None) -> Flags:
        """(m,) whether x (m, n) is within the limits and their tolerance."""
        x = x + (self.turned(x) if turns is None else turns)
        fits = (x >= self.low - self.tolerance) & (x <= self.high + self.tolerance)
        return np.asarray(np.all(fits | ~self.bounded, axis=1))

    def samples(self) -> list[tuple[Array, Array]]:
        """Of each curve places u (m,) in order and points x (m, n), exact where the margin's sign could depend on it.

        They lie so close that between two the margin changes its sign once at most.
        """
        counts = self.last * PARTS + 1
        k = np.repeat(np.arange(len(counts)), counts)
        first = np.cumsum(counts) - counts
        u = (np.arange(len(k)) - first[k]) / PARTS
        x, _ = self.cubic(k, u)
        margin = self.margin(k, x)
        rough = np.flatnonzero((np.abs(margin) <= NEARLY) & (u != np.round(u)))
        if len(rough):
            x[rough] = self.at(k[rough], u[rough])
            margin[rough] = self.margin(k[rough], x[rough])
        before, after = np.r_[0.0, margin[:-1]], np.r_[margin[1:], 0.0]
        end = first + counts - 1
        # Beside the ends of a curve that is not closed nothing is higher or lower than these.
        round_ = self.closed & (counts > 1)
        before[first] = np.where(round_, margin[np.maximum(end - 1, 0)], margin[first])
        after[end] = np.where(round_, margin[np.minimum(first + 1, len(u) - 1)], margin[end])
        # The margin is the least of several smooth functions: its kinks point upwards.
        peaks = (margin >= before) & (margin >= after) & (margin < 0.0) & (margin > -KINK)
        dips = (margin <= before) & (margin <= after) & (margin >= 0.0) & (margin < NEARLY)
        peaks &= (margin > before) | (margin > after)
        dips &= (margin < before) | (margin < after)
        row, sign = np.flatnonzero(peaks | dips), np.where(peaks, -1.0, 1.0)
        # On either side of each.
        low = np.concatenate([row[row > first[k[row]]] - 1, row[row < end[k[row]]]])
        sign = np.concatenate([sign[row[row > first[k[row]]]], sign[row[row < end[k[row]]]]])
        more, of = np.empty(0), k[low]
        if len(low):
            more, _ = least(self, of, u[low], u[low + 1], lambda i, of, y: sign[i] * self.margin(of, y))
        met, places = self._meetings(k, u, x, margin)
        of, more = np.append(of, met), np.append(more, places)
        if len(more):
            new, which = np.unique(np.stack([of, more]), axis=1, return_index=True)
            which = which[new[1] * PARTS != np.round(new[1] * PARTS)]
            of, more = of[which], more[which]
            x = np.concatenate([x, self.at(of, more)])
            k, u = np.append(k, of), np.append(u, more)
            order = np.lexsort((u, k))
            k, u, x = k[order], u[order], x[order]
        cuts = np.searchsorted(k, np.arange(1, len(counts)))
        return list(zip(np.split(u, cuts), np.split(x, cuts), strict=True)) if len(counts) else []

    def _meetings(self, k: Index, u: Array, x: Array, margin: Array) -> tuple[Index, Array]:
        """Where joints meet their limits between samples (m,), if several do: places (s,) within them, and the curves.

        One joint may come back from beyond its limit where another goes there: a piece of one point beside a longer
        one.
        """
        lower, higher = np.minimum(margin[1:], margin[:-1]), np.maximum(margin[1:], margin[:-1])
        rows = np.flatnonzero((k[1:] == k[:-1]) & (lower < 0.0) & (higher > -KINK))
        # Between limits that are nearly a full turn apart each end may have full turns of its own.
        better = margin[rows] > margin[rows + 1]
        turns, others = (self.turned(x[np.where(best, rows, rows + 1)]) for best in (better, ~better))
        differ = np.flatnonzero(np.any(turns != others, axis=1))
        rows, turns = np.append(rows, rows[differ]), np.concatenate([turns, others[differ]])

        def room(i: Index, y: Array) -> Array:
            return np.where(self.moving[k[rows[i]]], np.minimum(y - self.low, self.high - y), np.inf)

        every = np.arange(len(rows))
        near = np.minimum(np.abs(room(every, x[rows] + turns)), np.abs(room(every, x[rows + 1] + turns))) <= KINK
        some = np.flatnonzero(np.sum(near, axis=1) > 1)
        if not len(some):
            return np.empty(0, dtype=np.intp), np.empty(0)
        f = np.linspace(0.0, 1.0, CUTS + 1)
        many, start = np.repeat(some, CUTS + 1), u[rows[some]]
        points = on_spans(spans(self, k[rows[some]], start, u[rows[some] + 1]), np.tile(f, (len(some), 1)))
        values = room(many, points.reshape(len(many), -1) + turns[many]).reshape(points.shape)
        inside = values >= 0.0
        i, part, joint = np.nonzero((inside[:, 1:] != inside[:, :-1]) & near[some][:, None])
        if not len(i):
            return np.empty(0, dtype=np.intp), np.empty(0)
        ends = start[i, None] + (u[rows[some] + 1] - start)[i, None] * np.stack([f[part], f[part + 1]], axis=1)
        within = np.where(inside[i, part, joint], 0, 1)
        one = np.arange(len(i))
        places = zeros(
            self,
            k[rows[some[i]]],
            ends[one, within],
            ends[one, 1 - within],
            lambda row, _, y: room(some[i[row]], y + turns[some[i[row]]])[np.arange(len(row)), joint[row]],
        )
        of = k[rows[some[i]]]
        fits = self.is_inside(self.at(of, places), turns[some[i]])
        return of[fits], places[fits]


def spans(tracks: Tracks, k: Index, a: Array, b: Array) -> Array:
    """Coefficients (m, DEGREE + 1, n) of the points between places a and b (m,), between which no point stands."""
    u = a[:, None] + (b - a)[:, None] * NODES
    # A place that is a point ends one piece and begins the next: it belongs to this one.
    x = tracks.at(np.repeat(k, DEGREE + 1), u.reshape(-1)).reshape(len(a), DEGREE + 1, tracks.chain.n)
    return np.asarray(FROM_NODES @ x)


def on_spans(coefficients: Array, f: Array) -> Array:
    """Points (m, p, n) at fractions f (m, p) of spans."""
    return np.asarray(chebyshev.chebvander(2.0 * f - 1.0, DEGREE) @ coefficients)


def least(
    tracks: Tracks,
    k: Index,
    a: Array,
    b: Array,
    value: Callable[[Index, Index, Array], Array],
    steepest: float = np.inf,
) -> tuple[Array, Array]:
    """The places (m,) between a and b (m,) of curves k (m,) at which `value` is least, and the values (m,) there.

    `value` gives (s,) values for points x (s, n), which of the m intervals each is in, and its curve. Where it cannot
    come down to zero, as it changes by `steepest` times the difference of places at most, it is not sought further.
    """
    best, lowest = np.array(a), np.full(len(a), np.inf)
    low, high = np.zeros(len(a)), np.ones(len(a))
    cuts = np.linspace(0.0, 1.0, CUTS + 1)
    rows, coefficients = np.arange(len(a)), spans(tracks, k, a, b)
    for _ in range(ROUNDS):
        f = low[:, None] + (high - low)[:, None] * cuts
        of = np.repeat(rows, CUTS + 1)
        found = value(of, k[of], on_spans(coefficients, f).reshape(f.size, -1)).reshape(f.shape)
        every, i = np.arange(len(rows)), np.argmin(found, axis=1)
        best[rows], lowest[rows] = a[rows] + (b - a)[rows] * f[every, i], found[every, i]
        low, high = f[every, np.maximum(i - 1, 0)], f[every, np.minimum(i + 1, CUTS)]
        on = lowest[rows] <= steepest * (high - low) * (b - a)[rows] if np.isfinite(steepest) else every >= 0
        if not on.all():
            rows, coefficients, low, high = rows[on], coefficients[on], low[on], high[on]
            if not len(rows):
                break
    return best, lowest


def zeros(
    tracks: Tracks, k: Index, inside: Array, outside: Array, value: Callable[[Index, Index, Array], Array]
) -> Array:
    """The places (m,) between those inside and outside (m,) of curves k (m,) at which `value` vanishes.

    It is as for `least`, positive inside and negative outside.
    """
    coefficients = spans(tracks, k, inside, outside)
    low, high = np.zeros(len(inside)), np.ones(len(inside))
    cuts = np.linspace(0.0, 1.0, CUTS + 1)
    rows = np.arange(len(inside))
    of = np.repeat(rows, CUTS + 1)
    for _ in range(ROUNDS):
        f = low[:, None] + (high - low)[:, None] * cuts
        found = value(of, k[of], on_spans(coefficients, f).reshape(f.size, -1)).reshape(f.shape)
        found[:, 0], found[:, -1] = np.inf, -np.inf
        i = np.argmax(found < 0.0, axis=1)
        low, high = f[rows, i - 1], f[rows, i]
    return np.asarray(inside + (outside - inside) * low)
