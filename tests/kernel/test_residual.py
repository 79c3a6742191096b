"""What a pose lacks of a target: one configuration, a handful and thousands say the same, and J is its derivative."""

from __future__ import annotations

import numpy as np
import pytest

import robokin
from robokin.kernel.chain import chain_of, chain_size
from robokin.kernel.residual import TargetPoses, error_and_jacobian
from robokin.spatial import rotation_from_axis_angle


def test_error_and_jacobian_of_few_and_of_many(rng):
    h = 1e-6
    for name in ("puma560", "panda", "stanford", "scara"):
        robot = robokin.load(name)
        chain, size = chain_of(robot), chain_size(chain_of(robot))
        scale = np.where(robot.revolute, 1.0, size)
        q = rng.uniform(-3, 3, (2100, robot.n))
        found, T = robokin.forward_kinematics(robot, q), robokin.forward_kinematics(robot, q[::-1])
        whole = error_and_jacobian(chain, T, q, size)
        for k in (0, 1, 40, 81):
            part = error_and_jacobian(chain, T[:k], q[:k], size)
            assert [array.shape for array in part] == [(k, 6), (k, 6, robot.n)]
            assert all(np.allclose(a, b[:k], rtol=0, atol=1e-9) for a, b in zip(part, whole, strict=True))
        e, J = whole
        assert np.allclose(e[:, :3] * size, T[:, :3, 3] - found[:, :3, 3], atol=1e-12)
        for i in range(0, 2100, 50):
            angle = np.linalg.norm(e[i, 3:])
            assert np.allclose(rotation_from_axis_angle(e[i, 3:], angle) @ found[i, :3, :3], T[i, :3, :3], atol=1e-6)
        for j in range(robot.n):
            ahead, behind = (robokin.forward_kinematics(robot, q + d * scale * np.eye(robot.n)[j]) for d in (h, -h))
            slope = (error_and_jacobian(chain, ahead, q, size)[0] - error_and_jacobian(chain, behind, q, size)[0]) / 2
            assert np.allclose(slope / h, J[:, :, j], atol=1e-7)
    half = robokin.forward_kinematics(robot, [0.0, 0.0, 0.0, np.pi])[None]
    e, _ = error_and_jacobian(chain, half, np.zeros((1, 4)), size)
    assert np.isclose(np.linalg.norm(e[0, 3:]), np.pi)


@pytest.mark.parametrize("shape", [(), (1,), (3,), (2, 3), (2, 50), (0,)])
def test_any_leading_shape(shape, rng):
    robot = robokin.load("stanford")
    chain = chain_of(robot)
    q, wished = rng.uniform(-3, 3, (2, *shape, 6))
    T = robokin.forward_kinematics(robot, wished)
    e, J = error_and_jacobian(chain, T, q, 2.0)
    assert (e.shape, J.shape) == ((*shape, 6), (*shape, 6, 6))
    for where in np.ndindex(shape):
        one = error_and_jacobian(chain, T[where], q[where], 2.0)
        assert np.allclose(one[0], e[where], rtol=0, atol=1e-12)
        assert np.allclose(one[1], J[where], rtol=0, atol=1e-12)


def test_distances_and_angles_are_the_lengths_of_the_error(rng):
    robot = robokin.load("stanford")
    chain, q = chain_of(robot), rng.uniform(-3, 3, (40, 6))
    index, ahead = rng.integers(0, 40, 60), 1e-6 * rng.normal(size=(60, 6))
    T = robokin.forward_kinematics(robot, q)
    values = q[index] + ahead
    e, _ = error_and_jacobian(chain, T[index], values, 1.0)
    position, angle = TargetPoses(chain, T).residuals(index, np.ascontiguousarray(values.T))
    assert np.allclose(position, np.linalg.norm(e[:, :3], axis=1), rtol=0, atol=1e-14)
    assert np.allclose(angle, np.linalg.norm(e[:, 3:], axis=1), rtol=0, atol=1e-14)
