"""Where self-motions cross: configurations from which more curves leave than the one that was followed.

Statement. On curves of configurations that reach one pose find those at which the Jacobian loses rank.
Derivation. Along a curve one null vector is the tangent. Where a second one appears the least singular value that is
not the tangent's vanishes, about linearly in the distance: of its samples at the curve's points the lower ones than
their neighbours are refined on the polynomials between the points (`track`).
Degenerate case. Along a curve that counts twice that vanishes everywhere: of an arm of six joints or fewer the next one
is watched; of an arm with a joint to spare such a curve has no crossings of its own.

Here x are joint values [rad | size] and lengths are in the arm's size.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.inverse.self_motion.curve_tracing import Curve
from robokin.inverse.self_motion.pose_correction import errors
from robokin.inverse.self_motion.track import Tracks, least
from robokin.kernel.chain import Chain
from robokin.kernel.native_kernel import native
from robokin.kernel.ranks import ROOT_RANK

NEAR = 0.1
"""Singular value at a point of a curve below which it may vanish before the next: it changes by less on the way."""


SPARE = 7
"""Joints of an arm with one to spare: all six singular values but for those at crossings are above zero."""


def _along(tracks: Tracks, k: Index) -> tuple[Array, Index, Flags]:
    """The least singular value (p,) that is not the tangent's at the points of curves k (p,), the rank of each curve
    (c,), and which are watched."""
    known = [curve.second for curve in tracks.curves]
    if tracks.chain.n == SPARE and all(second is not None for second in known):
        value = np.concatenate([second for second in known if second is not None])
        whole = np.maximum.reduceat(value, tracks.first) > ROOT_RANK
        return value, np.where(whole, SPARE - 1, 1), whole
    _, J = errors(tracks.chain, tracks.T[k], tracks.points, tracks.size)
    sampled = np.linalg.svd(J, compute_uv=False)
    rank = np.maximum.reduceat(np.sum(sampled > ROOT_RANK, axis=1), tracks.first)
    watched = (rank > 0) & ((tracks.chain.n <= 6) | (rank == 6))
    return sampled[np.arange(len(k)), rank[k] - 1], rank, watched


def crossings(curves: Sequence[Curve], chain: Chain, T: Array, size: float) -> tuple[Index, Array]:
    """Configurations (k, n) [rad | m] at which other curves may cross some, with their numbers (k,).

    T: (c, 4, 4) the poses of the curves; an arm has one joint to spare at most.
    """
    chosen = np.array([i for i, one in enumerate(curves) if one.closed and one.dimension == 1], dtype=np.intp)
    nowhere = np.empty(0, dtype=np.intp), np.empty((0, chain.n))
    if not len(chosen):
        return nowhere
    free = np.tile([-np.inf, np.inf], (chain.n, 1))
    tracks = Tracks([curves[i] for i in chosen], chain, T[chosen], free, size)

    k = tracks.of_points
    value, rank, watched = _along(tracks, k)

    def second(k: Index, x: Array) -> Array:
        _, J = errors(chain, tracks.T[k], x, size)
        if native is not None and chain.n == SPARE and np.all(rank[k] == SPARE - 1):
            last: Array = native.least_values(J)
            return last
        return np.asarray(np.linalg.svd(J, compute_uv=False)[np.arange(len(x)), rank[k] - 1])

    # The last point of each curve is the first one again.
    end = tracks.first + tracks.last
    inner = np.setdiff1d(np.arange(len(k)), end)
    before, after = value[inner - 1], value[inner + 1]
    at_first = np.searchsorted(inner, tracks.first)
    before[at_first] = value[end - 1]
    low = inner[(value[inner] <= before) & (value[inner] <= after) & (value[inner] < NEAR) & watched[k[inner]]]
    if not len(low):
        return nowhere
    of, place = np.repeat(k[low], 2), np.repeat((low - tracks.first[k[low]]).astype(np.float64), 2)
    start = place - np.tile([1.0, 0.0], len(low))
    places, lowest = least(tracks, of, start, start + 1.0, lambda _, k, x: second(k, x), NEAR)
    zero = lowest <= ROOT_RANK
    return chosen[of[zero]], tracks.at(of[zero], places[zero]) * tracks.scale
