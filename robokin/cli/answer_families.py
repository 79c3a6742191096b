"""Self-motions of an answer of `robokin ik`: as plain data and in words."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from robokin.arrays import Array
from robokin.cli.arguments import in_units, joint_factors
from robokin.inverse.solutions import Arc, Family, Result
from robokin.model import Robot
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
    """Writes self-motions of a robot in units. `limits` tells whether the joint limits count."""

    robot: Robot
    units: Units
    limits: bool = True

    # Plain data -------------------------------------------------------------------------------------------

    def record(self, family: Family, result: Result) -> dict[str, Any]:
        """A self-motion in the JSON document; its solution counts from 1 as the list does."""
        return {
            "joints": list(family.joints),
            "dimension": family.dimension,
            "closed": family.closed,
            "solution": solution_number(family, result),
            "intervals": [self.interval(arc, family.joints) for arc in family.arcs],
        }

    def interval(self, arc: Arc, joints: Sequence[int]) -> dict[str, Any]:
        """An arc by its ends, and the minimum and the maximum of each joint that moves."""
        q = self.values(arc)
        return {
            "whole": arc.whole,
            "from": q[0].tolist(),
            "to": q[-1].tolist(),
            "ranges": {f"q{i}": [float(q[:, i - 1].min()), float(q[:, i - 1].max())] for i in joints},
        }

    def values(self, arc: Arc) -> Array:
        """The configurations (k, n) of an arc in the units."""
        return in_units(np.atleast_2d(arc.q), joint_factors(self.robot, self.units))

    # Words ------------------------------------------------------------------------------------------------

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
        q = self.values(arc)
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


def solution_number(family: Family, result: Result) -> int | None:
    """Which of the listed solutions stands for a self-motion, from 1; None where none does."""
    return family.solution + 1 if is_within(family) and 0 <= family.solution < len(result.solutions) else None


def is_within(family: Family) -> bool:
    """Whether some of a self-motion is within the joint limits, where these count. Of a surface it is not known."""
    return bool(family.arcs) or family.dimension > 1


def moves_within(family: Family) -> bool:
    """Whether the joints can move within the limits: a curve may be within them in single configurations only."""
    return family.dimension > 1 or any(len(np.atleast_2d(arc.q)) > 1 for arc in family.arcs)


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
