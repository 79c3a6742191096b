"""Joints that hang on others in another way than they should.

What each joint takes of what is typed is a row of S in v = S u + o (`Drive`). A variable has the place of its own joint
among the joints that move, so that rows can be compared whatever the joints are called.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array
from robokin.model import CoupledRobot, Robot

SAME_SHARE = 1e-6
"""Part of a ratio by which it may be off: 0.6666667 stands for 2/3."""


@dataclass(frozen=True)
class OtherCoupling:
    """A joint (from 1) with its shares in what is typed: found and expected, of joints (from 1) their ratios in SI.

    Joints beside the chain have the numbers after its own. pitches [m/rad]: the two advances of a helical joint, where
    it is these that differ.
    """

    joint: int
    found: tuple[tuple[int, float], ...]
    expected: tuple[tuple[int, float], ...]
    pitches: tuple[float, float] | None = None


def couplings_between(
    right: Robot, given: Robot, signs: Sequence[int], free: frozenset[str]
) -> tuple[OtherCoupling, ...]:
    """Where the joints of a given robot take other shares than those of the right one.

    Both have joints that move of the same types; signs: of each joint its sense against the right one.
    """
    a, b = _shares(right), _shares(given)
    width = max(a.shape[1], b.shape[1])
    a, b = (np.pad(S, ((0, 0), (0, width - S.shape[1]))) for S in (a, b))
    s = np.array(signs, dtype=np.float64)
    # What is typed may have another sense too: that of the joint that it moves.
    t = np.concatenate([s, np.ones(width - len(s))])
    for k in range(len(s), width) if "sign" in free else ():
        row = int(np.argmax(np.abs(a[:, k])))
        t[k] = -1.0 if b[row, k] * s[row] * a[row, k] < 0.0 else 1.0
    turned = s[:, None] * a * t
    other = np.max(np.abs(b - turned) - SAME_SHARE * np.abs(turned), axis=1, initial=0.0) > SAME_SHARE
    moving = [[row for row in robot.rows if row.moves] for robot in (right, given)]
    found = []
    for i, (one, two) in enumerate(zip(*moving, strict=True)):
        if other[i]:
            found.append(OtherCoupling(i + 1, _listed(b[i]), _listed(turned[i])))
        elif abs(two.pitch - one.pitch) > SAME_SHARE * abs(one.pitch):
            found.append(OtherCoupling(i + 1, (), (), (two.pitch, one.pitch)))
    return tuple(found)


def _shares(robot: Robot) -> Array:
    """(m, k) of each joint that moves its ratios to the variables, each in the column of its own joint."""
    moving = [row.name for row in robot.rows if row.moves]
    if not isinstance(robot, CoupledRobot):
        return np.eye(len(moving))
    S, _ = robot.row_values
    names = [joint.name for joint in robot.joints]
    beside = [name for name in names if name not in moving]
    columns = [*moving, *beside]
    shares = np.zeros((len(moving), len(columns)))
    shares[:, [columns.index(name) for name in names]] = S
    return shares


def _listed(row: Array) -> tuple[tuple[int, float], ...]:
    return tuple((int(k) + 1, float(row[k])) for k in np.flatnonzero(row))
