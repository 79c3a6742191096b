"""Joints, held joints and self-motions in words."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array
from robokin.inverse.solutions import Arc, Family, Result
from robokin.model import Robot, Tree
from robokin.number_text import show
from robokin.records.self_motion_records import arc_values, solution_number
from robokin.units import Units

DECIMALS = {"mm": 3, "cm": 3, "in": 4, "m": 5, "deg": 3, "rad": 5}
"""Decimals of a joint value: a hundredth of a millimetre or of a thousandth of a radian."""

STAYS = {
    "pose": "the pose stays",
    "approach": "the position and the direction of the tool's z axis stay",
    "position": "the position stays",
}
"""What does not change along a self-motion, by what was asked of the tool."""


def joined(words: Sequence[str]) -> str:
    """`a`, `a and b`, `a, b and c`."""
    return " and ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)


def joint_names(numbers: Sequence[int]) -> str:
    """`q4 and q6`, and more than two in a row as `q1 to q7`; numbers count from 1."""
    runs: list[list[int]] = []
    for i in numbers:
        if runs and i == runs[-1][-1] + 1:
            runs[-1].append(i)
        else:
            runs.append([i])
    return joined(
        [name for run in runs for name in ([f"q{run[0]} to q{run[-1]}"] if len(run) > 2 else [f"q{i}" for i in run])]
    )


def joints_can_move(numbers: Sequence[int], task: str) -> str:
    """`joints q4 and q6 can move while the pose stays`."""
    noun = "joint" if len(numbers) == 1 else "joints"
    return f"{noun} {joint_names(numbers)} can move while {STAYS[task]}"


@dataclass(frozen=True)
class FamilyWords:
    """Writes self-motions of a robot or a tree in units. `limits` tells whether the joint limits count."""

    robot: Robot | Tree
    units: Units
    limits: bool = True

    def lines(self, family: Family, result: Result, task: str) -> Iterator[str]:
        """What can move, and a line for each piece of it."""
        ways = f" in {family.dimension} independent ways" if family.dimension > 1 else ""
        number = solution_number(family, result)
        stands = f"; solution {number} stands for it" if number else ""
        yield f"self-motion: {joints_can_move(family.joints, task)}{ways}{stands}"
        for arc in family.arcs:
            yield f"  {self.piece(arc, family.joints)}"
        if family.dimension == 1 and not family.closed:
            yield "  it was not followed to its end: there may be more of it"

    def piece(self, arc: Arc, joints: Sequence[int]) -> str:
        """`q4 from -110 to 170 with q6 from 204 to -76`."""
        q = arc_values(self.robot, self.units, arc)
        decimals = [DECIMALS[self.units.angle if self.robot.revolute[i - 1] else self.units.length] for i in joints]
        columns = [np.round(q[:, i - 1], places) for i, places in zip(joints, decimals, strict=True)]
        if all(np.ptp(column) == 0.0 for column in columns):
            only = joined([f"q{i} = {_trimmed(column[0])}" for i, column in zip(joints, columns, strict=True)])
            return f"one configuration{' within the limits' if self.limits else ''}: {only}"
        first, *rest = [f"q{i} {_course(column)}" for i, column in zip(joints, columns, strict=True)]
        moves = f"{first} with {joined(rest)}" if rest else first
        if not arc.whole:
            return moves
        return f"a closed curve{', all of it within the limits' if self.limits else ''}: {moves}"


def _course(column: Array) -> str:
    """How a joint runs along an arc, column: (k,): from end to end, or where it turns back, between two values."""
    low, high = column.min(), column.max()
    if {column[0], column[-1]} == {low, high} and low < high:
        return f"from {_trimmed(column[0])} to {_trimmed(column[-1])}"
    if low == high:
        return f"at {_trimmed(low)}"
    return f"between {_trimmed(low)} and {_trimmed(high)}"


def _trimmed(value: float) -> str:
    """A rounded number without trailing zeros."""
    return f"{value + 0.0:.6f}".rstrip("0").rstrip(".")


def held_in_words(held: Mapping[int, float]) -> str:
    """`q3 held at 20`, or nothing; joints from 0, values in the units."""
    if not held:
        return ""
    at = {joint: show(value) for joint, value in sorted(held.items())}
    if len(set(at.values())) == 1 and len(at) > 1:
        return f"{joined([f'q{joint + 1}' for joint in at])} held at {next(iter(at.values()))}"
    return joined([f"q{joint + 1} held at {value}" for joint, value in at.items()])
