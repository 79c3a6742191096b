"""Known mistakes: what would make a wrong answer right, were it meant so.

Each function lists readings of an answer, or of the question, each with a name and a sentence. An answer has a known
mistake where one of them makes it right, within the tolerance; where none does, nothing is said. Chance makes a wrong
answer right so seldom (one reading of some thirty, each to a thousandth in all its dimensions) that naming it is
sound; lengths near zero, which are right in any unit, are left out.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from robokin.arrays import Array
from robokin.grading.tolerance import Tolerance
from robokin.kernel.facts import fact
from robokin.model import Joint, Robot
from robokin.spatial import invert
from robokin.units import METRES, Units

LENGTH_UNIT, ANGLE_UNIT, BOTH_UNITS = "length unit", "angle unit", "length and angle unit"
CONVENTION, ZERO, SIGN, TOOL, BASE = "convention", "zero", "sign", "tool", "base"
ROLL_YAW, ROTATION_ORDER, QUATERNION_ORDER = "roll and yaw", "order of rotations", "order of the quaternion"
INVERSE_ROTATION, INVERSE_POSE, ABSOLUTE = "inverse rotation", "inverse pose", "absolute angles"
FRAME, ROW_ORDER, TRANSPOSED = "frame", "order of rows", "transposed"

FEW_DIGITS = 3.0
"""So many times the tolerance is allowed to an answer read in another unit: its digits were meant for that one."""

ROUNDED = 1e-3
"""Sines of twists below this are those of parallel axes, the other way round as well."""

SURE = 20.0
"""A position this many tolerances from the origin is told from the same numbers in another unit."""


@dataclass(frozen=True)
class Mistake:
    """A known mistake: its name, and what would have to be meant for the answer to be right."""

    name: str
    said: str


def unit_readings(units: Units, *, lengths: bool, angles: bool) -> Iterator[tuple[Mistake, Units]]:
    """The units in which an answer may have been meant: another length unit, the other angle unit, or both."""
    angle = "rad" if units.degrees else "deg"
    others = [name for name in METRES if name != units.length] if lengths else []
    if angles:
        yield (
            Mistake(ANGLE_UNIT, f"right if its angles are in {angle}, expected {units.angle}"),
            units.override(angle=angle),
        )
    for name in others:
        yield Mistake(LENGTH_UNIT, f"right if its lengths are in {name}, expected {units.length}"), units.override(name)
        if angles:
            said = f"right if it is in {name} and {angle}, expected {units.length} and {units.angle}"
            yield Mistake(BOTH_UNITS, said), units.override(name, angle)


def loosened(allowed: Tolerance) -> Tolerance:
    """The tolerance for an answer that is read in another unit."""
    return replace(allowed, position=FEW_DIGITS * allowed.position, angle=FEW_DIGITS * allowed.angle)


def rotation_readings(T: Array) -> Iterator[tuple[Mistake, Array]]:
    """A pose (4, 4) with its rotation the other way, and the pose of the base in the end effector's frame."""
    turned = T.copy()
    turned[:3, :3] = T[:3, :3].T
    yield Mistake(INVERSE_ROTATION, "right with the transposed (inverse) rotation"), turned
    yield Mistake(INVERSE_POSE, "right as the inverse: this is the base in the frame of the end effector"), invert(T)


def joint_readings(robot: Robot, q: Array, units: Units, *, single: bool) -> list[tuple[Mistake, Array]]:
    """What joint values q (n,) [rad | m] may have been meant as, or taken for: (n,) [rad | m] each.

    In the other angle unit, with other signs, and as angles from the x axis in the plane. `single` also changes one
    joint alone, its sense or its zero: of a pose that says little, since many a wrong turn looks like it.
    """
    turning = robot.revolute
    n = robot.n
    factor = 1.0 / units.radians if units.degrees else np.pi / 180.0
    other = "rad" if units.degrees else "deg"
    found = []
    if turning.any():
        said = f"right if the angles of the joints are in {other}, expected {units.angle}"
        found.append((Mistake(ANGLE_UNIT, said), np.where(turning, q * factor, q)))
        found.append((Mistake(SIGN, "right with all joints the other way round"), np.where(turning, -q, q)))
    for i in np.flatnonzero(turning).tolist() if single else ():
        one = np.arange(n) == i
        found.append((Mistake(SIGN, f"right with joint {i + 1} the other way round"), np.where(one, -q, q)))
        said = f"right if joint {i + 1} counts from another zero"
        found += [(Mistake(ZERO, said), q + one * turn) for turn in (np.pi / 2.0, -np.pi / 2.0, np.pi)]
    if n > 1 and turning.all():
        said = "right if each angle is measured from the base instead of from the link before"
        found.append((Mistake(ABSOLUTE, said), np.diff(q, prepend=0.0)))
    return found


@fact
def robot_readings(robot: Robot) -> tuple[tuple[Mistake, Robot], ...]:
    """What a robot may have been taken for: the other convention, no offsets, no tool, no base."""
    return tuple(_robot_readings(robot))


def _robot_readings(robot: Robot) -> Iterator[tuple[Mistake, Robot]]:
    other = {"standard": "modified", "modified": "standard"}.get(robot.convention)
    if other is not None:
        said = f"right for the table read in the {other} convention, expected the {robot.convention} one"
        yield Mistake(CONVENTION, said), replace(robot, convention=other)  # type: ignore[arg-type]
    if any(row.offset for row in robot.rows):
        rows = tuple(replace(row, offset=0.0) for row in robot.rows)
        yield Mistake(ZERO, "right without the offsets of the joints"), replace(robot, rows=rows)
    if not np.array_equal(robot.tool, np.eye(4)):
        yield Mistake(TOOL, "right without the tool: this is the last frame"), replace(robot, tool=np.eye(4))
    if not np.array_equal(robot.base, np.eye(4)):
        yield Mistake(BASE, "right without the base: this is seen from frame 0"), replace(robot, base=np.eye(4))


def table_readings(robot: Robot) -> Iterator[tuple[Mistake, Robot]]:
    """What a table may have been meant as: the other convention, other units, twists the other way, a and d swapped."""
    if robot.convention == "frames":
        return
    other = "modified" if robot.convention == "standard" else "standard"
    said = f"right in the {other} convention, found the {robot.convention} one"
    yield Mistake(CONVENTION, said), replace(robot, convention=other)  # type: ignore[arg-type]
    units = robot.units
    for mistake, meant in unit_readings(units, lengths=True, angles=True):
        lengths, angles = meant.metres / units.metres, meant.radians / units.radians
        rows = tuple(_scaled(row, lengths, angles) for row in robot.rows)
        base, tool = (_stretched(T, lengths) for T in (robot.base, robot.tool))
        said = mistake.said.replace("expected", "found")
        yield Mistake(mistake.name, said), replace(robot, rows=rows, base=base, tool=tool)
        if lengths != 1.0 and not (np.array_equal(robot.base, base) and np.array_equal(robot.tool, tool)):
            yield Mistake(mistake.name, f"{said} (base and tool are right)"), replace(robot, rows=rows)
    # Of a single cell there are better words.
    if sum(abs(np.sin(row.alpha)) > ROUNDED for row in robot.rows) > 1:
        rows = tuple(replace(row, alpha=-row.alpha) for row in robot.rows)
        yield Mistake(SIGN, "right with the sign of each alpha reversed"), replace(robot, rows=rows)
    rows = tuple(replace(row, a=row.d, d=row.a) for row in robot.rows if row.type.letter != "P")
    if len(rows) == len(robot.rows) and sum(row.a != row.d for row in rows) > 1:
        yield Mistake("a and d", "right with the columns a and d exchanged"), replace(robot, rows=rows)


def _scaled(row: Joint, lengths: float, angles: float) -> Joint:
    """A row with its lengths and its angles times a factor each."""
    turns = row.type.letter == "R"
    return replace(
        row, a=row.a * lengths, d=row.d * lengths, alpha=row.alpha * angles, theta=row.theta * angles,
        offset=row.offset * (angles if turns else lengths),
    )  # fmt: skip


def _stretched(T: Array, factor: float) -> Array:
    """A transform with its translation times a factor."""
    stretched = T.copy()
    stretched[:3, 3] *= factor
    return stretched
