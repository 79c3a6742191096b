"""Points that fill the unit box: at random, on a grid, or evenly by Sobol's sequence, scrambled.

Any part of a sequence can be computed by itself, so that blocks of it may be made in any order, on any core
and after an interruption, and together are always the same points.

Sobol's points are those of S. Joe and F. Y. Kuo, "Constructing Sobol sequences with better two-dimensional
projections", SIAM J. Sci. Comput. 30, 2008 (their table new-joe-kuo-6), scrambled by a random lower triangular
matrix and a random digital shift (J. Matoušek, "On the L2-discrepancy for anchored boxes", J. Complexity 14, 1998):
each of several scramblings is as even as the sequence itself and each of its points is uniform, so that the
scatter of the scramblings' results is an estimate of their error.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from robokin.arrays import Array
from robokin.errors import InputError

Numbers = NDArray[np.uint64]
Kind = Literal["sobol", "random", "grid"]
KINDS = ("sobol", "random", "grid")

BITS = 52
"""Digits of a point: all that a float below 1 has."""

LOW = 12
"""Low bits of a point's number that one table serves for."""

# For each dimension from the second on: the primitive polynomial's coefficients between the first and the last,
# as a number, and the first direction numbers, as many as its degree.
_JOE_KUO = (
    (0, (1,)),
    (1, (1, 3)),
    (1, (1, 3, 1)),
    (2, (1, 1, 1)),
    (1, (1, 1, 3, 3)),
    (4, (1, 3, 5, 13)),
    (2, (1, 1, 5, 5, 17)),
    (4, (1, 1, 5, 5, 5)),
    (7, (1, 1, 7, 11, 19)),
    (11, (1, 1, 5, 1, 1)),
    (13, (1, 1, 1, 3, 11)),
    (14, (1, 3, 5, 5, 31)),
    (1, (1, 3, 3, 9, 7, 49)),
    (13, (1, 1, 1, 15, 21, 21)),
    (16, (1, 3, 1, 13, 27, 49)),
    (19, (1, 1, 1, 15, 7, 5)),
    (22, (1, 3, 1, 15, 13, 25)),
    (25, (1, 1, 5, 5, 19, 61)),
    (1, (1, 3, 7, 11, 23, 15, 103)),
    (4, (1, 3, 7, 13, 13, 15, 69)),
    (7, (1, 1, 3, 13, 7, 35, 63)),
    (8, (1, 3, 5, 9, 1, 25, 53)),
    (14, (1, 3, 1, 13, 9, 35, 107)),
)

MOST_DIMENSIONS = len(_JOE_KUO) + 1
"""Dimensions that the even sequence has direction numbers for; further ones are filled at random."""

RANDOM_BLOCK = 1 << 16
"""Random points come from one generator for each such block, so that any block can be had by itself."""


def unit_points(kind: Kind, dimensions: int, seed: int, start: int, count: int, total: int, scramble: int = 0) -> Array:
    """Points start … start + count - 1 of a sequence in the unit box: (dimensions, count).

    `total` is how many there will be in all (a grid is made for that number); `scramble` numbers independent
    sequences of one seed. Raises InputError for an unknown kind.
    """
    if kind == "sobol":
        return _sobol(dimensions, seed, start, count, scramble)
    if kind == "random":
        return _random(dimensions, seed, start, count, scramble)
    if kind == "grid":
        return _grid(dimensions, start, count, total)
    raise InputError(f"found sampling '{kind}', expected {' or '.join(KINDS)}")


def grid_sides(dimensions: int, total: int) -> int:
    """Points along each side of the finest grid of at most `total` points, at least 1."""
    if not dimensions:
        return 1
    side: int = round(float(total) ** (1.0 / dimensions)) + 1
    while side > 1 and side**dimensions > total:
        side -= 1
    return side


def _grid(dimensions: int, start: int, count: int, total: int) -> Array:
    """The points of a grid that includes the box's faces, the last dimension counting fastest."""
    side = grid_sides(dimensions, total)
    index = np.arange(start, min(start + count, side**dimensions))
    points = np.empty((dimensions, len(index)))
    for i in range(dimensions - 1, -1, -1):
        index, digit = np.divmod(index, side)
        points[i] = digit / (side - 1) if side > 1 else 0.5
    return points


def _random(dimensions: int, seed: int, start: int, count: int, scramble: int) -> Array:
    points = np.empty((dimensions, count))
    done = 0
    while done < count:
        block, offset = divmod(start + done, RANDOM_BLOCK)
        take = min(RANDOM_BLOCK - offset, count - done)
        drawn = np.random.default_rng((seed, scramble, block)).random((dimensions, RANDOM_BLOCK))
        points[:, done : done + take] = drawn[:, offset : offset + take]
        done += take
    return points


def _sobol(dimensions: int, seed: int, start: int, count: int, scramble: int) -> Array:
    even = min(dimensions, MOST_DIMENSIONS)
    points = np.empty((dimensions, count))
    numbers, shift, table = _directions(even, seed, scramble)
    # Point i is the exclusive or of the direction numbers at the ones of i: a table serves for i's low bits.
    row = np.empty(table.shape, dtype=np.uint64)
    for high in range(start >> LOW, ((start + count - 1) >> LOW) + 1):
        offset = shift.copy()
        for bit in range(high.bit_length()):
            if (high >> bit) & 1:
                offset ^= numbers[:, LOW + bit]
        np.bitwise_xor(table, offset[:, None], out=row)
        first = max(start - (high << LOW), 0)
        last = min(start + count - (high << LOW), 1 << LOW)
        place = (high << LOW) + first - start
        np.multiply(row[:, first:last], 2.0**-BITS, out=points[:even, place : place + last - first])
    # Half a unit off the digits' edge, so that no coordinate is 0.
    points[:even] += 2.0 ** -(BITS + 1)
    if dimensions > even:
        points[even:] = _random(dimensions - even, seed, start, count, scramble + 1)
    return points


def _combinations(numbers: Numbers) -> Numbers:
    """The exclusive or of every subset of numbers (d, k): (d, 2^k)."""
    table = np.zeros((len(numbers), 1), dtype=np.uint64)
    for column in numbers.T:
        table = np.concatenate([table, table ^ column[:, None]], axis=1)
    return table


@lru_cache(maxsize=64)
def _directions(dimensions: int, seed: int, scramble: int) -> tuple[Numbers, Numbers, Numbers]:
    """Scrambled direction numbers (dimensions, BITS), digital shifts (dimensions,), the low bits' table."""
    numbers = np.empty((dimensions, BITS), dtype=np.uint64)
    shift = np.empty(dimensions, dtype=np.uint64)
    for i in range(dimensions):
        # Each dimension has a generator of its own, so that it is the same whatever others there are.
        rng = np.random.default_rng((seed, scramble, 0x50B01, i))
        plain = _plain_directions(i)
        # Digit r of the scrambled number is digit r of the plain one plus a random sum of those before it.
        scrambled = [0] * BITS
        for r in range(BITS):
            mask = (int(rng.integers(0, 1 << r)) << (BITS - r)) | (1 << (BITS - 1 - r))
            for k, number in enumerate(plain):
                scrambled[k] |= ((number & mask).bit_count() & 1) << (BITS - 1 - r)
        numbers[i] = scrambled
        shift[i] = rng.integers(0, 1 << BITS, dtype=np.uint64)
    return numbers, shift, _combinations(numbers[:, :LOW])


def _plain_directions(dimension: int) -> list[int]:
    """Sobol's direction numbers of a dimension, as whole numbers of BITS digits."""
    if dimension == 0:
        return [1 << (BITS - 1 - k) for k in range(BITS)]
    coefficients, first = _JOE_KUO[dimension - 1]
    degree = len(first)
    m = list(first)
    for k in range(degree, BITS):
        value = m[k - degree] ^ (m[k - degree] << degree)
        for j in range(1, degree):
            if (coefficients >> (degree - 1 - j)) & 1:
                value ^= m[k - j] << j
        m.append(value)
    return [number << (BITS - 1 - k) for k, number in enumerate(m)]
