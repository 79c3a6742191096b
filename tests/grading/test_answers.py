"""Poses and configurations: nothing that is off by more than is allowed passes, nothing that is off by less fails."""

from __future__ import annotations

import numpy as np
import pytest
from library_entries import names_of
from sweeps import sweep

import robokin
from robokin.grading.configuration_marks import mark_set, reached
from robokin.grading.pose_difference import (
    PASS,
    WRONG_ORIENTATION,
    WRONG_POSE,
    WRONG_POSITION,
    pose_errors,
    pose_status,
)
from robokin.grading.tolerance import Tolerance, default_tolerance
from robokin.model import Robot
from robokin.spatial import rotation_from_axis_angle, rotation_from_quaternion, rotation_transform, transform

ROBOTS = names_of(Robot, 1)
SOLVED = ["puma560", "ur5", "stanford", "scara", "planar3r", "kr6-r900", "irb120", "spherical-wrist"]


def direction(rng):
    v = rng.normal(size=3)
    return v / np.linalg.norm(v)


def configuration(robot, rng):
    low, high = np.clip(robot.limits, -2.0, 2.0).T
    return rng.uniform(low, high)


@pytest.mark.parametrize("name", sweep(ROBOTS, 4))
def test_poses_both_ways(name, rng):
    robot = robokin.load(name)
    allowed = default_tolerance(robot)
    T = robokin.forward_kinematics(robot, configuration(robot, rng))
    for shift, turn, status in (
        (0.999, 0.999, PASS), (1.0, 1.0, PASS), (1.001, 0.5, WRONG_POSITION), (0.5, 1.001, WRONG_ORIENTATION),
        (3.0, 40.0, WRONG_POSE),
    ):  # fmt: skip
        R = T[:3, :3] @ rotation_from_axis_angle(direction(rng), turn * allowed.angle)
        answer = transform(R, T[:3, 3] + shift * allowed.position * direction(rng))
        assert pose_status(*pose_errors(T, answer), allowed, T) == status


def test_a_half_turn_and_all_between_are_measured(rng):
    for angle in (1e-9, 1e-3, 1.0, 3.0, np.pi):
        R = rotation_transform(direction(rng), angle)
        assert pose_errors(np.eye(4), R)[1] == pytest.approx(angle, rel=1e-6)


def test_the_sign_of_a_quaternion_does_not_matter(rng):
    q = rng.normal(size=4)
    a, b = (transform(rotation_from_quaternion(sign * q), np.zeros(3)) for sign in (1.0, -1.0))
    assert pose_errors(a, b) == (0.0, 0.0)


def test_what_is_no_rotation_does_not_pass_for_the_nearest_one():
    M = np.diag([1.01, 1.01, 1.01, 1.0])
    assert pose_errors(np.eye(4), M)[1] > 0.01
    assert pose_errors(np.eye(4), np.diag([1.0, 1.0, -1.0, 1.0]))[1] > 1.0


def test_nan_never_passes():
    T = np.full((4, 4), np.nan)
    assert pose_status(*pose_errors(np.eye(4), T), Tolerance(1e9, 1e9), np.eye(4)) == WRONG_POSE


def test_the_relative_tolerance_adds_to_the_absolute_one():
    T = transform(np.eye(3), [2.0, 0.0, 0.0])
    allowed = Tolerance(0.01, 0.0, relative=0.05)
    for x, right in ((2.1099, True), (2.1101, False), (1.8901, True)):
        assert (pose_status(*pose_errors(T, transform(np.eye(3), [x, 0, 0])), allowed, T) == PASS) == right


def test_the_default_is_a_round_number_in_the_description():
    for name in ROBOTS:
        robot = robokin.load(name)
        allowed = default_tolerance(robot)
        in_unit = allowed.position / robot.units.metres
        assert float(f"{in_unit:.0e}") == pytest.approx(in_unit, rel=1e-12)
        assert 0.39e-3 * allowed.size <= allowed.position <= 1.0000001e-3 * allowed.size


# Configurations -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ROBOTS[::2])
def test_a_configuration_is_judged_by_where_it_leads(name, rng):
    robot = robokin.load(name)
    allowed = default_tolerance(robot)
    q = configuration(robot, rng)
    T = robokin.forward_kinematics(robot, q)
    assert reached(robot, q, T, allowed).status == PASS
    turned = q + 2.0 * np.pi * robot.revolute * rng.integers(-2, 3, robot.n)
    assert reached(robot, turned, T, allowed).status == PASS
    for step in (0.2, 5.0):
        near = q + step * rng.uniform(-1.0, 1.0, robot.n) * np.where(robot.revolute, allowed.angle, allowed.position)
        mark = reached(robot, near, T, allowed, limits=False)
        assert mark.right == (mark.position <= allowed.position and mark.angle <= allowed.angle)


def test_limits_are_inclusive_and_modulo_360():
    robot = robokin.load("puma560")
    allowed = default_tolerance(robot)
    q = np.zeros(6)
    q[0] = robot.limits[0, 1]
    for value, status in ((q[0], PASS), (q[0] + 1e-6, "outside limits"), (q[0] - 2.0 * np.pi, PASS)):
        p = np.array([value, *q[1:]])
        mark = reached(robot, p, robokin.forward_kinematics(robot, p), allowed)
        assert mark.status == status
    p = np.array([3.1, *q[1:]])
    assert reached(robot, p, robokin.forward_kinematics(robot, p), allowed).outside == (1,)


@pytest.mark.parametrize("name", SOLVED)
@pytest.mark.parametrize("seed", sweep(range(4), 4))
def test_sets_of_solutions(name, seed):
    rng, robot = np.random.default_rng(seed), robokin.load(name)
    allowed = default_tolerance(robot)
    T = robokin.forward_kinematics(robot, configuration(robot, rng))
    result = robokin.solve_ik(robot, T)
    assert result.complete
    # Rounded a little, turned by 360°, in another order: still all of them.
    turns = 2.0 * np.pi * robot.revolute
    small = 1e-5 * np.where(robot.revolute, 1.0, allowed.size)
    answers = [
        s.q + turns * rng.integers(-1, 2, robot.n) + rng.uniform(-1, 1, robot.n) * small for s in result.solutions
    ]
    inside = [q if reached(robot, q, T, allowed).right else s.q for q, s in zip(answers, result.solutions, strict=True)]
    order = rng.permutation(len(inside))
    mark = mark_set(robot, [inside[i] for i in order], T, allowed)
    assert (mark.status, mark.score, mark.missing) == (PASS, 1.0, ())
    count = len(inside)
    # One twice.
    mark = mark_set(robot, [*inside, inside[0]], T, allowed)
    assert (mark.status, mark.missing) == ("duplicate", ())
    assert mark.score == pytest.approx(count / (count + 1))
    # One wrong.
    wrong = inside[0] + 50.0 * np.where(robot.revolute, allowed.angle, allowed.position)
    mark = mark_set(robot, [*inside, wrong], T, allowed)
    assert mark.status == "extra"
    if count > 1:
        mark = mark_set(robot, inside[1:], T, allowed)
        assert mark.status == "missing solution"
        assert len(mark.missing) == 1
        assert np.allclose(mark.missing[0], result.solutions[0].q)
        assert mark.score == pytest.approx((count - 1) / count)
        assert mark_set(robot, [*inside[1:], wrong], T, allowed).status == "missing and extra"
        # The same twice in place of the missing one.
        again = mark_set(robot, [*inside[1:], inside[1]], T, allowed)
        assert again.status == "missing solution"
        assert again.score == pytest.approx((count - 1) / (count + 1))


def test_of_infinitely_many_none_is_missing():
    robot = robokin.load("puma560")
    home = robot.poses["home"]
    T = robokin.forward_kinematics(robot, home)
    other = home + np.array([0.0, 0.0, 0.0, 0.5, 0.0, -0.5])
    allowed = default_tolerance(robot)
    mark = mark_set(robot, [home, other], T, allowed)
    assert (mark.status, mark.counted) == (PASS, False)
    assert mark_set(robot, [home, home], T, allowed).status == "duplicate"


def test_a_target_whose_digits_were_cut_still_has_its_solutions():
    """The stretched arm's position rounded outwards is beyond reach by less than the tolerance."""
    robot = robokin.load("planar2r")
    T = robokin.forward_kinematics(robot, np.zeros(2))
    T[0, 3] += 5e-4
    mark = mark_set(robot, [np.zeros(2)], T, default_tolerance(robot), "position")
    assert mark.status == PASS
