"""Which member stands for a self-motion: the nearest one to a wish within the joint limits, or any where none is.

Without a wish the member of a wrist's self-motion is the one with its first joint at rest.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array
from robokin.inverse.closed_form.spherical_wrist import SphericalTriple
from robokin.inverse.self_motion.curve_tracing import Curve
from robokin.inverse.self_motion.nearest_member import members_near, nearest_on_each
from robokin.inverse.verify import CLOSES, within_limits
from robokin.kernel.chain import Chain
from robokin.kernel.residual import distance_and_angle, error_and_jacobian
from robokin.spatial.angles import TURN, circled


@dataclass(frozen=True, eq=False)
class SelfMotion:
    """A self-motion of a target, and the member q (n,) [rad | m] that stands for it."""

    curve: Curve
    q: Array


def _wrist_held(chain: Chain, first: int, curve: Curve, q: Array, limits: Array, rest: Array) -> Array | None:
    """The member (n,) of a straight wrist's self-motion with its first joint at rest and the last with what is left.

    The two move as little from there as brings the last one into its limits. None where the curve is another one, or
    this member is outside the limits.
    """
    last = first + 2
    if set(curve.joints) != {first + 1, last + 1} or curve.sheets:
        return None
    t = curve.tangents[0]
    sign = 1 if t[last] * t[first] < 0.0 else -1
    held = q.copy()
    held[last] += sign * (q[first] - rest[first])
    held[first] = rest[first]
    held = _into_limits(held[None], first, sign, limits)
    return np.asarray(held[0]) if within_limits(held, chain.revolute, limits, None)[1][0] else None


def _into_limits(q: Array, first: int, sign: int, limits: Array) -> Array:
    """Configurations moved along the family as little as brings the wrist's last joint into its limits (2,)."""
    last = first + 2
    low, high = limits[last]
    value = circled(q[:, last])
    if np.isinf(low) or np.isinf(high):
        return q
    fits = np.floor((high - value) / TURN) >= np.ceil((low - value) / TURN)
    ends = circled(np.stack([low - value, high - value]))
    shift = np.where(fits, 0.0, ends[np.argmin(np.abs(ends), axis=0), np.arange(len(q))])
    q = q.copy()
    q[:, last] += shift
    q[:, first] -= sign * shift
    return q


def standing_for(
    chain: Chain,
    solver: object,
    T: Array,
    curves: list[Curve],
    known: Array,
    size: float,
    limits: Array,
    rest: Array,
    near: Array | None,
) -> Array:
    """The members (k, n) of sets at T (k, 4, 4) that stand for them, of each of which one (k, n) is known."""
    chosen: list[Array | None] = [None] * len(curves)
    wish = rest if near is None else near
    if near is None and isinstance(solver, SphericalTriple):
        for k, curve in enumerate(curves):
            chosen[k] = _wrist_held(chain, solver.first, curve, known[k], limits, rest)
        chosen = _closing(chain, T, chosen, size)
    anywhere = np.tile([-np.inf, np.inf], (chain.n, 1))
    for ask, within in ((members_near if near is None else nearest_on_each, limits), (members_near, anywhere)):
        open_ = [k for k, member in enumerate(chosen) if member is None]
        if open_:
            found = ask([curves[k] for k in open_], chain, T[open_], wish, within, size)
            for k, member in zip(open_, found, strict=True):
                chosen[k] = member
    # Of a set that the target only nearly has, what was found is nearer to it than what was followed.
    members = [known[k] if one is None else one for k, one in enumerate(_closing(chain, T, chosen, size))]
    return np.array(members).reshape(-1, chain.n)


def _closing(chain: Chain, T: Array, members: list[Array | None], size: float) -> list[Array | None]:
    """Those configurations (n,) that reach their T (k, 4, 4) as nearly as a solution must, None for the others."""
    given = [k for k, member in enumerate(members) if member is not None]
    q = np.array([members[k] for k in given]).reshape(-1, chain.n)
    error, _ = error_and_jacobian(chain, T[given], q, size)
    off = np.maximum(*distance_and_angle(error))
    out: list[Array | None] = [None] * len(members)
    for k, member, left in zip(given, q, off.tolist(), strict=True):
        out[k] = member if left <= CLOSES else None
    return out
