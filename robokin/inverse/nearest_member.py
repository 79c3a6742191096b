"""The member of a self-motion that is nearest to a wish.

Statement. Of the configurations of a self-motion that are within the joint limits, find that whose greatest joint move
from a wish is least, angles turned as near to it as the limits allow.
Derivation. Along each piece within the limits (`arcs`) the greatest move is sampled; its least value is sought beside
the samples that are lower than their neighbours, and at the pieces' ends. A wish that is a member itself is the answer.
Degenerate case. On a surface steps from its known points towards the wish, within the null space, end at members that
are near in the sense of least squares: a good one, not proven the nearest.

Here x are joint values [rad | size] and lengths are in the arm's size.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robokin.inverse.arcs import pieces
from robokin.inverse.curve_tracing import Curve
from robokin.inverse.fronts import LONGEST, TURN
from robokin.inverse.null_motion import CLOSES, ZERO, corrected, errors
from robokin.inverse.solution_sets import on_curve, turned_gap
from robokin.inverse.track import KINK, PARTS, Track, least
from robokin.kinematics.chain import Chain

Array = NDArray[np.float64]

CANDIDATES = 4
"""Local minima of the move from a wish that are refined on each piece."""

TYPED = 1e-3
"""A wish that misses the pose by more [size and rad] is no member. What is typed with four digits is nearer."""

REACHES = 1e-9
"""A wish that misses the pose by less [size and rad] is a solution as it stands."""

STRAIGHT = 1e-6
"""Tangents that differ by less may be those of a straight line: of joints that have one axis."""

LINE_STEP = 0.3
"""How far [rad | size] a straight curve is looked at from one of its points: they are 0.15 apart."""

LINE_CUTS, LINE_ROUNDS = 32, 13
"""Parts that it is cut into in each round, of which two remain: 1e-16 of the way in the end."""

OTHERS = 1e-7
"""Weight of the other joints' moves: it shifts the greatest move by less than anyone asks for."""

STILL = 1e-12
"""Differences of the greatest move below this [rad | size] are rounding of joints that stand still."""

WALK = 25
"""Steps of a walk towards a wish on a surface at most."""


def nearest_on(curve: Curve, chain: Chain, T: Array, near: Array, limits: Array, size: float) -> Array | None:
    """The member (own,) [rad | m] of a self-motion at T (4, 4) that is nearest to `near` (own,), within the limits.

    limits: (own, 2) of the arm's own joints; nearest by the greatest joint move, angles turned as near as the limits
    allow. None where no member is within the limits. Of a surface one that is found nearest from several guesses.
    """
    tracks = [Track(part, chain, T, limits, size) for part in curve.sheets or (curve,)]
    track = tracks[0]
    itself = _itself(track, curve, near)
    if itself is not None:
        return itself
    wish = near / track.scale[: track.own]
    found = [_nearest_of_pieces(part, wish) for part in tracks]
    if curve.sheets:
        found.append(_nearest_on_surface(track, curve, wish))
    rows = np.array([x for x in found if x is not None]).reshape(-1, chain.n)
    if not len(rows):
        return None
    best = rows[np.argmin(moves(track, rows, wish))]
    return np.asarray(nearest_turns(track, best[None], wish)[0, : track.own] * track.scale[: track.own])


def member_near(curve: Curve, chain: Chain, T: Array, wish: Array, limits: Array, size: float) -> Array | None:
    """A member (own,) [rad | m] within the limits (own, 2) that is about as near to the wish (own,) as any.

    It is the nearest one beside the nearest of the points that the curve was followed by, which spares most of what
    `nearest_on` does; that is asked where none of those points is within the limits.
    """
    track = Track(curve, chain, T, limits, size)
    inside = np.flatnonzero(track.is_inside(track.points))
    if curve.sheets or not len(inside):
        return nearest_on(curve, chain, T, wish, limits, size)
    x = wish / track.scale[: track.own]
    best = int(inside[np.argmin(moves(track, track.points[inside], x))])
    rows = track.points[best][None]
    sides = [(i, i + 1) for i in (best - 1, best) if i >= 0 and i + 1 <= track.last]
    sides = [side for side in sides if track.is_inside(track.points[list(side)]).all()]
    if sides:
        a, b = np.array(sides, dtype=np.float64).T
        rows = np.concatenate([rows, track.at(least(track, a, b, lambda y: moves(track, y, x))[0])])
        rows = rows[track.is_inside(rows)]
    straight = _on_line(track, best, x)
    if straight is not None:
        rows = straight[None]
    nearest = rows[np.argmin(moves(track, rows, x))]
    return np.asarray(nearest_turns(track, nearest[None], x)[0, : track.own] * track.scale[: track.own])


def _on_line(track: Track, best: int, wish: Array) -> Array | None:
    """The point (n,) within the limits nearest to the wish (own,) beside point `best` of a straight curve.

    None for another curve. The greatest move along a line is a convex function: it is least beside the least of some
    points. The point itself is the middle one of them.
    """
    t = track.tangents[best]
    if len(track.points) < 3 or np.max(np.abs(track.tangents - t)) > STRAIGHT:
        return None
    low, high, cuts = -LINE_STEP, LINE_STEP, np.linspace(0.0, 1.0, LINE_CUTS + 1)
    for _ in range(LINE_ROUNDS):
        parts = low + (high - low) * cuts
        rows = track.points[best] + parts[:, None] * t
        i = int(np.argmin(np.where(track.is_inside(rows), moves(track, rows, wish), np.inf)))
        low, high, x = parts[max(i - 1, 0)], parts[min(i + 1, LINE_CUTS)], rows[i]
    e, _ = errors(track.chain, track.T[None], x[None], track.size)
    return x if track.is_inside(x[None])[0] and float(np.max(np.abs(e))) <= REACHES else None


def _itself(track: Track, curve: Curve, near: Array) -> Array | None:
    """`near` (own,) itself, if it reaches the pose, is within the limits and on the curve."""
    if track.own < track.chain.n:
        return None
    x = near / track.scale
    if np.any((x < track.low - track.tolerance) | (x > track.high + track.tolerance)):
        return None
    e, _ = errors(track.chain, track.T[None], x[None], track.size)
    off = float(np.max(np.abs(e)))
    if off > TYPED or not on_curve(curve, track.chain, track.T, near[None], track.size)[0]:
        return None
    if off <= REACHES:
        return near
    exact, _, _ = corrected(track.chain, track.T[None], x[None], track.size)
    inside = np.all((exact[0] >= track.low - track.tolerance) & (exact[0] <= track.high + track.tolerance))
    return np.asarray(exact[0] * track.scale) if inside else None


def nearest_turns(track: Track, x: Array, wish: Array) -> Array:
    """x (m, n) with each angle turned as near to the wish (own,) as its limits allow."""
    wish = np.concatenate([wish, np.zeros(track.chain.n - len(wish))])
    with np.errstate(invalid="ignore"):
        least = np.ceil((track.low - track.tolerance - x) / TURN)
        most = np.floor((track.high + track.tolerance - x) / TURN)
        turns = np.clip(np.round((wish - x) / TURN), least, np.maximum(most, least))
    return np.asarray(np.where(track.chain.revolute & np.isfinite(turns), x + TURN * turns, x))


def moves(track: Track, x: Array, wish: Array) -> Array:
    """(m,) the greatest joint move from the wish (own,) to x (m, n), angles turned as near as the limits allow.

    It is given less that of the joints that stand still: where that is the greatest the rest has all its digits. Of
    members with the same greatest move that one counts as nearer whose other joints move less.
    """
    own = len(wish)
    gap = np.abs(nearest_turns(track, x, wish)[:, :own] - wish)
    still = track.still[:own]
    least = 0.0
    if still.any():
        least = float(np.max(np.abs(nearest_turns(track, track.points[:1], wish)[0, :own] - wish)[still]))
    greatest = np.max(gap, axis=1) - least
    greatest[np.abs(greatest) < STILL] = 0.0
    return np.asarray(greatest + OTHERS * np.linalg.norm(gap, axis=1))


def _nearest_of_pieces(track: Track, wish: Array) -> Array | None:
    """The member (n,) of a curve within the limits that is nearest to the wish (own,)."""
    found: list[Array] = []
    for piece in pieces(track):
        first, last = piece.first, piece.last
        inner = np.arange(np.floor(first * PARTS) + 1.0, np.ceil(last * PARTS)) / PARTS
        u = np.unique(np.concatenate([[first], inner, [last]]))
        x, _ = track.cubic(u)
        x[0], x[-1] = track.at(u[[0, -1]])
        far = moves(track, x, wish)
        lower = np.flatnonzero((far <= np.r_[np.inf, far[:-1]]) & (far <= np.r_[far[1:], np.inf]))
        lower = lower[np.argsort(far[lower], kind="stable")][:CANDIDATES]
        lower = lower[far[lower] <= far[lower[0]] + KINK]
        sides = np.array([(i, j) for i in lower.tolist() for j in (i - 1, i + 1) if 0 <= j < len(u)]).reshape(-1, 2)
        places = u[[0, -1]]
        if len(sides):
            a, b = np.sort(u[sides], axis=1).T
            places = np.append(places, least(track, a, b, lambda y: moves(track, y, wish))[0])
        found.extend(track.at(places))
    if not found:
        return None
    rows = np.array(found)
    return np.asarray(rows[np.argmin(moves(track, rows, wish))])


def _nearest_on_surface(track: Track, curve: Curve, wish: Array) -> Array | None:
    """The point of a surface that steps towards the wish, from its curves, end at, if it is within the limits."""
    own, chain = track.own, track.chain
    x = np.concatenate([sheet.x[:: max(len(sheet.x) // 4, 1)] for sheet in curve.sheets])
    many = np.broadcast_to(track.T, (len(x), 4, 4))
    kept = x[track.is_inside(x)]
    for _ in range(WALK):
        gap = np.zeros_like(x)
        gap[:, :own] = turned_gap(chain, np.pad(wish - x[:, :own], ((0, 0), (0, chain.n - own))))[:, :own]
        _, J = errors(chain, many, x, track.size)
        values, Vt = np.linalg.svd(J)[1:]
        felt = Vt[:, : values.shape[1]] * (values > ZERO)[:, :, None]
        step = gap - ((felt @ gap[:, :, None]).transpose(0, 2, 1) @ felt)[:, 0]
        length = np.linalg.norm(step, axis=1, keepdims=True)
        step *= np.minimum(1.0, LONGEST / np.maximum(length, 1e-12))
        x, off, _ = corrected(chain, many, x + step, track.size)
        if float(np.max(length)) < 1e-6:
            break
    ends = x[(off <= CLOSES) & track.is_inside(x)]
    kept = np.concatenate([kept, ends])
    return kept[np.argmin(moves(track, kept, wish))] if len(kept) else None
