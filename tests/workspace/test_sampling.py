"""Sampled joint values fill the box, their positions are those of forward kinematics, and cores change nothing."""

from __future__ import annotations

import pickle
from dataclasses import replace

import numpy as np
import pytest

import robokin
from robokin.errors import InputError
from robokin.formats import library_names, load_any
from robokin.jobs.sequences import KINDS
from robokin.model import Joint, JointType, Robot
from robokin.workspace.sampling import joint_values, moving_chain, positions, sample_count
from robokin.workspace.space import space_of

ARMS = ["puma560", "planar3r", "scara", "stanford", "thumb", "panda", "cylindrical", "spherical-wrist", "kr5-arc"]


def test_positions_are_those_of_forward_kinematics():
    count = 0
    for entry in map(load_any, library_names()):
        if not isinstance(entry, Robot):
            continue
        try:
            space = space_of(entry)
        except InputError:
            continue
        q = joint_values(space, "random", 1, 0, 50, 50, every=True)
        p = robokin.forward_kinematics(entry, q.T)[:, :3, 3]
        assert np.max(np.abs(positions(space, q).T - p)) <= 4e-15 * max(space.size, 1.0), entry.id
        count += 1
    assert count > 50


def test_a_joint_that_does_not_move_the_origin_is_left_out_wherever_it_stands():
    # The second joint turns about the line along which the third slides.
    rows = (
        Joint("1", JointType.REVOLUTE, a=0.4, alpha=0.3),
        Joint("2", JointType.REVOLUTE, offset=0.2),
        Joint("3", JointType.PRISMATIC, limits=(0.1, 0.5)),
    )
    robot = Robot("odd", rows)
    space = space_of(robot)
    assert space.moving == (0, 2)
    assert moving_chain(space).n == 2
    q = joint_values(space, "sobol", 0, 0, 100, 100, every=True)
    assert np.ptp(q[1]) > 6
    p = robokin.forward_kinematics(robot, q.T)[:, :3, 3]
    assert np.allclose(positions(space, q).T, p, rtol=0, atol=1e-15)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", ["puma560", "scara"])
def test_values_lie_in_the_box_and_reach_its_ends(name, kind):
    space = space_of(robokin.load(name))
    count = sample_count(space, kind, 4096, every=True)
    q = joint_values(space, kind, 0, 0, 4096, 4096, every=True)
    assert q.shape == (space.robot.n, count)
    low, high = space.low[:, None], space.high[:, None]
    assert np.all((q >= low - 1e-12) & (q <= high + 1e-12))
    spread = np.ptp(q, axis=1) / (space.high - space.low)
    side = count ** (1 / space.robot.n)
    expected = np.where(space.full, 1 - 1 / side, 1.0) if kind == "grid" else 0.99
    assert np.all(spread >= expected - 1e-12)


@pytest.mark.parametrize("kind", ["sobol", "random"])
@pytest.mark.parametrize("name", ARMS)
def test_positions_do_not_depend_on_the_other_joints(name, kind):
    space = space_of(robokin.load(name))
    few, all_ = (joint_values(space, kind, 3, 40, 200, 1000, every=every) for every in (False, True))
    assert np.array_equal(positions(space, few), positions(space, all_))


@pytest.mark.parametrize("kind", KINDS)
def test_a_part_of_a_sequence_is_that_part_from_any_start(kind):
    space = space_of(robokin.load("stanford"))
    total = sample_count(space, kind, 4500)
    whole = joint_values(space, kind, 5, 0, total, 4500)
    assert whole.shape == (6, total)
    for start, count in ((0, 1000), (1000, 1), (total // 2 + 7, 300)):
        assert np.array_equal(joint_values(space, kind, 5, start, count, 4500), whole[:, start : start + count])


def test_a_base_moves_every_position(rng):
    robot = robokin.load("puma560")
    base = robokin.forward_kinematics(robot, rng.uniform(-2, 2, 6))
    q = rng.uniform(-2, 2, (6, 100))
    moved = positions(space_of(replace(robot, base=base)), q)
    still = np.linalg.inv(robot.base) @ np.concatenate([positions(space_of(robot), q), np.ones((1, 100))])
    assert np.allclose(moved, (base @ still)[:3], rtol=0, atol=1e-14)


def test_a_space_travels_between_processes(rng):
    space = space_of(robokin.load("panda"))
    q = rng.uniform(-2, 2, (space.robot.n, 10))
    assert np.array_equal(positions(pickle.loads(pickle.dumps(space)), q), positions(space, q))


def test_an_arm_whose_tool_stays_has_one_position():
    space = space_of(robokin.load("spherical-wrist", d6=0))
    assert space.dimension == 0
    assert np.ptp(positions(space, joint_values(space, "sobol", 0, 0, 10, 10)), axis=1).max() == 0


@pytest.mark.parametrize("samples", [0, -5])
def test_less_than_one_sample_is_refused(samples):
    space = space_of(robokin.load("planar2r"))
    with pytest.raises(InputError, match=f"found {samples} samples, expected at least 1"):
        sample_count(space, "sobol", samples)
