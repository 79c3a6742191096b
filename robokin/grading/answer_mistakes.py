"""Known mistakes in answers: the numbers read as they may have been meant, and compared again."""

from __future__ import annotations

from collections.abc import Iterator

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
    robot, units, allowed = subject.robot, subject.units, subject.allowed
    meant = mistakes.joint_readings(robot, q, units, single=True)
    sliding = ~robot.revolute
    for mistake, other in mistakes.unit_readings(units, lengths=bool(sliding.any()), angles=False):
        values = np.where(sliding, q * (other.metres / units.metres), q)
        # A slide near zero is there in any unit.
        if np.max(np.abs(values[sliding])) > mistakes.SURE * allowed.position:
            meant.append((mistake, values))
    # Where they lead, all at once: few are worth more than a look.
    poses = forward_kinematics(robot, np.array([values for _, values in meant]).reshape(-1, robot.n))
    wide = mistakes.loosened(allowed)
    near = reached(robot, q, T, wide, task, limits).right
    for k in np.flatnonzero(np.linalg.norm(poses[:, :3, 3] - T[:3, 3], axis=1) <= _reach(wide, T)).tolist():
        mistake, values = meant[k]
        unit = mistake.name in (mistakes.ANGLE_UNIT, mistakes.LENGTH_UNIT)
        if reached(robot, values, T, wide if unit and not near else allowed, task, limits).right:
            return mistake
    return None


def _reach(allowed: Tolerance, T: Array) -> float:
    """A distance [m] from a target that no answer within the tolerance has."""
    return 1.01 * (allowed.position + allowed.relative * float(np.linalg.norm(T[:3, 3]))) + 1e-9 * allowed.size


def set_mistake(
    subject: Subject, given: list[Array], T: Array, task: Task, limits: bool, known: Result
) -> Mistake | None:
    """The known mistake in configurations, each (n,) [rad | m], none of which solves a task: the other angle unit."""
    robot, wide, turning = subject.robot, mistakes.loosened(subject.allowed), subject.robot.revolute
    if not turning.any() or any(reached(robot, q, T, wide, task, limits).right for q in given):
        return None
    ((mistake, meant),) = mistakes.unit_readings(subject.units, lengths=False, angles=True)
    again = [np.where(turning, q * (meant.radians / subject.units.radians), q) for q in given]
    return mistake if mark_set(robot, again, T, wide, task, limits, known).status == PASS else None
