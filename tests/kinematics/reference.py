"""Forward kinematics written a second time, as the definition says it: a product of 4×4 matrices."""

from __future__ import annotations

import numpy as np


def rot(axis, angle):
    """Rot(axis, angle) about a vector (3,), by the exponential of its skew matrix."""
    u = np.asarray(axis, dtype=float) / np.linalg.norm(axis)
    K = np.array([[0, -u[2], u[1]], [u[2], 0, -u[0]], [-u[1], u[0], 0]])
    T = np.eye(4)
    T[:3, :3] = np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K
    return T


def trans(x, y, z):
    T = np.eye(4)
    T[:3, 3] = x, y, z
    return T


def step(row, convention, value):
    """One row of the table at the joint value (0 for a fixed row)."""
    turns, slides = row.type == "revolute", row.type == "prismatic"
    shifted = value + row.offset
    if convention == "frames":
        T = row.origin
        if turns:
            return T @ rot(row.axis, shifted)
        return T @ trans(*(np.asarray(row.axis) * shifted)) if slides else T
    theta = shifted if turns else row.theta
    d = shifted if slides else row.d
    z = rot([0, 0, 1], theta) @ trans(0, 0, d)
    x = trans(row.a, 0, 0) @ rot([1, 0, 0], row.alpha)
    return z @ x if convention == "standard" else x @ z


def frames(robot, q):
    """Base, the frame after each row, and the tool's pose."""
    T = [np.array(robot.base)]
    values = iter(q)
    for row in robot.rows:
        T.append(T[-1] @ step(row, robot.convention, next(values) if row.type != "fixed" else 0.0))
    return [*T, T[-1] @ robot.tool]


def forward(robot, q):
    return frames(robot, q)[-1]
