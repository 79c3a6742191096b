"""Outlines of sets whose boundary is known."""

from __future__ import annotations

import numpy as np
import pytest

from robokin.pictures.outline import signed_area, trace

FINE = 2e-6
"""Relative error of an area with a round boundary: some 500 corners, each with one between."""

BOX = np.array([-1.0, -1.0]), np.array([1.0, 1.0])


def ring(points):
    r = np.hypot(*points.T)
    return (r < 0.9) & (r > 0.3)


def test_a_ring_has_one_part_and_one_hole():
    outline = trace(ring, *BOX)
    assert (outline.pieces, len(outline.holes)) == (1, 1)
    assert outline.area == pytest.approx(np.pi * (0.81 - 0.09), rel=FINE)
    outside, hole = sorted(outline.loops, key=signed_area, reverse=True)
    assert np.allclose(np.hypot(*outside.T), 0.9, atol=1e-4)
    assert np.allclose(np.hypot(*hole.T), 0.3, atol=1e-4)


def test_a_set_that_fills_its_box_ends_at_the_box():
    outline = trace(lambda p: np.all(np.abs(p) <= 1.0, axis=1), *BOX)
    assert outline.pieces == 1
    # A corner is cut off at half a cell at most.
    assert outline.area == pytest.approx(4.0, abs=4 * outline.cell**2)


def test_the_set_is_on_the_left_of_its_boundary():
    outline = trace(ring, *BOX)
    for loop in outline.loops:
        along = np.roll(loop, -1, axis=0) - loop
        # Where the curve passes a point of the grid closely its sides are too short for a direction.
        sides = np.flatnonzero(np.linalg.norm(along, axis=1) > 0.1 * outline.cell)
        left = np.stack([-along[:, 1], along[:, 0]], axis=1)[sides]
        left /= np.linalg.norm(left, axis=1)[:, None]
        middle = (loop + 0.5 * along)[sides]
        assert np.all(ring(middle + 1e-3 * left))
        assert not np.any(ring(middle - 1e-3 * left))


def test_parts_that_touch_at_a_corner_close_their_curves():
    outline = trace(lambda p: (np.floor(3 * p[:, 0]) + np.floor(3 * p[:, 1])) % 2 == 0, *BOX, cells=30)
    assert outline.area == pytest.approx(2.0, rel=0.05)
    assert all(len(loop) > 8 for loop in outline.loops)


def test_nothing_has_no_outline():
    outline = trace(lambda p: np.zeros(len(p), dtype=bool), *BOX)
    assert (outline.loops, outline.area, outline.pieces) == ((), 0.0, 0)
