"""Inverse kinematics of a robot whose joints hang on each other: v = S u + o, the variables u being what is asked for.

Statement. Given a pose, find the variables u that bring the tool there.
Derivation. Where S is square and regular the joints' values v are found by the arm whose joints move one by one, with
everything that is known of it, and u = S⁻¹ (v - o), as many as full turns of the joints make (`coupled_turns`).
Where S is tall (a joint follows another) the arm has fewer freedoms than joints, and no closed form of it holds: what
is found by descents in u is listed, and that these are all is not said.
Degenerate case. Of self-motions the pieces within limits of variables end at the last point within, where those of an
arm without couplings end on the limit; `complete` is then not said. Without limits, u of angles is within half a turn.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from robokin.arrays import Array
from robokin.inverse.analysis import Task, analysis_of
from robokin.inverse.claims import SEARCHED
from robokin.inverse.coupled_turns import SAME, configurations, pieces
from robokin.inverse.full_turns import check_turns, task_errors
from robokin.inverse.numeric.closest import beyond_reach
from robokin.inverse.numeric.driven_descent import chosen_starts, driven_ends, driven_search
from robokin.inverse.numeric.driven_tips import DrivenTips
from robokin.inverse.self_motion.redundant import NOT_FOUND, UNPROVEN
from robokin.inverse.single_answer import FAR
from robokin.inverse.solutions import BatchResult, Result, Solution
from robokin.inverse.target_block import OUTSIDE
from robokin.kernel.chain import chain_of, chain_size
from robokin.kernel.facts import fact
from robokin.model import CoupledRobot

LISTED = 4
"""How many times as many postures of arms with joints to spare are taken, of which some are outside the limits."""

STARTS = 64
"""Descents for each target of an arm with followers; distinct ends of them are listed."""

FOLLOWERS = "fewer freedoms than joints that move: found by search, which proves nothing"
ENDLESS = "a variable without limits turns a joint through a ratio: there are more, full turns apart"
CUT_MOTIONS = "the pieces of self-motions within the limits of coupled joints were found by points alone"
NEARLY = 1e-7
"""What a nearest configuration may lack, in the arm's size, and yet only the orientation is said to be lacking."""


def about_inverse(robot: CoupledRobot) -> tuple[str, str, bool]:
    """How it is solved, why so, and whether every solution is found."""
    if not robot.drive.invertible:
        return "search", FOLLOWERS, False
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
        wish = _Wish(robot, task, limits, near, turns, most, seed)
        results = [_of_motion(wish, T[i], free[i]) for i in range(len(T))]
        return _batch(wish, T, results, free.method)
    wish = _Wish(robot, task, limits, near, turns, most, seed)
    return _batch(wish, T, [_searched(wish, target) for target in T], "search")


@dataclass(frozen=True, eq=False)
class _Wish:
    """What is asked of a robot."""

    robot: CoupledRobot
    task: Task
    limits: bool
    near: Array | None
    turns: bool
    most: int | None
    seed: int

    @property
    def scale(self) -> Array:
        """(n,) what variables are counted in [rad | m]."""
        return np.where(self.robot.revolute, 1.0, chain_size(chain_of(self.robot.free_motion)))


# Square S ----------------------------------------------------------------------------------------------------------


def _of_motion(wish: _Wish, T: Array, motion: Result) -> Result:
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
        families.append(replace(family, joints=_moved(robot, family.joints), arcs=arcs, solution=-1))
        if wish.limits and arcs and not rows:
            like = motion.solutions[0] if motion.solutions else _no_name(arcs[0].q[0])
            rows += [(arc.q[len(arc.q) // 2], like) for arc in arcs]
    cut_motions = bool(motion.families) and wish.limits
    if not rows and (motion.families or not motion.complete):
        found = _search_one(wish, T)
        if found is not None:
            rows = [(found, _no_name(found))]
    solutions = _listed(wish, T, rows)
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
    )  # fmt: skip
    if listed:
        return told
    if not motion.solutions:
        return replace(told, reason=motion.reason)
    return replace(told, reason=OUTSIDE if complete else UNPROVEN)


def _listed(wish: _Wish, T: Array, rows: Sequence[tuple[Array, Solution]]) -> list[Solution]:
    """Configurations with the solutions that they are of, as solutions, in their order."""
    if not rows:
        return []
    robot = wish.robot
    q = np.array([u for u, _ in rows])
    position, angle = task_errors(robot, q, np.repeat(T[None], len(q), axis=0), wish.task)
    inside = robot.within_limits(q).tolist()
    order = np.lexsort(np.round(q.T / 1e-7)[::-1])
    if wish.near is not None:
        order = order[np.argsort(np.max(np.abs(q[order] - wish.near) / wish.scale, axis=1), kind="stable")]
    return [
        replace(
            rows[i][1], q=q[i], within_limits=inside[i], position_error=float(position[i]),
            angle_error=float(angle[i]), free=_moved(robot, rows[i][1].free),
        )
        for i in order.tolist()
    ]  # fmt: skip


def _moved(robot: CoupledRobot, joints: tuple[int, ...]) -> tuple[int, ...]:
    """The variables that move where some joints do; both count from 1."""
    if not joints:
        return ()
    moved = np.any(robot.drive.inverse[:, [joint - 1 for joint in joints]] != 0.0, axis=1)
    return tuple((np.flatnonzero(moved) + 1).tolist())


# Search ------------------------------------------------------------------------------------------------------------


@fact
def _tips(robot: CoupledRobot, task: Task, limits: bool) -> DrivenTips:
    """What the search takes: the chain, S, and limits of the variables and of joints that hang on several."""
    drive, chain = robot.drive, chain_of(robot.free_motion)
    chain = replace(chain, offsets=chain.offsets + drive.offsets)
    own = np.flatnonzero(np.isfinite(drive.limits).any(axis=1) & (np.count_nonzero(drive.S, axis=1) > 1))
    free = np.tile([-np.inf, np.inf], (robot.n, 1))
    own = own if limits else own[:0]
    return DrivenTips(
        (chain,), (drive.S,), (task,), robot.revolute, robot.limits if limits else free,
        drive.S[own], drive.offsets[own], drive.limits[own],
    )  # fmt: skip


def _home(wish: _Wish) -> Array:
    """Where a search begins: near the wish, else in the middle of the limits."""
    if wish.near is not None:
        return wish.near
    box = wish.robot.limits
    ends = np.where(np.isfinite(box), box, np.where(np.isfinite(box[:, ::-1]), box[:, ::-1], 0.0))
    return np.asarray(0.5 * (ends[:, 0] + ends[:, 1]))


def _search_one(wish: _Wish, T: Array) -> Array | None:
    """A configuration (n,) that reaches T, if the search finds one."""
    ends = driven_search(_tips(wish.robot, wish.task, wish.limits), T[None, None], _home(wish), wish.seed)
    return ends.u[0] if ends.reached[0] else None


def _nearest(wish: _Wish, T: Array) -> Solution:
    """The configuration that comes nearest."""
    ends = driven_search(_tips(wish.robot, wish.task, wish.limits), T[None, None], _home(wish), wish.seed)
    inside = bool(wish.robot.within_limits(ends.u[0]))
    return Solution(ends.u[0], "", inside, float(ends.place[0, 0]), float(ends.angle[0, 0]))


def _no_name(q: Array) -> Solution:
    return Solution(q, "", True, 0.0, 0.0)


def _searched(wish: _Wish, T: Array) -> Result:
    """The answer for one target of an arm with followers: what descents find."""
    robot = wish.robot
    tips = _tips(robot, wish.task, wish.limits)
    u = chosen_starts(tips, T[None, None], wish.seed, STARTS)[0]
    u = np.concatenate([np.clip(_home(wish), tips.limits[:, 0], tips.limits[:, 1])[None], u])
    ends = driven_ends(tips, np.repeat(T[None, None], len(u), axis=0), u)
    chosen: list[Array] = []
    for q in ends.u[ends.reached]:
        if not any(np.max(np.abs(q - other) / wish.scale) < SAME for other in chosen):
            chosen.append(q)
    one = None if chosen else _search_one(wish, T)
    if one is not None:
        chosen = [one]
    solutions = _listed(wish, T, [(q, _no_name(q)) for q in chosen])
    listed = tuple(solutions[: wish.most] if wish.most else solutions)
    counts = {"closing": len(solutions), "listed": len(listed)}
    told = Result(listed, False, "search", None, None, counts, certificate=FOLLOWERS)
    if listed:
        return told
    nearest = _nearest(wish, T)
    size = chain_size(chain_of(robot.free_motion))
    far = bool(beyond_reach(analysis_of(robot.free_motion, wish.task), T[None], robot.free_motion.limits)[0])
    only_turn = wish.task != "position" and nearest.position_error <= NEARLY * size
    reason = FAR if far else "orientation not found by search (not proven unreachable)" if only_turn else NOT_FOUND
    return replace(told, reason=reason, nearest=nearest, certificate=SEARCHED)


def _batch(wish: _Wish, T: Array, results: list[Result], method: str) -> BatchResult:
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
            results[i] = replace(results[i], nearest=_nearest(wish, T[i]))
        return results[i]

    return BatchResult(
        q, count, position, angle, inside, all(result.complete for result in results), method,
        single,
        lambda: [solution.branch for result in results for solution in result.solutions],
        lambda i: results[i].reason,
    )  # fmt: skip
