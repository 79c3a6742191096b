"""Chains whose joints hang on each other: in every convention, written and read again, as URDF; the same at every q."""

from __future__ import annotations

import numpy as np
import pytest
from sweeps import sweep

import robokin
from robokin.errors import InputError
from robokin.formats import read_text
from robokin.formats.part import tree_of
from robokin.formats.urdf import read_urdf
from robokin.formats.written_robot import row_order, written
from robokin.formats.written_tree_urdf import tree_urdf
from robokin.model import CoupledRobot

from .drawn_trees import drawn_tree

SAME = 1e-12


def chains(rng, count, **more):
    """Chains of random trees that are coupled, with configurations (4, n) and the poses there."""
    for _ in range(count):
        tree = drawn_tree(rng, **more)
        for tip in tree.tips:
            robot = tree.robot(tip)
            if isinstance(robot, CoupledRobot):
                u = rng.uniform(-2.0, 2.0, (4, robot.n))
                size = 1.0 + sum(float(np.linalg.norm(row.origin[:3, 3])) for row in robot.rows)
                yield robot, u, robokin.forward_kinematics(robot, u), size


def whole(robot):
    """Whether all that moves a chain's joints is in it."""
    try:
        return bool(row_order(robot))
    except InputError as error:
        assert "is not in the chain, expected the tree" in str(error)
        return False


@pytest.mark.parametrize("seed", sweep(range(10), 3))
def test_other_conventions_and_descriptions_are_the_same_robot(seed):
    rng = np.random.default_rng([seed, 5])
    for robot, u, T, size in chains(rng, 40, hostile=seed % 3 == 0):
        for convention in ("frames", "standard", "modified"):
            made = robokin.to_convention(robot, convention)
            assert made.convention == convention
            assert np.max(np.abs(robokin.forward_kinematics(made, u) - T)) <= SAME * size
            assert [joint.name for joint in made.joints] == [joint.name for joint in robot.joints]
            if not whole(made):
                continue
            order = row_order(made)
            back = read_text(written(made))
            assert np.max(np.abs(robokin.forward_kinematics(back, u[:, order]) - T)) <= SAME * size
            some = rng.uniform(-3.0, 3.0, (50, robot.n))
            assert np.array_equal(back.within_limits(some[:, order]), robot.within_limits(some))
            for name, q in robot.poses.items():
                np.testing.assert_allclose(back.poses[name], q[order], rtol=4e-16, atol=0.0)


def test_a_chain_whose_joints_follow_is_a_urdf_with_mimics():
    rng = np.random.default_rng(6)
    count = 0
    for robot, u, T, size in chains(rng, 150, helical=False, adds=False):
        if whole(robot):
            back = read_urdf(tree_urdf(tree_of(robot)), "a.urdf", exact=True)
            place = back.tips.index("tool")
            assert np.max(np.abs(robokin.tip_poses(back, u)[:, place] - T)) <= SAME * size
            count += 1
    assert count > 10


FOREARM = """\
robokin: 1
name: forearm
units: {length: mm, angle: deg}
joints:
  - {name: a, type: R, a: 300, limits: [-90, 90], motion_limits: [-80, 80]}
  - {name: "~", type: R, a: 200, offset: 20}
  - {name: screw, type: H, pitch: 5, alpha: 90}
couplings:
  - {joint: "~", adds: a, ratio: -1}
  - {joint: screw, follows: {"~": 2, a: 1/3}, offset: 10}
poses: {home: [10, 20]}
"""


def test_a_description_with_couplings_is_written_as_it_is_read():
    robot = read_text(FOREARM)
    text = written(robot)
    assert text.count("\n") == FOREARM.count("\n") + 2  # the convention, and poses a line each
    for line in (
        "  - {name: a, type: revolute, d: 0, a: 300, alpha: 0, limits: [-90, 90], motion_limits: [-80, 80]}\n",
        '  - {joint: "~", adds: a, ratio: -1}\n',
        '  - {joint: screw, follows: {"~": 2, a: 1/3}, offset: 10}\n',
        "pitch: 5}\n",
    ):
        assert line in text
    assert written(read_text(text)) == text
