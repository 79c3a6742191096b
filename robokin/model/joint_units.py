"""Joint values between SI and the units in which people say them."""

from __future__ import annotations

import numpy as np

from robokin.arrays import Array
from robokin.model import Robot, Tree
from robokin.units import Units


def joint_factors(robot: Robot | Tree, units: Units) -> Array:
    """(n,) SI in one unit of each joint's value [rad | m]."""
    return np.where(robot.revolute, units.radians, units.metres)


def in_units(values: Array, factors: Array | float) -> Array:
    """SI values in units of `factors`, without the last digit's dust that the division leaves.

    90° in radians and back is 90.00000000000001; a value within two units in the last place of one
    with twelve digits is that one.
    """
    scaled = values / factors
    short = np.array([float(f"{value:.12g}") for value in np.ravel(scaled)]).reshape(np.shape(scaled))
    return np.where(np.abs(scaled - short) <= 4.0 * np.spacing(np.abs(scaled)), short, scaled) + 0.0
