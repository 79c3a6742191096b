"""Search for the variables u of a robot whose joints hang on each other, where no closed form of it holds.

Statement. Given a pose, find variables u of v = S u + o that bring the tool there, S being tall, wide or singular.
Derivation. Descents in u from configurations that are drawn within the limits (`driven_descent`); distinct ends that
arrive are solutions. Where variables can move while the task stays there are infinitely many, of which some are listed,
each far from the others, and next to a wish the one that a motion along them leads to.
Degenerate case. Nothing proves that what is found is all, or that there is none, but for what is out of reach.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from robokin.arrays import Array
from robokin.inverse.analysis import Task, analysis_of
from robokin.inverse.claims import SEARCHED, SPREAD
from robokin.inverse.coupled_turns import SAME
from robokin.inverse.full_turns import task_errors
from robokin.inverse.numeric.closest import beyond_reach
from robokin.inverse.numeric.driven_descent import chosen_starts, driven_ends, driven_search
from robokin.inverse.numeric.driven_tips import DrivenTips, errors_and_slopes
from robokin.inverse.self_motion.redundant import NOT_FOUND
from robokin.inverse.self_motion.spread import well_spread
from robokin.inverse.single_answer import FAR
from robokin.inverse.solutions import Result, Solution
from robokin.kernel.chain import chain_of, chain_size
from robokin.kernel.facts import fact
from robokin.kernel.ranks import RANK
from robokin.model import CoupledRobot
from robokin.spatial.angles import circled

STARTS = 64
"""Descents for each target of an arm with followers; distinct ends of them are listed."""

SPREAD_LISTED = 16
"""Postures that are listed of infinitely many, as of arms whose joints move one by one."""

NEARER_STEPS = 24
"""Steps along a self-motion towards what is wished."""

LONGEST_STEP = 0.3
"""The longest of them [rad | size]: the target is found again from there."""

FOLLOWERS = "fewer freedoms than joints that move: found by search, which proves nothing"
SPARE = "more variables than joints that they move: found by search, which proves nothing"
ALIKE = "variables that move the same joints alike: found by search, which proves nothing"
NEARLY = 1e-7
"""What a nearest configuration may lack, in the arm's size, and yet only the orientation is said to be lacking."""


@dataclass(frozen=True, eq=False)
class CoupledWish:
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


def why_searched(robot: CoupledRobot) -> str:
    """Why no closed form holds."""
    joints, variables = robot.drive.S.shape
    return FOLLOWERS if joints > variables else SPARE if joints < variables else ALIKE


def as_solutions(wish: CoupledWish, T: Array, rows: Sequence[tuple[Array, Solution]]) -> list[Solution]:
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
            angle_error=float(angle[i]), free=variables_moved(robot, rows[i][1].free),
        )
        for i in order.tolist()
    ]  # fmt: skip


def variables_moved(robot: CoupledRobot, joints: tuple[int, ...]) -> tuple[int, ...]:
    """The variables that move where some joints do; both count from 1."""
    if not joints:
        return ()
    moved = np.any(robot.drive.inverse[:, [joint - 1 for joint in joints]] != 0.0, axis=1)
    return tuple((np.flatnonzero(moved) + 1).tolist())


@fact
def coupled_tips(robot: CoupledRobot, task: Task, limits: bool) -> DrivenTips:
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


def _home(wish: CoupledWish) -> Array:
    """Where a search begins: near the wish, else in the middle of the limits."""
    if wish.near is not None:
        return wish.near
    box = wish.robot.limits
    ends = np.where(np.isfinite(box), box, np.where(np.isfinite(box[:, ::-1]), box[:, ::-1], 0.0))
    return np.asarray(0.5 * (ends[:, 0] + ends[:, 1]))


def search_one(wish: CoupledWish, T: Array) -> Array | None:
    """A configuration (n,) that reaches T, if the search finds one."""
    ends = driven_search(coupled_tips(wish.robot, wish.task, wish.limits), T[None, None], _home(wish), wish.seed)
    return ends.u[0] if ends.reached[0] else None


def nearest_found(wish: CoupledWish, T: Array) -> Solution:
    """The configuration that comes nearest."""
    ends = driven_search(coupled_tips(wish.robot, wish.task, wish.limits), T[None, None], _home(wish), wish.seed)
    inside = bool(wish.robot.within_limits(ends.u[0]))
    return Solution(ends.u[0], "", inside, float(ends.place[0, 0]), float(ends.angle[0, 0]))


def unnamed(q: Array) -> Solution:
    """A configuration (n,) as a solution of which no more is known."""
    return Solution(q, "", True, 0.0, 0.0)


def all_found(wish: CoupledWish, T: Array) -> Result:
    """The answer for one target of an arm with followers: what descents find."""
    robot = wish.robot
    tips = coupled_tips(robot, wish.task, wish.limits)
    u = chosen_starts(tips, T[None, None], wish.seed, STARTS)[0]
    u = np.concatenate([np.clip(_home(wish), tips.limits[:, 0], tips.limits[:, 1])[None], u])
    ends = driven_ends(tips, np.repeat(T[None, None], len(u), axis=0), u)
    chosen: list[Array] = []
    for q in ends.u[ends.reached]:
        if not any(np.max(np.abs(q - other) / wish.scale) < SAME for other in chosen):
            chosen.append(q)
    one = None if chosen else search_one(wish, T)
    if one is not None:
        chosen = [one]
    endless = bool(chosen) and _can_move(tips, T, chosen)
    if endless and wish.near is not None:
        chosen.append(_nearer(wish, tips, T, chosen))
    if endless:
        chosen = _spread_ones(wish, chosen)
    solutions = as_solutions(wish, T, [(q, unnamed(q)) for q in chosen])
    listed = tuple(solutions[: wish.most] if wish.most else solutions)
    counts = {"closing": len(solutions), "listed": len(listed)}
    words = SPREAD if endless else why_searched(robot)
    told = Result(listed, False, "search", None, None, counts, certificate=words)
    if listed:
        return told
    nearest = nearest_found(wish, T)
    size = chain_size(chain_of(robot.free_motion))
    far = bool(beyond_reach(analysis_of(robot.free_motion, wish.task), T[None], robot.free_motion.limits)[0])
    only_turn = wish.task != "position" and nearest.position_error <= NEARLY * size
    reason = FAR if far else "orientation not found by search (not proven unreachable)" if only_turn else NOT_FOUND
    return replace(told, reason=reason, nearest=nearest, certificate=SEARCHED)


def _can_move(tips: DrivenTips, T: Array, chosen: Sequence[Array]) -> bool:
    """Whether at each of some solutions variables can move while the task stays: then there are infinitely many."""
    u = np.array(chosen)
    _, J = errors_and_slopes(tips, np.repeat(T[None, None], len(u), axis=0), u)
    values = np.linalg.svd(J, compute_uv=False)
    return bool(np.all(np.sum(values > RANK * values[:, :1], axis=1) < tips.n))


def _spread_ones(wish: CoupledWish, chosen: list[Array]) -> list[Array]:
    """Some of many solutions, the one next to the wish, or to the middle of the limits, first, each far from others."""
    x = np.array(chosen)
    turning = wish.robot.revolute
    move = np.max(np.abs(x - _home(wish)) / wish.scale, axis=1)
    x = circled(x, turning) / wish.scale
    index, rank = np.zeros(len(x), dtype=np.intp), np.ones(len(x), dtype=np.intp)
    most = SPREAD_LISTED if wish.most is None else wish.most
    return [chosen[i] for i in well_spread(index, x, turning, move, rank, most).tolist()]


def _nearer(wish: CoupledWish, tips: DrivenTips, T: Array, chosen: Sequence[Array]) -> Array:
    """The solution (n,) that the one next to the wish comes to when it moves towards it while the task stays."""
    target = T[None, None]
    moves = [np.max(np.abs(q - _home(wish)) / wish.scale) for q in chosen]
    u = chosen[int(np.argmin(moves))]
    for _ in range(NEARER_STEPS):
        _, J = errors_and_slopes(tips, target, u[None])
        _, values, V = np.linalg.svd(J[0])
        free = V[int(np.sum(values > RANK * values[0])) :]
        step = free.T @ (free @ ((_home(wish) - u) / wish.scale))
        step *= LONGEST_STEP / max(float(np.max(np.abs(step))), LONGEST_STEP)
        there = driven_ends(tips, target, np.clip(u + step * wish.scale, tips.limits[:, 0], tips.limits[:, 1])[None])
        if not there.reached[0] or np.max(np.abs(step)) < SAME:
            break
        u = there.u[0]
    return u
