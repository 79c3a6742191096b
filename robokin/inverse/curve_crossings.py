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

import numpy as np
from numpy.typing import NDArray

from robokin.inverse.curve_tracing import Curve
from robokin.inverse.null_motion import ZERO, errors
from robokin.inverse.track import Track, least
from robokin.kinematics.chain import Chain

Array = NDArray[np.float64]

NEAR = 0.1
"""Singular value at a point of a curve below which it may vanish before the next: it changes by less on the way."""


def crossings(curves: list[Curve], chain: Chain, T: Array, size: float) -> Array:
    """Configurations (k, n) [rad | m] at which other curves at T (4, 4) may cross these; an arm has one joint to spare
    at most."""
    free = np.tile([-np.inf, np.inf], (chain.n, 1))
    found = [_on(Track(curve, chain, T, free, size)) for curve in curves if curve.closed and curve.dimension == 1]
    return np.concatenate([np.empty((0, chain.n)), *found])


def _on(track: Track) -> Array:
    """The crossings (k, n) [rad | m] on one closed curve."""

    def values(x: Array) -> Array:
        _, J = errors(track.chain, np.broadcast_to(track.T, (len(x), 4, 4)), x, track.size)
        return np.asarray(np.linalg.svd(J, compute_uv=False))

    sampled = values(track.points[:-1])
    rank = int(np.max(np.sum(sampled > ZERO, axis=1)))
    if rank == 0 or (track.chain.n > 6 and rank < 6):
        return np.empty((0, track.chain.n))

    def second(x: Array) -> Array:
        return np.asarray(values(x)[:, rank - 1])

    value = sampled[:, rank - 1]
    low = np.flatnonzero((value <= np.roll(value, 1)) & (value <= np.roll(value, -1)) & (value < NEAR))
    ends = np.stack([low - 1.0, low, low, low + 1.0], axis=1).reshape(-1, 2)
    if not len(ends):
        return np.empty((0, track.chain.n))
    places, _ = least(track, ends[:, 0], ends[:, 1], second)
    x = track.at(places)
    return np.asarray(x[second(x) <= ZERO] * track.scale)
