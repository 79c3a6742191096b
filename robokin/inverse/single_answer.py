"""The answer for one target of a block: its solutions with their names, its self-motions, and why there is none."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from robokin.arrays import Array
from robokin.inverse.claims import BASES
from robokin.inverse.later_fields import with_later_nearest
from robokin.inverse.self_motion.arcs import arcs_of_each
from robokin.inverse.self_motion.curve_crossings import crossings
from robokin.inverse.self_motion.redundant import NOT_FOUND, seeds_of
from robokin.inverse.self_motion.solution_sets import families
from robokin.inverse.solution_names import branch_names
from robokin.inverse.solutions import Arc, Family, Result, Solution, named_later
from robokin.inverse.target_block import Request, TargetBlock, stands_for
from robokin.inverse.verify import within_limits, wrapped
from robokin.kinematics.forward import forward_kinematics

REACHED = 1e-8
"""A nearest configuration whose position is off by less, in the arm's size, lacks only the orientation."""

FAR = "out of reach"
"""The reason where not even the position can be had."""


def result_of(request: Request, block: TargetBlock, i: int) -> Result:
    """The answer for target i of a block: names, self-motions, reasons."""
    analysis, found = request.analysis, block.found
    rows = slice(np.searchsorted(found.index, i), np.searchsorted(found.index, i, side="right"))
    q = found.q[rows]
    table = np.column_stack([q, found.position[rows], found.angle[rows], block.inside[rows]])
    name, free = partial(_name, block), partial(_free, block)
    solutions = named_later(name, table, q.shape[1], free, first=int(rows.start))
    method = "numeric" if request.method == "numeric" else analysis.method
    sets = families_of(request, block, i, q)
    basis = bool(block.claims.basis[i])
    complete = basis and not block.cut[i]
    idle = {i + 1 for i in analysis.idle}
    postures = complete and all(idle.issuperset(solution.free) for solution in solutions)
    known = {joint for family in sets for joint in family.joints} | idle
    known_all = basis and all(known.issuperset(solution.free) for solution in solutions)
    complete = complete and known_all and not (idle and solutions)
    all_motions = known_all and not (idle and solutions)
    if request.motions and solutions and block.in_closed_form(i):
        all_motions = all(arc.swivel is not None for family in sets for arc in family.arcs)
    tried, same = block.claims.candidates, block.claims.duplicates
    found_of = {} if tried is None or same is None else {"found": int(tried[i]), "duplicates": int(same[i])}
    within = {"within_limits": int(block.within[i])} if request.limits else {}
    told: dict[str, Any] = {
        "families": sets,
        "families_complete": all_motions,
        "counts": {**found_of, "closing": int(block.closing[i]), **within, "listed": len(solutions)},
        "postures": postures,
        "basis": BASES[block.claims.basis[i]] if complete else None,
        "all_known": known_all,
        "certificate": block.claims.sentence(i),
    }
    if solutions:
        return Result(solutions, complete, method, **told)
    result = Result((), complete, method, **told)
    return with_later_nearest(result, known_reason(block, i), partial(why_not, request, block, i))


def _name(block: TargetBlock, row: int) -> str:
    return block.names[row]


def _free(block: TargetBlock, row: int) -> tuple[int, ...]:
    return block.free[row]


def families_of(request: Request, block: TargetBlock, i: int, q: Array) -> tuple[Family, ...]:
    """The self-motions of target i, with their pieces within the limits, for its listed solutions q: (k, n)."""
    analysis, robot = request.analysis, request.robot
    if request.method != "numeric" and analysis.redundancy == 1 and not analysis.open and not analysis.idle:
        return _redundant_families(request, block, i, q) if request.motions else ()
    if request.method == "numeric" or i not in block.claims.motions:
        return ()
    moving = analysis.moving
    own = len(moving)
    out = []
    for motion, own_arcs in zip(block.claims.motions[i], block.arcs(i), strict=True):
        arcs = []
        for arc in own_arcs:
            whole = np.tile(request.middle, (len(arc.q), 1))
            whole[:, moving] = arc.q
            if not request.limits:
                # Full turns of a joint count for nothing here: the piece is told about zero.
                middle = (np.min(whole, axis=0) + np.max(whole, axis=0)) / 2.0
                whole -= np.where(robot.revolute, 2.0 * np.pi * np.round(middle / (2.0 * np.pi)), 0.0)
            arcs.append(Arc(whole, arc.whole))
        joints = tuple(int(moving[k - 1]) + 1 for k in motion.curve.joints if k <= own)
        if not joints:
            continue
        solution = stands_for(robot, analysis, q, motion)
        out.append(Family(joints, motion.curve.dimension, motion.curve.closed, tuple(arcs), solution))
    return tuple(out)


def _redundant_families(request: Request, block: TargetBlock, i: int, q: Array) -> tuple[Family, ...]:
    """The self-motions of target i, for an arm with one joint to spare, that come within the limits.

    They are followed from the listed solutions q: (k, n) and from all that are known, within the limits or not. A
    curve that none of these is on, nor crosses one that is, is not known.
    """
    analysis, limits = request.analysis, request.own_limits
    if not len(q):
        return ()
    known = block.families(i)
    if known is not None:
        return known
    T, size = block.T[i], analysis.size
    listed = block.every[0][block.every[1] == i]
    seeds = np.concatenate([q, seeds_of(analysis, T, listed, limits, request.middle)])
    sets = families(analysis.chain, T[None], seeds, size, limits=limits)
    curves = sets.curves[0]
    _, crossing = crossings(curves, analysis.chain, np.broadcast_to(T, (len(curves), 4, 4)), size)
    if len(crossing):
        seeds = np.concatenate([seeds, crossing])
        sets = families(analysis.chain, T[None], seeds, size, limits=limits)
    curves = sets.curves[0]
    found = arcs_of_each(curves, analysis.chain, np.broadcast_to(T, (len(curves), 4, 4)), limits, size)
    out = []
    for number, (curve, arcs) in enumerate(zip(curves, found, strict=True)):
        members = np.flatnonzero(sets.of[: len(q)] == number)
        if arcs or len(members):
            solution = int(members[0]) if len(members) else -1
            out.append(Family(curve.joints, curve.dimension, curve.closed, arcs, solution))
    return tuple(out)


def known_reason(block: TargetBlock, i: int) -> str | None:
    """Why target i has no solution, if that is known without its nearest configuration.

    That the limits are in the way is, and that the target is farther off than the arm is long.
    """
    if block.closing[i]:
        return block.outside(i)
    if block.beyond[i]:
        return FAR
    return None if block.claims.basis[i] else NOT_FOUND


def why_not(request: Request, block: TargetBlock, i: int) -> tuple[str, Solution]:
    """Why a target has no solution, and the configuration that comes nearest."""
    robot, analysis = request.robot, request.analysis
    q, position, angle = block.nearest(i)
    q, inside = within_limits(wrapped(q[None], robot.revolute), robot.revolute, robot.limits, request.near)
    if analysis.open:
        # What the task leaves open is no error: all of the orientation, or the turn about the tool's z axis.
        z, wish = forward_kinematics(robot, q[0])[:3, 2], block.T[i, :3, 2]
        angle = float(2.0 * np.arcsin(np.minimum(np.linalg.norm(z - wish) / 2.0, 1.0))) if analysis.open == 1 else 0.0
    nearest = Solution(q[0], branch_names(robot, q)[0], bool(inside[0]), position, angle)
    reason = known_reason(block, i)
    if reason is not None:
        return reason, nearest
    if analysis.open < 3 and position <= REACHED * analysis.size:
        return "orientation not attainable by this arm at that position", nearest
    return FAR, nearest
