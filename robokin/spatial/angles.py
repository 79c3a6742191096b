"""Angles on the circle."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from robokin.arrays import Array

TURN = 2.0 * math.pi
"""A full turn [rad]."""


def circled(values: Array, turning: NDArray[np.bool_] | bool = True) -> Array:
    """Values with angles in [-π, π], the others as they are; turning: which are angles, broadcast to the values."""
    return np.asarray(np.where(turning, values - TURN * np.round(values / TURN), values))
