"""Answers to items: each within its budget, whatever it holds."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, Protocol

import numpy as np

from robokin.arrays import Array
from robokin.grading.feedback import Words, alike, joined
from robokin.grading.mark_items import NOT_DECIDED, Item, Report
from robokin.grading.mistakes import Mistake
from robokin.grading.tolerance import Tolerance
from robokin.jobs.executors import lent_executor
from robokin.jobs.guarded import BUDGET, Overrun, guarded, shared_out
from robokin.jobs.ordered_map import usable_cores
from robokin.model import Robot
from robokin.model.joint_units import in_units, joint_factors
from robokin.unfinished_work import in_order
from robokin.units import Units

if TYPE_CHECKING:
    from robokin.inverse.solutions import Result

REPEATED = "the same as an answer before, so it does not count"

DIGITS = 9
"""Digits of joint values by which two questions are told apart."""


FEW = 16
"""Answers that are worth a core: to start a process takes as long as to mark one to ten of them."""


class NoAnswerError(Exception):
    """An answer that cannot be compared: the status word that it gets, and why."""

    def __init__(self, status: str, detail: str = "") -> None:
        super().__init__(status)
        self.status, self.detail = status, detail


@dataclass(frozen=True, eq=False)
class GivenValue:
    """A value that needs no reading: called, it gives it, or raises it if it is an exception."""

    value: Any

    def __call__(self) -> Any:
        """The value."""
        if isinstance(self.value, Exception):
            raise self.value
        return self.value


@dataclass(frozen=True, eq=False)
class GivenAnswer:
    """One answer, unread: `read` gives it or raises NoAnswerError, and is called within the answer's budget.

    written: as it stands where it was given; `claims_none`: it says that there is no solution; line: in a file.
    """

    read: Callable[[], Any]
    written: Any = None
    claims_none: bool = False
    line: int | None = None


@dataclass(frozen=True, eq=False)
class AnswerTask:
    """What is marked at a time: what one student answers to one question.

    question: gives it or raises NoAnswerError, as answers do; line: where the first answer stands in a file; known:
    the solutions of a question of inverse kinematics, where they have been sought already.
    """

    id: str
    question: Callable[[], Any]
    answers: tuple[GivenAnswer, ...]
    student: str | None = None
    line: int | None = None
    known: Result | None = None

    def item(self, status: str, score: float, words: Words, mistake: Mistake | None = None, **more: Any) -> Item:
        """The mark of it; a known mistake is said first; `more` are other fields of `Item`."""
        if mistake is not None:
            words, more["mistake"] = joined([alike(mistake.said), words]), mistake.name
        return Item(self.id, status, score, words=words, student=self.student, **{"line": self.line, **more})


class Marker(Protocol):
    """What marks answers; `unsaid` is what an item has beside the keys of all where there is nothing to say."""

    @property
    def unsaid(self) -> Mapping[str, Any]:
        """The keys of an item that could not be decided."""

    def mark(self, task: AnswerTask) -> Sequence[Item]:
        """The items of an answer. Raises InputError for one that cannot be read, if it is a slip of the teacher's."""


@dataclass(frozen=True, eq=False)
class Subject:
    """What answers are about: a robot, the units in which errors are said, and how far answers may be off."""

    robot: Robot
    units: Units
    allowed: Tolerance

    unsaid: ClassVar[Mapping[str, Any]] = MappingProxyType({})
    """What an item has beside the keys of all where there is nothing to say."""

    def mark(self, task: AnswerTask) -> Sequence[Item]:
        """The items of an answer. Raises InputError for one that cannot be read, if it is a slip of the teacher's."""
        # No abstract method: a subject of no kind says quantities in its units, which is all that some ask of it.
        raise NotImplementedError

    def joints(self, q: Array) -> list[float]:
        """Joint values (..., n) [rad | m] in the units."""
        values: list[float] = in_units(q, joint_factors(self.robot, self.units)).tolist()
        return values

    def value(self, value: float, angle: bool) -> float:
        """An angle [rad] or a length [m] in the units."""
        return float(in_units(np.asarray(value), self.units.radians if angle else self.units.metres))

    def errors(self, position: float, angle: float, task: str) -> dict[str, float | None]:
        """The errors [m, rad] of a pose, as far as the task asks for them, in the units."""
        errors: dict[str, float | None] = {"position": position / self.units.metres}
        return errors if task == "position" else errors | {"angle": angle / self.units.radians}

    def report(self, check: str, robot: str, items: Sequence[Item]) -> Report:
        """The items of a check as a report; `robot` is what it calls the robot."""
        allowed = {name: self.value(getattr(self.allowed, name), name == "angle") for name in ("position", "angle")}
        if self.allowed.relative:
            allowed["relative"] = self.allowed.relative
        return Report(check, robot, self.units, allowed, tuple(items))


@dataclass(frozen=True)
class Rules:
    """What holds for all marks: `budget`, seconds of processor time for each answer, `partial` and `cores`.

    partial: the least score of an answer with a known mistake, or None. cores: how many work on the answers, None for
    all. Without a budget (None) answers are marked in this process, each however long it takes.
    """

    budget: float | None = BUDGET
    partial: float | None = None
    cores: int | None = None

    def scored(self, item: Item) -> Item:
        """The item with the score that `partial` leaves an answer with a known mistake."""
        if item.mistake is None or self.partial is None or item.passed:
            return item
        return replace(item, score=max(item.score, self.partial))


def marked(subject: Marker, tasks: Sequence[AnswerTask], rules: Rules) -> Iterator[Item]:
    """The items of each task, in order. An answer that takes too much is not decided, and the others go on.

    Raises InputError for an answer that its check refuses to mark.
    """
    if rules.budget is None:
        for task in tasks:
            yield from map(rules.scored, subject.mark(task))
        return
    # Asked to end, the program first ends the process that works on the answers.
    cores = min(rules.cores or usable_cores(), max(len(tasks) // FEW, 1))
    away = lent_executor() is not None
    work = shared_out(subject.mark, tasks, rules.budget) if away else guarded(subject.mark, tasks, rules.budget, cores)
    with in_order(), contextlib.closing(work) as outcomes:
        for task, outcome in zip(tasks, outcomes, strict=True):
            if isinstance(outcome, Overrun):
                yield task.item(NOT_DECIDED, 0.0, undecided(outcome.why), more=dict(subject.unsaid))
            else:
                yield from map(rules.scored, outcome)


def undecided(why: str) -> Words:
    """What is said of an answer that is neither right nor wrong."""
    return Words(own=f"no points, since it could not be decided: {why}")


def repeated(item: Item) -> Item:
    """The item of an answer that repeats one before: it does not count."""
    return replace(item, counted=False, words=joined([item.words, Words(own=REPEATED)]))


def without_repetitions(items: Iterable[Item]) -> Iterator[Item]:
    """The items, of which those that repeat a student's answer to the same question (their key `q`) do not count."""
    seen: set[str] = set()
    for item in items:
        question = [f"{value:.{DIGITS}g}" for value in item.more.get("q") or ()]
        # One that is right is the same right answer whatever its last digits are.
        key = repr((item.student, question, item.passed or item.got))
        yield repeated(item) if question and key in seen else item
        seen.add(key)
