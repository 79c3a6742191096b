"""Paths of arms with joints held."""

from __future__ import annotations

import numpy as np
import pytest

import robokin
from robokin.errors import InputError
from robokin.inverse.held_paths import path_with_held_joints
from robokin.inverse.path_goals import Goal, Manner
from robokin.inverse.rounded_curves import CornerRounding
from robokin.inverse.trajectories import Timing, motion_limits

PANDA = robokin.load("panda")
START = np.radians([0.0, -30.0, 0.0, -100.0, 0.0, 90.0, 0.0])
T = robokin.forward_kinematics(PANDA, START)
DOWN = T.copy()
DOWN[:3, 3] = (0.4, 0.1, 0.5)


@pytest.mark.parametrize("joint", [2, 4, 6])
def test_a_held_joint_stands_still_and_the_rest_is_the_line(joint):
    timing = Timing(motion_limits(PANDA, 1.0, 5.0))
    goals = [Goal(T=DOWN)]
    path = path_with_held_joints(PANDA, {joint: 0.0}, START, goals, 200, Manner("line", timing=timing))
    assert path.complete and path.robot is PANDA and path.held is not None
    assert not path.q[:, joint].any() and not path.velocity[:, joint].any() and not path.acceleration[:, joint].any()
    np.testing.assert_allclose(robokin.forward_kinematics(PANDA, path.q), path.T, atol=1e-12)
    np.testing.assert_allclose(path.T[:, :3, :3], np.tile(T[:3, :3], (201, 1, 1)), atol=1e-8)
    way = DOWN[:3, 3] - T[:3, 3]
    off = np.cross(path.T[:, :3, 3] - T[:3, 3], way / np.linalg.norm(way))
    assert np.abs(off).max() < 1e-8
    assert np.abs(path.velocity).max() <= 1.0 + 1e-9 and np.abs(path.acceleration).max() <= 5.0 + 1e-9
    middle = (path.q[2:] - path.q[:-2]) / (path.t[2:] - path.t[:-2])[:, None]
    np.testing.assert_allclose(middle, path.velocity[1:-1], atol=2e-3)
    # Each row is one of all solutions with that joint held.
    for i in (0, 77, 200):
        found = robokin.solve_ik(PANDA, path.T[i], hold={joint: 0.0})
        gaps = [np.abs((path.q[i] - one.q + np.pi) % (2 * np.pi) - np.pi).max() for one in found.solutions]
        assert min(gaps) < 1e-6


def test_a_pose_to_start_from_gives_branches_of_the_whole_arm():
    path = path_with_held_joints(PANDA, {2: 0.2}, Goal(T=T), [Goal(T=DOWN)], 20, Manner("line"))
    assert path.complete and path.branches and all(one.start.shape == (7,) for one in path.branches)
    assert all(one.start[2] == 0.2 and one.travel[2] == 0.0 for one in path.branches)
    np.testing.assert_array_equal(path.branches[0].start, path.q[0])


def test_what_ends_it_is_told_by_the_whole_arms_joints():
    """Joint 4 is the third of those that are left; its limits are -3.07 to -0.07 rad."""
    far = START.copy()
    far[3] = 1.0
    path = path_with_held_joints(PANDA, {2: 0.0}, START, [Goal(q=far)], 10, Manner())
    assert not path.complete and path.events[-1].joint == 4 and path.events[-1].words == "joint 4 leaves its limits"
    assert path.events[-1].value == pytest.approx(PANDA.limits[3, 1])
    timing = Timing(motion_limits(PANDA, [9, 9, 9, 1, 9, 9, 9], None), duration=0.1)
    with pytest.raises(InputError, match="joint 4 is at its limit"):
        path_with_held_joints(PANDA, {2: 0.0}, START, [Goal(q=far)], 10, Manner(timing=timing))


def test_corners_are_rounded_with_a_joint_held():
    side = DOWN.copy()
    side[:3, 3] = (0.45, -0.1, 0.5)
    manner = Manner("line", rounding=CornerRounding(0.5))
    path = path_with_held_joints(PANDA, {2: 0.0}, START, [Goal(T=DOWN), Goal(T=side)], 40, manner)
    assert path.complete and len(path) == 81 and len(path.blends) == 1 and not path.q[:, 2].any()


def test_values_that_are_not_the_held_ones():
    with pytest.raises(InputError, match=r"q3 is held at 0\.2 and is 0 where the path goes"):
        path_with_held_joints(PANDA, {2: 0.2}, START, [Goal(T=DOWN)], 10, Manner())
    with pytest.raises(InputError, match=r"q3 is held at 9 rad, outside its limits"):
        path_with_held_joints(PANDA, {2: 9.0}, START, [Goal(T=DOWN)], 10, Manner())
