"""Tables as items: is it the same robot, and if not, where does it begin to differ?"""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, ClassVar

import numpy as np

from robokin.arrays import Array
from robokin.errors import DescriptionError, InputError, or_list
from robokin.grading.differences import Difference, difference_of
from robokin.grading.feedback import Words, joined
from robokin.grading.mark_items import NO_ROBOT, UNREADABLE, Item
from robokin.grading.marking import AnswerTask, NoAnswerError, Subject
from robokin.grading.pose_difference import PASS
from robokin.grading.same_robot import OPEN, Comparison, compare_tables
from robokin.grading.table_mistakes import table_mistake
from robokin.grading.wrong_cells import Cell, wrong_cells
from robokin.model import Robot
from robokin.number_text import show

OTHER_JOINTS, DIFFERENT = "other joints", "different"

SAID = {
    "base": "the base stands elsewhere",
    "tool": "the tool is another frame",
    "zero": "joints have another zero",
    "sign": "joints turn the other way",
}
"""What each of `OPEN` means where it is all that differs."""


@dataclass(frozen=True, eq=False)
class TableCheck(Subject):
    """What tables are marked against. `free` is left open; `alone`: a table that cannot be read is refused."""

    free: frozenset[str] = frozenset()
    alone: bool = False

    unsaid: ClassVar = MappingProxyType({"needs": None, "differences": (), "zeros": None, "signs": None, "cells": ()})

    def mark(self, task: AnswerTask) -> tuple[Item]:
        """The mark of a table. Raises InputError for one that cannot be read if it is the only one."""
        try:
            given = task.answers[0].read()
        except NoAnswerError as wrong:
            return (self.none(task, wrong.status, Words(own=wrong.detail)),)
        except InputError as error:
            if self.alone:
                raise
            # One line: the first mistake.
            said = error.sentence if isinstance(error, DescriptionError) else str(error)
            return (self.none(task, UNREADABLE, Words(own=said)),)
        if not isinstance(given, Robot):
            if self.alone:
                raise InputError(f"{task.answers[0].written} is no robot, expected a table of joints")
            return (self.none(task, NO_ROBOT, Words(own="expected a table of joints")),)
        return (self.item(task, given),)

    def none(self, task: AnswerTask, status: str, words: Words, **more: Any) -> Item:
        """The mark of what cannot be compared."""
        return task.item(status, 0.0, words, expected=_moving_types(self.robot), more=dict(self.unsaid), **more)

    def item(self, task: AnswerTask, given: Robot) -> Item:
        """The mark of a table that can be read."""
        found = compare_tables(self.robot, given, self.allowed, self.free)
        told = found.same or bool(found.couplings)
        mistake = None if told else table_mistake(self.robot, given, self.allowed, self.free)
        if found.match is None:
            return self.none(task, OTHER_JOINTS, self.other_joints(given), mistake=mistake, got=_moving_types(given))
        cells: tuple[Cell, ...] = ()
        if not told and mistake is None:
            cells = wrong_cells(self.robot, given, self.allowed, self.free)
        differences = [difference_of(one, self.allowed) for one in found.differences]
        return task.item(
            PASS if found.same else DIFFERENT, found.score, self.words(found, differences, cells), mistake,
            expected=_moving_types(self.robot), got=_moving_types(given), more=self.more(found, differences, cells),
        )  # fmt: skip

    def more(self, found: Comparison, differences: list[Difference], cells: tuple[Cell, ...]) -> dict[str, Any]:
        """What would have to be left open, the differences, and how the joints of the two go with each other."""
        more = dict(self.unsaid)
        if found.needs is not None and found.match is not None:
            more |= {
                "needs": list(found.needs),
                "zeros": self.shifts(self.zeros(found)),
                "signs": list(found.match.state.signs),
            }
        more["differences"] = [{"joint": one.joint, "what": one.what, **self.values(one)} for one in differences]
        more["cells"] = [{"row": one.row, "column": one.column, **self.values(one)} for one in cells]
        return more

    def values(self, one: Difference | Cell) -> dict[str, float | None]:
        """What was found and expected, in the units."""
        expected = None if one.expected is None else self.value(one.expected, one.angle)
        return {"found": self.value(one.found, one.angle), "expected": expected}

    def shifts(self, zeros: Array) -> list[float]:
        """Shifts of joints (n,) [rad | m] in the units."""
        turning = [letter == "R" for letter in _moving_types(self.robot)]
        return [self.value(float(shift), turns) for shift, turns in zip(zeros, turning, strict=True)]

    def zeros(self, found: Comparison) -> Array:
        """(n,) the shifts c of q' = s (q + c) [rad | m], without the dust that the comparison leaves."""
        assert found.match is not None
        zeros = found.match.zeros
        turning = np.array([letter == "R" for letter in _moving_types(self.robot)], dtype=bool)
        small = np.where(turning, self.allowed.angle, self.allowed.position)
        return np.where(np.abs(zeros) <= small, 0.0, zeros)

    # Words ------------------------------------------------------------------------------------------------

    def other_joints(self, given: Robot) -> Words:
        """Where the joints' types differ."""
        got, wanted = _moving_types(given), _moving_types(self.robot)
        if len(got) != len(wanted):
            answer = f"{len(got)} joints ({got}), expected {len(wanted)} ({wanted})"
            return Words("the number of joints", f"{len(got)} joints are not the right number", answer)
        i = next(i for i, (a, b) in enumerate(zip(got, wanted, strict=True), start=1) if a != b)
        names = {"R": "revolute", "P": "prismatic"}
        answer = f"joint {i} is {names[got[i - 1]]}, expected {names[wanted[i - 1]]}"
        return Words(f"the type of joint {i}", f"the type of joint {i}", answer)

    def words(self, found: Comparison, differences: list[Difference], cells: tuple[Cell, ...]) -> Words:
        """What is wrong, in a sentence."""
        if found.same:
            return Words()
        if found.couplings:
            return self.hung(found)
        named = joined([self.cell(one) for one in cells])
        # One wrong cell says more than what would have to be left open for it; of a wrong offset both are said.
        offset = found.needs == ("zero",) and any(one.column == "offset" for one in cells)
        if (found.needs is None and cells) or (len(cells) == 1 and not offset):
            return named
        first = named if cells else self.sentence(differences[0]) if differences else Words()
        if found.needs is None:
            more = len(differences) - 1
            return first.mapped(lambda text: f"{text}; and {more} more" if more > 0 else text)
        said = [SAID[name] + self.which(name, found) for name in found.needs if name not in self.free]
        open_all = ",".join(name for name in OPEN if name in self.free or name in found.needs)
        same = f"the same arm, but {' and '.join(said)}"
        pass_with = f"; --up-to {open_all} would let it pass"
        return first.mapped(lambda text: f"{same}{pass_with} ({text})")

    def hung(self, found: Comparison) -> Words:
        """What joints hang on, where it is not what it should be."""
        one, more = found.couplings[0], len(found.couplings) + len(found.differences) - 1
        start = f"joint {one.joint}: what it hangs on"
        if one.pitches is not None:
            start = f"joint {one.joint}: its pitch"
            own, right = (show(self.value(2.0 * np.pi * pitch, False)) for pitch in one.pitches)
            answer = f"{start}: {own} {self.units.length} a turn, expected {right}"
        else:
            own, right = (self.shares(one.joint, ratios) for ratios in (one.found, one.expected))
            answer = f"{start}: {own}, expected {right}"
        words = Words(start, f"{start} is another", answer)
        return words.mapped(lambda text: f"{text}; and {more} more" if more > 0 else text)

    def shares(self, joint: int, ratios: tuple[tuple[int, float], ...]) -> str:
        """What a joint (from 1) takes of others, as `itself - 0.5 of joint 2`, in the units."""
        moving = [row for row in self.robot.rows if row.moves]

        def unit(number: int) -> float:
            turns = number > len(moving) or moving[number - 1].type.letter == "R"
            return self.units.radians if turns else self.units.metres

        text = ""
        for other, ratio in ratios:
            number = ratio * unit(other) / unit(joint)
            name = f"joint {other}" if other <= len(moving) else "a joint beside the chain"
            name = "itself" if other == joint else name
            times = name if number == 1.0 or (text and number == -1.0) else f"{show(abs(number))} of {name}"
            text += f" {'-' if number < 0.0 else '+'} {times}" if text else f"{'-' if number < 0.0 else ''}{times}"
        return "nothing" if text in ("itself", "") else text

    def cell(self, one: Cell) -> Words:
        """A wrong cell in a sentence."""
        unit = self.units.angle if one.angle else self.units.length
        found, expected = self.value(one.found, one.angle), self.value(one.expected, one.angle)
        start = f"row {one.row}: {one.column}"
        off = abs(found - expected)
        if one.angle:
            turn = 2.0 * np.pi / self.units.radians
            off = min(off % turn, turn - off % turn)
        return Words(
            f"{start} is wrong", f"{start} {show(found)} {unit} is off by {show(off)} {unit}",
            f"{start} {show(found)} {unit}, expected {show(expected)} {unit}",
        )  # fmt: skip

    def which(self, name: str, found: Comparison) -> str:
        """The joints that a zero or a sense is about."""
        assert found.match is not None
        if name == "sign":
            return _numbers([i for i, sign in enumerate(found.match.state.signs, start=1) if sign < 0])
        if name == "zero":
            return _numbers([int(i) + 1 for i in np.flatnonzero(self.zeros(found))])
        return ""

    def sentence(self, one: Difference) -> Words:
        """A difference as a sentence's part."""
        unit = self.units.angle if one.angle else self.units.length
        value = self.value(one.found, one.angle)
        start = one.what if one.joint is None else f"joint {one.joint}: {one.what}"
        if one.expected is None:
            far = f"{start}: off by {show(value)} {unit}"
            return Words(start, far, far)
        expected = self.value(one.expected, one.angle)
        off = f"{start}: off by {show(abs(value - expected))} {unit}"
        return Words(start, off, f"{start}: {show(value)} {unit}, expected {show(expected)} {unit}")


def _moving_types(robot: Robot) -> str:
    """The types of the joints that move, those that hang on others too."""
    return "".join(row.type.letter for row in robot.rows if row.moves)


def _numbers(joints: list[int]) -> str:
    return f" ({or_list(list(map(str, joints))).replace(' or ', ' and ')})" if joints else ""
