"""Of each self-motion one member, and double roots to their last digit: what is listed at singular poses.

Statement. Among the solutions of a target there may be many members of one self-motion, and double roots known to half
of their digits. List each self-motion once, by its member nearest to a wish within the joint limits, and each double
root exactly.
How. Solutions at which the Jacobian has lost rank are classified (`self_motion`): those that stand alone, exact where
they are double; and members of sets, which are followed, each once (`solution_sets`). A set has its nearest member
within the limits (`arcs`), or where none is within them any member, which then is outside.
Without a wish the member of a wrist's self-motion is the one with its first joint at rest.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.inverse.closed_form.spherical_wrist import SphericalTriple
from robokin.inverse.self_motion.curve_tracing import Curve
from robokin.inverse.self_motion.fronts import slide_reach
from robokin.inverse.self_motion.nearest_member import members_near, nearest_on_each
from robokin.inverse.self_motion.null_motion import corrected, errors, on_the_way_home, scale_of
from robokin.inverse.self_motion.solution_sets import Families, families
from robokin.inverse.verify import CLOSES, Found, with_ones_within, within_limits
from robokin.inverse.window import least_singular_values
from robokin.kernel.chain import Chain
from robokin.kernel.ranks import ROOT_RANK
from robokin.kernel.residual import error_and_jacobian

TURN = 2.0 * np.pi

UNRESOLVED = 3e-8
"""Least singular value below which a solution is a multiple one: neighbours within `NEIGHBOURS` are the same root.
Rounding takes a double root apart by 1e-8, and the singular value is about as large; two roots that are farther apart
are two."""

NEIGHBOURS = 2e-3
"""How far rounding takes a root apart that counts many times [rad | size]: the seventh root of 1e-16. Also how near to
a self-motion such a root may be and still belong to it, where the error hardly grows at right angles to it."""


NEXT = 1e-5
"""Two solutions that are nearer [rad | size] are one if the pose midway between them is the target but for `MIDWAY`."""

MIDWAY = 2e-13
"""What the pose is then off by at most [size and rad]: some hundred times its rounding. Two roots of a common fold that
are 1e-6 apart are off by as much midway; joint values are not known better."""

SLOW = 1e-3
"""Least singular value below which Newton's steps may stall on the way to a root."""

BESIDE = 2e-3
"""How near [rad | size] to a solution another one that is singular too, or has not settled, is taken for the same."""

CROWDED = 0.3
"""Distance [rad | size] of singular solutions below which one may lead to the other: self-motions are followed by steps
of up to 0.2, and one that is smaller looks like roots."""

FLAT = 1e-12
"""Error [size and rad] up to which a curve that could not be followed to its end has no solutions to be told apart:
where it is so small over `CROWDED`, its slope is below what rounding of the pose makes of a solution's place."""

FEW = 4
"""Solutions that may stand alone in a valley; of a set that could not be followed any number would settle."""

SETTLED = 1e-13
"""Residual [size and rad] to which Newton's steps bring a root that stands alone."""


@dataclass(frozen=True, eq=False)
class SelfMotion:
    """A self-motion of a target, and the member q (n,) [rad | m] that stands for it."""

    curve: Curve
    q: Array


def listed_once(
    chain: Chain,
    solver: object,
    T: Array,
    found: Found,
    size: float,
    limits: Array,
    rest: Array,
    near: Array | None,
    known: Mapping[int, Sequence[Curve]] | None = None,
) -> tuple[Found, dict[int, list[SelfMotion]], Index, Index]:
    """Solutions (s, n) of targets T (m, 4, 4), sorted, with each self-motion and each multiple root once.

    limits: (n, 2) [rad | m]; rest: (n,) the wish where there is no `near` (n,); known: self-motions of targets, by
    their numbers, that were followed before. Also the self-motions of each target,
    and the targets (k,) of which a solution is singular and neither double nor on a self-motion: others may be so near
    to it that they were not told apart; and how many (m,) were left out beside another one, as if the two were double.
    """
    listed, motions, unclear, beside = _once(chain, solver, T, found, size, limits, rest, near, known)
    # Of roots that joint values hardly tell apart another one may stand outside the limits for one within; and a
    # self-motion may be within them in no more than the configuration that was found.
    listed, again = with_ones_within(listed, found, chain.revolute, limits, size)
    unclear = np.union1d(unclear, again)
    return listed, motions, unclear, beside


def _once(
    chain: Chain,
    solver: object,
    T: Array,
    found: Found,
    size: float,
    limits: Array,
    rest: Array,
    near: Array | None,
    known: Mapping[int, Sequence[Curve]] | None,
) -> tuple[Found, dict[int, list[SelfMotion]], Index, Index]:
    """`listed_once`, whatever the limits say of those that are left out."""
    least = least_singular_values(chain, found.q, size)
    found, least, astray = _within_reach(chain, T, found, least, size, limits)
    found, least = _thinned(chain, found, least, size)
    singular = np.flatnonzero(least < ROOT_RANK)
    if not len(singular):
        return found, {}, astray, np.zeros(len(T), dtype=np.intp)
    q, index = found.q.copy(), found.index
    position, angle = found.position.copy(), found.angle.copy()
    sets = families(chain, T, q[singular], size, index[singular], known, limits=limits)
    local = sets.local
    # On the way to a multiple root that the target only nearly has, a solution is better left where it is.
    there, _ = error_and_jacobian(chain, T[index[singular]], local.q, size)
    position[singular], angle[singular], moved = _better(position[singular], angle[singular], there, size)
    q[singular] = np.where(moved[:, None], local.q, q[singular])
    keep = np.ones(len(found), dtype=bool)
    # Of a target with more sets than are followed the members of the others are left out; it is said that some are.
    unfollowed = (sets.of < 0) & (local.dimension > 0) & np.isin(index[singular], np.array([*sets.open], dtype=np.intp))
    keep[singular[unfollowed]] = False
    stands, curves, lost = _stand_ins(chain, T, sets, index, singular, np.maximum(position / size, angle), keep, size)
    motions: dict[int, list[SelfMotion]] = {}
    targets = index[stands]
    q[stands] = _members(chain, solver, T[targets], curves, q[stands], size, limits, rest, near)
    for i, curve, chosen in zip(targets.tolist(), curves, q[stands], strict=True):
        motions.setdefault(i, []).append(SelfMotion(curve, chosen))
    off, _ = error_and_jacobian(chain, T[targets], q[stands], size)
    position[stands], angle[stands] = np.linalg.norm(off[:, :3], axis=1) * size, np.linalg.norm(off[:, 3:], axis=1)
    alone = sets.of < 0
    least[singular] = least_singular_values(chain, q[singular], size)
    unclear = index[singular[alone & ~(local.double & moved) & (least[singular] < ROOT_RANK)]]
    # Any solution of these targets may be a place where Newton's steps gave up on the way to a multiple root.
    off = np.maximum(position / size, angle)
    off[stands] = 0.0
    keep[_stalled(index, keep, least, off)] = False
    rows = np.setdiff1d(np.flatnonzero(keep & np.isin(index, index[singular[alone]])), stands)
    again, beside = _again(chain, T, index, q, rows, size, least)
    keep[again] = False
    keep[_on_motions(chain, index, q, rows, size, least, motions)] = False
    crowded = _crowded(chain, index, q, singular[alone & keep[singular] & (least[singular] < ROOT_RANK)], size)
    return (
        Found(index, q, position, angle).pick(keep),
        motions,
        np.unique(np.concatenate([unclear, crowded, astray, np.array([*lost, *sets.open], dtype=np.intp)])),
        np.bincount(index[beside], minlength=len(T)),
    )


def _stand_ins(
    chain: Chain, T: Array, sets: Families, index: Index, singular: Index, off: Array, keep: Flags, size: float
) -> tuple[list[np.intp], list[Curve], list[np.intp]]:
    """Of each set one of the singular solutions (rows of index (s,)) that are on it, its curve, and the targets of sets
    that could not be followed to their ends.

    off: (s,) the errors [size and rad]. The other members are taken out of keep (s,); and what settled in a valley, in
    which the error nearly vanishes, out of the sets.
    """
    stands: list[np.intp] = []
    curves: list[Curve] = []
    lost: list[np.intp] = []
    for i in np.unique(index[singular]):
        mine = np.flatnonzero(index[singular] == i)
        for number, curve in enumerate(sets.curves[i]):
            members = singular[mine[sets.of[mine] == number]]
            if not len(members):
                continue
            if any(part.ended == "lost" for part in curve.sheets or (curve,)):
                lost.append(i)
                if np.sum(off[members] <= SETTLED) <= FEW and not _flat(chain, T[i], curve, size):
                    # No set of solutions but a valley: what settled is alone.
                    sets.of[mine[sets.of[mine] == number]] = -1
                    continue
            keep[members] = False
            # The most exact member stands for all.
            first = members[np.argmin(off[members])]
            keep[first] = True
            stands.append(first)
            curves.append(curve)
    return stands, curves, lost


def _within_reach(
    chain: Chain, T: Array, found: Found, least: Array, size: float, limits: Array
) -> tuple[Found, Array, Index]:
    """The solutions and their least singular values with none on far ends of self-motions, and the targets (k,) of
    which some were left out.

    Of slides without limits a self-motion has no end, and what is found of it may be anywhere. On a straight line it is
    brought near. Curves come from where they are followed, so that of targets with other singular solutions no
    member beyond is needed.
    """
    far = np.flatnonzero(
        (least < ROOT_RANK) & np.any(np.abs(found.q) > slide_reach(chain, size, limits) * size, axis=1)
    )
    if not len(far):
        return found, least, far
    q, position, angle, least = found.q.copy(), found.position.copy(), found.angle.copy(), least.copy()
    poses, scale = T[found.index[far]], scale_of(chain, size)
    _, J = errors(chain, poses, q[far] / scale, size)
    home, brought = on_the_way_home(chain, J, q[far] / scale)
    x, off, _ = corrected(chain, poses, home, size)
    brought &= off <= CLOSES
    near = far[brought]
    q[near] = (x * scale)[brought]
    error, _ = error_and_jacobian(chain, poses[brought], q[near], size)
    position[near], angle[near] = np.linalg.norm(error[:, :3], axis=1) * size, np.linalg.norm(error[:, 3:], axis=1)
    least[near] = least_singular_values(chain, q[near], size)
    far = far[~brought]
    others = np.setdiff1d(np.flatnonzero(least < ROOT_RANK), far)
    far = far[np.isin(found.index[far], found.index[others])]
    keep = np.ones(len(q), dtype=bool)
    keep[far] = False
    return Found(found.index, q, position, angle).pick(keep), least[keep], np.unique(found.index[far])


def _thinned(chain: Chain, found: Found, least: Array, size: float) -> tuple[Found, Array]:
    """The solutions, and their least singular values, without those beside another one that tell nothing new.

    Next to a singular solution many are found that have not settled, or that lie on one self-motion. Of those that
    have settled the most singular one stays: a member of a self-motion closes no better than what is beside it.
    """
    off = np.maximum(found.position / size, found.angle)
    scale = np.where(chain.revolute, 1.0, size)
    keep = np.ones(len(found), dtype=bool)
    rows = np.flatnonzero(least < SLOW)
    for target in np.unique(found.index[rows]):
        mine = rows[found.index[rows] == target]
        mine = mine[np.lexsort((least[mine], np.maximum(off[mine], SETTLED)))]
        x = found.q[mine] / scale
        gap = x[:, None] - x[None]
        gap = np.max(np.abs(np.where(chain.revolute, gap - TURN * np.round(gap / TURN), gap)), axis=2)
        vague = (off[mine] > SETTLED)[:, None] | (np.maximum(least[mine][:, None], least[mine][None]) < UNRESOLVED)
        near = vague & (gap < BESIDE)
        for k in range(1, len(mine)):
            keep[mine[k]] = not np.any(near[k, :k] & keep[mine[:k]])
    return found.pick(keep), least[keep]


def _stalled(index: Index, keep: Flags, least: Array, off: Array) -> Index:
    """Which rows are places where Newton's steps gave up next to a singular pose, of targets with others.

    A root is settled on to rounding, be it ever so near to another one.
    """
    stalled = keep & (off > SETTLED) & (least < SLOW)
    settled = np.bincount(index[keep & ~stalled], minlength=int(index.max(initial=0)) + 1) > 0
    return np.flatnonzero(stalled & settled[index])


def _wrist_held(chain: Chain, first: int, curve: Curve, q: Array, limits: Array, rest: Array) -> Array | None:
    """The member (n,) of a straight wrist's self-motion with its first joint at rest and the last with what is left.

    The two move as little from there as brings the last one into its limits. None where the curve is another one, or
    this member is outside the limits.
    """
    last = first + 2
    if set(curve.joints) != {first + 1, last + 1} or curve.sheets:
        return None
    t = curve.tangents[0]
    sign = 1 if t[last] * t[first] < 0.0 else -1
    held = q.copy()
    held[last] += sign * (q[first] - rest[first])
    held[first] = rest[first]
    held = _into_limits(held[None], first, sign, limits)
    return np.asarray(held[0]) if within_limits(held, chain.revolute, limits, None)[1][0] else None


def _into_limits(q: Array, first: int, sign: int, limits: Array) -> Array:
    """Configurations moved along the family as little as brings the wrist's last joint into its limits (2,)."""
    last = first + 2
    low, high = limits[last]
    value = _half_turn(q[:, last])
    if np.isinf(low) or np.isinf(high):
        return q
    fits = np.floor((high - value) / TURN) >= np.ceil((low - value) / TURN)
    ends = _half_turn(np.stack([low - value, high - value]))
    shift = np.where(fits, 0.0, ends[np.argmin(np.abs(ends), axis=0), np.arange(len(q))])
    q = q.copy()
    q[:, last] += shift
    q[:, first] -= sign * shift
    return q


def _half_turn(angle: Array) -> Array:
    """Angles in [-π, π]."""
    return angle - TURN * np.round(angle / TURN)


def _better(position: Array, angle: Array, there: Array, size: float) -> tuple[Array, Array, Flags]:
    """Residuals (s,) [m, rad] of solutions or of where they could be moved, with the error `there` (s, 6), and whether
    they are moved: to what closes as well."""
    new_position, new_angle = np.linalg.norm(there[:, :3], axis=1) * size, np.linalg.norm(there[:, 3:], axis=1)
    moved = np.maximum(new_position / size, new_angle) <= np.maximum(np.maximum(position / size, angle), SETTLED)
    return np.where(moved, new_position, position), np.where(moved, new_angle, angle), moved


def _members(
    chain: Chain,
    solver: object,
    T: Array,
    curves: list[Curve],
    known: Array,
    size: float,
    limits: Array,
    rest: Array,
    near: Array | None,
) -> Array:
    """The members (k, n) of sets at T (k, 4, 4) that stand for them, of each of which one (k, n) is known."""
    chosen: list[Array | None] = [None] * len(curves)
    wish = rest if near is None else near
    if near is None and isinstance(solver, SphericalTriple):
        for k, curve in enumerate(curves):
            chosen[k] = _wrist_held(chain, solver.first, curve, known[k], limits, rest)
        chosen = _closing(chain, T, chosen, size)
    anywhere = np.tile([-np.inf, np.inf], (chain.n, 1))
    for ask, within in ((members_near if near is None else nearest_on_each, limits), (members_near, anywhere)):
        open_ = [k for k, member in enumerate(chosen) if member is None]
        if open_:
            found = ask([curves[k] for k in open_], chain, T[open_], wish, within, size)
            for k, member in zip(open_, found, strict=True):
                chosen[k] = member
    # Of a set that the target only nearly has, what was found is nearer to it than what was followed.
    members = [known[k] if one is None else one for k, one in enumerate(_closing(chain, T, chosen, size))]
    return np.array(members).reshape(-1, chain.n)


def _closing(chain: Chain, T: Array, members: list[Array | None], size: float) -> list[Array | None]:
    """Those configurations (n,) that reach their T (k, 4, 4) as nearly as a solution must, None for the others."""
    given = [k for k, member in enumerate(members) if member is not None]
    q = np.array([members[k] for k in given]).reshape(-1, chain.n)
    error, _ = error_and_jacobian(chain, T[given], q, size)
    off = np.maximum(np.linalg.norm(error[:, :3], axis=1), np.linalg.norm(error[:, 3:], axis=1))
    out: list[Array | None] = [None] * len(members)
    for k, member, left in zip(given, q, off.tolist(), strict=True):
        out[k] = member if left <= CLOSES else None
    return out


def _flat(chain: Chain, T: Array, curve: Curve, size: float) -> bool:
    """Whether the pose hardly leaves T (4, 4) along a long piece of a curve that ends somewhere."""
    off = np.max(np.abs(errors(chain, np.broadcast_to(T, (len(curve.x), 4, 4)), curve.x, size)[0]), axis=1)
    pieces = np.split(curve.x, np.flatnonzero(off > FLAT))
    return any(float(np.max(np.ptp(piece[1:], axis=0))) >= CROWDED for piece in pieces if len(piece) > 2)


def _again(
    chain: Chain, T: Array, index: Index, q: Array, rows: Index, size: float, least: Array
) -> tuple[Index, Index]:
    """Which of some rows are the same root as another one of their target, T: (m, 4, 4) being the targets.

    Also which of these are roots of their own, but so near to another one that joint values hardly tell them apart.
    """
    scale = np.where(chain.revolute, 1.0, size)
    again, beside = [], []
    for target in np.unique(index[rows]):
        mine = rows[index[rows] == target]
        mine = mine[np.argsort(least[mine], kind="stable")]
        for k in range(1, len(mine)):
            gap = (q[mine[:k]] - q[mine[k]]) / scale
            gap = np.where(chain.revolute, gap - TURN * np.round(gap / TURN), gap)
            distance = np.max(np.abs(gap), axis=1)
            multiple = np.maximum(least[mine[:k]], least[mine[k]]) < UNRESOLVED
            same = multiple & (distance < NEIGHBOURS)
            next_to = np.flatnonzero(~same & (distance < NEXT))
            midway = q[mine[k]] / scale + 0.5 * gap[next_to]
            off = errors(chain, np.broadcast_to(T[target], (len(midway), 4, 4)), midway, size)[0]
            next_to = next_to[np.max(np.abs(off), axis=1, initial=0.0) <= MIDWAY]
            if np.any(same) or len(next_to):
                again.append(mine[k])
            if len(next_to) and not np.any(same):
                beside.append(mine[k])
    return np.array(again, dtype=np.intp), np.array(beside, dtype=np.intp)


def _crowded(chain: Chain, index: Index, q: Array, rows: Index, size: float) -> Index:
    """The targets of which some singular solutions are near to each other: they may be on one self-motion, which is too
    small to be followed."""
    scale = np.where(chain.revolute, 1.0, size)
    found = []
    for target in np.unique(index[rows]):
        x = q[rows[index[rows] == target]] / scale
        gap = x[:, None] - x[None]
        gap = np.max(np.abs(np.where(chain.revolute, gap - TURN * np.round(gap / TURN), gap)), axis=2)
        if np.any(gap[np.triu_indices(len(x), 1)] < CROWDED):
            found.append(target)
    return np.array(found, dtype=np.intp)


def _on_motions(
    chain: Chain, index: Index, q: Array, rows: Index, size: float, least: Array, motions: dict[int, list[SelfMotion]]
) -> Index:
    """Which of some rows, none of which stands for one, are multiple roots beside a self-motion of their target."""
    scale = np.where(chain.revolute, 1.0, size)
    beside = []
    for row in rows[least[rows] < UNRESOLVED]:
        for motion in motions.get(int(index[row]), []):
            gap = (motion.curve.q - q[row]) / scale
            gap = np.where(chain.revolute, gap - TURN * np.round(gap / TURN), gap)
            if _distance(gap) < NEIGHBOURS:
                beside.append(row)
                break
    return np.array(beside, dtype=np.intp)


def _distance(points: Array) -> float:
    """How far the straight pieces between points (k, n) are from zero, by the greatest coordinate."""
    if len(points) < 2:
        return float(np.min(np.max(np.abs(points), axis=1)))
    chord = np.diff(points, axis=0)
    chord = chord - TURN * np.round(chord / TURN)
    length = np.maximum(np.einsum("ij,ij->i", chord, chord), 1e-300)
    along = np.clip(-np.einsum("ij,ij->i", points[:-1], chord) / length, 0.0, 1.0)
    return float(np.min(np.max(np.abs(points[:-1] + along[:, None] * chord), axis=1)))
