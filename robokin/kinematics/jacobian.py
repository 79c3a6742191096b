"""The geometric Jacobian."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from robokin.arrays import Array, combined
from robokin.expected import expect_choice
from robokin.jobs.shared_rows import by_threads
from robokin.kernel.chain import chain_of
from robokin.kernel.facts import fact
from robokin.kernel.frames import program_to_joints
from robokin.kernel.geometric_jacobian import fill_jacobians
from robokin.kernel.geometric_jacobian import jacobian as chain_jacobian
from robokin.kernel.native_kernel import native
from robokin.kernel.straight_line import Straight, straight_jacobian
from robokin.kinematics.at_once import ALONE, jacobian_at_once, keep_at_once
from robokin.kinematics.code_at_once import JACOBIAN, keep_code
from robokin.kinematics.forward import SHARE, joint_motions, threads_wanted
from robokin.model import CoupledRobot, Robot

BASE = "base"
"""The axes of a plain call."""


def jacobian(robot: Robot, q: ArrayLike, frame: Literal["base", "tool"] = "base", cores: int | None = 1) -> Array:
    """The geometric Jacobian J: twist of the tool = J · dq/dt, linear part before angular part.

    q: (..., n) [rad | m]. Returns (..., 6, n) [m/rad | 1, 1 | 0]. The twist is that of the tool's
    origin, in the axes of the world (`base`) or of the tool (`tool`). A revolute joint about z through
    o gives the column (z × (p - o), z), a prismatic one (z, 0); a variable that moves several joints the sum of theirs.
    cores: threads that share a large batch, all usable cores for None; the numbers are the same.
    Raises InputError when q has another length than n, for another frame, and for less than one core.
    Source: B. Siciliano et al., Robotics: Modelling, Planning and Control, 2009, eq. (3.30).
    """
    if cores is ALONE and frame is BASE:
        known: Array | None = jacobian_at_once(robot, q)
        if known is not None:
            return known
    if type(frame) is not str or frame != "base":
        expect_choice(frame, ("base", "tool"), "frame")
    q, moving = joint_motions(robot, q)
    cores = threads_wanted(cores)
    keep_at_once(robot)
    J = _at_one(moving, q, frame) if native is None and q.ndim == 1 else None
    if J is None and cores == 1:
        J = chain_jacobian(chain_of(moving), q, frame)
    elif J is None:
        chain = chain_of(moving)
        J = by_threads(lambda part, out: fill_jacobians(chain, part, frame, out), q, (6, moving.n), SHARE, cores)
    return combined(J, robot.drive.S) if isinstance(robot, CoupledRobot) else J


def _at_one(robot: Robot, q: Array, frame: str) -> Array | None:
    """J (6, n) at one configuration, if there is code for the robot and all angles are finite."""
    one = _straight(robot, frame)
    if one is None:
        return None
    if frame == BASE:
        keep_code(JACOBIAN, robot, one)
    try:
        columns = one(q.tolist())
    except ValueError:
        return None
    if frame == "base":
        return columns.T
    turned = np.empty((robot.n, 6))
    R = columns[robot.n :].reshape(12)[:9].reshape(3, 3)
    for part in (slice(3), slice(3, 6)):
        np.matmul(columns[: robot.n, part], R, out=turned[:, part])
    return turned.T


@fact
def _straight(robot: Robot, frame: str) -> Straight | None:
    return straight_jacobian(program_to_joints(chain_of(robot)), frame == "tool")
