"""The turns of the triples of an arm with a spherical shoulder and wrist (`swivel_arm`) at a swivel angle.

Statement. Give the joint values of curves (`swivel_curves`) at ψ, or how far these are from something.
Derivation. Of R = Rz(a) K Rz(b) L Rz(c) the entry 33 gives the cosine of b but for a shift; a is how far the entries
13 and 23 are turned from those of K Rz(b) L, and c the same of 31 and 32. All three are angles of complex numbers.
Degenerate case. Where a middle turn is at zero those of its neighbours are any; `swivel_curves` doubts there.
"""

from __future__ import annotations

import numpy as np

from robokin.arrays import Array
from robokin.inverse.self_motion.swivel_arm import SwivelArm, Triples
from robokin.inverse.verify import HALF_TURN
from robokin.kernel.facts import fact
from robokin.spatial.angles import TURN

TRIPLES = np.array([[0, 1, 2], [4, 5, 6]])
"""The joints of the shoulder and of the wrist, from 0."""


def entries_at(entries: Array, psi: Array) -> Array:
    """Entries (5, ...) of triples at ψ (...) by their factors (3, 5, ...) of 1, cos ψ and sin ψ."""
    g = entries[1] * np.cos(psi)
    g += entries[0]
    g += entries[2] * np.sin(psi)
    return np.asarray(g)


def joint_values(arm: SwivelArm, factors: Array, q4: Array, signs: Array, psi: Array) -> Array:
    """(s, 7) [rad] in [-π, π] the joint values at ψ (s,) of curves with factors (3, 5, 2, s), the elbow at q4 (s,).

    signs: (2, s) of the sines of the middle turns.
    """
    amid, side, ends = turning_numbers(entries_at(factors, psi), arm.triples, plain_levers(arm))
    side *= signs
    amid += side
    amid[0::2] *= ends
    q = np.empty((7, len(psi)))
    turns = np.arctan2(amid.imag, amid.real)
    q[:3], q[4:] = turns[:, 0], turns[:, 1]
    np.subtract(q4, arm.chain.offsets[3], out=q[3])
    q[3] -= TURN * np.rint(q[3] / TURN)
    low = q < HALF_TURN - np.pi
    if low.any():
        q[low] += TURN  # -180° is 180°, whatever the last digits say
    return q.T


def turning_numbers(g: Array, triples: Triples, levers: Array) -> tuple[Array, Array, Array]:
    """Complex numbers along the turns (3, ..., 2, K) of triples, but for a factor: what the cosine and what the sine of
    the middle turn add to them, and (2, ..., 2, K) what the first and the last are to be multiplied by.

    g: (5, ..., 2, K) the entries 13, 23, 33, 31, 32 of the triples; levers: (3, 3, 2, 1) by `turning_levers`. The sine
    is the one that is not negative; of the other sign, what it adds has the other sign.
    """
    x = g[2] - triples.k[:, None]
    x /= triples.r[:, None]
    np.minimum(x, 1.0, out=x)
    np.maximum(x, -1.0, out=x)
    y = 1.0 - x
    y *= 1.0 + x
    np.sqrt(y, out=y)
    if x.ndim > 2:
        levers = levers.reshape(3, 3, *[1] * (x.ndim - 2), 2, 1)
    still, along, across = levers
    amid = along * x
    amid += still
    ends = np.empty((2, *x.shape), dtype=complex)
    ends.real, ends[0].imag = g[0::3], g[1]
    np.negative(g[4], out=ends[1].imag)
    return amid, across * y, ends


def turning_levers(triples: Triples, back: Array) -> Array:
    """The factors (3, 3, 2, 1) of 1, and of the cosine and sine of b counted from phi, in the turns of
    `turning_numbers`, turned back by angles (3, 2) [rad], by turn and triple."""
    first, last = np.conj(triples.u[0] + 1j * triples.u[1]), triples.v[0] + 1j * triples.v[1]
    amid = np.broadcast_to(np.array([[0.0], [1.0], [1j]]), (3, 2))
    c, s = triples.cos_phi, triples.sin_phi
    levers = [[lever[0], lever[1] * c + lever[2] * s, lever[2] * c - lever[1] * s] for lever in (first, amid, last)]
    return np.asarray((np.array(levers).swapaxes(0, 1) * np.exp(-1j * back))[..., None])


@fact
def plain_levers(arm: SwivelArm) -> Array:
    """The same for the joint values of an arm."""
    return turning_levers(arm.triples, arm.chain.offsets[TRIPLES].T)
