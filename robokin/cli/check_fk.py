"""Answers to "where is the hand?" as items."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from robokin.cli import say
from robokin.cli.arguments import in_units, joint_factors, parse_configuration
from robokin.cli.check_poses import Answer, PoseReader, pose_argument, pose_reader, pose_value
from robokin.cli.check_rows import GREATEST, IDS, STUDENTS, NoAnswerError, Row, Sheet, read_sheet
from robokin.cli.checks import PASS, Item
from robokin.cli.output.numbers import show
from robokin.errors import InputError, shown
from robokin.grading.poses import WRONG_ORIENTATION, WRONG_POSITION, pose_errors, pose_status
from robokin.grading.tolerance import Tolerance
from robokin.kinematics.forward import forward_kinematics
from robokin.model import Robot
from robokin.units import Units

Array = NDArray[np.float64]
Value = TypeVar("Value")

HALVES = {PASS: 1.0, WRONG_POSITION: 0.5, WRONG_ORIENTATION: 0.5}
"""The score of a pose: its position is one half, its orientation the other."""

NOT_ANSWERED, SEVERAL = "missing", "several answers"


@dataclass(frozen=True, eq=False)
class ForwardCheck:
    """What poses are marked against."""

    robot: Robot
    units: Units
    allowed: Tolerance

    def options(self, q: list[str], expect: list[str]) -> Iterator[Item]:
        """The items of --q and --expect, one of each after the other."""
        if len(q) != len(expect):
            raise InputError(f"found {len(q)} --q and {len(expect)} --expect, expected one --expect for each --q")
        for i, (configuration, text) in enumerate(zip(q, expect, strict=True), start=1):
            values = parse_configuration(configuration, self.robot, self.units)
            if np.any(np.abs(values) > GREATEST):
                raise InputError(f"--q: found '{shown(configuration)}', expected joint values below {GREATEST:g}")
            values = values * joint_factors(self.robot, self.units)
            try:
                yield self.item(str(i), values, pose_argument(text, self.robot, self.units))
            except NoAnswerError as wrong:
                yield self.none(str(i), wrong, text, values)

    def item(self, id: str, q: Array, answer: Answer, student: str | None = None, line: int | None = None) -> Item:
        """The mark of a pose answered for q (n,) [rad | m]."""
        right = forward_kinematics(self.robot, q)
        position, angle = pose_errors(right, answer.T, answer.task)
        status = pose_status(position, angle, self.allowed, right)
        errors: dict[str, float | None] = {"position": position / self.units.metres}
        if answer.task != "position":
            errors["angle"] = angle / self.units.radians
        expected, got = (pose_value(T, answer.task, self.units) for T in (right, answer.T))
        detail = "" if status == PASS else _detail(status, expected, got)
        more = {"q": self.shown(q), "compared": answer.task}
        score = HALVES.get(status, 0.0) if answer.task == "pose" else float(status == PASS)
        return Item(id, status, score, expected, got, errors, detail, student, line, more)

    def shown(self, q: Array) -> list[float]:
        """Joint values in the units."""
        values: list[float] = in_units(q, joint_factors(self.robot, self.units)).tolist()
        return values

    def none(
        self, id: str, wrong: NoAnswerError, got: object, q: Array | None, student: str | None = None,
        line: int | None = None,
    ) -> Item:  # fmt: skip
        """The mark of what is no answer."""
        expected = None if q is None else pose_value(forward_kinematics(self.robot, q), "pose", self.units)
        more = {"q": None if q is None else self.shown(q), "compared": None}
        return Item(id, wrong.status, 0.0, expected, got, {"position": None}, wrong.detail, student, line, more)

    # Files ------------------------------------------------------------------------------------------------

    def file(self, source: str, key: str | None) -> Iterator[Item]:
        """The items of a file of answers; the questions are its own joint values, or those of a key."""
        sheet = read_sheet(source)
        reader = pose_reader(sheet, self.robot, self.units)
        if reader is None:
            raise InputError(f"{sheet.name}: found no columns of a pose, expected x, y, z, roll, pitch, yaw")
        if key is not None:
            yield from self.keyed(sheet, reader, self.questions(key))
            return
        sheet.require(self.joints, "the joint values of the question; or --key FILE has them")
        id, student = sheet.column(IDS), sheet.column(STUDENTS)
        for i, row in enumerate(sheet.rows, start=1):
            name = (row.cells[id] if id else "") or str(i)
            yield self.row(name, row, reader, None, row.cells[student] if student else None)

    @property
    def joints(self) -> list[str]:
        """The columns of the joint values."""
        return [f"q{i}" for i in range(1, self.robot.n + 1)]

    def configuration(self, row: Row) -> Array:
        """The joint values (n,) [rad | m] of a row. Raises NoAnswerError."""
        values = row.numbers(self.joints, self.robot.revolute.tolist(), self.units)
        return values * joint_factors(self.robot, self.units)

    def row(self, id: str, row: Row, reader: PoseReader, q: Array | None, student: str | None) -> Item:
        """The mark of a row, for q or for its own joint values."""
        try:
            q = self.configuration(row) if q is None else q
            return self.item(id, q, reader.read(row), student, row.line)
        except NoAnswerError as wrong:
            return self.none(id, wrong, {name: row.cells[name] for name in reader.names}, q, student, row.line)

    def questions(self, key: str) -> dict[str, Array]:
        """The joint values (n,) [rad | m] of each question of a key. Raises InputError for a key that is wrong."""
        sheet = read_sheet(key)
        sheet.require(self.joints, "the joint values of the question")
        return keyed_rows(sheet, self.configuration)

    def keyed(self, sheet: Sheet, reader: PoseReader, questions: dict[str, Array]) -> Iterator[Item]:
        """The items of each student for each question."""
        for student, id, rows in answers_by_question(sheet, list(questions)):
            q = questions[id]
            if len(rows) == 1:
                yield self.row(id, rows[0], reader, q, student)
            elif rows:
                lines = ", ".join(str(row.line) for row in rows)
                wrong = NoAnswerError(SEVERAL, f"lines {lines}: found {len(rows)} answers, expected one")
                yield self.none(id, wrong, None, q, student, rows[0].line)
            else:
                yield self.none(id, NoAnswerError(NOT_ANSWERED, "no line answers it"), None, q, student)


def keyed_rows(sheet: Sheet, read: Callable[[Row], Value]) -> dict[str, Value]:
    """What a key says of each question. Raises InputError for a line that is wrong: a key is no answer."""
    id = sheet.column(IDS)
    if id is None:
        raise InputError(f"{sheet.name}: found no column 'id', expected one that names the questions")
    found: dict[str, Value] = {}
    for row in sheet.rows:
        name = row.cells[id]
        if not name or name in found:
            said = f"the id '{name}' twice" if name else "no id"
            raise InputError(f"{sheet.name}, line {row.line}: found {said}, expected one for each question")
        try:
            found[name] = read(row)
        except NoAnswerError as wrong:
            raise InputError(f"{sheet.name}, {wrong.detail}") from None
    return found


def answers_by_question(sheet: Sheet, ids: list[str]) -> Iterator[tuple[str | None, str, list[Row]]]:
    """Each student with each question and the lines that answer it; a note names the lines that answer none."""
    id, student = sheet.column(IDS), sheet.column(STUDENTS)
    if id is None:
        raise InputError(f"{sheet.name}: found no column 'id', expected one that names the questions of --key")
    answers: dict[tuple[str | None, str], list[Row]] = {}
    students: dict[str | None, None] = {}
    for row in sheet.rows:
        who = row.cells[student] if student else None
        students[who] = None
        if row.cells[id] not in ids:
            say(f"{sheet.name}, line {row.line}: there is no question '{shown(row.cells[id])}' in the key; not marked")
        answers.setdefault((who, row.cells[id]), []).append(row)
    for who in students:
        for name in ids:
            yield who, name, answers.get((who, name), [])


def _detail(status: str, expected: dict[str, list[float]], got: dict[str, list[float]]) -> str:
    """What was expected and what was given, of the part that is wrong."""
    parts = []
    for name, wanted in expected.items():
        if status == (WRONG_ORIENTATION if name == "position" else WRONG_POSITION):
            continue
        given = got.get(name)
        said = "no such rotation" if given is None else " ".join(map(show, given))
        label = "roll pitch yaw" if name == "rpy" else name
        parts.append(f"{label} {said}, expected {' '.join(map(show, wanted))}")
    return "; ".join(parts)
