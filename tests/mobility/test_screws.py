"""Twists and rigid motions: exponential and logarithm, the twists of joints by finite differences."""

from __future__ import annotations

import numpy as np
import pytest

from robokin.mobility.screws import elements_of, has_geometry, slide, turn
from robokin.model import MechanismJoint
from robokin.spatial import invert
from robokin.spatial.twists import exponential, logarithm, moved_screws


@pytest.mark.parametrize("angle", [0.0, 1e-12, 1e-6, 9e-5, 1.1e-4, 1e-3, 0.5, 2.0, 3.1, 3.14159])
def test_the_logarithm_undoes_the_exponential(rng, angle):
    w = rng.normal(size=(50, 3))
    w *= angle / np.linalg.norm(w, axis=1, keepdims=True)
    twists = np.concatenate([rng.normal(size=(50, 3)), w], axis=1)
    back = logarithm(exponential(twists))
    # Near half a turn the axis is read off a small difference.
    assert np.allclose(back, twists, atol=1e-13 + 1e-15 / (np.pi - angle) ** 2, rtol=0)


def test_the_exponential_is_rigid_and_adds_up(rng):
    twists = rng.normal(size=(50, 6))
    T = exponential(twists)
    assert np.allclose(T[:, :3, :3] @ T[:, :3, :3].transpose(0, 2, 1), np.eye(3), atol=1e-14)
    assert np.allclose(exponential(0.3 * twists) @ exponential(0.7 * twists), T, atol=1e-13)
    assert np.allclose(exponential(-twists), invert(T), atol=1e-13)
    assert np.array_equal(exponential(np.zeros((1, 6)))[0], np.eye(4))


def test_the_exponential_is_the_power_series(rng):
    """The matrix exponential of [[w]× v; 0 0], term by term."""
    for twist in rng.normal(size=(5, 6)):
        v, w = twist[:3], twist[3:]
        X = np.zeros((4, 4))
        X[:3, :3] = [[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]]
        X[:3, 3] = v
        total, term = np.eye(4), np.eye(4)
        for k in range(1, 40):
            term = term @ X / k
            total = total + term
        assert np.allclose(exponential(twist[None])[0], total, atol=1e-12)


def test_the_twist_of_a_turn_is_the_velocity_of_its_points(rng):
    at, axis, x = rng.normal(size=(3, 3))
    axis /= np.linalg.norm(axis)
    h = 1e-6
    T = exponential(np.stack([h * turn(at, axis), -h * turn(at, axis)]))
    ahead, back = (g[:3, :3] @ x + g[:3, 3] for g in T)
    assert np.allclose((ahead - back) / (2 * h), np.cross(axis, x - at), atol=1e-9)
    (g,) = exponential(turn(at, axis)[None])
    assert np.allclose(g[:3, :3] @ at + g[:3, 3], at), "points of the axis stay"
    assert np.allclose(exponential(slide(axis)[None])[0][:3, 3], axis)


def test_twists_are_carried_along(rng):
    """exp(Ad(g) S) = g exp(S) g⁻¹."""
    g, S = exponential(rng.normal(size=(20, 6))), rng.normal(size=(20, 6))
    assert np.allclose(exponential(moved_screws(g, S)), g @ exponential(S) @ invert(g), atol=1e-12)


def joint(kind, at=(1.0, 2.0, 3.0), axes=((0.0, 0.6, 0.8),), pitch=0.0, freedoms=1):
    return MechanismJoint("j", kind, ("a", "b"), freedoms, None if at is None else np.array(at),
                          None if axes is None else np.array(axes), pitch)  # fmt: skip


@pytest.mark.parametrize(
    ("kind", "freedoms"),
    [("fixed", 0), ("revolute", 1), ("rolling", 1), ("prismatic", 1), ("helical", 1), ("cylindrical", 2),
     ("spherical", 3), ("planar", 3)],
)  # fmt: skip
def test_a_joint_has_as_many_twists_as_freedoms(kind, freedoms):
    ((screws, labels),) = elements_of(joint(kind, pitch=0.2), np.zeros(3), 2.0)
    assert screws.shape == (freedoms, 6)
    assert len(labels) == freedoms
    assert freedoms == 0 or np.linalg.matrix_rank(screws) == freedoms


def test_a_universal_joint_is_two_hinges():
    parts = elements_of(joint("universal", axes=((1.0, 0, 0), (0, 1.0, 0))), np.zeros(3), 1.0)
    assert [screws.shape for screws, _ in parts] == [(1, 6), (1, 6)]
    assert np.allclose([screws[0, 3:] for screws, _ in parts], [[1, 0, 0], [0, 1, 0]])


def test_a_screw_goes_on_by_its_pitch():
    ((screws, _),) = elements_of(joint("helical", pitch=0.25), np.array([1.0, 2.0, 3.0]), 2.0)
    T = exponential(2 * np.pi * screws)[0]
    assert np.allclose(T[:3, :3], np.eye(3), atol=1e-13)
    assert np.allclose(T[:3, 3], 2 * np.pi * 0.25 / 2.0 * np.array([0, 0.6, 0.8]), atol=1e-13)


def test_a_contact_turns_and_slides_across_its_normal():
    ((screws, _),) = elements_of(joint("gear", axes=((0.6, 0.8, 0.0),), at=(0, 0, 0)), np.zeros(3), 1.0)
    assert np.allclose(screws, [[0, 0, 0, 0, 0, 1], [-0.8, 0.6, 0, 0, 0, 0]])


@pytest.mark.parametrize(
    ("kind", "at", "axes", "enough"),
    [("fixed", False, False, True), ("prismatic", False, True, True), ("prismatic", True, False, False),
     ("revolute", True, True, True), ("revolute", False, True, False), ("spherical", True, False, True),
     ("spherical", False, False, False), ("planar", False, True, True), ("gear", True, True, False)],
)  # fmt: skip
def test_what_geometry_a_joint_needs(kind, at, axes, enough):
    """The gear's axis here is the plane's normal, which is not that of the contact."""
    given = joint(kind, (0, 0, 0) if at else None, ((0, 0, 1.0),) if axes else None)
    assert has_geometry(given) is enough
