"""How far the tool's origin comes: along the world's axes, and from the base.

Each of the eight questions is the least value over the joint box of

    f(p(q)) = g · p + w/2 |p - c|²,

with w = 0 for a bound along ±g, and g = 0, w = ±1 for the least and the greatest distance from c. Three stages:

1. Starts: the best configurations of several parts of an even sequence, so that they are good and far apart; as many
   of which some joints are at limits, as they are at extremes; and the best corners of the joint box.
2. Sweeps: one joint after the other is given its best value, the others being held. That is exact: with a joint's
   axis at o, along z of R, and s what follows it, p = o + R Rot(z, θ) s, so that with h = Rᵀ(g + w (o - c))

       f = h · Rot(z, θ) s + constant = A cos θ + B sin θ + constant,

   least at one angle, or at a limit; a sliding joint makes it a parabola. A whole sweep costs no more than one forward
   kinematics, ends at the limits exactly, and leaps over the hills between the valleys of one joint.
3. Newton's method with the exact Hessian, in a region of trust (trusted_steps.py), on the joints that are not held by
   a limit: to rounding. With J's column i ∂p/∂q_i and i ≤ j, ∂²p/∂q_i∂q_j = z_i × J_j, and 0 where joint i slides.

The sweeps are coordinate descent, whose limit points are stationary (D. P. Bertsekas, Nonlinear Programming, 2nd ed.
1999, prop. 2.7.1).
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.kernel.chain import Chain
from robokin.kernel.damped_newton import held_at
from robokin.kernel.facts import fact
from robokin.spatial.angles import TURN
from robokin.workspace.geared_extremes import geared_best
from robokin.workspace.goals import Goals, derivatives
from robokin.workspace.sampling import joint_values, moving_chain, positions
from robokin.workspace.sizes import Extent
from robokin.workspace.space import Space
from robokin.workspace.trusted_steps import Freed, polished

SAMPLES = 1 << 14
"""Configurations that starts are chosen from."""

STARTS = 32
"""Starts for each question: the best of every 32nd configuration."""

EDGES = 1 << 12
"""Further configurations with some joints at limits, from which as many starts come."""

ON_EDGE = 0.4
"""Chance that a joint is at one of its limits in these."""

MOST_CORNERS, CORNERS = 1 << 10, 16
"""Corners of the joint box that are looked at, and starts for each question that are the best of them."""

SWEEPS = 12
"""Times that each joint is given its best value: the valleys of these functions are not long."""

POLISHED = 16
"""Ends of the sweeps, for each question, that Newton's method goes on from."""

STEPS = 60
"""Newton steps at most: some five are needed near a regular extreme, more at a limit or on a flat one."""

NOTHING = 1e-15
"""An amplitude [size²] of A cos θ + B sin θ that is rounding: the angle stays what it is."""


@dataclass(frozen=True, eq=False)
class _Box:
    """The joints that move the origin, lengths in the arm's size: low, high, full (n,)."""

    chain: Chain
    low: Array
    high: Array
    full: Flags


def extent(space: Space, seed: int = 0) -> Extent:
    """The bounds of the reachable set along the world's axes, its least and greatest distance from the base's origin.

    Each is the best of several local extremes, found to 1e-12 of the arm's size; that a better one is far from
    every start is not proven, only unlikely. Joints that do not move the origin are in the middle of their range.
    """
    return _extent(space, seed)


@fact
def _extent(space: Space, seed: int) -> Extent:
    origin = space.robot.base[:3, 3].copy()
    q = np.tile(0.5 * (space.low + space.high), (8, 1))
    if space.moving:
        goals = _eight(origin / space.size)
        q[:, list(space.moving)] = (
            _best(space, goals, seed) if space.gears is None else geared_best(space, goals, SAMPLES, seed)
        )
    p = positions(space, q.T).T
    distances = np.linalg.norm(p - origin, axis=1)
    return Extent(
        low=p[[0, 1, 2], [0, 1, 2]],
        high=p[[3, 4, 5], [0, 1, 2]],
        least=float(distances[6]),
        greatest=float(distances[7]),
        origin=origin,
        q_low=q[:3],
        q_high=q[3:6],
        q_least=q[6],
        q_greatest=q[7],
    )


def outermost(space: Space, directions: Array, sweeps: int, seed: int = 0) -> Array:
    """(n, m) values [rad | m] of the moving joints that put the origin far out along each of `directions` (m, 3)."""
    box = _scaled(space)
    unit = np.where(box.chain.revolute, 1.0, space.size)
    count = len(directions)
    q = joint_values(space, "sobol", seed, 0, count, count).T[:, list(space.moving)] / unit
    goals = Goals(-directions, np.zeros(count), np.zeros(3))
    for _ in range(sweeps):
        _sweep(box, goals, q)
    values = q * unit
    low, high, full = (whole[list(space.moving)] for whole in (space.low, space.high, space.full))
    return np.asarray(np.where(full, low + np.mod(values - low, TURN), np.clip(values, low, high)).T)


def _eight(origin: Array) -> Goals:
    """Low and high along the axes, least and greatest distance from an origin (3,) [size]."""
    g = np.concatenate([np.eye(3), -np.eye(3), np.zeros((2, 3))])
    return Goals(g, np.array([0.0] * 6 + [1.0, -1.0]), origin)


def _best(space: Space, eight: Goals, seed: int) -> Array:
    """The best values (8, n) [rad | m] of the moving joints for low and high, least and greatest."""
    box = _scaled(space)
    unit = np.where(box.chain.revolute, 1.0, space.size)

    samples = np.concatenate([joint_values(space, "sobol", seed, 0, SAMPLES, SAMPLES), _at_limits(space, seed)], axis=1)
    p = positions(space, samples).T / space.size
    starts = []
    for k in range(8):
        f = eight.taken(np.full(len(p), k)).values(p)
        for first, last in pairwise((0, SAMPLES, SAMPLES + EDGES)):
            starts.append(first + np.argmin(f[first:last].reshape(-1, STARTS), axis=0) * STARTS + np.arange(STARTS))
        starts.append(SAMPLES + EDGES + np.argsort(f[SAMPLES + EDGES :], kind="stable")[:CORNERS])
    each = 2 * STARTS + len(starts[-1])
    q = samples.T[np.concatenate(starts)][:, list(space.moving)] / unit
    goals = eight.taken(np.repeat(np.arange(8), each))

    for _ in range(SWEEPS):
        f = _sweep(box, goals, q)
    order = np.argsort(f.reshape(8, each), axis=1, kind="stable")[:, :POLISHED]
    chosen = (order + each * np.arange(8)[:, None]).ravel()
    q, goals = q[chosen], goals.taken(chosen)
    q, f = _polish(box, goals, q)
    best: Array = q[np.argmin(f.reshape(8, POLISHED), axis=1) + POLISHED * np.arange(8)] * unit
    low, high, full = (whole[list(space.moving)] for whole in (space.low, space.high, space.full))
    return np.where(full, low + np.mod(best - low, TURN), np.clip(best, low, high))


def _at_limits(space: Space, seed: int) -> Array:
    """(n, EDGES + c) configurations with some of the moving joints at limits, then c corners of their box."""
    moving = list(space.moving)
    rng = np.random.default_rng((seed, 0xC0E5))
    part, drawn = rng.random((2, len(moving), EDGES))
    part = np.where(drawn < 0.5 * ON_EDGE, 0.0, np.where(drawn < ON_EDGE, 1.0, part))
    k = len(moving)
    count = min(1 << k, MOST_CORNERS)
    which = np.arange(count) if count == 1 << k else rng.integers(0, 1 << min(k, 62), count)
    corners = (which >> np.arange(k)[:, None]) & 1
    q = np.tile(0.5 * (space.low + space.high)[:, None], (1, EDGES + count))
    width = (space.high - space.low)[moving, None]
    q[moving] = space.low[moving, None] + width * np.concatenate([part, corners], axis=1)
    return q


def _scaled(space: Space) -> _Box:
    """The moving joints with lengths in the arm's size."""
    chain, moving = moving_chain(space), list(space.moving)
    constants = chain.constants.copy()
    constants[:, :3, 3] /= space.size
    unit = np.where(chain.revolute, 1.0, space.size)
    scaled = Chain(constants, chain.revolute, chain.offsets / unit)
    return _Box(scaled, space.low[moving] / unit, space.high[moving] / unit, space.full[moving])


def _sweep(box: _Box, goals: Goals, q: Array) -> Array:
    """Give each joint in turn its best value, in place, in q: (m, n); the functions' values (m,) before the sweep."""
    chain = box.chain
    # What follows each joint, at the values it will have when the joint's turn comes.
    after = np.empty((chain.n + 1, len(q), 3))
    after[chain.n] = chain.constants[chain.n, :3, 3]
    for i in range(chain.n - 1, -1, -1):
        C = chain.constants[i]
        after[i] = _moved(chain, i, q[:, i], after[i + 1]) @ C[:3, :3].T + C[:3, 3]
    R, o = np.broadcast_to(chain.constants[0, :3, :3], (len(q), 3, 3)), chain.constants[0, :3, 3][None]
    for i in range(chain.n):
        s = after[i + 1]
        h = np.einsum("mji,mj->mi", R, goals.slopes(o))
        q[:, i] = _best_angle(box, i, q[:, i], h, s) if chain.revolute[i] else _best_length(box, i, goals.w, h, s)
        C = chain.constants[i + 1]
        o = o + np.einsum("mij,mj->mi", R, _moved(chain, i, q[:, i], C[:3, 3]))
        R = R @ _moved(chain, i, q[:, i], C[:3, :3].T, turn=True).swapaxes(1, 2)
    return goals.values(after[0])


def _moved(chain: Chain, i: int, values: Array, vectors: Array, turn: bool = False) -> Array:
    """J_i(values (m,)) of points (m, 3) or (3,); with `turn`, of the three directions (3, 3) in rows: (m, 3, 3)."""
    v = np.broadcast_to(vectors, (len(values), 3, 3) if turn else (len(values), 3)).copy()
    values = (values + chain.offsets[i]).reshape(-1, *(1,) * turn)
    if not chain.revolute[i]:
        if not turn:
            v[..., 2] += values
        return v
    c, s = np.cos(values), np.sin(values)
    x, y = v[..., 0].copy(), v[..., 1].copy()
    v[..., 0] = c * x - s * y
    v[..., 1] = s * x + c * y
    return v


def _best_angle(box: _Box, i: int, now: Array, h: Array, s: Array) -> Array:
    """The value (m,) of joint i, now (m,), that makes h · Rot(z, θ) s least."""
    A = h[:, 0] * s[:, 0] + h[:, 1] * s[:, 1]
    B = h[:, 1] * s[:, 0] - h[:, 0] * s[:, 1]
    low, high, offset = box.low[i], box.high[i], box.chain.offsets[i]
    best = low + np.mod(np.arctan2(-B, -A) - offset - low, TURN)
    if not box.full[i]:
        at_low, at_high = (A * np.cos(end + offset) + B * np.sin(end + offset) for end in (low, high))
        best = np.where(best <= high, best, np.where(at_low <= at_high, low, high))
    return np.where(np.hypot(A, B) > NOTHING, best, now)


def _best_length(box: _Box, i: int, w: Array, h: Array, s: Array) -> Array:
    """The value (m,) of joint i that makes a d + w d²/2 least, d with its offset."""
    low, high, offset = box.low[i], box.high[i], box.chain.offsets[i]
    a = h[:, 2] + w * s[:, 2]
    at_low, at_high = (a * (end + offset) + 0.5 * w * (end + offset) ** 2 for end in (low, high))
    best: Array = np.where(w > 0, np.clip(-a - offset, low, high), np.where(at_low <= at_high, low, high))
    return best


def _polish(box: _Box, goals: Goals, q: Array) -> tuple[Array, Array]:
    """Newton's method from q: (m, n): where it ends, and the functions' values (m,) there."""

    def derived(rows: Index, x: Array) -> tuple[Array, Array, Array]:
        some = goals.taken(rows)
        p, gradient, H = derivatives(box.chain, some, x)
        return some.values(p), gradient, H

    def free(x: Array, gradient: Array, H: Array) -> Freed:
        held = ~box.full & held_at(x, box.low, box.high, -gradient)
        one = np.eye(x.shape[1])
        # In what is known there, so that shorter steps from the same place leave these joints alone, too.
        np.copyto(H, one, where=held[:, :, None] | held[:, None, :])
        np.copyto(gradient, 0.0, where=held)
        return Freed(gradient, H, np.where(held[:, :, None], 0.0, one), held)

    return polished(derived, free, lambda x, step, _: _inside(box, x, step), q, STEPS)


def _inside(box: _Box, q: Array, step: Array) -> Array:
    """q + step as far as the first limit on the way."""
    with np.errstate(divide="ignore", invalid="ignore"):
        to_limit = np.where(step < 0, box.low - q, box.high - q) / step
    to_limit = np.where(box.full | (step == 0.0), np.inf, np.maximum(to_limit, 0.0))
    share = np.minimum(np.min(to_limit, axis=1, keepdims=True), 1.0)
    moved = q + share * step
    # Whoever gets to a limit is exactly there.
    limit = np.where(step < 0, box.low, box.high)
    moved = np.where(to_limit <= share, limit, moved)
    return np.where(box.full, moved, np.clip(moved, box.low, box.high))
