"""Marks as plain data: one item for each answer, and what they make together."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from robokin.grading.feedback import ANSWER, DISTANCE, PART, VERDICT, Words, tells
from robokin.grading.tolerance import Tolerance
from robokin.records.envelope import envelope
from robokin.units import Units

PASS, NOT_DECIDED, WRONG = "pass", "not decided", "wrong"

SAYS_NOTHING = frozenset((
    PASS, NOT_DECIDED, WRONG, "blank", "not a number", "not a rotation", "not a pose", "bad line", "missing",
    "several answers", "unreadable", "no robot",
))  # fmt: skip
"""Statuses that tell nothing of the right answer. At the feedback `verdict` all others are `wrong`."""


@dataclass(frozen=True)
class Item:
    """The mark of one answer: its status, its score from 0 to 1, what was expected, what was given, and the error.

    `words` says what is wrong, as far as the feedback may tell; `line` is where the answer stands in a file, or None;
    `more` belongs to the kind of check; `counted` is false for a repetition of an answer before; `mistake` names what
    keeps an answer from being right, where that is a known mistake.
    """

    id: str
    status: str
    score: float
    expected: Any = None
    got: Any = None
    error: dict[str, float | None] = field(default_factory=dict)
    words: Words = field(default_factory=Words)
    student: str | None = None
    line: int | None = None
    more: dict[str, Any] = field(default_factory=dict)
    counted: bool = True
    mistake: str | None = None

    @property
    def passed(self) -> bool:
        """Whether the answer is right."""
        return self.status == PASS

    @property
    def decided(self) -> bool:
        """Whether it is known to be right or wrong."""
        return self.status != NOT_DECIDED

    def said_status(self, level: str = ANSWER) -> str:
        """The status as a level tells it."""
        return self.status if tells(level, PART) or self.status in SAYS_NOTHING else WRONG

    def detail(self, level: str = ANSWER) -> str:
        """What is wrong, in a sentence, as a level tells it."""
        return self.words.at(level)

    def errors(self, level: str = ANSWER) -> dict[str, float | None]:
        """The errors as a level tells them; None for what is no number or is not told."""
        told = tells(level, DISTANCE)
        return {
            name: value if told and value is not None and math.isfinite(value) else None
            for name, value in self.error.items()
        }

    def record(self, level: str = ANSWER) -> dict[str, Any]:
        """The item as JSON has it; what a level does not tell is null."""
        record: dict[str, Any] = {"id": self.id}
        if self.student is not None:
            record["student"] = self.student
        expected = self.expected if tells(level, ANSWER) else None
        record |= {"status": self.said_status(level), "score": self.score, "expected": expected, "got": self.got}
        more = {name: _told(name, value, level) for name, value in self.more.items()}
        record |= {"error": self.errors(level), **more, "detail": self.detail(level)}
        record |= {"decided": self.decided, "counted": self.counted}
        record["mistake"] = self.mistake if tells(level, PART) else None
        if self.line is not None:
            record["line"] = self.line
        return record


TOLD = {"needs": PART, "signs": PART, "zeros": DISTANCE, "missing": ANSWER, "complete": ANSWER}
"""From which level on a key that belongs to a kind of check is told; others are at all."""


def _told(name: str, value: Any, level: str) -> Any:
    """The value of a key as a level tells it."""
    if not tells(level, TOLD.get(name, VERDICT)):
        return None
    if name == "answers":
        return [_answer(answer, level) for answer in value]
    if name in ("differences", "cells"):
        hidden = [part for part, of in (("found", DISTANCE), ("expected", ANSWER)) if not tells(level, of)]
        return [one | dict.fromkeys(hidden) for one in value] if tells(level, PART) else []
    return value


def _answer(answer: dict[str, Any], level: str) -> dict[str, Any]:
    """One answer of a set as a level tells it."""
    status = answer["status"] if tells(level, PART) or answer["status"] in SAYS_NOTHING else WRONG
    return answer | {"status": status, "detail": answer["detail"].at(level)}


@dataclass(frozen=True)
class Report:
    """All items of a check. `tolerance` says what was allowed, in the units."""

    check: str
    robot: str
    units: Units | None
    tolerance: dict[str, float]
    items: tuple[Item, ...]

    @cached_property
    def counted(self) -> tuple[Item, ...]:
        """The items but for repetitions."""
        return tuple(item for item in self.items if item.counted)

    @property
    def right(self) -> bool:
        """Whether all answers are right."""
        return all(item.passed for item in self.items)

    @property
    def passed(self) -> int:
        """How many are right."""
        return sum(item.passed for item in self.counted)

    @property
    def undecided(self) -> int:
        """How many are neither right nor wrong."""
        return sum(not item.decided for item in self.counted)

    @property
    def score(self) -> float:
        """The mean of the questions' scores."""
        return mean_score(self.items)

    def students(self) -> list[dict[str, Any]]:
        """The marks of each student, in the order of the file; empty where no students are named."""
        own: dict[str, list[Item]] = {}
        for item in self.items:
            if item.student is not None:
                own.setdefault(item.student, []).append(item)
        return [{"student": name, **_count(tuple(items))} for name, items in own.items()]

    def head(self) -> dict[str, Any]:
        """What is said of all items, without them."""
        return envelope("robot", self.robot, self.units) | {"check": self.check, "tolerance": self.tolerance}

    def record(self, level: str = ANSWER) -> dict[str, Any]:
        """The document, as a level of feedback tells it."""
        record = self.head() | _count(self.items)
        if students := self.students():
            record["students"] = students
        return record | {"items": [item.record(level) for item in self.items]}


def mean_score(items: tuple[Item, ...]) -> float:
    """The mean of the questions' scores, 1 of none.

    A question is what one student answered under one id. With several answers that are not the same its score is the
    part of them that is right: neither more answers to an easy question nor a guess beside another one earn anything.
    """
    questions: dict[tuple[str | None, str], list[Item]] = {}
    for item in items:
        if item.counted:
            questions.setdefault((item.student, item.id), []).append(item)
    scores = [
        own[0].score if len(own) == 1 else sum(item.passed for item in own) / len(own) for own in questions.values()
    ]
    return math.fsum(scores) / len(scores) if scores else 1.0


def _count(items: tuple[Item, ...]) -> dict[str, Any]:
    counted = [item for item in items if item.counted]
    return {
        "passed": sum(item.passed for item in counted),
        "total": len(counted),
        "score": mean_score(items),
        "undecided": sum(not item.decided for item in counted),
    }


def tolerance_record(allowed: Tolerance, units: Units) -> dict[str, float]:
    """A tolerance in the units."""
    from robokin.cli.arguments import in_units

    record = {
        "position": float(in_units(_array(allowed.position), units.metres)),
        "angle": float(in_units(_array(allowed.angle), units.radians)),
    }
    return record | ({"relative": allowed.relative} if allowed.relative else {})


def _array(value: float) -> Any:
    import numpy as np

    return np.asarray(value)
