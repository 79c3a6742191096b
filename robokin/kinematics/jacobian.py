"""The geometric Jacobian."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from robokin.arrays import Array
from robokin.expected import expect_choice
from robokin.kinematics.forward import joint_frames
from robokin.model import Robot


def jacobian(robot: Robot, q: ArrayLike, frame: Literal["base", "tool"] = "base") -> Array:
    """The geometric Jacobian J: twist of the tool = J · dq/dt, linear part before angular part.

    q: (..., n) [rad | m]. Returns (..., 6, n) [m/rad | 1, 1 | 0]. The twist is that of the tool's
    origin, in the axes of the world (`base`) or of the tool (`tool`). A revolute joint about z through
    o gives the column (z × (p - o), z), a prismatic one (z, 0).
    Source: B. Siciliano et al., Robotics: Modelling, Planning and Control, 2009, eq. (3.30).
    """
    expect_choice(frame, ("base", "tool"), "frame")
    F = joint_frames(robot, q)
    z, o = F[..., :-1, :3, 2], F[..., :-1, :3, 3]
    R, p = F[..., -1, :3, :3], F[..., -1, None, :3, 3]
    turns = robot.revolute[:, None]
    linear = np.where(turns, np.cross(z, p - o), z)
    angular = np.where(turns, z, 0.0)
    if frame == "tool":
        linear, angular = linear @ R, angular @ R
    return np.swapaxes(np.concatenate([linear, angular], axis=-1), -1, -2)
