"""Tables as items: is it the same robot, and if not, where does it begin to differ?"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from robokin.cli.arguments import in_units, joint_factors
from robokin.cli.checks import PASS, Item
from robokin.cli.output.numbers import show
from robokin.cli.submissions import Submission, read_plain_file
from robokin.errors import DescriptionError, InputError, did_you_mean, or_list, shown
from robokin.formats.library import load_any
from robokin.formats.read import MAX_BYTES, read_bytes
from robokin.grading.differences import Difference, difference_of
from robokin.grading.feedback import Words, alike, joined
from robokin.grading.mistakes import Mistake
from robokin.grading.same_robot import OPEN, Comparison, compare_tables
from robokin.grading.table_mistakes import table_mistake
from robokin.grading.tolerance import Tolerance
from robokin.grading.wrong_cells import Cell, wrong_cells
from robokin.model import Mechanism, Robot, WheeledBase
from robokin.units import Units

UNREADABLE, NO_ROBOT, OTHER_JOINTS, DIFFERENT = "unreadable", "no robot", "other joints", "different"

NOTHING: dict[str, Any] = {"needs": None, "differences": [], "zeros": None, "signs": None, "cells": []}
"""What is said of a table that could not be compared."""

SAID = {
    "base": "the base stands elsewhere",
    "tool": "the tool is another frame",
    "zero": "joints have another zero",
    "sign": "joints turn the other way",
}
"""What each of `OPEN` means where it is all that differs."""


def _reason(error: InputError) -> str:
    """Why a table cannot be read, on one line: the first mistake."""
    return error.sentence if isinstance(error, DescriptionError) else str(error)


def open_parts(text: str | None) -> frozenset[str]:
    """What --up-to leaves open. Raises InputError."""
    if text is None:
        return frozenset()
    names = [name.strip().lower() for name in text.replace(" ", ",").split(",") if name.strip()]
    if names == ["all"]:
        return frozenset(OPEN)
    for name in names:
        if name not in OPEN:
            hint = did_you_mean(name, OPEN)
            raise InputError(
                f"--up-to: found '{shown(name)}', expected some of {', '.join(OPEN)} with commas, or all{hint}"
            )
    return frozenset(names)


@dataclass(frozen=True, eq=False)
class TableCheck:
    """What tables are marked against. `free` is left open; lengths and angles are shown in `units`."""

    robot: Robot
    units: Units
    allowed: Tolerance
    free: frozenset[str]
    alone: bool = False

    def mark(self, submission: Submission) -> tuple[Item]:
        """The mark of a table. Raises InputError for one that cannot be read if it is the only one."""
        try:
            given = self.read(submission)
        except InputError as error:
            if self.alone:
                raise
            return (self.none(submission, UNREADABLE, _reason(error)),)
        if not isinstance(given, Robot):
            if self.alone:
                raise InputError(f"{submission.place} is no robot, expected a table of joints")
            return (self.none(submission, NO_ROBOT, "expected a table of joints"),)
        found = compare_tables(self.robot, given, self.allowed, self.free)
        mistake: Mistake | None = None
        cells: tuple[Cell, ...] = ()
        if not found.same:
            mistake = table_mistake(self.robot, given, self.allowed, self.free)
        name = None if mistake is None else mistake.name
        name = None if mistake is None else mistake.name
        if found.match is None:
            words = joined([_known(mistake), self.other_joints(given)])
            item = self.none(submission, OTHER_JOINTS, "")
            return (replace(item, got=given.types, words=words, mistake=name),)
        if not found.same and mistake is None:
            cells = wrong_cells(self.robot, given, self.allowed, self.free)
        differences = [difference_of(one, self.allowed) for one in found.differences]
        status = PASS if found.same else DIFFERENT
        words = joined([_known(mistake), self.words(found, differences, cells)])
        more = self.more(found, differences, cells)
        return (
            Item(submission.id, status, found.score, self.robot.types, given.types, {}, words, more=more, mistake=name),
        )

    def read(self, submission: Submission) -> Robot | Mechanism | WheeledBase:
        """What was handed in. Raises InputError."""
        if submission.path is None:
            return load_any(submission.place)
        path = submission.path
        data = read_plain_file(path, submission.follow, MAX_BYTES + 1)
        return read_bytes(data, path)

    def none(self, submission: Submission, status: str, detail: str) -> Item:
        """The mark of what cannot be compared."""
        return Item(submission.id, status, 0.0, self.robot.types, None, {}, Words(own=detail), more=dict(NOTHING))

    def more(self, found: Comparison, differences: list[Difference], cells: tuple[Cell, ...]) -> dict[str, Any]:
        """What would have to be left open, the differences, and how the joints of the two go with each other."""
        zeros = signs = None
        if found.needs is not None and found.match is not None:
            zeros = in_units(self.zeros(found), joint_factors(self.robot, self.units)).tolist()
            signs = list(found.match.state.signs)
        return {
            "needs": None if found.needs is None else list(found.needs),
            "differences": [
                {
                    "joint": one.joint, "what": one.what,
                    "found": self.value(one.found, one.angle), "expected": self.value(one.expected, one.angle),
                }
                for one in differences
            ],
            "zeros": zeros,
            "signs": signs,
            "cells": [
                {
                    "row": one.row, "column": one.column,
                    "found": self.value(one.found, one.angle), "expected": self.value(one.expected, one.angle),
                }
                for one in cells
            ],
        }  # fmt: skip

    def zeros(self, found: Comparison) -> Any:
        """(n,) the shifts c of q' = s (q + c) [rad | m], without the dust that the comparison leaves."""
        assert found.match is not None
        zeros = found.match.zeros
        small = np.where(self.robot.revolute, self.allowed.angle, self.allowed.position)
        return np.where(np.abs(zeros) <= small, 0.0, zeros)

    def value(self, value: float | None, angle: bool) -> float | None:
        """A value in the units."""
        if value is None:
            return None
        return float(in_units(np.asarray(value), self.units.radians if angle else self.units.metres))

    # Words ------------------------------------------------------------------------------------------------

    def other_joints(self, given: Robot) -> Words:
        """Where the joints' types differ."""
        if given.n != self.robot.n:
            answer = f"{given.n} joints ({given.types}), expected {self.robot.n} ({self.robot.types})"
            return Words("the number of joints", f"{given.n} joints are not the right number", answer)
        i = next(i for i, (a, b) in enumerate(zip(given.types, self.robot.types, strict=True), start=1) if a != b)
        names = {"R": "revolute", "P": "prismatic"}
        answer = f"joint {i} is {names[given.types[i - 1]]}, expected {names[self.robot.types[i - 1]]}"
        return Words(f"the type of joint {i}", f"the type of joint {i}", answer)

    def words(self, found: Comparison, differences: list[Difference], cells: tuple[Cell, ...]) -> Words:
        """What is wrong, in a sentence."""
        if found.same:
            return Words()
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

    def cell(self, one: Cell) -> Words:
        """A wrong cell in a sentence."""
        unit = self.units.angle if one.angle else self.units.length
        found, expected = (self.value(value, one.angle) or 0.0 for value in (one.found, one.expected))
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
        value, expected = self.value(one.found, one.angle), self.value(one.expected, one.angle)
        assert value is not None
        start = one.what if one.joint is None else f"joint {one.joint}: {one.what}"
        if expected is None:
            far = f"{start}: off by {show(value)} {unit}"
            return Words(start, far, far)
        off = f"{start}: off by {show(abs(value - expected))} {unit}"
        return Words(start, off, f"{start}: {show(value)} {unit}, expected {show(expected)} {unit}")


def _known(mistake: Mistake | None) -> Words:
    return Words() if mistake is None else alike(mistake.said)


def _numbers(joints: list[int]) -> str:
    return f" ({or_list(list(map(str, joints))).replace(' or ', ' and ')})" if joints else ""
