"""The pieces of an arm's self-motions within its joint limits, as exact intervals of the swivel angle.

Statement. On the curves of `swivel_curves` find all intervals of ψ in which all joints are within their limits.
Derivation. That a turn of a triple Rz(a) K Rz(b) L Rz(c) = R(ψ) has a given value makes an equation that is linear in
cos ψ and sin ψ: with a = A the second axis is known on the side of the first, and its angle to the third is that of L,

    (K z)ᵀ Rz(-A) R(ψ) z = zᵀ L z,   zᵀ R(ψ) z = k + r cos(B - φ),   zᵀ R(ψ) Rz(-C) Lᵀ z = zᵀ K z.

So a joint meets each of its limits at two values of ψ at most, whatever the signs. Between two neighbours of all these
values no joint meets a limit: the configurations midway say of each interval whether it is within the limits.
A joint with limits a full turn apart is within them everywhere, and stops where it meets them.
Degenerate case. Joints that meet their limits at one ψ may leave a single point within them, and a joint may touch its
limit, which counts as within. Where a joint touches a limit and turns back, or keeps to one all along, or does either
nearly so; where a configuration is a trifle beyond a limit and both sides of it are alike; where a piece or the gap
between two is short: there is `doubt`, by a margin some thousand times the error of any configuration.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.inverse.self_motion.swivel_arm import SwivelArm
from robokin.inverse.self_motion.swivel_curves import TURN, SwivelCurves
from robokin.kernel.facts import fact
from robokin.model.robot import LIMIT_TOLERANCE

TRIPLES = np.array([[0, 1, 2], [4, 5, 6]])
"""The joints of the shoulder and of the wrist, from 0."""

TOUCHES = 1e-9
"""How far beyond 1 the cosine of half the way between two values of ψ may be for them to be one."""

ALIKE = 1e-11
"""Values of ψ [rad] that are nearer are one."""

VAGUE = 1e-4
"""Pieces and gaps [rad] that are shorter, and margins [rad] that are less, may come from a pose's error of 1e-9, which
moves joints by 1e-6 at the margins of `swivel_curves`."""

VAGUEST = 1e-3
"""The same with a straight elbow, where it may move them by 1e-4 and more."""

MEETS = 1e-8
"""How near to its limits [rad] a joint meets these that has them a full turn apart."""

WEIGHTS = np.array([8, 4, 2, 1])
"""What makes a pose and three signs one number."""

SURE = 0.5 * LIMIT_TOLERANCE
"""A joint [rad] that is beyond its limit by less is within it, whatever rounding did."""

AT_ONCE = 256
"""Poses at a time: the tables stay in cache."""


@dataclass(frozen=True, eq=False)
class SwivelPieces:
    """Intervals of ψ within the limits, by pose and by signs.

    row: (p,) the poses; signs: (p, 3) of elbow, shoulder and wrist by their places in `SIGNS`; first, last: (p,) [rad],
    last up to a turn more than first, which is in [-π, π]; whole: (p,) where all of a closed curve is within the
    limits; doubt: (m,) the poses of which it is not certain that these are all.
    """

    row: Index
    signs: Index
    first: Array
    last: Array
    whole: Flags
    doubt: Flags

    def of(self, rows: Flags) -> SwivelPieces:
        """The pieces of some poses (m,)."""
        some = rows[self.row]
        row, signs, whole = self.row[some], self.signs[some], self.whole[some]
        return SwivelPieces(row, signs, self.first[some], self.last[some], whole, self.doubt)


def swivel_pieces(curves: SwivelCurves, limits: Array) -> SwivelPieces:
    """The pieces within limits (7, 2) [rad]."""
    bounds = _bounds(curves.arm, np.asarray(limits, dtype=np.float64).tobytes())
    parts: list[SwivelPieces] = []
    for start in range(0, len(curves.q4), AT_ONCE):
        parts.append(_pieces(curves.of(slice(start, start + AT_ONCE)), bounds))
    if len(parts) == 1:
        return parts[0]
    empty = _pieces(curves.of(slice(0, 0)), bounds)
    row = np.concatenate([empty.row, *(part.row + k * AT_ONCE for k, part in enumerate(parts))])
    signs, first, last, whole, doubt = (
        np.concatenate([getattr(part, name) for part in (empty, *parts)])
        for name in ("signs", "first", "last", "whole", "doubt")
    )
    return SwivelPieces(row, signs, first, last, whole, doubt)


@fact
def _bounds(arm: SwivelArm, limits: bytes) -> SwivelBounds:
    """The equations of limits (7, 2) [rad], given by their bytes."""
    return SwivelBounds(arm, np.frombuffer(limits).reshape(7, 2))


class SwivelBounds:
    """Limits of an arm as equations.

    matrix: (E, 10), value: (E,) of equations in the ten entries of the triples; middle, half: (2, 3, 1) of the triples'
    turns and (2,) of the elbow [rad], offsets included; half is infinite where limits keep no angle out; stops:
    (2, 3, 1) which joints have limits a full turn apart.
    """

    def __init__(self, arm: SwivelArm, limits: Array) -> None:
        low, high = (limits + arm.chain.offsets[:, None]).T
        with np.errstate(invalid="ignore"):
            bounded = high - low <= TURN + LIMIT_TOLERANCE
        stops = bounded & (high - low >= TURN - LIMIT_TOLERANCE)
        middle = np.where(bounded, 0.5 * (np.where(bounded, low, 0.0) + np.where(bounded, high, 0.0)), 0.0)
        half = np.where(bounded & ~stops, 0.5 * (high - low), np.inf)
        self.stops = stops[TRIPLES][:, :, None]
        self.middle, self.half = middle[TRIPLES][:, :, None], half[TRIPLES][:, :, None]
        self.elbow = float(middle[3]), float(half[3])
        rows, values = [], []
        for t, joints in enumerate(TRIPLES):
            for place, joint in enumerate(joints):
                ends = (low[joint], high[joint])[: 2 - int(stops[joint])]
                for end in ends if bounded[joint] else ():
                    row = np.zeros((2, 5))
                    row[t], value = _meeting_limit(arm, t, place, float(end))
                    rows.append(row.reshape(10))
                    values.append(value)
        self.matrix, self.value = np.array(rows).reshape(-1, 10), np.array(values)


def _meeting_limit(arm: SwivelArm, t: int, place: int, end: float) -> tuple[Array, float]:
    """The factors of the entries 13, 23, 33, 31, 32 of triple t, and their sum, where its turn `place` is at an end."""
    triples = arm.triples
    K, L = triples.K[t], triples.L[t]
    c, s = np.cos(end), np.sin(end)
    if place == 1:
        return np.array([0.0, 0.0, 1.0, 0.0, 0.0]), float(triples.k[t] + triples.r[t] * np.cos(end - triples.phi[t]))
    x, y, z = K[:, 2] if place == 0 else L[2]
    if place == 0:
        return np.array([c * x - s * y, s * x + c * y, z, 0.0, 0.0]), float(L[2, 2])
    return np.array([0.0, 0.0, z, c * x + s * y, c * y - s * x]), float(K[2, 2])


def _pieces(curves: SwivelCurves, bounds: SwivelBounds) -> SwivelPieces:
    """The pieces of some poses, few enough for one table."""
    vague = np.where(curves.straight, VAGUEST, VAGUE)
    psi, touched = _meetings(curves, bounds, vague)
    gap = np.diff(psi, axis=2, append=psi[:, :, :1] + TURN)
    margin, stopped = _margins(curves, bounds, np.concatenate([psi, psi + 0.5 * gap], axis=2))
    at, amid = np.split(margin, 2, axis=-1)
    middle, half = bounds.elbow
    away = curves.q4 - middle
    room = np.where(curves.real, half - np.abs(away - TURN * np.round(away / TURN)), -np.inf)
    elbow = room >= -SURE
    within = (amid >= -SURE) & elbow[:, :, None, None, None]
    # What is too short to have an inside is as its neighbour is.
    place, short = np.arange(psi.shape[2]), gap < ALIKE
    place = np.maximum.accumulate(np.where(short, -1, place), axis=2)
    place = np.where(place < 0, place[:, :, -1:], place)
    within = np.take_along_axis(within, place[:, :, None, None], axis=4)
    before = np.roll(within, 1, axis=4)
    begins, ends = within & ~before, before & ~within
    all_round: Flags = np.all(within, axis=4)
    doubt = curves.doubt | np.any(touched & elbow, axis=1) | np.any((room < -SURE) & (room > -vague[:, None]), axis=1)
    apart, there = ~short[:, :, None, None], elbow[:, :, None, None, None]
    if stopped is not None:
        stop = stopped & within & before & apart
        begins, ends = begins | stop, ends | stop
        all_round &= ~stop.any(axis=4)
    least = -vague[:, None, None, None, None]
    doubt |= np.any((amid < -SURE) & (amid > least) & apart & there, axis=(1, 2, 3, 4))
    # On a limit is within it, also in a single point; a little beyond may be rounding.
    alike = (within == before) & apart & there & (at >= least)
    doubt |= np.any(alike & (at < -SURE), axis=(1, 2, 3, 4))
    points = np.argwhere(alike & ~within & (at >= -SURE))
    row, signs, first, last, whole = _runs(psi, begins, ends, all_round, points)
    # Where a joint stops the next piece begins where one ends; any other gap this short may be rounding.
    length, gaps = last - first, first[1:] - last[:-1]
    left_out = TURN - length
    # Of a straight elbow no single point is certain.
    short_piece = (length < vague[row]) & ((length > 0.0) | curves.straight[row])
    doubt[row[short_piece | (~whole & (left_out < vague[row]) & (left_out > ALIKE))]] = True
    same = (np.diff(row) == 0) & np.all(np.diff(signs, axis=0) == 0, axis=1)
    doubt[row[1:][same & (gaps < vague[row[1:]]) & (gaps != 0.0)]] = True
    return SwivelPieces(row, signs, first, last, whole, doubt)


def _meetings(curves: SwivelCurves, bounds: SwivelBounds, vague: Array) -> tuple[Array, Flags]:
    """(m, 2, K) in order the values of ψ in [-π, π] at which a joint may be at a limit; -π in place of missing ones.

    With (m, 2) whether a joint touches one and turns back, or keeps to it, to within vague (m,) [rad].
    """
    m, many = len(curves.q4), len(bounds.value)
    if not many:
        return np.full((m, 2, 1), -np.pi), np.zeros((m, 2), dtype=bool)
    still, cosine, sine = np.moveaxis(bounds.matrix @ curves.entries.reshape(m, 2, 10, 3), 3, 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        swing, off = np.hypot(cosine, sine), bounds.value - still
        x = off / swing
        exists = np.abs(x) <= 1.0 + TOUCHES
        side = np.arccos(np.clip(x, -1.0, 1.0))
    amid = np.arctan2(sine, cosine)
    psi = np.concatenate([amid - side, amid + side], axis=2)
    psi -= TURN * np.round(psi / TURN)
    psi = np.where(np.concatenate([exists, exists], axis=2), psi, -np.pi)
    psi.sort(axis=2)
    return psi, np.any(np.abs(np.abs(off) - swing) < vague[:, None, None], axis=2)


def _margins(curves: SwivelCurves, bounds: SwivelBounds, psi: Array) -> tuple[Array, Flags | None]:
    """(m, 2, 2, 2, K) the least distance from a limit of the joints but the elbow at ψ (m, 2, K), by signs.

    With the flags (m, 2, 2, 2, K / 2) whether at the first half of ψ a joint with limits a full turn apart meets these;
    None for an arm without such a joint.
    """
    turns, _ = curves.turns(psi)
    turns -= bounds.middle[:, None]
    turns -= TURN * np.round(turns / TURN)
    away = np.abs(turns, out=turns)
    margin = np.min(bounds.half[:, None] - away, axis=-2)
    margin = np.minimum(margin[:, :, 0, :, None], margin[:, :, 1, None])
    if not bounds.stops.any():
        return margin, None
    meets = np.any((away[..., : psi.shape[2] // 2] >= np.pi - MEETS) & bounds.stops[:, None], axis=-2)
    return margin, meets[:, :, 0, :, None] | meets[:, :, 1, None]


def _runs(
    psi: Array, opening: Flags, closing: Flags, all_round: Flags, points: Index
) -> tuple[Index, Index, Array, Array, Flags]:
    """Runs of intervals within the limits: poses, signs, first and last ψ, whether they are all of a curve.

    psi: (m, 2, K) where intervals begin; opening, closing: (m, 2, 2, 2, K) whether a run begins there, and whether one
    ends; all_round: (m, 2, 2, 2) the curves that are within the limits everywhere; points: (c, 5) the places of those
    that are in a single point.
    """
    begins, ends = np.argwhere(opening), np.argwhere(closing)
    curve = begins[:, :4] @ WEIGHTS
    opens = np.searchsorted(curve, curve)
    counts = np.searchsorted(curve, curve, side="right") - opens
    # A run that goes on beyond π ends where the first end of its curve is.
    later = ends[opens, 4] <= begins[opens, 4]
    place = opens + (np.arange(len(begins)) - opens + later) % counts
    row, elbow = begins[:, 0], begins[:, 1]
    first, last = psi[row, elbow, begins[:, 4]], psi[row, elbow, ends[place, 4]]
    last = np.where(last <= first, last + TURN, last)
    found, rounds = begins[:, :4], np.argwhere(all_round)
    whole = np.zeros(len(found), dtype=bool)
    if len(rounds) or len(points):
        alone = psi[points[:, 0], points[:, 1], points[:, 4]]
        turn = np.full(len(rounds), np.pi)
        found = np.concatenate([found, rounds, points[:, :4]])
        first, last = np.concatenate([first, -turn, alone]), np.concatenate([last, turn, alone])
        whole = np.concatenate([whole, turn > 0.0, np.zeros(len(points), dtype=bool)])
        order = np.lexsort((first, found @ WEIGHTS))
        found, first, last, whole = found[order], first[order], last[order], whole[order]
    return found[:, 0], found[:, 1:], first, last, whole
