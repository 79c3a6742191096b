"""What is marked of a file of a class: who answered which question, and how the answer is read."""

from __future__ import annotations

import contextlib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from robokin.arrays import Array
from robokin.formats.typed_angles import LOOKED_AT, unit_of_values
from robokin.grading.answers.answer_files import AnswerFile, Row, read_answers, read_key
from robokin.grading.answers.answered_poses import needed_poses, pose_reader
from robokin.grading.answers.submissions import Submission
from robokin.grading.answers.typed_answers import NONE
from robokin.grading.mark_items import NOT_ANSWERED, SEVERAL
from robokin.grading.marking import AnswerTask, GivenAnswer, GivenValue, NoAnswerError
from robokin.model import Robot
from robokin.model.joint_units import joint_factors
from robokin.tables.text_source import Say
from robokin.units import Units


@dataclass(frozen=True)
class JointReader:
    """Reads joint values from the columns q1, … of a file."""

    robot: Robot
    units: Units

    @property
    def columns(self) -> list[str]:
        """The columns of the joint values."""
        return [f"q{i}" for i in range(1, self.robot.n + 1)]

    def read(self, row: Row) -> Array:
        """The joint values (n,) [rad | m] of a row. Raises NoAnswerError."""
        values = row.numbers(self.columns, self.robot.revolute.tolist(), self.units)
        return values * joint_factors(self.robot, self.units)

    def unit_note(self, rows: Sequence[Row]) -> str:
        """A sentence where the plain numbers of the first rows look like angles in the other unit; "" for none."""
        plain: list[list[float]] = []
        for row in rows[:LOOKED_AT]:
            with contextlib.suppress(ValueError):
                plain.append([float(row.decimals.plain(row.cells[name])) for name in self.columns])
        return unit_of_values(self.robot, self.units, np.array(plain).reshape(len(plain), self.robot.n))

    def answer(self, row: Row) -> GivenAnswer:
        """The answer of a row: joint values, or that there are none."""
        first, *others = (row.cells[name] for name in self.columns)
        # `robokin ik -f csv` says with solution 0 that there is none.
        unsolved = row.cells.get("solution") == "0" and not first
        none = not (row.fault or any(others)) and (unsolved or first.lower() == NONE)
        return GivenAnswer(partial(self.read, row), claims_none=none, line=row.line)


def note_units(sheet: AnswerFile, joints: JointReader) -> None:
    """A note where the joint values of questions look like angles in the other unit; of answers the marks tell it."""
    if note := joints.unit_note(sheet.rows):
        sheet.say(f"{sheet.name}: {note}")


def pose_tasks(
    source: str, key: str | None, robot: Robot, units: Units, say: Say, *, follow: bool = False
) -> list[AnswerTask]:
    """The answered poses of a file; the questions are its own joint values, or those of a key. Raises InputError."""
    sheet = read_answers(source, say, follow=follow)
    poses, joints = needed_poses(sheet, robot, units, "a pose"), JointReader(robot, units)

    def answer(row: Row) -> GivenAnswer:
        return GivenAnswer(partial(poses.read, row), poses.cells(row))

    if key is None:
        sheet.require(joints.columns, "the joint values of the question; or --key FILE has them")
        note_units(sheet, joints)
        return [
            AnswerTask(id or str(i), partial(joints.read, row), (answer(row),), who, row.line)
            for i, (who, id, row) in enumerate(sheet.lines(), start=1)
        ]
    questions = read_key(key, say)
    questions.require(joints.columns, "the joint values of the question")
    note_units(questions, joints)
    known = questions.keyed(joints.read)
    tasks = []
    for who, id, rows in sheet.by_question(list(known)):
        if len(rows) == 1:
            given = answer(rows[0])
        elif rows:
            lines = ", ".join(str(row.line) for row in rows)
            said = f"lines {lines}: found {len(rows)} answers, expected one"
            given = GivenAnswer(GivenValue(NoAnswerError(SEVERAL, said)))
        else:
            given = GivenAnswer(GivenValue(NoAnswerError(NOT_ANSWERED, "no line answers it")))
        tasks.append(AnswerTask(id, GivenValue(known[id]), (given,), who, rows[0].line if rows else None))
    return tasks


def joint_tasks(
    source: str, key: str | None, robot: Robot, units: Units, say: Say, *, follow: bool = False
) -> list[AnswerTask]:
    """The answered joint values of a file; lines of one student and question are one. Raises InputError.

    The questions are the targets of a key, or those that the lines say themselves: then one is an id and a target.
    """
    sheet, joints = read_answers(source, say, follow=follow), JointReader(robot, units)
    if key is not None:
        questions = read_key(key, say)
        sheet.require(joints.columns, "the answered joint values")
        targets = needed_poses(questions, robot, units, "a target")
        known = {name: GivenValue(T) for name, T in questions.keyed(lambda row: targets.target(row, row.line)).items()}
        return [
            AnswerTask(id, known[id], tuple(map(joints.answer, rows)), who, rows[0].line if rows else None)
            for who, id, rows in sheet.by_question(list(known))
        ]
    pose_reader(sheet, robot, units)  # half a pose is refused before anything else
    sheet.require(joints.columns, "the answered joint values")
    poses = needed_poses(sheet, robot, units, "a target", ", or --key FILE")
    groups: dict[object, tuple[str | None, str, list[Row]]] = {}
    for who, id, row in sheet.lines():
        # A line that cannot be read stands for itself.
        place = (who, id, *poses.cells(row).values(), row.line if row.fault else 0)
        groups.setdefault(place, (who, id, []))[2].append(row)
    return [
        AnswerTask(
            id or str(number), partial(poses.target, rows[0]), tuple(map(joints.answer, rows)), who, rows[0].line
        )
        for number, (who, id, rows) in enumerate(groups.values(), start=1)
    ]


def table_task(submission: Submission) -> AnswerTask:
    """The table of a file that was handed in, or of a robot of the library."""
    return AnswerTask(submission.id, GivenValue(None), (GivenAnswer(submission.read, submission.place),))
