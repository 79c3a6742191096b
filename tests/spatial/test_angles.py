"""Angles on the circle."""

from __future__ import annotations

import numpy as np

from robokin.spatial.angles import TURN, circled


def test_angles_are_brought_within_half_a_turn_by_full_turns(rng):
    q = rng.uniform(-50.0, 50.0, (200, 3))
    found = circled(q)
    assert np.max(np.abs(found)) <= np.pi
    turns = (q - found) / TURN
    np.testing.assert_allclose(turns, np.round(turns), atol=1e-12)
    np.testing.assert_allclose(np.sin(found), np.sin(q), atol=1e-13)
    assert np.array_equal(circled(found), found)


def test_what_slides_stays(rng):
    q = rng.uniform(-50.0, 50.0, (4, 5, 3))
    found = circled(q, np.array([True, False, True]))
    assert np.array_equal(found[..., 1], q[..., 1])
    assert np.array_equal(found[..., [0, 2]], circled(q[..., [0, 2]]))
    assert circled(np.zeros((0, 3)), np.ones(3, dtype=bool)).shape == (0, 3)
