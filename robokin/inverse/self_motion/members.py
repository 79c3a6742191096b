"""Of each self-motion one member, and double roots to their last digit: what is listed at singular poses.

Statement. Among the solutions of a target there may be many members of one self-motion, and double roots known to half
of their digits. List each self-motion once, by its member nearest to a wish within the joint limits, and each double
root exactly.
How. Solutions at which the Jacobian has lost rank are classified (`singular_solutions`): those that stand alone, exact
where they are double; and members of sets, which are followed, each once (`solution_sets`) and stood for by one member
(`chosen_members`). What is so near to another one that it is the same is left out (`root_neighbours`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.inverse.self_motion.chosen_members import SelfMotion, standing_for
from robokin.inverse.self_motion.curve_tracing import Curve
from robokin.inverse.self_motion.fronts import slide_reach
from robokin.inverse.self_motion.pose_correction import corrected, errors, scale_of
from robokin.inverse.self_motion.root_neighbours import (
    CROWDED,
    SETTLED,
    crowded,
    on_motions,
    repeated,
    stalled,
    thinned,
)
from robokin.inverse.self_motion.solution_sets import Families, families
from robokin.inverse.self_motion.straight_motions import on_the_way_home
from robokin.inverse.verify import CLOSES, Found, with_ones_within
from robokin.inverse.window import least_singular_values
from robokin.kernel.chain import Chain
from robokin.kernel.ranks import ROOT_RANK
from robokin.kernel.residual import error_and_jacobian

FLAT = 1e-12
"""Error [size and rad] up to which a curve that could not be followed to its end has no solutions to be told apart:
where it is so small over `CROWDED`, its slope is below what rounding of the pose makes of a solution's place."""

FEW = 4
"""Solutions that may stand alone in a valley; of a set that could not be followed any number would settle."""


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
    found, least = thinned(chain, found, least, size)
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
    q[stands] = standing_for(chain, solver, T[targets], curves, q[stands], size, limits, rest, near)
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
    keep[stalled(index, keep, least, off)] = False
    rows = np.setdiff1d(np.flatnonzero(keep & np.isin(index, index[singular[alone]])), stands)
    again, beside = repeated(chain, T, index, q, rows, size, least)
    keep[again] = False
    keep[on_motions(chain, index, q, rows, size, least, motions)] = False
    close = crowded(chain, index, q, singular[alone & keep[singular] & (least[singular] < ROOT_RANK)], size)
    return (
        Found(index, q, position, angle).pick(keep),
        motions,
        np.unique(np.concatenate([unclear, close, astray, np.array([*lost, *sets.open], dtype=np.intp)])),
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


def _better(position: Array, angle: Array, there: Array, size: float) -> tuple[Array, Array, Flags]:
    """Residuals (s,) [m, rad] of solutions or of where they could be moved, with the error `there` (s, 6), and whether
    they are moved: to what closes as well."""
    new_position, new_angle = np.linalg.norm(there[:, :3], axis=1) * size, np.linalg.norm(there[:, 3:], axis=1)
    moved = np.maximum(new_position / size, new_angle) <= np.maximum(np.maximum(position / size, angle), SETTLED)
    return np.where(moved, new_position, position), np.where(moved, new_angle, angle), moved


def _flat(chain: Chain, T: Array, curve: Curve, size: float) -> bool:
    """Whether the pose hardly leaves T (4, 4) along a long piece of a curve that ends somewhere."""
    off = np.max(np.abs(errors(chain, np.broadcast_to(T, (len(curve.x), 4, 4)), curve.x, size)[0]), axis=1)
    pieces = np.split(curve.x, np.flatnonzero(off > FLAT))
    return any(float(np.max(np.ptp(piece[1:], axis=0))) >= CROWDED for piece in pieces if len(piece) > 2)
