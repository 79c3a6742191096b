"""Numeric answers: solutions where no solver applies, the nearest configuration where there is none, self-motions."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robokin.inverse.analysis import Analysis
from robokin.inverse.numeric import descend, error_and_jacobian
from robokin.inverse.verify import CLOSES, Found, nothing
from robokin.kinematics.chain import Chain

Array = NDArray[np.float64]

STARTS = 64
"""Starts of a search for one target; PUMA's and Panda's poses are met from 8 of them in 99.95 % of the cases."""

FINALISTS = 8
"""Of these the search goes on with the best, more carefully."""

DRAWN = 2048
"""Configurations drawn to choose the starts from."""

ORIENTATION = 1e-3
"""Weight of a radian against an arm's size where the position comes first."""

SINGULAR = 1e-6
"""Least singular value of the Jacobian (lengths in sizes) below which a configuration is singular."""

TRADES = 4
"""Steps of a walk along a suspected self-motion, each way."""

TRADE = 0.05
"""How far joints are moved along a suspected self-motion [rad | size]: far enough that the curvature of a mere
singularity shows (1e-3), near enough to come back to the curve by a few Newton steps."""


def starts(chain: Chain, limits: Array, size: float, count: int, seed: int) -> Array:
    """Random configurations (count, n) within the limits, or a turn and two arm's sizes where there are none."""
    reach = np.where(chain.revolute, np.pi, size)
    low = np.where(np.isinf(limits[:, 0]), -reach, limits[:, 0])
    high = np.where(np.isinf(limits[:, 1]), reach, limits[:, 1])
    return low + (high - low) * np.random.default_rng(seed).random((count, chain.n))


def numeric_solutions(analysis: Analysis, T: Array, limits: Array, seed: int, count: int = STARTS) -> Found:
    """Solutions found by descending from random starts for targets T: (m, 4, 4), with all their duplicates."""
    chain, own = analysis.chain, analysis.chain.n - analysis.open
    wide = np.concatenate([limits, np.tile([-np.inf, np.inf], (analysis.open, 1))])
    drawn = starts(chain, wide, analysis.size, DRAWN, seed)
    parts = nothing(own)
    for i, target in enumerate(T):
        many = np.broadcast_to(target, (DRAWN, 4, 4))
        error, _ = error_and_jacobian(chain, many, drawn, analysis.size)
        best = np.argsort(np.sum(error * error, axis=1), kind="stable")[:count]
        q, error = descend(chain, many[: len(best)], drawn[best], analysis.size, limits=wide, steps=60)
        position, angle = np.linalg.norm(error[:, :3], axis=1), np.linalg.norm(error[:, 3:], axis=1)
        closes = (position <= CLOSES) & (angle <= CLOSES)
        found = Found(np.full(len(q), i), q[:, :own], position * analysis.size, angle).pick(closes)
        parts = Found(
            np.concatenate([parts.index, found.index]),
            np.concatenate([parts.q, found.q]),
            np.concatenate([parts.position, found.position]),
            np.concatenate([parts.angle, found.angle]),
        )
    return parts


def nearest_configuration(
    analysis: Analysis, target: Array, limits: Array, near: Array | None, seed: int
) -> tuple[Array, float, float]:
    """The configuration (n,) whose pose comes nearest to target (4, 4): position first, then orientation.

    Also its distance [m] and angle [rad] from the target.
    """
    chain, own = analysis.chain, analysis.chain.n - analysis.open
    wide = np.concatenate([limits, np.tile([-np.inf, np.inf], (analysis.open, 1))])
    drawn = starts(chain, wide, analysis.size, DRAWN, seed)
    if near is not None:
        drawn[0, :own] = near
    many = np.broadcast_to(target, (DRAWN, 4, 4))
    weights = np.array([1.0, 1.0, 1.0, ORIENTATION, ORIENTATION, ORIENTATION])
    error, _ = error_and_jacobian(chain, many, drawn, analysis.size)
    best = np.argsort(np.sum((error * [1, 1, 1, 0.1, 0.1, 0.1]) ** 2, axis=1), kind="stable")[:STARTS]
    q, error = descend(chain, many[:STARTS], drawn[best], analysis.size, limits=wide, weights=weights, steps=50)
    best = np.argsort(np.sum((error * weights) ** 2, axis=1), kind="stable")[:FINALISTS]
    few = many[:FINALISTS]
    q, _ = descend(chain, few, q[best], analysis.size, limits=wide, weights=weights, steps=60, unreachable=True)
    # The small weight leaves the position off by its square: it is closed by itself, from where it is.
    position_only = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
    closed, error = descend(
        chain, few, q, analysis.size, limits=wide, weights=position_only, steps=200, unreachable=True
    )
    position, angle = np.linalg.norm(error[:, :3], axis=1), np.linalg.norm(error[:, 3:], axis=1)
    rounded = np.round(position, 9)
    winner = np.lexsort((angle, rounded))[0]
    return closed[winner, :own], float(position[winner] * analysis.size), float(angle[winner])


def free_joints(chain: Chain, q: Array, target: Array, size: float) -> tuple[int, ...]:
    """Joints (from 1) that may trade motion at q (n,) without moving the tool from target (4, 4); () if none.

    A null vector of the Jacobian alone is no proof: a stretched elbow has one and cannot move. So the
    joints are moved along it and brought back to the target; if they stay away from where they were, they
    are on a curve of solutions.
    """
    _, J = error_and_jacobian(chain, target[None], q[None], size)
    _, values, Vt = np.linalg.svd(J[0])
    null = Vt[np.sum(values > SINGULAR) :]
    if not len(null):
        return ()
    scale = np.where(chain.revolute, 1.0, size)
    moving = np.zeros(chain.n, dtype=bool)
    for direction in null:
        for ahead in (direction, -direction):
            at = q
            for _ in range(TRADES):
                back, error = descend(chain, target[None], (at + TRADE * ahead * scale)[None], size, steps=20)
                gone = (back[0] - at) / scale
                if np.max(np.abs(error)) > 1e-8 or np.max(np.abs(gone)) < 0.3 * TRADE:
                    break
                # On along the curve: a joint that happens to stand still where it starts moves further on.
                at, ahead = back[0], gone / np.max(np.abs(gone))
                moving |= np.abs(at - q) / scale > 1e-4
    return tuple(int(i) + 1 for i in np.flatnonzero(moving))
