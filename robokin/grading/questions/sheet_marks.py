"""The marks of a sheet: items of many kinds, each with what it is about."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any, ClassVar

from robokin.errors import InputError
from robokin.grading.feedback import Words
from robokin.grading.mark_items import NOT_A_NUMBER, Item, Report
from robokin.grading.marking import AnswerTask, Rules, marked
from robokin.grading.questions.exercise import Exercise


@dataclass(frozen=True, eq=False)
class SheetMarker:
    """Marks each answer against what its task brings with it."""

    unsaid: ClassVar[Mapping[str, Any]] = MappingProxyType({})

    def mark(self, task: AnswerTask) -> Sequence[Item]:
        """The one item of an answer; what its check refuses is a wrong answer, and no reason to stop."""
        marker = getattr(task, "marker", None)
        assert marker is not None
        try:
            (item,) = marker.mark(task)
        except InputError as error:
            return (task.item(NOT_A_NUMBER, 0.0, Words(own=str(error))),)
        return (item,)


def sheet_report(name: str, exercises: Mapping[str, Exercise], tasks: Sequence[AnswerTask], rules: Rules) -> Report:
    """The marks of a sheet's answers, one for each task."""
    items: Iterable[Item] = marked(SheetMarker(), tasks, rules)
    return Report("sheet", name, None, {}, tuple(_told(item, exercises[item.id]) for item in items))


def _told(item: Item, exercise: Exercise) -> Item:
    robot = getattr(exercise, "robot", None)
    about = {"kind": exercise.kind, "about": exercise.about}
    units = None if robot is None else robot.units.as_record()
    # What single checks say beyond this (cells, signs, missing solutions) is in the words too.
    return replace(item, more=about | {"units": units})
