"""Inverse kinematics of a robot whose joints hang on each other: v = S u + o, the variables u being what is asked for.

Statement. Given a pose, find the variables u that bring the tool there.
Derivation. Where S is square and regular the joints' values v are found by the arm whose joints move one by one, with
everything that is known of it, and u = S⁻¹ (v - o), as many as full turns of the joints make (`coupled_turns`).
Where S is tall (a joint follows another) the arm has fewer freedoms than joints, and no closed form of it holds: it is
searched (`coupled_search`).
Degenerate case. Of self-motions the pieces within limits of variables end at the last point within, where those of an
arm without couplings end on the limit; `complete` is then not said. Without limits, u of angles is within half a turn.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from robokin.arrays import Array
from robokin.inverse.analysis import Task, analysis_of
from robokin.inverse.coupled_search import (
    CoupledWish,
    all_found,
    as_solutions,
    nearest_found,
    search_one,
    unnamed,
    variables_moved,
    why_searched,
)
from robokin.inverse.coupled_turns import configurations, pieces
from robokin.inverse.full_turns import check_turns
from robokin.inverse.self_motion.redundant import UNPROVEN
from robokin.inverse.solutions import BatchResult, Result, Solution
from robokin.inverse.target_block import OUTSIDE
from robokin.model import CoupledRobot

LISTED = 4
"""How many times as many postures of arms with joints to spare are taken, of which some are outside the limits."""

ENDLESS = "a variable without limits turns a joint through a ratio: there are more, full turns apart"
CUT_MOTIONS = "the pieces of self-motions within the limits of coupled joints were found by points alone"


def about_inverse(robot: CoupledRobot) -> tuple[str, str, bool]:
    """How it is solved, why so, and whether every solution is found."""
    if not robot.drive.invertible:
        return "search", why_searched(robot), False
    analysis = analysis_of(robot.free_motion)
    return analysis.method, f"{analysis.sentence}; what moves them from these", analysis.complete


def solve_coupled(
    robot: CoupledRobot, T: Array, solve: Callable[..., BatchResult], task: Task, most: int | None, seed: int,
    limits: bool, near: Array | None, turns: bool,
) -> BatchResult:  # fmt: skip
    """The configurations u (n,) [rad | m] that reach each of T (m, 4, 4) [m]; `solve` solves an arm without couplings.

    Raises InputError for limits that allow too many turns.
    """
    if turns:
        check_turns(robot, limits)
    if robot.drive.invertible:
        # Of infinitely many postures some are listed: what the limits leave each joint draws them where they count.
        spare = limits and analysis_of(robot.free_motion, task).redundancy > 0
        arm = robot.bounded_motion if spare else robot.free_motion
        free = solve(arm, T, spare, LISTED * most if spare and most else None)
        wish = CoupledWish(robot, task, limits, near, turns, most, seed)
        results = [_of_motion(wish, T[i], free[i]) for i in range(len(T))]
        return _batch(wish, T, results, free.method)
    wish = CoupledWish(robot, task, limits, near, turns, most, seed)
    return _batch(wish, T, [all_found(wish, target) for target in T], "search")


# Square S ----------------------------------------------------------------------------------------------------------


def _of_motion(wish: CoupledWish, T: Array, motion: Result) -> Result:
    """The answer for one target from that of the arm whose joints move one by one, without limits."""
    robot, drive = wish.robot, wish.robot.drive
    rows: list[tuple[Array, Solution]] = []
    families, endless = [], False
    for solution in motion.solutions:
        q, more = configurations(robot, drive.variables_for(solution.q), wish.limits, wish.turns, wish.near)
        endless |= more
        rows += [(u, solution) for u in q]
    for family in motion.families:
        arcs = tuple(piece for arc in family.arcs for piece in pieces(robot, arc, wish.limits))
        families.append(replace(family, joints=variables_moved(robot, family.joints), arcs=arcs, solution=-1))
        if wish.limits and arcs and not rows:
            like = motion.solutions[0] if motion.solutions else unnamed(arcs[0].q[0])
            rows += [(arc.q[len(arc.q) // 2], like) for arc in arcs]
    cut_motions = bool(motion.families) and wish.limits
    if not rows and (motion.families or not motion.complete):
        found = search_one(wish, T)
        if found is not None:
            rows = [(found, unnamed(found))]
    solutions = as_solutions(wish, T, rows)
    listed = solutions[: wish.most] if wish.most else solutions
    complete = motion.complete and len(listed) == len(solutions) and not endless and not cut_motions
    words = CUT_MOTIONS if cut_motions else ENDLESS if endless else motion.certificate
    counts = {**motion.counts, "within_limits": len(solutions), "listed": len(listed)}
    if not wish.limits:
        counts.pop("within_limits")
    counts.pop("turns", None)
    told = replace(
        motion, solutions=tuple(listed), complete=complete, basis=motion.basis if complete else None,
        certificate=words, counts=counts, families=tuple(families), postures=motion.postures and complete,
        all_known=motion.all_known and not endless and not cut_motions, reason=None, nearest=None, question=None,
        families_complete=complete,
    )  # fmt: skip
    if listed:
        return told
    if not motion.solutions:
        return replace(told, reason=motion.reason)
    return replace(told, reason=OUTSIDE if complete else UNPROVEN)


def _batch(wish: CoupledWish, T: Array, results: list[Result], method: str) -> BatchResult:
    """The answers as arrays; what comes nearest is sought for those that are looked at."""
    m, most, n = len(results), max((len(result) for result in results), default=0), wish.robot.n
    q, position, angle = np.full((m, most, n), np.nan), np.full((m, most), np.nan), np.full((m, most), np.nan)
    inside = np.zeros((m, most), dtype=bool)
    for i, result in enumerate(results):
        for k, solution in enumerate(result.solutions):
            q[i, k], inside[i, k] = solution.q, solution.within_limits
            position[i, k], angle[i, k] = solution.position_error, solution.angle_error
    count = np.array([len(result) for result in results], dtype=np.intp)

    def single(i: int) -> Result:
        if not results[i].solutions and results[i].nearest is None:
            results[i] = replace(results[i], nearest=nearest_found(wish, T[i]))
        return results[i]

    return BatchResult(
        q, count, position, angle, inside, all(result.complete for result in results), method,
        single,
        lambda: [solution.branch for result in results for solution in result.solutions],
        lambda i: results[i].reason,
    )  # fmt: skip
