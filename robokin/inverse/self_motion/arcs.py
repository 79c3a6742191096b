"""The pieces of self-motions that are within the joint limits.

Statement. Of curves of configurations that each reach one pose, find the pieces whose joint values are within the
limits, angles counting modulo full turns, with exact ends.
Derivation. Samples on the curve (`track`) are so chosen that the margin from the limits changes its sign once at most
between two of them. From the sample with the greatest margin samples are taken both ways while the limits hold; the
ends are zeros of the margin. Along a piece no joint makes a full turn at once, so each joint's number of turns is
chosen once, where the piece begins to grow. Samples that no piece has taken begin the next one: where limits are as
wide as a turn or wider, pieces with different numbers of turns may share configurations.
Degenerate case. A curve may touch the limits in one configuration: a piece of one point.

Here x are joint values [rad | size] and lengths are in the arm's size.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from robokin.arrays import Array, Index
from robokin.inverse.self_motion.curve_tracing import Curve
from robokin.inverse.self_motion.native_curves import native_pieces
from robokin.inverse.self_motion.pose_correction import CLOSES, corrected
from robokin.inverse.self_motion.track import CROSSING, ROUNDING, Tracks, zeros
from robokin.inverse.solutions import Arc
from robokin.kernel.chain import Chain

ON_LIMIT = 1e-12
"""A margin [rad | size] up to which a configuration is at a limit."""

FINE = 8
"""Configurations of an arc for each point of the curve: some 0.02 [rad | size] apart, so that straight pieces between
them are off by 1e-4 at most."""

END = 1e-5
"""The end of a piece is found so near [rad | size] at least, and then put on the limit."""

POINT = 1e-9
"""A piece that is shorter, as a part of a step of its curve, is a point: places are known to about that."""

ONE_POINT = 1e-9
"""Configurations whose joint values [rad | m] differ by less are one point of a curve that touches its limits."""

INNER = 5
"""Points of an arc that is shorter than a step of its curve."""


class CurvePiece(NamedTuple):
    """A piece of a curve within the limits.

    curve: its number, from 0; first, last: its places on the curve; turns: (n,) full turns [rad] added to each joint;
    whole: whether it is all of a closed curve.
    """

    curve: int
    first: float
    last: float
    turns: Array
    whole: bool


def arcs_within(curve: Curve, chain: Chain, T: Array, limits: Array, size: float) -> tuple[Arc, ...]:
    """The pieces of a self-motion at T (4, 4) within limits (own, 2) [rad | m] of the arm's own joints.

    Each has its ends exactly; the joints beyond `own` are those that the task leaves open. For a surface: those of
    the curves that were followed on it.
    """
    return arcs_of_each([curve], chain, T[None], limits, size)[0]


def arcs_of_each(curves: Sequence[Curve], chain: Chain, T: Array, limits: Array, size: float) -> list[tuple[Arc, ...]]:
    """`arcs_within` of each of some self-motions at T (k, 4, 4)."""
    parts = [(k, part) for k, curve in enumerate(curves) for part in curve.sheets or (curve,)]
    of = np.array([k for k, _ in parts], dtype=np.intp)
    tracks = Tracks([part for _, part in parts], chain, T[of], limits, size)
    arcs: list[list[Arc]] = [[] for _ in curves]
    known = native_pieces(tracks)
    if known is None:
        found = pieces(tracks)
        known = [(piece.curve, arc) for piece, arc in zip(found, _arcs(tracks, found), strict=True)]
    for k, arc in known:
        arcs[of[k]].append(arc)
    return [_each_once(some) for some in arcs]


def _each_once(arcs: list[Arc]) -> tuple[Arc, ...]:
    """The arcs without points of others: where a curve touches its limits rounding may find the place twice."""
    points = [k for k, arc in enumerate(arcs) if len(arc.q) == 1]
    again = {
        k
        for k in points
        for i, other in enumerate(arcs)
        if i != k and not (k < i and i in points) and np.min(np.max(np.abs(other.q - arcs[k].q), axis=1)) <= ONE_POINT
    }
    return tuple(arc for k, arc in enumerate(arcs) if k not in again)


def _arcs(tracks: Tracks, found: list[CurvePiece]) -> list[Arc]:
    """Pieces as configurations: their ends and the curve's points between them."""
    if not found:
        return []
    places = [_places(piece) for piece in found]
    counts = np.array([len(u) for u in places])
    piece = np.repeat(np.arange(len(found)), counts)
    curve, turns = np.array([one.curve for one in found], dtype=np.intp), np.array([one.turns for one in found])
    x = tracks.at(curve[piece], np.concatenate(places)) + turns[piece]
    last = np.cumsum(counts) - 1
    open_ = np.flatnonzero([not one.whole for one in found])
    ends = np.unique(np.concatenate([(last - counts + 1)[open_], last[open_]]))
    x[ends] = _on_limits(tracks, curve[piece[ends]], x[ends])
    parts = np.split((x * tracks.scale)[:, : tracks.own], last[:-1] + 1)
    return [Arc(part, one.whole) for part, one in zip(parts, found, strict=True)]


def _places(piece: CurvePiece) -> Array:
    """The places of a piece's configurations."""
    if piece.last - piece.first <= POINT:
        return np.array([0.5 * (piece.first + piece.last)])
    inner = np.arange(np.floor(piece.first * FINE) + 1.0, np.ceil(piece.last * FINE)) / FINE
    if len(inner) < INNER - 2:
        return np.linspace(piece.first, piece.last, INNER)
    return np.concatenate([[piece.first], inner, [piece.last]])


def _on_limits(tracks: Tracks, k: Index, x: Array) -> Array:
    """Ends (m, n) of pieces of curves k (m,), each with the joint that ends it at its limit exactly.

    Where a curve bends at once the polynomial that the end was found with is off by some 1e-8.
    """
    moving = tracks.moving[k]
    low, high = np.where(moving, tracks.low, -np.inf), np.where(moving, tracks.high, np.inf)
    beyond = np.concatenate([low - x, x - high], axis=1)
    worst = np.argmax(beyond, axis=1)
    joint = worst % x.shape[1]
    rows = np.flatnonzero(np.abs(beyond[np.arange(len(x)), worst]) <= END)
    if not len(rows):
        return x
    start, joint = x[rows], joint[rows]
    start[np.arange(len(rows)), joint] = np.where(worst[rows] < x.shape[1], tracks.low[joint], tracks.high[joint])
    held = np.eye(x.shape[1])[joint, None]
    new, off, _ = corrected(tracks.chain, tracks.T[k[rows]], start, tracks.size, held, settled=ROUNDING, zero=CROSSING)
    good = (off <= CLOSES) & (np.max(np.abs(new - x[rows]), axis=1) <= END)
    good &= tracks.is_inside(new, np.zeros(x.shape[1]))
    out = x.copy()
    out[rows[good]] = new[good]
    return out


def pieces(tracks: Tracks) -> list[CurvePiece]:
    """The pieces of curves within the limits, by curve, that with the greatest margin first."""
    runs: list[_Run] = []
    for k, (u, x) in enumerate(tracks.samples()):
        depth = np.where(tracks.is_inside(x), tracks.margin(np.full(len(x), k), x), -np.inf)
        while depth.max() > -np.inf:
            run = _run(tracks, k, u, x, int(np.argmax(depth)))
            depth[run.covered] = -np.inf
            if tracks.closed[k]:
                depth[-1] = min(depth[0], depth[-1])
            runs.append(run)
    found = []
    for run, (first, last) in zip(runs, _ends(tracks, runs).tolist(), strict=True):
        length = float(tracks.last[run.curve])
        whole = bool(tracks.closed[run.curve]) and last - first >= length - 1e-9
        if whole:
            # One round, with the start amid it as far as the limits allow.
            first = min(max(run.start - 0.5 * length, first), last - length)
            last = first + length
        found.append(CurvePiece(run.curve, first, last, run.turns, whole))
    return found


class _Run(NamedTuple):
    """Samples in a row within the limits, with given full turns (n,).

    curve: its number; start: the place from which it was followed; inside: its first and last place; outside: the
    places beyond them, the same where the curve ends; covered: its samples, as indices.
    """

    curve: int
    start: float
    turns: Array
    inside: tuple[float, float]
    outside: tuple[float, float]
    covered: Index


def _run(tracks: Tracks, k: int, u: Array, x: Array, start: int) -> _Run:
    """From sample `start` of curve k both ways while the limits hold with the full turns chosen there."""
    turns = tracks.turned(x[start : start + 1])[0]
    closed = tracks.closed[k]
    count = len(u) - 1 if closed else len(u)
    inside, outside, covered = [], [], []
    for step in (-1, 1):
        if closed:
            order = start + step * np.arange(count + 1)
            rounds = order // count
            order = order % count
            values, places = x[order] + rounds[:, None] * tracks.round[k], u[order] + rounds * tracks.last[k]
        else:
            order = np.arange(start, len(u)) if step == 1 else np.arange(start, -1, -1)
            values, places = x[order], u[order]
        fits = tracks.is_inside(values, turns)
        fits[0] = True
        stop = len(fits) if fits.all() else int(np.argmin(fits))
        covered.append(order[:stop])
        inside.append(float(places[stop - 1]))
        outside.append(float(places[min(stop, len(places) - 1)]))
    ends = (inside[0], inside[1]), (outside[0], outside[1])
    return _Run(k, float(u[start]), turns, *ends, np.concatenate(covered))


def _ends(tracks: Tracks, runs: list[_Run]) -> Array:
    """(r, 2) the places of the ends of runs."""
    if not runs:
        return np.empty((0, 2))
    k = np.repeat([run.curve for run in runs], 2)
    inside = np.array([run.inside for run in runs]).reshape(-1)
    outside = np.array([run.outside for run in runs]).reshape(-1)
    turns = np.repeat(np.array([run.turns for run in runs]), 2, axis=0)
    out = inside.copy()
    both = np.concatenate([k, k])
    at_ends = tracks.at(both, np.concatenate([inside, outside]))
    within, beyond = np.split(tracks.margin(both, at_ends, np.concatenate([turns, turns])), 2)
    rows = np.flatnonzero((inside != outside) & (within > ON_LIMIT) & (beyond < 0.0))
    if len(rows):
        some = turns[rows]
        out[rows] = zeros(tracks, k[rows], inside[rows], outside[rows], lambda i, k, x: tracks.margin(k, x, some[i]))
    return out.reshape(-1, 2)
