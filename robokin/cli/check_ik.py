"""Answers to "which joint values?" as items: one configuration, or all of them as a set."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from robokin.arrays import Array
from robokin.cli.arguments import joint_factors, parse_configuration, split_vector
from robokin.cli.check_fk import HALVES, NOT_ANSWERED, REPEATED, answers_by_question, keyed_rows
from robokin.cli.check_mistakes import joints_mistake, set_meant
from robokin.cli.check_poses import AnsweredPose, PoseReader, no_number, pose_reader
from robokin.cli.check_rows import BLANK, IDS, NOT_A_NUMBER, STUDENTS, AnswerFile, NoAnswerError, Row, sized
from robokin.cli.checks import NOT_DECIDED, PASS, Item
from robokin.cli.joint_words import JointWords
from robokin.cli.marking import undecided
from robokin.cli.output.numbers import counted
from robokin.cli.targets import Target
from robokin.errors import InputError
from robokin.grading.configuration_marks import (
    Reached,
    countable,
    mark_set,
    proven_none,
    reached,
    solutions_near,
)
from robokin.grading.distinct import firsts
from robokin.grading.feedback import Words, alike, joined
from robokin.grading.mistakes import loosened
from robokin.grading.tolerance import Tolerance
from robokin.inverse.analysis import Task
from robokin.inverse.solutions import Result
from robokin.model import Robot
from robokin.spatial import nearest_rotation, rotation_error, transform
from robokin.spatial.rotations import DIGITS_LOST
from robokin.tables.pose_columns import CLEAN
from robokin.units import Units

NONE = "none"
"""What an answer says that claims that there is no solution."""

EXISTS = "solution exists"
"""The status of that claim where it is wrong."""


@dataclass(frozen=True, eq=False)
class Given:
    """One answered configuration: q (n,) [rad | m], or None with what is wrong; `claims_none` says there is none."""

    q: Array | None
    wrong: NoAnswerError | None = None
    claims_none: bool = False
    line: int | None = None


@dataclass(frozen=True, eq=False)
class JointsTask:
    """What one student answers to one question, unread: the rows of a file, or the texts of --q.

    target: the question; None where the rows have it. known: its solutions, where they have been sought already.
    """

    id: str
    target: Target | None
    answers: tuple[Row | str, ...]
    student: str | None = None
    line: int | None = None
    known: Result | None = None


@dataclass(frozen=True, eq=False)
class InverseCheck:
    """What configurations are marked against. `every`: all solutions are asked for; None: where several are given.

    reader: reads the targets of a file whose lines say them.
    """

    robot: Robot
    units: Units
    allowed: Tolerance
    limits: bool
    every: bool | None
    reader: PoseReader | None = None

    @property
    def told(self) -> JointWords:
        """The words of the marks."""
        return JointWords(self.robot, self.units)

    # Reading ----------------------------------------------------------------------------------------------

    def option(self, text: str) -> Given:
        """The configuration of --q."""
        if self.says_none(text):
            return Given(None, claims_none=True)
        parts = split_vector(text)
        if not parts:
            return Given(None, NoAnswerError(BLANK, "no answer"))
        for i, part in enumerate(parts if len(parts) == self.robot.n else []):
            if no_number(part) and part not in self.robot.poses:
                word = NOT_A_NUMBER if part.strip() else BLANK
                return Given(None, NoAnswerError(word, f"value {i + 1} of {len(parts)}: found '{part}'"))
        values = parse_configuration(text, self.robot, self.units)
        try:
            values = np.array([sized(value) for value in values.tolist()])
        except NoAnswerError as wrong:
            return Given(None, wrong)
        return Given(values * joint_factors(self.robot, self.units))

    @property
    def joint_columns(self) -> list[str]:
        """The columns of the answered joint values."""
        return [f"q{i}" for i in range(1, self.robot.n + 1)]

    def says_none(self, row: Row | str) -> bool:
        """Whether a line, or a text of --q, says that there is no solution."""
        if isinstance(row, str):
            return row.strip().lower() == NONE
        words = [row.cells[name] for name in self.joint_columns]
        # `robokin ik -f csv` says with solution 0 that there is none.
        unsolved = row.cells.get("solution") == "0" and not any(words)
        return not row.fault and (unsolved or (words[0].lower() == NONE and not any(words[1:])))

    def row(self, row: Row) -> Given:
        """The configuration of a line."""
        names = self.joint_columns
        if self.says_none(row):
            return Given(None, claims_none=True, line=row.line)
        try:
            values = row.numbers(names, self.robot.revolute.tolist(), self.units)
        except NoAnswerError as wrong:
            return Given(None, wrong, line=row.line)
        return Given(values * joint_factors(self.robot, self.units), line=row.line)

    # Marking ----------------------------------------------------------------------------------------------

    def mark(self, task: JointsTask) -> list[Item]:
        """The items of the answers to one question. Raises InputError for a text that cannot be read."""
        target = task.target
        if target is None:
            first = task.answers[0]
            assert isinstance(first, Row)
            assert self.reader is not None
            try:
                target = target_of(self.reader.read(first))
            except NoAnswerError as wrong:
                return [self.unread(task, None, wrong)]
        given = [self.row(answer) if isinstance(answer, Row) else self.option(answer) for answer in task.answers]
        if not given:
            return [self.unread(task, target, NoAnswerError(NOT_ANSWERED, "no line answers it"))]
        if any(answer.claims_none for answer in given):
            return [self.claim(task, target, given)]
        if self.every or (self.every is None and len(given) > 1):
            return [self.set(task, target, given)]
        return self.each(task, target, given)

    def needs_all(self, answers: Sequence[Row | str]) -> bool:
        """Whether answers are compared with all solutions."""
        several = self.every is None and len(answers) > 1
        return bool(answers) and bool(self.every or several or any(map(self.says_none, answers)))

    def solutions(self, target: Target) -> Result:
        """What there is to find for a question of the teacher's: sought once, whatever time it takes."""
        return solutions_near(self.robot, target.T, self.allowed, task_of(target), self.limits)

    def unread(self, task: JointsTask, target: Target | None, wrong: NoAnswerError) -> Item:
        """The mark of what is no answer."""
        expected = None if target is None else self.told.target(target)
        words = Words(own=wrong.detail)
        return Item(task.id, wrong.status, 0.0, expected, None, {"position": None}, words, task.student, task.line)

    def each(self, task: JointsTask, target: Target, given: list[Given]) -> list[Item]:
        """The marks of configurations by themselves; those that repeat one before do not count."""
        read = [i for i, answer in enumerate(given) if answer.q is not None]
        values = np.array([given[i].q for i in read]).reshape(len(read), self.robot.n)
        same = firsts(self.robot, values, self.allowed) if len(read) > 1 else list(range(len(read)))
        repeated = {i for k, i in enumerate(read) if same[k] != k}
        # A blank beside other answers is one more wrong one, however many there are.
        blanks = [i for i, answer in enumerate(given) if answer.q is None]
        repeated.update(blanks[1:])
        items = [self.one(task, target, answer) for answer in given]
        return [
            replace(item, counted=False, words=joined([item.words, Words(own=REPEATED)])) if i in repeated else item
            for i, item in enumerate(items)
        ]

    def one(self, task: JointsTask, target: Target, given: Given) -> Item:
        """The mark of one configuration by itself."""
        task = replace(task, line=given.line)
        if given.q is None:
            return self.unread(task, target, given.wrong or NoAnswerError(BLANK))
        kind = task_of(target)
        mark = reached(self.robot, given.q, target.T, self.allowed, kind, self.limits)
        score = HALVES.get(mark.status, 0.0) if target.task == "pose" else float(mark.right)
        words, known = self.told.words(mark), None
        if not mark.right:
            known = joints_mistake(self.robot, given.q, target.T, kind, self.units, self.allowed, self.limits)
            words = joined([alike(known.said), words]) if known is not None else words
        return Item(
            task.id, mark.status, score, self.told.target(target), self.told.joints(given.q),
            self.told.errors(mark, target.task), words, task.student, task.line,
            mistake=None if known is None else known.name,
        )  # fmt: skip

    def set(self, task: JointsTask, target: Target, given: list[Given]) -> Item:
        """The mark of configurations as the set of all solutions."""
        read = [answer.q for answer in given if answer.q is not None]
        kind = task_of(target)
        mark = mark_set(self.robot, read, target.T, self.allowed, kind, self.limits, task.known)
        unread = len(given) - len(read)
        total = len(given) + len(mark.missing)
        right = sum(answer.right for answer in mark.answers)
        status = mark.status
        if unread:
            status = "missing and extra" if mark.missing else "extra"
        if not read:
            status = self.fault(given[0])[0]
        found = iter(mark.answers)
        answers = [self.answer(next(found) if one.q is not None else None, one) for one in given]
        more = {
            "complete": mark.counted,
            "answers": answers,
            "missing": [self.told.joints(q) for q in mark.missing],
        }
        expected = [self.told.joints(solution.q) for solution in mark.result.solutions]
        got = [self.told.joints(q) for q in read]
        worst = [answer for answer in mark.answers if not answer.right]
        errors: dict[str, float | None] = {
            "position": max((answer.position for answer in worst or mark.answers), default=np.nan) / self.units.metres
        }
        if target.task != "position":
            errors["angle"] = (
                max((answer.angle for answer in worst or mark.answers), default=np.nan) / self.units.radians
            )
        words, mistake = self.told.set_words(mark, answers), None
        if not right and not unread and (meant := set_meant(self.robot, read, self.units)) is not None:
            wide = loosened(self.allowed)
            near = any(reached(self.robot, q, target.T, wide, kind, self.limits).right for q in read)
            if (
                not near
                and mark_set(self.robot, meant[1], target.T, wide, kind, self.limits, mark.result).status == PASS
            ):
                mistake, words = meant[0].name, joined([alike(meant[0].said), words])
        score = right / total if total else 0.0
        return Item(
            task.id, status, score, expected, got, errors, words, task.student, given[0].line, more, mistake=mistake
        )

    def claim(self, task: JointsTask, target: Target, given: list[Given]) -> Item:
        """The mark of an answer that says that there is no solution: right where that is proven."""
        expected = self.told.target(target)
        line = given[0].line
        if not all(answer.claims_none for answer in given):
            words = alike("says that there is no solution, and gives one")
            return Item(task.id, "extra", 0.0, expected, NONE, {"position": None}, words, task.student, line)
        result = self.solutions(target) if task.known is None else task.known
        count = len(result.solutions)
        if result.solutions:
            known = f"there {'is' if count == 1 else 'are'} {counted(count, 'solution')}"
            status, words = EXISTS, Words(answer=known if countable(result) else "there are solutions")
        elif proven_none(result):
            status, words = PASS, alike(f"right: {result.reason}")
        else:
            status, words = NOT_DECIDED, undecided("no solution was found, and that there is none is not proven")
        score = float(status == PASS)
        return Item(task.id, status, score, expected, NONE, {"position": None}, words, task.student, line)

    def fault(self, given: Given) -> tuple[str, str]:
        """The status and the detail of an answer that is none."""
        return (given.wrong.status, given.wrong.detail) if given.wrong is not None else (BLANK, "")

    def answer(self, mark: Reached | None, given: Given) -> dict[str, Any]:
        """One answer of a set."""
        if mark is None:
            status, detail = self.fault(given)
            return {"q": None, "status": status, "detail": Words(own=detail)}
        return {"q": self.told.joints(mark.q), "status": mark.status, "detail": self.told.words(mark)}

    # Files ------------------------------------------------------------------------------------------------

    def file(self, sheet: AnswerFile, key: AnswerFile | None) -> list[JointsTask]:
        """The answers of a file; lines of one student and question (id and target) are one."""
        sheet.require(self.joint_columns, "the answered joint values")
        if key is None:
            return self.own_targets(sheet)
        targets = self.targets(key)
        known: dict[str, Result] = {}
        tasks = []
        for student, id, rows in answers_by_question(sheet, list(targets)):
            target = targets[id]
            if id not in known and self.needs_all(rows):
                known[id] = self.solutions(target)
            tasks.append(JointsTask(id, target, tuple(rows), student, rows[0].line if rows else None))
        return [replace(task, known=known.get(task.id)) for task in tasks]

    def own_targets(self, sheet: AnswerFile) -> list[JointsTask]:
        """The answers of a file whose lines say their targets themselves."""
        reader = self.reader
        if reader is None:
            raise InputError(
                f"{sheet.name}: found no columns of a target, expected x, y, z, roll, pitch, yaw, or --key FILE"
            )
        id, student = sheet.column(IDS), sheet.column(STUDENTS)
        groups: dict[tuple[Any, ...], list[Row]] = {}
        for row in sheet.rows:
            who = row.cells[student] if student else None
            # A line that cannot be read stands for itself.
            place = row.line if row.fault else 0
            groups.setdefault((who, row.cells[id] if id else "", reader.key(row), place), []).append(row)
        return [
            JointsTask(name or str(number), None, tuple(rows), who, rows[0].line)
            for number, ((who, name, _, _), rows) in enumerate(groups.items(), start=1)
        ]

    def targets(self, sheet: AnswerFile) -> dict[str, Target]:
        """The target of each question of a key."""
        reader = pose_reader(sheet, self.robot, self.units)
        if reader is None:
            raise InputError(f"{sheet.name}: found no columns of a target, expected x, y, z, roll, pitch, yaw")
        return keyed_rows(sheet, lambda row: target_of(reader.read(row), row.line))


def task_of(target: Target) -> Task:
    """What is asked of the tool."""
    return "approach" if target.task == "approach" else "position" if target.task == "position" else "pose"


def target_of(answer: AnsweredPose, line: int | None = None) -> Target:
    """A pose as a target. Raises NoAnswerError for a rotation that is none."""
    R = answer.T[:3, :3]
    off = float(rotation_error(R))
    if not off <= DIGITS_LOST:
        place = f"line {line}: " if line is not None else ""
        raise NoAnswerError("not a rotation", f"{place}found a matrix that is off by {off:.2g}, expected a rotation")
    R = nearest_rotation(R) if off > CLEAN else R
    return Target(transform(R, answer.T[:3, 3]), answer.task)
