"""Some well spread ones of many configurations: what is listed of infinitely many solutions.

Statement. Of K configurations choose N so that the least distance between two of them is great. The distance is
the greatest difference of a joint, of angles on the circle.
Derivation. Begin with one, then take each time the one whose distance from all the chosen is greatest. The least
distance of the chosen is at least half of the best that any choice of N has: were it less, every configuration
would be nearer than that to one of the first N - 1 chosen, and two of any N would have such a one in common.
Reference: T. Gonzalez, "Clustering to minimize the maximum intercluster distance", Theoretical Computer Science 38,
1985.
"""

from __future__ import annotations

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.kernel.native_kernel import native
from robokin.spatial.angles import TURN

CELLS = 2**15
"""Configurations at a time: the tables stay in cache."""

FEW = 2**13
"""Joint values in a table that is looked at as a whole."""

DECIMALS = 7
"""Distances that agree to so many decimals [rad | size] are equal, and the first configuration is taken."""

PREFERRED = 1e3
"""More than any distance: what is preferred comes first, however near."""


def well_spread(index: Index, x: Array, revolute: Flags, move: Array, rank: Flags | Index, most: int) -> Index:
    """Which configurations to list for each target, at most `most`, in the order of their choice.

    index: (s,) the targets, sorted; x: (s, n) configurations, angles in [-π, π], lengths in sizes; move: (s,),
    the least of a target is chosen first; rank: (s,) all of a higher rank are chosen before any of a lower one, as
    those within the limits (1 or true) before the others (0 or false).
    """
    starts = np.flatnonzero(np.diff(index, prepend=-1))
    counts = np.diff(np.append(starts, len(index)))
    if not len(starts):
        return np.empty(0, dtype=np.intp)
    if len(starts) == 1 and revolute.all():
        return spread_of_one(x.T, move, most, np.asarray(PREFERRED * rank))
    chosen = []
    step = max(CELLS // int(counts.max()), 1)
    for a in range(0, len(starts), step):
        begin, count = starts[a : a + step], counts[a : a + step]
        place = np.arange(count.max())
        filled = place < count[:, None]
        rows = begin[:, None] + np.minimum(place, count[:, None] - 1)
        picked = _chosen(x.T[:, rows], revolute, filled, move[rows], rank[rows], min(most, len(place)))
        chosen.append((begin[:, None] + picked)[picked >= 0])
    return np.concatenate(chosen)


def spread_of_one(x: Array, move: Array, most: int, preferred: Array | None = None) -> Index:
    """The places of up to `most` well spread ones of configurations x (n, s) of turning joints, for one target.

    move: (s,); preferred: (s,) what is added to a distance, if anything.
    """
    if native is not None and x.size:
        places: Index = native.spread(x, move, max(most, 1), preferred)
        return places
    return _spread_by_rows(x, move, most, preferred)


def _spread_by_rows(x: Array, move: Array, most: int, preferred: Array | None) -> Index:
    """`spread_of_one` in Python."""
    n, count = x.shape
    away, back, gap, distance = np.empty((n, count)), np.empty((n, count)), np.empty(count), np.full(count, np.inf)
    least = np.rint(move * 10.0**DECIMALS)
    pick = int((least if preferred is None else least - preferred * 10.0**DECIMALS).argmin())
    chosen = [pick]
    while len(chosen) < min(most, count):
        np.subtract(x, x[:, pick : pick + 1], out=away)
        np.abs(away, out=away)
        np.subtract(TURN, away, out=back)
        np.minimum(away, back, out=away)
        np.maximum.reduce(away, axis=0, out=gap)
        np.multiply(gap, 10.0**DECIMALS, out=gap)
        np.rint(gap, out=gap)
        np.minimum(distance, gap, out=distance)
        distance[pick] = -np.inf
        pick = int((distance if preferred is None else distance + preferred * 10.0**DECIMALS).argmax())
        chosen.append(pick)
    return np.array(chosen, dtype=np.intp)


def _chosen(
    x: Array,
    revolute: Flags,
    filled: Flags,
    move: Array,
    rank: Flags | Index,
    most: int,
) -> Index:
    """(g, most) places of the chosen of x: (n, g, K) in the order of their choice; -1 where there are no more."""
    preferred = PREFERRED * rank
    distance = np.where(filled, np.inf, -np.inf)
    out = np.empty((len(filled), most), dtype=np.intp)
    target = np.arange(len(filled))
    # Few configurations of turning joints at once, for which the calls take longer than the work.
    together = bool(x.size <= FEW and revolute.all())
    pick = np.argmax(np.where(filled, preferred - np.round(move, DECIMALS), -np.inf), axis=1)
    for k in range(most):
        out[:, k] = np.where(distance[target, pick] > -np.inf, pick, -1)
        if together:
            away = np.abs(x - x[:, target, pick][:, :, None])
            gap = np.max(np.minimum(away, 2.0 * np.pi - away), axis=0)
        else:
            gap = np.zeros(distance.shape)
            for values, turns in zip(x, revolute, strict=True):
                difference = np.abs(values - values[target, pick][:, None])
                if turns:
                    difference = np.minimum(difference, 2.0 * np.pi - difference)
                np.maximum(gap, difference, out=gap)
        np.minimum(distance, np.round(gap, DECIMALS), out=distance)
        distance[target, pick] = -np.inf
        pick = np.argmax(distance + preferred, axis=1)
    return out
