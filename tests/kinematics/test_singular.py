"""Every condition that is named really is one, and the known ones are found."""

from __future__ import annotations

import numpy as np
import pytest
from library_entries import entry, names_of
from sweeps import sweep

import robokin
from robokin.inverse.analysis import analysis_of
from robokin.kinematics.velocity import motion_task
from robokin.model import Robot

CLOSED = [name for name in names_of(Robot, 1)[::5] if analysis_of(entry(name)).method != "elimination"]
SAMPLES = 100


def found(name, **parameters):
    return robokin.singular_configurations(robokin.load(name, **parameters))


def least(robot, q):
    """The least singular value that the arm has in general, as a part of the greatest."""
    values = robokin.differential_kinematics(robot, q).singular_values
    return values[..., -1] / values[..., 0]


def random_values(robot, rng, count):
    size = motion_task(robot).size
    return rng.uniform(-np.pi, np.pi, (count, robot.n)) * np.where(robot.revolute, 1.0, size)


# Arms with wrists and shoulders of the same make are sampled: every fifth keeps the run short.
@pytest.mark.parametrize(
    "name", sweep(sorted({*CLOSED, "puma560", "stanford", "ur5e", "scara", "spherical", "iiwa14"}), 4)
)
def test_a_condition_holds_whatever_the_other_joints_are(name, rng):
    robot = robokin.load(name)
    conditions = robokin.singular_configurations(robot)
    assert np.median(least(robot, random_values(robot, rng, SAMPLES))) > 1e-4
    for one in conditions:
        joints = [k - 1 for k in one.joints]
        for row in one.values:
            q = random_values(robot, rng, SAMPLES)
            q[:, joints] = row
            assert np.max(least(robot, q)) < 1e-7, one
        if one.equation is not None and one.enough:
            q = one.equation.solved(random_values(robot, rng, 4 * SAMPLES), joints[0])
            q = q[np.isfinite(q).all(axis=1)][:SAMPLES]
            assert len(q) == SAMPLES
            assert np.max(np.abs(one.equation.value(q))) < 1e-12
            assert np.max(least(robot, q)) < 1e-7, one
        found = robokin.differential_kinematics(robot, one.example)
        assert found.rank < found.task.dimension
        assert len(one.lost) >= 1


def names_and_joints(conditions):
    return [(one.name, one.joints) for one in conditions]


def test_puma():
    # J. Craig, Introduction to Robotics, 2005, section 5.8, and the factors of det J of any arm with such a wrist.
    shoulder, elbow, wrist = found("puma560")
    robot = robokin.load("puma560")
    a3, d4 = robot.rows[2].a, robot.rows[3].d
    assert names_and_joints([shoulder, elbow, wrist]) == [("shoulder", (2, 3)), ("elbow", (3,)), ("wrist", (5,))]
    assert shoulder.equation.lettered == "a2 c2 + a3 c23 + d4 s23 = 0"
    assert shoulder.enough
    assert np.allclose(elbow.values[:, 0], [np.arctan2(-d4, -a3), np.arctan2(d4, a3)], atol=1e-14)
    assert elbow.exact == ("atan2(-d4, -a3)", "atan2(d4, a3)")
    assert elbow.posture == ("folded", "stretched")
    assert elbow.inside == (False, True)
    assert np.allclose(wrist.values[:, 0], [0.0, np.pi], atol=0)
    assert wrist.inside == (True, False)


def test_conditions_are_all_there_is_for_a_spherical_wrist(rng):
    """det J over the product of the factors has neither zeros nor poles: it is the constant a2 at every sample."""
    robot = robokin.load("puma560")
    shoulder, _, _ = robokin.singular_configurations(robot)
    a2, a3, d4 = robot.rows[1].a, robot.rows[2].a, robot.rows[3].d
    q = rng.uniform(-3, 3, (200, 6))
    elbow = a3 * np.sin(q[:, 2]) - d4 * np.cos(q[:, 2])
    factors = shoulder.equation.value(q) * elbow * np.sin(q[:, 4])
    ratio = np.abs(np.linalg.det(robokin.jacobian(robot, q)) / factors)
    assert np.allclose(ratio, a2, rtol=1e-8)


@pytest.mark.parametrize(
    ("name", "expected"),
    sweep(
        [
            ("planar2r", [("elbow", (2,))]),
            ("planar3r", [("elbow", (2,))]),
            ("anthropomorphic", [("shoulder", (2, 3)), ("elbow", (3,))]),
            ("scara", [("elbow", (2,))]),
            ("spherical", [("shoulder", (2,)), ("boundary", (3,))]),
            ("stanford", [("shoulder", (2,)), ("boundary", (3,)), ("wrist", (5,))]),
            ("cylindrical", [("boundary", (3,))]),
            ("spherical-wrist", [("wrist", (2,))]),
            ("cartesian", []),
            ("ur5e", [("shoulder", (2, 3, 4)), ("elbow", (3,)), ("wrist", (5,))]),
            ("puma560-craig", [("shoulder", (2, 3)), ("elbow", (3,)), ("wrist", (5,))]),
            ("scorbot", [("shoulder", (2, 3, 4)), ("elbow", (3,))]),
            ("iiwa14", [("shoulder", (2, 3)), ("elbow", (4,)), ("wrist", (5, 6)), ("general", (2, 6))]),
        ],
        3,
    ),
)
def test_names(name, expected):
    assert names_and_joints(found(name)) == expected


def test_equations():
    assert found("anthropomorphic")[0].equation.lettered == "a2 c2 + a3 c23 = 0"
    assert found("ur5e")[0].equation.lettered == "a2 c2 + a3 c23 + d5 s234 = 0"
    # Where the arm has five joints a second equation must hold, and that is said.
    assert not found("scorbot")[0].enough


def test_the_redundant_arm_of_seven_joints():
    # M. Shimizu et al., Analytical inverse kinematic computation for 7-DOF redundant manipulators, 2008: the elbow
    # stretched; the shoulder straight with q3 = ±90°; the wrist straight with q5 = ±90°; both straight.
    shoulder, elbow, wrist, both = found("iiwa14")
    right = np.pi / 2
    assert {tuple(row) for row in shoulder.values} >= {(0.0, right), (0.0, -right)}
    assert elbow.values[:, 0].tolist() == [0.0, np.pi]
    assert {tuple(row) for row in wrist.values} >= {(right, 0.0), (-right, 0.0)}
    assert (0.0, 0.0) in {tuple(row) for row in both.values}


def test_parameters_move_the_conditions():
    elbow = found("planar2r", a1=3.0, a2=0.2)[0]
    assert elbow.values[:, 0].tolist() == [0.0, np.pi]
    assert elbow.posture == ("stretched", "folded")


def test_examples_are_the_same_in_every_run():
    one = robokin.singular_configurations(robokin.load("puma560"))
    other = robokin.singular_configurations(robokin.load("puma560"))
    assert all(np.array_equal(a.example, b.example) for a, b in zip(one, other, strict=True))
