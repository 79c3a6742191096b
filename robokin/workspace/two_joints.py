"""The size of a set that two joints reach, by an integral over the second joint alone.

With the first joint at zero let x(q2) be where the second puts the tool's origin. Another value q2' leads to the same
place, for another value of the first joint, only where the first can move x(q2) to x(q2'): where both are at one
height and one distance from its axis, or, if it slides, on one line along it. On the circle or line that x runs through
these are two functions of the form A cos θ + B sin θ + C, or of second degree; they agree along a whole range of q2
only if one reflection q2' = 2 c - q2 leaves both as they are. So a place has one configuration or two, the second known
in closed form, and

    size = ∫ w(q2) (W - ½ |[0, W] ∩ [δ, δ + W]|) dq2,

with w the norm of the two derivatives' cross product, W the first joint's stroke, δ what the second configuration needs
more of it, and without the second term where q2' is out of the limits. Between the known places where q2' comes to a
limit, or the ranges of the first joint begin to overlap, the integrand is smooth; it is integrated there by the rule of
Gauss and Kronrod in intervals that are halved where that is the least exact.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from robokin.arrays import Array
from robokin.spatial.angles import TURN, circled
from robokin.workspace.sampling import moving_chain
from robokin.workspace.sizes import Measure
from robokin.workspace.space import Space

ALIKE = 1e-6
"""Heights and distances [size] that differ by less under a reflection are the same: tables are printed to some five
digits, and what they make flat is taken for flat."""

ROUNDING = 1e-12
"""Rounding of an integral, as a part of it."""

SAFETY = 4.0
"""The bound is so many times the difference of the two rules, each of which is much greater than the error."""

ENOUGH = 1e-13
"""Halving ends where the bound is this part of the integral."""

LEAST_WIDTH = 1e-13
"""An interval of this part of the whole is not halved any more."""

SCANNED, HALVINGS = 65, 52
"""Values at which a kink of the integrand is looked for between two ends, and halvings that find it to rounding."""

# Gauss-Kronrod 7/15 (R. Piessens et al., QUADPACK, 1983): nodes from the middle outwards, weights of both rules.
_NODES = (
    0.0, 0.207784955007898467600689403773245, 0.405845151377397166906606412076961, 0.586087235467691130294144691693013,
    0.741531185599394439863864773280788, 0.864864423359769072789712788640926, 0.949107912342758524526189684047851,
    0.991455371120812639206854697526329,
)  # fmt: skip
_KRONROD = (
    0.209482141084727828012999174891714, 0.204432940075298892414161999234649, 0.190350578064785409913256402421014,
    0.169004726639267902826583426598550, 0.140653259715525918745189590510238, 0.104790010322250183839876322541518,
    0.063092092629978553290700663189204, 0.022935322010529224963732008058970,
)  # fmt: skip
_GAUSS = (
    0.417959183673469387755102040816327, 0.0, 0.381830050505118944950369775488975, 0.0,
    0.279705391489276667901467771423780, 0.0, 0.129484966168869693270611432679082, 0.0,
)  # fmt: skip


def _both_sides(values: tuple[float, ...], sign: float = 1.0) -> Array:
    return np.array([sign * value for value in values[:0:-1]] + list(values))


NODES, KRONROD, GAUSS = _both_sides(_NODES, -1.0), _both_sides(_KRONROD), _both_sides(_GAUSS)


@dataclass(frozen=True, eq=False)
class _Pair:
    """Two joints, lengths in the arm's size: x(q2) = middle + cos(q2 + offset) along + sin(q2 + offset) across, or
    middle + q2 along if the second slides, in the frame of the first, which turns about z or slides along it."""

    turns: tuple[bool, bool]
    offset: float
    middle: Array
    along: Array
    across: Array

    def at(self, q2: Array) -> tuple[Array, Array]:
        """Places (m, 3) and their derivatives (m, 3) at q2 (m,)."""
        if not self.turns[1]:
            return self.middle + q2[:, None] * self.along, np.broadcast_to(self.along, (len(q2), 3))
        c, s = np.cos(q2 + self.offset)[:, None], np.sin(q2 + self.offset)[:, None]
        return self.middle + c * self.along + s * self.across, c * self.across - s * self.along

    def weight(self, q2: Array) -> Array:
        """(m,) the area that a unit of both joints sweeps."""
        x, slope = self.at(q2)
        z = np.array([0.0, 0.0, 1.0])
        return np.asarray(np.linalg.norm(np.cross(np.cross(z, x) if self.turns[0] else z, slope), axis=1))

    def sum_of_both(self) -> float | None:
        """q2 + q2' of the values that the first joint makes one place of; None where there are no two such."""
        if not self.turns[1]:
            if not self.turns[0] or abs(self.along[2]) > ALIKE:
                return None
            return float(-2.0 * self.middle[:2] @ self.along[:2])
        if self.turns[0]:
            rows = [[part[2], part @ self.middle] for part in (self.along, self.across)]
        else:
            rows = [[part[0], part[1]] for part in (self.along, self.across)]
        _, values, directions = np.linalg.svd(np.transpose(rows) / np.linalg.norm(self.along))
        if values[1] > ALIKE:
            return None
        return float(2.0 * (np.arctan2(directions[0, 1], directions[0, 0]) - self.offset))

    def shift(self, q2: Array, other: Array) -> Array:
        """(m,) how much more of the first joint the values `other` (m,) need for the place of q2 (m,)."""
        here, there = self.at(q2)[0], self.at(other)[0]
        if not self.turns[0]:
            return np.asarray(here[:, 2] - there[:, 2])
        return np.arctan2(here[:, 1], here[:, 0]) - np.arctan2(there[:, 1], there[:, 0])


def _pair_of(space: Space) -> _Pair:
    chain = moving_chain(space)
    first, last = chain.constants[1].copy(), chain.constants[2][:3, 3] / space.size
    R, o = first[:3, :3], first[:3, 3] / space.size
    turns = bool(chain.revolute[0]), bool(chain.revolute[1])
    if turns[1]:
        middle = o + R @ [0.0, 0.0, last[2]]
        return _Pair(turns, chain.offsets[1], middle, R @ [last[0], last[1], 0.0], R @ [-last[1], last[0], 0.0])
    middle = o + R @ (last + np.array([0.0, 0.0, chain.offsets[1] / space.size]))
    return _Pair(turns, 0.0, middle, R[:, 2].copy(), np.zeros(3))


def two_joint_measure(space: Space, samples: int, several: bool = False) -> Measure:
    """The area that two joints reach, or of its part where two orientations are possible.

    `samples` values of the second joint are looked at, but never less than one interval's.
    """
    pair = _pair_of(space)
    unit = np.where(moving_chain(space).revolute, 1.0, space.size)
    moving = list(space.moving)
    low, high, full = space.low[moving] / unit, space.high[moving] / unit, space.full[moving]
    both = pair.sum_of_both()
    stroke = float(high[0] - low[0])

    def integrand(q2: Array) -> Array:
        twice = np.zeros(len(q2))
        if both is not None:
            other = both - q2
            if pair.turns[1]:
                other = low[1] + np.mod(other - low[1], TURN)
            inside = np.flatnonzero(full[1] | ((other >= low[1]) & (other <= high[1])))
            apart = pair.shift(q2[inside], other[inside])
            twice[inside] = _common(apart, stroke, pair.turns[0], bool(full[0]))
        return pair.weight(q2) * (0.5 * twice if several else stroke - 0.5 * twice)

    edges = _edges(pair, both, (float(low[1]), float(high[1]), bool(full[1])), (stroke, bool(full[0])))
    value, error, count = integrated(integrand, edges, samples)
    error += ROUNDING * (value + float(np.prod(high - low)) * 1e-3)
    area = space.size**2
    return Measure(value * area, error * area, "integral over the second joint alone", count)


def _common(shift: Array, stroke: float, turns: bool, full: bool) -> Array:
    """(m,) how much two ranges of the first joint have in common, one of them `shift` (m,) ahead."""
    if full:
        return np.full(len(shift), stroke)
    if not turns:
        return np.maximum(stroke - np.abs(shift), 0.0)
    ahead = np.mod(shift, TURN)
    return np.maximum(stroke - ahead, 0.0) + np.maximum(stroke - (TURN - ahead), 0.0)


def _edges(pair: _Pair, both: float | None, second: tuple[float, float, bool], first: tuple[float, bool]) -> Array:
    """The ends of intervals of q2 within which the integrand is smooth; second: the second joint's limits and whether
    it makes a whole turn, first: the first one's stroke and whether that is a whole turn."""
    low, high, full = second
    if both is None:
        return np.array([low, high])
    # Where the two configurations meet, and where the other is at a limit.
    inner = [0.5 * both] + ([] if full else [both - low, both - high])
    if pair.turns[1]:
        inner = [low + float(np.mod(value - low, TURN)) for value in [*inner, 0.5 * both + np.pi]]
    edges = np.array([low, *sorted({value for value in inner if low < value < high}), high])
    opposite = TURN - first[0] if pair.turns[0] else -first[0]
    levels = [] if first[1] else [first[0], opposite]
    found = [edges]
    for level in levels:
        # Where the ranges of the first joint begin to have a part in common.
        parts = np.linspace(edges[:-1], edges[1:], SCANNED).T
        for one in parts:
            found.append(_crossed(partial(_above, pair, both, level), one))
    return np.unique(np.concatenate(found))


def _above(pair: _Pair, both: float, level: float, q2: Array) -> Array:
    """(m,) how much more than `level` the other configuration needs of the first joint, to half a turn if it turns."""
    apart = pair.shift(q2, both - q2) - level
    return circled(apart) if pair.turns[0] else apart


def _crossed(g: Callable[[Array], Array], x: Array) -> Array:
    """Where g changes sign between neighbours of x (k,), but for leaps."""
    values = g(x)
    which = np.flatnonzero((values[1:] > 0.0) != (values[:-1] > 0.0))
    which = which[np.abs(values[which + 1] - values[which]) < np.pi] if len(which) else which
    low, high, below = x[which], x[which + 1], values[which] > 0.0
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        same = (g(middle) > 0.0) == below
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return 0.5 * (low + high)


def integrated(f: Callable[[Array], Array], edges: Array, most: int) -> tuple[float, float, int]:
    """∫ f from the first to the last of edges, a bound of the error, and how many values were looked at.

    f: (m,) -> (m,), continuous between neighbouring edges.
    """
    least = LEAST_WIDTH * float(edges[-1] - edges[0])
    a, b = edges[:-1], edges[1:]
    value, error, spent = *_rules(f, a, b), len(a) * len(NODES)
    while spent + 2 * len(NODES) <= most and SAFETY * float(np.sum(error)) > ENOUGH * abs(float(np.sum(value))):
        # The worst that together have most of the error, as far as the budget goes.
        order = np.argsort(-np.where(b - a > least, error, 0.0), kind="stable")
        ahead = np.cumsum(error[order])
        count = int(np.searchsorted(ahead, 0.75 * ahead[-1])) + 1
        chosen = order[: min(count, (most - spent) // (2 * len(NODES)))]
        chosen = chosen[(b - a)[chosen] > least]
        if not len(chosen):
            break
        middle = 0.5 * (a[chosen] + b[chosen])
        new_a, new_b = np.concatenate([a[chosen], middle]), np.concatenate([middle, b[chosen]])
        new = _rules(f, new_a, new_b)
        spent += len(new_a) * len(NODES)
        kept = np.ones(len(a), dtype=bool)
        kept[chosen] = False
        a, b = np.concatenate([a[kept], new_a]), np.concatenate([b[kept], new_b])
        value, error = (np.concatenate([old[kept], part]) for old, part in zip((value, error), new, strict=True))
    return float(np.sum(value)), SAFETY * float(np.sum(error)), spent


def _rules(f: Callable[[Array], Array], a: Array, b: Array) -> tuple[Array, Array]:
    """(k,) Kronrod's rule on intervals from a to b (k,), and how far Gauss's is from it."""
    half = 0.5 * (b - a)
    x = (0.5 * (a + b))[:, None] + half[:, None] * NODES
    values = f(x.ravel()).reshape(x.shape)
    return half * (values @ KRONROD), np.abs(half * (values @ (KRONROD - GAUSS)))
