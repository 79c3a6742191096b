"""Where neighbouring axes of a loop meet, and whether they are parallel."""

from __future__ import annotations

import math

import numpy as np

from robokin.arrays import Array
from robokin.inverse.elimination.loop import Loop

PARALLEL = 1e-6
"""Neighbouring axes whose angle has a smaller sine count as parallel where they should meet: two turns
about them are one."""

ORDINALS = ("1, 2, 3", "2, 3, 4", "3, 4, 5", "4, 5, 6")
"""Three consecutive joints by the first of them."""


class SingularEverywhereError(Exception):
    """A solver's equations do not determine the joints at any pose."""


def meeting_point(loop: Loop, first: int) -> tuple[float, float, float]:
    """How far axes first, first + 1, first + 2 are from meeting [size], and the point's z on the outer two.

    Infinity where neighbours are parallel.
    """
    L, M = loop.links[first], loop.links[first + 1]
    on_first, on_second = nearest_points(L)
    on_second_too, on_third = nearest_points(M)
    deviation = max(
        float(np.linalg.norm(L[:3, 3] + on_second * L[:3, 2] - [0.0, 0.0, on_first])),
        float(np.linalg.norm(M[:3, 3] + on_third * M[:3, 2] - [0.0, 0.0, on_second_too])),
        abs(on_second - on_second_too),
    )
    finite = math.isfinite(on_first) and math.isfinite(on_third)
    return (deviation if finite else math.inf), on_first, on_third


def nearest_points(L: Array) -> tuple[float, float]:
    """The z of the points nearest to each other on the z axes of a frame and of the frame L (4, 4) in it.

    NaN where the axes are parallel.
    """
    z, t = L[:3, 2], L[:3, 3]
    sine_squared = float(z[:2] @ z[:2])
    if sine_squared < PARALLEL**2:
        return math.nan, math.nan
    along = -float(t[:2] @ z[:2]) / sine_squared
    return float(t[2] + along * z[2]), along


def tilt(loop: Loop, first: int) -> float:
    """The greatest angle [rad], of neighbours, between the lines of axes first, first + 1, first + 2."""
    z = loop.links[first : first + 2, :3, 2]
    return float(np.max(np.arctan2(np.hypot(z[:, 0], z[:, 1]), np.abs(z[:, 2]))))
