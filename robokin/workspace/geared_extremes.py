"""How far the tool's origin comes where joints hang on each other: extremes over a box of variables with cuts.

The same functions as in extremes.py. Starts are the best of an even sequence, of its like with variables at limits, and
of corners. One variable after the other is then tried at values all over the range that the others leave it, and
Newton's method with the exact Hessian goes on, in a region of trust (trusted_steps.py): on the plane of the limits that
stand in the way, box and cuts alike, whose normals are projected out of slope and Hessian, and no step goes beyond the
first limit in its way (J. Nocedal and S. J. Wright, Numerical Optimization, 2nd ed. 2006, sections 16.5 and 16.7).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.kernel.chain import Chain
from robokin.kernel.frames import frames
from robokin.spatial.angles import TURN
from robokin.workspace.geared_starts import spread_to_limits
from robokin.workspace.goals import Goals, derivatives
from robokin.workspace.half_spaces import HalfSpaces
from robokin.workspace.sampling import moving_chain, moving_cuts, moving_gears
from robokin.workspace.space import Space
from robokin.workspace.trusted_steps import STILL, Freed, polished

STARTS = 32
"""Starts for each function from the inside, and as many from the limits."""

SWEEPS, TRIED = 3, 33
"""Times that each variable is tried all over its range, and at how many values."""

STEPS = 80
"""Newton steps at most."""

TOUCHING = 1e-12
"""Room to a limit [rad | size] that is none."""


@dataclass(frozen=True, eq=False)
class _Geared:
    """The moving variables, lengths in the arm's size: S (m, n) to the chain's joints, the box (n,), (n,), the cuts of
    it, and all limits but those of whole turns as half spaces."""

    chain: Chain
    S: Array
    low: Array
    high: Array
    full: Flags
    cuts: HalfSpaces
    limits: HalfSpaces


def geared_best(space: Space, goals: Goals, samples: int, seed: int = 0) -> Array:
    """The values (k, n) [rad | m] of the moving variables at which each of k functions is least, as far as found."""
    geared = _scaled(space)
    unit = np.where(space.robot.revolute[list(space.moving)], 1.0, space.size)
    k, n = len(goals.w), len(unit)
    inside = geared.cuts.filled(np.random.default_rng((seed, 0x1D5E)).random((n, samples)), geared.low, geared.high)
    outer = spread_to_limits(geared.cuts, geared.low, geared.high, samples, 7, seed)
    q = np.concatenate([inside, outer], axis=1).T
    p = _places(geared, q)
    starts = []
    for i in range(k):
        f = goals.taken(np.full(len(p), i)).values(p)
        for first, last in pairwise((0, samples, 2 * samples)):
            # The best of every so many, so that they are far apart.
            apart = min(STARTS, samples)
            part = f[first : first + (last - first) // apart * apart].reshape(-1, apart)
            starts.append(first + np.argmin(part, axis=0) * apart + np.arange(apart))
    each = 2 * min(STARTS, samples)
    q = q[np.concatenate(starts)].copy()
    goals = goals.taken(np.repeat(np.arange(k), each))
    for _ in range(SWEEPS):
        _try_all_over(geared, goals, q)
    q, f = _polished(geared, goals, q)
    best = q[np.argmin(f.reshape(k, each), axis=1) + each * np.arange(k)]
    # Within the limits to the last digit.
    best = np.where(geared.full, geared.low + np.mod(best - geared.low, TURN), np.clip(best, geared.low, geared.high))
    return np.asarray(best * unit)


def _scaled(space: Space) -> _Geared:
    moving, size = list(space.moving), space.size
    chain, cuts = moving_chain(space), moving_cuts(space)
    unit = np.where(space.robot.revolute[moving], 1.0, size)
    own = np.where(chain.revolute, 1.0, size)
    constants = chain.constants.copy()
    constants[:, :3, 3] /= size
    low, high, full = space.low[moving] / unit, space.high[moving] / unit, space.full[moving]
    cuts = HalfSpaces.of(cuts.G * unit, cuts.h)
    box = HalfSpaces.box(np.where(full, -np.inf, low), np.where(full, np.inf, high))
    S = moving_gears(space) * unit / own[:, None]
    return _Geared(
        Chain(constants, chain.revolute, chain.offsets / own), S, low, high, full, cuts, box.joined(cuts)
    )  # fmt: skip


def _places(geared: _Geared, q: Array) -> Array:
    """(m, 3) [size] where q (m, n) put the tool's origin."""
    return np.asarray(frames(geared.chain, q @ geared.S.T)[:, -1, :3, 3])


def _try_all_over(geared: _Geared, goals: Goals, q: Array) -> None:
    """Give each variable in turn the best of values all over its range, in place, in q: (m, n)."""
    m = len(q)
    for j in range(q.shape[1]):
        low, high = geared.cuts.joined(HalfSpaces.box(geared.low, geared.high)).ranges(j, q.T)
        part = np.linspace(0.0, 1.0, TRIED)
        tried = np.repeat(q[None], TRIED + 1, axis=0)
        tried[:TRIED, :, j] = low + part[:, None] * np.maximum(high - low, 0.0)
        p = _places(geared, tried.reshape(-1, q.shape[1]))
        f = goals.taken(np.tile(np.arange(m), TRIED + 1)).values(p).reshape(TRIED + 1, m)
        q[:] = tried[np.argmin(f, axis=0), np.arange(m)]


def _polished(geared: _Geared, goals: Goals, q: Array) -> tuple[Array, Array]:
    """Newton's method from q: (m, n): where it ends, and the functions' values (m,) there."""

    def derived(rows: Index, x: Array) -> tuple[Array, Array, Array]:
        return _derivatives(geared, goals.taken(rows), x)

    def free(x: Array, slope: Array, H: Array) -> Freed:
        P, held = _free_plane(geared, x, slope)
        flat = P @ H @ P
        return Freed(np.einsum("mij,mj->mi", P, slope), 0.5 * (flat + flat.swapaxes(1, 2)), P, held)

    return polished(derived, free, partial(_stopped, geared), q, STEPS)


def _free_plane(geared: _Geared, q: Array, slope: Array) -> tuple[Array, Flags]:
    """(m, n, n) the projection of steps on what the limits leave that stand in the way down at q (m, n), and which
    limits they are (m, c)."""
    G, h = geared.limits.G, geared.limits.h
    near = q @ G.T >= h - TOUCHING
    held = np.zeros_like(near)
    P = np.tile(np.eye(q.shape[1]), (len(q), 1, 1))
    for _ in range(q.shape[1] + 1):
        down = -np.einsum("mij,mj->mi", P, slope)
        pushed = near & ~held & (down @ G.T > STILL)
        if not pushed.any():
            break
        # One at a time: what the first takes off may be what the others stand in the way of.
        first = np.argmax(np.where(pushed, down @ G.T, -np.inf), axis=1)
        rows = np.flatnonzero(pushed.any(axis=1))
        held[rows, first[rows]] = True
        N = np.where(held[rows][:, :, None], G, 0.0)
        P[rows] = np.eye(q.shape[1]) - np.linalg.pinv(N, rcond=1e-10) @ N
    return P, held


def _stopped(geared: _Geared, q: Array, step: Array, held: Flags) -> Array:
    """q + step as far as the first limit on the way that is not held."""
    G, h = geared.limits.G, geared.limits.h
    toward = step @ G.T
    with np.errstate(divide="ignore", invalid="ignore"):
        # What goes across a limit by no more than rounding is not stopped by it, as along one without a slope across.
        share = np.where((toward > STILL) & ~held, np.maximum(h - q @ G.T, 0.0) / toward, np.inf)
    moved = q + np.minimum(np.min(share, axis=1, initial=np.inf), 1.0)[:, None] * step
    return np.asarray(np.where(geared.full, moved, np.clip(moved, geared.low, geared.high)))


def _derivatives(geared: _Geared, goals: Goals, q: Array) -> tuple[Array, Array, Array]:
    """The functions (m,), their gradients (m, n) and Hessians (m, n, n) at q: (m, n)."""
    p, slope, H = derivatives(geared.chain, goals, q @ geared.S.T)
    return goals.values(p), slope @ geared.S, geared.S.T @ H @ geared.S
