"""Inverse kinematics of a robot whose joints hang on each other: v = S u + o, the variables u being what is asked for.

Statement. Given a pose, find the variables u that bring the tool there.
Derivation. Where S is square and regular the joints' values v are found by the arm whose joints move one by one, with
everything that is known of it, and u = S⁻¹ (v - o). A full turn of a joint that turns leaves the pose, but not always
the variables: v + 2π k, k whole, has u + 2π S⁻¹ k. Where S⁻¹ is whole these are the full turns of the variables; where
it is not (a ratio of 13 to 72) they are other configurations of the drives, and all of those within the limits are
listed. Joints that are not connected by S do not know of each other: their choices are combined.
Where S is tall (a joint follows another) the arm has fewer freedoms than joints, and no closed form of it holds: what
is found by descents in u is listed, and that these are all is not said.
Degenerate case. Of self-motions the pieces within limits of variables end at the last point within, where those of an
arm without couplings end on the limit; `complete` is then not said. Without limits, u of angles is within half a turn.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.errors import InputError
from robokin.inverse.analysis import Task, analysis_of
from robokin.inverse.claims import SEARCHED
from robokin.inverse.full_turns import check_turns, task_errors
from robokin.inverse.numeric.closest import beyond_reach
from robokin.inverse.numeric.driven_descent import chosen_starts, driven_ends, driven_search
from robokin.inverse.numeric.driven_tips import DrivenTips
from robokin.inverse.self_motion.redundant import NOT_FOUND, UNPROVEN
from robokin.inverse.single_answer import FAR
from robokin.inverse.solutions import Arc, BatchResult, Family, Result, Solution
from robokin.inverse.target_block import OUTSIDE
from robokin.inverse.verify import within_limits, wrapped
from robokin.kernel.chain import chain_of, chain_size
from robokin.kernel.facts import fact
from robokin.model import CoupledRobot, Robot
from robokin.model.robot import tolerated, within

TURN = 2.0 * math.pi

MOST = 10_000
"""Configurations of the drives that are looked at for one of the joints: limits that allow more are refused."""

LISTED = 4
"""How many times as many postures of arms with joints to spare are taken, of which some are outside the limits."""

STARTS = 64
"""Descents for each target of an arm with followers; distinct ends of them are listed."""

SAME = 1e-6
"""Variables that differ by less in everything [rad | size] are one configuration."""

FOLLOWERS = "joints that follow others, found by search: there may be more"
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
    pieces, endless = [], False
    for solution in motion.solutions:
        q, more = _configurations(robot, drive.variables_for(solution.q), wish.limits, wish.turns, wish.near)
        endless |= more
        rows += [(u, solution) for u in q]
    for family in motion.families:
        arcs = _pieces(wish, family)
        pieces.append(replace(family, joints=_moved(robot, family.joints), arcs=arcs, solution=-1))
        if wish.limits and arcs and not rows:
            like = next(s for s in motion.solutions)
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
        certificate=words, counts=counts, families=tuple(pieces), postures=motion.postures and complete,
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


@fact
def _groups(robot: CoupledRobot) -> list[tuple[Index, Index]]:
    """Rows and variables that S connects, with nothing between the groups."""
    n = robot.n
    linked = np.abs(robot.drive.S) > 0.0
    linked = linked | (np.abs(robot.drive.inverse.T) > 0.0)
    groups: list[tuple[Index, Index]] = []
    open_ = set(range(n))
    while open_:
        variables = {min(open_)}
        rows: set[int] = set()
        while True:
            more_rows = set(np.flatnonzero(linked[:, sorted(variables)].any(axis=1)).tolist())
            more = set(np.flatnonzero(linked[sorted(more_rows)].any(axis=0)).tolist())
            if more == variables and more_rows == rows:
                break
            variables, rows = more | variables, more_rows
        open_ -= variables
        groups.append((np.array(sorted(rows), dtype=np.intp), np.array(sorted(variables), dtype=np.intp)))
    return groups


@fact
def _one_for_each(robot: CoupledRobot) -> bool:
    """Whether full turns of the joints are full turns of the variables: a posture is one configuration of these."""
    turned = robot.drive.inverse[:, robot.free_motion.revolute]
    return bool(np.all(turned[robot.revolute] % 1.0 == 0.0) and not turned[~robot.revolute].any())


def _configurations(
    robot: CoupledRobot, u: Array, limits: bool, turns: bool, near: Array | None = None
) -> tuple[list[Array], bool]:
    """The variables (n,) [rad | m] that stand for the same posture as u (n,), one of those that are full turns apart.

    With `limits` those within these; with `turns` all of them, else of full turns of the variables the one nearest to
    `near` (n,), or to zero. Also whether there are more of them without end.
    """
    if not turns and _one_for_each(robot):
        q, inside = within_limits(wrapped(u[None], robot.revolute), robot.revolute, robot.limits, near)
        if not inside[0]:  # no turn of a variable is within its limits
            return ([] if limits else [q[0]]), False
        if robot.within_limits(q[0]):
            return [q[0]], False
    choices, endless = [], False
    for rows, variables in _groups(robot):
        wish = np.zeros(len(variables)) if near is None else near[variables]
        found, more = _of_group(robot, rows, variables, u, limits, turns, wish)
        endless |= more
        choices.append((variables, found))
    if math.prod(len(found) for _, found in choices) > MOST:
        raise InputError(
            f"the limits of {robot.name} allow more than {MOST} turns of its drives, expected narrower ones"
        )
    out = []
    for combination in itertools.product(*(found for _, found in choices)):
        q = np.empty(robot.n)
        for (variables, _), part in zip(choices, combination, strict=True):
            q[variables] = part
        out.append(q)
    return out, endless


def _of_group(
    robot: CoupledRobot, rows: Index, variables: Index, u: Array, limits: bool, turns: bool, near: Array
) -> tuple[list[Array], bool]:
    """The same for the variables of one group: their values (k,), of equal ones that next to `near` (k,)."""
    drive = robot.drive
    step = TURN * drive.inverse[np.ix_(variables, rows)] * robot.free_motion.revolute[rows]
    turning = robot.revolute[variables]
    box = robot.limits[variables]
    finite: Flags = np.all(np.isfinite(box), axis=1)
    start = u[variables]
    whole = drive.inverse[np.ix_(variables, rows)]
    whole = whole[:, robot.free_motion.revolute[rows]]
    ratios = bool(np.any(np.abs(whole - np.round(whole)) > 1e-12))
    slides = ~robot.free_motion.revolute[rows]
    S = drive.S[np.ix_(rows, variables)]
    searched = _searched_box(box, turning, limits, near)
    least, most = _ranges(S, step, start, _bounded(S, slides, turning, start[None], searched))
    q = start + _whole_numbers(robot, least, most) @ step.T
    o, own = drive.offsets[rows], drive.limits[rows]
    low, high = tolerated(searched)
    q = q[np.all((q >= low) & (q <= high), axis=1)]
    if limits:
        q = q[within(own, q @ S.T + o)]
    if not len(q):
        return [], False
    rest = np.max(np.abs(q - near), axis=1)
    outside = ~_inside(box, own, q, q @ S.T + o)
    keep = np.lexsort((rest, outside))
    chosen: list[Array] = []
    for i in keep.tolist():
        same = turning if not turns else np.zeros(len(turning), dtype=bool)
        if not any(_equal(q[i], other, same) for other in chosen):
            chosen.append(q[i])
    return chosen, ratios and not bool(np.all(finite | ~turning))


def _inside(box: Array, own: Array, q: Array, v: Array) -> Flags:
    """(s,) whether variables q (s, k) are within box (k, 2), and joints' values v (s, r) within own (r, 2)."""
    return np.asarray(within(box, q)) & np.asarray(within(own, v))


def _equal(a: Array, b: Array, turning: Flags) -> bool:
    """Whether two values (k,) are the same, of angles but for full turns."""
    gap = a - b
    gap = np.where(turning, gap - TURN * np.round(gap / TURN), gap)
    return bool(np.max(np.abs(gap), initial=0.0) < SAME)


def _searched_box(box: Array, turning: Flags, limits: bool, near: Array) -> Array:
    """Between which values (k, 2) the variables are looked for: their limits, of angles without any half a turn.

    Where limits do not count, an angle is anywhere within half a turn of `near` (k,) or its limits.
    """
    half = near[:, None] + [-np.pi, np.pi]
    free = np.tile([-np.inf, np.inf], (len(box), 1))
    if limits:
        bounded = np.any(np.isfinite(box), axis=1, keepdims=True)
        around = np.where(bounded, _one_turn(box, near), half)
        return np.where(turning[:, None], around, box)
    wide = np.stack(
        [np.where(np.isfinite(box[:, 0]), np.minimum(box[:, 0], half[:, 0]), half[:, 0]),
         np.where(np.isfinite(box[:, 1]), np.maximum(box[:, 1], half[:, 1]), half[:, 1])], axis=1
    )  # fmt: skip
    return np.where(turning[:, None], wide, free)


def _bounded(S: Array, slides: Flags, turning: Flags, points: Array, box: Array) -> Array:
    """The box (k, 2) with an end for what slides without limits: where full turns from points (s, k) may bring it.

    slides: (r,) rows of S that do not turn. They stay where they are, and so the variables that slide follow those that
    turn, which are bounded.
    """
    if np.all(np.isfinite(box)):
        return box
    rate = -np.linalg.solve(S[np.ix_(slides, ~turning)], S[np.ix_(slides, turning)])
    least, most = points.min(axis=0), points.max(axis=0)
    ends = np.stack([rate * (box[turning, 0] - most[turning]), rate * (box[turning, 1] - least[turning])])
    low, high = least[~turning] + ends.min(axis=0).sum(axis=1), most[~turning] + ends.max(axis=0).sum(axis=1)
    out = box.copy()
    out[~turning, 0], out[~turning, 1] = np.maximum(box[~turning, 0], low), np.minimum(box[~turning, 1], high)
    return out


def _one_turn(box: Array, near: Array) -> Array:
    """Limits (k, 2) of which a missing one is half a turn beyond `near` (k,), and a turn or more from the other."""
    low = np.where(np.isfinite(box[:, 0]), box[:, 0], np.minimum(near - np.pi, box[:, 1] - TURN))
    high = np.where(np.isfinite(box[:, 1]), box[:, 1], np.maximum(near + np.pi, box[:, 0] + TURN))
    return np.stack([low, high], axis=1)


def _ranges(S: Array, step: Array, start: Array, box: Array) -> tuple[Index, Index]:
    """The least and the greatest whole numbers of turns (r,) of each row that leave the variables in a box (k, 2)."""
    # v - v0 = S (u - u0) = 2π k of the rows that turn: of u in a box each is in an interval.
    with np.errstate(invalid="ignore"):
        ends = np.stack([S * (box[:, 0] - start), S * (box[:, 1] - start)])
    ends = np.where(S == 0.0, 0.0, ends)
    low, high = ends.min(axis=0).sum(axis=1), ends.max(axis=0).sum(axis=1)
    turns = np.any(step != 0.0, axis=0)
    low, high = np.where(turns, low, 0.0) / TURN, np.where(turns, high, 0.0) / TURN
    # Something to spare for rounding: what is outside is left out afterwards.
    return np.ceil(low - 1e-6).astype(np.intp), np.floor(high + 1e-6).astype(np.intp)


def _pieces(wish: _Wish, family: Family) -> tuple[Arc, ...]:
    """The pieces of a self-motion in the variables, with `limits` within these."""
    robot = wish.robot
    out: list[Arc] = []
    for arc in family.arcs:
        u = robot.drive.variables_for(arc.q)
        if not wish.limits:
            middle = 0.5 * (np.min(u, axis=0) + np.max(u, axis=0))
            out.append(Arc(u - np.where(robot.revolute, TURN * np.round(middle / TURN), 0.0), arc.whole))
            continue
        for shift in _shifts(robot, u):
            inside = np.asarray(robot.within_limits(u + shift))
            if inside.any():
                out += _runs(u + shift, inside, arc.whole)
    return tuple(out)


def _shifts(robot: CoupledRobot, u: Array) -> list[Array]:
    """The full turns (n,), in the variables, by which points of a curve (k, n) may come within the limits."""
    drive, near = robot.drive, np.zeros(robot.n)
    shifts = [near]
    for rows, variables in _groups(robot):
        S = drive.S[np.ix_(rows, variables)]
        step = TURN * drive.inverse[np.ix_(variables, rows)] * robot.free_motion.revolute[rows]
        box = _searched_box(robot.limits[variables], robot.revolute[variables], True, near[variables])
        points = u[:, variables]
        box = _bounded(S, ~robot.free_motion.revolute[rows], robot.revolute[variables], points, box)
        # Between which turns those of all points are: the ends of what S makes of the curve.
        turned = points @ S.T
        ends = [
            _ranges(S, step, end @ drive.inverse[np.ix_(variables, rows)].T, box)
            for end in (turned.max(axis=0), turned.min(axis=0))
        ]
        grid = _whole_numbers(robot, ends[0][0], ends[1][1]) @ step.T
        own = drive.limits[rows]
        moved = []
        for turn in grid:
            q = points + turn
            if _inside(robot.limits[variables], own, q, q @ S.T + drive.offsets[rows]).any():
                whole = np.zeros(robot.n)
                whole[variables] = turn
                moved.append(whole)
        shifts = [one + other for one in shifts for other in moved]
    return shifts


def _whole_numbers(robot: Robot, least: Index, most: Index) -> Array:
    """All rows of whole numbers (r,) between two. Raises InputError where they are too many."""
    if float(np.prod((most - least + 1).astype(np.float64))) > MOST:
        raise InputError(
            f"the limits of {robot.name} allow more than {MOST} turns of its drives, expected narrower ones"
        )
    ranges = (range(a, b + 1) for a, b in zip(least.tolist(), most.tolist(), strict=True))
    return np.array(list(itertools.product(*ranges))).reshape(-1, len(least))


def _runs(u: Array, inside: Flags, whole: bool) -> list[Arc]:
    """The pieces of a curve (k, n) whose points are inside, each of them two or more points."""
    if inside.all():
        return [Arc(u, whole)]
    if whole and inside[0]:  # the curve closes: a piece may run over where it begins
        first = int(np.flatnonzero(~inside)[0])
        ahead = u[1 : first + 1] + (u[-1] - u[0])
        u, inside = np.concatenate([u[first:], ahead]), np.concatenate([inside[first:], inside[1 : first + 1]])
    edges = np.flatnonzero(np.diff(np.concatenate([[0], inside.astype(np.int8), [0]])))
    return [Arc(u[a:b]) for a, b in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True) if b - a > 1]


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
