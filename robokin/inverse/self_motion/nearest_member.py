"""The member of each of some self-motions that is nearest to a wish.

Statement. Of the configurations of each self-motion that are within the joint limits, find that whose greatest joint
move from a wish is least, angles turned as near to it as the limits allow.
Derivation. Along each piece within the limits (`arcs`) the greatest move is sampled; its least value is sought beside
the samples that are lower than their neighbours, and at the pieces' ends. A wish that is a member itself is the answer.
Degenerate case. On a surface steps from its known points towards the wish, within the null space, end at members that
are near in the sense of least squares: a good one, not proven the nearest.

Here x are joint values [rad | size] and lengths are in the arm's size.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.inverse.self_motion.arcs import pieces
from robokin.inverse.self_motion.curve_tracing import Curve
from robokin.inverse.self_motion.fronts import LONGEST
from robokin.inverse.self_motion.pose_correction import CLOSES, corrected, errors
from robokin.inverse.self_motion.solution_sets import on_curve
from robokin.inverse.self_motion.track import KINK, PARTS, Tracks, least
from robokin.kernel.chain import Chain
from robokin.kernel.ranks import ROOT_RANK
from robokin.spatial.angles import TURN, circled

SLACK = 1.1
"""What a curve's pieces are longer than their chords, at most."""

CANDIDATES = 4
"""Local minima of the move from a wish that are refined on each piece."""

TYPED = 1e-3
"""A wish that misses the pose by more [size and rad] is no member. What is typed with four digits is nearer."""

REACHES = 1e-9
"""A wish that misses the pose by less [size and rad] is a solution as it stands."""

STRAIGHT = 1e-6
"""Tangents that differ by less may be those of a straight line: of joints that have one axis."""

LINE_CUTS, LINE_ROUNDS = 32, 14
"""Parts that a straight curve beside a point is cut into in each round, of which two remain: 1e-16 of it in the end."""

OTHERS = 1e-7
"""Weight of the other joints' moves: it shifts the greatest move by less than anyone asks for."""

TIE, TIE_OF_OTHERS = 1e-9, 1e-6
"""Greatest moves, and lengths of all moves, that differ by less [rad | size] are equal: of mirror images of each other
one is always the same."""

ALIKE = 1e-4
"""Joint values [rad | size] that differ by less do not tell such members apart."""

STILL = 1e-12
"""Differences of the greatest move below this [rad | size] are rounding of joints that stand still."""

WALK = 25
"""Steps of a walk towards a wish on a surface at most."""


def nearest_on(curve: Curve, chain: Chain, T: Array, near: Array, limits: Array, size: float) -> Array | None:
    """The member (own,) [rad | m] of a self-motion at T (4, 4) that is nearest to `near` (own,), within the limits.

    limits: (own, 2) of the arm's own joints; nearest by the greatest joint move, angles turned as near as the limits
    allow. None where no member is within the limits. Of a surface one that is found nearest from several guesses.
    """
    return nearest_on_each([curve], chain, T[None], near, limits, size)[0]


def nearest_on_each(
    curves: Sequence[Curve], chain: Chain, T: Array, near: Array, limits: Array, size: float
) -> list[Array | None]:
    """`nearest_on` for each of some self-motions at T (k, 4, 4), all with the same wish `near` (own,)."""
    whole = Tracks(curves, chain, T, limits, size)
    answers = [_itself(whole, T[k], curve, near) for k, curve in enumerate(curves)]
    parts = [(k, part) for k, one in enumerate(curves) if answers[k] is None for part in one.sheets or (one,)]
    if not parts:
        return answers
    of = np.array([k for k, _ in parts], dtype=np.intp)
    tracks = Tracks([part for _, part in parts], chain, T[of], limits, size)
    wish = near / tracks.scale[: tracks.own]
    part, x = _nearest_of_pieces(tracks, wish)
    for k in np.unique(of).tolist():
        mine = of[part] == k
        rows, tracked = x[mine], part[mine]
        if curves[k].sheets:
            more = _nearest_on_surface(tracks, T[k], curves[k], wish)
            rows, tracked = np.concatenate([rows, more]), np.append(tracked, np.full(len(more), np.searchsorted(of, k)))
        if len(rows):
            # Of a surface the points of all curves are compared as those of one.
            best = rows[_nearest_of_each(tracks, np.full(len(rows), tracked[0]), rows, wish)[0]]
            answers[k] = _turned_near(tracks, best, wish)
    return answers


def members_near(
    curves: Sequence[Curve], chain: Chain, T: Array, wish: Array, limits: Array, size: float
) -> list[Array | None]:
    """Members (own,) [rad | m] within the limits (own, 2) that are about as near to the wish (own,) as any.

    One of each of some self-motions at T (k, 4, 4). It is the nearest one between those points that the curve was
    followed by that may have it between them, which spares most of what `nearest_on` does; that is asked where none of
    the points is within the limits, or these cut what may be nearest.
    """
    answers: list[Array | None] = [None] * len(curves)
    tracks = Tracks(curves, chain, T, limits, size)
    inside, of = tracks.is_inside(tracks.points), tracks.of_points
    simple = np.isin(np.arange(len(curves)), of[inside]) & np.array([not one.sheets for one in curves], dtype=bool)
    x = wish / tracks.scale[: tracks.own]
    usable = np.flatnonzero(inside & simple[of])
    if len(usable):
        far = moves(tracks, of, tracks.points, x)
        best = _nearest_points(of, far, usable)
        low = _lower_between(tracks, far, inside, best)
        # Where the limits cut what may be nearest its ends are needed.
        cut = np.unique(of[low[inside[low] != inside[low + 1]]])
        simple[cut] = False
        best, low = best[simple[of[best]]], low[inside[low] & simple[of[low]]]
        for k, member in zip(of[best].tolist(), _beside(tracks, best, low, x), strict=True):
            answers[k] = _turned_near(tracks, member, x)
    rest = np.flatnonzero(~simple)
    if len(rest):
        asked = nearest_on_each([curves[k] for k in rest.tolist()], chain, T[rest], wish, limits, size)
        for k, found in zip(rest.tolist(), asked, strict=True):
            answers[k] = found
    return answers


def _nearest_of_each(tracks: Tracks, of: Index, x: Array, wish: Array) -> Index:
    """Of each curve, in order, the row of x (m, n) that is nearest to the wish (own,); of: (m,) the rows' curves.

    Of several that are equally near the one whose first joints' values are greatest.
    """
    which, index = np.unique(of, return_inverse=True)
    greatest, others = _parts_of_moves(tracks, of, x, wish)
    order = np.lexsort((greatest + OTHERS * others, index))
    best = order[np.searchsorted(index[order], np.arange(len(which)))]
    tied = np.flatnonzero((greatest <= greatest[best][index] + TIE) & (others <= others[best][index] + TIE_OF_OTHERS))
    if len(tied) == len(best):
        return best
    columns = np.round(-x[tied] / ALIKE).T
    tied = tied[np.lexsort((*columns[::-1], index[tied]))]
    return np.asarray(tied[np.unique(index[tied], return_index=True)[1]])


def _nearest_points(of: Index, far: Array, usable: Index) -> Index:
    """Of each curve that has usable points (u,) the one with the least move far (p,); of: (p,) the points' curves."""
    order = usable[np.lexsort((far[usable], of[usable]))]
    return np.asarray(order[np.unique(of[order], return_index=True)[1]])


def _lower_between(tracks: Tracks, far: Array, inside: Flags, best: Index) -> Index:
    """The points (k,) of curves between which and the next one the move from a wish may be less than at all points.

    far: (p,) the moves to all points, inside: (p,) those within the limits; best: (m,) the nearest one of each curve
    that counts. Between two points the greatest move is less than at both by half of what joints move from one to the
    other, at most; beyond the limits it says nothing, as angles are turned.
    """
    of = tracks.of_points
    nearest = np.full(len(tracks.last), -np.inf)
    nearest[of[best]] = far[best]
    step = SLACK * np.max(np.abs(np.diff(tracks.points, axis=0)), axis=1)
    same = of[1:] == of[:-1]
    one = np.where(inside[1:], far[1:], far[:-1]) - step
    lowest = np.where(inside[1:] & inside[:-1], 0.5 * (far[1:] + far[:-1] - step), one)
    return np.flatnonzero(same & (inside[1:] | inside[:-1]) & (lowest < nearest[of[:-1]]))


def _beside(tracks: Tracks, best: Index, low: Index, wish: Array) -> Array:
    """The points (m, n) nearest to the wish of curves of which `best` (m,) are the nearest points, sought between these
    and between points `low` (k,) and the next ones."""
    of = tracks.of_points
    rows, curve = tracks.points[best], of[best]
    if len(low):
        k, first = of[low], (low - tracks.first[of[low]]).astype(np.float64)
        a, b = _parts_of_least(tracks, k, first, wish)
        k = k[np.isfinite(a)]
        a, b = a[np.isfinite(a)], b[np.isfinite(b)]
        places, _ = least(tracks, k, a, b, lambda _, k, y: moves(tracks, k, y, wish))
        found = tracks.at(k, places)
        fits = tracks.is_inside(found)
        rows, curve = np.concatenate([rows, found[fits]]), np.append(curve, k[fits])
    chosen = rows[_nearest_of_each(tracks, curve, rows, wish)]
    straight, on_lines = _on_lines(tracks, best, wish)
    chosen[straight] = on_lines
    return np.asarray(chosen)


def _parts_of_least(tracks: Tracks, k: Index, first: Array, wish: Array) -> tuple[Array, Array]:
    """Of intervals from places `first` (m,) of curves k (m,), one long, the parts (a, b) that the least move may be in.

    NaN for those of which others of the same curve come nearer.
    """
    f = np.linspace(0.0, 1.0, PARTS + 1)
    many = np.repeat(k, PARTS + 1)
    x, _ = tracks.cubic(many, (first[:, None] + f).reshape(-1))
    far = moves(tracks, many, x, wish).reshape(len(k), PARTS + 1)
    i = np.argmin(far, axis=1)
    low = far[np.arange(len(k)), i]
    nearest = np.full(int(np.max(k)) + 1, np.inf)
    np.minimum.at(nearest, k, low)
    close = low <= nearest[k] + KINK
    a, b = first + f[np.maximum(i - 1, 0)], first + f[np.minimum(i + 1, PARTS)]
    return np.where(close, a, np.nan), np.where(close, b, np.nan)


def _on_lines(tracks: Tracks, best: Index, wish: Array) -> tuple[Index, Array]:
    """Which of points `best` (m,) of some curves are on straight ones, and the points (k, n) of these nearest the wish.

    The greatest move along a line is a convex function: it is least beside the least of some points. The point itself
    is the middle one of them.
    """
    of = tracks.of_points
    k, t = of[best], tracks.tangents[best]
    place = np.full(len(tracks.last), -1)
    place[k] = np.arange(len(best))
    mine = np.flatnonzero(place[of] >= 0)
    bent = mine[np.max(np.abs(tracks.tangents[mine] - t[place[of[mine]]]), axis=1, initial=0.0) > STRAIGHT]
    rows = np.flatnonzero((tracks.last[k] >= 2) & ~np.isin(k, of[bent]))
    if not len(rows):
        return rows, np.empty((0, tracks.chain.n))
    k, t, start = k[rows], t[rows], tracks.points[best[rows]]
    apart = np.append(np.linalg.norm(np.diff(tracks.points, axis=0), axis=1), 0.0)
    before, after = (
        np.maximum(best[rows] - 1, tracks.first[k]),
        np.minimum(best[rows], tracks.first[k] + tracks.last[k] - 1),
    )
    high = 2.0 * np.maximum(apart[before], apart[after])
    low = -high
    cuts, every, many = np.linspace(0.0, 1.0, LINE_CUTS + 1), np.arange(len(rows)), np.repeat(k, LINE_CUTS + 1)
    for _ in range(LINE_ROUNDS):
        parts = low[:, None] + (high - low)[:, None] * cuts
        points = (start[:, None] + parts[:, :, None] * t[:, None]).reshape(parts.size, -1)
        far = np.where(tracks.is_inside(points), moves(tracks, many, points, wish), np.inf).reshape(parts.shape)
        i = np.argmin(far, axis=1)
        low, high = parts[every, np.maximum(i - 1, 0)], parts[every, np.minimum(i + 1, LINE_CUTS)]
        x = points.reshape(*parts.shape, -1)[every, i]
    e, _ = errors(tracks.chain, tracks.T[k], x, tracks.size)
    good = tracks.is_inside(x) & (np.max(np.abs(e), axis=1) <= REACHES)
    return rows[good], x[good]


def _turned_near(tracks: Tracks, x: Array, wish: Array) -> Array:
    """The arm's own joints (own,) [rad | m] of a point x (n,), angles turned near the wish (own,)."""
    own = tracks.own
    return np.asarray(nearest_turns(tracks, x[None], wish)[0, :own] * tracks.scale[:own])


def _itself(tracks: Tracks, T: Array, curve: Curve, near: Array) -> Array | None:
    """`near` (own,) itself, if it reaches the pose T (4, 4), is within the limits and on the curve."""
    if tracks.own < tracks.chain.n:
        return None
    x = near / tracks.scale
    if np.any((x < tracks.low - tracks.tolerance) | (x > tracks.high + tracks.tolerance)):
        return None
    e, _ = errors(tracks.chain, T[None], x[None], tracks.size)
    off = float(np.max(np.abs(e)))
    if off > TYPED or not on_curve(curve, tracks.chain, T, near[None], tracks.size)[0]:
        return None
    if off <= REACHES:
        return near
    exact, _, _ = corrected(tracks.chain, T[None], x[None], tracks.size)
    inside = np.all((exact[0] >= tracks.low - tracks.tolerance) & (exact[0] <= tracks.high + tracks.tolerance))
    return np.asarray(exact[0] * tracks.scale) if inside else None


def nearest_turns(tracks: Tracks, x: Array, wish: Array) -> Array:
    """x (m, n) with each angle turned as near to the wish (own,) as its limits allow."""
    wish = np.concatenate([wish, np.zeros(tracks.chain.n - len(wish))])
    with np.errstate(invalid="ignore"):
        least = np.ceil((tracks.low - tracks.tolerance - x) / TURN)
        most = np.floor((tracks.high + tracks.tolerance - x) / TURN)
        turns = np.clip(np.round((wish - x) / TURN), least, np.maximum(most, least))
    return np.asarray(np.where(tracks.chain.revolute & np.isfinite(turns), x + TURN * turns, x))


def moves(tracks: Tracks, k: Index, x: Array, wish: Array) -> Array:
    """(m,) the greatest joint move from the wish (own,) to points x (m, n) of curves k (m,), turned near it.

    It is given less that of the joints that stand still: where that is the greatest the rest has all its digits. Of
    members with the same greatest move that one counts as nearer whose other joints move less.
    """
    greatest, others = _parts_of_moves(tracks, k, x, wish)
    return np.asarray(greatest + OTHERS * others)


def _parts_of_moves(tracks: Tracks, k: Index, x: Array, wish: Array) -> tuple[Array, Array]:
    """(m,) the greatest move of `moves`, and the length of all moves."""
    own = len(wish)
    gap = np.abs(nearest_turns(tracks, x, wish)[:, :own] - wish)
    greatest = np.max(gap, axis=1) - _least_moves(tracks, wish)[k]
    greatest[np.abs(greatest) < STILL] = 0.0
    return greatest, np.linalg.norm(gap, axis=1)


def _least_moves(tracks: Tracks, wish: Array) -> Array:
    """(k,) the greatest move from the wish (own,) of the joints that stand still on each curve."""
    known = tracks.least_moves
    if known is None or known[0] is not wish:
        own = len(wish)
        standing = np.abs(nearest_turns(tracks, tracks.points[tracks.first], wish)[:, :own] - wish)
        known = wish, np.max(np.where(tracks.still[:, :own], standing, 0.0), axis=1, initial=0.0)
        tracks.least_moves = known
    return known[1]


def _nearest_of_pieces(tracks: Tracks, wish: Array) -> tuple[Index, Array]:
    """The members (k, n) within the limits nearest to the wish (own,), one of each curve that has any; which (k,)."""
    found = pieces(tracks)
    if not found:
        return np.empty(0, dtype=np.intp), np.empty((0, tracks.chain.n))
    places = []
    for piece in found:
        inner = np.arange(np.floor(piece.first * PARTS) + 1.0, np.ceil(piece.last * PARTS)) / PARTS
        places.append(np.unique(np.concatenate([[piece.first], inner, [piece.last]])))
    counts = np.array([len(u) for u in places])
    first = np.cumsum(counts) - counts
    u, k = np.concatenate(places), np.repeat([piece.curve for piece in found], counts)
    ends = np.unique(np.concatenate([first, first + counts - 1]))
    x, _ = tracks.cubic(k, u)
    x[ends] = tracks.at(k[ends], u[ends])
    far = moves(tracks, k, x, wish)
    sides = []
    for start, count in zip(first.tolist(), counts.tolist(), strict=True):
        mine = far[start : start + count]
        lower = np.flatnonzero((mine <= np.r_[np.inf, mine[:-1]]) & (mine <= np.r_[mine[1:], np.inf]))
        lower = lower[np.argsort(mine[lower], kind="stable")][:CANDIDATES]
        lower = lower[mine[lower] <= mine[lower[0]] + KINK]
        sides.append(start + np.concatenate([lower[lower > 0] - 1, lower[lower < count - 1]]))
    low = np.concatenate(sides)
    of, place = k[ends], u[ends]
    if len(low):
        more, _ = least(tracks, k[low], u[low], u[low + 1], lambda _, k, y: moves(tracks, k, y, wish))
        of, place = np.append(of, k[low]), np.append(place, more)
    rows = tracks.at(of, place)
    chosen = _nearest_of_each(tracks, of, rows, wish)
    return of[chosen], rows[chosen]


def _nearest_on_surface(tracks: Tracks, T: Array, curve: Curve, wish: Array) -> Array:
    """The point (1, n) of a surface at T (4, 4) that steps towards the wish, from its curves, end at; (0, n) for none
    within the limits."""
    own, chain = tracks.own, tracks.chain
    x = np.concatenate([sheet.x[:: max(len(sheet.x) // 4, 1)] for sheet in curve.sheets])
    many = np.broadcast_to(T, (len(x), 4, 4))
    kept = x[tracks.is_inside(x)]
    for _ in range(WALK):
        gap = np.zeros_like(x)
        gap[:, :own] = circled(wish - x[:, :own], chain.revolute[:own])
        _, J = errors(chain, many, x, tracks.size)
        values, Vt = np.linalg.svd(J)[1:]
        felt = Vt[:, : values.shape[1]] * (values > ROOT_RANK)[:, :, None]
        step = gap - ((felt @ gap[:, :, None]).transpose(0, 2, 1) @ felt)[:, 0]
        length = np.linalg.norm(step, axis=1, keepdims=True)
        step *= np.minimum(1.0, LONGEST / np.maximum(length, 1e-12))
        x, off, _ = corrected(chain, many, x + step, tracks.size)
        if float(np.max(length)) < 1e-6:
            break
    ends = x[(off <= CLOSES) & tracks.is_inside(x)]
    kept = np.concatenate([kept, ends])
    first = next(k for k, one in enumerate(tracks.curves) if one is curve.sheets[0])
    far = moves(tracks, np.full(len(kept), first), kept, wish)
    return kept[np.argmin(far)][None] if len(kept) else kept
