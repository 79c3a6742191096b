"""Where the self-motions of a target come within the limits, or touch them, at places that no known solution is near.

Statement. Given solutions of targets, within the limits or not, of an arm with one joint to spare, find solutions
within the limits on the self-motions that these are on.
Derivation. The curves are followed without regard to limits (`pieces_within`). Along them the margin, the least
distance of a joint from its limits, has maxima; where one is above zero or little below, the configuration there is put
on the limits and Newton's steps within these lead to a solution, if there is one beside it.
Degenerate case. At a corner of the limits the solution is a single point, and the margin has a kink of zero there: the
steps, which hold the joints at their limits, end on it exactly.

Here x are joint values [rad | size] and lengths are in the arm's size.
"""

from __future__ import annotations

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.inverse.numeric.closing import exact_within
from robokin.inverse.self_motion.bounded_task import BoundedTask
from robokin.inverse.self_motion.pieces_within import Pieces, between, far_apart, joined, ranks, rays
from robokin.inverse.verify import Found, wrapped

SEEDS = 24
"""Known solutions of a target, far from each other, on the curves of which maxima are looked for."""

AT_ONCE = 2
"""Those of a target that are followed at the same time: most targets have two to four curves."""

ROUNDS = 6
"""How often more are followed from those that are on no curve yet."""

ON_CURVE = 0.05
"""How far [rad | size] a solution on a curve is from the chord between two of its points at most."""

PARTS = 8
"""Places between two points of a curve at which the margin is looked at: some 0.03 [rad | size] apart."""

NEARLY = 0.05
"""How far below zero [rad | size] a maximum of the margin may be at these places: a joint moves by less between two."""

BESIDE = 0.1
"""Error [size and rad] of a configuration put on the limits up to which it is followed."""

CONTACTS = 24
"""Maxima of the margin that are followed for a target, the greatest ones."""


def contacts(task: BoundedTask, known: Found) -> Found:
    """Solutions within the limits on the self-motions of known solutions, with duplicates, by target."""
    target, x = _highest(task, _curves(task.unlimited(), known))
    found = exact_within(task.analysis, task.T, target, x * task.scale, task.limits, BESIDE)
    return found.pick(np.argsort(found.index, kind="stable"))


def _curves(task: BoundedTask, known: Found) -> Pieces:
    """The curves that known solutions are on, whatever the limits.

    They are followed from a few solutions at a time; those that are then beside one that was followed are done.
    """
    if not len(known):
        return Pieces(known.index, known.index, task.points(known), task.points(known))
    seeds, _ = far_apart(task, known, SEEDS)
    x, left = task.points(seeds), np.ones(len(seeds), dtype=bool)
    parts: list[Pieces] = []
    for _ in range(ROUNDS):
        rows = np.flatnonzero(left)
        rows = rows[ranks(seeds.index[rows]) < AT_ONCE]
        if not len(rows):
            break
        parts.append(rays(task, seeds.pick(rows), 1, 0))
        left[rows] = False
        for i in np.unique(seeds.index[rows]):
            mine = np.flatnonzero(left & (seeds.index == i))
            left[mine] = ~_beside(task, parts[-1].of(np.arange(len(task.T)) == i), x[mine])
    return joined(parts)


def _beside(task: BoundedTask, curves: Pieces, x: Array) -> Flags:
    """(s,) which points x (s, n) are on the curves of one target."""
    pair = np.flatnonzero(np.diff(curves.ray) == 0)
    chord = curves.x[pair + 1] - curves.x[pair]
    gap = wrapped((x[:, None] - curves.x[pair]).reshape(-1, x.shape[1]), task.chain.revolute)
    gap = gap.reshape(len(x), len(pair), x.shape[1])
    along = np.clip(np.einsum("spn,pn->sp", gap, chord) / np.sum(chord**2, axis=1), 0.0, 1.0)
    off = np.linalg.norm(gap - along[:, :, None] * chord, axis=2)
    return np.asarray(np.min(off, axis=1, initial=np.inf) <= ON_CURVE)


def _highest(task: BoundedTask, curves: Pieces) -> tuple[Index, Array]:
    """The targets (k,) and the points x (k, n) at the maxima of the margin, each turned to where its limits are."""
    pair = np.flatnonzero(np.diff(curves.ray) == 0)
    place = (pair[:, None] + np.arange(PARTS) / PARTS).reshape(-1)
    x = task.turned(between(curves, place))
    target, ray = curves.target[place.astype(np.intp)], curves.ray[place.astype(np.intp)]
    margin = task.margin(x)
    before, after = np.r_[-np.inf, margin[:-1]], np.r_[margin[1:], -np.inf]
    before[1:][np.diff(ray) != 0] = -np.inf
    after[:-1][np.diff(ray) != 0] = -np.inf
    chosen = np.flatnonzero((margin >= before) & (margin >= after) & (margin > -NEARLY))
    chosen = chosen[np.lexsort((-margin[chosen], target[chosen]))]
    rank = np.arange(len(chosen)) - np.searchsorted(target[chosen], target[chosen])
    chosen = chosen[rank < CONTACTS]
    return target[chosen], x[chosen]
