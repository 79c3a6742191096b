"""Rows of joint values: how the columns of a robot's joints may be called."""

from __future__ import annotations

from collections.abc import Sequence

from robokin.errors import shown
from robokin.model import Robot, Tree
from robokin.tables.headings import MAX_NAMES, FoundColumns, Way, find, refused
from robokin.tables.wanted_columns import Wanted
from robokin.units import Units

NUMBERED = ("q", "joint", "theta", "j", "axis")
"""What may stand before the number of a joint, counted from 1, with an underscore between or without."""


class JointColumns(Wanted):
    """The joint values of a robot, in its own order."""

    key = "q"

    def __init__(self, robot: Robot | Tree, units: Units) -> None:
        self.robot, self.units = robot, units
        self.what = f"one for each joint of {robot.name} ({robot.types})"
        kinds = "".join("a" if turns else "l" for turns in robot.revolute)
        ways = []
        for word in NUMBERED:
            columns = tuple((f"{word}{i}", f"{word}_{i}") for i in range(1, robot.n + 1))
            ways.append(Way(columns, kinds, numbered=word))
        names = Way(tuple((joint.name,) for joint in robot.joints), kinds)
        if len({*names.names}) == robot.n:
            ways.insert(1, names)
        self.ways = tuple(ways)

    def headed(self, headings: Sequence[str]) -> FoundColumns:
        """Where the joints stand below some headings. Raises InputError that lists what is allowed."""
        found = find(self.ways, headings, self.units)
        if found is None:
            first, last = (self.ways[0].names[i] for i in (0, -1))
            expected = f"{', '.join(self.ways[0].names)} (or joint_1, theta1, … in place of {first} to {last})"
            own = [joint.name for joint in self.robot.joints]
            if not all(map(str.isdecimal, own)):
                expected += f", or the joints' names: {shown(', '.join(own), MAX_NAMES)}"
            raise refused(headings, expected)
        return found

    def bare(self, count: int) -> Way:
        """The joints in their order."""
        return self.ways[0]
