"""Arbitrary numbers are those of numpy's generator."""

from __future__ import annotations

import numpy as np
import pytest

from robokin.jobs.arbitrary_numbers import FIRST, arbitrary


@pytest.mark.parametrize("seed", [*FIRST, 5])
def test_they_are_what_the_generator_draws(seed):
    for rows, columns in ((1, 6), (3, 6), (3, 8), (3, 9), (0, 3)):
        drawn = np.random.default_rng(seed).uniform(-1.0, 1.0, (rows, columns))
        assert np.array_equal(arbitrary(seed, rows, columns), drawn)
