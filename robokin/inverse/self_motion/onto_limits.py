"""Solutions a trifle outside the joint limits that stand for ones inside.

Statement. Where solutions nearly meet one of them is listed, which may be outside the limits (n, 2) while what it
stands for is inside. Bring it inside, where that is as exact.
Derivation. A root that counts m times is known to the m-th root of rounding only: along its null vector the error
grows with the m-th power of the distance, once it is corrected at right angles to it. Newton's steps lead anywhere
on the way, so that the null vector is followed as far as the limits are away, and no farther.
"""

from __future__ import annotations

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.inverse.analysis import Analysis
from robokin.inverse.numeric.closing import DONE, EXACT_STEPS, newton_within
from robokin.inverse.self_motion.pose_correction import corrected
from robokin.inverse.self_motion.root_neighbours import NEIGHBOURS, UNRESOLVED
from robokin.inverse.verify import Found, wrapped
from robokin.inverse.window import nearly_singular
from robokin.kernel.residual import error_and_jacobian

BESIDE = 1e-5
"""A solution that is outside the limits by no more [rad | size] may stand for others that are inside: two that nearly
meet are listed as one where they are so near to each other."""

STANDS = 0.01
"""Part of a null vector that a joint must have to be brought into its limits along it: else the others go too far."""

FREE = 1e-4
"""Singular values below this belong to what is free: those of a root and what is within `NEIGHBOURS` of it."""

AS_EXACT = 1e-13
"""Error [size and rad] of a configuration within the limits that is as good as such a solution."""


def onto_limits(analysis: Analysis, T: Array, found: Found, inside: Flags, limits: Array) -> tuple[Found, Flags]:
    """Solutions (s, n) for targets T (m, 4, 4) with those brought inside the limits (n, 2) that are there as exact.

    inside: (s,) which are within the limits. Where two solutions nearly meet one is listed, which may be outside while
    what it stands for is inside; where more of them meet rounding may put it outside. Returns the solutions, and which
    of them are moved.
    """
    chain, size = analysis.chain, analysis.size
    scale = np.where(chain.revolute, 1.0, size)
    moved = np.zeros(len(found), dtype=bool)
    rows = _beside(found.q, np.flatnonzero(~inside), chain.revolute, limits, scale)
    if not len(rows):
        return found, moved
    start = _turned_beside(found.q[rows], chain.revolute, limits)
    outside = np.max(np.abs(np.clip(start, *limits.T) - start) / scale, axis=1, initial=0.0)
    unresolved = nearly_singular(chain, start, size, np.full(len(start), UNRESOLVED))
    known_to = np.where(unresolved, NEIGHBOURS, BESIDE)
    beside = outside <= known_to
    rows, start, near = rows[beside], start[beside], np.maximum(known_to[beside], 10.0 * BESIDE)
    if not len(rows):
        return found, moved
    index = found.index[rows]
    q, error = _exact_beside(analysis, T[index], start, limits)
    exact = np.max(np.abs(q - start) / scale, axis=1) <= near
    exact &= np.max(np.abs(error), axis=1) <= AS_EXACT
    for i in np.flatnonzero(exact):
        mine = inside & (found.index == index[i])
        gap = wrapped(found.q[mine] - q[i], chain.revolute) / scale
        exact[i] = not np.any(np.max(np.abs(gap), axis=1) <= near[i])
    rows, q, error = rows[exact], q[exact], error[exact]
    moved[rows] = True
    values, position, angle = found.q.copy(), found.position.copy(), found.angle.copy()
    values[rows], position[rows] = q, np.linalg.norm(error[:, :3], axis=1) * size
    angle[rows] = np.linalg.norm(error[:, 3:], axis=1)
    return Found(found.index, values, position, angle), moved


def _exact_beside(analysis: Analysis, T: Array, start: Array, limits: Array) -> tuple[Array, Array]:
    """Configurations (s, n) within the limits near some a trifle outside, as exact as they can be, and errors (s, 6).

    At a root that counts many times Newton's steps lead as far as the pose does not tell the difference, while along
    its null vector the error hardly grows: that is tried first, with corrections at right angles to it.
    """
    chain, size, every = analysis.chain, analysis.size, np.arange(len(start))
    scale = np.where(chain.revolute, 1.0, size)
    before, J = error_and_jacobian(chain, T, start, size)
    free = np.linalg.svd(J)[2][:, -1]
    gap = (np.clip(start, *limits.T) - start) / scale
    worst = np.argmax(np.abs(gap), axis=1)
    moves = np.abs(free[every, worst]) > STANDS
    along = np.where(moves, gap[every, worst] / np.where(moves, free[every, worst], 1.0), 0.0)
    x, _, _ = corrected(chain, T, start / scale + along[:, None] * free, size, steps=2, settled=0.0, zero=FREE)
    q = np.clip(x * scale, *limits.T)
    error, _ = error_and_jacobian(chain, T, q, size)
    open_ = np.flatnonzero(np.max(np.abs(error), axis=1) > np.maximum(np.max(np.abs(before), axis=1), DONE))
    if len(open_):
        q[open_], error[open_] = newton_within(chain, T[open_], start[open_], size, limits, EXACT_STEPS)
    return q, error


ROUGHLY = 1.1
"""Times as much is let pass by what sorts out most of those that are far outside."""


def _beside(q: Array, rows: Index, revolute: Flags, limits: Array, scale: Array) -> Index:
    """Some rows of q (s, n) without those that no turn brings to within `NEIGHBOURS` of their limits (n, 2) everywhere.

    What can be turned into its limits is (`within_limits`). Joint by joint: hardly any row is left after the first few.
    Some may be left that are farther outside.
    """
    for j, (low, high) in enumerate(limits):
        values, near = q[rows, j], ROUGHLY * NEIGHBOURS * scale[j]
        off = np.flatnonzero((values < low - near) | (values > high + near))
        if revolute[j]:
            for end in (low, high):
                turns = (values[off] - end) / (2.0 * np.pi)
                turns -= np.rint(turns)
                off = off[~(np.abs(turns) <= ROUGHLY * NEIGHBOURS)] if np.isfinite(end) else off[:0]
        rows = np.delete(rows, off)
    return rows


def _turned_beside(q: Array, revolute: Flags, limits: Array) -> Array:
    """Configurations (s, n) with each angle that is outside its limits (n, 2) turned as near to them as it can be."""
    best, least = q, np.max(np.stack([limits[:, 0] - q, q - limits[:, 1]]), axis=0)
    for end in np.where(np.isfinite(limits), limits, 0.0).T:
        turned = np.where(revolute, q + 2.0 * np.pi * np.round((end - q) / (2.0 * np.pi)), q)
        beyond = np.max(np.stack([limits[:, 0] - turned, turned - limits[:, 1]]), axis=0)
        nearer = (least > 0.0) & (beyond < least)
        best, least = np.where(nearer, turned, best), np.where(nearer, beyond, least)
    return best
