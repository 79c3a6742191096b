"""What is taken for a target: rotations whose digits were cut in print, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

import robokin
from robokin.errors import InputError
from robokin.inverse.solve import solve_many, target_poses
from robokin.spatial import nearest_rotation, rotation_error, rotation_from_rpy, transform


def printed(T, digits):
    """A pose with its rotation as it is printed with some digits after the point."""
    return transform(np.round(T[:3, :3], digits), T[:3, 3])


@pytest.mark.parametrize("digits", [4, 5, 6, 9])
def test_digits_cut_in_print_are_made_good(digits, rng):
    T = np.array([transform(rotation_from_rpy(rng.uniform(-3, 3, 3)), rng.uniform(-1, 1, 3)) for _ in range(50)])
    cut = np.array([printed(pose, digits) for pose in T])
    poses = target_poses(cut)
    assert np.max(rotation_error(poses[:, :3, :3])) < 1e-14
    assert np.max(np.abs(poses - T)) < 10.0**-digits
    assert np.array_equal(poses[:, :3, 3], T[:, :3, 3])
    assert np.allclose(poses[7, :3, :3], nearest_rotation(cut[7, :3, :3]), atol=1e-15)


def test_a_printed_matrix_has_the_solutions_of_its_rotation():
    robot = robokin.load("puma560")
    T = transform(rotation_from_rpy([0.0, 0.0, np.pi / 6.0]), np.array([0.4, 0.2, 0.1]))
    cut = T.copy()
    cut[:2, :2] = [[0.866, -0.5], [0.5, 0.866]]
    exact, found = (robokin.solve_ik(robot, pose, limits=False) for pose in (T, cut))
    assert len(exact.solutions) == len(found.solutions) > 0
    for one, other in zip(exact.solutions, found.solutions, strict=True):
        assert np.max(np.abs(one.q - other.q)) < 1e-4
    pose = target_poses(cut)
    for solution in found.solutions:
        assert np.max(np.abs(robokin.forward_kinematics(robot, solution.q) - pose)) < 1e-9


@pytest.mark.parametrize("far", [1.1e12, -1e100, 1e308])
def test_a_target_too_far_for_squares_is_refused(far):
    T = np.eye(4)
    T[1, 3] = far
    with pytest.raises(InputError, match=r"too far away, expected less than 1e\+12 m"):
        robokin.solve_ik(robokin.load("puma560"), T)


@pytest.mark.parametrize("number", [1e-300, 1e200, 1e308])
def test_great_and_small_numbers_are_no_rotation(number):
    with pytest.raises(InputError, match="rotation is off by"):
        solve_many(robokin.load("puma560"), np.diag([number, number, number, 1.0]))
