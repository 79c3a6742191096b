"""The way down to the nearest orientation along the configurations that have the position.

Statement. From configurations within the limits that have the target's position go down to a local minimum of the angle
that is left, the position kept.
Derivation. 1 - cos θ is to be least subject to c(x) = p - t = 0 and to the limits. With the multipliers λ that make the
slope r = ∇(1 - cos θ) + Jᵀ λ shortest, J = ∂p/∂x, a Newton step of the Lagrangian within the null space of J is taken,
and Newton's steps of the position lead back to it (J. Nocedal, S. J. Wright, "Numerical Optimization", 2nd ed., 2006,
sections 15.3 and 18.1). The Lagrangian's curvature is that of ½ |p - t'|² + 1 - cos θ with the target put to
t' = p - λ (`second_order`), which differs by JᵀJ only, nothing within the null space. Penalties (`position_first`) see
a curved valley there and go a few thousandths of a radian at a time: an elbow's circle is longer.
Degenerate case. Directions of negative curvature are gone down like those of positive one; a step that does not turn
less is halved. Where J has lost rank its zero directions are left to the null space.
"""

from __future__ import annotations

import numpy as np

from robokin.arrays import Array, Index
from robokin.inverse.numeric.position_first import DescentEnds, Ways
from robokin.inverse.numeric.second_order import offsets, place_jacobian, slope
from robokin.kernel.damped_newton import Judged, Known, Trial, held_at, led_down, limited
from robokin.kernel.native_kernel import handle, native
from robokin.kernel.ranks import RANK

HAS_POSITION = 1e-11
"""Distance [size] up to which a configuration has the position."""

STEPS = 25
"""Newton steps at most."""

LONGEST = 0.3
"""The longest step of a joint [rad | size]."""

SHORTEST = 1e-9
"""A step [rad | size] that ends the way."""

BACK = 3
"""Newton's steps back to the position after each."""

FLAT = 1e-9
"""Least curvature that a step is divided by."""


def turned_in_place(ways: Ways, T: Array, ends: DescentEnds) -> DescentEnds:
    """The ends (n, s), those that have the position of their targets T: (4, 3, s) [m] as little turned as can be."""
    chosen = np.flatnonzero((ends.distance <= HAS_POSITION) & (ends.angle > 0.0))
    if not len(chosen):
        return ends
    box = (np.broadcast_to(bound, ends.x.shape)[:, chosen] for bound in (ways.low, ways.high))
    some = Ways(ways.chain, ways.size, *box)
    known = handle(ways.chain)
    if native is None or known is None or ways.chain.n > native.most_moved:
        x, place, turn = turned_by_columns(some, T[..., chosen], ends.x[:, chosen])
    else:
        targets, start = T[..., chosen].reshape(12, -1).T, ends.x[:, chosen].T
        x, parts = native.turned(known, targets, start, ways.size, some.low.T, some.high.T, STEPS)
        x, place, turn = x.T, np.sqrt(2.0 * parts[:, 0]), parts[:, 1]
    out = DescentEnds(ends.x.copy(), ends.distance.copy(), ends.angle.copy())
    out.x[:, chosen], out.distance[chosen] = x, place
    out.angle[chosen] = 2.0 * np.arcsin(np.sqrt(np.minimum(0.5 * turn, 1.0)))
    return out


def turned_by_columns(ways: Ways, T: Array, x: Array) -> tuple[Array, ...]:
    """In Python where x (n, s) comes to, the distances there [size] and 1 - cos θ, each (s,); limits (n, s) in ways."""
    low, high = ways.low, ways.high

    def look(rows: Index, x: Array) -> Known:
        here = slope(ways.chain, T[..., rows], x, ways.size, np.ones(len(rows)))
        return np.sqrt(2.0 * here.place), here.turn

    def step(rows: Index, x: Array, here: Known, trust: Known) -> Trial:
        target, *box = T[..., rows], low[:, rows], high[:, rows]
        dx = _step(ways, target, x, *box) * trust[0]
        return Trial(_back(ways, target, x + dx, *box), trust, np.max(np.abs(dx), axis=0) > SHORTEST)

    def judge(x: Array, here: Known, there: Known, trial: Trial) -> Judged:
        less = (there[0] <= np.maximum(here[0], HAS_POSITION)) & (there[1] < here[1])
        return Judged(less, (np.where(less, np.minimum(2.0 * trial.trust[0], 1.0), 0.25 * trial.trust[0]),))

    return led_down(look, step, judge, x, (np.ones(x.shape[1]),), steps=STEPS, told=2, axis=-1)


def _step(ways: Ways, T: Array, x: Array, low: Array, high: Array) -> Array:
    """The Newton step (n, s) within the null space of the position's Jacobian."""
    chain, size = ways.chain, ways.size
    one = np.ones(x.shape[1])
    J = place_jacobian(chain, x, size).transpose(2, 1, 0)
    e = offsets(chain, T, x, size).T
    g = slope(chain, T, x, size, one).gradient.T - np.einsum("sij,si->sj", J, e)
    at_low, at_high = (x <= low).T, (x >= high).T
    held = at_low | at_high
    for _ in range(2):
        multiplier, null = _null(np.where(held[:, None], 0.0, J), g)
        r = g + np.einsum("sij,si->sj", J, multiplier)
        held = (at_low & (r > 0.0)) | (at_high & (r < 0.0))
    multiplier, null = _null(np.where(held[:, None], 0.0, J), g)
    null = np.where(held[:, :, None] | held[:, None], 0.0, null)
    shifted = T.copy()
    shifted[3] += size * (e - multiplier).T
    here = slope(chain, shifted, x, size, one)
    H = null @ here.hessian.transpose(2, 0, 1) @ null
    curvature, V = np.linalg.eigh(H)
    slopes = np.einsum("sij,si->sj", V, np.einsum("sij,sj->si", null, here.gradient.T))
    along = np.where(np.abs(slopes) > 0.0, -slopes / np.maximum(np.abs(curvature), FLAT), 0.0)
    step = np.einsum("sij,sj->si", V, along)
    return limited(step, LONGEST).T


def _null(J: Array, g: Array) -> tuple[Array, Array]:
    """The multipliers (s, 3) with which g + Jᵀ λ is shortest, and the projections (s, n, n) on the null spaces of J."""
    U, values, Vt = np.linalg.svd(J, full_matrices=False)
    rank = values > RANK
    inverse = np.where(rank, 1.0 / np.where(rank, values, 1.0), 0.0)
    multiplier = -np.einsum("sij,sj->si", U, inverse * np.einsum("sij,sj->si", Vt, g))
    rows = Vt * rank[:, :, None]
    return multiplier, np.eye(J.shape[2]) - np.swapaxes(rows, 1, 2) @ rows


def _back(ways: Ways, T: Array, x: Array, low: Array, high: Array) -> Array:
    """x (n, s) led back to the position within the limits."""
    x = np.clip(x, low, high)
    for _ in range(BACK):
        e = offsets(ways.chain, T, x, ways.size).T
        J = place_jacobian(ways.chain, x, ways.size).transpose(2, 1, 0)
        uphill = np.einsum("sij,si->sj", J, e)
        held = held_at(x, low, high, -uphill.T).T
        U, values, Vt = np.linalg.svd(np.where(held[:, None], 0.0, J), full_matrices=False)
        rank = values > RANK
        along = np.einsum("sij,si->sj", U, e) * np.where(rank, 1.0 / np.where(rank, values, 1.0), 0.0)
        x = np.clip(x - np.einsum("sij,si->sj", Vt, along).T, low, high)
    return np.asarray(x)
