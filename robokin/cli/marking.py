"""Answers to items: each within its budget, whatever it holds."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Any, Protocol, TypeVar

from robokin.cli.check_options import Rules
from robokin.cli.checks import NOT_DECIDED, Item
from robokin.cli.interruptions import in_order
from robokin.grading.feedback import Words
from robokin.grading.guarded import Overrun, guarded


class Answered(Protocol):
    """What is marked at a time: what one student answers to one question."""

    @property
    def id(self) -> str:
        """The question."""

    @property
    def student(self) -> str | None:
        """Who answered, if that is said."""

    @property
    def line(self) -> int | None:
        """Where it stands in a file of answers."""


EMPTY: Mapping[str, Any] = MappingProxyType({})

Task = TypeVar("Task", bound=Answered)


def scored(item: Item, partial: float | None) -> Item:
    """The item with the score that --partial leaves an answer with a known mistake."""
    if item.mistake is None or partial is None or item.passed:
        return item
    return replace(item, score=max(item.score, partial))


def marked(
    mark: Callable[[Task], Sequence[Item]], tasks: Sequence[Task], rules: Rules, nothing: Mapping[str, Any] = EMPTY
) -> Iterator[Item]:
    """The items of each task, in order. An answer that takes too much is not decided, and the others go on.

    nothing: what an item of the check has beside the keys of all, where there is nothing to say.
    """
    # Asked to end, the program first ends the process that works on the answers.
    with in_order(), contextlib.closing(guarded(mark, tasks, rules.budget)) as outcomes:
        for task, outcome in zip(tasks, outcomes, strict=True):
            if isinstance(outcome, Overrun):
                words, more = undecided(outcome.why), dict(nothing)
                yield Item(task.id, NOT_DECIDED, 0.0, None, None, {}, words, task.student, task.line, more)
            else:
                yield from (scored(item, rules.partial) for item in outcome)


def undecided(why: str) -> Words:
    """What is said of an answer that is neither right nor wrong."""
    return Words(own=f"no points, since it could not be decided: {why}")
