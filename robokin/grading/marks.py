"""Answers marked from Python: a pose, a configuration, a set of solutions, a table, as `robokin check` marks them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import cast

import numpy as np
from numpy.typing import ArrayLike

from robokin.arrays import Array
from robokin.brief import Brief
from robokin.errors import InputError
from robokin.expected import expect_choice, expect_finite, expect_flag, expect_kind
from robokin.grading.configuration_marks import Reached, SetMark, mark_set, reached
from robokin.grading.pose_difference import PASS, pose_errors, pose_status
from robokin.grading.same_robot import OPEN, Comparison, compare_tables
from robokin.grading.tolerance import Tolerance, default_tolerance
from robokin.inverse.analysis import Task
from robokin.inverse.solve import TASKS, target_poses
from robokin.kinematics.forward import forward_kinematics
from robokin.model import Robot, expect_robot
from robokin.model.named_values import plain_joint_values


@dataclass(frozen=True, eq=False, repr=False)
class PoseMark(Brief):
    """The mark of a pose: `pass` or what is wrong, its errors [m, rad], and the right pose (4, 4) [m]."""

    status: str
    position: float
    angle: float
    expected: Array

    @property
    def right(self) -> bool:
        """Whether it passes."""
        return self.status == PASS


def check_pose(
    robot: Robot, q: ArrayLike, T: ArrayLike, tolerance: Tolerance | None = None, task: str = "pose"
) -> PoseMark:
    """The mark of a pose T: (4, 4) [m] that was answered for joint values q: (n,) [rad | m].

    Position and orientation are compared apart; with the task `position` the orientation does not count. By default
    the tolerance is that of `robokin check fk`. Raises InputError.
    """
    robot, allowed = expect_robot(robot), expect_tolerance(robot, tolerance)
    chosen = expect_choice(task, ("pose", "position"), "task")
    right = forward_kinematics(robot, expect_configuration(robot, q))
    position, angle = pose_errors(right, expect_target(T), chosen)
    return PoseMark(pose_status(position, angle, allowed, right), position, angle, right)


def check_configuration(
    robot: Robot,
    T: ArrayLike,
    q: ArrayLike,
    tolerance: Tolerance | None = None,
    task: Task = "pose",
    limits: bool = True,
) -> Reached:
    """The mark of joint values q: (n,) [rad | m] that were answered for a target T: (4, 4) [m].

    By default the tolerance is that of `robokin check ik`. Raises InputError.
    """
    robot, allowed, chosen = expect_robot(robot), expect_tolerance(robot, tolerance), _task(task)
    return reached(
        robot, expect_configuration(robot, q), expect_target(T), allowed, chosen, expect_flag(limits, "limits")
    )


def check_solutions(
    robot: Robot,
    T: ArrayLike,
    answers: Sequence[ArrayLike],
    tolerance: Tolerance | None = None,
    task: Task = "pose",
    limits: bool = True,
) -> SetMark:
    """The mark of configurations, answers: (k, n) [rad | m], as the set of all solutions for a target T: (4, 4) [m].

    By default the tolerance is that of `robokin check ik --all`. Raises InputError.
    """
    robot, allowed, chosen = expect_robot(robot), expect_tolerance(robot, tolerance), _task(task)
    rows = expect_kind(answers, (list, tuple, np.ndarray), "answers", "a list of configurations (n,)")
    if isinstance(rows, np.ndarray) and rows.ndim == 0:
        raise InputError("answers: found a single number, expected a list of configurations (n,)")
    given = [expect_configuration(robot, one) for one in rows]
    return mark_set(robot, given, expect_target(T), allowed, chosen, expect_flag(limits, "limits"))


def check_table(
    robot: Robot, given: Robot, tolerance: Tolerance | None = None, up_to: Iterable[str] = ()
) -> Comparison:
    """The mark of a table `given`: whether it is kinematically the same robot as `robot`.

    `up_to` says what may differ: some of base, tool, zero, sign. By default the tolerance is that of `robokin check
    dh`. Raises InputError.
    """
    right, other = expect_robot(robot), expect_robot(given, "given")
    allowed = expect_tolerance(right, tolerance, table=True)
    return compare_tables(right, other, allowed, expect_open(up_to))


def expect_tolerance(robot: Robot, tolerance: Tolerance | None, *, table: bool = False) -> Tolerance:
    """A tolerance, by default that for answers about the robot or its table. Raises InputTypeError."""
    if tolerance is None:
        return default_tolerance(robot, table=table)
    how = "a robokin.Tolerance, such as robokin.Tolerance(position=1e-3, angle=2e-3)"
    return cast(Tolerance, expect_kind(tolerance, Tolerance, "tolerance", how))


def expect_open(up_to: Iterable[str]) -> frozenset[str]:
    """What may differ between two tables: some of `OPEN`. Raises InputError."""
    names = expect_kind(up_to, (list, tuple, set, frozenset), "up_to", f"some of {', '.join(OPEN)}, such as ['base']")
    return frozenset(expect_choice(name, OPEN, "up_to") for name in names)


def _task(task: object) -> Task:
    return cast(Task, expect_choice(task, TASKS, "task"))


def expect_configuration(robot: Robot, q: ArrayLike) -> Array:
    """Joint values q: (n,) [rad | m]. Raises InputError, also for a robot without joints."""
    if not robot.n:
        raise InputError(f"{robot.name} has no joints, expected a robot that can move")
    return expect_finite(plain_joint_values(robot, q), "q", f"{robot.n} finite joint values", (robot.n,))


def expect_target(T: ArrayLike) -> Array:
    """One pose T: (4, 4) [m]. Raises InputError."""
    poses = target_poses(T)
    if poses.ndim != 2:
        raise InputError(f"T: found an array of shape {poses.shape}, expected one pose (4, 4)")
    return poses
