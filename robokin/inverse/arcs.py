"""The pieces of a self-motion that are within the joint limits.

Statement. Of a curve of configurations that reach one pose, find the pieces whose joint values are within the limits,
angles counting modulo full turns, with exact ends.
Derivation. Samples on the curve (`track`) are so chosen that the margin from the limits changes its sign once at most
between two of them. From the sample with the greatest margin samples are taken both ways while the limits hold; the
ends are zeros of the margin. Along a piece no joint makes a full turn at once, so each joint's number of turns is
chosen once, where the piece begins to grow. Samples that no piece has taken begin the next one: where limits are as
wide as a turn or wider, pieces with different numbers of turns may share configurations.
Degenerate case. A curve may touch the limits in one configuration: a piece of one point.

Here x are joint values [rad | size] and lengths are in the arm's size.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robokin.inverse.curve_tracing import Curve
from robokin.inverse.null_motion import CLOSES, corrected
from robokin.inverse.result import Arc
from robokin.inverse.track import CROSSING, ROUNDING, Track, zeros
from robokin.kinematics.chain import Chain

Array = NDArray[np.float64]

ON_LIMIT = 1e-12
"""A margin [rad | size] up to which a configuration is at a limit."""

FINE = 8
"""Configurations of an arc for each point of the curve: some 0.02 [rad | size] apart, so that straight pieces between
them are off by 1e-4 at most."""

END = 1e-5
"""The end of a piece is found so near [rad | size] at least, and then put on the limit."""

INNER = 5
"""Points of an arc that is shorter than a step of its curve."""


class Piece(NamedTuple):
    """A piece of a curve within the limits.

    first, last: its places on the curve; turns: (n,) full turns [rad] added to each joint; whole: whether it is all
    of a closed curve.
    """

    first: float
    last: float
    turns: Array
    whole: bool


def arcs_within(curve: Curve, chain: Chain, T: Array, limits: Array, size: float) -> tuple[Arc, ...]:
    """The pieces of a self-motion at T (4, 4) within limits (own, 2) [rad | m] of the arm's own joints.

    Each has its ends exactly; the joints beyond `own` are those that the task leaves open. For a surface: those of
    the curves that were followed on it.
    """
    arcs: list[Arc] = []
    for part in curve.sheets or (curve,):
        track = Track(part, chain, T, limits, size)
        arcs.extend(_arc(track, piece) for piece in pieces(track))
    return tuple(arcs)


def _arc(track: Track, piece: Piece) -> Arc:
    """A piece as configurations: its ends and the curve's points between them."""
    inner = np.arange(np.floor(piece.first * FINE) + 1.0, np.ceil(piece.last * FINE)) / FINE
    if piece.last == piece.first:
        u = np.array([piece.first])
    elif len(inner) < INNER - 2:
        u = np.linspace(piece.first, piece.last, INNER)
    else:
        u = np.concatenate([[piece.first], inner, [piece.last]])
    x = track.at(u) + piece.turns
    if not piece.whole:
        x[[0, -1]] = _on_limits(track, x[[0, -1]])
    return Arc((x * track.scale)[:, : track.own], piece.whole)


def _on_limits(track: Track, x: Array) -> Array:
    """Ends of pieces (m, n), each with the joint that ends it at its limit exactly.

    Where a curve bends at once the polynomial that the end was found with is off by some 1e-8.
    """
    low, high = np.where(track.moving, track.low, -np.inf), np.where(track.moving, track.high, np.inf)
    beyond = np.concatenate([low - x, x - high], axis=1)
    worst = np.argmax(beyond, axis=1)
    joint = worst % x.shape[1]
    rows = np.flatnonzero(np.abs(beyond[np.arange(len(x)), worst]) <= END)
    start = x[rows]
    start[np.arange(len(rows)), joint[rows]] = np.where(worst < x.shape[1], low[joint], high[joint])[rows]
    held = np.eye(x.shape[1])[joint[rows], None]
    many = np.broadcast_to(track.T, (len(rows), 4, 4))
    new, off, _ = corrected(track.chain, many, start, track.size, held, settled=ROUNDING, zero=CROSSING)
    good = (off <= CLOSES) & (np.max(np.abs(new - x[rows]), axis=1) <= END) & track.is_inside(new, np.zeros(x.shape[1]))
    out = x.copy()
    out[rows[good]] = new[good]
    return out


def pieces(track: Track) -> list[Piece]:
    """The pieces of a curve within the limits, that with the greatest margin first."""
    u, x = track.samples
    depth = np.where(track.is_inside(x), track.margin(x), -np.inf)
    runs: list[_Run] = []
    while depth.max() > -np.inf:
        run = _run(track, u, x, int(np.argmax(depth)))
        depth[run.covered] = -np.inf
        if track.curve.closed:
            depth[-1] = min(depth[0], depth[-1])
        runs.append(run)
    found = []
    for run, (first, last) in zip(runs, _ends(track, runs).tolist(), strict=True):
        whole = track.curve.closed and last - first >= track.last - 1e-9
        if whole:
            # One round, with the start amid it as far as the limits allow.
            first = min(max(run.start - 0.5 * track.last, first), last - track.last)
            last = first + track.last
        found.append(Piece(first, last, run.turns, whole))
    return found


class _Run(NamedTuple):
    """Samples in a row within the limits, with given full turns (n,).

    start: the place from which it was followed; inside: its first and last place; outside: the places beyond them,
    the same where the curve ends; covered: its samples, as indices.
    """

    start: float
    turns: Array
    inside: tuple[float, float]
    outside: tuple[float, float]
    covered: Array


def _run(track: Track, u: Array, x: Array, start: int) -> _Run:
    """From sample `start` both ways while the limits hold with the full turns chosen there."""
    turns = track.turned(x[start : start + 1])[0]
    closed = track.curve.closed
    count = len(u) - 1 if closed else len(u)
    inside, outside, covered = [], [], []
    for step in (-1, 1):
        if closed:
            order = start + step * np.arange(count + 1)
            rounds = order // count
            order = order % count
            values, places = x[order] + rounds[:, None] * track.round, u[order] + rounds * track.last
        else:
            order = np.arange(start, len(u)) if step == 1 else np.arange(start, -1, -1)
            values, places = x[order], u[order]
        fits = track.is_inside(values, turns)
        fits[0] = True
        stop = len(fits) if fits.all() else int(np.argmin(fits))
        covered.append(order[:stop])
        inside.append(float(places[stop - 1]))
        outside.append(float(places[min(stop, len(places) - 1)]))
    return _Run(float(u[start]), turns, (inside[0], inside[1]), (outside[0], outside[1]), np.concatenate(covered))


def _ends(track: Track, runs: list[_Run]) -> Array:
    """(k, 2) the places of the ends of runs."""
    if not runs:
        return np.empty((0, 2))
    inside = np.array([run.inside for run in runs]).reshape(-1)
    outside = np.array([run.outside for run in runs]).reshape(-1)
    turns = np.repeat(np.array([run.turns for run in runs]), 2, axis=0)
    out = inside.copy()
    margins = track.margin(track.at(inside), turns), track.margin(track.at(outside), turns)
    rows = np.flatnonzero((inside != outside) & (margins[0] > ON_LIMIT) & (margins[1] < 0.0))
    if len(rows):
        out[rows] = zeros(track, inside[rows], outside[rows], turns[rows])
    return out.reshape(-1, 2)
