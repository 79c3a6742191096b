"""Poses that were answered or asked for: from columns of a file or from one argument."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from robokin.arrays import Array
from robokin.cli.arguments import split_vector
from robokin.cli.check_rows import BLANK, AnswerFile, NoAnswerError, Row, number
from robokin.cli.output.numbers import counted
from robokin.cli.targets import parse_target
from robokin.errors import ExpressionError, InputError, shown
from robokin.formats.number_expressions import Scope
from robokin.formats.transform_expressions import STEPS, evaluate_transform
from robokin.kinematics.structure import structure_of
from robokin.model import Robot
from robokin.spatial import (
    rotation_error,
    rotation_from_quaternion,
    rpy_from_rotation,
    transform,
)
from robokin.tables.orientations import MATRIX, ORIENTATIONS, pose_columns
from robokin.tables.pose_columns import ORDER
from robokin.units import Units

NO_ROTATION = "not a rotation"

QUATERNION_CUT = 0.02
"""A quaternion of two decimals is this near to length one."""

MATRIX_CUT = 0.05
"""A matrix of two decimals is this near to a rotation; what is farther is shown as it stands."""

CALL = re.compile(r"\s*([A-Za-z]+)\s*\(")


@dataclass(frozen=True, eq=False)
class AnsweredPose:
    """A pose (4, 4) [m], whose upper left part may be no exact rotation, and what of it counts: pose or position.

    values: the numbers (k,) that it was read from, in the units, and `kind` what they are; none of an expression.
    """

    T: Array
    task: str
    values: Array | None = None
    kind: str = "expression"


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

    def key(self, row: Row) -> tuple[str, ...]:
        """What tells two targets apart."""
        return tuple(row.cells[name] for name in self.names)


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


def pose_from(values: Array, kind: str, robot: Robot, units: Units) -> AnsweredPose:
    """A pose from numbers in the units. Raises NoAnswerError for what is none."""
    T, task = _pose_and_task(values, kind, robot, units)
    return AnsweredPose(T, task, values, kind)


def _pose_and_task(values: Array, kind: str, robot: Robot, units: Units) -> tuple[Array, str]:
    if kind == "planar":
        texts = [repr(float(value)) for value in values]
        options = {"--xy": ",".join(texts[:2]), "--phi": texts[2] if len(texts) > 2 else None}
        try:
            target = parse_target(options, robot, units)
        except InputError as error:
            raise NoAnswerError(NO_ROTATION, str(error)) from None
        return target.T, target.task
    if kind == "matrix":
        M = values.reshape(-1, 4)
        M = M if len(M) == 4 else np.vstack([M, [0.0, 0.0, 0.0, 1.0]])
        if np.max(np.abs(M[3] - [0.0, 0.0, 0.0, 1.0])) > 1e-9:
            raise NoAnswerError(
                "not a pose", f"found the last row {' '.join(f'{v:g}' for v in M[3])}, expected 0 0 0 1"
            )
        return transform(M[:3, :3], M[:3, 3] * units.metres), "pose"
    p = values[:3] * units.metres
    if kind == "position":
        return transform(np.eye(3), p), "position"
    if kind == "quaternion":
        length = float(np.linalg.norm(values[3:]))
        if abs(length - 1.0) > QUATERNION_CUT:
            raise NoAnswerError(NO_ROTATION, f"found a quaternion of length {length:.6g}, expected 1")
        return transform(rotation_from_quaternion(values[3:]), p), "pose"
    R = ORIENTATIONS[kind].rotation(values[3:] * units.radians)
    return transform(R, p), "pose"


def pose_argument(text: str, robot: Robot, units: Units) -> AnsweredPose:
    """The pose that an argument of --expect says: numbers, a matrix, or a transform expression.

    Raises NoAnswerError for an answer that is blank or no number, InputError for what cannot be read.
    """
    if not text.strip():
        raise NoAnswerError(BLANK, "no answer")
    call = CALL.match(text)
    if call and call.group(1).lower() in STEPS:
        try:
            return AnsweredPose(evaluate_transform(text, Scope(degrees=units.degrees), units), "pose")
        except ExpressionError as error:
            raise InputError(f"--expect: {error}") from None
    if text.lstrip().startswith("[["):
        return pose_from(matrix_argument(text, [(4, 4), (3, 4)], units).ravel(), "matrix", robot, units)
    parts = split_vector(text)
    kinds = {3: "position", 6: "rpy", 7: "quaternion", 16: "matrix"}
    if len(parts) == 2 and structure_of(robot).arm == "planar":
        kinds[2] = "planar"
    if len(parts) not in kinds:
        raise InputError(
            f"--expect: found {counted(len(parts), 'value')} in '{shown(text)}', expected X,Y,Z or "
            "X,Y,Z,roll,pitch,yaw, a matrix [[…], …] or an expression such as Trans(1,2,3)"
        )
    kind = kinds[len(parts)]
    return pose_from(np.array(numbers_of(parts, kind, units)), kind, robot, units)


def numbers_of(parts: Sequence[str], kind: str, units: Units) -> list[float]:
    """The values of --expect. Raises NoAnswerError for nan, inf and blanks, InputError for what cannot be read."""
    return [_number(part, kind == "rpy" and i >= 3, i, len(parts), units) for i, part in enumerate(parts)]


def _number(part: str, angle: bool, i: int, count: int, units: Units) -> float:
    try:
        return number(part, angle, units)
    except NoAnswerError as wrong:
        if no_number(part):
            raise NoAnswerError(wrong.status, f"value {i + 1} of {count}: {wrong.detail}") from None
        raise InputError(f"--expect: value {i + 1} of {count}: {wrong.detail}") from None


def no_number(cell: str) -> bool:
    """Whether a cell says that there is no number: blank, nan, inf. Everything else that is none is a slip."""
    return cell.strip().lower().lstrip("+-") in ("", "nan", "inf", "infinity", "null", "none")


def matrix_argument(text: str, shapes: Sequence[tuple[int, int]], units: Units) -> Array:
    """A matrix [[…], …] of expressions, of one of some shapes. Raises NoAnswerError and InputError."""
    rows = [split_vector(row) for row in split_vector(text)]
    expected = " or ".join(f"{m}×{n}" for m, n in shapes)
    if not text.strip().endswith("]]") or len({len(row) for row in rows}) != 1:
        raise InputError(f"--expect: found '{shown(text)}', expected a matrix [[…], …] of {expected} numbers")
    if (len(rows), len(rows[0])) not in shapes:
        raise InputError(f"--expect: found a matrix of {len(rows)}×{len(rows[0])}, expected {expected}")
    return np.array([numbers_of(row, "matrix", units) for row in rows])


def pose_value(T: Array, task: str, units: Units) -> dict[str, Any]:
    """A pose as an item shows it: numbers as the answer has them, of a matrix that is no rotation the matrix."""
    if task != "position" and float(rotation_error(T[:3, :3])) > MATRIX_CUT:
        M = T.copy()
        M[:3, 3] /= units.metres
        return {"matrix": M.tolist()}
    value: dict[str, Any] = {"position": (T[:3, 3] / units.metres + 0.0).tolist()}
    if task == "pose":
        value["rpy"] = (rpy_from_rotation(T[:3, :3]) / units.radians + 0.0).tolist()
    if task == "approach":
        value["approach"] = (T[:3, 2] + 0.0).tolist()
    return value
