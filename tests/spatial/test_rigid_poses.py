"""Poses from expressions, positions and angles, and what a pose says: there and back."""

from __future__ import annotations

import numpy as np
import pytest

import robokin
from robokin import InputError

UNITS = [("m", "rad"), ("mm", "deg"), ("in", "rad"), ("cm", "deg")]
FORMS = ("rpy", "euler", "quaternion", "rotvec")


def random_poses(rng, count):
    """Poses of which some are round: no turn, half turns, right angles, singular triples of angles."""
    T = np.tile(np.eye(4), (count, 1, 1))
    axes = rng.normal(size=(count, 3))
    T[:, :3, :3] = robokin.rotation_from_axis_angle(axes, rng.uniform(0, np.pi, count))
    T[:, :3, 3] = rng.uniform(-2, 2, (count, 3))
    round_ones = [robokin.pose(f"Rot({axis}, {turns}*pi/2)") for axis in "xyz" for turns in range(4)]
    return np.concatenate([T, round_ones])


@pytest.mark.parametrize("length, angle", UNITS)
def test_what_a_pose_says_makes_it_again(rng, length, angle):
    T = random_poses(rng, 50)
    parts = robokin.pose_parts(T, length=length, angle=angle)
    for form in FORMS:
        again = robokin.pose(parts.position, **{form: getattr(parts, form)}, length=length, angle=angle)
        assert np.max(np.abs(again - T)) < 1e-13, form
    assert np.allclose(robokin.pose(parts.position, R=parts.rotation, length=length), T, atol=1e-14)
    turned = parts.angle * (np.pi / 180 if angle == "deg" else 1)
    assert np.allclose(robokin.rotation_from_axis_angle(parts.axis, turned), T[:, :3, :3], atol=1e-14)


def test_the_parts_are_those_of_the_shell():
    T = robokin.pose("Trans(4,-3,7) Rot(y,90) Rot(z,90)", angle="deg")
    parts, document = robokin.pose_parts(T, angle="deg"), robokin.documents.frame("Trans(4,-3,7) Rot(y,90) Rot(z,90)")
    for name in ("position", "rpy", "euler", "quaternion"):
        assert np.allclose(getattr(parts, name), document[name], atol=1e-12), name


def test_an_expression_is_that_of_a_description():
    T = robokin.pose("Trans(400, 0, 300) RPY(0, 90, 0)", length="mm", angle="deg")
    assert np.array_equal(T, robokin.transform("Trans(400, 0, 300) RPY(0, 90, 0)", robokin.Units("mm", "deg")))
    assert np.allclose(T, robokin.pose([400, 0, 300], rpy=[0, 90, 0], length="mm", angle="deg"), atol=1e-15)
    assert np.array_equal(robokin.pose([1, 2, 3]), robokin.pose("Trans(1, 2, 3)"))


def test_an_inverse_takes_back(rng):
    T = random_poses(rng, 20)
    assert np.allclose(robokin.invert_pose(T) @ T, np.eye(4), atol=1e-14)
    assert np.allclose(robokin.invert_pose(robokin.invert_pose(T)), T, atol=1e-14)
    # The slide of Lecture 3 (after Craig), Inverted Transformation.
    back = robokin.invert_pose(robokin.pose("Trans(4,3,0) Rot(z,30)", angle="deg"))
    assert np.allclose(back[:3, 3], [-4.964101615137754, -0.598076211353316, 0], atol=1e-14)


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: robokin.pose("Rot(z, 1)", rpy=[0, 0, 0]), "rpy: is for a position"),
        (lambda: robokin.pose([1, 2, 3], rpy=[0, 0, 0], euler=[0, 0, 0]), "found rpy and euler, expected one of"),
        (lambda: robokin.pose([1, 2]), r"what: found an array of shape \(2,\)"),
        (lambda: robokin.pose(None), "what: found None, expected an expression"),
        (lambda: robokin.pose([1, 2, 3], rpy=[1, 2]), r"rpy: found an array of shape \(2,\), expected roll, pitch"),
        (lambda: robokin.pose([1, 2, 3], quaternion=[0, 0, 0, 0]), "quaternion: found a vector of zeros"),
        (lambda: robokin.pose([[1, 2, 3]] * 2, rpy=[[0, 0, 0]] * 3), "rpy: .*expected one for each position"),
        (lambda: robokin.pose([1, 2, 3], R=np.eye(4)), r"R: found an array of shape \(4, 4\)"),
        (lambda: robokin.pose([1, 2, 3], length="km"), "length: found 'km', expected 'm', 'cm', 'mm' or 'in'"),
        (lambda: robokin.pose([1, 2, 3], angle="degrees"), "angle: found 'degrees'"),
        (lambda: robokin.pose([1e13, 0, 0]), "what: found a pose too far away"),
        (lambda: robokin.pose_parts(np.eye(3)), r"T: found an array of shape \(3, 3\), expected poses"),
        (lambda: robokin.pose_parts(2 * np.eye(4)), "T: found a pose whose last row is not 0 0 0 1"),
        (lambda: robokin.pose_parts(np.diag([1, 1, -1, 1])), "T: found a pose whose rotation is off by 2"),
        (lambda: robokin.invert_pose(np.full((4, 4), np.nan)), "T: found a pose with a number that is not finite"),
        (lambda: robokin.invert_pose("Rot(z, 1)"), r"T: found the string 'Rot\(z, 1\)', expected poses"),
    ],
)
def test_a_slip_is_said_with_its_argument(call, said):
    with pytest.raises(InputError, match=said):
        call()
