"""Arms that move in the plane of x and y."""

from __future__ import annotations

import numpy as np

from robokin.arrays import Array
from robokin.model import Robot
from robokin.spatial import rotation_from_rpy, transform

LEVEL = 1e-9
"""Metres, and sines of an angle: what differs by less lies at one height."""


def flat_arm(robot: Robot) -> Array | None:
    """The pose (4, 4) [m] at zero of a planar arm that moves in the plane of x and y, None for all others."""
    from robokin.kinematics.forward import forward_kinematics
    from robokin.kinematics.structure import structure_of

    if structure_of(robot).arm != "planar":
        return None
    # The arm's height and the tilt of its end effector are the same at every configuration.
    zero, ones = forward_kinematics(robot, np.array([np.zeros(robot.n), np.ones(robot.n)]))
    tilted = abs(zero[2, 3] - ones[2, 3]) > LEVEL or np.max(np.abs(zero[2, :3] - ones[2, :3])) > LEVEL
    return None if tilted else zero


def upright_tool(zero: Array) -> bool:
    """Whether the x axis of the end effector of an arm with this pose (4, 4) at zero has no angle in the plane."""
    return bool(np.hypot(zero[0, 0], zero[1, 0]) < LEVEL)


def planar_pose(zero: Array, p: Array, phi: float | Array | None) -> Array:
    """Poses (..., 4, 4) [m] at p: (..., 2) x, y [m] in the plane of an arm whose pose at zero (4, 4) is `zero`.

    phi: the angles (...) [rad] of the end effector's x axis to x; None leaves its orientation as it is at zero.
    """
    R = zero[:3, :3]
    if phi is not None:
        yaw = np.asarray(phi - np.arctan2(zero[1, 0], zero[0, 0]))
        R = rotation_from_rpy(np.stack([np.zeros_like(yaw), np.zeros_like(yaw), yaw], axis=-1)) @ R
    height = np.full((*p.shape[:-1], 1), zero[2, 3])
    return transform(R, np.concatenate([p, height], axis=-1))
