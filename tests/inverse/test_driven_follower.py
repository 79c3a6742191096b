"""Straight lines of robots whose joints follow others."""

from __future__ import annotations

import numpy as np
import pytest

import robokin
from robokin.inverse.paths_to_poses import follow_line
from robokin.kernel.chain import row_standing
from robokin.model.coupled_robot import driven
from robokin.model.graph import Coupling
from robokin.model.robot import Joint, JointType, Robot

from .test_coupled_joints import FREE, finger


def arm(a, couplings, limits=None, alpha=None):
    """An arm of turning joints with links a, in a plane unless alpha says otherwise."""
    alpha = alpha or [0.0] * len(a)
    limits = limits or [FREE] * len(a)
    rows = tuple(
        Joint(f"j{i}", JointType.REVOLUTE, a=length, alpha=twist, limits=tuple(box))
        for i, (length, twist, box) in enumerate(zip(a, alpha, limits, strict=True), start=1)
    )
    return driven({"name": "arm", "rows": rows}, couplings)


def on_line(path, start, T):
    """How far the tool is off the line, in space and in time [m]."""
    wanted = start + path.s[:, None] * (T[:3, 3] - start)
    return np.max(np.linalg.norm(path.T[:, :3, 3] - wanted, axis=1))


@pytest.mark.parametrize("seed", range(8))
def test_a_line_is_followed_to_its_end_and_joints_move_evenly(seed):
    rng = np.random.default_rng(seed)
    ratio = float(rng.choice([1.0, 2 / 3, -0.5, 2.0]))
    robot = arm([0.4, 0.3, 0.2], (Coupling("j3", (("j2", ratio),), 0.1),))
    first = rng.uniform([-1.0, 0.6], [1.0, 1.2])
    T = robokin.forward_kinematics(robot, first + rng.uniform(-0.3, 0.3, 2))
    path = follow_line(robot, first, T, 40, task="position")
    assert path.complete
    assert on_line(path, robokin.forward_kinematics(robot, first)[:3, 3], T) < 1e-9
    assert np.max(np.abs(np.diff(path.q, axis=0))) < 0.1
    assert np.max(np.abs(np.diff(path.q[::-1], axis=0))) < 0.1


def test_a_follower_that_stands_is_a_fixed_row():
    """A ratio of nothing: the same arm with the row fixed goes the same way, by lists of all solutions."""
    puma = robokin.load("puma560")
    rows = [*puma.rows[:3], Joint("extra", JointType.REVOLUTE, a=0.05, alpha=0.3), *puma.rows[3:]]
    rows = [Joint(f"j{i}", row.type, row.theta, row.d, row.a, row.alpha, row.offset) for i, row in enumerate(rows)]
    coupled = driven({"name": "arm", "rows": tuple(rows)}, (Coupling("j3", (("j1", 0.0),), 0.4),))
    plain = Robot("plain", tuple(row_standing(row, 0.4, "standard") if row.name == "j3" else row for row in rows))
    first = np.array([0.2, -0.6, 0.4, 0.3, 0.8, 0.2])
    T = robokin.forward_kinematics(plain, first + 0.2)
    assert np.allclose(T, robokin.forward_kinematics(coupled, first + 0.2))
    a, b = follow_line(plain, first, T, 20), follow_line(coupled, first, T, 20)
    assert a.complete and b.complete
    assert np.max(np.abs(a.q - b.q)) < 1e-7


def test_a_stretched_arm_bends_the_way_that_its_limits_leave():
    free = arm([0.4, 0.3, 0.2], (Coupling("j3", (("j2", 1.0),)),))
    T = robokin.forward_kinematics(free, [0.3, 0.8])
    assert follow_line(free, [0.0, 0.0], T, 20, task="position").complete
    for box, sense in ([[0.0, 2.0], 1.0], [[-2.0, 0.0], -1.0]):
        bounded = arm([0.4, 0.3, 0.2], (Coupling("j3", (("j2", 1.0),)),), [FREE, box, FREE])
        path = follow_line(bounded, [0.0, 0.0], T, 20, task="position")
        assert path.complete
        assert np.all(path.q[1:, 1] * sense > 0.0)
        assert "singular" in path.events[0].words


def test_out_of_reach_the_limits_and_a_jump():
    robot = arm([0.4, 0.3, 0.2], (Coupling("j3", (("j2", 1.0),)),), [FREE, [-2.0, 1.0], FREE])
    start = robokin.forward_kinematics(robot, [0.2, 0.5])
    far = start.copy()
    far[0, 3] += 1.0
    path = follow_line(robot, [0.2, 0.5], far, 10, task="position")
    assert path.events[-1].kind == "unreachable" and 0.0 < path.fraction < 1.0
    # The tool is stretched where the line ends.
    reach = start[:3, 3] + path.fraction * (far[:3, 3] - start[:3, 3])
    assert np.linalg.norm(reach) == pytest.approx(0.9, abs=1e-6)
    near = robokin.forward_kinematics(robot, [0.2, 1.4])
    path = follow_line(robot, [0.2, 0.5], near, 20, task="position")
    assert (path.events[-1].kind, path.events[-1].joint) == ("limit", 2)
    assert path.events[-1].value == pytest.approx(1.0)
    assert follow_line(robot, [0.2, 0.5], near, 20, limits=False, task="position").complete
    outside = follow_line(robot, [0.2, 1.5], near, 5, task="position")
    assert (outside.fraction, len(outside), outside.events[-1].kind) == (0.0, 1, "limit")


def test_more_variables_than_needed_take_the_least_motion_and_the_limits():
    a, twist = [0.3, 0.3, 0.25, 0.2, 0.1], [0.0] * 5
    couplings = (Coupling("j4", (("j3", 0.5),)),)
    robot = arm(a, couplings, alpha=twist)
    first = np.array([0.2, 0.5, 0.4, 0.3])
    T = robokin.forward_kinematics(robot, first + np.array([0.4, -0.2, 0.3, 0.1]))
    path = follow_line(robot, first, T, 30, task="position")
    assert path.complete and on_line(path, robokin.forward_kinematics(robot, first)[:3, 3], T) < 1e-9
    # Each step is the shortest that brings the tool on.
    J = robokin.jacobian(robot, path.q[:-1])[:, :2]
    least = np.einsum("sij,sj->si", np.linalg.pinv(J), np.diff(path.T[:, :2, 3], axis=0))
    assert np.max(np.abs(least - np.diff(path.q, axis=0))) < 5e-3
    # The third joint may not move: the others do without it.
    held = arm(a, couplings, [FREE, FREE, [0.4, 0.4], FREE, FREE], alpha=twist)
    path = follow_line(held, first, T, 30, task="position")
    assert path.complete
    assert np.all(path.q[:, 2] == pytest.approx(0.4))


def test_a_finger_in_space():
    robot = finger()
    first = np.array([0.05, 0.3, 0.5])
    T = robokin.forward_kinematics(robot, [-0.1, 0.6, 0.9])
    path = follow_line(robot, first, T, 50)  # of an arm that places a point the position follows the line
    assert path.complete and path.kind == "line"
    assert np.allclose(path.q[-1], [-0.1, 0.6, 0.9], atol=1e-7)
    pose = follow_line(robot, first, T, 10, task="pose")
    assert not pose.complete and "orientation" in pose.events[-1].words


@pytest.mark.parametrize("ratio", [1e6, -1e8, 1e-9])
def test_great_and_small_ratios_end_in_an_answer(ratio):
    robot = arm([0.4, 0.3, 0.2], (Coupling("j3", (("j2", ratio),)),))
    T = robokin.forward_kinematics(robot, [0.3, 0.7])
    path = follow_line(robot, [0.2, 0.7], T, 4, task="position")
    assert on_line(path, robokin.forward_kinematics(robot, [0.2, 0.7])[:3, 3], T) < 1e-8
    assert 0.0 <= path.fraction <= 1.0
