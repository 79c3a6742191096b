"""Names for the matrices of a robot whose joints hang on each other, in symbols of what is typed.

A joint's value is Σ ratio · q + offset of the variables (`Drive`). Where the ratios are 1 and -1 and the offset whole
quarter turns, the cosine and the sine are of that sum itself, so that the forearm that a controller holds against the
horizontal, q3 - q2, behind the upper arm's q2 gives c3. Any other sum is a definition: theta4 = 0.6667 q3 + 5.
"""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np

from robokin.derivation.angle_sums import Angle, NamedAngle, Trigonometry
from robokin.derivation.symbol_names import Names, in_unit, labels_of, quarters_of
from robokin.derivation.symbol_sums import LEAD, TRAIL, Sum, number, symbol, times, total
from robokin.derivation.written_sums import written
from robokin.model import CoupledRobot, Joint, Robot
from robokin.model.graph import NO_LIMITS
from robokin.units import Units


class CoupledNames(Names):
    """See `Names`; the rows are those of `free_motion`, of which a helical joint has two with one label."""

    def __init__(self, robot: CoupledRobot, units: Units, numbers: bool) -> None:
        super().__init__(robot.free_motion, units, numbers)
        self.drive = robot.drive
        rows = tuple(replace(row, pitch=0.0, motion_limits=NO_LIMITS) for row in robot.rows)
        whole = Robot(robot.name, rows, robot.convention)
        labels = labels_of(whole)
        self.labels = tuple(
            label for label, row in zip(labels, robot.rows, strict=True) for _ in range(1 + bool(row.pitch))
        )
        self.trigonometry = Trigonometry(any(len(label) > 1 for label in (*self.labels, str(robot.n))))
        moving = iter(range(len(self.drive.offsets)))
        self.moves = [next(moving) if row.moves else -1 for row in self.robot.rows]
        self.angles = [self._angle(k, robot) for k in range(robot.n)]
        self.kinds = robot.revolute

    def _angle(self, k: int, robot: CoupledRobot) -> NamedAngle:
        """Variable k, from 0, as an angle; its place is that of the first row that it moves, or of its own joint."""
        names = [row.name for row in self.robot.rows]
        own = robot.joints[k].name
        first = names.index(own) if own in names else int(np.flatnonzero(self.drive.S[:, k])[0])
        return NamedAngle(first + 1, str(k + 1), f"q{k + 1}")

    def variable(self, joint: Joint, i: int) -> Sum:
        """The length of a sliding row: what moves it, with its offset."""
        text = self._told(joint, i)
        name = self._free("d" + self.labels[i])
        self.definitions[name] = text
        return symbol(name, TRAIL, i + 1)

    def turn(self, joint: Joint, i: int) -> Angle:
        """The angle of a turning row, a sum of variables where it is one."""
        ratios = self.drive.S[self.moves[i]] * joint.sense
        quarters = quarters_of(joint.offset + joint.sense * float(self.drive.offsets[self.moves[i]]))
        if quarters is not None and np.all(np.isin(ratios, (-1.0, 0.0, 1.0))) and np.all(self.kinds[ratios != 0.0]):
            order = np.argsort(-ratios, kind="stable")  # what is taken away comes last
            parts = tuple((self.angles[k], int(ratios[k])) for k in order.tolist() if ratios[k])
            return Angle(quarters, parts)
        name = self._free(f"theta{self.labels[i]}")
        self.definitions[name] = self._told(joint, i)
        return Angle(0, ((NamedAngle(i + 1, self.labels[i], name), 1),))

    def _told(self, joint: Joint, i: int) -> str:
        """A row's angle or length in the units, as a sum of variables."""
        turns = joint.type.letter == "R"
        unit = self.units.radians if turns else self.units.metres
        place = self.moves[i]
        terms = []
        for k in np.flatnonzero(self.drive.S[place]).tolist():
            ratio = joint.sense * float(self.drive.S[place, k])
            mine = self.units.radians if self.kinds[k] else self.units.metres
            worth = ratio if mine == unit else _tidied(ratio * mine / unit)
            terms.append(times(number(worth), symbol(f"q{k + 1}", LEAD, 0, k)))
        shift = joint.offset + joint.sense * float(self.drive.offsets[place])
        return written(total((*terms, number(in_unit(shift, unit)))))


def _tidied(ratio: float) -> float:
    """A ratio of two units without the last digit's dust, where it is one of whole numbers: 20 mm in 360 deg."""
    near = float(Fraction(ratio).limit_denominator(100_000))
    return near if abs(near - ratio) <= 8.0 * math.ulp(ratio) else ratio
