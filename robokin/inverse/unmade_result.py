"""Results that are made when something of them is first asked for: of the answers in a loop most are not looked at.

Statement. Give a result for a pose in the time of its numbers, and the same to all who look at it as one that was made.
Derivation. Its class has a property for each field, and for all of them together (`__dict__`): whichever is asked first
makes it, and gives it the class `Result`, which has none. The question is made when it is asked for, as other fields
are that take a while (`later_fields`).
Degenerate case. Threads that ask at once make it at once; the fields of one of them stay.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields
from functools import partial
from typing import TYPE_CHECKING, Any, SupportsIndex

from robokin.arrays import Array
from robokin.brief import Brief
from robokin.inverse.later_fields import QUESTION
from robokin.inverse.solutions import Question, Result
from robokin.model import Robot


def question_later(robot: Robot, T: Array, limits: bool, hold: Mapping[int, float]) -> dict[str, Any]:
    """The field of a question for a whole pose T (4, 4) [m], which is made when it is first asked for."""
    return {QUESTION: partial(_question, robot, T, limits, hold)}


def _question(robot: Robot, T: Array, limits: bool, hold: Mapping[int, float]) -> dict[str, Any]:
    return {"question": Question(robot, T, "pose", limits, hold)}


def told_result(told: dict[str, Any]) -> Result:
    """A result by its fields, or by what finds them, made in a fraction of the usual time; it keeps the mapping."""
    one = object.__new__(Result)
    object.__setattr__(one, "__dict__", told)
    return one


_known_of: Callable[[object], dict[str, Any]] = vars(Brief)["__dict__"].__get__
"""What an object holds, also where its class has something else for `__dict__`."""


def _asked_first(name: str) -> property:
    """What stands for a field, and for all of them, until a result is made."""

    def found(one: UnmadeResult) -> Any:
        known = _known_of(one)
        tell = known.get("_tell")
        if tell is not None:  # else another thread has made it meanwhile
            known.update(tell())
            object.__setattr__(one, "__class__", Result)
            known.pop("_tell", None)
        return getattr(one, name)

    return property(found)


class UnmadeResult(Result):
    """A result that is made when something of it is first asked for, and is a `Result` from then on.

    tell: gives its fields, or what finds them.
    """

    if not TYPE_CHECKING:  # who reads the types knows the fields alone
        locals().update({part.name: _asked_first(part.name) for part in fields(Result)})
        __dict__ = _asked_first("__dict__")

    def __init__(self, tell: Callable[[], dict[str, Any]]) -> None:
        object.__setattr__(self, "_tell", tell)

    def __reduce_ex__(self, protocol: SupportsIndex) -> str | tuple[Any, ...]:
        """As the `Result` that it is from now on."""
        vars(self)
        return Result.__reduce_ex__(self, protocol)
