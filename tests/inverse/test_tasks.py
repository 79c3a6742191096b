"""What forward kinematics reaches is found again, for every task: the pose, the approach direction, the position."""

from __future__ import annotations

import numpy as np
import pytest
from library_entries import names_of
from sweeps import sweep

import robokin
from robokin.inverse.analysis import analysis_of
from robokin.inverse.solve import TASKS, solve_many
from robokin.kernel.frames import frames
from robokin.kernel.residual import error_and_jacobian
from robokin.model import Joint, JointType, Robot
from robokin.spatial import rotation_from_axis_angle, rotation_from_rpy

REGULAR = 1e-4
"""Least singular value of the task's Jacobian from which on a configuration must be found."""


def few_joints():
    return names_of(Robot, 1, 6)


def random_chain(rng):
    """A chain of one to five joints, mostly with right angles and axes that meet."""
    special = rng.random() < 0.8
    rows = []
    for i in range(int(rng.integers(1, 6))):
        turns = rng.random() < 0.6
        a, d = rng.uniform(-1.0, 1.0, 2) * (rng.random(2) < (0.5 if special else 1.0))
        alpha = rng.choice([0.0, 90.0, -90.0]) if special else rng.uniform(-180.0, 180.0)
        kind = JointType.REVOLUTE if turns else JointType.PRISMATIC
        rows.append(Joint(str(i + 1), kind, d=d if turns else 0.0, a=a, alpha=np.deg2rad(alpha)))
    return Robot("random chain", tuple(rows))


def configurations(robot, rng, count, step=None):
    """Joint values (count, n), any within a turn and an arm's size, or multiples of a step [deg] and of 0.25 m."""
    shape = count, robot.n
    if step is not None:
        turns = np.deg2rad(step) * rng.integers(-180 // step, 180 // step + 1, shape)
        return np.where(robot.revolute, turns, 0.25 * rng.integers(-4, 5, shape))
    size = analysis_of(robot).size
    return np.where(robot.revolute, rng.uniform(-3.1, 3.1, shape), rng.uniform(-size, size, shape))


def turned(T, task, rng):
    """Poses (m, 4, 4) turned at random in what the task leaves open."""
    T = T.copy()
    for pose in T:
        if task == "approach":
            pose[:3, :3] = pose[:3, :3] @ rotation_from_axis_angle([0.0, 0.0, 1.0], rng.uniform(-3.0, 3.0))
        elif task == "position":
            pose[:3, :3] = rotation_from_rpy(rng.uniform(-3.0, 3.0, 3))
    return T


def regular(robot, task, q):
    """(m,) whether configurations (m, n) are regular for the task."""
    analysis = analysis_of(robot, task)
    chain = analysis.solved
    if not len(analysis.moving):
        return np.ones(len(q), dtype=bool)
    q = np.concatenate([q[:, analysis.moving], np.zeros((len(q), analysis.open))], axis=1)
    _, J = error_and_jacobian(chain, frames(chain, q)[:, -1], q, analysis.size)
    return np.linalg.svd(J, compute_uv=False)[:, analysis.window.dimension - 1] > REGULAR


def assert_found(robot, task, q, T):
    """Each q (m, n) is among the solutions, but for idle joints; an arm that is redundant has some solution."""
    analysis = analysis_of(robot, task)
    result = solve_many(robot, T, limits=False, task=task)
    must = regular(robot, task, q)
    assert np.all(result.count[must] > 0)
    if not analysis.complete or not len(analysis.moving) or not must.any():
        return
    gap = np.abs(result.q - q[:, None])
    gap = np.where(robot.revolute, np.minimum(gap % (2 * np.pi), -gap % (2 * np.pi)), gap)[:, :, analysis.moving]
    nearest = np.min(np.max(np.nan_to_num(gap, nan=9.0), axis=2), axis=1)
    assert np.max(nearest[must]) < 1e-5


@pytest.mark.parametrize("part", sweep(range(8), 8))
@pytest.mark.parametrize("task", ["approach", "position"])
def test_every_arm_of_the_library_with_at_most_six_joints(task, part, rng):
    for name in few_joints()[part::8]:
        robot = robokin.load(name)
        q = configurations(robot, rng, 20 if analysis_of(robot, task).complete else 2)
        assert_found(robot, task, q, robokin.forward_kinematics(robot, q))


@pytest.mark.parametrize("task", sweep(TASKS, 3))
def test_random_chains(task):
    rng = np.random.default_rng(31)
    for _ in range(60):
        robot = random_chain(rng)
        if not analysis_of(robot, task).complete:
            continue
        q = configurations(robot, rng, 20)
        T = robokin.forward_kinematics(robot, q)
        assert_found(robot, task, q, T)
        assert_found(robot, task, q, turned(T, task, rng))


@pytest.mark.parametrize("task", ["approach", "position"])
@pytest.mark.parametrize("rows", sweep(["RP", "PR", "PP", "RPP", "PRP", "PPR", "RRP", "PPP"], 4))
def test_round_values_of_arms_with_right_angles(task, rows):
    """Of a cylindrical arm the roll is at zero in each pose that forward kinematics gives."""
    rng = np.random.default_rng(len(rows))
    joints = []
    for i, letter in enumerate(rows):
        kind = JointType.REVOLUTE if letter == "R" else JointType.PRISMATIC
        joints.append(Joint(str(i + 1), kind, d=0.5 if letter == "R" else 0.0, alpha=(0.0, -np.pi / 2)[i % 2]))
    robot = Robot(rows, tuple(joints))
    for step in (30, 90):
        q = configurations(robot, rng, 60, step)
        T = robokin.forward_kinematics(robot, q)
        assert_found(robot, task, q, T)
        assert_found(robot, task, q, turned(T, task, rng))


def test_a_cylindrical_arm_finds_the_approach_that_forward_kinematics_gives():
    robot = robokin.load("cylindrical")
    q = np.array([np.deg2rad(80.0), 0.25, 0.5])
    result = robokin.solve_ik(robot, robokin.forward_kinematics(robot, q), task="approach")
    assert result.complete
    assert len(result.solutions) == 1
    assert np.allclose(result.solutions[0].q, q, atol=1e-9)
