"""Paths: the time law, straight lines that stay on one branch, and what ends them."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import robokin
from robokin.errors import InputError
from robokin.inverse.joint_paths import time_law
from robokin.spatial import axis_angle_from_rotation, transform

ARMS = {
    "puma560": ([0.1, -0.8, 1.2, 0.2, 0.6, 0.3], [0.5, -0.6, 1.0, 0.4, 0.7, 0.1]),
    "ur5e": ([0.1, -0.8, 1.2, 0.2, 0.6, 0.3], [0.5, -0.6, 1.0, 0.4, 0.7, 0.1]),
    "crx10ia": ([0.1, -0.8, 0.4, 0.2, 0.6, 0.3], [0.5, -0.6, 0.5, 0.4, 0.7, 0.1]),
    "scara": ([0.3, 0.7, 0.1, 0.5], [1.2, 0.4, 0.05, 0.6]),
    "planar3r": ([0.3, 0.7, 0.1], [1.2, 0.4, 0.05]),
    "panda": ([0.1, -0.8, 0.2, -1.2, 0.2, 1.6, 0.3], [0.5, -0.6, 0.1, -1.0, 0.4, 1.7, 0.1]),
}
POINTS = {
    "planar2r": ([0.3, 0.7], [1.2, 0.4]),
    "anthropomorphic": ([0.3, 0.7, 0.5], [1.2, 0.4, 0.6]),
    "spherical": ([0.3, 0.7, 0.5], [0.9, 1.1, 0.8]),
}


def line(name, start, end, **options):
    robot = robokin.load(name)
    return robot, robokin.follow_line(robot, start, robokin.forward_kinematics(robot, end), **options)


def test_the_time_law():
    t = np.linspace(0, 1, 1001)
    s = time_law(t)
    assert (s[0], s[-1], s[500]) == (0.0, 1.0, 0.5)
    first, second = np.gradient(s, t), np.gradient(np.gradient(s, t), t)
    assert np.all(np.diff(s) > 0)
    for ends in (first[[0, -1]], second[[0, -1]]):
        assert np.max(np.abs(ends)) < 0.05
    # The greatest velocity is 15/8, in the middle.
    assert np.max(first) == pytest.approx(15 / 8, rel=1e-4)


def test_joints_move_together(rng):
    robot = robokin.load("puma560")
    start, end = rng.uniform(-0.5, 0.5, (2, 6))
    path = robokin.interpolate_joints(robot, start, end, 40)
    assert (path.complete, path.fraction, path.q.shape) == (True, 1.0, (41, 6))
    assert np.array_equal(path.q[0], start)
    assert np.allclose(path.q[-1], end, atol=1e-15)
    assert np.allclose((path.q - start) / (end - start), path.s[:, None], atol=1e-12)
    assert np.array_equal(path.T, robokin.forward_kinematics(robot, path.q))


@pytest.mark.parametrize("name", ARMS)
def test_a_line_is_straight_and_turns_about_one_axis(name):
    robot, path = line(name, *ARMS[name], steps=200)
    assert path.complete
    assert path.events == ()
    first, last = path.T[0], robokin.forward_kinematics(robot, ARMS[name][1])
    assert np.allclose(path.T[-1], last, atol=1e-8)
    straight = first[:3, 3] + path.s[:, None] * (last[:3, 3] - first[:3, 3])
    assert np.max(np.abs(path.T[:, :3, 3] - straight)) < 1e-8
    axis, angle = axis_angle_from_rotation(first[:3, :3].T @ last[:3, :3])
    axes, angles = axis_angle_from_rotation(first[:3, :3].T @ path.T[20:, :3, :3])
    assert np.allclose(angles, path.s[20:] * angle, atol=1e-7)
    assert angle < 1e-9 or np.allclose(axes, axis, atol=1e-5)


@pytest.mark.parametrize("name", {**ARMS, **POINTS})
def test_a_line_has_no_jumps(name):
    """Half as long a step moves the joints half as far."""
    start, end = {**ARMS, **POINTS}[name]
    steps = [np.max(np.abs(np.diff(line(name, start, end, steps=n)[1].q, axis=0))) for n in (100, 200)]
    assert steps[0] < 0.1
    assert steps[1] < 0.6 * steps[0]


@pytest.mark.parametrize("name", POINTS)
def test_arms_that_place_a_point_follow_its_line(name):
    robot, path = line(name, *POINTS[name], steps=50)
    assert path.complete
    p = path.T[:, :3, 3]
    last = robokin.forward_kinematics(robot, POINTS[name][1])[:3, 3]
    assert np.max(np.abs(p - (p[0] + path.s[:, None] * (last - p[0])))) < 1e-9
    assert path.length == pytest.approx(np.linalg.norm(last - p[0]), rel=1e-9)


@pytest.mark.slow
def test_a_line_out_of_reach_ends_at_the_boundary():
    robot = robokin.load("planar2r")
    T = np.eye(4)
    T[:3, 3] = [2.0, 0.0, 0.0]
    path = robokin.follow_line(robot, [0.3, 0.7], T)
    first = path.T[0, :2, 3]
    # Where the segment meets the circle of radius l1 + l2 = 1.6.
    d = np.array([2.0, 0.0]) - first
    roots = np.roots([d @ d, 2 * first @ d, first @ first - 1.6**2])
    assert path.fraction == pytest.approx(float(np.max(roots.real)), abs=1e-4)
    (event,) = [event for event in path.events if event.kind == "unreachable"]
    assert event.fraction == path.fraction
    assert len(path.q) < 101
    assert np.all(path.s <= path.fraction)


def test_a_line_ends_where_a_joint_leaves_its_limits():
    robot = robokin.load("puma560")
    T = robokin.forward_kinematics(robot, [0.1, -0.8, 1.2, 0.2, 0.6, 0.3]).copy()
    T[2, 3] -= 1.2
    path = robokin.follow_line(robot, [0.1, -0.8, 1.2, 0.2, 0.6, 0.3], T)
    event = path.events[-1]
    assert (event.kind, event.joint) == ("limit", 2)
    assert event.value == robot.limits[1, 1]
    assert np.all(robot.within_limits(path.q))
    # At the fraction itself the joint is at its limit.
    at = path.T[0].copy()
    at[:3, 3] += path.fraction * (T[:3, 3] - at[:3, 3])
    (q,) = [s.q for s in robokin.solve_ik(robot, at, limits=False, near=path.q[-1]).solutions[:1]]
    assert q[1] == pytest.approx(robot.limits[1, 1], abs=1e-6)


def test_joints_end_at_the_limit():
    robot = robokin.load("puma560")
    path = robokin.interpolate_joints(robot, np.zeros(6), [0, 0, 0, 2 * robot.limits[3, 1], 0, 0])
    assert path.fraction == pytest.approx(0.5)
    assert (path.events[-1].joint, path.events[-1].value) == (4, robot.limits[3, 1])
    whole = robokin.interpolate_joints(robot, np.zeros(6), [0, 0, 0, 2 * robot.limits[3, 1], 0, 0], limits=False)
    assert whole.complete
    outside = robokin.interpolate_joints(robot, [0, 2.0, 0, 0, 0, 0], np.zeros(6))
    assert (outside.fraction, len(outside.q)) == (0.0, 1)


def test_a_singularity_on_the_way_is_said_and_passed():
    """A wrist that is straight in the middle of the way: the joints go on through it."""
    robot = robokin.load("puma560")
    start, end = np.array([0.1, -0.8, 1.2, 0.0, 0.5, 0.3]), np.array([0.1, -0.8, 1.2, 0.0, -0.5, 0.3])
    path = robokin.interpolate_joints(robot, start, end)
    (event,) = path.events
    assert (event.kind, event.fraction) == ("singularity", 0.5)
    assert "rotation about" in event.words
    assert path.complete
    assert np.min(path.manipulability) == 0.0


def test_a_line_through_a_straight_wrist_keeps_its_branch():
    """The hand turns about axis 5 alone: q5 passes zero, and no joint moves by half a turn."""
    robot = robokin.load("puma560")
    at_the_wrist = transform(np.eye(3), np.array([0.0, 0.0, -robot.rows[5].d]))
    robot = dataclasses.replace(robot, tool=at_the_wrist)
    start, end = [0.1, -0.8, 1.2, 0.2, 0.5, 0.3], [0.1, -0.8, 1.2, 0.2, -0.5, 0.3]
    path = robokin.follow_line(robot, start, robokin.forward_kinematics(robot, end))
    assert path.complete
    assert np.max(np.abs(np.diff(path.q, axis=0))) < 0.05
    assert np.allclose(path.q[-1], end, atol=1e-6)
    assert [event.kind for event in path.events] == ["singularity"]


def test_a_redundant_arm_moves_no_more_than_it_must():
    """Along its null space a path of least joint motion does not move."""
    start, end = ARMS["panda"]
    robot, path = line("panda", start, end, steps=400)
    found = robokin.differential_kinematics(robot, path.q[:-1])
    rates = np.diff(path.q, axis=0)
    along = np.einsum("mi,mi->m", found.null_space[:, -1], rates)
    assert np.max(np.abs(along)) < 0.05 * np.max(np.linalg.norm(rates, axis=1))


def test_a_task_of_position_leaves_the_hand_free():
    robot = robokin.load("scorbot")
    start, end = [0.3, -0.7, 0.9, -1.0, 0.5], [0.6, -0.5, 1.1, -1.0, 0.6]
    T = robokin.forward_kinematics(robot, end)
    assert not robokin.follow_line(robot, start, T).complete
    path = robokin.follow_line(robot, start, T, task="position")
    assert path.complete
    assert np.allclose(path.T[-1, :3, 3], T[:3, 3], atol=1e-8)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (([0.0] * 5, np.eye(4)), "expected 6"),
        (([np.nan] * 6, np.eye(4)), "finite"),
        (([0.0] * 6, np.ones((4, 4))), "homogeneous"),
        (([0.0] * 6, np.eye(4), 0), "from 1 to"),
    ],
)
def test_what_is_no_path(arguments, message):
    with pytest.raises(InputError, match=message):
        robokin.follow_line(robokin.load("puma560"), *arguments)
