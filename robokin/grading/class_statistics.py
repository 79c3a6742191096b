"""Statistics of a class: how hard each question was, and which known mistakes were made how often."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

from robokin.brief import Answer
from robokin.errors import counted
from robokin.grading.mark_items import BLANK, NOT_ANSWERED
from robokin.grading.pose_difference import PASS

UNANSWERED = (NOT_ANSWERED, BLANK)


@dataclass
class QuestionStatistics:
    """What a class did with a question. `kind` is what was asked and `about` of what."""

    id: str
    kind: str
    about: str
    statuses: Counter[str] = field(default_factory=Counter)
    mistakes: Counter[str] = field(default_factory=Counter)
    scores: list[float] = field(default_factory=list)

    @property
    def answers(self) -> int:
        """Marks, those of questions that were not answered too."""
        return len(self.scores)

    @property
    def right(self) -> int:
        """How many are right."""
        return self.statuses[PASS]

    @property
    def unanswered(self) -> int:
        """How many are missing or blank."""
        return sum(self.statuses[status] for status in UNANSWERED)

    @property
    def score(self) -> float:
        """The mean score: how easy the question was."""
        return math.fsum(self.scores) / len(self.scores) if self.scores else 0.0


@dataclass
class MistakeStatistics:
    """A known mistake: how often, by how many students, in which questions."""

    name: str
    answers: int = 0
    students: set[str] = field(default_factory=set)
    questions: dict[str, int] = field(default_factory=dict)


@dataclass(frozen=True, eq=False, repr=False)
class ClassStatistics(Answer):
    """What a class did: the scores of each student, questions in their order, mistakes by how often they were made.

    source: where the marks are from.
    """

    students: dict[str, list[float]]
    questions: list[QuestionStatistics]
    mistakes: list[MistakeStatistics]
    source: str = ""

    def __repr__(self) -> str:
        """A line: how many students, how many of their answers are right, the score."""
        right = f"{self.right} of {counted(self.answers, 'answer')} right"
        return f"<statistics of {counted(len(self.students), 'student')}: {right}, score {self.score:.4g}>"

    @property
    def answers(self) -> int:
        """Marks of all questions."""
        return sum(one.answers for one in self.questions)

    @property
    def right(self) -> int:
        """Right answers to all questions."""
        return sum(one.right for one in self.questions)

    @property
    def wrong(self) -> int:
        """Answers that were given and are not right."""
        return self.answers - self.right - sum(one.unanswered for one in self.questions)

    @property
    def known(self) -> int:
        """Answers with a known mistake."""
        return sum(one.answers for one in self.mistakes)

    @property
    def score(self) -> float:
        """The mean score of all answers."""
        scores = [score for one in self.questions for score in one.scores]
        return math.fsum(scores) / len(scores) if scores else 0.0

    @property
    def student_scores(self) -> list[float]:
        """The mean score of each student, from the lowest."""
        return sorted(math.fsum(own) / len(own) for own in self.students.values())


def class_statistics(marks: Iterable[dict[str, Any]], source: str = "") -> ClassStatistics:
    """The statistics of marks as `robokin check` writes them in JSON. Marks that do not count are left out."""
    questions: dict[tuple[str, str, str], QuestionStatistics] = {}
    mistakes: dict[str, MistakeStatistics] = {}
    students: dict[str, list[float]] = {}
    for mark in marks:
        if not mark.get("counted", True):
            continue
        id, student, score = str(mark["id"]), str(mark.get("student") or ""), float(mark["score"])
        kind = str(mark.get("kind") or mark.get("check") or "")
        about = str(mark.get("about") or mark.get("robot") or "")
        one = questions.setdefault((id, kind, about), QuestionStatistics(id, kind, about))
        one.scores.append(score)
        one.statuses[str(mark["status"])] += 1
        students.setdefault(student, []).append(score)
        if name := mark.get("mistake"):
            one.mistakes[name] += 1
            found = mistakes.setdefault(name, MistakeStatistics(name))
            found.answers += 1
            found.students.add(student)
            found.questions[id] = found.questions.get(id, 0) + 1
    ordered = sorted(mistakes.values(), key=lambda one: (-one.answers, one.name))
    return ClassStatistics(students, [*questions.values()], ordered, source)
