"""Answered Jacobians as items."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from robokin.arrays import Array, Flags
from robokin.cli.arguments import in_units, joint_factors
from robokin.cli.check_poses import matrix_argument
from robokin.cli.check_rows import NoAnswerError
from robokin.cli.checks import PASS, Item
from robokin.cli.output.numbers import show
from robokin.cli.targets import LEVEL, flat_arm
from robokin.grading.feedback import Words, alike, joined
from robokin.grading.mistakes import FRAME, ROW_ORDER, SIGN, TRANSPOSED, Mistake, loosened, unit_readings
from robokin.grading.tolerance import Tolerance
from robokin.kinematics.jacobian import jacobian
from robokin.model import Robot
from robokin.units import Units

ROWS = ("vx", "vy", "vz", "wx", "wy", "wz")
IN_PLANE = {3: [0, 1, 5], 2: [0, 1]}
"""The rows that a lecture writes of an arm in the plane of x and y, by their number: vx, vy, wz, or vx, vy."""


@dataclass(frozen=True, eq=False)
class JacobianTask:
    """An answered Jacobian for q (n,) [rad | m], as it was typed; frame: base or tool."""

    text: str
    q: Array
    frame: str
    id: str = "1"
    student: str | None = None
    line: int | None = None


@dataclass(frozen=True, eq=False)
class Rows:
    """Which of the six rows a Jacobian has; scale: (rows, n) SI in one unit of its entries."""

    rows: list[int]
    scale: Array

    def of(self, J: Array) -> Array:
        """Its rows of a Jacobian (6, n)."""
        return J[self.rows]


@dataclass(frozen=True, eq=False)
class JacobianCheck:
    """What Jacobians are marked against."""

    robot: Robot
    units: Units
    allowed: Tolerance

    def mark(self, task: JacobianTask) -> tuple[Item]:
        """The mark of a 6×n matrix; its score is the part of the columns that are right.

        Of an arm in the plane of x and y the rows vx, vy, wz or vx, vy alone will do. Linear entries of turning joints
        are lengths (for a radian), all others pure numbers, which may be off by the angle tolerance in radians. Raises
        InputError for what cannot be read.
        """
        robot, units, allowed = self.robot, self.units, self.allowed
        J = jacobian(robot, task.q, "tool" if task.frame == "tool" else "base")
        scale = np.ones((6, robot.n))
        scale[:3, robot.revolute] = units.metres
        more: dict[str, Any] = {"q": in_units(task.q, joint_factors(robot, units)).tolist(), "frame": task.frame}
        zero = flat_arm(robot)
        upright = zero is not None and (task.frame == "base" or abs(zero[2, 2]) > 1.0 - LEVEL)
        shapes = [(6, robot.n), *((count, robot.n) for count in IN_PLANE if upright)]
        try:
            given = matrix_argument(task.text, shapes, units)
        except NoAnswerError as wrong:
            expected = (J / scale + 0.0).tolist()
            nothing: dict[str, float | None] = {"linear": None, "angular": None}
            return (Item(task.id, wrong.status, 0.0, expected, None, nothing, Words(own=wrong.detail), more=more),)
        rows = IN_PLANE.get(len(given), list(range(6)))
        part = Rows(rows, scale[rows])
        J, scale = part.of(J), part.scale
        given = given * scale
        expected = (J / scale + 0.0).tolist()
        right = _right(J, given, rows, robot, allowed)
        off = np.abs(given - J)
        linear = np.array(rows) < 3
        errors: dict[str, float | None] = {
            "linear": float(np.max(off[linear] / scale[linear], initial=0.0)),
            "angular": float(np.max(off[~linear], initial=0.0)) if len(rows) > 2 else None,
        }
        got = (given / scale).tolist()
        if right.all():
            return (Item(task.id, PASS, 1.0, expected, got, errors, more=more),)
        wrong_entries = np.argwhere(~right)
        i, k = wrong_entries[np.argmax((off / np.where(scale == 1.0, 1.0, allowed.size))[~right])]
        count = "1 entry" if len(wrong_entries) == 1 else f"{len(wrong_entries)} entries"
        found, wanted = show(given[i, k] / scale[i, k]), show(J[i, k] / scale[i, k])
        start = f"{count} wrong, the worst {ROWS[rows[i]]} of q{k + 1}"
        words = Words(start, f"{start}: off by {show(off[i, k] / scale[i, k])}", f"{start}: {found}, expected {wanted}")
        mistake = jacobian_mistake(robot, task, given, part, units, allowed)
        if mistake is not None:
            words = joined([words, alike(mistake.said)])
        score = float(np.mean(right.all(axis=0)))
        name = None if mistake is None else mistake.name
        return (Item(task.id, "wrong entries", score, expected, got, errors, words, more=more, mistake=name),)


def jacobian_mistake(
    robot: Robot, task: JacobianTask, given: Array, part: Rows, units: Units, allowed: Tolerance
) -> Mistake | None:
    """The known mistake in some rows of a wrong Jacobian (rows, n), or None."""
    whole = jacobian(robot, task.q, "tool" if task.frame == "tool" else "base")
    J, rows, scale, turning = part.of(whole), part.rows, part.scale, robot.revolute

    def right(J: Array, given: Array, allowed: Tolerance = allowed) -> bool:
        return bool(_right(J, given, rows, robot, allowed).all())

    other = "base" if task.frame == "tool" else "tool"
    if right(part.of(jacobian(robot, task.q, "tool" if other == "tool" else "base")), given):
        return Mistake(FRAME, f"this is the Jacobian in the {other} frame")
    if len(rows) == 6 and turning.all():
        swapped = np.concatenate([J[3:], J[:3]]) / np.concatenate([scale[3:], scale[:3]])
        if right(swapped * scale, given):
            return Mistake(ROW_ORDER, "the angular rows stand first, expected the linear ones first")
    # What is off by a little is in no other unit.
    near = right(J, given, loosened(allowed))
    linear = np.array(rows) < 3
    for mistake, meant in unit_readings(units, lengths=True, angles=True) if not near else ():
        again = given.copy()
        again[np.ix_(linear, turning)] *= meant.metres / units.metres
        if meant.angle != units.angle:
            # For a degree instead of for a radian, whatever the angles are shown in.
            again[:, turning] *= 180.0 / np.pi
        if right(J, again, loosened(allowed)):
            if meant.angle != units.angle:
                said = "right for a degree of each joint, expected for a radian"
                return Mistake(mistake.name, said if meant.length == units.length else f"{said}; and in {meant.length}")
            return mistake
    if right(-J, given):
        return Mistake(SIGN, "right with the sign of each entry reversed")
    if len(rows) == robot.n and right(J.T, given / scale):
        return Mistake(TRANSPOSED, "this is the transposed matrix, expected a column for each joint")
    return None


def _right(J: Array, given: Array, rows: list[int], robot: Robot, allowed: Tolerance) -> Flags:
    """(len(rows), n) which entries are within the tolerance; rows: which of the six rows J has."""
    right = np.zeros(J.shape, dtype=bool)
    for i, k in np.ndindex(J.shape):
        test = allowed.allows_position if rows[i] < 3 and robot.revolute[k] else allowed.allows_angle
        right[i, k] = test(float(abs(given[i, k] - J[i, k])), float(J[i, k]))
    return right
