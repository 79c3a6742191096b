"""The screw motion between two frames: against exponentials of twists, and where there is no axis."""

from __future__ import annotations

import numpy as np
import pytest

from robokin.spatial import invert, rotation_from_axis_angle, transform
from robokin.spatial.screw_motions import screw_between
from robokin.spatial.twists import exponential, logarithm


def frames(rng, count, angle=None):
    axes = rng.normal(size=(count, 3))
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    turns = rng.uniform(0.0, 3.1, count) if angle is None else np.full(count, angle)
    return transform(rotation_from_axis_angle(axes, turns), rng.uniform(-2.0, 2.0, (count, 3)))


def test_it_is_the_exponential_of_its_twist(rng):
    s = np.linspace(0.0, 1.0, 7)
    for first, step in zip(frames(rng, 50), frames(rng, 50), strict=True):
        last = step @ first
        twist = logarithm((last @ invert(first))[None])[0]
        wanted = exponential(s[:, None] * twist) @ first
        assert np.max(np.abs(screw_between(first, last).at(s) - wanted)) < 1e-12


@pytest.mark.parametrize("angle", [1e-8, 1e-3, 1.0, 3.0, np.pi])
def test_its_axis_is_the_line_that_only_slides(rng, angle):
    for first, step in zip(frames(rng, 20), frames(rng, 20, angle), strict=True):
        screw = screw_between(first, step @ first)
        place = np.append(screw.point, 1.0)
        moved = (step @ place - place)[:3]
        # What the entries of the rotations are rounded by places the axis, the farther away the worse.
        assert np.allclose(moved, screw.slide * screw.axis, atol=1e-13 * (1.0 + np.linalg.norm(screw.point)))
        assert screw.angle == pytest.approx(angle, rel=1e-6)
        assert abs(screw.point @ screw.axis) < 1e-9 * (1.0 + np.linalg.norm(screw.point))
        ends = screw.at(np.array([0.0, 1.0]))
        assert np.allclose(ends, [first, step @ first], atol=1e-12)


def test_the_pitch_is_the_slide_of_a_radian():
    step = transform(rotation_from_axis_angle(np.array([0.0, 0.0, 1.0]), 0.5), np.array([0.0, 0.0, 3.0]))
    screw = screw_between(np.eye(4), step)
    assert screw.pitch == pytest.approx(6.0)
    assert np.allclose(screw.point, 0.0)


def test_a_translation_has_no_axis_and_the_same_frame_no_motion(rng):
    (first,) = frames(rng, 1)
    last = first.copy()
    last[:3, 3] += [0.0, 3.0, 4.0]
    screw = screw_between(first, last)
    assert (screw.point, screw.pitch, screw.angle) == (None, None, 0.0)
    assert np.allclose(screw.axis, [0.0, 0.6, 0.8])
    assert screw.slide == pytest.approx(5.0)
    assert np.allclose(screw.at(np.array([0.5]))[0, :3, 3], first[:3, 3] + [0.0, 1.5, 2.0])
    still = screw_between(first, first)
    assert (still.axis, still.point, still.slide) == (None, None, 0.0)
    assert np.array_equal(still.at(np.array([0.3]))[0], first)
