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
    on_first, on_second, apart = nearest_points(loop.links[first])
    on_second_too, on_third, apart_too = nearest_points(loop.links[first + 1])
    deviation = max(apart, apart_too, abs(on_second - on_second_too))
    finite = math.isfinite(on_first) and math.isfinite(on_third)
    return (deviation if finite else math.inf), on_first, on_third


def nearest_points(L: Array) -> tuple[float, float, float]:
    """The z of the points nearest to each other on the z axes of a frame and of the frame L (4, 4) in it.

    The third number is how far they are from each other. NaN where the axes are parallel.
    """
    x, y, z = L[:3, 2].tolist()
    t_x, t_y, t_z = L[:3, 3].tolist()
    sine_squared = x * x + y * y
    if sine_squared < PARALLEL**2:
        return math.nan, math.nan, math.nan
    along = -(t_x * x + t_y * y) / sine_squared
    return t_z + along * z, along, math.hypot(t_x + along * x, t_y + along * y)


def tilt(loop: Loop, first: int) -> float:
    """The greatest angle [rad], of neighbours, between the lines of axes first, first + 1, first + 2."""
    z = loop.links[first : first + 2, :3, 2]
    return float(np.max(np.arctan2(np.hypot(z[:, 0], z[:, 1]), np.abs(z[:, 2]))))
