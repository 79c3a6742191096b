"""Configurations spread over the self-motions of arms with a spherical shoulder and wrist: what is listed of them.

Statement. For poses of such an arm give configurations on every piece of its self-motions within the limits (or
without regard to them), as many as are wanted, and those nearest to a wish.
Derivation. The pieces are intervals of the swivel angle (`swivel_pieces`); configurations stand on them at equal
distances of it. The distance from the wish is the greatest of the joints'; on each piece its least values at some such
places are brackets, in which it is narrowed down by thirds.
Degenerate case. Poses of which the pieces are not certain are not `known`: nothing is given for them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.inverse.self_motion.swivel_arm import SwivelArm
from robokin.inverse.self_motion.swivel_curves import SwivelCurves, swivel_curves
from robokin.inverse.self_motion.swivel_pieces import SwivelPieces, swivel_pieces
from robokin.inverse.verify import CLOSES, SAME, Found, residuals, within_limits
from robokin.kernel.frames import pose

COUNTS = (67, 509, 8221)
"""Configurations put on the pieces of a pose, the next where the ones before are too few. They are prime numbers: no
two of different counts then stand at one place."""

APART = 10.0 * SAME
"""Least distance of ψ between two of them: some joint moves by a third of it at least."""

ROUNDS_UP = 0.5 + 1e-6
"""What makes the next whole number of a part that is below it: of pieces of one length no last digit decides."""

BRACKETS = 24
"""Places on a piece at which the distance from a wish is looked at."""

THIRDS = 60
"""How often a bracket is cut to two thirds: from 0.5 to 1e-11 rad."""


@dataclass(frozen=True, eq=False)
class SwivelAnswers:
    """What is known of the self-motions of m poses.

    known: (m,) of which poses all pieces are known; found: the configurations of those, by pose; generation: (s,) 0 for
    those of the first count, more for those that were put between them because more are wanted.
    """

    curves: SwivelCurves
    pieces: SwivelPieces
    known: Flags
    found: Found
    generation: Index

    @property
    def none(self) -> Flags:
        """(m,) the poses that are known to have nothing within the limits."""
        return np.asarray(self.known & (np.bincount(self.pieces.row, minlength=len(self.known)) == 0))


def swivel_answers(
    arm: SwivelArm, T: Array, limits: Array, preferred: Array, near: Array | None, wanted: int
) -> SwivelAnswers:
    """What is known of poses T (m, 4, 4) [m] within limits (7, 2) [rad], and `wanted` configurations of each.

    preferred: (7, 2) limits within which there are to be as many, if there are pieces; near: (7,) the wish [rad]. Where
    nothing is within the limits configurations outside are given.
    """
    curves = swivel_curves(arm, T)
    pieces = swivel_pieces(curves, limits)
    known = ~pieces.doubt
    free = np.tile([-np.inf, np.inf], (7, 1))
    outside = np.flatnonzero(np.bincount(pieces.row, minlength=len(T)) == 0)
    sets = [pieces.of(known)]
    if len(outside):
        sets.append(swivel_pieces(curves, free).of(known & np.isin(np.arange(len(T)), outside)))
    if not np.array_equal(limits, preferred):
        sets.append(swivel_pieces(curves, preferred).of(known))
    rows, q, since = [], [], []
    for some in sets:
        for generation, count in enumerate(COUNTS):
            if generation and wanted <= COUNTS[generation - 1] // 2:
                break
            of, psi = placed(some, count)
            rows.append(some.row[of])
            q.append(curves.configurations(some.row[of], some.signs[of], psi))
            since.append(np.full(len(of), generation))
    if near is not None:
        some = sets[0]
        at = _nearest(curves, some, limits, near)
        rows.append(some.row)
        q.append(curves.configurations(some.row, some.signs, at))
        since.append(np.zeros(len(at), dtype=np.intp))
    row, Q, generation_ = np.concatenate(rows), np.concatenate(q), np.concatenate(since)
    order = np.argsort(row, kind="stable")
    return SwivelAnswers(curves, pieces, known, *_proven(arm, T, row[order], Q[order], generation_[order]))


def _proven(arm: SwivelArm, T: Array, row: Index, q: Array, generation: Index) -> tuple[Found, Index]:
    """Configurations (s, 7) of poses (s,) with their errors by forward kinematics, those that close."""
    position, angle = residuals(T[row], pose(arm.chain, q))
    closes = (position <= CLOSES * arm.size) & (angle <= CLOSES)
    return Found(row, q, position, angle).pick(closes), generation[closes]


def placed(pieces: SwivelPieces, count: int) -> tuple[Index, Array]:
    """Some `count` places for each pose at equal distances on its pieces, one at least on each: which piece, ψ."""
    length = pieces.last - pieces.first
    total = np.bincount(pieces.row, length, minlength=1)[pieces.row]
    many = np.floor(count * length / np.maximum(total, APART) + ROUNDS_UP)
    many = np.clip(many, 1, np.maximum(length / APART, 1)).astype(np.intp)
    of = np.repeat(np.arange(len(length)), many)
    rank = np.arange(len(of)) - np.repeat(np.cumsum(many) - many, many)
    return of, pieces.first[of] + (rank + 0.5) * (length / many)[of]


def _nearest(curves: SwivelCurves, pieces: SwivelPieces, limits: Array, near: Array) -> Array:
    """(p,) ψ of the configuration of each piece that is nearest to `near` (7,), by the joint that is farthest away."""
    turning = np.ones(7, dtype=bool)

    def distance(of: Index, psi: Array) -> Array:
        q = curves.configurations(pieces.row[of], pieces.signs[of], psi)
        return np.asarray(np.max(np.abs(within_limits(q, turning, limits, near)[0] - near), axis=1, initial=0.0))

    p = len(pieces.row)
    part = np.linspace(0.0, 1.0, BRACKETS)
    psi = pieces.first[:, None] + part * (pieces.last - pieces.first)[:, None]
    of = np.repeat(np.arange(p), BRACKETS)
    best = np.argmin(distance(of, psi.reshape(-1)).reshape(p, BRACKETS), axis=1)
    each, step = np.arange(p), (pieces.last - pieces.first) / (BRACKETS - 1)
    low, high = psi[each, best] - step, psi[each, best] + step
    low = np.where(pieces.whole, low, np.maximum(low, pieces.first))
    high = np.where(pieces.whole, high, np.minimum(high, pieces.last))
    for _ in range(THIRDS):
        third = (high - low) / 3.0
        nearer = distance(each, low + third) <= distance(each, high - third)
        low, high = np.where(nearer, low, low + third), np.where(nearer, high - third, high)
    return np.asarray(0.5 * (low + high))
