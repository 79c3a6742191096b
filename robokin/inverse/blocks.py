"""Blocks of targets to verified configurations, whatever the arm."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robokin.inverse.analysis import Analysis, General, chain_pose_parts, window_chain
from robokin.inverse.elimination import doubtful, rescue_candidates
from robokin.inverse.families import with_families_held
from robokin.inverse.loop import Candidates
from robokin.inverse.nearest import SINGULAR
from robokin.inverse.numeric import descend, error_and_jacobian
from robokin.inverse.verify import CLOSES, VIRTUAL, Found, Poses, distinct, nothing, verified
from robokin.spatial import invert

Array = NDArray[np.float64]

BLOCK = 4000
"""Targets at a time: the interpreter's share is spread thin, and the columns of a closed form stay in cache."""

HELD_SAMPLES = 48
"""Values at which the joints of a redundant arm are held, for each target."""

MORE_SAMPLES = 192
"""The same for a target that those do not serve: still a tenth of the time that a search takes."""

GRAZING = 1e-5
"""A virtual joint below this may be zero but for rounding (at a double root half of the digits are lost); the
arm's own joints are then polished alone and judged by their own residual."""


def solve_block(
    analysis: Analysis, T: Array, limits: Array, near: Array | None, rest: Array, more: bool = False
) -> Found:
    """Every configuration found for targets T: (m, 4, 4), m at most a block, duplicates removed.

    q: (s, n) holds the arm's own joints only; idle ones, and one of those that trade motion at a singular wrist,
    are at `rest` (n,). For a redundant arm the joints outside the window are held at the values of `near` (n,), if
    it is given, and at values spread over the limits (n, 2); with `more` at further and more such values, for
    targets that the first do not serve.
    """
    if analysis.solver is None:
        return nothing(analysis.chain.n - analysis.open)
    moving = analysis.moving
    if not analysis.redundancy:
        open_joints = np.tile([-np.inf, np.inf], (analysis.open, 1))
        bounds = np.concatenate([limits[moving], open_joints])
        held = np.concatenate([rest[moving], np.zeros(analysis.open)])
        found = with_families_held(analysis, T, _solve_window(analysis, T), held, bounds)
    else:
        held = spread(analysis, limits[moving])
        if more:
            held = spread(analysis, limits[moving], MORE_SAMPLES, start=HELD_SAMPLES)
        elif near is not None:
            first = np.zeros((1, analysis.solved.n))
            first[0, : len(moving)] = near[moving]
            held = np.concatenate([first, held])
        found = _solve_held(analysis, T, held)
    found = Found(found.index, found.q[:, : len(moving)], found.position, found.angle)
    if len(moving) and not analysis.redundancy:
        found = distinct(found, analysis.solved.revolute[: len(moving)], analysis.size)
    elif not len(moving):
        found = found.pick(np.unique(found.index, return_index=True)[1])
    if not analysis.idle:
        return found
    q = np.tile(rest, (len(found), 1))
    q[:, moving] = found.q
    return Found(found.index, q, found.position, found.angle)


def _solve_window(analysis: Analysis, T: Array) -> Found:
    """Solutions of the window for its own targets; q: (s, window)."""
    six, loop = analysis.six, analysis.loop
    assert six is not None
    assert loop is not None
    closing = loop.closing(T)
    poses = Poses(six.chain, T)
    candidates = analysis.solver.candidates(closing)
    found = verified(loop, six.chain, poses, closing, candidates)
    if isinstance(analysis.solver, General):
        found = distinct(found, six.chain.revolute, loop.size)
        scale = np.where(six.chain.revolute, 1.0, loop.size)
        values = (found.q + six.chain.offsets) / scale
        again = np.flatnonzero(doubtful(loop, len(T), found.index, values))
        if len(again):
            more = rescue_candidates(loop, analysis.solver.splits, closing[again])
            more = Candidates(again[more.index], more.values)
            extra = verified(loop, six.chain, poses, closing, more)
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
    still = size <= GRAZING
    family = np.zeros(len(found), dtype=bool)
    if not analysis.redundancy:
        family = _on_self_motions(analysis, T, found, still)
    found = found.pick(still | family)
    own_chain = window_chain(analysis.solved, analysis.window)
    q, position, angle = found.q[:, :own], found.position.copy(), found.angle.copy()
    if not len(q):
        return Found(found.index, q, position, angle)
    steps = 2 if np.all(size <= VIRTUAL) else 8 if not family.any() else 25
    q, error = descend(own_chain, T[found.index], q, analysis.size, steps=steps)
    position = np.linalg.norm(error[:, :3], axis=1) * analysis.size
    angle = np.linalg.norm(error[:, 3:], axis=1)
    closes = (position <= CLOSES * analysis.size) & (angle <= CLOSES)
    return Found(found.index, q, position, angle).pick(closes)


def _on_self_motions(analysis: Analysis, T: Array, found: Found, still: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """(s,) which configurations are on self-motions of the six joints, for targets without any that stand `still`.

    Such a curve may lead to where the virtual joints stand still: its members are starts for the arm's own.
    """
    assert analysis.six is not None
    answered = np.bincount(found.index[still], minlength=len(T)) > 0
    family = ~answered[found.index]
    chosen = np.flatnonzero(family)
    if len(chosen):
        _, J = error_and_jacobian(analysis.six.chain, T[found.index[chosen]], found.q[chosen], analysis.size)
        family[chosen] = np.linalg.svd(J, compute_uv=False)[:, -1] <= SINGULAR
    return family


def _solve_held(analysis: Analysis, T: Array, held: Array) -> Found:
    """Solutions with the joints outside the window held at each of some rows; q: (s, n)."""
    window, chain = analysis.window, analysis.solved
    before, after = chain_pose_parts(chain, window, held)
    m, k = len(T), len(held)
    # Every target with every row, the target counting slower.
    inner = invert(before)[None] @ T[:, None] @ invert(after)[None]
    found = nothing(chain.n)
    parts = []
    flat = inner.reshape(m * k, 4, 4)
    for start in range(0, m * k, BLOCK):
        part = _solve_window(analysis, np.ascontiguousarray(flat[start : start + BLOCK]))
        # What differs in a held joint is different: only the few solutions of one row need a comparison.
        part = distinct(part, chain.revolute[window.first : window.last], analysis.size)
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

    limits: (k, 2) those of the arm's joints that are solved for, idle ones left out.

    The points of an additive sequence whose steps are powers of the root of x^(d+1) = x + 1 (M. Roberts,
    "The unreasonable effectiveness of quasirandom sequences", 2018): they fill a box of any dimension evenly
    and can be continued.
    """
    chain, window = analysis.solved, analysis.window
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
