"""Poses that were answered or asked for, from numbers and from the columns of a file."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from robokin.arrays import Array
from robokin.errors import InputError
from robokin.grading.answers.answer_files import AnswerFile, Row
from robokin.grading.mark_items import NO_POSE, NO_ROTATION
from robokin.grading.marking import NoAnswerError
from robokin.kinematics.flat_arm import flat_arm, planar_pose, upright_tool
from robokin.kinematics.structure import structure_of
from robokin.model import Robot
from robokin.spatial import nearest_rotation, rotation_error, rotation_from_quaternion, transform
from robokin.spatial.rotations import DIGITS_LOST
from robokin.tables.near_targets import near_enough
from robokin.tables.orientations import MATRIX, ORIENTATIONS, pose_columns
from robokin.tables.pose_columns import CLEAN, ORDER
from robokin.units import Units

QUATERNION_CUT = 0.02
"""A quaternion of two decimals is this near to length one."""


@dataclass(frozen=True, eq=False)
class AnsweredPose:
    """A pose (4, 4) [m], whose upper left part may be no exact rotation, and what of it counts: pose or position.

    values: the numbers (k,) that it was read from, in the units, and `kind` what they are; none of an expression.
    """

    T: Array
    task: str
    values: Array | None = None
    kind: str = "expression"

    def as_target(self, line: int | None = None) -> AnsweredPose:
        """It as a question: with an exact rotation. Raises NoAnswerError, which names the line, where it has none."""
        R = self.T[:3, :3]
        off = float(rotation_error(R))
        if not off <= DIGITS_LOST:
            place = f"line {line}: " if line is not None else ""
            raise NoAnswerError(NO_ROTATION, f"{place}found a matrix that is off by {off:.2g}, expected a rotation")
        return replace(self, T=transform(nearest_rotation(R) if off > CLEAN else R, self.T[:3, 3]))


@dataclass(frozen=True)
class PoseReader:
    """Reads poses from the columns of a sheet: rpy, quaternion, euler, matrix, position, or planar."""

    kind: str
    names: tuple[str, ...]
    robot: Robot
    units: Units

    def read(self, row: Row) -> AnsweredPose:
        """The pose of a row. Raises NoAnswerError."""
        turns = self.kind == "planar" or (self.kind in ORIENTATIONS and ORIENTATIONS[self.kind].angles)
        angles = [turns and name not in ("x", "y", "z") for name in self.names]
        return pose_from(row.numbers(self.names, angles, self.units), self.kind, self.robot, self.units)

    def target(self, row: Row, line: int | None = None) -> AnsweredPose:
        """The pose of a row as a question. Raises NoAnswerError, which names a line."""
        return self.read(row).as_target(line)

    def cells(self, row: Row) -> dict[str, str]:
        """What stands in a row where the pose is read."""
        return {name: row.cells[name] for name in self.names}


def pose_reader(sheet: AnswerFile, robot: Robot, units: Units) -> PoseReader | None:
    """What reads the poses of a sheet; None where it has no columns of any."""
    have = set(sheet.columns)
    for kind in ORDER:
        names = MATRIX if kind == "matrix" else pose_columns(kind)
        if have.issuperset(names):
            return PoseReader(kind, tuple(names), robot, units)
    half = [name for kind in ("rpy", "quaternion", "euler", "rotvec") for name in ORIENTATIONS[kind].columns]
    half += MATRIX
    planar = structure_of(robot).arm == "planar"
    found = [name for name in half if name in have and not (name == "phi" and planar)]
    if found:
        raise InputError(
            f"{sheet.name}: found the column {found[0]} without the others of its pose, expected all of them"
        )
    if have.issuperset("xyz"):
        return PoseReader("position", ("x", "y", "z"), robot, units)
    if planar and have.issuperset("xy"):
        return PoseReader("planar", ("x", "y", "phi") if "phi" in have else ("x", "y"), robot, units)
    return None


def needed_poses(sheet: AnswerFile, robot: Robot, units: Units, what: str, more: str = "") -> PoseReader:
    """What reads the poses of a sheet. Raises InputError where it has no columns of any; `what` they would be."""
    reader = pose_reader(sheet, robot, units)
    if reader is None:
        raise InputError(f"{sheet.name}: found no columns of {what}, expected x, y, z, roll, pitch, yaw{more}")
    return reader


def pose_from(values: Array, kind: str, robot: Robot, units: Units) -> AnsweredPose:
    """A pose from numbers (k,) in the units. Raises NoAnswerError for what is none."""
    if kind == "planar":
        T = _planar(values, robot, units)
        return AnsweredPose(T, "pose" if len(values) > 2 else "position", values, kind)
    if kind == "matrix":
        M = values.reshape(-1, 4)
        M = M if len(M) == 4 else np.vstack([M, [0.0, 0.0, 0.0, 1.0]])
        if np.max(np.abs(M[3] - [0.0, 0.0, 0.0, 1.0])) > 1e-9:
            raise NoAnswerError(NO_POSE, f"found the last row {' '.join(f'{v:g}' for v in M[3])}, expected 0 0 0 1")
        R, p = M[:3, :3], M[:3, 3]
    else:
        R, p = _rotation(values[3:], kind, units), values[:3]
    return AnsweredPose(transform(R, p * units.metres), "position" if kind == "position" else "pose", values, kind)


def _rotation(values: Array, kind: str, units: Units) -> Array:
    if kind == "position":
        return np.eye(3)
    if kind != "quaternion":
        return ORIENTATIONS[kind].rotation(values * units.radians)
    length = float(np.linalg.norm(values))
    if abs(length - 1.0) > QUATERNION_CUT:
        raise NoAnswerError(NO_ROTATION, f"found a quaternion of length {length:.6g}, expected 1")
    return rotation_from_quaternion(values)


def _planar(values: Array, robot: Robot, units: Units) -> Array:
    """The pose (4, 4) [m] that x, y, or x, y, phi of a planar arm say. Raises NoAnswerError."""
    zero = flat_arm(robot)
    if zero is None:
        said = f"--xy: {robot.name} does not move in the plane of x and y, expected --xyz"
        raise NoAnswerError(NO_ROTATION, said)
    if len(values) > 2 and upright_tool(zero):
        said = f"--phi: the x axis of {robot.name}'s tool frame is upright, expected --xyz and --rpy"
        raise NoAnswerError(NO_ROTATION, said)
    phi = float(values[2]) * units.radians if len(values) > 2 else None
    try:
        return near_enough(planar_pose(zero, values[:2] * units.metres, phi), units)
    except ValueError as error:
        raise NoAnswerError(NO_ROTATION, f"--xy: {error}") from None
