"""Self-motions of an answer of `robokin ik` as plain data."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from robokin.arrays import Array
from robokin.inverse.solutions import Arc, Family, Result
from robokin.model import Robot, Tree
from robokin.model.joint_units import in_units, joint_factors
from robokin.units import Units


def family_record(robot: Robot | Tree, units: Units, family: Family, result: Result) -> dict[str, Any]:
    """A self-motion in the JSON document; its solution counts from 1 as the list does."""
    return {
        "joints": list(family.joints),
        "dimension": family.dimension,
        "closed": family.closed,
        "solution": solution_number(family, result),
        "intervals": [_interval(robot, units, arc, family.joints) for arc in family.arcs],
    }


def _interval(robot: Robot | Tree, units: Units, arc: Arc, joints: Sequence[int]) -> dict[str, Any]:
    """An arc by its ends, and the minimum and the maximum of each joint that moves."""
    q = arc_values(robot, units, arc)
    ranges = {f"q{i}": [float(q[:, i - 1].min()), float(q[:, i - 1].max())] for i in joints}
    interval = {"whole": arc.whole, "from": q[0].tolist(), "to": q[-1].tolist(), "ranges": ranges}
    return interval if arc.swivel is None else {**interval, "swivel": [end / units.radians for end in arc.swivel]}


def arc_values(robot: Robot | Tree, units: Units, arc: Arc) -> Array:
    """The configurations (k, n) of an arc in the units."""
    return in_units(np.atleast_2d(arc.q), joint_factors(robot, units))


def solution_number(family: Family, result: Result) -> int | None:
    """Which of the listed solutions stands for a self-motion, from 1; None where none does."""
    return family.solution + 1 if is_within(family) and 0 <= family.solution < len(result.solutions) else None


def is_within(family: Family) -> bool:
    """Whether some of a self-motion is within the joint limits, where these count. Of a surface it is not known."""
    return bool(family.arcs) or family.dimension > 1


def moves_within(family: Family) -> bool:
    """Whether the joints can move within the limits: a curve may be within them in single configurations only."""
    return family.dimension > 1 or any(len(np.atleast_2d(arc.q)) > 1 for arc in family.arcs)
