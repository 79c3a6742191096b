"""`solve_ik`: every joint configuration that reaches a pose, each with its proof; why, when there is none."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robokin.errors import InputError
from robokin.inverse.analysis import Analysis, Task, analysis_of
from robokin.inverse.blocks import BLOCK, merged, solve_block
from robokin.inverse.branches import branch_names
from robokin.inverse.closest import TOGETHER, beyond_reach, nearest_configurations
from robokin.inverse.nearest import free_at, numeric_solutions
from robokin.inverse.result import BatchResult, Result, Solution
from robokin.inverse.spread import well_spread
from robokin.inverse.verify import Found, distinct, nothing, within_limits, wrapped
from robokin.kinematics.forward import forward_kinematics
from robokin.model import Robot
from robokin.spatial import nearest_rotation, rotation_error, transform

Array = NDArray[np.float64]
Method = Literal["auto", "analytic", "numeric"]
METHODS = ("auto", "analytic", "numeric")
TASKS = ("pose", "approach", "position")

ROTATION = 1e-6
"""A target whose rotation is off by more is none; below, rounding is taken out of it."""

REACHED = 1e-8
"""A nearest configuration whose position is off by less, in the arm's size, lacks only the orientation."""

MOST = 16
"""Solutions listed for an arm that has infinitely many."""

OUTSIDE = "outside the joint limits"
"""The reason where there are solutions but for the limits."""

FAR = "out of reach"
"""The reason where not even the position can be had."""


def solve_ik(
    robot: Robot,
    T: ArrayLike,
    limits: bool = True,
    near: ArrayLike | None = None,
    method: Method = "auto",
    task: Task = "pose",
    most: int | None = None,
    seed: int = 0,
) -> Result | BatchResult:
    """Every configuration that brings the tool to T.

    T: (4, 4) or (m, 4, 4) poses of the tool in the world [m]. `limits` lists only what respects the joint
    limits (an angle ±360° counts as the same configuration and is tried). `near` (n,) [rad | m] orders by the
    greatest joint move from there; otherwise the order is fixed: by q1, then q2, … ; of an arm with infinitely
    many solutions well spread ones are listed, each the farthest from those before. `task` is the whole pose,
    the position with the z axis (`approach`), or the position alone. `most` cuts the list.
    Returns a Result for one pose, a BatchResult for several. Raises InputError for what is no pose.
    """
    poses = target_poses(T)
    batch = solve_many(robot, poses.reshape(-1, 4, 4), limits, near, method, task, most, seed)
    return batch[0] if poses.ndim == 2 else batch


def solve_many(
    robot: Robot,
    T: ArrayLike,
    limits: bool = True,
    near: ArrayLike | None = None,
    method: Method = "auto",
    task: Task = "pose",
    most: int | None = None,
    seed: int = 0,
) -> BatchResult:
    """`solve_ik` for poses T: (m, 4, 4), whatever their number."""
    poses = target_poses(T).reshape(-1, 4, 4)
    request = _request(robot, limits, near, method, task, most, seed)
    answers = [_Block(request, poses[start : start + BLOCK]) for start in range(0, len(poses), BLOCK)]
    return _batch(request, answers)


def target_poses(T: ArrayLike) -> Array:
    """Targets as an array (4, 4) or (m, 4, 4); InputError for what are no rigid transforms, saying how far off."""
    try:
        poses = np.array(T, dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError("a target must be an array of numbers (4, 4) or (m, 4, 4)") from None
    if poses.ndim not in (2, 3) or poses.shape[-2:] != (4, 4):
        raise InputError(f"found a target of shape {poses.shape}, expected (4, 4) or (m, 4, 4)")
    if not np.all(np.isfinite(poses)):
        raise InputError("found a target with numbers that are not finite, expected finite numbers")
    if np.any(np.abs(poses[..., 3, :] - [0.0, 0.0, 0.0, 1.0]) > 1e-9):
        raise InputError("found a target whose last row is not 0 0 0 1, expected a homogeneous matrix")
    off = rotation_error(poses[..., :3, :3])
    if np.any(off > ROTATION):
        raise InputError(f"found a target whose rotation is off by {np.max(off):.2g}, expected at most {ROTATION:g}")
    if np.any(off > 1e-14):
        poses = transform(nearest_rotation(poses[..., :3, :3]), poses[..., :3, 3])
    return poses


@dataclass(frozen=True, eq=False)
class Request:
    """What is asked for, checked."""

    robot: Robot
    analysis: Analysis
    limits: bool
    near: Array | None
    method: Method
    most: int | None
    seed: int

    @property
    def own_limits(self) -> Array:
        """(n, 2) the limits that searches stay within."""
        return self.robot.limits if self.limits else np.tile([-np.inf, np.inf], (self.robot.n, 1))

    @property
    def middle(self) -> Array:
        """(n,) where a joint is put that may be anywhere [rad | m]: at `near`, or at zero, or amid its limits."""
        low, high = self.robot.limits.T
        if self.near is not None:
            turned, _ = within_limits(self.near[None], self.robot.revolute, self.robot.limits, self.near)
            return np.clip(turned[0], low, high) if self.limits else self.near
        with np.errstate(invalid="ignore"):
            amid = np.where(np.isfinite(low) & np.isfinite(high), (low + high) / 2.0, np.clip(0.0, low, high))
        return np.where((low <= 0.0) & (high >= 0.0), 0.0, amid)


def _request(
    robot: Robot, limits: bool, near: ArrayLike | None, method: Method, task: Task, most: int | None, seed: int
) -> Request:
    if method not in METHODS:
        raise InputError(f"found method '{method}', expected {' or '.join(METHODS)}")
    if task not in TASKS:
        raise InputError(f"found task '{task}', expected {' or '.join(TASKS)}")
    if robot.n == 0:
        raise InputError(f"{robot.name} has no joints, expected a robot that can move")
    if near is not None:
        near = np.asarray(near, dtype=np.float64)
        if near.shape != (robot.n,):
            raise InputError(f"near has {near.size} values, expected {robot.n}: one for each joint of {robot.name}")
        if not np.all(np.isfinite(near)):
            raise InputError("near holds a number that is not finite, expected finite numbers")
    return Request(robot, analysis_of(robot, task), limits, near, method, most, seed)


class _Block:
    """The answers for a block of targets, as flat lists."""

    def __init__(self, request: Request, T: Array) -> None:
        robot, analysis = request.robot, request.analysis
        self.request, self.T = request, T
        self._nearest: dict[int, tuple[Array, float, float]] = {}
        found = nothing(robot.n)
        if request.method != "numeric":
            found = solve_block(analysis, T, request.own_limits, request.near, request.middle)
        found, inside = _limited(request, found)
        if request.method != "numeric" and analysis.solver is not None and analysis.redundancy:
            missing = np.flatnonzero((np.bincount(found.index[inside], minlength=len(T)) == 0) & ~self.beyond)
            if len(missing):
                more = solve_block(analysis, T[missing], request.own_limits, None, request.middle, more=True)
                found, inside = _limited(request, _with_more(found, more, missing))
        redundant = analysis.redundancy > 0 or analysis.solver is None
        if request.method == "numeric" or (request.method == "auto" and redundant):
            answered = (np.bincount(found.index[inside], minlength=len(T)) > 0) | self.beyond
            missing = np.flatnonzero(~self.beyond if request.method == "numeric" else ~answered)
            if len(missing):
                more = numeric_solutions(analysis, T[missing], request.own_limits, request.middle, request.seed)
                more = distinct(more, robot.revolute, analysis.size)
                found, inside = _limited(request, _with_more(found, more, missing))
        self.closing = np.bincount(found.index, minlength=len(T))
        if request.limits:
            found, inside = found.pick(inside), inside[inside]
        listed = np.bincount(found.index, minlength=len(T))
        self.found, self.inside = _ordered(request, found, inside)
        self.count = np.bincount(self.found.index, minlength=len(T))
        self.cut = listed > self.count

    @cached_property
    def names(self) -> list[str]:
        """The branch of each configuration."""
        return branch_names(self.request.robot, self.found.q)

    @cached_property
    def free(self) -> list[tuple[int, ...]]:
        """The joints of each configuration that may trade motion with each other."""
        analysis, q = self.request.analysis, self.found.q
        return free_at(analysis, q) if len(q) else []

    @cached_property
    def beyond(self) -> NDArray[np.bool_]:
        """Which targets are farther off than the arm is long."""
        return beyond_reach(self.request.analysis, self.T, self.request.own_limits)

    def nearest(self, i: int) -> tuple[Array, float, float]:
        """The configuration (n,) closest to target i, which has no solution, and its distance [m] and angle [rad].

        Together they take less time each: with it those to the next targets without a solution are found,
        of the same kind, as often only one kind is asked for.
        """
        if i not in self._nearest:
            alike = (self.count == 0) & ((self.closing > 0) == (self.closing[i] > 0))
            rows = i + np.flatnonzero(alike[i:])[:TOGETHER]
            request = self.request
            found = nearest_configurations(
                request.analysis, self.T[rows], request.own_limits, request.middle, request.seed
            )
            for row, q, position, angle in zip(rows.tolist(), *found, strict=True):
                self._nearest[row] = q, float(position), float(angle)
        return self._nearest[i]


def _with_more(found: Found, more: Found, missing: NDArray[np.intp]) -> Found:
    """All configurations, sorted by target; more's targets are numbered as in `missing`."""
    both = merged(found, Found(missing[more.index], more.q, more.position, more.angle))
    return both.pick(np.argsort(both.index, kind="stable"))


def _limited(request: Request, found: Found) -> tuple[Found, NDArray[np.bool_]]:
    """Angles turned into the limits, and which configurations are within them."""
    robot = request.robot
    q, inside = within_limits(found.q, robot.revolute, robot.limits, request.near)
    return Found(found.index, q, found.position, found.angle), inside


def _ordered(request: Request, found: Found, inside: NDArray[np.bool_]) -> tuple[Found, NDArray[np.bool_]]:
    """By target, then by the move from `near` if there is one, and cut to the number asked for.

    Of infinitely many some well spread ones; without `near` each is the farthest from those before it.
    """
    analysis, revolute = request.analysis, request.robot.revolute
    if not len(found):
        return found, inside
    scale = np.where(revolute, 1.0, analysis.size)
    if analysis.redundancy or analysis.solver is None:
        move = np.max(np.abs(found.q - request.middle) / scale, axis=1)
        most = MOST if request.most is None else request.most
        chosen = well_spread(found.index, wrapped(found.q, revolute) / scale, revolute, move, inside, most)
        found, inside = found.pick(chosen), inside[chosen]
    if request.near is not None:
        move = np.max(np.abs(found.q - request.near) / scale, axis=1)
        order = np.lexsort((move, found.index))
        found, inside = found.pick(order), inside[order]
    if request.most is None:
        return found, inside
    rank = np.arange(len(found)) - np.searchsorted(found.index, found.index)
    keep = rank < request.most
    return found.pick(keep), inside[keep]


def _batch(request: Request, answers: list[_Block]) -> BatchResult:
    n = request.robot.n
    counts = np.concatenate([block.count for block in answers]) if answers else np.zeros(0, dtype=np.intp)
    most = int(counts.max(initial=0))
    q = np.full((len(counts), most, n), np.nan)
    position, angle = np.full((len(counts), most), np.nan), np.full((len(counts), most), np.nan)
    inside = np.zeros((len(counts), most), dtype=bool)
    start = 0
    for block in answers:
        found, end = block.found, start + len(block.T)
        if np.all(block.count == most):
            shape = (len(block.T), most)
            q[start:end] = found.q.T.reshape(n, *shape).transpose(1, 2, 0)
            position[start:end], angle[start:end] = found.position.reshape(shape), found.angle.reshape(shape)
            inside[start:end] = block.inside.reshape(shape)
        else:
            place = np.arange(len(found)) - np.repeat(np.cumsum(block.count) - block.count, block.count)
            row = found.index + start
            q[row, place], position[row, place], angle[row, place] = found.q, found.position, found.angle
            inside[row, place] = block.inside
        start = end

    def single(i: int) -> Result:
        block = answers[i // BLOCK]
        return _result(request, block, i % BLOCK)

    def reason(i: int) -> str | None:
        block, k = answers[i // BLOCK], i % BLOCK
        # That the limits are in the way, or the target far off, is known without a search for what is nearest.
        if block.closing[k] and not block.count[k]:
            return OUTSIDE
        return FAR if block.beyond[k] else single(i).reason

    def branches() -> list[str]:
        return [name for block in answers for name in block.names]

    analysis = request.analysis
    method = "numeric" if request.method == "numeric" else analysis.method
    complete = analysis.complete and not analysis.idle and request.method != "numeric"
    return BatchResult(q, counts, position, angle, inside, complete, method, single, branches, reason)


def _result(request: Request, block: _Block, i: int) -> Result:
    """The answer for target i of a block: names, self-motions, reasons."""
    analysis, found = request.analysis, block.found
    rows = slice(np.searchsorted(found.index, i), np.searchsorted(found.index, i, side="right"))
    q, position, angle = found.q[rows], found.position[rows].tolist(), found.angle[rows].tolist()
    names, inside, free = block.names[rows], block.inside[rows].tolist(), block.free[rows]
    solutions = tuple(map(Solution, q, names, inside, position, angle, free))
    method = "numeric" if request.method == "numeric" else analysis.method
    complete = analysis.complete and request.method != "numeric" and not block.cut[i]
    idle = {i + 1 for i in analysis.idle}
    families = complete and all(idle.issuperset(solution.free) for solution in solutions)
    complete = complete and not any(solution.free for solution in solutions)
    counts = {"closing": int(block.closing[i]), "listed": len(solutions)}
    if solutions:
        return Result(solutions, complete, method, counts=counts, families=families)
    reason, nearest = _why_not(request, block, i)
    return Result((), complete, method, reason, nearest, counts)


def _why_not(request: Request, block: _Block, i: int) -> tuple[str, Solution]:
    """Why a target has no solution, and the configuration that comes nearest."""
    robot, analysis = request.robot, request.analysis
    q, position, angle = block.nearest(i)
    q, inside = within_limits(wrapped(q[None], robot.revolute), robot.revolute, robot.limits, request.near)
    if analysis.open:
        # What the task leaves open is no error: all of the orientation, or the turn about the tool's z axis.
        z, wish = forward_kinematics(robot, q[0])[:3, 2], block.T[i, :3, 2]
        angle = float(2.0 * np.arcsin(np.minimum(np.linalg.norm(z - wish) / 2.0, 1.0))) if analysis.open == 1 else 0.0
    nearest = Solution(q[0], branch_names(robot, q)[0], bool(inside[0]), position, angle)
    if block.closing[i]:
        return OUTSIDE, nearest
    if not analysis.complete and analysis.solver is None and not block.beyond[i]:
        return "none found, which proves nothing: outside the solver's guarantee", nearest
    if analysis.open < 3 and position <= REACHED * analysis.size:
        return "orientation not attainable by this arm at that position", nearest
    return FAR, nearest
