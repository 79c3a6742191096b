"""A robot as an alternation of constant transforms and motions about or along z.

Every convention becomes T = C0 J1(q1) C1 J2(q2) … Jn(qn) Cn, where J is Rot(z, q + offset) or
Trans(0, 0, q + offset) and each C is a constant rigid transform. What follows (forward kinematics,
Jacobian, inverse kinematics) is written for this form alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from robokin.kinematics.dh import modified_dh, standard_dh
from robokin.model import Joint, JointType, Robot
from robokin.spatial import invert, rotation_transform

Array = NDArray[np.float64]

EXACT = 1e-15
"""An entry of a constant rotation this near to 0 or ±1 is meant to be just that: it is rounding of the
products of right angles (a few 1e-16). Exact entries cost no arithmetic later."""


@dataclass(frozen=True, eq=False)
class Chain:
    """C0 J1 C1 … Jn Cn.

    constants: (n + 1, 4, 4) [m]; revolute: (n,) bool; offsets: (n,) [rad | m].
    """

    constants: Array
    revolute: NDArray[np.bool_]
    offsets: Array

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
        offsets = np.array([joint.offset for joint in robot.joints])
        chain = _chains[robot] = Chain(np.stack([exact(C) for C in constants]), robot.revolute, offsets)
    return chain


def row_constants(row: Joint, convention: str) -> tuple[Array, Array]:
    """The constant transforms (4, 4) before and after the motion of one row, the motion being along z."""
    # The variable's own cell is 0 in the row, so that one formula serves every type of row.
    if convention == "standard":
        return np.eye(4), standard_dh(row.theta, row.d, row.a, row.alpha)
    if convention == "modified":
        return modified_dh(row.alpha, row.a, 0.0, 0.0), standard_dh(row.theta, row.d, 0.0, 0.0)
    origin = np.eye(4) if row.origin is None else row.origin
    if row.type is JointType.FIXED or row.axis is None:
        return origin, np.eye(4)
    A = z_to(tuple(float(part) for part in row.axis))
    return exact(origin @ A), invert(A)


@lru_cache(maxsize=64)
def z_to(axis: tuple[float, float, float]) -> Array:
    """A rotation (4, 4) that takes z to the given axis (x, y, z), of any length but zero."""
    u = np.array(axis) / np.linalg.norm(axis)
    normal = np.cross([0.0, 0.0, 1.0], u)
    angle = np.arctan2(np.linalg.norm(normal), u[2])
    return exact(rotation_transform(normal if np.any(normal) else [1.0, 0.0, 0.0], angle))


def exact(T: Array) -> Array:
    """T (4, 4) with entries of the rotation that are 0 or ±1 but for rounding made exactly that."""
    T = T.copy()
    R = T[:3, :3]
    whole = np.round(R)
    T[:3, :3] = np.where(np.abs(R - whole) <= EXACT, whole, R) + 0.0
    return T
