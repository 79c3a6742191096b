"""Blocks of targets to verified configurations, whatever the arm."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robokin.inverse.analysis import Analysis, General, chain_pose_parts, window_chain
from robokin.inverse.elimination import doubtful, rescue_candidates
from robokin.inverse.loop import Candidates
from robokin.inverse.numeric import descend
from robokin.inverse.verify import CLOSES, VIRTUAL, Found, Poses, distinct, nothing, verified
from robokin.spatial import invert

Array = NDArray[np.float64]

BLOCK = 4000
"""Targets at a time: the interpreter's share is spread thin, and the columns of a closed form stay in cache."""

HELD_SAMPLES = 48
"""Values at which the joints of a redundant arm are held, for each target."""

GRAZING = 1e-5
"""A virtual joint below this may be zero but for rounding (at a double root half of the digits are lost); the
arm's own joints are then polished alone and judged by their own residual."""


def solve_block(analysis: Analysis, T: Array, limits: Array, held: Array | None = None) -> Found:
    """Every configuration found for targets T: (m, 4, 4), m at most a block, duplicates removed.

    q: (s, n) holds the arm's own joints only. For a redundant arm the joints outside the window are held at
    each row of `held` (k, n) in turn, by default at values spread over the limits (n, 2).
    """
    if analysis.solver is None:
        return nothing(analysis.chain.n - analysis.open)
    if not analysis.redundancy:
        found = _solve_window(analysis, T)
    else:
        rows = spread(analysis, limits) if held is None else held
        found = _solve_held(analysis, T, rows)
    own = analysis.chain.n - analysis.open
    found = Found(found.index, found.q[:, :own], found.position, found.angle)
    return distinct(found, analysis.chain.revolute[:own], analysis.size)


def _solve_window(analysis: Analysis, T: Array) -> Found:
    """Solutions of the window for its own targets; q: (s, window)."""
    six, loop = analysis.six, analysis.loop
    assert six is not None
    assert loop is not None
    closing = loop.closing(T)
    poses = Poses(six.chain)
    candidates = analysis.solver.candidates(closing)
    found = verified(loop, six.chain, poses, T, closing, candidates)
    if isinstance(analysis.solver, General):
        found = distinct(found, six.chain.revolute, loop.size)
        scale = np.where(six.chain.revolute, 1.0, loop.size)
        values = (found.q + six.chain.offsets) / scale
        again = np.flatnonzero(doubtful(loop, len(T), found.index, values))
        if len(again):
            more = rescue_candidates(loop, analysis.solver.splits, closing[again])
            more = Candidates(again[more.index], more.values)
            extra = verified(loop, six.chain, poses, T, closing, more)
            found = merged(found, extra)
    if six.virtual:
        found = _own_joints(analysis, T, found)
    return found


def _own_joints(analysis: Analysis, T: Array, found: Found) -> Found:
    """Those whose virtual joints stand still, with the window's own joints only."""
    assert analysis.six is not None
    assert analysis.loop is not None
    chain = analysis.six.chain
    own = chain.n - analysis.six.virtual
    scale = np.where(chain.revolute[own:], 1.0, analysis.loop.size)
    virtual = found.q[:, own:] / scale
    virtual = np.where(chain.revolute[own:], virtual - 2 * np.pi * np.round(virtual / (2 * np.pi)), virtual)
    size = np.max(np.abs(virtual), axis=1)
    found = found.pick(size <= GRAZING)
    own_chain = window_chain(analysis.chain, analysis.window)
    q, position, angle = found.q[:, :own], found.position.copy(), found.angle.copy()
    if not len(q):
        return Found(found.index, q, position, angle)
    q, error = descend(own_chain, T[found.index], q, analysis.size, steps=8 if np.any(size > VIRTUAL) else 2)
    position = np.linalg.norm(error[:, :3], axis=1) * analysis.size
    angle = np.linalg.norm(error[:, 3:], axis=1)
    closes = (position <= CLOSES * analysis.size) & (angle <= CLOSES)
    return Found(found.index, q, position, angle).pick(closes)


def _solve_held(analysis: Analysis, T: Array, held: Array) -> Found:
    """Solutions with the joints outside the window held at each of some rows; q: (s, n)."""
    window, chain = analysis.window, analysis.chain
    before, after = chain_pose_parts(chain, window, held)
    m, k = len(T), len(held)
    # Every target with every row, the target counting slower.
    inner = invert(before)[None] @ T[:, None] @ invert(after)[None]
    found = nothing(chain.n)
    parts = []
    flat = inner.reshape(m * k, 4, 4)
    for start in range(0, m * k, BLOCK):
        part = _solve_window(analysis, np.ascontiguousarray(flat[start : start + BLOCK]))
        index = part.index + start
        q = held[index % k].copy()
        q[:, window.first : window.last] = part.q
        parts.append(Found(index // k, q, part.position, part.angle))
    for part in parts:
        found = merged(found, part)
    return found


def merged(a: Found, b: Found) -> Found:
    """Both, one after the other."""
    return Found(
        np.concatenate([a.index, b.index]),
        np.concatenate([a.q, b.q]),
        np.concatenate([a.position, b.position]),
        np.concatenate([a.angle, b.angle]),
    )


def spread(analysis: Analysis, limits: Array, count: int = HELD_SAMPLES, start: int = 0) -> Array:
    """Values (count, n) for the joints outside the window, evenly spread over their limits [rad | m].

    The points of an additive sequence whose steps are powers of the root of x^(d+1) = x + 1 (M. Roberts,
    "The unreasonable effectiveness of quasirandom sequences", 2018): they fill a box of any dimension evenly
    and can be continued.
    """
    chain, window = analysis.chain, analysis.window
    own = len(limits)
    free = [i for i in range(chain.n) if not window.first <= i < window.last]
    root = 2.0
    for _ in range(40):
        root = (1.0 + root) ** (1.0 / (len(free) + 1))
    fractions = (0.5 + np.outer(np.arange(start, start + count) + 1, root ** -np.arange(1.0, len(free) + 1))) % 1.0
    held = np.zeros((count, chain.n))
    for column, i in enumerate(free):
        reach = np.pi if chain.revolute[i] else analysis.size
        low, high = limits[i] if i < own else (-np.inf, np.inf)
        low = max(low, -reach) if np.isinf(low) else low
        high = min(high, reach) if np.isinf(high) else high
        held[:, i] = low + (high - low) * fractions[:, column]
    return held
