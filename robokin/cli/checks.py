"""Marks as plain data: one item for each answer, and what they make together."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

from robokin.grading.tolerance import Tolerance
from robokin.units import Units

PASS = "pass"


@dataclass(frozen=True)
class Item:
    """The mark of one answer: its status, its score from 0 to 1, what was expected, what was given, and the error.

    `detail` is a sentence for eyes; `line` where the answer stands in a file, or None; `more` belongs to the kind of
    check.
    """

    id: str
    status: str
    score: float
    expected: Any = None
    got: Any = None
    error: dict[str, float | None] = field(default_factory=dict)
    detail: str = ""
    student: str | None = None
    line: int | None = None
    more: dict[str, Any] = field(default_factory=dict)

    @property
    def passed(self) -> bool:
        """Whether the answer is right."""
        return self.status == PASS

    def record(self) -> dict[str, Any]:
        """The item as JSON has it."""
        record: dict[str, Any] = {"id": self.id}
        if self.student is not None:
            record["student"] = self.student
        record |= {"status": self.status, "score": self.score, "expected": self.expected, "got": self.got}
        error = {
            name: value if value is not None and math.isfinite(value) else None for name, value in self.error.items()
        }
        record |= {"error": error, **self.more, "detail": self.detail}
        if self.line is not None:
            record["line"] = self.line
        return record


@dataclass(frozen=True)
class Report:
    """All items of a check. `tolerance` says what was allowed, in the units."""

    check: str
    robot: str
    units: Units | None
    tolerance: dict[str, float]
    items: tuple[Item, ...]

    @property
    def passed(self) -> int:
        """How many are right."""
        return sum(item.passed for item in self.items)

    @property
    def score(self) -> float:
        """The mean of the items' scores."""
        return mean_score(self.items)

    def students(self) -> list[dict[str, Any]]:
        """The marks of each student, in the order of the file; empty where no students are named."""
        names = dict.fromkeys(item.student for item in self.items if item.student is not None)
        marks = []
        for name in names:
            own = tuple(item for item in self.items if item.student == name)
            marks.append({"student": name, **_count(own)})
        return marks

    def head(self) -> dict[str, Any]:
        """What is said of all items, without them."""
        record: dict[str, Any] = {"check": self.check, "robot": self.robot}
        if self.units is not None:
            record["units"] = self.units.as_record()
        return record | {"tolerance": self.tolerance}

    def record(self) -> dict[str, Any]:
        """The document."""
        record = self.head() | _count(self.items)
        if students := self.students():
            record["students"] = students
        return record | {"items": [item.record() for item in self.items]}


def mean_score(items: tuple[Item, ...]) -> float:
    """The mean of scores, 1 of none."""
    return math.fsum(item.score for item in items) / len(items) if items else 1.0


def _count(items: tuple[Item, ...]) -> dict[str, Any]:
    return {"passed": sum(item.passed for item in items), "total": len(items), "score": mean_score(items)}


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
