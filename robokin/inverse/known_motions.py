"""Targets of a redundant arm of which all self-motions are known in closed form: what is found and said of them.

Statement. Of a block of targets of an arm with a spherical shoulder and wrist join what the swivel angle tells
(`swivel_members`) with what other ways found for the rest, and give the self-motions of one target.
What vouches. The elbow's equation has two roots, each triple of turns two solutions, and each joint meets a limit at
the roots of one equation: the intervals are all, unless a pose is next to a degenerate case: there nothing is claimed.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.inverse.analysis import Analysis
from robokin.inverse.claims import COUNTED, SPREAD, Claims, unclaimed
from robokin.inverse.self_motion.one_swivel import moving_joints
from robokin.inverse.self_motion.swivel_arcs import swivel_arcs
from robokin.inverse.self_motion.swivel_arm import swivel_arm
from robokin.inverse.self_motion.swivel_curves import TURN, SwivelCurves
from robokin.inverse.self_motion.swivel_members import SwivelAnswers, swivel_answers
from robokin.inverse.self_motion.swivel_pieces import CODES, SwivelPieces
from robokin.inverse.solutions import Family, arc_later
from robokin.inverse.verify import SAME, Found, merged
from robokin.model.robot import LIMIT_TOLERANCE

ALL_MOTIONS = f"{SPREAD}; the self-motions are known in closed form"
"""What is said of a target with solutions."""

NO_MOTION = "the self-motions are known in closed form"
"""What is said of a target without."""

MOVING = [tuple(i + 1 for i in range(7) if bits >> i & 1) for bits in range(128)]
"""Joints, from 1, by bits."""

NO_ELBOW = "no value of the elbow brings the wrist as far from the shoulder as the pose has it"
"""The same where the wrist cannot be there."""


def known_motions(
    analysis: Analysis, T: Array, limits: Array, preferred: Array, near: Array | None, wanted: int
) -> SwivelAnswers | None:
    """What the swivel angle tells of targets T (m, 4, 4); None for an arm that has none.

    limits, preferred: (n, 2), near: (n,) [rad], as in `swivel_answers`.
    """
    if analysis.open or analysis.redundancy != 1:
        return None
    arm = swivel_arm(analysis.chain)
    return None if arm is None else swivel_answers(arm, T, limits, preferred, near, wanted)


def with_known(found: Found, rest: Index, known: SwivelAnswers) -> tuple[Found, Index, Claims]:
    """What was found for the targets `rest` (k,), numbered among themselves, with what is known of the others.

    By target, each with its generation, and the claims for all.
    """
    claims = unclaimed(len(known.known), SPREAD)
    none = known.none
    claims.basis[none] = COUNTED
    elbows: Flags = np.any(known.curves.real, axis=1)
    for i in np.flatnonzero(known.known).tolist():
        claims.words[i] = ALL_MOTIONS if not none[i] else NO_MOTION if elbows[i] else NO_ELBOW
    if not len(found):
        return known.found, known.generation, claims
    both = merged(known.found, Found(rest[found.index], found.q, found.position, found.angle))
    order = np.argsort(both.index, kind="stable")
    generation = np.concatenate([known.generation, np.zeros(len(found), dtype=np.intp)])
    return both.pick(order), generation[order], claims


def known_families(known: SwivelAnswers, i: int, limits: Array, listed: Array) -> tuple[Family, ...] | None:
    """The self-motions of target i within limits (7, 2) [rad], for its listed solutions (k, 7).

    None where one turns on beyond its limits in a way that intervals of the swivel angle do not tell.
    """
    curves, pieces = known.curves, known.pieces
    chosen = np.flatnonzero(pieces.row == i)
    if not len(chosen):
        return ()

    @cache
    def arcs() -> tuple[list[Array], bool]:
        found, fits = swivel_arcs(curves, pieces, chosen, limits)
        return found, bool(fits.all())

    if turns_on(limits) and not arcs()[1]:
        return None
    codes, of = np.unique(pieces.code[chosen], return_inverse=True)
    moving = [MOVING[bits] for bits in moving_joints(curves, i, codes)]
    stands = _standing(curves, i, CODES[codes], listed)
    families = []
    for number in np.argsort(np.where(stands < 0, len(listed), stands), kind="stable").tolist():
        own = tuple(
            arc_later(partial(_one, arcs, k), bool(pieces.whole[piece]), _interval(pieces, piece))
            for k, piece in enumerate(chosen.tolist())
            if of[k] == number
        )
        families.append(Family(moving[number], 1, True, own, int(stands[number])))
    return tuple(families)


def turns_on(limits: Array) -> bool:
    """Whether some limits (7, 2) [rad] are more than a turn apart: a joint may then turn on beyond one of them."""
    with np.errstate(invalid="ignore"):
        width = limits[:, 1] - limits[:, 0]
    return bool(np.any(np.isfinite(width) & (width > TURN + LIMIT_TOLERANCE)))


def _one(arcs: Callable[[], tuple[list[Array], bool]], k: int) -> Array:
    return arcs()[0][k]


def _interval(pieces: SwivelPieces, piece: int) -> tuple[float, float]:
    return float(pieces.first[piece]), float(pieces.last[piece])


def _standing(curves: SwivelCurves, i: int, motions: Index, listed: Array) -> Index:
    """(c,) the first of the listed solutions (k, 7) on each curve of target i with signs (c, 3); -1 for none."""
    c, k = len(motions), len(listed)
    if not k:
        return np.full(c, -1)
    row, signs, q = np.full(c * k, i), np.repeat(motions, k, axis=0), np.tile(listed, (c, 1))
    away = curves.configurations(row, signs, curves.swivel(row, signs[:, 0], q)) - q
    on = (np.max(np.abs(away - TURN * np.round(away / TURN)), axis=1) <= SAME).reshape(c, k)
    return np.where(on.any(axis=1), np.argmax(on, axis=1), -1)
