"""Rank, manipulability and what is lost: the closed forms of the books, and what the words claim."""

from __future__ import annotations

import re

import numpy as np
import pytest

import robokin
from robokin.errors import InputError
from robokin.kinematics.forward import joint_frames
from robokin.kinematics.velocity import lost_directions, motion_task, null_space_joints, scaled, wrist_centre

DK = robokin.differential_kinematics


@pytest.mark.parametrize(
    ("name", "task", "dimension"),
    [
        ("planar2r", "position", 2),
        ("planar3r", "pose", 3),
        ("anthropomorphic", "position", 3),
        ("spherical", "position", 3),
        ("cylindrical", "position", 3),
        ("cartesian", "position", 3),
        ("spherical-wrist", "orientation", 3),
        ("scara", "pose", 4),
        ("scorbot", "pose", 5),
        ("puma560", "pose", 6),
        ("panda", "pose", 6),
    ],
)
def test_what_counts_for_an_arm(name, task, dimension):
    kind = motion_task(robokin.load(name))
    assert (kind.name, kind.dimension) == (task, dimension)


def test_manipulability_of_two_links(rng):
    # T. Yoshikawa, Manipulability of robotic mechanisms, 1985, eq. (17): l1 l2 |sin q2|.
    q = rng.uniform(-3, 3, (50, 2))
    found = DK(robokin.load("planar2r", a1=0.9, a2=0.4), q)
    assert np.allclose(found.manipulability, 0.36 * np.abs(np.sin(q[:, 1])), atol=1e-14)


def test_manipulability_of_the_anthropomorphic_arm(rng):
    # B. Siciliano et al., 2009, eq. (3.45): det J_P = -a2 a3 s3 (a2 c2 + a3 c23).
    robot = robokin.load("anthropomorphic")
    a2, a3 = (row.a for row in robot.rows[1:])
    q = rng.uniform(-3, 3, (50, 3))
    expected = a2 * a3 * np.sin(q[:, 2]) * (a2 * np.cos(q[:, 1]) + a3 * np.cos(q[:, 1] + q[:, 2]))
    assert np.allclose(DK(robot, q).manipulability, np.abs(expected), atol=1e-14)


def test_manipulability_of_a_square_jacobian_is_its_determinant(rng):
    robot = robokin.load("puma560")
    q = rng.uniform(-3, 3, (4, 5, 6))
    found = DK(robot, q)
    assert found.rank.shape == (4, 5)
    assert np.allclose(found.manipulability, np.abs(np.linalg.det(robokin.jacobian(robot, q))), rtol=1e-9)


def test_manipulability_of_a_redundant_arm(rng):
    robot = robokin.load("panda")
    q = rng.uniform(-1, 1, (20, 7))
    J = robokin.jacobian(robot, q)
    assert np.allclose(DK(robot, q).manipulability ** 2, np.linalg.det(J @ np.swapaxes(J, 1, 2)), rtol=1e-8)


def test_the_frame_changes_no_number(rng):
    robot = robokin.load("ur5e")
    q = rng.uniform(-3, 3, (20, 6))
    base, tool = DK(robot, q), DK(robot, q, frame="tool")
    assert np.allclose(base.singular_values, tool.singular_values, atol=1e-14)
    assert np.allclose(base.manipulability, tool.manipulability, rtol=1e-10)


def test_scaling_an_arm_changes_no_singular_value(rng):
    q = rng.uniform(-3, 3, (20, 2))
    one, other = (DK(robokin.load("planar2r", a1=k, a2=0.6 * k), q) for k in (1.0, 7.0))
    assert np.allclose(one.singular_values, other.singular_values, atol=1e-14)
    assert np.allclose(one.condition, other.condition, rtol=1e-9)
    assert np.allclose(49.0 * one.manipulability, other.manipulability, rtol=1e-12)


def test_condition_and_rank(rng):
    robot = robokin.load("puma560")
    q = rng.uniform(-3, 3, 6)
    found = DK(robot, q)
    assert found.rank == 6
    assert found.condition == pytest.approx(found.singular_values[0] / found.singular_values[-1])
    q[4] = 0.0
    found = DK(robot, q)
    assert (found.rank, found.manipulability, found.condition) == (5, 0.0, np.inf)
    assert null_space_joints(found) == [(4, 6)]


def test_joints_of_the_null_space_move_nothing(rng):
    for name, count in (("panda", 1), ("human-arm", 3)):
        robot = robokin.load(name)
        q = rng.uniform(-1, 1, (10, robot.n))
        found = DK(robot, q)
        null = found.null_space[:, -count:]
        S = scaled(robot, found.jacobian, found.task.size)
        assert np.max(np.abs(np.einsum("mij,mkj->mik", S, null))) < 1e-12
        for joints, rows in zip(null_space_joints(found), null, strict=True):
            assert {k + 1 for k in np.flatnonzero(np.max(np.abs(rows), axis=0) > 1e-4)} <= set(joints)


@pytest.mark.parametrize("frame", ["base", "tool"])
@pytest.mark.parametrize(
    ("name", "joint", "value"), [("puma560", 4, 0.0), ("ur5e", 2, 0.0), ("planar3r", 1, 0.0), ("scara", 1, np.pi)]
)
def test_what_is_lost_is_made_by_no_joint(name, joint, value, frame, rng):
    robot = robokin.load(name)
    for _ in range(5):
        q = rng.uniform(-2, 2, robot.n)
        q[joint] = value
        (lost,) = lost_directions(robot, q, frame)
        size = motion_task(robot).size
        made = lost.twist @ scaled(robot, robokin.jacobian(robot, q, frame), size)
        assert np.linalg.norm(lost.twist) == pytest.approx(1.0)
        assert np.max(np.abs(made)) < 1e-12


def test_words_of_a_stretched_arm():
    (lost,) = lost_directions(robokin.load("planar2r"), [0.0, 0.0])
    assert lost.words == "translation along [1, 0, 0]"
    (lost,) = lost_directions(robokin.load("planar3r"), [np.pi / 2, 0.0, 1.0])
    assert lost.words == "translation of joint 3 along [0, 1, 0]"


def test_words_of_a_straight_wrist(rng):
    """The wrist centre held, the hand cannot turn about the normal of axes 4 and 5."""
    robot = robokin.load("puma560")
    q = rng.uniform(-1, 1, 6)
    q[4] = 0.0
    (lost,) = lost_directions(robot, q)
    z4, z5 = robokin.link_frames(robot, q)[3:5, :3, 2]
    axis = np.array([float(x) for x in re.search(r"\[(.*)\]", lost.words)[1].split(",")])
    assert lost.words.startswith("rotation about")
    assert lost.words.endswith("while the wrist centre stands still")
    assert abs(axis @ np.cross(z4, z5)) == pytest.approx(1.0, abs=1e-4)


def test_what_an_arm_never_has_is_no_loss(rng):
    assert lost_directions(robokin.load("planar2r"), [0.3, 0.7]) == []
    assert lost_directions(robokin.load("scara"), [0.3, 0.7, 0.1, 0.2]) == []


def test_a_robot_without_joints_and_an_unknown_task_are_refused():
    with pytest.raises(InputError, match="no joints"):
        DK(robokin.load("assembly"), [])
    with pytest.raises(InputError, match="expected 'pose', 'position' or 'orientation'"):
        DK(robokin.load("puma560"), np.zeros(6), task="twist")


def test_the_wrist_centre_is_on_the_last_three_axes(rng):
    # The last one's frames lie apart from the point where its axes meet.
    for name in ("puma560", "irb120", "kr6-r900", "viperx300s", "iiwa14", "human-arm"):
        robot = robokin.load(name)
        F = joint_frames(robot, rng.uniform(-2, 2, (5, robot.n)))
        centre = wrist_centre(robot, F)
        away = centre[:, None] - F[:, -4:-1, :3, 3]
        assert np.max(np.linalg.norm(np.cross(away, F[:, -4:-1, :3, 2]), axis=2)) < 1e-6
    assert wrist_centre(robokin.load("ur5e"), joint_frames(robokin.load("ur5e"), np.zeros(6))) is None
