"""Poses that are searched for: what forward kinematics reaches is found, and what is found is there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import robokin
from robokin.arrays import Array
from robokin.inverse.analysis import analysis_of
from robokin.inverse.solve_blocks import quick_block
from robokin.inverse.verify import within_limits
from robokin.model import Joint, JointType, Robot
from robokin.spatial import rotation_transform
from robokin.workspace.attitudes import attitudes, group_of
from robokin.workspace.orientation import FEWER, SPARE, notes_of_turns
from robokin.workspace.pose_descent import searched, sought_poses
from robokin.workspace.sizes import Measure
from robokin.workspace.space import space_of
from robokin.workspace.trials import configurations, fractions, reached_with_more
from robokin.workspace.workspace_result import Dexterity

NONE = Measure(0.0, 0.0, "", 0)
FOUND = Dexterity("SO(3)", 86, 1.0, np.zeros((0, 3)), 0.1, np.zeros(0), False, 0.5, NONE, NONE, NONE)

EDGE = 0.38
"""The part of the joint values that stand at limits."""


def samples(robot: Robot, count: int, seed: int) -> Array:
    """Joint values (count, n) within the limits, as often as not with some of them at one."""
    rng = np.random.default_rng(seed)
    limits = np.where(np.isinf(robot.limits), np.array([-np.pi, np.pi]), robot.limits)
    q = limits[:, 0] + (limits[:, 1] - limits[:, 0]) * rng.random((count, robot.n))
    side = rng.integers(0, 2, q.shape)
    return np.where(rng.random(q.shape) < EDGE, limits[np.arange(robot.n), side], q)


def seven(seed: int, endless: bool = False) -> Robot:
    """An arm of seven turning joints without a closed form."""
    rng = np.random.default_rng(seed)
    joints = []
    for i in range(7):
        low, high = sorted(rng.uniform(-3.0, 3.0, 2))
        limits = (-np.inf, np.inf) if endless and i == 6 else (low - 0.3, high + 0.3)
        d, a, alpha = (*rng.uniform(-0.4, 0.6, 2), rng.uniform(-2.0, 2.0))
        joints.append(Joint(f"q{i}", JointType.REVOLUTE, limits=limits, d=d, a=a, alpha=alpha))
    if endless:
        joints[-1] = replace(joints[-1], a=0.0, alpha=0.0)
    return Robot("seven", tuple(joints))


@pytest.mark.parametrize("name", ["rizon4", "gen3"])
def test_what_forward_kinematics_reaches_is_found(name: str) -> None:
    robot = robokin.load(name)
    space = space_of(robot)
    assert searched(space, "pose")
    T = robokin.forward_kinematics(robot, samples(robot, 300, 1))
    inside, q = sought_poses(space, "pose", T[:, :3, 3], T[:, :3, :3])
    # One in a thousand is missed, where several joints stand at their limits.
    assert np.sum(~inside) <= 2
    assert np.all(np.isnan(q[~inside]))
    there = robokin.forward_kinematics(robot, q[inside])
    assert np.allclose(there, T[inside], atol=1e-9)
    assert np.all(q[inside] >= robot.limits[:, 0] - 1e-9)
    assert np.all(q[inside] <= robot.limits[:, 1] + 1e-9)


@pytest.mark.parametrize("seed", range(3))
def test_arms_at_random_find_what_a_sweep_of_the_joint_to_spare_does(seed: int) -> None:
    robot = seven(seed)
    space, analysis = space_of(robot), analysis_of(robot)
    assert searched(space, "pose")
    rng = np.random.default_rng(seed + 50)
    T = robokin.forward_kinematics(robot, samples(robot, 30, seed))
    # Places that are reached, with orientations that may not be.
    turns = [rotation_transform(axis, float(np.linalg.norm(axis))) for axis in rng.normal(0.0, 0.6, (30, 3))]
    T = T @ np.array(turns)
    found = quick_block(analysis, T, robot.limits, np.clip(0.0, *robot.limits.T))
    _, which = within_limits(found.q, robot.revolute, robot.limits, None)
    swept = np.zeros(len(T), dtype=bool)
    swept[found.index[which]] = True
    inside, _ = sought_poses(space, "pose", T[:, :3, 3], T[:, :3, :3])
    assert np.all(inside[swept])
    assert np.all(reached_with_more(space, "pose", T[:, :3, 3], T[:, :3, :3]) == inside)


def test_a_direction_of_an_arm_whose_last_joint_rolls_is_searched_without_it() -> None:
    robot = seven(4, endless=True)
    space = space_of(robot)
    assert group_of(space) == "S2"
    assert analysis_of(space.arm, "approach").idle == (6,)
    assert searched(space, "approach") == (analysis_of(space.arm, "approach").redundancy > 0)
    T = robokin.forward_kinematics(robot, samples(robot, 60, 2))
    inside, q = configurations(space, "approach", T[:, :3, 3], T[:, :3, :3])
    assert np.mean(inside) > 0.95
    there = robokin.forward_kinematics(robot, q[inside])
    assert np.allclose(there[:, :3, 2:], T[inside, :3, 2:], atol=1e-8)


def test_the_answer_says_that_fewer_orientations_are_tried() -> None:
    found = replace(FOUND, every=Measure(0.0, 0.0, "", 0, exact=False))
    assert notes_of_turns(space_of(robokin.load("rizon4")), found) == [SPARE, FEWER]
    assert notes_of_turns(space_of(robokin.load("panda")), found) == [SPARE]
    assert notes_of_turns(space_of(robokin.load("puma560")), replace(found, every=NONE)) == []
    assert notes_of_turns(space_of(robokin.load("rizon4")), None) == []


def test_no_pose_depends_on_the_others_nor_on_their_order() -> None:
    space = space_of(robokin.load("rizon4"))
    T = robokin.forward_kinematics(space.robot, samples(space.robot, 40, 3))
    T[::2, :3, :3] = T[1::2, :3, :3]
    inside, q = sought_poses(space, "pose", T[:, :3, 3], T[:, :3, :3])
    order = np.random.default_rng(0).permutation(40)
    mixed, values = sought_poses(space, "pose", T[order, :3, 3], T[order, :3, :3])
    assert np.array_equal(mixed, inside[order])
    assert np.array_equal(values, q[order], equal_nan=True)
    alone, value = sought_poses(space, "pose", T[:1, :3, 3], T[:1, :3, :3])
    assert np.array_equal(alone, inside[:1])
    assert np.array_equal(value, q[:1], equal_nan=True)


def test_places_out_of_reach_have_no_orientation_and_none_is_an_answer() -> None:
    space = space_of(robokin.load("rizon4"))
    far = np.array([[5.0, 0.0, 0.0], [0.0, 0.0, -3.0], [0.9, 0.9, 0.9]])
    inside, q = sought_poses(space, "pose", far, np.tile(np.eye(3), (3, 1, 1)))
    assert not inside.any()
    assert np.all(np.isnan(q))
    inside, q = sought_poses(space, "pose", np.zeros((0, 3)), np.zeros((0, 3, 3)))
    assert inside.shape == (0,)
    assert q.shape == (0, 7)


def test_arms_with_a_closed_form_are_solved_as_before() -> None:
    for name in ("panda", "iiwa7", "puma560", "scorbot"):
        assert not searched(space_of(robokin.load(name)), "pose")


def test_one_place_of_a_seven_joint_arm_has_a_part_of_the_orientations() -> None:
    robot = robokin.load("rizon4")
    space = space_of(robot)
    grid = attitudes(space, "SO(3)", 40, 0)
    points = np.array([[0.3, 0.2, 0.5], [0.0, 0.0, 4.0]])
    part = fractions(space, grid, points, 1)
    assert 0.5 < part[0] <= 1.0
    assert part[1] == 0.0
