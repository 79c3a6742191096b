"""Answers in the texts of options: a pose, joint values, a matrix, a whole number.

A student may have written any of it: what says that there is no number is a wrong answer, and gets its mark; what
cannot be read is a slip of whoever typed the command, and is refused.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import partial

import numpy as np

from robokin.arrays import Array
from robokin.errors import ExpressionError, InputError, counted, shown
from robokin.formats.number_expressions import Scope
from robokin.formats.transform_expressions import STEPS, evaluate_transform
from robokin.formats.vector_expressions import parse_configuration, split_vector
from robokin.grading.answers.answer_files import GREATEST, number, sized
from robokin.grading.answers.answered_poses import AnsweredPose, pose_from
from robokin.grading.jacobian_marks import jacobian_shapes
from robokin.grading.mark_items import BLANK, NOT_A_NUMBER
from robokin.grading.marking import AnswerTask, GivenAnswer, GivenValue, NoAnswerError
from robokin.kinematics.structure import structure_of
from robokin.model import Robot
from robokin.model.joint_units import joint_factors
from robokin.units import Units

CALL = re.compile(r"\s*([A-Za-z]+)\s*\(")

NONE = "none"
"""What an answer says that claims that there is no solution."""


def typed_pose_tasks(q: Sequence[str], expect: Sequence[str], robot: Robot, units: Units) -> list[AnswerTask]:
    """The answers of --expect to the questions of --q, one of each after the other. Raises InputError."""
    if len(q) != len(expect):
        raise InputError(f"found {len(q)} --q and {len(expect)} --expect, expected one --expect for each --q")
    tasks = []
    for i, (configuration, text) in enumerate(zip(q, expect, strict=True), start=1):
        values = parse_configuration(configuration, robot, units)
        if np.any(np.abs(values) > GREATEST):
            raise InputError(f"--q: found '{shown(configuration)}', expected joint values below {GREATEST:g}")
        answer = GivenAnswer(partial(pose_argument, text, robot, units), text)
        tasks.append(AnswerTask(str(i), GivenValue(values * joint_factors(robot, units)), (answer,)))
    return tasks


def typed_joints(text: str, robot: Robot, units: Units) -> GivenAnswer:
    """The answer of a --q: joint values, a named pose, or `none`."""
    return GivenAnswer(partial(joints_argument, text, robot, units), text, text.strip().lower() == NONE)


def joints_argument(text: str, robot: Robot, units: Units) -> Array:
    """The joint values (n,) [rad | m] that a --q says. Raises NoAnswerError, InputError for what cannot be read."""
    parts = split_vector(text)
    if not parts:
        raise NoAnswerError(BLANK, "no answer")
    for i, part in enumerate(parts if len(parts) == robot.n else []):
        if no_number(part) and part not in robot.poses:
            word = NOT_A_NUMBER if part.strip() else BLANK
            raise NoAnswerError(word, f"value {i + 1} of {len(parts)}: found '{part}'")
    values = np.array([sized(value) for value in parse_configuration(text, robot, units).tolist()])
    return values * joint_factors(robot, units)


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


def jacobian_answer(text: str, robot: Robot, units: Units, frame: str) -> GivenAnswer:
    """The answer of --expect to what the Jacobian is: its entries (rows, n) in the units."""
    return GivenAnswer(partial(matrix_argument, text, jacobian_shapes(robot, frame), units), text)


def whole_number(text: str, option: str) -> int | None:
    """A whole number, None for a blank or what is no number. Raises InputError for anything else."""
    if no_number(text):
        return None
    digits = text.strip()
    try:
        if len(digits) < 20 and float(digits).is_integer():
            return int(float(digits))
    except ValueError:
        pass
    raise InputError(f"{option}: found '{shown(text)}', expected a whole number")
