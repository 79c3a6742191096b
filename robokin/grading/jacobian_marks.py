"""Answered Jacobians as items."""

from __future__ import annotations

from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any, ClassVar

import numpy as np

from robokin.arrays import Array, Flags
from robokin.grading.feedback import Words, alike, joined
from robokin.grading.mark_items import Item
from robokin.grading.marking import AnswerTask, NoAnswerError, Subject
from robokin.grading.mistakes import FRAME, ROW_ORDER, SIGN, TRANSPOSED, Mistake, loosened, unit_readings
from robokin.grading.pose_difference import PASS
from robokin.grading.tolerance import Tolerance
from robokin.kinematics.flat_arm import LEVEL, flat_arm
from robokin.kinematics.jacobian import jacobian
from robokin.model import Robot
from robokin.number_text import show

ROWS = ("vx", "vy", "vz", "wx", "wy", "wz")
IN_PLANE = {3: [0, 1, 5], 2: [0, 1]}
"""The rows that a lecture writes of an arm in the plane of x and y, by their number: vx, vy, wz, or vx, vy."""

WRONG_ENTRIES = "wrong entries"


def jacobian_shapes(robot: Robot, frame: str = "base") -> list[tuple[int, int]]:
    """The shapes that an answer may have: six rows, and of an arm in the plane of x and y fewer will do."""
    zero = flat_arm(robot)
    upright = zero is not None and (frame == "base" or abs(zero[2, 2]) > 1.0 - LEVEL)
    return [(6, robot.n), *((count, robot.n) for count in IN_PLANE if upright)]


@dataclass(frozen=True, eq=False)
class JacobianCheck(Subject):
    """What Jacobians are marked against; frame: base or tool."""

    frame: str = "base"

    unsaid: ClassVar = MappingProxyType({"q": None, "frame": None})

    def mark(self, task: AnswerTask) -> tuple[Item]:
        """The mark of a matrix with some of the six rows; its score is the part of the columns that are right.

        Linear entries of turning joints are lengths (for a radian), all others pure numbers, which may be off by the
        angle tolerance in radians. Raises InputError for what cannot be read.
        """
        q = task.question()
        more = {"q": self.joints(q), "frame": self.frame}
        try:
            given = task.answers[0].read()
        except NoAnswerError as wrong:
            J, scale = self.right(q), self.scale(range(6))
            nothing = {"linear": None, "angular": None}
            words, expected = Words(own=wrong.detail), (J / scale + 0.0).tolist()
            return (task.item(wrong.status, 0.0, words, expected=expected, error=nothing, more=more),)
        rows = IN_PLANE.get(len(given), range(6))
        J, scale = self.right(q)[rows], self.scale(rows)
        given = given * scale
        off, right, linear = np.abs(given - J), self.within(J, given, rows), np.array(rows) < 3
        values: dict[str, Any] = {"expected": (J / scale + 0.0).tolist(), "got": (given / scale).tolist(), "more": more}
        values["error"] = {
            "linear": float(np.max((off / scale)[linear], initial=0.0)),
            "angular": float(np.max(off[~linear], initial=0.0)) if len(rows) > 2 else None,
        }
        if right.all():
            return (task.item(PASS, 1.0, Words(), **values),)
        wrong_entries = np.argwhere(~right)
        i, k = wrong_entries[np.argmax((off / np.where(scale == 1.0, 1.0, self.allowed.size))[~right])]
        count = "1 entry" if len(wrong_entries) == 1 else f"{len(wrong_entries)} entries"
        start = f"{count} wrong, the worst {ROWS[rows[i]]} of q{k + 1}"
        found, wanted, far = (show(value[i, k] / scale[i, k]) for value in (given, J, off))
        words = Words(start, f"{start}: off by {far}", f"{start}: {found}, expected {wanted}")
        item = task.item(WRONG_ENTRIES, float(np.mean(right.all(axis=0))), words, **values)
        mistake = self.mistake(q, given, rows)
        if mistake is None:
            return (item,)
        return (replace(item, words=joined([words, alike(mistake.said)]), mistake=mistake.name),)

    def right(self, q: Array, frame: str | None = None) -> Array:
        """(6, n) the right Jacobian at q: (n,) [rad | m], in the frame asked for or in another."""
        return jacobian(self.robot, q, "tool" if (frame or self.frame) == "tool" else "base")

    def scale(self, rows: Any) -> Array:
        """(rows, n) SI in one unit of the entries of some of the six rows."""
        scale: Array = np.ones((6, self.robot.n))
        scale[:3, self.robot.revolute] = self.units.metres
        return np.asarray(scale[rows])

    def within(self, J: Array, given: Array, rows: Any, allowed: Tolerance | None = None) -> Flags:
        """(rows, n) which given entries are within the tolerance, or another one; rows: which of the six they are."""
        allowed = allowed or self.allowed
        right = np.zeros(J.shape, dtype=bool)
        for i, k in np.ndindex(J.shape):
            test = allowed.allows_position if rows[i] < 3 and self.robot.revolute[k] else allowed.allows_angle
            right[i, k] = test(float(abs(given[i, k] - J[i, k])), float(J[i, k]))
        return right

    def mistake(self, q: Array, given: Array, rows: Any) -> Mistake | None:
        """The known mistake in a wrong answer (rows, n) with some of the six rows, or None."""
        J, scale, units, turning = self.right(q)[rows], self.scale(rows), self.units, self.robot.revolute

        def right(J: Array, given: Array, allowed: Tolerance | None = None) -> bool:
            return bool(self.within(J, given, rows, allowed).all())

        other = "base" if self.frame == "tool" else "tool"
        if right(self.right(q, other)[rows], given):
            return Mistake(FRAME, f"this is the Jacobian in the {other} frame")
        if len(rows) == 6 and turning.all():
            swapped = np.concatenate([J[3:], J[:3]]) / np.concatenate([scale[3:], scale[:3]])
            if right(swapped * scale, given):
                return Mistake(ROW_ORDER, "the angular rows stand first, expected the linear ones first")
        # What is off by a little is in no other unit.
        wide, linear = loosened(self.allowed), np.array(rows) < 3
        for mistake, meant in unit_readings(units, lengths=True, angles=True) if not right(J, given, wide) else ():
            again = given.copy()
            again[np.ix_(linear, turning)] *= meant.metres / units.metres
            if meant.angle != units.angle:
                # For a degree instead of for a radian, whatever the angles are shown in.
                again[:, turning] *= 180.0 / np.pi
            if right(J, again, wide):
                if meant.angle == units.angle:
                    return mistake
                said = "right for a degree of each joint, expected for a radian"
                return Mistake(mistake.name, said if meant.length == units.length else f"{said}; and in {meant.length}")
        if right(-J, given):
            return Mistake(SIGN, "right with the sign of each entry reversed")
        if len(rows) == self.robot.n and right(J, (given / scale).T * scale):
            return Mistake(TRANSPOSED, "this is the transposed matrix, expected a column for each joint")
        return None
