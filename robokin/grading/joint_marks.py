"""Answers to "which joint values?" as items: one configuration, or all of them as a set."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from robokin.arrays import Array
from robokin.errors import counted
from robokin.grading.answer_mistakes import joints_mistake, set_mistake
from robokin.grading.answers.answered_poses import AnsweredPose
from robokin.grading.answers.typed_answers import NONE
from robokin.grading.configuration_marks import (
    BOTH,
    EXTRA,
    Reached,
    countable,
    mark_set,
    proven_none,
    reached,
    solutions_near,
)
from robokin.grading.distinct import firsts
from robokin.grading.feedback import Words, alike, joined
from robokin.grading.joint_words import JointWords
from robokin.grading.mark_items import NOT_ANSWERED, NOT_DECIDED, Item
from robokin.grading.marking import AnswerTask, GivenAnswer, GivenValue, NoAnswerError, repeated, undecided
from robokin.grading.pose_difference import PASS, pose_score, pose_value
from robokin.inverse.analysis import Task
from robokin.inverse.solutions import Result

EXISTS = "solution exists"
"""The status of that claim where it is wrong."""


@dataclass(frozen=True, eq=False)
class JointCheck(JointWords):
    """What configurations are marked against. `every`: all solutions are asked for; None: where several are given."""

    limits: bool = True
    every: bool | None = None

    def prepared(self, tasks: Sequence[AnswerTask]) -> list[AnswerTask]:
        """Tasks with the solutions of the teacher's questions, which are sought once, whatever time it takes."""
        known: dict[int, Result] = {}
        for task in tasks:
            own = id(task.question)
            if isinstance(task.question, GivenValue) and own not in known and self.needs_all(task.answers):
                known[own] = self.solutions(task.question())
        return [replace(task, known=known.get(id(task.question))) for task in tasks]

    def needs_all(self, answers: Sequence[GivenAnswer]) -> bool:
        """Whether answers are compared with all solutions."""
        return bool(answers) and (self.as_set(answers) or any(answer.claims_none for answer in answers))

    def as_set(self, answers: Sequence[Any]) -> bool:
        """Whether so many answers are marked as the set of all solutions."""
        return len(answers) > 1 if self.every is None else self.every

    def solutions(self, target: AnsweredPose) -> Result:
        """What there is to find for a question."""
        return solutions_near(self.robot, target.T, self.allowed, task_of(target), self.limits)

    def mark(self, task: AnswerTask) -> list[Item]:
        """The items of the answers to one question. Raises InputError for a text that cannot be read."""
        target: AnsweredPose | None = None
        try:
            target = task.question()
            if not task.answers:
                raise NoAnswerError(NOT_ANSWERED, "no line answers it")
        except NoAnswerError as wrong:
            return [self.unread(task, target, wrong)]
        claims = [answer for answer in task.answers if answer.claims_none]
        given = [_read(answer) for answer in task.answers if not answer.claims_none]
        if claims:
            return [self.claim(replace(task, line=task.answers[0].line), target, bool(given))]
        return [self.set(task, target, given)] if self.as_set(given) else self.each(task, target, given)

    def expected(self, target: AnsweredPose) -> dict[str, Any]:
        """The target as an item shows it."""
        return {**pose_value(target.T, target.task, self.units), "task": target.task}

    def unread(self, task: AnswerTask, target: AnsweredPose | None, wrong: NoAnswerError) -> Item:
        """The mark of what is no answer."""
        expected = None if target is None else self.expected(target)
        return task.item(wrong.status, 0.0, Words(own=wrong.detail), expected=expected, error={"position": None})

    def each(self, task: AnswerTask, target: AnsweredPose, given: Sequence[Array | NoAnswerError]) -> list[Item]:
        """The marks of configurations by themselves; those that repeat one before do not count."""
        read = [i for i, q in enumerate(given) if not isinstance(q, NoAnswerError)]
        values = np.array([given[i] for i in read]).reshape(len(read), self.robot.n)
        same = firsts(self.robot, values, self.allowed) if len(read) > 1 else list(range(len(read)))
        again = {i for k, i in enumerate(read) if same[k] != k}
        # A blank beside other answers is one more wrong one, however many there are.
        again.update([i for i in range(len(given)) if i not in read][1:])
        tasks = [replace(task, line=answer.line) for answer in task.answers]
        items = [self.one(own, target, q) for own, q in zip(tasks, given, strict=True)]
        return [repeated(item) if i in again else item for i, item in enumerate(items)]

    def one(self, task: AnswerTask, target: AnsweredPose, q: Array | NoAnswerError) -> Item:
        """The mark of one configuration by itself."""
        if isinstance(q, NoAnswerError):
            return self.unread(task, target, q)
        kind = task_of(target)
        mark = reached(self.robot, q, target.T, self.allowed, kind, self.limits)
        mistake = None if mark.right else joints_mistake(self, q, target.T, kind, self.limits)
        return task.item(
            mark.status, pose_score(mark.status, target.task), self.words(mark), mistake,
            expected=self.expected(target), got=self.joints(q),
            error=self.errors(mark.position, mark.angle, target.task),
        )  # fmt: skip

    def set(self, task: AnswerTask, target: AnsweredPose, given: Sequence[Array | NoAnswerError]) -> Item:
        """The mark of configurations as the set of all solutions."""
        read = [q for q in given if not isinstance(q, NoAnswerError)]
        unread = [q for q in given if isinstance(q, NoAnswerError)]
        kind = task_of(target)
        mark = mark_set(self.robot, read, target.T, self.allowed, kind, self.limits, task.known)
        status = mark.status
        if unread:
            status = (BOTH if mark.missing else EXTRA) if read else unread[0].status
        found = iter(mark.answers)
        answers = [self.answer(q if isinstance(q, NoAnswerError) else next(found)) for q in given]
        worst = [answer for answer in mark.answers if not answer.right] or mark.answers
        position, angle = (
            max((getattr(answer, name) for answer in worst), default=np.nan) for name in ("position", "angle")
        )
        right, total = sum(answer.right for answer in mark.answers), len(given) + len(mark.missing)
        mistake = None
        if not right and not unread:
            mistake = set_mistake(self, read, target.T, kind, self.limits, mark.result)
        missing = [self.joints(q) for q in mark.missing]
        return task.item(
            status, right / total if total else 0.0, self.set_words(mark, answers), mistake,
            expected=[self.joints(solution.q) for solution in mark.result.solutions],
            got=[self.joints(q) for q in read], error=self.errors(position, angle, target.task),
            more={"complete": mark.counted, "answers": answers, "missing": missing}, line=task.answers[0].line,
        )  # fmt: skip

    def answer(self, mark: Reached | NoAnswerError) -> dict[str, Any]:
        """One answer of a set."""
        if isinstance(mark, NoAnswerError):
            return {"q": None, "status": mark.status, "detail": Words(own=mark.detail)}
        return {"q": self.joints(mark.q), "status": mark.status, "detail": self.words(mark)}

    def claim(self, task: AnswerTask, target: AnsweredPose, others: bool) -> Item:
        """The mark of an answer that says that there is no solution: right where that is proven, and nothing else."""
        status, words = EXTRA, alike("says that there is no solution, and gives one")
        if not others:
            status, words = self.claimed(self.solutions(target) if task.known is None else task.known)
        return task.item(
            status, float(status == PASS), words, expected=self.expected(target), got=NONE, error={"position": None}
        )

    def claimed(self, result: Result) -> tuple[str, Words]:
        """The status of the claim that there is no solution, and what is said of it."""
        count = len(result.solutions)
        if count:
            known = f"there {'is' if count == 1 else 'are'} {counted(count, 'solution')}"
            return EXISTS, Words(answer=known if countable(result) else "there are solutions")
        if proven_none(result):
            return PASS, joined([alike(f"right: {result.reason}"), self.just_beside(result)])
        return NOT_DECIDED, undecided("no solution was found, and that there is none is not proven")


def _read(answer: GivenAnswer) -> Array | NoAnswerError:
    try:
        q: Array = answer.read()
        return q
    except NoAnswerError as wrong:
        return wrong


def task_of(target: AnsweredPose) -> Task:
    """What is asked of the tool."""
    return "approach" if target.task == "approach" else "position" if target.task == "position" else "pose"
