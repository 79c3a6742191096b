"""Whatever is drawn has one answer, whatever its order, size and place."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from mobility.drawn import drawn
from mobility.test_library import anywhere
from sweeps import sweep

from robokin.mobility.verdict import mobility_of

HARD = (1397,)
"""A double curve, narrow in one direction and wide in others: three seemed to be its dimension, or none."""


def answer(found):
    """What must not change."""
    if found.motion is None:
        return found.verdict
    dimensions = tuple(sorted(size for size, _ in found.branches))
    # From Python, where nobody typed digits, "nearly" goes by how long the numbers are, and turning makes them long.
    verdict = "" if found.verdict in ("nearly", "right", "exceptional") else found.verdict
    return found.mobility, verdict, found.motion.instantaneous, found.motion.order, dimensions, found.motion.count


@pytest.mark.parametrize("part", sweep(range(4), 4))
def test_order_and_size_and_place_do_not_matter(part):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for seed in (*range(140), *HARD)[part::4]:
            mechanism = drawn(np.random.default_rng(seed))
            found = mobility_of(mechanism)
            for k, scale in enumerate((1e-3, 1e3)):
                other = mobility_of(anywhere(mechanism, np.random.default_rng(2 * seed + k), scale))
                assert answer(other) == answer(found), seed
            if found.motion is None:
                continue
            assert found.motion.finite <= found.motion.most <= found.motion.instantaneous
            assert found.mobility is None or found.motion.finite == found.motion.most
