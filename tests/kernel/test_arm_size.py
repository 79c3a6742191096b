"""The arm's size: of its axes, not of its table; and frames that stand far off are moved to the arm."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import robokin
from robokin.kernel.chain import Chain, chain_of, chain_size
from robokin.kinematics.velocity import differential_kinematics
from robokin.model import Joint, JointType, Robot
from robokin.spatial import rotation_from_rpy, transform, translation_transform


def moved_along(chain, shifts):
    """The chain with its joints' frames moved along their axes by shifts (n,)."""
    constants = chain.constants.copy()
    start = chain.start.copy()
    for i, shift in enumerate(shifts):
        constants[i] = constants[i] @ translation_transform([0.0, 0.0, shift])
        constants[i + 1] = translation_transform([0.0, 0.0, -shift]) @ constants[i + 1]
    start[2] -= shifts[0]
    return Chain(constants, chain.revolute, chain.offsets, start)


def turned(robot, row, angle, d):
    """The robot with the twist of a row off by an angle, and the next two d off by d and -d."""
    rows = list(robot.rows)
    rows[row] = replace(rows[row], alpha=rows[row].alpha + angle, d=rows[row].d + d)
    rows[row + 1] = replace(rows[row + 1], d=rows[row + 1].d - d)
    return replace(robot, rows=tuple(rows), poses={})


# What a hand adds up from the tables: the root of d² + a² row by row, but where axes are parallel.
@pytest.mark.parametrize(
    ("name", "size"),
    [
        ("planar2r", 1.0 + 0.6),
        ("anthropomorphic", 0.4 + 0.5),
        ("puma560", np.hypot(0.14909, 0.4318) + 0.02032 + 0.43307 + 0.05625),
        ("stanford", 0.154 + 0.263),
        # d4 counts along the first of the three parallel axes, where it makes the way least.
        ("ur5", 0.089159 + np.hypot(0.425, 0.10915) + 0.39225 + 0.09465 + 0.0823),
        ("irb120", sum(map(float, (0.29, 0.27, 0.07, 0.302, 0.072)))),
    ],
)
def test_sizes_of_tables(name, size):
    assert chain_size(chain_of(robokin.load(name))) == pytest.approx(size, rel=1e-12)


@pytest.mark.parametrize("name", ["puma560", "ur5", "stanford", "scara", "panda", "scorbot", "planar3r", "viperx300s"])
def test_the_size_does_not_depend_on_where_frames_stand(name, rng):
    chain = chain_of(robokin.load(name))
    shifts = np.where(chain.revolute, rng.uniform(-2.0, 2.0, chain.n), 0.0)
    assert chain_size(moved_along(chain, shifts)) == pytest.approx(chain_size(chain), rel=1e-12)


def test_a_slide_has_no_place(rng):
    chain = chain_of(robokin.load("stanford"))
    constants = chain.constants.copy()
    aside = rng.uniform(-1.0, 1.0, 3)
    constants[2] = constants[2] @ translation_transform(aside)
    constants[3] = translation_transform(-aside) @ constants[3]
    assert chain_size(Chain(constants, chain.revolute, chain.offsets, chain.start)) == pytest.approx(chain_size(chain))


def test_the_base_may_stand_anywhere():
    robot = robokin.load("ur5")
    away = transform(rotation_from_rpy([0.3, 0.2, 0.1]), np.array([10.0, -4.0, 3.0]))
    assert chain_size(chain_of(replace(robot, base=away))) == pytest.approx(chain_size(chain_of(robot)), rel=1e-12)


@pytest.mark.parametrize("angle", [1e-12, 1e-9, 1e-6, 1e-4])
def test_nearly_parallel_axes_are_as_good_as_parallel(angle):
    robot = robokin.load("ur5")
    size = chain_size(chain_of(robot))
    # d goes 100 m forth and back along axes at the angle: near the arm they are off by 100 m · angle.
    assert chain_size(chain_of(turned(robot, 1, angle, 100.0))) == pytest.approx(size, abs=250.0 * angle + 1e-11)


def test_the_size_has_no_jumps_from_parallel_axes_to_axes_at_an_angle():
    robot = robokin.load("ur5")
    angles = np.linspace(0.0, 0.3, 601)
    sizes = np.array([chain_size(chain_of(turned(robot, 1, angle, 0.0))) for angle in angles])
    assert np.max(np.abs(np.diff(sizes))) < 0.02


def test_an_arm_without_lengths_has_the_size_1():
    rows = tuple(Joint(f"q{i}", JointType.REVOLUTE, alpha=0.5 * np.pi) for i in range(3))
    assert chain_size(chain_of(Robot("wrist", rows))) == 1.0
    slides = tuple(Joint(f"q{i}", JointType.PRISMATIC, alpha=0.5 * np.pi) for i in range(3))
    assert chain_size(chain_of(Robot("slides", slides))) == 1.0


def test_a_chain_that_is_moved_to_the_arm_has_the_same_forward_kinematics(rng):
    robot = turned(robokin.load("ur5"), 1, 2e-5, 500.0)
    chain = chain_of(robot)
    assert np.max(np.abs(chain.constants[:, :3, 3])) < 1.0
    q = rng.uniform(-3.0, 3.0, (20, 6))
    T = robokin.forward_kinematics(robot, q)
    # The table's own frames go the long way.
    assert np.allclose(T, robokin.link_frames(robot, q)[:, -1] @ robot.tool, rtol=0, atol=1e-12)
    assert np.array_equal(chain.offsets, [joint.offset for joint in robot.joints])


def test_a_slide_is_moved_with_the_joint_before_it(rng):
    robot = turned(robokin.load("stanford"), 0, 0.0, 0.0)
    chain = chain_of(robot)
    far = moved_along(chain, np.array([0.0, 300.0, 0.0, -200.0, 0.0, 0.0]))
    rows = [replace(row) for row in robot.rows]
    frames = []
    for i, row in enumerate(rows):
        frames.append(
            replace(row, theta=0.0, d=0.0, a=0.0, alpha=0.0, origin=far.constants[i], axis=np.array([0.0, 0.0, 1.0]))
        )
    other = replace(robot, rows=tuple(frames), convention="frames", tool=far.constants[-1], base=np.eye(4))
    assert np.max(np.abs(chain_of(other).constants[:, :3, 3])) < 1.0
    q = rng.uniform(-2.0, 2.0, (10, 6))
    assert np.allclose(robokin.forward_kinematics(other, q), robokin.forward_kinematics(robot, q), rtol=0, atol=1e-12)


def test_the_condition_number_is_that_of_the_arm():
    nominal = robokin.load("ur5")
    robot = turned(nominal, 1, 2e-6, 500.0)
    q = [0.3, -1.1, 1.2, -0.4, 0.9, 0.2]
    expected = differential_kinematics(nominal, q).condition
    assert differential_kinematics(robot, q).condition == pytest.approx(expected, rel=0.02)
