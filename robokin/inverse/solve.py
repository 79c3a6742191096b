"""`solve_ik`: every joint configuration that reaches a pose, each with its proof; why, when there is none."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from robokin.arrays import Array
from robokin.errors import InputError
from robokin.expected import described, expect_choice, expect_flag, expect_kind, expect_numbers, expect_whole
from robokin.inverse.analysis import Task, analysis_of
from robokin.inverse.answered_batch import answered_batch
from robokin.inverse.coupled_joints import solve_coupled
from robokin.inverse.full_turns import check_turns, with_full_turns, with_turn_counts
from robokin.inverse.hold import (
    HeldArm,
    arm_held_before,
    check_held_limits,
    held_arm,
    own_near,
    whole_answer,
    with_held_joints,
)
from robokin.inverse.later_fields import changed
from robokin.inverse.one_answer import OneAnswer
from robokin.inverse.one_target import KernelSolution, kernel_answer, plain_pose, solve_one
from robokin.inverse.one_target_arm import OneTargetArm, one_target_arm
from robokin.inverse.solutions import BatchResult, Question, Result
from robokin.inverse.swivel_block import SwivelSolution, one_swivel_arm, solve_swivel
from robokin.inverse.target_block import Method, Request
from robokin.inverse.unmade_result import UnmadeResult, question_later
from robokin.jobs.ordered_map import MOST_CORES
from robokin.jobs.shared_rows import by_threads
from robokin.kernel.native_kernel import native
from robokin.model import CoupledRobot, Robot, expect_robot
from robokin.model.named_values import plain_joint_values, plain_poses
from robokin.spatial.rigid_poses import rigid

METHODS = ("auto", "analytic", "numeric")
TASKS = ("pose", "approach", "position")

COPIED = 16_000
"""Targets that are copied and looked at together: a millisecond's work."""


def solve_ik(
    robot: Robot,
    T: ArrayLike,
    limits: bool = True,
    near: ArrayLike | None = None,
    method: Method = "auto",
    task: Task = "pose",
    most: int | None = None,
    seed: int = 0,
    turns: bool = False,
    hold: Mapping[int, float] | None = None,
    cores: int | None = 1,
) -> Result | BatchResult:
    """Every configuration that brings the tool to T.

    T: (4, 4) or (m, 4, 4) poses of the tool in the world [m]; of a rotation whose digits were cut in print (off by
    up to 1e-3, as 0.866 for √3/2) the nearest one is taken, without a word, and errors are measured from that.
    `limits` lists only what respects the joint
    limits (an angle ±360° counts as the same configuration and is tried). `near` (n,) [rad | m] orders by the
    greatest joint move from there; otherwise the order is fixed: by q1, then q2, … ; of an arm with infinitely
    many solutions well spread ones are listed, each the farthest from those before. `task` is the whole pose,
    the position with the z axis (`approach`), or the position alone. `most` cuts the list. `turns` also lists the
    ±360° equivalents of each solution within the limits. `hold` fixes joints (from 0) at values [rad | m]: the rest
    is solved as the arm that it then is, and `complete` is said of that. `cores` share a batch of many
    targets, all usable ones for None; the answers are the same.
    Returns a Result for one pose, a BatchResult for several. Raises InputError for what is no pose.
    Source: D. L. Pieper, The kinematics of manipulators under computer control, 1968 (three axes through a point, three
    parallel ones, three slides); M. Raghavan and B. Roth, Inverse kinematics of the general 6R manipulator and related
    linkages, J. Mech. Des. 115, 1993 (any other); A. P. Morgan and A. J. Sommese, Coefficient-parameter polynomial
    continuation, Appl. Math. Comput. 29, 1989 (that these are all).
    """
    if turns is False and type(cores) is int and cores == 1:
        one = _one_target(robot, T, limits, near, method, task, most, seed, hold)
        if one is not None:
            return one
    given = plain_poses(T, "T", robot, task) if isinstance(robot, Robot) else T
    cores = None if cores is None else expect_whole(cores, "cores", 1, MOST_CORES)
    poses = target_poses(given, cores=cores)
    alone = poses.ndim == 2
    targets = poses.reshape(-1, 4, 4)
    batch = solve_many(robot, targets, limits, near, method, task, most, seed, turns, hold, alone, cores, checked=True)
    batch = replace(batch, question=Question(robot, targets, task, bool(limits), dict(hold or {})))
    if not alone and _follows(robot, method, task, hold):
        asked: dict[str, Any] = {
            "limits": limits, "method": method, "task": task, "most": most, "seed": seed, "turns": turns,
            "near": None if near is None else np.array(near), "hold": dict(hold or {}) or None,
        }  # fmt: skip
        batch = replace(batch, alone=partial(_alone, robot, asked))
    return UnmadeResult(partial(_first, batch)) if alone else batch


def _one_target(
    robot: Robot,
    T: ArrayLike,
    limits: bool,
    near: ArrayLike | None,
    method: Method,
    task: Task,
    most: int | None,
    seed: int,
    hold: Mapping[int, float] | None,
) -> Result | None:
    """The answer for one pose where it can be had without the blocks; None where not, and for what is no question."""
    if not isinstance(robot, Robot) or type(limits) is not bool:
        return None
    if type(method) is not str or method not in ("auto", "analytic") or type(task) is not str or task != "pose":
        return None
    if type(seed) is not int or seed < 0 or not (most is None or (type(most) is int and most >= 1)):
        return None
    part = arm = None
    if near is None and hold is None:
        arm = one_target_arm(robot)
    elif near is None and type(hold) is dict and type(robot) is Robot:
        part = arm_held_before(robot, hold)
        arm = part.one if part is not None and (part.inside or not limits) else None
    if near is None and native is not None and arm is not None and arm.kernel is not None:
        # The kernel looks at the pose itself, and what the answer is made of is put together when it is looked at.
        told = native.solution(arm.kernel, T, limits, None, arm.elimination)
        if told is None:
            return None
        return UnmadeResult(
            partial(_told, robot, part, arm, told, limits, most, hold and (*hold.items(),), method, seed)
        )
    if near is None and hold is None:
        return _without_kernel(robot, arm, T, limits, most, method, seed)
    if not plain_pose(T) or isinstance(robot, CoupledRobot) or not (hold is None or isinstance(hold, Mapping)):
        return None
    wish = near = _wished(robot, near)
    part = None
    if hold:
        part = held_arm(robot, hold)
        if limits:
            check_held_limits(robot, part)
        wish = own_near(part, wish)
    arm = one_target_arm(robot) if part is None else part.one
    answer = None if arm is None else solve_one(arm, T, limits, most, wish)
    if answer is None:
        return None
    return UnmadeResult(partial(_made, robot, part, answer, dict(hold or {}), method, seed, near))


def _without_kernel(
    robot: Robot, arm: OneTargetArm | None, T: ArrayLike, limits: bool, most: int | None, method: Method, seed: int
) -> Result | None:
    """The same where the native kernel has no closed form: by Python's code, or by intervals of the swivel angle."""
    if not plain_pose(T):
        return None
    assert isinstance(T, np.ndarray)
    if arm is not None:
        answer = solve_one(arm, T, limits, most)
        return None if answer is None else UnmadeResult(partial(_made, robot, None, answer, {}, method, seed))
    swivel = one_swivel_arm(robot) if limits else None
    known = None if swivel is None else solve_swivel(swivel, T, most)
    return None if known is None else UnmadeResult(partial(_made_of_motions, known, method, most, seed))


def _told(
    robot: Robot,
    part: HeldArm | None,
    arm: OneTargetArm,
    told: KernelSolution,
    limits: bool,
    most: int | None,
    hold: tuple[tuple[int, float], ...] | None,
    method: Method,
    seed: int,
) -> dict[str, Any]:
    """The fields of the native kernel's answer, when it is looked at."""
    return _made(robot, part, kernel_answer(arm, told, limits, most, None), dict(hold or ()), method, seed)


def _made(
    robot: Robot,
    part: HeldArm | None,
    answer: OneAnswer,
    hold: dict[int, float],
    method: Method,
    seed: int,
    near: Array | None = None,
) -> dict[str, Any]:
    """The fields of an answer, when it is looked at."""
    question = question_later(robot, answer.T, answer.limits, hold)
    if answer.reached:
        return answer.told(question) if part is None else whole_answer(robot, part, answer, question)
    rest: dict[str, Any] = {"most": answer.most, "seed": seed, "hold": hold or None, "motions": True}
    blocks = partial(solve_many, robot, answer.T, answer.limits, near, method, **rest)
    return vars(answer.unreached(question, lambda: blocks()[0]))


def _made_of_motions(known: SwivelSolution, method: Method, most: int | None, seed: int) -> dict[str, Any]:
    """The fields of an answer with self-motions, when it is looked at."""
    robot, T = known.known.robot, known.T
    question = Question(robot, T, "pose", True, {})
    result = known.result(question)
    if result is None:
        batch = solve_many(robot, T[None], True, None, method, "pose", most, seed, motions=True)
        result = changed(batch[0], question=question)
    return vars(result)


def _first(batch: BatchResult) -> dict[str, Any]:
    """The fields of the answer for a batch's only target."""
    return vars(batch[0])


def _alone(robot: Robot, arguments: dict[str, Any], T: Array) -> Result:
    """The answer for one target T (4, 4) [m] of a batch, with its self-motions."""
    answer: Result = solve_many(robot, T[None], motions=True, **arguments)[0]
    return answer


def _follows(robot: Robot, method: Method, task: Task, hold: Mapping[int, float] | None) -> bool:
    """Whether the self-motions of an arm are looked for only when they are asked for: those of one joint to spare."""
    arm = held_arm(robot, hold).part if hold else robot
    if isinstance(arm, CoupledRobot):
        arm = arm.free_motion
    return method != "numeric" and arm.n > 0 and analysis_of(arm, task).redundancy == 1


def solve_many(
    robot: Robot,
    T: ArrayLike,
    limits: bool = True,
    near: ArrayLike | None = None,
    method: Method = "auto",
    task: Task = "pose",
    most: int | None = None,
    seed: int = 0,
    turns: bool = False,
    hold: Mapping[int, float] | None = None,
    motions: bool = False,
    cores: int | None = 1,
    checked: bool = False,
    pattern: Array | None = None,
) -> BatchResult:
    """`solve_ik` for poses T: (m, 4, 4), whatever their number; `checked` are as `target_poses` gives them.

    With `motions` the self-motions of arms with one joint to spare are followed too, as `solve_ik` does for one pose:
    that takes a tenth of a second each. Those of singular poses always are. `pattern` (see `Request`) is not for turns.
    """
    robot = expect_robot(robot)
    near = _wished(robot, near)
    expect_choice(method, METHODS, "method")
    expect_choice(task, TASKS, "task")
    limits, turns = expect_flag(limits, "limits"), expect_flag(turns, "turns")
    most = None if most is None else expect_whole(most, "most", 1)
    seed = expect_whole(seed, "seed", 0)
    cores = None if cores is None else expect_whole(cores, "cores", 1, MOST_CORES)
    if hold is not None:
        expect_kind(hold, Mapping, "hold", "a mapping of joints (from 0) to values, such as {2: 0.35}")
    if isinstance(robot, CoupledRobot) and not hold:

        def free(arm: Robot, T: Array, bounded: bool, listed: int | None) -> BatchResult:
            wish = None if near is None else robot.drive.motions(near)
            return solve_many(arm, T, bounded, wish, method, task, listed, seed, False, None, motions, cores)

        poses = _checked(T, checked)
        return solve_coupled(robot, poses, free, task, most, seed, limits, near, turns)
    if hold:
        arm = held_arm(robot, hold)
        if limits:
            check_held_limits(robot, arm)
        own = own_near(arm, near)
        asked = limits, own, method, task, most, seed, turns, None, motions, cores, checked
        batch = solve_many(arm.part, T, *asked, pattern=None if turns else arm.pattern)
        return with_held_joints(robot, arm, batch, cores)
    if turns:
        check_turns(robot, limits)
    poses = _checked(T, checked)
    request = replace(_request(robot, limits, near, method, task, most, seed), motions=motions, pattern=pattern)
    if turns and not (request.analysis.redundancy or request.analysis.solver is None):
        request = replace(request, most=None)  # what is cut is the list with the full turns in it
    batch = answered_batch(request, poses, cores)
    if turns:
        return with_full_turns(robot, batch, poses, task, near, request.analysis.size, most)
    return with_turn_counts(robot, batch) if limits else batch


def _checked(T: ArrayLike, checked: bool) -> Array:
    """Targets as an array (m, 4, 4) [m]."""
    poses = T if checked and isinstance(T, np.ndarray) else target_poses(T)
    return poses.reshape(-1, 4, 4)


def target_poses(T: ArrayLike, argument: str = "T", cores: int | None = 1) -> Array:
    """Targets (4, 4) or (m, 4, 4) [m] as an array, each with the rotation that is nearest to the given one.

    Rotations may be off by `DIGITS_LOST`: a matrix copied from print has three or four digits. `cores` share many.
    Raises InputError for what are no rigid transforms, saying how far off.
    """
    given = expect_numbers(plain_poses(T, argument), argument, "an array of numbers (4, 4) or (m, 4, 4)")
    if given.ndim not in (2, 3) or given.shape[-2:] != (4, 4):
        found = described(given) if given.ndim else "a single number"
        raise InputError(f"{argument}: found {found}, expected a pose (4, 4) or poses (m, 4, 4)")
    plain = []

    def copied(rows: Array, poses: Array) -> None:
        poses[:] = rows.reshape(poses.shape)
        plain.append(native is not None and native.rigid(poses))

    poses = by_threads(copied, given.reshape(-1, 16), (4, 4), COPIED, cores).reshape(given.shape)
    return poses if all(plain) else rigid(poses, argument)


def _wished(robot: Robot, near: ArrayLike | None) -> Array | None:
    """The joint values `near` (n,), checked."""
    if near is None:
        return None
    near = np.array(expect_numbers(plain_joint_values(robot, near, "near"), "near", f"{robot.n} joint values"))
    if near.shape != (robot.n,):
        raise InputError(
            f"near: found {described(near)}, expected {robot.n} values, one for each joint of {robot.name}"
        )
    if not np.all(np.isfinite(near)):
        raise InputError("near: found a number that is not finite, expected finite numbers")
    return near


def _request(
    robot: Robot, limits: bool, near: Array | None, method: Method, task: Task, most: int | None, seed: int
) -> Request:
    if robot.n == 0:
        raise InputError(f"{robot.name} has no joints, expected a robot that can move")
    return Request(robot, analysis_of(robot, task), limits, near, method, most, seed)
