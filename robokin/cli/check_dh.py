"""Tables as items: is it the same robot, and if not, where does it begin to differ?"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from robokin.cli.arguments import in_units, joint_factors
from robokin.cli.checks import PASS, Item
from robokin.cli.output.numbers import show
from robokin.description.library import load_any
from robokin.errors import InputError, did_you_mean, or_list, shown
from robokin.grading.differences import Difference, difference_of
from robokin.grading.same_robot import OPEN, Comparison, compare_tables
from robokin.grading.tolerance import Tolerance
from robokin.model import Robot
from robokin.units import Units

UNREADABLE, NO_ROBOT, OTHER_JOINTS, DIFFERENT = "unreadable", "no robot", "other joints", "different"

SAID = {
    "base": "the base stands elsewhere",
    "tool": "the tool is another frame",
    "zero": "joints have another zero",
    "sign": "joints turn the other way",
}
"""What each of `OPEN` means where it is all that differs."""


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

    def item(self, file: str, *, alone: bool) -> Item:
        """The mark of a table. Raises InputError for one that cannot be read if it is the only one."""
        label = Path(file).name
        try:
            given = load_any(file)
        except InputError as error:
            if alone:
                raise
            return Item(label, UNREADABLE, 0.0, self.robot.types, None, {}, str(error), more=self.nothing())
        if not isinstance(given, Robot):
            if alone:
                raise InputError(f"{file} is no robot, expected a table of joints")
            return Item(
                label, NO_ROBOT, 0.0, self.robot.types, None, {}, "expected a table of joints", more=self.nothing()
            )
        found = compare_tables(self.robot, given, self.allowed, self.free)
        if found.match is None:
            detail = self.other_joints(given)
            return Item(label, OTHER_JOINTS, 0.0, self.robot.types, given.types, {}, detail, more=self.nothing())
        differences = [difference_of(one, self.allowed) for one in found.differences]
        status = PASS if found.same else DIFFERENT
        return Item(
            label, status, found.score, self.robot.types, given.types, {}, self.detail(found, differences),
            more=self.more(found, differences),
        )  # fmt: skip

    def nothing(self) -> dict[str, Any]:
        """The keys of an item that could not be compared."""
        return {"needs": None, "differences": [], "zeros": None, "signs": None}

    def more(self, found: Comparison, differences: list[Difference]) -> dict[str, Any]:
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
                    "found": self.value(one.found, one), "expected": self.value(one.expected, one),
                }
                for one in differences
            ],
            "zeros": zeros,
            "signs": signs,
        }  # fmt: skip

    def zeros(self, found: Comparison) -> Any:
        """(n,) the shifts c of q' = s (q + c) [rad | m], without the dust that the comparison leaves."""
        assert found.match is not None
        zeros = found.match.zeros
        small = np.where(self.robot.revolute, self.allowed.angle, self.allowed.position)
        return np.where(np.abs(zeros) <= small, 0.0, zeros)

    def value(self, value: float | None, one: Difference) -> float | None:
        """A value in the units."""
        if value is None:
            return None
        return float(in_units(np.asarray(value), self.units.radians if one.angle else self.units.metres))

    # Words ------------------------------------------------------------------------------------------------

    def other_joints(self, given: Robot) -> str:
        """Where the joints' types differ."""
        if given.n != self.robot.n:
            return f"{given.n} joints ({given.types}), expected {self.robot.n} ({self.robot.types})"
        i = next(i for i, (a, b) in enumerate(zip(given.types, self.robot.types, strict=True), start=1) if a != b)
        names = {"R": "revolute", "P": "prismatic"}
        return f"joint {i} is {names[given.types[i - 1]]}, expected {names[self.robot.types[i - 1]]}"

    def detail(self, found: Comparison, differences: list[Difference]) -> str:
        """The verdict in a sentence."""
        if found.same:
            return ""
        first = self.sentence(differences[0]) if differences else ""
        if found.needs is None:
            more = len(differences) - 1
            return first + (f"; and {more} more" if more > 0 else "")
        said = [SAID[name] + self.which(name, found) for name in found.needs if name not in self.free]
        open_all = ",".join(name for name in OPEN if name in self.free or name in found.needs)
        return f"the same arm, but {' and '.join(said)}; --up-to {open_all} would let it pass ({first})"

    def which(self, name: str, found: Comparison) -> str:
        """The joints that a zero or a sense is about."""
        assert found.match is not None
        if name == "sign":
            return _numbers([i for i, sign in enumerate(found.match.state.signs, start=1) if sign < 0])
        if name == "zero":
            return _numbers([int(i) + 1 for i in np.flatnonzero(self.zeros(found))])
        return ""

    def sentence(self, one: Difference) -> str:
        """A difference as a sentence's part."""
        unit = self.units.angle if one.angle else self.units.length
        value, expected = self.value(one.found, one), self.value(one.expected, one)
        assert value is not None
        start = one.what if one.joint is None else f"joint {one.joint}: {one.what}"
        if expected is None:
            return f"{start}: off by {show(value)} {unit}"
        return f"{start}: {show(value)} {unit}, expected {show(expected)} {unit}"


def _numbers(joints: list[int]) -> str:
    return f" ({or_list(list(map(str, joints))).replace(' or ', ' and ')})" if joints else ""
