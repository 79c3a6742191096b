"""Rotations and their parametrisations: each way back leads where it came from, everywhere."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sweeps import sweep

from robokin.spatial import (
    axis_angle_from_rotation,
    euler_from_rotation,
    nearest_rotation,
    quaternion_from_rotation,
    rotation_angle,
    rotation_error,
    rotation_from_axis_angle,
    rotation_from_euler,
    rotation_from_quaternion,
    rotation_from_rotation_vector,
    rotation_from_rpy,
    rotation_vector_from_rotation,
    rpy_from_rotation,
)

X, Y, Z = np.eye(3)


def turn(axis, angle):
    """A rotation by the textbook's three matrices, independent of the package."""
    c, s = np.cos(angle), np.sin(angle)
    i, j = [(1, 2), (2, 0), (0, 1)]["xyz".index(axis)]
    R = np.eye(3)
    R[i, i] = R[j, j] = c
    R[i, j], R[j, i] = -s, s
    return R


@pytest.mark.parametrize(("axis", "vector"), [("x", X), ("y", Y), ("z", Z)])
def test_a_rotation_about_a_main_axis_is_the_lectures_matrix(axis, vector):
    for angle in np.linspace(-7.0, 7.0, 29):
        assert np.allclose(rotation_from_axis_angle(vector, angle), turn(axis, angle), atol=1e-15)


def test_right_angles_are_exact():
    R = rotation_from_axis_angle(Z, np.pi / 2)
    assert R.tolist() == [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]


def test_rpy_turns_about_x_then_y_then_z_of_the_fixed_frame(rng):
    roll, pitch, yaw = rng.uniform(-3, 3, 3)
    expected = turn("z", yaw) @ turn("y", pitch) @ turn("x", roll)
    assert np.allclose(rotation_from_rpy([roll, pitch, yaw]), expected, atol=1e-15)


def test_euler_is_z_y_z(rng):
    phi, theta, psi = rng.uniform(-3, 3, 3)
    expected = turn("z", phi) @ turn("y", theta) @ turn("z", psi)
    assert np.allclose(rotation_from_euler([phi, theta, psi]), expected, atol=1e-15)


def test_a_quaternion_is_w_x_y_z_and_its_length_does_not_matter():
    half = np.sqrt(0.5)
    expected = turn("x", np.pi / 2)
    assert np.allclose(rotation_from_quaternion([half, half, 0, 0]), expected, atol=1e-15)
    assert np.allclose(rotation_from_quaternion([-3.0, -3.0, 0, 0]), expected, atol=1e-15)


WAYS = {
    "rpy": (rpy_from_rotation, rotation_from_rpy),
    "euler": (euler_from_rotation, rotation_from_euler),
    "quaternion": (quaternion_from_rotation, rotation_from_quaternion),
    "rotation vector": (rotation_vector_from_rotation, rotation_from_rotation_vector),
    "axis-angle": (axis_angle_from_rotation, lambda pair: rotation_from_axis_angle(*pair)),
}

angles = st.one_of(
    st.floats(-7.0, 7.0),
    st.sampled_from([k * np.pi / 2 for k in range(-4, 5)]),
    st.sampled_from([np.pi / 2, np.pi, 0.0]).flatmap(
        lambda a: st.sampled_from([1e-15, 1e-13, 1e-12, 1e-9, 1e-6]).map(lambda e: a + e)
    ),
)


@pytest.mark.parametrize("way", sweep(WAYS, 4))
@settings(derandomize=True, deadline=None, max_examples=400)
@given(three=st.tuples(angles, angles, angles))
def test_every_way_out_of_a_matrix_leads_back(way, three):
    out, back = WAYS[way]
    for R in (rotation_from_rpy(three), rotation_from_euler(three)):
        # At a singular place an outer angle is taken as zero, which moves an entry by twice SINGULAR at most.
        assert np.max(np.abs(back(out(R)) - R)) < 4e-12


@pytest.mark.parametrize("way", WAYS)
def test_batches_are_singles(way, rng):
    out, back = WAYS[way]
    R = rotation_from_rpy(rng.uniform(-4, 4, (2, 5, 3)))
    whole = out(R)
    single = out(R[1, 3])
    if way == "axis-angle":
        assert whole[0].shape == (2, 5, 3)
        assert whole[1].shape == (2, 5)
        assert np.allclose(whole[0][1, 3], single[0], atol=1e-15)
    else:
        assert whole.shape[:2] == (2, 5)
        assert np.allclose(whole[1, 3], single, atol=1e-15)
    assert np.allclose(back(whole), R, atol=1e-14)


def test_singular_places_have_their_stated_angle():
    for pitch in (np.pi / 2, -np.pi / 2):
        roll, found, yaw = rpy_from_rotation(rotation_from_rpy([0.3, pitch, 0.5]))
        assert roll == 0.0
        assert found == pytest.approx(pitch)
        assert yaw == pytest.approx(0.5 - 0.3 * np.sign(pitch))
    for theta in (0.0, np.pi):
        phi, found, psi = euler_from_rotation(rotation_from_euler([0.3, theta, 0.5]))
        assert phi == 0.0
        assert found == pytest.approx(theta)
        assert psi == pytest.approx(0.8 if theta == 0.0 else 0.2)
    axis, angle = axis_angle_from_rotation(np.eye(3))
    assert axis.tolist() == [0.0, 0.0, 1.0]
    assert angle == 0.0


@pytest.mark.parametrize("axis", [-X, -Y, -Z, [-1.0, 2.0, 0.5], [0.0, -1.0, 1.0]])
def test_half_turns_take_the_axis_with_a_positive_first_element(axis):
    found, angle = axis_angle_from_rotation(rotation_from_axis_angle(axis, np.pi))
    expected = -np.asarray(axis) / np.linalg.norm(axis)
    expected *= np.sign(expected[np.flatnonzero(expected)[0]])
    assert np.allclose(found, expected, atol=1e-12)
    assert angle == pytest.approx(np.pi)


@pytest.mark.parametrize("size", [0.0, 1e-13, 1e-9, 1e-3, 3.0, np.pi - 1e-9])
def test_rotation_vectors_keep_all_digits(size, rng):
    vectors = rng.normal(size=(50, 3))
    vectors *= size / np.linalg.norm(vectors, axis=1)[:, None]
    found = rotation_vector_from_rotation(rotation_from_rotation_vector(vectors))
    assert np.allclose(found, vectors, rtol=3e-15, atol=1e-15 * size)


def test_rotation_vectors_of_great_length_are_rotations():
    for vector in ([1e200, 0, 0], [1e300, -1e300, 1e300], [1e-320, 0, 0]):
        assert rotation_error(rotation_from_rotation_vector(vector)) < 1e-14


def test_quaternions_have_no_negative_w(rng):
    q = quaternion_from_rotation(rotation_from_rpy(rng.uniform(-4, 4, (500, 3))))
    assert np.all(q[:, 0] >= 0.0)
    assert np.allclose(np.linalg.norm(q, axis=1), 1.0, atol=1e-15)


@pytest.mark.parametrize("angle", [0.0, 1e-12, 1e-7, 1.0, np.pi - 1e-7, np.pi])
def test_the_angle_between_rotations_keeps_its_digits(angle, rng):
    R = rotation_from_rpy(rng.uniform(-3, 3, 3))
    D = rotation_from_axis_angle(rng.normal(size=3), angle)
    assert rotation_angle(R, R @ D) == pytest.approx(angle, abs=2e-15 if angle < 3 else 1e-14)


def test_how_far_a_matrix_is_from_a_rotation():
    assert rotation_error(np.eye(3)) == 0.0
    assert rotation_error(1.01 * np.eye(3)) == pytest.approx(0.0201)
    assert rotation_error(np.diag([1.0, 1.0, -1.0])) >= 2.0


def test_the_nearest_rotation_is_one_and_near(rng):
    R = rotation_from_rpy(rng.uniform(-3, 3, (50, 3)))
    near = nearest_rotation(R + 1e-4 * rng.normal(size=R.shape))
    assert np.max(rotation_error(near)) < 1e-14
    assert np.max(rotation_angle(R, near)) < 1e-3
    assert np.linalg.det(nearest_rotation(np.diag([1.0, 1.0, -0.9]))) == pytest.approx(1.0)


def test_no_axis_no_rotation():
    with pytest.raises(ValueError, match="axis"):
        rotation_from_axis_angle([0, 0, 0], 1.0)
    with pytest.raises(ValueError, match="quaternion"):
        rotation_from_quaternion([0, 0, 0, 0])
