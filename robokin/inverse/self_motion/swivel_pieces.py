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
from robokin.inverse.self_motion.swivel_turns import TRIPLES, turning_levers, turning_numbers
from robokin.kernel.facts import fact
from robokin.model.robot import LIMIT_TOLERANCE

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

CURVES = 8
"""Curves of a pose, by the signs of elbow, shoulder and wrist."""

CODES = np.array([[code >> 2, code >> 1 & 1, code & 1] for code in range(CURVES)])
"""The places of a curve's signs of elbow, shoulder and wrist, by its number."""

SURE = 0.5 * LIMIT_TOLERANCE
"""A joint [rad] that is beyond its limit by less is within it, whatever rounding did."""

AT_ONCE = 256
"""Poses at a time: the tables stay in cache."""


@dataclass(frozen=True, eq=False)
class SwivelPieces:
    """Intervals of ψ within the limits, by pose and by signs.

    row: (p,) the poses; code: (p,) the curves, by their places in `CODES`; first, last: (p,) [rad], last up to a turn
    more than first, which is in [-π, π]; whole: (p,) where all of a closed curve is within the limits; doubt: (m,) the
    poses of which it is not certain that these are all.
    """

    row: Index
    code: Index
    first: Array
    last: Array
    whole: Flags
    doubt: Flags

    @property
    def signs(self) -> Index:
        """(p, 3) of elbow, shoulder and wrist, by their places in `SIGNS`."""
        return CODES[self.code]

    def of(self, rows: Flags) -> SwivelPieces:
        """The pieces of some poses (m,)."""
        some = rows[self.row]
        row, code, whole = self.row[some], self.code[some], self.whole[some]
        return SwivelPieces(row, code, self.first[some], self.last[some], whole, self.doubt)


def swivel_pieces(curves: SwivelCurves, limits: Array) -> SwivelPieces:
    """The pieces within limits (7, 2) [rad]."""
    bounds = swivel_bounds(curves.arm, limits)
    if len(curves.q4) <= AT_ONCE:
        return _pieces(curves, bounds)
    starts = range(0, len(curves.q4), AT_ONCE)
    parts = [_pieces(curves.of(slice(start, start + AT_ONCE)), bounds) for start in starts]
    row = np.concatenate([part.row + start for part, start in zip(parts, starts, strict=True)])
    names = ("code", "first", "last", "whole", "doubt")
    return SwivelPieces(row, *(np.concatenate([getattr(part, name) for part in parts]) for name in names))


def swivel_bounds(arm: SwivelArm, limits: Array) -> SwivelBounds:
    """The equations of limits (7, 2) [rad]."""
    return _bounds(arm, np.asarray(limits, dtype=np.float64).tobytes())


@fact
def _bounds(arm: SwivelArm, limits: bytes) -> SwivelBounds:
    """The equations of limits (7, 2) [rad], given by their bytes."""
    return SwivelBounds(arm, np.frombuffer(limits).reshape(7, 2))


class SwivelBounds:
    """Limits of an arm as equations.

    matrix: (E, 10), value: (E,) of equations in the ten entries of the triples; middle, half: (3, 1, 1, 2, 1, 1) of the
    triples' turns and (2,) of the elbow [rad], offsets included; half is infinite where limits keep no angle out;
    stops: the same, which joints have limits a full turn apart; stopping: whether some have; levers: those of
    `turning_levers` for the middles.
    """

    def __init__(self, arm: SwivelArm, limits: Array) -> None:
        low, high = (limits + arm.chain.offsets[:, None]).T
        with np.errstate(invalid="ignore"):
            bounded = high - low <= TURN + LIMIT_TOLERANCE
        stops = bounded & (high - low >= TURN - LIMIT_TOLERANCE)
        middle = np.where(bounded, 0.5 * (np.where(bounded, low, 0.0) + np.where(bounded, high, 0.0)), 0.0)
        half = np.where(bounded & ~stops, 0.5 * (high - low), np.inf)
        self.stopping = bool(stops[TRIPLES].any())
        self.middle, self.half, self.stops = (
            number[TRIPLES].T[:, None, None, :, None, None] for number in (middle, half, stops)
        )
        self.elbow = float(middle[3]), float(half[3])
        self.arm, self.levers = arm, turning_levers(arm.triples, middle[TRIPLES].T)
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
    m, vague = len(curves.q4), np.where(curves.straight, VAGUEST, VAGUE)
    least = -vague[:, None]
    psi, touched = meetings(curves.entries, bounds, vague)
    gap = np.empty(psi.shape)
    np.subtract(psi[..., 1:], psi[..., :-1], out=gap[..., :-1])
    gap[..., -1] = psi[..., 0] + TURN - psi[..., -1]
    # What is too short to have an inside is as its neighbour is.
    short = gap < ALIKE
    amid = _neighbours(psi + 0.5 * gap, short)
    margin, stopped = _margins(curves, bounds, np.concatenate([psi, amid], axis=2))
    away = curves.q4 - bounds.elbow[0]
    room = np.where(curves.real, bounds.elbow[1] - np.abs(away - TURN * np.rint(away / TURN)), -np.inf)
    elbow = room >= -SURE
    doubt = curves.doubt | np.logical_or.reduce((touched & elbow) | ((room < -SURE) & (room > least)), axis=1)
    if not elbow.all():
        margin[~elbow] = -np.inf
    least = least[:, None, None, None]
    at, amid = margin[..., : psi.shape[2]], margin[..., psi.shape[2] :]
    within = amid >= -SURE
    before = np.empty(within.shape, dtype=bool)
    before[..., 1:], before[..., 0] = within[..., :-1], within[..., -1]
    begins, ends = within > before, before > within
    all_round: Flags = np.logical_and.reduce(within, axis=4)
    apart = ~short[:, :, None, None]
    if stopped is not None:
        stop = stopped & within & before & apart
        begins, ends = begins | stop, ends | stop
        all_round &= ~np.logical_or.reduce(stop, axis=4)
    # On a limit is within it, also in a single point; a little beyond may be rounding.
    alike = (within == before) & apart & (at >= least)
    vaguely = (amid > least) > within
    vaguely |= alike & (at < -SURE)
    doubt |= np.logical_or.reduce(vaguely.reshape(m, -1), axis=1)
    points = np.flatnonzero((alike & (at >= -SURE)) > within)
    curve, first, last, whole = _runs(psi, np.flatnonzero(begins), np.flatnonzero(ends), all_round.reshape(-1), points)
    row = curve // CURVES
    # Where a joint stops the next piece begins where one ends; any other gap this short may be rounding.
    length, gaps, bound = last - first, first[1:] - last[:-1], vague[row]
    left_out = TURN - length
    # Of a straight elbow no single point is certain.
    short_piece = (length < bound) & ((length > 0.0) | curves.straight[row])
    short_piece |= (left_out < bound) & (left_out > ALIKE) & ~whole
    short_piece[1:] |= (curve[1:] == curve[:-1]) & (gaps < bound[1:]) & (gaps != 0.0)
    if short_piece.any():
        doubt[row[short_piece]] = True
    return SwivelPieces(row, curve % CURVES, first, last, whole, doubt)


def _neighbours(amid: Array, short: Flags) -> Array:
    """Midway places (m, 2, K) with those of intervals that are too short replaced by those of the intervals before."""
    place = np.where(short, -1, np.arange(amid.shape[2]))
    np.maximum.accumulate(place, axis=2, out=place)
    place = np.where(place < 0, place[:, :, -1:], place).reshape(-1, amid.shape[2])
    place += np.arange(0, amid.size, amid.shape[2])[:, None]
    return amid.reshape(-1)[place].reshape(amid.shape)


def meetings(entries: Array, bounds: SwivelBounds, vague: Array) -> tuple[Array, Flags]:
    """(m, 2, K) in order the values of ψ in [-π, π] at which a joint may be at a limit; -π in place of missing ones.

    With (m, 2) whether a joint touches one and turns back, or keeps to it, to within vague (m,) [rad].
    """
    m, many = len(entries), len(bounds.value)
    if not many:
        return np.full((m, 2, 1), -np.pi), np.zeros((m, 2), dtype=bool)
    still, cosine, sine = (bounds.matrix @ entries.reshape(m, 2, 10, 3)).transpose(3, 0, 1, 2)
    swing, off = np.hypot(cosine, sine), bounds.value - still
    # Where nothing swings, no place meets a limit.
    x = off / np.maximum(swing, 1e-300)
    side = np.arccos(np.minimum(np.maximum(x, -1.0), 1.0))
    amid = np.arctan2(sine, cosine)
    psi = np.empty((m, 2, 2 * many))
    np.subtract(amid, side, out=psi[..., :many])
    np.add(amid, side, out=psi[..., many:])
    psi -= TURN * np.rint(psi / TURN)
    missing = np.abs(x) > 1.0 + TOUCHES
    psi[..., :many][missing] = psi[..., many:][missing] = -np.pi
    psi.sort(axis=2)
    touches = np.abs(np.abs(off) - swing) < vague[:, None, None]
    return psi, np.logical_or.reduce(touches, axis=2)


def _margins(curves: SwivelCurves, bounds: SwivelBounds, psi: Array) -> tuple[Array, Flags | None]:
    """(m, 2, 2, 2, K) the least distance from a limit of the joints but the elbow at ψ (m, 2, K), by signs.

    With the flags (m, 2, 2, 2, K / 2) whether at the first half of ψ a joint with limits a full turn apart meets these;
    None for an arm without such a joint.
    """
    away = turned_away(curves.entries_at(psi), bounds)
    margin = np.minimum.reduce(bounds.half - away, axis=0)
    margin = np.minimum(margin[:, :, 0, :, None], margin[:, :, 1, None])
    if not bounds.stopping:
        return margin, None
    meets = np.logical_or.reduce((away[..., : psi.shape[2] // 2] >= np.pi - MEETS) & bounds.stops, axis=0)
    return margin, meets[:, :, 0, :, None] | meets[:, :, 1, None]


def turned_away(g: Array, bounds: SwivelBounds) -> Array:
    """How far (3, ..., 2, 2, K) [rad] the turns of triples are from the middle of their limits, by both signs.

    g: (5, ..., 2, K) the entries 13, 23, 33, 31, 32 of the triples. The turns are turned back by the middles as complex
    numbers, so that there are no full turns to look at.
    """
    amid, side, ends = turning_numbers(g, bounds.arm.triples, bounds.levers)
    turned = np.empty((*amid.shape[:-1], 2, amid.shape[-1]), dtype=complex)
    np.add(amid, side, out=turned[..., 0, :])
    np.subtract(amid, side, out=turned[..., 1, :])
    turned[0::2] *= ends[..., None, :]
    away = np.arctan2(turned.imag, turned.real)
    return np.asarray(np.abs(away, out=away))


def _runs(psi: Array, begins: Index, ends: Index, all_round: Flags, points: Index) -> tuple[Index, Array, Array, Flags]:
    """Runs of intervals within the limits: curves, first and last ψ, whether they are all of a curve.

    psi: (m, 2, K) where intervals begin; begins, ends: places in (m, 2, 2, 2, K) where runs begin, and where they end;
    all_round: (8 m,) the curves that are within the limits everywhere; points: places of those in a single point.
    """
    K, places = psi.shape[2], psi.reshape(-1)
    curve = begins // K
    opens = curve.searchsorted(curve)
    counts = curve.searchsorted(curve, side="right") - opens
    # A run that goes on beyond π ends where the first end of its curve is.
    later = ends[opens] <= begins[opens]
    closes = ends[opens + (np.arange(len(begins)) - opens + later) % counts]
    elbow = (curve // 4 - curve) * K
    first, last = places[begins + elbow], places[closes + elbow]
    last[last <= first] += TURN
    whole = np.zeros(len(curve), dtype=bool)
    rounds = np.flatnonzero(all_round)
    if len(rounds) or len(points):
        own = points // K
        alone, turn = places[points + (own // 4 - own) * K], np.full(len(rounds), np.pi)
        curve = np.concatenate([curve, rounds, own])
        first, last = np.concatenate([first, -turn, alone]), np.concatenate([last, turn, alone])
        whole = np.concatenate([whole, turn > 0.0, np.zeros(len(own), dtype=bool)])
        order = np.lexsort((first, curve))
        curve, first, last, whole = curve[order], first[order], last[order], whole[order]
    return curve, first, last, whole
