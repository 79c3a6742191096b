"""Pieces of self-motions in the swivel angle as configurations in order, joint values going on without jumps.

Statement. Give for intervals of ψ (`swivel_pieces`) configurations along them, so close that straight lines between
them will do, with full turns of the joints such that these are within their limits throughout.
Derivation. Values of ψ a degree apart, and between them as many more as keep each joint's step small: next to a
straight shoulder or wrist two joints turn fast. Angles are unwrapped along each piece, and each joint then gets the one
number of full turns that brings it into its limits.
Degenerate case. Where limits are more than a turn apart a joint may turn on beyond one of them within a piece that no
number of turns fits: such a piece is told to be more than one.
"""

from __future__ import annotations

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.inverse.self_motion.swivel_curves import TURN, SwivelCurves
from robokin.inverse.self_motion.swivel_pieces import SwivelPieces
from robokin.inverse.verify import HALF_TURN
from robokin.model.robot import LIMIT_TOLERANCE

FINE = np.radians(1.0)
"""Distance [rad] of ψ between two configurations."""

FEWEST = 5
"""Configurations of a piece at least."""

STEP = 0.04
"""The longest step of a joint [rad]."""

HALVINGS = 24
"""How often a distance of ψ is halved at most: to 1e-9."""


def swivel_arcs(curves: SwivelCurves, pieces: SwivelPieces, chosen: Index, limits: Array) -> tuple[list[Array], Flags]:
    """Configurations (k, 7) [rad] along the chosen pieces, and (p,) whether full turns bring each into its limits.

    limits: (7, 2) [rad], infinite where they do not count.
    """
    first, last = pieces.first[chosen], pieces.last[chosen]
    counts = np.where(last > first, np.maximum(np.ceil((last - first) / FINE).astype(np.intp) + 1, FEWEST), 1)
    of = np.repeat(np.arange(len(chosen)), counts)
    rank = np.arange(len(of)) - np.repeat(np.cumsum(counts) - counts, counts)
    part = rank / np.maximum(counts - 1, 1)[of]
    psi = np.where(rank == (counts - 1)[of], last[of], first[of] + part * (last - first)[of])
    row, signs = pieces.row[chosen], pieces.signs[chosen]
    q = curves.configurations(row[of], signs[of], psi)
    for _ in range(HALVINGS):
        wide = np.flatnonzero((np.diff(of) == 0) & (np.max(np.abs(_between(q)), axis=1, initial=0.0) > STEP))
        if not len(wide):
            break
        amid = 0.5 * (psi[wide] + psi[wide + 1])
        more = curves.configurations(row[of[wide]], signs[of[wide]], amid)
        psi, q, of = (
            np.insert(psi, wide + 1, amid),
            np.insert(q, wide + 1, more, axis=0),
            np.insert(of, wide + 1, of[wide]),
        )
    steps = np.where((np.diff(of) == 0)[:, None], _between(q), 0.0)
    starts = np.flatnonzero(np.diff(of, prepend=-1))
    walked = np.concatenate([np.zeros((1, 7)), np.cumsum(steps, axis=0)])
    q = q[starts][of] + walked - walked[starts][of]
    return _turned_into(q, starts, of, limits)


def _between(q: Array) -> Array:
    """Steps (k - 1, 7) between configurations, the short way."""
    step = np.diff(q, axis=0)
    return np.asarray(step - TURN * np.round(step / TURN))


def _turned_into(q: Array, starts: Index, of: Index, limits: Array) -> tuple[list[Array], Flags]:
    """Configurations (k, 7) of pieces of, which begin at some (p,), with each joint turned into its limits, and whether
    all could be."""
    low, high = limits.T
    least, most = np.minimum.reduceat(q, starts, axis=0), np.maximum.reduceat(q, starts, axis=0)
    with np.errstate(invalid="ignore"):
        fewest = np.ceil((low - LIMIT_TOLERANCE - least) / TURN)
        greatest = np.floor((high + LIMIT_TOLERANCE - most) / TURN)
    fits = np.all(fewest <= greatest, axis=1)
    # -180° is 180°, whatever the last digits say.
    wish = -np.ceil(0.5 * (least + most) / TURN - 0.5 - HALF_TURN)
    turns = np.where(fits[:, None], np.clip(wish, fewest, np.maximum(greatest, fewest)), wish)
    q = q + TURN * turns[of]
    near = np.clip(q, low, high)
    q = np.where(np.abs(near - q) <= 2.0 * LIMIT_TOLERANCE, near, q)
    return np.split(q, starts[1:]), fits
