"""Solutions so near to each other that they are one: which of them are told apart, and which are left out.

Rounding takes a root apart that counts several times, by the more the oftener it counts, and Newton's steps give up
beside a singular pose. What is found there may be a root twice, a place where steps stalled, or two roots in truth.
Joint values and how singular they are tell the first; the error tells the second; the pose midway between two tells
the third.
"""

from __future__ import annotations

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.inverse.self_motion.chosen_members import SelfMotion
from robokin.inverse.self_motion.pose_correction import errors
from robokin.inverse.verify import Found
from robokin.kernel.chain import Chain
from robokin.spatial.angles import circled

UNRESOLVED = 3e-8
"""Least singular value below which a solution is a multiple one: neighbours within `NEIGHBOURS` are the same root.
Rounding takes a double root apart by 1e-8, and the singular value is about as large; two roots that are farther apart
are two."""

NEIGHBOURS = 2e-3
"""How far rounding takes a root apart that counts many times [rad | size]: the seventh root of 1e-16. Also how near to
a self-motion such a root may be and still belong to it, where the error hardly grows at right angles to it."""

NEXT = 1e-5
"""Two solutions that are nearer [rad | size] are one if the pose midway between them is the target but for `MIDWAY`."""

MIDWAY = 2e-13
"""What the pose is then off by at most [size and rad]: some hundred times its rounding. Two roots of a common fold that
are 1e-6 apart are off by as much midway; joint values are not known better."""

SLOW = 1e-3
"""Least singular value below which Newton's steps may stall on the way to a root."""

BESIDE = 2e-3
"""How near [rad | size] to a solution another one that is singular too, or has not settled, is taken for the same."""

CROWDED = 0.3
"""Distance [rad | size] of singular solutions below which one may lead to the other: self-motions are followed by steps
of up to 0.2, and one that is smaller looks like roots."""

SETTLED = 1e-13
"""Residual [size and rad] to which Newton's steps bring a root that stands alone."""


def thinned(chain: Chain, found: Found, least: Array, size: float) -> tuple[Found, Array]:
    """The solutions, and their least singular values, without those beside another one that tell nothing new.

    Next to a singular solution many are found that have not settled, or that lie on one self-motion. Of those that
    have settled the most singular one stays: a member of a self-motion closes no better than what is beside it.
    """
    off = np.maximum(found.position / size, found.angle)
    scale = np.where(chain.revolute, 1.0, size)
    keep = np.ones(len(found), dtype=bool)
    rows = np.flatnonzero(least < SLOW)
    for target in np.unique(found.index[rows]):
        mine = rows[found.index[rows] == target]
        mine = mine[np.lexsort((least[mine], np.maximum(off[mine], SETTLED)))]
        x = found.q[mine] / scale
        gap = x[:, None] - x[None]
        gap = np.max(np.abs(circled(gap, chain.revolute)), axis=2)
        vague = (off[mine] > SETTLED)[:, None] | (np.maximum(least[mine][:, None], least[mine][None]) < UNRESOLVED)
        near = vague & (gap < BESIDE)
        for k in range(1, len(mine)):
            keep[mine[k]] = not np.any(near[k, :k] & keep[mine[:k]])
    return found.pick(keep), least[keep]


def stalled(index: Index, keep: Flags, least: Array, off: Array) -> Index:
    """Which rows are places where Newton's steps gave up next to a singular pose, of targets with others.

    A root is settled on to rounding, be it ever so near to another one.
    """
    stalled = keep & (off > SETTLED) & (least < SLOW)
    settled = np.bincount(index[keep & ~stalled], minlength=int(index.max(initial=0)) + 1) > 0
    return np.flatnonzero(stalled & settled[index])


def repeated(
    chain: Chain, T: Array, index: Index, q: Array, rows: Index, size: float, least: Array
) -> tuple[Index, Index]:
    """Which of some rows are the same root as another one of their target, T: (m, 4, 4) being the targets.

    Also which of these are roots of their own, but so near to another one that joint values hardly tell them apart.
    """
    scale = np.where(chain.revolute, 1.0, size)
    again, beside = [], []
    for target in np.unique(index[rows]):
        mine = rows[index[rows] == target]
        mine = mine[np.argsort(least[mine], kind="stable")]
        for k in range(1, len(mine)):
            gap = (q[mine[:k]] - q[mine[k]]) / scale
            gap = circled(gap, chain.revolute)
            distance = np.max(np.abs(gap), axis=1)
            multiple = np.maximum(least[mine[:k]], least[mine[k]]) < UNRESOLVED
            same = multiple & (distance < NEIGHBOURS)
            next_to = np.flatnonzero(~same & (distance < NEXT))
            if len(next_to):
                midway = q[mine[k]] / scale + 0.5 * gap[next_to]
                off = errors(chain, np.broadcast_to(T[target], (len(midway), 4, 4)), midway, size)[0]
                next_to = next_to[np.max(np.abs(off), axis=1, initial=0.0) <= MIDWAY]
            if np.any(same) or len(next_to):
                again.append(mine[k])
            if len(next_to) and not np.any(same):
                beside.append(mine[k])
    return np.array(again, dtype=np.intp), np.array(beside, dtype=np.intp)


def crowded(chain: Chain, index: Index, q: Array, rows: Index, size: float) -> Index:
    """The targets of which some singular solutions are near to each other: they may be on one self-motion, which is too
    small to be followed."""
    scale = np.where(chain.revolute, 1.0, size)
    found = []
    for target in np.unique(index[rows]):
        x = q[rows[index[rows] == target]] / scale
        gap = x[:, None] - x[None]
        gap = np.max(np.abs(circled(gap, chain.revolute)), axis=2)
        if np.any(gap[np.triu_indices(len(x), 1)] < CROWDED):
            found.append(target)
    return np.array(found, dtype=np.intp)


def on_motions(
    chain: Chain, index: Index, q: Array, rows: Index, size: float, least: Array, motions: dict[int, list[SelfMotion]]
) -> Index:
    """Which of some rows, none of which stands for one, are multiple roots beside a self-motion of their target."""
    scale = np.where(chain.revolute, 1.0, size)
    beside = []
    for row in rows[least[rows] < UNRESOLVED]:
        for motion in motions.get(int(index[row]), []):
            gap = (motion.curve.q - q[row]) / scale
            gap = circled(gap, chain.revolute)
            if _distance(gap) < NEIGHBOURS:
                beside.append(row)
                break
    return np.array(beside, dtype=np.intp)


def _distance(points: Array) -> float:
    """How far the straight pieces between points (k, n) are from zero, by the greatest coordinate."""
    if len(points) < 2:
        return float(np.min(np.max(np.abs(points), axis=1)))
    chord = circled(np.diff(points, axis=0))
    length = np.maximum(np.einsum("ij,ij->i", chord, chord), 1e-300)
    along = np.clip(-np.einsum("ij,ij->i", points[:-1], chord) / length, 0.0, 1.0)
    return float(np.min(np.max(np.abs(points[:-1] + along[:, None] * chord), axis=1)))
