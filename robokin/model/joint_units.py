"""Joint values between SI and the units in which people say them."""

from __future__ import annotations

import numpy as np

from robokin.arrays import Array
from robokin.model import Robot, Tree
from robokin.units import Units, value_in_unit


def joint_factors(robot: Robot | Tree, units: Units) -> Array:
    """(n,) SI in one unit of each joint's value [rad | m]."""
    return np.where(robot.revolute, units.radians, units.metres)


def in_units(values: Array, factors: Array | float) -> Array:
    """SI values in units of `factors`, without the last digit's dust that the division leaves."""
    values, factors = np.broadcast_arrays(values, factors)
    found = map(value_in_unit, values.ravel().tolist(), factors.ravel().tolist())
    return np.array([*found]).reshape(values.shape)
