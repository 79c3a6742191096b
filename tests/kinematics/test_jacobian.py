"""The Jacobian is the derivative of forward kinematics."""

from __future__ import annotations

import numpy as np
import pytest
from kinematics.chains import random_chain
from library_entries import names_of
from sweeps import sweep

import robokin
from robokin.errors import InputError
from robokin.model import Robot

ROBOTS = names_of(Robot)
STEP = 1e-5  # of central differences: their error is STEP² + 1e-16 / STEP, about 1e-10


def by_differences(robot, q):
    """(6, n) the twist of the tool per joint, in the world's axes, from poses alone."""
    R = robokin.forward_kinematics(robot, q)[:3, :3]
    J = np.zeros((6, robot.n))
    for k in range(robot.n):
        h = np.zeros(robot.n)
        h[k] = STEP
        D = (robokin.forward_kinematics(robot, q + h) - robokin.forward_kinematics(robot, q - h)) / (2 * STEP)
        W = D[:3, :3] @ R.T
        J[:, k] = [*D[:3, 3], W[2, 1], W[0, 2], W[1, 0]]
    return J


@pytest.mark.parametrize("convention", ["standard", "modified", "frames"])
def test_it_is_the_finite_difference(convention, rng):
    for _ in range(10):
        robot = random_chain(rng, 7, convention, special=True)
        q = rng.uniform(-3, 3, robot.n)
        assert np.max(np.abs(robokin.jacobian(robot, q) - by_differences(robot, q))) < 1e-7


@pytest.mark.parametrize("name", sweep(ROBOTS, 4))
def test_library_robots(name, rng):
    robot = robokin.load(name)
    q = rng.uniform(-1, 1, robot.n)
    expected = by_differences(robot, q)
    assert np.max(np.abs(robokin.jacobian(robot, q) - expected), initial=0.0) < 1e-8
    R = robokin.forward_kinematics(robot, q)[:3, :3]
    turned = np.concatenate([R.T @ expected[:3], R.T @ expected[3:]])
    assert np.max(np.abs(robokin.jacobian(robot, q, frame="tool") - turned), initial=0.0) < 1e-8


def test_in_the_tools_axes_it_is_turned_back(rng):
    robot = robokin.load("puma560")
    q = rng.uniform(-1, 1, (2, 3, 6))
    R = robokin.forward_kinematics(robot, q)[..., :3, :3]
    base, tool = robokin.jacobian(robot, q), robokin.jacobian(robot, q, frame="tool")
    assert base.shape == (2, 3, 6, 6)
    assert np.allclose(R @ tool[..., :3, :], base[..., :3, :], atol=1e-14)
    assert np.allclose(R @ tool[..., 3:, :], base[..., 3:, :], atol=1e-14)


def test_another_frame_is_refused():
    with pytest.raises(InputError, match="'base' or 'tool'"):
        robokin.jacobian(robokin.load("puma560"), np.zeros(6), frame="hand")
