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

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np

from robokin.arrays import Array, Flags
from robokin.brief import Brief
from robokin.kernel.arm_size import axis_path
from robokin.kernel.facts import fact
from robokin.model import Joint, JointType, Robot, expect_uncoupled
from robokin.model.robot import row_constants
from robokin.spatial import exact, invert, translation_transform, z_to
from robokin.spatial.rotations import cos_sin

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


@fact
def chain_of(robot: Robot) -> Chain:
    """The chain of a robot, from its base to its tool.

    Raises InputError for a robot whose joints do not move one by one: of its `free_motion` it is asked.
    """
    part = expect_uncoupled(robot).graph.chain("base", "tool")
    start = (invert(part.constants[0]) @ part.base)[:3, 3]
    return near_the_arm(Chain(np.stack([exact(C) for C in part.constants]), robot.revolute, part.offsets, start))


@fact
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


def with_joints_at(chain: Chain, values: Mapping[int, float]) -> Chain:
    """The chain with some joints (from 0) standing at values [rad | m]: its joints are the others."""
    if not values:
        return chain
    constants = [chain.constants[0]]
    for i, C in enumerate(chain.constants[1:]):
        if i in values:
            at = _standing(bool(chain.revolute[i]), values[i] + float(chain.offsets[i]))
            constants[-1] = exact(constants[-1] @ at @ C)
        else:
            constants.append(C)
    rest = [i for i in range(chain.n) if i not in values]
    return Chain(np.stack(constants), chain.revolute[rest], chain.offsets[rest])


def with_joints(chain: Chain, axes: Sequence[int], revolute: Sequence[bool], G: Array | None = None) -> Chain:
    """The chain with joints after its own, about or along axes (0 to 2 for x, y, z) of the frame G (4, 4) in the tool.

    G is the tool's own frame if it is not given. The chain's tool is moved by the new joints.
    """
    if not axes:
        return chain
    start = np.eye(4) if G is None else G
    turned = [start @ z_to(np.eye(3)[axis]) for axis in axes]
    constants = [*chain.constants[:-1], chain.constants[-1] @ turned[0]]
    constants += [invert(before) @ after for before, after in pairwise(turned)]
    constants.append(invert(turned[-1]))
    return Chain(
        np.stack([exact(C) for C in constants]),
        np.concatenate([chain.revolute, np.array(revolute, dtype=bool)]),
        np.concatenate([chain.offsets, np.zeros(len(axes))]),
    )


def row_standing(row: Joint, value: float, convention: str) -> Joint:
    """A row as a fixed one, its joint standing at a value [rad | m]."""
    moved = row.offset + row.sense * value
    turns = row.type is JointType.REVOLUTE
    fixed = replace(row, type=JointType.FIXED, offset=0.0, limits=(-np.inf, np.inf), texts=(), sense=1)
    if convention != "frames":
        return replace(fixed, theta=row.theta + moved) if turns else replace(fixed, d=row.d + moved)
    before, after = row_constants(replace(row, sense=1), convention)
    return replace(fixed, origin=before @ _standing(turns, moved) @ after, axis=None)


def _standing(turns: bool, at: float) -> Array:
    """J (4, 4) of a joint that stands at a value [rad | m], exact at right angles."""
    if not turns:
        return translation_transform(np.array([0.0, 0.0, at]))
    c, s = cos_sin(at)
    J = np.eye(4)
    J[0, 0], J[0, 1], J[1, 0], J[1, 1] = c, -s, s, c
    return J
