"""A robot as an alternation of constant transforms and motions about or along z.

Every convention becomes T = C0 J1(q1) C1 J2(q2) … Jn(qn) Cn, where J is Rot(z, q + offset) or
Trans(0, 0, q + offset) and each C is a constant rigid transform. What follows (forward kinematics,
Jacobian, inverse kinematics) is written for this form alone. A variable that enters with the other sign turns the
frame of its joint by half a turn about x, and back: Rot(z, offset - q) = F Rot(z, q - offset) F, and so of a slide.

Each joint's frame may stand anywhere on its axis: moved along z it gives the same T. It stands where the table puts
it, unless that is far off the arm: calibrated tables of axes that are parallel but for 1e-4 rad put frames hundreds of
metres away, and lengths of 0.1 m would be differences of such numbers.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from weakref import WeakKeyDictionary

import numpy as np

from robokin.arrays import Array, Flags
from robokin.brief import Brief
from robokin.kernel.arm_size import axis_path
from robokin.model import Robot
from robokin.model.robot import row_constants
from robokin.spatial import exact, invert

FAR = 2.0
"""Frames that are farther from each other, in the arm's size and added up, than this are moved along their axes to the
arm. In tables that are written by hand it is less than 1.5: only offsets along parallel axes may go to and fro."""


@dataclass(frozen=True, eq=False, repr=False)
class Chain(Brief):
    """C0 J1 C1 … Jn Cn.

    constants: (n + 1, 4, 4) [m]; revolute: (n,) bool; offsets: (n,) [rad | m]; start: (3,) where the arm begins, the
    origin of its base, in the frame that the first joint starts from [m].
    """

    constants: Array
    revolute: Flags
    offsets: Array
    start: Array = field(default_factory=lambda: np.zeros(3))

    @property
    def n(self) -> int:
        """The number of joints."""
        return len(self.revolute)


_chains: WeakKeyDictionary[Robot, Chain] = WeakKeyDictionary()


def chain_of(robot: Robot) -> Chain:
    """The chain of a robot: base, rows and tool, constants between two joints multiplied out. Kept."""
    chain = _chains.get(robot)
    if chain is None:
        constants = [robot.base]
        for row in robot.rows:
            before, after = row_constants(row, robot.convention)
            constants[-1] = constants[-1] @ before
            if row.moves:
                constants.append(after)
            else:
                constants[-1] = constants[-1] @ after
        constants[-1] = constants[-1] @ robot.tool
        offsets = np.array([joint.offset for joint in robot.joints]) * robot.senses + 0.0  # no negative zeros
        start = (invert(constants[0]) @ robot.base)[:3, 3]
        chain = Chain(np.stack([exact(C) for C in constants]), robot.revolute, offsets, start)
        chain = _chains[robot] = near_the_arm(chain)
    return chain


def chain_size(chain: Chain) -> float:
    """The arm's size [m]: the lengths along and between its axes (see `arm_size`), or 1 where there are none."""
    return axis_path(chain.constants, chain.revolute, chain.offsets, chain.start)[0]


def near_the_arm(chain: Chain) -> Chain:
    """The chain with its joints' frames moved along their axes to the arm, if they stand far off."""
    size, shifts = axis_path(chain.constants, chain.revolute, chain.offsets, chain.start)
    if float(np.sum(np.linalg.norm(chain.constants[1:, :3, 3], axis=1))) <= FAR * size:
        return chain
    constants = chain.constants.copy()
    start = chain.start.copy()
    for i in range(chain.n):
        # A joint along or about z lets a shift along z pass; a slide lets every translation pass, and starts where the
        # joint before it does.
        shift = np.array([0.0, 0.0, shifts[i]])
        if not chain.revolute[i] and i > 0:
            shift = -constants[i, :3, :3].T @ constants[i, :3, 3]
        constants[i, :3, 3] += constants[i, :3, :3] @ shift
        constants[i + 1, :3, 3] -= shift
        if i == 0:
            start -= shift
    return Chain(constants, chain.revolute, chain.offsets, start)
