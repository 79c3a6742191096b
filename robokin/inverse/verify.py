"""What happens to every solver's candidates: proof by forward kinematics, limits, duplicates, order.

Written once and shared by all solvers. Everything works on flat lists: s configurations and, for each, the
index of the target in the block that it is for.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robokin.arrays import Array, Flags, Index
from robokin.inverse.elimination.loop import Candidates, Loop
from robokin.inverse.elimination.loop_newton import refine
from robokin.kernel.chain import Chain
from robokin.kernel.native_kernel import native
from robokin.kernel.residual import TargetPoses
from robokin.model.robot import tolerated

CLOSES = 1e-9
"""A solution's greatest residual, in the arm's size and in radians: what is listed closes to this."""

ROUNDING = 1e-14
"""A residual of this part of what the joints slide may be rounding, on top of CLOSES: some 50 times the last digit.
Of a slide that is a million times as long as the links the last digit is a part in 1e10 of the links."""

EXACT_ENOUGH = 1e-12
"""Residual above which a candidate gets Newton steps before it is judged; closed forms give 1e-15."""

NEWTON_STEPS = 12
"""Steps of the polish. From 1e-4 two are enough; at double roots each step halves the error."""

SAME = 1e-6
"""Configurations that differ by less in every joint [rad | size] are one. Rounding moves a solution by 1e-9 at
a singular pose at most once it closes; different solutions are rarely nearer than 1e-4 to each other."""

HALF_TURN = 1e-9
"""Angles [rad] this near to -π count as π: solutions closer than that to the same root differ by rounding."""

CLOSE = 1e-4
"""A difference of the weighted sums of two configurations' joints, in half turns and sizes, below which the two may be
about to meet. By chance one pose in five hundred has one."""

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

    def pick(self, which: Index | Flags) -> Found:
        """Some of them."""
        if which.dtype == np.bool_:
            if which.all():
                return self
            which = np.flatnonzero(which)
        # Along what lies together in memory: joint by joint, or configuration by configuration.
        q = self.q.take(which, axis=0) if self.q.flags.c_contiguous else self.q.T.take(which, axis=1).T
        return Found(self.index.take(which), q, self.position.take(which), self.angle.take(which))

    def numbered(self, targets: Index) -> Found:
        """The same of some targets whose numbers among all (k,) are these."""
        return Found(targets[self.index], self.q, self.position, self.angle)


def nothing(n: int) -> Found:
    """No configuration."""
    return Found(np.empty(0, dtype=np.intp), np.empty((0, n)), np.empty(0), np.empty(0))


def merged(*parts: Found) -> Found:
    """All of them, one after the other."""
    return Found(
        np.concatenate([part.index for part in parts]),
        np.concatenate([part.q for part in parts]),
        np.concatenate([part.position for part in parts]),
        np.concatenate([part.angle for part in parts]),
    )


def residuals(T: Array, found: Array) -> tuple[Array, Array]:
    """Distances (s,) [m] and angles (s,) [rad] between poses (s, 4, 4).

    The angle comes from the chord |R_a - R_b| = 2 √2 sin(angle / 2), which keeps all digits of small ones.
    """
    difference = T[:, :3] - found[:, :3]
    position = np.sqrt(np.einsum("si,si->s", difference[:, :, 3], difference[:, :, 3]))
    chord = np.sqrt(np.einsum("sij,sij->s", difference[:, :, :3], difference[:, :, :3]))
    return position, 2.0 * np.arcsin(np.minimum(chord / np.sqrt(8.0), 1.0))


def verified(
    loop: Loop, chain: Chain, poses: TargetPoses, closing: Array, candidates: Candidates, enough: float = EXACT_ENOUGH
) -> Found:
    """The candidates that close, after a polish of those that close only nearly.

    poses: of the chain, against the targets; closing: (m, 4, 4) the targets as the loop's last link; enough: the
    residual [size and rad] above which a candidate is polished.
    """
    index, values = candidates.index, candidates.values
    scale = np.where(chain.revolute, 1.0, loop.size)[:, None]
    q = values.T * scale
    q -= chain.offsets[:, None]
    position, angle = poses.residuals(index, q)
    rough = np.flatnonzero(~(np.maximum(position / loop.size, angle) <= enough))
    if len(rough):
        polished, _, _ = refine(loop, closing, index[rough], values[rough], NEWTON_STEPS)
        q[:, rough] = polished.T * scale - chain.offsets[:, None]
        position[rough], angle[rough] = poses.residuals(index[rough], q[:, rough])
    closes = (position <= closing_distances(chain, q.T, loop.size)) & (angle <= CLOSES)
    return Found(index, q.T, position, angle).pick(closes)


def closing_distances(chain: Chain, q: Array, size: float) -> Array:
    """(s,) up to which distance from the target [m] configurations (s, n) [rad | m] close; of turning joints (1,)."""
    if chain.revolute.all():
        return np.array([CLOSES * size])
    slides = np.flatnonzero(~chain.revolute)
    slid = np.abs(q.T[slides] + chain.offsets[slides, None])
    return np.asarray(CLOSES * size + ROUNDING * np.sum(slid, axis=0))


def wrapped(q: Array, revolute: Flags) -> Array:
    """Joint values (s, n) with every angle in [-π, π]."""
    whole_turns = np.where(revolute, 0.5 / np.pi, 0.0)[:, None]
    out = np.empty_like(q.T, dtype=np.float64)  # laid out as they are: last digits of later products hang on that
    for start in range(0, len(q), TOGETHER):
        values = q.T[:, start : start + TOGETHER]
        turns = np.multiply(values, whole_turns, out=out[:, start : start + TOGETHER])
        np.rint(turns, out=turns)
        turns *= -2.0 * np.pi
        turns += values
    return out.T


TOGETHER = 4000
"""Configurations at a time where a handful of numbers of each are worked on in turn: they stay in the cache."""


def distinct(found: Found, revolute: Flags, size: float) -> Found:
    """One configuration of each set of equal ones, angles in [-π, π], by target and then by q1, q2, … .

    Of equal ones that with the least residual stays. The order is by q1 to q4 as rounded to a few
    hundredths of a degree (one number holds the four), and then by a weighted sum of all joints, so that no last digit
    decides.
    """
    return distinct_and_close(found, revolute, size)[0]


def distinct_and_close(found: Found, revolute: Flags, size: float) -> tuple[Found, Index, Index]:
    """`distinct`; the targets (k,) of which some were equal; those of which some may be nearer than CLOSE together.

    Where solutions meet the arm is singular, so that nearness is a cheap hint of it.
    """
    if native is None or not len(found):
        return told_by_tables(found, revolute, size)
    off = found.position / size + found.angle
    q, order, equal, close, listed, equals, near = native.arranged(
        found.index, found.q, off, revolute, size, CELLS, _weights(len(revolute)), THRESHOLDS
    )
    order = order[:listed]
    kept = Found(found.index[order], q[order], found.position[order], found.angle[order])
    return kept, equal[:equals], close[:near]


def told_by_tables(found: Found, revolute: Flags, size: float) -> tuple[Found, Index, Index]:
    """`distinct_and_close` in Python."""
    none = np.empty(0, dtype=np.intp)
    if not len(found):
        return found, none, none
    q = wrapped(found.q, revolute)
    # -180° is 180°, whatever the last digits say: the order must not depend on them.
    if q.T.min() < HALF_TURN - np.pi:
        q[revolute & (q < HALF_TURN - np.pi)] += 2.0 * np.pi
    scaled = q.T / np.where(revolute, np.pi, size)[:, None]
    by_target, counts = _by_target(found.index)
    # Each target's configurations side by side in a table.
    filled = np.arange(int(counts.max())) < counts[:, None]
    full = bool(filled.all())

    def table(values: NDArray[Any], missing: float = np.inf) -> NDArray[Any]:
        if full:
            return values[by_target].reshape(filled.shape)
        spread = np.full(filled.shape, missing, dtype=values.dtype)
        spread[filled] = values[by_target]
        return spread

    # Equal configurations have nearly equal sums of |q|, weighted so that different ones hardly ever do: sorted
    # target by target, only where two neighbours agree is looked at closely.
    weights = _weights(len(scaled))
    sums = table(weights @ np.abs(scaled))
    sums.sort(axis=1)
    gaps = np.full(len(sums), np.inf)
    with np.errstate(invalid="ignore"):
        for gap in np.diff(sums, axis=1).T:
            np.fmin(gaps, gap, out=gaps)
    alike = gaps < SAME * weights.sum()
    close = found.index[by_target[np.cumsum(counts) - counts]][gaps < CLOSE]
    key = np.zeros(len(by_target))
    for cells, value, turns in zip(KEY_CELLS, scaled, revolute, strict=False):
        half = 0.5 * (cells - 1)
        part = (value if turns else np.clip(value, -1.0, 1.0)) * half
        part += half + OFF_CENTRE
        key *= cells
        key += np.round(part, out=part)
    first = np.cumsum(counts) - counts
    ranks = _ranked(table(key.astype(np.int64), NO_KEY), lambda: table(weights @ scaled))
    places = first[:, None] + ranks
    order = by_target[places.reshape(-1) if full else places[filled]]
    arranged = Found(found.index, q, found.position, found.angle).pick(order)
    if not alike.any():
        return arranged, none, close
    compared = np.repeat(alike, counts)
    keep = np.ones(len(order), dtype=bool)
    keep[compared] = _first_of_equals(arranged.pick(compared), revolute, size)
    return arranged.pick(keep), np.unique(arranged.index[~keep]), close


OFF_CENTRE = 0.31
"""Moves round angles off the edges of the cells: zero, multiples of 15° and what rounding makes of them."""

KEY_CELLS = (2.0**14, 2.0**13, 2.0**13, 2.0**13)
"""Parts that the ranges of q1 … q4 are cut into for the order; their product is a whole number below 2⁵³."""

CELLS, THRESHOLDS = np.array(KEY_CELLS), (SAME, CLOSE, HALF_TURN, OFF_CENTRE)
"""What the native kernel is told of the order and of what is the same."""


@cache
def _weights(n: int) -> Array:
    """What n joints count in the sums that tell configurations apart."""
    return np.asarray(1.0 + np.modf(np.arange(1.0, n + 1.0) * 0.6180339887498949)[0])


def _by_target(index: Index) -> tuple[Index, Index]:
    """The order of configurations by target (s,), and how many each target has that has some."""
    counts = np.bincount(index)
    if counts.min() == counts.max():
        # Of a closed form all roots may be real, and stand branch after branch.
        branches = index.reshape(counts[0], len(counts))
        if (branches == np.arange(len(counts))).all():
            return np.arange(len(index)).reshape(branches.shape).T.ravel(), counts
    return np.argsort(index.astype(np.uint16), kind="stable"), counts[counts > 0]  # of 16 bits: counted, not compared


NO_KEY = 2**53
"""Stands for what is missing: above every key."""


def _ranked(keys: NDArray[Any], sums: Callable[[], Array]) -> Index:
    """The columns of a table of keys in rising order, row by row; of equal keys the sums decide, a table as well.

    Next to a singular pose two solutions may be in one cell, and come in any order.
    """
    width = keys.shape[1]
    if width > COLUMNS:
        order: Index = np.argsort(keys, axis=1, kind="stable")
        arranged = np.take_along_axis(keys, order, axis=1)
    else:
        # The column in the last digits: numbers are sorted in half the time that their places take.
        mixed = keys * COLUMNS
        mixed += np.arange(width)
        mixed.sort(axis=1)
        order, arranged = mixed & (COLUMNS - 1), mixed >> COLUMNS.bit_length() - 1
    # What fills a row up is no key, and no two of it are told apart.
    alike = (arranged[:, 1:] == arranged[:, :-1]) & (arranged[:, 1:] < NO_KEY)
    tied = np.unique(np.flatnonzero(alike) // max(width - 1, 1))
    if len(tied):
        order[tied] = np.lexsort((sums()[tied], keys[tied]), axis=1)
    return order


COLUMNS = 32
"""Columns of a table, a power of two, of which the number is written behind the keys: below 2⁶³ together."""


def _first_of_equals(found: Found, revolute: Flags, size: float) -> Flags:
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


def within_limits(q: Array, revolute: Flags, limits: Array, near: Array | None) -> tuple[Array, Flags]:
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
    low, high = tolerated(limits)
    inside = np.ones(len(q), dtype=bool)
    columns = q.T
    for i in np.flatnonzero(np.isfinite(limits).any(axis=1)):
        column = columns[i]
        fits = (column >= low[i]) & (column <= high[i])
        beyond = near is not None or low[i] < -np.pi or high[i] > np.pi
        if revolute[i] and beyond and not fits.all():
            # The least and the greatest turn that are within the limits; the nearest to the wish lies between them.
            off = np.flatnonzero(~fits)
            values = column[off]
            with np.errstate(invalid="ignore"):
                least, most = np.ceil((low[i] - values) / turn), np.floor((high[i] - values) / turn)
            values += turn * np.where(least <= most, np.clip(0.0, least, most), 0.0)
            fits[off] = (values >= low[i]) & (values <= high[i])
            columns = columns.copy() if q is given else columns
            q = columns.T
            columns[i] += 0.0  # as turns by nothing leave it: of no zero the sign counts
            columns[i, off] = values
        inside &= fits
    return q, inside


def with_ones_within(listed: Found, found: Found, revolute: Flags, limits: Array, size: float) -> tuple[Found, Index]:
    """What is listed, by target, and of each target with none within limits (n, 2) the most exact one found that is.

    Of roots that joint values hardly tell apart one outside the limits may stand for one within. Also the targets (k,)
    to which one was added.
    """
    if np.all(np.isinf(limits)) or not len(found):
        return listed, np.empty(0, dtype=np.intp)
    inside = within_limits(found.q, revolute, limits, None)[1]
    answered = listed.index[within_limits(listed.q, revolute, limits, None)[1]]
    rows = np.flatnonzero(inside & ~np.isin(found.index, answered))
    if not len(rows):
        return listed, np.empty(0, dtype=np.intp)
    rows = rows[np.lexsort((np.maximum(found.position[rows] / size, found.angle[rows]), found.index[rows]))]
    rows = rows[np.unique(found.index[rows], return_index=True)[1]]
    both = merged(listed, found.pick(rows))
    return both.pick(np.argsort(both.index, kind="stable")), found.index[rows]
