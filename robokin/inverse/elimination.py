"""The elimination on a given arm: which splits serve, which poses are doubtful, and what is tried for those.

Each of the twelve splits of `raghavan_roth` is right, but on an arm whose axes are parallel or meet most of them have
equations that say nothing. Rather than by reasoning about the geometry, a split is chosen by trying it on poses of
the arm itself, whose solutions are known.

Where an arm is singular, roots coincide for a reason that no split removes. Links that are wrong by a trifle separate
them; Newton's steps on the true loop then make up for the trifle.
"""

from __future__ import annotations

from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from robokin.inverse.loop import Candidates, Loop
from robokin.inverse.newton import closing_at, determinants, refine
from robokin.inverse.raghavan_roth import PERTURBATION, SHIFT, SPLITS, Elimination

__all__ = ["SPLITS", "Elimination", "choose_splits", "doubtful", "rescue_candidates"]

Array = NDArray[np.float64]

ORDER = (1, 10, 4, 7, 0, 9, 3, 6, 2, 11, 5, 8)
"""Splits in the order in which they are tried: split 1 serves nine in ten of the arms on sale that have no wrist."""

POSES = 12
"""Random poses on which a split is tried."""

ENOUGH, PATIENCE = 2, 4
"""A second split that finds everything, to check the first and to fall back on, is looked for this much further."""

FOUND = 1e-6
"""Joint values [rad | size] that agree so well are the same."""


def choose_splits(loop: Loop, values: Array | None = None) -> list[int]:
    """The splits that find solutions of a loop, best first; none if there are none.

    They are tried on poses of the arm itself: random joint values, or those given (k, 6) [rad | size], must be among
    the answers. Splits of the perturbed loop are tried when no other finds everything.
    """
    if values is None:
        spans = np.where(loop.revolute, np.pi, 1.0)
        values = np.random.default_rng(7).uniform(-spans, spans, (POSES, 6))
    closing = closing_at(loop, values)
    shares: dict[int, float] = {}
    for splits in (ORDER, tuple(SPLITS + split for split in ORDER)):
        since = 0
        for split in splits:
            shares[split] = _share_found(loop, split, values, closing)
            perfect = sum(share == 1.0 for share in shares.values())
            since += perfect > 0
            if perfect >= ENOUGH or since > PATIENCE:
                break
        if perfect:
            break
    return sorted((split for split, share in shares.items() if share > 0.0), key=lambda split: -shares[split])


def _share_found(loop: Loop, split: int, values: Array, closing: Array) -> float:
    """The part of the joint values (k, 6) that a split finds."""
    try:
        found = Elimination(loop, split).candidates(closing)
    except np.linalg.LinAlgError:
        return 0.0
    refined, _, _ = refine(loop, closing, found.index, found.values, 3)
    gap = refined - values[found.index]
    gap = np.where(loop.revolute, gap - 2.0 * np.pi * np.round(gap / (2.0 * np.pi)), gap)
    hits = found.index[np.max(np.abs(gap), axis=1) < FOUND]
    return len(np.unique(hits)) / len(values)


RESCUES = ((0, 2.3, 0.0), (1, SHIFT, 0.0), (0, SHIFT, 1e-6), (0, SHIFT, 1e-4), (1, 2.3, 1e-5), (1, SHIFT, 1e-3))
"""What else is tried for a doubtful pose: the best or the second split, its shift, the links' errors."""

RESCUE_STEPS = 20
"""Newton steps from there: near a double solution each but halves the error."""

RESCUED = 1e-7
"""A candidate that closes no better [size and rad] after these steps leads nowhere."""

SINGULAR = 1e-5
"""|det S| of a solution below which others may be lost, about one random pose in a hundred: roots and their vectors
then lie so near to each other that telling them apart takes more digits than there are."""

_rescuers: WeakKeyDictionary[Loop, dict[tuple[int, float, float], Elimination]] = WeakKeyDictionary()


def doubtful(loop: Loop, targets: int, index: NDArray[np.intp], values: Array) -> NDArray[np.bool_]:
    """Which of some targets (m,) deserve `rescue_candidates`, given their verified and distinct solutions.

    index: (s,) the solutions' targets; values: (s, 6) [rad | size]. At a regular pose solutions come in pairs: none,
    or an odd number, or one at which the arm is near-singular, asks for a second look.
    """
    count = np.bincount(index, minlength=targets)
    near = index[determinants(loop, values) < SINGULAR]
    return np.asarray((count % 2 == 1) | (count == 0) | (np.bincount(near, minlength=targets) > 0))


def rescue_candidates(loop: Loop, splits: list[int], closing: Array) -> Candidates:
    """Candidates for doubtful poses L6 (m, 4, 4), found in several ways and refined on the true loop.

    Other splits and shifts go round roots at infinity and ones that coincide by chance, perturbed links round ones
    that coincide at the pose for good.
    """
    kept = _rescuers.setdefault(loop, {})
    parts = []
    for which, shift, perturbation in RESCUES:
        split = splits[min(which, len(splits) - 1)]
        if perturbation:
            split = split % SPLITS + SPLITS
        key = split, shift, perturbation or PERTURBATION
        try:
            if key not in kept:
                kept[key] = Elimination(loop, *key)
            parts.append(kept[key].candidates(closing))
        except np.linalg.LinAlgError:
            continue
    if not parts:
        return Candidates(np.empty(0, dtype=np.intp), np.empty((0, 6)))
    index = np.concatenate([part.index for part in parts])
    values = np.concatenate([part.values for part in parts])
    values, position, angle = refine(loop, closing, index, values, RESCUE_STEPS)
    closes = (position < RESCUED) & (angle < RESCUED)
    return Candidates(index[closes], values[closes])
