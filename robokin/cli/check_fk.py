"""Answered poses of the end effector as items."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np

from robokin.arrays import Array
from robokin.cli.arguments import in_units, joint_factors, parse_configuration
from robokin.cli.check_mistakes import pose_mistake
from robokin.cli.check_poses import AnsweredPose, PoseReader, pose_argument, pose_reader, pose_value
from robokin.cli.check_rows import GREATEST, IDS, STUDENTS, AnswerFile, NoAnswerError, Row
from robokin.cli.checks import PASS, Item
from robokin.cli.output.numbers import show
from robokin.cli.statuses import say
from robokin.errors import InputError, shown
from robokin.grading.feedback import Words, alike, joined
from robokin.grading.pose_difference import WRONG_ORIENTATION, WRONG_POSITION, pose_errors, pose_status
from robokin.grading.tolerance import Tolerance
from robokin.kinematics.forward import forward_kinematics
from robokin.model import Robot
from robokin.units import Units

Value = TypeVar("Value")

HALVES = {PASS: 1.0, WRONG_POSITION: 0.5, WRONG_ORIENTATION: 0.5}
"""The score of a pose: its position is one half, its orientation the other."""

NOT_ANSWERED, SEVERAL = "missing", "several answers"

DIGITS = 9
"""Digits of joint values by which two questions are told apart."""

REPEATED = "the same as an answer before, so it does not count"


@dataclass(frozen=True, eq=False)
class PoseTask:
    """One answered pose, unread: a row of a file or a text of --expect, or None where there is none or too many.

    q: (n,) [rad | m] the question; None where the row itself has it.
    """

    id: str
    answer: Row | str | None
    q: Array | None
    student: str | None = None
    line: int | None = None
    wrong: NoAnswerError | None = None


@dataclass(frozen=True, eq=False)
class ForwardCheck:
    """What poses are marked against; `reader` reads those of a file."""

    robot: Robot
    units: Units
    allowed: Tolerance
    reader: PoseReader | None = None

    def options(self, q: list[str], expect: list[str]) -> Iterator[PoseTask]:
        """The answers of --q and --expect, one of each after the other."""
        if len(q) != len(expect):
            raise InputError(f"found {len(q)} --q and {len(expect)} --expect, expected one --expect for each --q")
        for i, (configuration, text) in enumerate(zip(q, expect, strict=True), start=1):
            values = parse_configuration(configuration, self.robot, self.units)
            if np.any(np.abs(values) > GREATEST):
                raise InputError(f"--q: found '{shown(configuration)}', expected joint values below {GREATEST:g}")
            yield PoseTask(str(i), text, values * joint_factors(self.robot, self.units))

    def mark(self, task: PoseTask) -> tuple[Item, ...]:
        """The mark of an answer. Raises InputError for a text that cannot be read."""
        q = task.q
        try:
            if task.wrong is not None:
                raise task.wrong
            if isinstance(task.answer, str):
                answer = pose_argument(task.answer, self.robot, self.units)
            else:
                assert task.answer is not None
                assert self.reader is not None
                q = self.configuration(task.answer) if q is None else q
                answer = self.reader.read(task.answer)
        except NoAnswerError as wrong:
            return (self.none(task, wrong, q),)
        assert q is not None
        return (self.item(task, q, answer),)

    def item(self, task: PoseTask, q: Array, answer: AnsweredPose) -> Item:
        """The mark of a pose answered for q (n,) [rad | m]."""
        right = forward_kinematics(self.robot, q)
        position, angle = pose_errors(right, answer.T, answer.task)
        status = pose_status(position, angle, self.allowed, right)
        errors: dict[str, float | None] = {"position": position / self.units.metres}
        if answer.task != "position":
            errors["angle"] = angle / self.units.radians
        expected, got = (pose_value(T, answer.task, self.units) for T in (right, answer.T))
        words, mistake = Words(), None
        if status != PASS:
            words = _words(status, expected, got, errors, self.units)
            if (known := pose_mistake(self.robot, q, answer, self.units, self.allowed)) is not None:
                mistake, words = known.name, joined([alike(known.said), words])
        more = {"q": self.shown(q), "compared": answer.task}
        score = HALVES.get(status, 0.0) if answer.task == "pose" else float(status == PASS)
        return Item(
            task.id, status, score, expected, got, errors, words, task.student, task.line, more, mistake=mistake
        )

    def shown(self, q: Array) -> list[float]:
        """Joint values in the units."""
        values: list[float] = in_units(q, joint_factors(self.robot, self.units)).tolist()
        return values

    def none(self, task: PoseTask, wrong: NoAnswerError, q: Array | None) -> Item:
        """The mark of what is no answer."""
        got: object = task.answer
        if isinstance(got, Row):
            got = {name: got.cells[name] for name in self.reader.names} if self.reader is not None else None
        expected = None if q is None else pose_value(forward_kinematics(self.robot, q), "pose", self.units)
        more = {"q": None if q is None else self.shown(q), "compared": None}
        words = Words(own=wrong.detail)
        return Item(task.id, wrong.status, 0.0, expected, got, {"position": None}, words, task.student, task.line, more)

    # Files ------------------------------------------------------------------------------------------------

    def file(self, sheet: AnswerFile, key: AnswerFile | None) -> list[PoseTask]:
        """The answers of a file; the questions are its own joint values, or those of a key."""
        if key is not None:
            return list(self.keyed(sheet, self.questions(key)))
        sheet.require(self.joints, "the joint values of the question; or --key FILE has them")
        id, student = sheet.column(IDS), sheet.column(STUDENTS)
        return [
            PoseTask(
                (row.cells[id] if id else "") or str(i), row, None, row.cells[student] if student else None, row.line
            )
            for i, row in enumerate(sheet.rows, start=1)
        ]

    @property
    def joints(self) -> list[str]:
        """The columns of the joint values."""
        return [f"q{i}" for i in range(1, self.robot.n + 1)]

    def configuration(self, row: Row) -> Array:
        """The joint values (n,) [rad | m] of a row. Raises NoAnswerError."""
        values = row.numbers(self.joints, self.robot.revolute.tolist(), self.units)
        return values * joint_factors(self.robot, self.units)

    def questions(self, sheet: AnswerFile) -> dict[str, Array]:
        """The joint values (n,) [rad | m] of each question of a key. Raises InputError for a key that is wrong."""
        sheet.require(self.joints, "the joint values of the question")
        return keyed_rows(sheet, self.configuration)

    def keyed(self, sheet: AnswerFile, questions: dict[str, Array]) -> Iterator[PoseTask]:
        """An answer for each student and question."""
        for student, id, rows in answers_by_question(sheet, list(questions)):
            task = PoseTask(id, None, questions[id], student, rows[0].line if rows else None)
            if len(rows) == 1:
                yield replace(task, answer=rows[0])
            elif rows:
                lines = ", ".join(str(row.line) for row in rows)
                yield replace(
                    task, wrong=NoAnswerError(SEVERAL, f"lines {lines}: found {len(rows)} answers, expected one")
                )
            else:
                yield replace(task, wrong=NoAnswerError(NOT_ANSWERED, "no line answers it"))


def needed_reader(sheet: AnswerFile, robot: Robot, units: Units) -> PoseReader:
    """What reads the poses of a file of answers. Raises InputError."""
    reader = pose_reader(sheet, robot, units)
    if reader is None:
        raise InputError(f"{sheet.name}: found no columns of a pose, expected x, y, z, roll, pitch, yaw")
    return reader


def without_repetitions(items: Iterable[Item]) -> Iterator[Item]:
    """The items, of which those that repeat a student's answer to the same question do not count."""
    seen: set[str] = set()
    for item in items:
        q = item.more.get("q")
        question = [f"{value:.{DIGITS}g}" for value in q] if q is not None else []
        # One that is right is the same right answer whatever its last digits are.
        key = repr((item.student, question, item.passed or item.got))
        if question and key in seen:
            item = replace(item, counted=False, words=joined([item.words, Words(own=REPEATED)]))
        seen.add(key)
        yield item


def keyed_rows(sheet: AnswerFile, read: Callable[[Row], Value]) -> dict[str, Value]:
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


def answers_by_question(sheet: AnswerFile, ids: list[str]) -> Iterator[tuple[str | None, str, list[Row]]]:
    """Each student with each question and the lines that answer it; a note names the lines that answer none.

    A line with a fault, or in another one's quotes, may name a student whose it is not: it stands for an answer only
    where there is no other.
    """
    id, student = sheet.column(IDS), sheet.column(STUDENTS)
    if id is None:
        raise InputError(f"{sheet.name}: found no column 'id', expected one that names the questions of --key")
    answers: dict[tuple[str | None, str], list[Row]] = {}
    students: dict[str | None, None] = {}
    known = set(ids)
    unmarked = []
    for row in sheet.rows:
        who = row.cells[student] if student else None
        students[who] = None
        if row.cells[id] not in known:
            unmarked.append(f"line {row.line}: there is no question '{shown(row.cells[id])}' in the key; not marked")
        answers.setdefault((who, row.cells[id]), []).append(row)
    for place, rows in answers.items():
        best = min(map(_doubt, rows))
        unmarked += [f"line {row.line}: {row.fault or DOUBTFUL}; not marked" for row in rows if _doubt(row) > best]
        answers[place] = [row for row in rows if _doubt(row) == best]
    for note in unmarked[:NOTES]:
        say(f"{sheet.name}, {note}")
    if len(unmarked) > NOTES:
        say(f"{sheet.name}: and {len(unmarked) - NOTES} more lines that are not marked")
    for who in students:
        for name in ids:
            yield who, name, answers.get((who, name), [])


def _doubt(row: Row) -> int:
    """How little a line is to be trusted to be what it says: 0 for a row, more for what may be another one's cell."""
    return 2 if row.fault else int(row.doubtful)


DOUBTFUL = "it may be part of the cell of another row, whose quotes do not end"

NOTES = 20
"""Lines that are not marked that are named one by one."""


def _words(
    status: str, expected: dict[str, Any], got: dict[str, Any], errors: dict[str, float | None], units: Units
) -> Words:
    """What was expected and what was given, of the part that is wrong."""
    parts = []
    for name, wanted in expected.items():
        if status == (WRONG_ORIENTATION if name == "position" else WRONG_POSITION):
            continue
        given = got.get(name)
        said = "no such rotation" if given is None else " ".join(map(show, given))
        label = "roll pitch yaw" if name == "rpy" else name
        error, unit = (errors["position"], units.length) if name == "position" else (errors.get("angle"), units.angle)
        off = f"{'position' if name == 'position' else 'orientation'} off by {show(error or 0.0)} {unit}"
        parts.append(Words("", off, f"{label} {said}, expected {' '.join(map(show, wanted))}"))
    return joined(parts)
