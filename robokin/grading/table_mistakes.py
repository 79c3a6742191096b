"""Known mistakes in a table: another convention, other units, and the like."""

from __future__ import annotations

from dataclasses import replace

from robokin.grading.mistakes import ANGLE_UNIT, BOTH_UNITS, LENGTH_UNIT, Mistake, table_readings
from robokin.grading.same_robot import Skeleton, match, skeleton_of
from robokin.grading.tolerance import Tolerance
from robokin.model import Robot

CUT = 1.8e-3
"""Radians by which a right angle that was cut in print, as 1.57, is off."""


def table_mistake(right: Robot, given: Robot, allowed: Tolerance, free: frozenset[str]) -> Mistake | None:
    """The known mistake in a table that is another robot; None where no reading makes it the right one."""
    wanted = skeleton_of(right)
    # What is off by a little has no other unit, only fewer digits.
    wide = replace(allowed, angle=max(allowed.angle, CUT))
    near = wanted.types == skeleton_of(given).types and match(wanted, skeleton_of(given), wide, free).same
    for mistake, meant in table_readings(given):
        skeleton = skeleton_of(meant)
        if skeleton.types != wanted.types:
            return None
        cut = mistake.name in (ANGLE_UNIT, BOTH_UNITS) and not near
        tolerance = wide if cut else allowed
        if match(wanted, skeleton, tolerance, free).same and not (
            mistake.name in (LENGTH_UNIT, BOTH_UNITS) and _without_lengths(wanted, meant, tolerance, free)
        ):
            return mistake
    return None


def _without_lengths(wanted: Skeleton, meant: Robot, allowed: Tolerance, free: frozenset[str]) -> bool:
    """Whether a table would be right without lengths: then one that is wrong is in no other unit, but too much."""
    rows = tuple(replace(row, a=0.0, d=0.0, offset=row.offset if row.type.letter == "R" else 0.0) for row in meant.rows)
    return match(wanted, skeleton_of(replace(meant, rows=rows)), allowed, free).same
