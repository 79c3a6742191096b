"""What kind of arm a robot is: its class, its wrist, the dimension of the poses it can reach.

All of it is read off the joint axes at one configuration chosen at random once and for all: what holds
there but for chance (axes parallel, meeting in a point, the Jacobian's rank) holds everywhere.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from robokin.arrays import Array
from robokin.kernel.chain import chain_of, chain_size
from robokin.kernel.facts import fact
from robokin.kinematics.forward import joint_frames
from robokin.kinematics.jacobian import jacobian
from robokin.model import CoupledRobot, Robot

SAME = 1e-6
"""Sines of angles, and distances as parts of the arm's size, below which axes are taken as parallel or
meeting: tables are printed to some five digits, and no real arm is so nearly special by chance."""


@dataclass(frozen=True)
class Structure:
    """The class of the arm, its wrist in words (or ""), and M, the dimension of the poses it can reach."""

    arm: str
    wrist: str
    joints: int
    dimension: int

    @property
    def redundancy(self) -> int:
        """R = N - M: how many joints could be held without losing anything."""
        return self.joints - self.dimension

    @property
    def holonomic(self) -> bool:
        """Whether the joints, each with a drive, suffice for all freedoms of what the arm reaches: N ≥ M."""
        return self.redundancy >= 0


@fact
def structure_of(robot: Robot) -> Structure:
    """The structure of a robot; joints, and the dimension, of one whose joints hang on others count its variables."""
    if isinstance(robot, CoupledRobot):
        joints = structure_of(robot.free_motion)
        return Structure(joints.arm, joints.wrist, robot.n, dimension_of(robot))
    axes = _Axes(robot)
    return Structure(_arm_class(robot.types, axes), _wrist(robot.types, axes), robot.n, dimension_of(robot))


class _Axes:
    """The joint axes at a generic configuration, directions z: (n, 3) and points o: (n, 3) on them."""

    def __init__(self, robot: Robot) -> None:
        frames = joint_frames(robot, generic_values(robot))
        self.z, self.o = frames[:-1, :3, 2], frames[:-1, :3, 3]
        self.size = arm_size(robot)

    def parallel(self, *joints: int) -> bool:
        """Whether the axes have one direction."""
        crosses = np.cross(self.z[list(joints)], self.z[joints[0]])
        return bool(np.max(np.linalg.norm(crosses, axis=1)) < SAME)

    def perpendicular(self, i: int, j: int) -> bool:
        """Whether two axes are at right angles."""
        return bool(abs(self.z[i] @ self.z[j]) < SAME)

    def concurrent(self, *joints: int) -> bool:
        """Whether the axes meet in one point: the least squares point lies on all of them, and no two neighbours are
        one axis."""
        if any(self.parallel(*pair) for pair in pairwise(joints)):
            return False
        z, o = self.z[list(joints)], self.o[list(joints)]
        off = np.eye(3) - z[:, :, None] * z[:, None, :]
        point, _, rank, _ = np.linalg.lstsq(off.reshape(-1, 3), np.einsum("kij,kj->ki", off, o).ravel(), rcond=1e-9)
        distance = np.linalg.norm(np.einsum("kij,kj->ki", off, point - o), axis=1)
        return bool(rank == 3 and np.max(distance) < SAME * self.size)


def _arm_class(types: str, axes: _Axes) -> str:
    """The class by the first three joints, as the lectures sort them."""
    n, first = len(types), types[:3]
    if n == 0:
        return "none (no joints)"
    if set(types) == {"R"} and axes.parallel(*range(n)):
        return "planar"
    if n < 3:
        return "two joints" if n == 2 else "one joint"
    if first == "PPP":
        return "Cartesian"
    turning = [i for i in range(3) if types[i] == "R"]
    sliding = [i for i in range(3) if types[i] == "P"]
    if len(turning) == 1:
        along = [i for i in sliding if axes.parallel(turning[0], i)]
        across = [i for i in sliding if axes.perpendicular(turning[0], i)]
        return "cylindrical" if along and across else "general (R and 2 P)"
    if len(turning) == 2:
        if axes.parallel(0, 1, 2):
            return "SCARA"
        if axes.perpendicular(*turning) and axes.perpendicular(turning[1], sliding[0]):
            return "spherical"
        return "general (2 R and P)"
    if types[:4] == "RRRP" and axes.parallel(0, 1, 2, 3):
        return "SCARA"
    if n == 3 and axes.concurrent(0, 1, 2):
        return "spherical wrist"
    return "anthropomorphic"


def _wrist(types: str, axes: _Axes) -> str:
    n = len(types)
    if n < 5 or types[-2:] != "RR":
        return ""
    if n >= 6 and types[-3:] == "RRR":
        names = f"axes {n - 2}, {n - 1}, {n}"
        if axes.concurrent(n - 3, n - 2, n - 1):
            return f"spherical: {names} meet in one point"
        return f"not spherical: {names} do not meet in one point"
    return f"two axes, {n - 1} and {n}"


def dimension_of(robot: Robot) -> int:
    """The Jacobian's rank with lengths measured in the arm's size."""
    if not robot.n:
        return 0
    size = arm_size(robot)
    J = jacobian(robot, generic_values(robot))
    J[:3] /= size
    sliding = ~robot.revolute
    J[:, sliding] *= size
    if isinstance(robot, CoupledRobot):  # a ratio of a million is no reason to take the others for nothing
        J /= np.maximum(np.linalg.norm(J, axis=0), np.finfo(float).tiny)
    singular = np.linalg.svd(J, compute_uv=False)
    return int(np.sum(singular > SAME * singular[0]))


def generic_values(robot: Robot) -> Array:
    """Joint values (n,) [rad | m] at which nothing is special but by chance."""
    # An arbitrary seed; the values stay within ±60° and ±1 m, away from the stretched arm.
    return np.random.default_rng(20).uniform(-1.0, 1.0, robot.n)


def arm_size(robot: Robot) -> float:
    """The arm's size [m] (see `chain_size`)."""
    return chain_size(chain_of(robot.free_motion if isinstance(robot, CoupledRobot) else robot))
