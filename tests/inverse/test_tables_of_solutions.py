"""What sorts solutions out without the native kernel: whole tables at once, as each target and each row by itself."""

from __future__ import annotations

import numpy as np
import pytest

from robokin.inverse import verify
from robokin.inverse.elimination import raghavan_roth
from robokin.inverse.self_motion import onto_limits
from robokin.inverse.self_motion.root_neighbours import NEIGHBOURS

TURN = 2.0 * np.pi


@pytest.mark.parametrize("missing", [False, True])
def test_configurations_are_sorted_by_target(missing, rng):
    index = np.tile(np.arange(40), 8)
    if missing:
        index = index[rng.uniform(size=len(index)) < 0.6]
    order, counts = verify._by_target(index)
    assert np.array_equal(order, np.argsort(index, kind="stable"))
    assert np.array_equal(counts, np.unique(index, return_counts=True)[1])


@pytest.mark.parametrize("width", [1, 8, verify.COLUMNS, verify.COLUMNS + 1])
def test_rows_are_ranked_by_keys_and_then_by_sums(width, rng):
    keys = rng.integers(0, 30, (200, width)) * (verify.NO_KEY // 31)
    keys[rng.uniform(size=keys.shape) < 0.2] = verify.NO_KEY
    sums = rng.uniform(size=keys.shape)
    expected = np.lexsort((sums, keys), axis=1)
    found = verify._ranked(keys, lambda: sums)
    # What fills a row up is in any order.
    filled = np.take_along_axis(keys, expected, axis=1) < verify.NO_KEY
    assert np.array_equal(found[filled], expected[filled])
    assert np.array_equal(np.sort(found, axis=1), np.tile(np.arange(width), (200, 1)))


def test_nothing_beside_its_limits_is_sorted_out(rng):
    limits = np.array([[-2.8, 2.8], [-4.0, 0.8], [-3.1, 3.1], [-np.inf, np.inf], [0.1, 0.4], [-1.0, 5.5]])
    revolute = np.array([True, True, True, True, False, True])
    scale = np.where(revolute, 1.0, 0.7)
    q = rng.uniform(-np.pi, np.pi, (4000, 6))
    q[:, 4] = rng.uniform(0.1, 0.4, 4000)
    for row, joint in enumerate(rng.integers(0, 6, 4000)):
        if joint != 3:
            end = limits[joint, rng.integers(2)]
            q[row, joint] = end + rng.uniform(-1.5, 1.5) * NEIGHBOURS * scale[joint]
    q, _ = verify.within_limits(verify.wrapped(q, revolute), revolute, limits, None)
    # Each row by itself: the gap that is left at the best of all turns.
    turned = q[:, :, None] + np.where(revolute, TURN, 0.0)[:, None] * np.arange(-2, 3)
    gaps = np.abs(np.clip(turned, limits[:, :1], limits[:, 1:]) - turned).min(axis=2) / scale
    beside = np.flatnonzero(gaps.max(axis=1) <= NEIGHBOURS)
    left = onto_limits._beside(q, np.arange(4000), revolute, limits, scale)
    assert len(beside) > 50
    assert np.isin(beside, left).all()
    assert gaps[left].max() <= 10.0 * NEIGHBOURS


def test_frames_of_a_candidate_do_not_depend_on_the_others(rng):
    """A product by BLAS has other last digits for one column than for many."""
    link = rng.normal(size=(1, 4, 4))
    link[:, 3] = 0.0, 0.0, 0.0, 1.0
    many = rng.normal(size=(4, 3, 37)) + 1j * rng.normal(size=(4, 3, 37))
    together = raghavan_roth._times_link(many, link)
    for i in range(37):
        alone = raghavan_roth._times_link(np.ascontiguousarray(many[..., i : i + 1]), link)
        assert alone.tobytes() == np.ascontiguousarray(together[..., i : i + 1]).tobytes()
    expected = np.einsum("kcs,kj->jcs", many, link[0])
    assert np.allclose(together, expected, rtol=0.0, atol=1e-13)
