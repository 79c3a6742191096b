"""Marks as plain values: one item for each answer, and what they make together."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, SupportsIndex, overload

from robokin.brief import Brief
from robokin.errors import counted
from robokin.grading.feedback import ANSWER, DISTANCE, PART, Words, tells
from robokin.grading.pose_difference import PASS
from robokin.units import Units

NOT_DECIDED, WRONG, BLANK, NOT_A_NUMBER, BAD_LINE = "not decided", "wrong", "blank", "not a number", "bad line"
NO_ROTATION, NO_POSE, NOT_ANSWERED, SEVERAL = "not a rotation", "not a pose", "missing", "several answers"
UNREADABLE, NO_ROBOT = "unreadable", "no robot"

SAYS_NOTHING = frozenset((
    PASS, NOT_DECIDED, WRONG, BLANK, NOT_A_NUMBER, NO_ROTATION, NO_POSE, BAD_LINE, NOT_ANSWERED, SEVERAL, UNREADABLE,
    NO_ROBOT,
))  # fmt: skip
"""Statuses that tell nothing of the right answer. At the feedback `verdict` all others are `wrong`."""


def said_status(status: str, level: str) -> str:
    """A status as a level of feedback tells it."""
    return status if tells(level, PART) or status in SAYS_NOTHING else WRONG


@dataclass(frozen=True, repr=False)
class Item(Brief):
    """The mark of one answer: its status, its score from 0 to 1, what was expected, what was given, and the error.

    `words` says what is wrong, as far as the feedback may tell; `line` is where the answer stands in a file, or None;
    `more` belongs to the kind of check; `counted` is false for a repetition of an answer before; `mistake` names what
    keeps an answer from being right, where that is a known mistake. Numbers are in the units of the report.
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
        return said_status(self.status, level)

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


@dataclass(frozen=True, repr=False)
class Report(Brief):
    """All items of a check of answers about a robot, a sequence. `tolerance` says what was allowed, in the units."""

    check: str
    robot: str
    units: Units | None
    tolerance: dict[str, float]
    items: tuple[Item, ...]

    def __len__(self) -> int:
        """The number of items."""
        return len(self.items)

    @overload
    def __getitem__(self, i: SupportsIndex) -> Item: ...
    @overload
    def __getitem__(self, i: slice) -> tuple[Item, ...]: ...
    def __getitem__(self, i: SupportsIndex | slice) -> Item | tuple[Item, ...]:
        """Item i, or a tuple of some. Raises IndexError."""
        return self.items[i]

    def __iter__(self) -> Iterator[Item]:
        """The items in their order."""
        return iter(self.items)

    def __bool__(self) -> bool:
        """A report is one whether or not there are items in it."""
        return True

    def __repr__(self) -> str:
        """A line: how many answers are right, and the score."""
        right = f"{self.passed} of {counted(len(self.counted), 'answer')} right"
        return f"<check {self.check} of {self.robot}: {right}, score {self.score:.4g}>"

    def record(self, feedback: str = "answer") -> Any:
        """The document that the command prints with --json, as a level of feedback tells it. Raises InputError."""
        import robokin  # the package's own face: documents are made in a room above this one

        return robokin.documents.check(self, feedback)

    def to_pandas(self) -> Any:
        """The items as a data frame, with the columns of `robokin check -f csv`."""
        import robokin  # the package's own face: frames are made in a room above this one

        return robokin.dataframes.of(self)

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
        """The mean of the questions' scores, 1 of none.

        A question is what one student answered under one id. With several answers that are not the same its score is
        the part of them that is right: neither more answers to an easy question nor a guess beside another one earn
        anything.
        """
        questions: dict[tuple[str | None, str], list[Item]] = {}
        for item in self.counted:
            questions.setdefault((item.student, item.id), []).append(item)
        scores = [
            own[0].score if len(own) == 1 else sum(item.passed for item in own) / len(own) for own in questions.values()
        ]
        return math.fsum(scores) / len(scores) if scores else 1.0

    def students(self) -> dict[str, Report]:
        """The report of each student, in the order of the file; empty where no students are named."""
        own: dict[str, list[Item]] = {}
        for item in self.items:
            if item.student is not None:
                own.setdefault(item.student, []).append(item)
        return {
            name: Report(self.check, self.robot, self.units, self.tolerance, tuple(items))
            for name, items in own.items()
        }
