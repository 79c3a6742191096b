"""Points fill the box evenly, and any part of a sequence can be had by itself."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from robokin.errors import InputError
from robokin.jobs.sequences import (
    _JOE_KUO,
    BITS,
    KINDS,
    MOST_DIMENSIONS,
    RANDOM_BLOCK,
    _plain_directions,
    grid_sides,
    unit_points,
)


@pytest.mark.parametrize("kind", KINDS)
def test_any_part_of_a_sequence_is_that_part_of_the_whole(kind, rng):
    total = 3 * RANDOM_BLOCK
    whole = unit_points(kind, 3, 7, 0, total, total)
    last = whole.shape[1]
    for start in [0, 1, 4095, 4096, RANDOM_BLOCK - 1, *rng.integers(0, total, 6)]:
        count = int(rng.integers(1, 9000))
        part = unit_points(kind, 3, 7, int(start), count, total)
        assert np.array_equal(part, whole[:, start : min(start + count, last)][:, : part.shape[1]])
        assert part.shape[1] == max(min(count, last - start), 0) or kind != "grid"


@pytest.mark.parametrize("kind", ["sobol", "random"])
def test_a_dimension_is_the_same_whatever_others_there_are(kind):
    few, many = (unit_points(kind, k, 3, 100, 500, 1000) for k in (2, 6))
    assert np.array_equal(few, many[:2])


@pytest.mark.parametrize("kind", ["sobol", "random"])
def test_seeds_and_scramblings_are_sequences_of_their_own(kind):
    sequences = [unit_points(kind, 4, seed, 0, 64, 64, scramble) for seed in (0, 1) for scramble in (0, 1)]
    for a, b in itertools.combinations(sequences, 2):
        assert not np.any(a == b)


@pytest.mark.parametrize("seed", range(3))
def test_every_interval_has_its_share_in_every_dimension(seed):
    # A digital net: 2^k points at an aligned start, one in each of 2^k equal intervals.
    for k, start in [(6, 0), (9, 3 << 9), (12, 5 << 12)]:
        points = unit_points("sobol", MOST_DIMENSIONS, seed, start, 1 << k, 1 << 20)
        for row in points:
            assert np.array_equal(np.sort(np.floor(row * (1 << k))), np.arange(1 << k))


def test_every_box_has_its_share_in_the_first_two_dimensions():
    # Sobol's first two dimensions are a (0, k, 2)-net: one point in every elementary box.
    k = 8
    x, y = unit_points("sobol", 2, 5, 0, 1 << k, 1 << k)
    for i in range(k + 1):
        cells = np.floor(x * (1 << i)) * (1 << (k - i)) + np.floor(y * (1 << (k - i)))
        assert len(np.unique(cells)) == 1 << k


def test_direction_numbers_are_those_of_the_recurrence():
    # Odd and small, as Sobol's construction wants them; the first of four dimensions are worked out by hand.
    for i in range(MOST_DIMENSIONS):
        directions = _plain_directions(i)
        assert len(directions) == BITS
        for k, number in enumerate(directions):
            m = number >> (BITS - 1 - k)
            assert m % 2 == 1
            assert m < 2 << k
    first = np.array([[_plain_directions(i)[k] / 2**BITS for k in range(3)] for i in range(4)])
    assert np.array_equal(first, [[0.5, 0.25, 0.125], [0.5, 0.75, 0.625], [0.5, 0.75, 0.375], [0.5, 0.75, 0.125]])
    assert len({(len(m), a) for a, m in _JOE_KUO}) == len(_JOE_KUO)


def test_points_lie_within_the_box(rng):
    for kind in KINDS:
        points = unit_points(kind, 5, int(rng.integers(99)), 0, 5000, 5000)
        assert np.all((points >= 0) & (points <= 1))
    assert np.all((unit_points("sobol", 3, 0, 0, 5000, 5000) > 0) & (unit_points("sobol", 3, 0, 0, 5000, 5000) < 1))


def test_the_even_sequence_integrates_better_than_chance():
    # ∫ Π (1 + (x - 1/2)) = 1; the scatter of eight sequences.
    def scatter(kind):
        means = [
            np.mean(np.prod(0.5 + unit_points(kind, 5, 0, 0, 1 << 12, 1 << 12, scramble), axis=0))
            for scramble in range(8)
        ]
        return np.sqrt(np.mean((np.array(means) - 1.0) ** 2))

    assert scatter("sobol") < 0.05 * scatter("random")


def test_scramblings_are_not_biased():
    # The first point alone is uniform over the scramblings.
    first = np.array([unit_points("sobol", 1, 0, 0, 1, 1, scramble)[0, 0] for scramble in range(200)])
    assert abs(np.mean(first) - 0.5) < 4 * np.sqrt(1 / 12 / 200)


def test_dimensions_beyond_the_table_are_random():
    points = unit_points("sobol", MOST_DIMENSIONS + 3, 0, 0, 4096, 4096)
    assert points.shape == (MOST_DIMENSIONS + 3, 4096)
    assert np.all(np.abs(np.mean(points, axis=1) - 0.5) < 0.03)


@pytest.mark.parametrize(
    ("dimensions", "total", "side"), [(2, 100, 10), (2, 99, 9), (3, 1000, 10), (3, 1, 1), (6, 64, 2), (0, 9, 1)]
)
def test_a_grid_has_at_most_the_points_asked_for(dimensions, total, side):
    assert grid_sides(dimensions, total) == side
    points = unit_points("grid", dimensions, 0, 0, total, total)
    assert points.shape == (dimensions, side**dimensions)
    if dimensions:
        assert len(np.unique(points, axis=1).T) == side**dimensions
        if side > 1:
            assert np.min(points) == 0
            assert np.max(points) == 1


def test_an_unknown_kind_is_refused():
    with pytest.raises(InputError, match="expected sobol or random or grid"):
        unit_points("halton", 2, 0, 0, 1, 1)
