"""Known mistakes in answers: the numbers read as they may have been meant, and compared again."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from robokin.arrays import Array
from robokin.grading import mistakes
from robokin.grading.answers.answered_poses import AnsweredPose, pose_from
from robokin.grading.configuration_marks import mark_set, reached
from robokin.grading.marking import NoAnswerError, Subject
from robokin.grading.mistakes import Mistake
from robokin.grading.pose_difference import PASS, pose_errors, pose_status
from robokin.grading.tolerance import Tolerance
from robokin.inverse.analysis import Task
from robokin.inverse.solutions import Result
from robokin.kinematics.forward import forward_kinematics
from robokin.model import Robot
from robokin.spatial import rotation_from_axis_angle, transform
from robokin.units import Units

ANGLES = {"rpy": True, "euler": True, "planar": True}
"""Kinds of poses whose numbers have angles among them."""


def pose_mistake(subject: Subject, q: Array, answer: AnsweredPose) -> Mistake | None:
    """The known mistake in a wrong pose for q: (n,) [rad | m], or None."""
    robot, units, allowed = subject.robot, subject.units, subject.allowed
    right = forward_kinematics(robot, q)
    # What is off by a little is in no other unit: that its digits were meant for one is then no excuse.
    near = _is(right, answer.T, answer.task, mistakes.loosened(allowed))
    for mistake, T, tolerance in _poses_meant(subject, answer):
        if not (near and tolerance is not allowed) and _is(right, T, answer.task, tolerance):
            return mistake
    for mistake, other in mistakes.robot_readings(robot):
        if _is(forward_kinematics(other, q), answer.T, answer.task, allowed):
            return mistake
    taken = mistakes.joint_readings(robot, q, units, single=False)
    poses = forward_kinematics(robot, np.array([values for _, values in taken]).reshape(-1, robot.n))
    return next(
        (mistake for (mistake, _), T in zip(taken, poses, strict=True) if _is(T, answer.T, answer.task, allowed)), None
    )


def _is(right: Array, T: Array, task: str, allowed: Tolerance) -> bool:
    return pose_status(*pose_errors(right, T, task), allowed, right) == PASS


def _poses_meant(subject: Subject, answer: AnsweredPose) -> Iterator[tuple[Mistake, Array, Tolerance]]:
    """What a pose may have been meant as (4, 4) [m], each with what it may be off by."""
    robot, units, allowed = subject.robot, subject.units, subject.allowed
    values, kind = answer.values, answer.kind
    if values is not None:
        angles = ANGLES.get(kind, False) and len(values) != 2
        for mistake, meant in mistakes.unit_readings(units, lengths=True, angles=angles):
            T = _again(values, kind, robot, meant)
            # The same numbers are near the origin in any unit.
            near = mistakes.SURE * max(allowed.position, np.finfo(float).tiny)
            if T is None or (meant.length != units.length and np.linalg.norm(T[:3, 3]) < near):
                continue
            yield mistake, T, mistakes.loosened(allowed)
        if kind == "rpy":
            T = _again(np.concatenate([values[:3], values[:2:-1]]), kind, robot, units)
            if T is not None:
                yield Mistake(mistakes.ROLL_YAW, "right with roll and yaw exchanged"), T, allowed
            x, y, z = (
                rotation_from_axis_angle(axis, angle * units.radians)
                for axis, angle in zip(np.eye(3), values[3:].tolist(), strict=True)
            )
            said = "right if the rotations multiply in the other order, expected Rz(yaw) Ry(pitch) Rx(roll)"
            yield Mistake(mistakes.ROTATION_ORDER, said), transform(x @ y @ z, answer.T[:3, 3]), allowed
        if kind == "quaternion":
            T = _again(np.concatenate([values[:3], values[6:], values[3:6]]), kind, robot, units)
            if T is not None:
                yield Mistake(mistakes.QUATERNION_ORDER, "right if w stands last, expected it first"), T, allowed
    if answer.task == "pose":
        for mistake, T in mistakes.rotation_readings(answer.T):
            yield mistake, T, allowed


def _again(values: Array, kind: str, robot: Robot, units: Units) -> Array | None:
    """The pose that numbers say in other units, if any."""
    try:
        return pose_from(values, kind, robot, units).T
    except NoAnswerError:
        return None


def joints_mistake(subject: Subject, q: Array, T: Array, task: Task, limits: bool) -> Mistake | None:
    """The known mistake in joint values q: (n,) [rad | m] that do not solve a task, or None."""
    wide = mistakes.loosened(subject.allowed)
    near = reached(subject.robot, q, T, wide, task, limits).right
    meant = _joints_meant(subject, q)
    for k in _arriving(subject.robot, [values for _, values in meant], T, wide):
        mistake, values = meant[k]
        if not _told(subject, mistake, values):
            continue
        allowed = wide if mistake.name in UNITS and not near else subject.allowed
        if reached(subject.robot, values, T, allowed, task, limits).right:
            return mistake
    return None


UNITS = (mistakes.ANGLE_UNIT, mistakes.LENGTH_UNIT)
"""Mistakes whose digits were meant for another unit."""


def _joints_meant(subject: Subject, q: Array) -> list[tuple[Mistake, Array]]:
    """What joint values q (n,) [rad | m] may have been meant as, in the same order for each q: (n,) [rad | m] each."""
    robot, units = subject.robot, subject.units
    sliding = ~robot.revolute
    lengths = mistakes.unit_readings(units, lengths=bool(sliding.any()), angles=False)
    return mistakes.joint_readings(robot, q, units, single=True) + [
        (mistake, np.where(sliding, q * (other.metres / units.metres), q)) for mistake, other in lengths
    ]


def _told(subject: Subject, mistake: Mistake, values: Array) -> bool:
    """Whether a reading is another one: a slide near zero is there in any unit."""
    if mistake.name != mistakes.LENGTH_UNIT:
        return True
    return bool(np.max(np.abs(values[~subject.robot.revolute])) > mistakes.SURE * subject.allowed.position)


def _arriving(robot: Robot, readings: Sequence[Array], T: Array, wide: Tolerance) -> list[int]:
    """Which readings (n,) [rad | m] lead to a target's place, all looked at at once: few are worth more than that."""
    poses = forward_kinematics(robot, np.array(readings).reshape(-1, robot.n))
    near: list[int] = np.flatnonzero(np.linalg.norm(poses[:, :3, 3] - T[:3, 3], axis=1) <= _reach(wide, T)).tolist()
    return near


def _reach(allowed: Tolerance, T: Array) -> float:
    """A distance [m] from a target that no answer within the tolerance has."""
    return 1.01 * (allowed.position + allowed.relative * float(np.linalg.norm(T[:3, 3]))) + 1e-9 * allowed.size


def set_mistake(
    subject: Subject, given: list[Array], T: Array, task: Task, limits: bool, known: Result
) -> Mistake | None:
    """The known mistake in configurations, each (n,) [rad | m], none of which solves a task: the same one in all."""
    robot, wide = subject.robot, mistakes.loosened(subject.allowed)
    if not given:
        return None
    near = any(reached(robot, q, T, wide, task, limits).right for q in given)
    meant = [_joints_meant(subject, q) for q in given]
    for k in _arriving(robot, [values for _, values in meant[0]], T, wide):
        mistake, again = meant[0][k][0], [readings[k][1] for readings in meant]
        if not all(_told(subject, mistake, values) for values in again):
            continue
        if near and mistake.name in UNITS:
            continue
        allowed = wide if mistake.name in UNITS else subject.allowed
        if mark_set(robot, again, T, allowed, task, limits, known).status == PASS:
            return mistake
    return None
