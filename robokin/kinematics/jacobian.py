"""The geometric Jacobian."""

from __future__ import annotations

from typing import Literal

from numpy.typing import ArrayLike

from robokin.arrays import Array
from robokin.expected import expect_choice
from robokin.kernel.chain import chain_of
from robokin.kernel.geometric_jacobian import jacobian as chain_jacobian
from robokin.kinematics.forward import joint_motions
from robokin.model import CoupledRobot, Robot


def jacobian(robot: Robot, q: ArrayLike, frame: Literal["base", "tool"] = "base") -> Array:
    """The geometric Jacobian J: twist of the tool = J · dq/dt, linear part before angular part.

    q: (..., n) [rad | m]. Returns (..., 6, n) [m/rad | 1, 1 | 0]. The twist is that of the tool's
    origin, in the axes of the world (`base`) or of the tool (`tool`). A revolute joint about z through
    o gives the column (z × (p - o), z), a prismatic one (z, 0); a variable that moves several joints the sum of theirs.
    Raises InputError when q has another length than n, and for another frame.
    Source: B. Siciliano et al., Robotics: Modelling, Planning and Control, 2009, eq. (3.30).
    """
    expect_choice(frame, ("base", "tool"), "frame")
    q, moving = joint_motions(robot, q)
    J = chain_jacobian(chain_of(moving), q, frame)
    return J @ robot.drive.S if isinstance(robot, CoupledRobot) else J
