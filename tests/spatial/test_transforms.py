"""Rigid transforms: a group that acts on points."""

from __future__ import annotations

import numpy as np
import pytest

from robokin.spatial import (
    compose,
    invert,
    map_point,
    rotation_from_rpy,
    rotation_transform,
    transform,
    translation_transform,
    z_to,
)


def poses(rng, *shape):
    return transform(rotation_from_rpy(rng.uniform(-3, 3, (*shape, 3))), rng.normal(size=(*shape, 3)))


def test_an_inverse_undoes(rng):
    T = poses(rng, 4, 3)
    assert np.allclose(T @ invert(T), np.eye(4), atol=1e-14)
    assert np.allclose(invert(T), np.linalg.inv(T), atol=1e-13)


def test_composition_is_the_product_from_left_to_right(rng):
    A, B, C = poses(rng, 3)
    assert np.array_equal(compose(A, B, C), A @ B @ C)
    assert np.array_equal(compose(), np.eye(4))


def test_mapping_a_point_is_the_product_with_its_homogeneous_coordinates(rng):
    T, p = poses(rng, 5), rng.normal(size=(5, 3))
    expected = np.einsum("kij,kj->ki", T, np.c_[p, np.ones(5)])[:, :3]
    assert np.allclose(map_point(T, p), expected, atol=1e-15)
    assert map_point(T[0], p).shape == (5, 3)


def test_inner_letters_cancel(rng):
    T_a_b, T_b_c, p_c = poses(rng), poses(rng), rng.normal(size=3)
    assert np.allclose(map_point(T_a_b @ T_b_c, p_c), map_point(T_a_b, map_point(T_b_c, p_c)), atol=1e-14)


def test_a_point_in_a_turned_and_moved_frame():
    # Lecture 3, Homogeneous Transformations: frame {B} is turned by 30° about z and moved (10, 5, 0).
    T = translation_transform([10, 5, 0]) @ rotation_transform([0, 0, 1], np.radians(30))
    c, s = np.sqrt(3) / 2, 0.5
    assert np.allclose(map_point(T, [3, 7, 0]), [10 + 3 * c - 7 * s, 5 + 3 * s + 7 * c, 0], atol=1e-14)


@pytest.mark.parametrize("tilt", [0.0, 1e-300, 1e-17, 3e-13, 1e-6, 0.3, 1.0])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_z_is_taken_to_an_axis_however_near(tilt, sign):
    axis = np.array([tilt, -2.0 * tilt, sign]) * 3.0
    R = z_to(axis)[:3, :3]
    assert np.allclose(R[:, 2], axis / np.linalg.norm(axis), atol=2e-15)
    assert np.allclose(R @ R.T, np.eye(3), atol=1e-15)
