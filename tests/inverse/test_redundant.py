"""Redundant arms: every pose within the limits is answered, as often as asked for, and a search is called a search."""

from __future__ import annotations

import numpy as np
import pytest

import robokin
from robokin.inverse.analysis import analysis_of
from robokin.inverse.closing import closing_nearest
from robokin.inverse.numeric import error_and_jacobian
from robokin.inverse.redundant import NOT_FOUND, UNPROVEN, along_self_motion
from robokin.inverse.verify import CLOSES, Found, residuals

ARMS = ["panda", "fr3", "iiwa14", "gen72", "r1pro-left", "openarm-left", "human-arm"]
"""Arms of seven joints and more with closed forms of six."""


def within(robot, count, rng):
    """Configurations (count, n) within the limits: inside, with some joints at limits, with all, in turn."""
    reach = np.where(robot.revolute, np.pi, analysis_of(robot).size)[:, None] * [-1.0, 1.0]
    low, high = np.where(np.isinf(robot.limits), reach, robot.limits).T
    q = rng.uniform(low, high, (count, robot.n))
    chance = np.array([0.0, 0.5, 1.0])[np.arange(count) % 3]
    at_limit = np.where(rng.random(q.shape) < 0.5, low, high)
    return np.where(rng.random(q.shape) < chance[:, None], at_limit, q)


def check(robot, T, index, q):
    position, angle = residuals(T[index], robokin.forward_kinematics(robot, q))
    assert np.max(position) <= CLOSES * analysis_of(robot).size + 1e-15
    assert np.max(angle) <= CLOSES + 1e-15
    assert robot.within_limits(q).all()


@pytest.mark.parametrize("name", ARMS)
def test_every_pose_within_the_limits_is_answered(name, rng):
    robot = robokin.load(name)
    T = robokin.forward_kinematics(robot, within(robot, 60, rng))
    result = robokin.solve_ik(robot, T)
    assert np.all(result.count > 0)
    index, place = np.nonzero(~np.isnan(result.q[:, :, 0]))
    check(robot, T, index, result.q[index, place])


def test_all_joints_at_a_limit():
    robot = robokin.load("gen72")
    low, high = robot.limits.T
    q = np.where(np.array([1, -1, 1, -1, 1, 1, 1]) > 0, high, low)
    assert robokin.solve_ik(robot, robokin.forward_kinematics(robot, q)).reachable


@pytest.mark.parametrize("name", ["yumi-right", "gen3"])
def test_arms_without_a_closed_form_are_searched(name, rng):
    robot = robokin.load(name)
    T = robokin.forward_kinematics(robot, within(robot, 45, rng))
    found = closing_nearest(analysis_of(robot), T, robot.limits, np.clip(0.0, *robot.limits.T), 0)
    assert np.all(np.bincount(found.index, minlength=len(T)) > 0)
    check(robot, T, found.index, found.q)


def test_as_many_as_asked_for_where_joints_are_far_from_their_limits(rng):
    """Such a configuration has a piece of its self-motion beside it."""
    robot = robokin.load("iiwa14")
    low, high = robot.limits.T
    q = rng.uniform(0.8 * low, 0.8 * high, (10, robot.n))
    T = robokin.forward_kinematics(robot, q)
    result = robokin.solve_ik(robot, T, most=128)
    assert np.all(result.count == 128)
    for target, solutions in zip(T, result.q, strict=True):
        check(robot, target[None], np.zeros(128, dtype=np.intp), solutions)
        gaps = np.abs(solutions[:, None] - solutions)
        gaps = np.max(np.minimum(gaps % (2 * np.pi), 2 * np.pi - gaps % (2 * np.pi)), axis=2)
        assert np.min(gaps + np.eye(128)) > 1e-6


def test_the_way_along_a_self_motion_keeps_the_pose_and_the_limits(rng):
    robot = robokin.load("panda")
    analysis = analysis_of(robot)
    q = within(robot, 9, rng)[::3]
    T = robokin.forward_kinematics(robot, q)
    start = Found(np.arange(3), q, np.zeros(3), np.zeros(3))
    found = along_self_motion(analysis, T, start, robot.limits, 0.02)
    assert len(found)
    check(robot, T, found.index, found.q)
    _, J = error_and_jacobian(analysis.chain, T, q, analysis.size)
    null = np.linalg.svd(J)[2][:, -1]
    for i, way in enumerate(null):
        near = found.q[found.index == i] - q[i]
        first = near[np.linalg.norm(near, axis=1) < 0.03]
        assert np.allclose(np.abs(first @ way), 0.02, atol=2e-3)


@pytest.mark.parametrize(("place", "reason"), [([0.1, 0.0, -0.2], UNPROVEN), ([0.0, 0.0, -0.3], NOT_FOUND)])
def test_a_search_proves_nothing(place, reason):
    """Below its base a Panda finds no solution within its limits; whether there is any outside is known for the first.

    Three metres away is farther than the arm is long, which is a proof.
    """
    robot = robokin.load("panda")
    T = np.eye(4)
    T[:3, 3] = place
    answer = robokin.solve_ik(robot, T)
    assert not answer.reachable
    assert not answer.complete
    assert answer.reason == reason
    assert "not proven unreachable" in reason
    assert robokin.solve_ik(robot, np.stack([T, T])).reason(1) == reason
    T[:3, 3] = [3.0, 0.0, 0.0]
    assert robokin.solve_ik(robot, T).reason == "out of reach"
