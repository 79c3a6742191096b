"""Answers to "which joint values?" as items: one configuration, or all of them as a set."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robokin.cli.arguments import in_units, joint_factors, parse_configuration, split_vector
from robokin.cli.check_fk import HALVES, NOT_ANSWERED, answers_by_question, keyed_rows
from robokin.cli.check_poses import Answer, no_number, pose_reader, pose_value
from robokin.cli.check_rows import BLANK, IDS, NOT_A_NUMBER, STUDENTS, NoAnswerError, Row, Sheet, read_sheet, sized
from robokin.cli.checks import PASS, Item
from robokin.cli.output.numbers import counted, show
from robokin.cli.target_rows import CLEAN
from robokin.cli.targets import Target
from robokin.errors import InputError
from robokin.grading.configurations import OUTSIDE, Reached, SetMark, countable, mark_set, reached, solutions_near
from robokin.grading.tolerance import Tolerance
from robokin.inverse.analysis import Task
from robokin.model import Robot
from robokin.spatial import nearest_rotation, rotation_error, transform
from robokin.spatial.rotations import DIGITS_LOST
from robokin.units import Units

Array = NDArray[np.float64]

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
class InverseCheck:
    """What configurations are marked against. `every`: all solutions are asked for; None: where several are given."""

    robot: Robot
    units: Units
    allowed: Tolerance
    limits: bool
    every: bool | None

    # Reading ----------------------------------------------------------------------------------------------

    def option(self, text: str) -> Given:
        """The configuration of --q."""
        if text.strip().lower() == NONE:
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

    def row(self, row: Row) -> Given:
        """The configuration of a line."""
        names = [f"q{i}" for i in range(1, self.robot.n + 1)]
        words = [row.cells[name] for name in names]
        # `robokin ik -f csv` says with solution 0 that there is none.
        unsolved = row.cells.get("solution") == "0" and not any(words)
        if not row.fault and (unsolved or (words[0].lower() == NONE and not any(words[1:]))):
            return Given(None, claims_none=True, line=row.line)
        try:
            values = row.numbers(names, self.robot.revolute.tolist(), self.units)
        except NoAnswerError as wrong:
            return Given(None, wrong, line=row.line)
        return Given(values * joint_factors(self.robot, self.units), line=row.line)

    # Marking ----------------------------------------------------------------------------------------------

    def items(self, id: str, target: Target, given: list[Given], student: str | None = None) -> Iterator[Item]:
        """The items of the answers to one question."""
        if any(answer.claims_none for answer in given):
            yield self.claim(id, target, given, student)
        elif self.every or (self.every is None and len(given) > 1):
            yield self.set(id, target, given, student)
        else:
            for answer in given:
                yield self.one(id, target, answer, student)

    def one(self, id: str, target: Target, given: Given, student: str | None) -> Item:
        """The mark of one configuration by itself."""
        expected = self.target(target)
        if given.q is None:
            status, detail = self.fault(given)
            return Item(id, status, 0.0, expected, None, {"position": None}, detail, student, given.line)
        mark = reached(self.robot, given.q, target.T, self.allowed, task_of(target), self.limits)
        score = HALVES.get(mark.status, 0.0) if target.task == "pose" else float(mark.right)
        return Item(
            id, mark.status, score, expected, self.joints(given.q), self.errors(mark, target.task),
            self.detail(mark), student, given.line,
        )  # fmt: skip

    def set(self, id: str, target: Target, given: list[Given], student: str | None) -> Item:
        """The mark of configurations as the set of all solutions."""
        read = [answer.q for answer in given if answer.q is not None]
        mark = mark_set(self.robot, read, target.T, self.allowed, task_of(target), self.limits)
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
            "missing": [self.joints(q) for q in mark.missing],
        }
        expected = [self.joints(solution.q) for solution in mark.result.solutions]
        got = [self.joints(q) for q in read]
        worst = [answer for answer in mark.answers if not answer.right]
        errors: dict[str, float | None] = {
            "position": max((answer.position for answer in worst or mark.answers), default=np.nan) / self.units.metres
        }
        if target.task != "position":
            errors["angle"] = (
                max((answer.angle for answer in worst or mark.answers), default=np.nan) / self.units.radians
            )
        detail = self.set_detail(mark, answers)
        score = right / total if total else 0.0
        return Item(id, status, score, expected, got, errors, detail, student, given[0].line, more)

    def claim(self, id: str, target: Target, given: list[Given], student: str | None) -> Item:
        """The mark of an answer that says that there is no solution."""
        expected = self.target(target)
        line = given[0].line
        if len(given) > 1:
            detail = "says that there is no solution, and gives one"
            return Item(id, "extra", 0.0, expected, NONE, {"position": None}, detail, student, line)
        result = solutions_near(self.robot, target.T, self.allowed, task_of(target), self.limits)
        status = EXISTS if result.reachable else PASS
        count = len(result.solutions)
        known = countable(result)
        detail = (
            f"there {'is' if count == 1 else 'are'} {counted(count, 'solution')}" if known else "there are solutions"
        )
        detail = detail if result.reachable else f"right: {result.reason}"
        return Item(id, status, float(status == PASS), expected, NONE, {"position": None}, detail, student, line)

    # Words ------------------------------------------------------------------------------------------------

    def joints(self, q: Array) -> list[float]:
        """Joint values in the units."""
        values: list[float] = in_units(q, joint_factors(self.robot, self.units)).tolist()
        return values

    def target(self, target: Target) -> dict[str, Any]:
        """The target as an item shows it."""
        return {**pose_value(target.T, target.task, self.units), "task": target.task}

    def fault(self, given: Given) -> tuple[str, str]:
        """The status and the detail of an answer that is none."""
        return (given.wrong.status, given.wrong.detail) if given.wrong is not None else (BLANK, "")

    def errors(self, mark: Reached, task: str) -> dict[str, float | None]:
        """The errors in the units."""
        errors: dict[str, float | None] = {"position": mark.position / self.units.metres}
        return errors if task == "position" else errors | {"angle": mark.angle / self.units.radians}

    def answer(self, mark: Reached | None, given: Given) -> dict[str, Any]:
        """One answer of a set."""
        if mark is None:
            status, detail = self.fault(given)
            return {"q": None, "status": status, "detail": detail}
        detail = self.detail(mark)
        return {"q": self.joints(mark.q), "status": mark.status, "detail": detail}

    def detail(self, mark: Reached) -> str:
        """What is wrong with a configuration."""
        if mark.right:
            return ""
        if mark.status == OUTSIDE:
            limits = self.robot.limits / joint_factors(self.robot, self.units)[:, None]
            values = self.joints(mark.q)
            return "; ".join(
                f"q{i} {show(values[i - 1])}, expected {show(limits[i - 1, 0])} to {show(limits[i - 1, 1])}"
                for i in mark.outside
            )
        if mark.status == "duplicate":
            return "the same as another answer"
        parts = [f"{show(mark.position / self.units.metres)} {self.units.length} from the target"]
        if mark.status != "wrong position":
            parts.append(f"turned by {show(mark.angle / self.units.radians)} {self.units.angle}")
        return " and ".join(parts if mark.status != "wrong orientation" else parts[1:])

    def set_detail(self, mark: SetMark, answers: list[dict[str, Any]]) -> str:
        """What is wrong with a set."""
        parts = [
            f"answer {i}: {answer['status']}" + (f" ({answer['detail']})" if answer["detail"] else "")
            for i, answer in enumerate(answers, start=1)
            if answer["status"] != PASS
        ]
        if mark.missing:
            shown = " and ".join(" ".join(map(show, self.joints(q))) for q in mark.missing[:2])
            more = f" and {len(mark.missing) - 2} more" if len(mark.missing) > 2 else ""
            parts.append(
                f"{len(mark.missing)} of {counted(len(mark.result.solutions), 'solution')} missing: {shown}{more}"
            )
        elif not mark.counted and mark.result.reachable:
            parts.append("there may be infinitely many solutions, so each answer is marked by itself")
        return "; ".join(parts)

    # Files ------------------------------------------------------------------------------------------------

    def file(self, source: str, key: str | None) -> Iterator[Item]:
        """The items of a file of answers; lines of one question (id and target) are a set."""
        sheet = read_sheet(source)
        sheet.require([f"q{i}" for i in range(1, self.robot.n + 1)], "the answered joint values")
        if key is not None:
            targets = self.targets(read_sheet(key))
            for student, id, rows in answers_by_question(sheet, list(targets)):
                given = [self.row(row) for row in rows]
                if rows:
                    yield from self.items(id, targets[id], given, student)
                else:
                    missing = Given(None, NoAnswerError(NOT_ANSWERED, "no line answers it"))
                    yield self.one(id, targets[id], missing, student)
            return
        yield from self.own_targets(sheet)

    def own_targets(self, sheet: Sheet) -> Iterator[Item]:
        """The items of a file whose lines say their targets themselves."""
        reader = pose_reader(sheet, self.robot, self.units)
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
        for number, ((who, name, _, _), rows) in enumerate(groups.items(), start=1):
            label = name or str(number)
            try:
                target = target_of(reader.read(rows[0]))
            except NoAnswerError as wrong:
                yield Item(label, wrong.status, 0.0, None, None, {"position": None}, wrong.detail, who, rows[0].line)
                continue
            yield from self.items(label, target, [self.row(row) for row in rows], who)

    def targets(self, sheet: Sheet) -> dict[str, Target]:
        """The target of each question of a key."""
        reader = pose_reader(sheet, self.robot, self.units)
        if reader is None:
            raise InputError(f"{sheet.name}: found no columns of a target, expected x, y, z, roll, pitch, yaw")
        return keyed_rows(sheet, lambda row: target_of(reader.read(row), row.line))


def task_of(target: Target) -> Task:
    """What is asked of the tool."""
    return "approach" if target.task == "approach" else "position" if target.task == "position" else "pose"


def target_of(answer: Answer, line: int | None = None) -> Target:
    """A pose as a target. Raises NoAnswerError for a rotation that is none."""
    R = answer.T[:3, :3]
    off = float(rotation_error(R))
    if not off <= DIGITS_LOST:
        place = f"line {line}: " if line is not None else ""
        raise NoAnswerError("not a rotation", f"{place}found a matrix that is off by {off:.2g}, expected a rotation")
    R = nearest_rotation(R) if off > CLEAN else R
    return Target(transform(R, answer.T[:3, 3]), answer.task)
