"""What a rotation says in angles and in a quaternion, by its entries: of one rotation floats, of many arrays.

Each formula stands here once. `maths` brings the functions: numpy for arrays, `Floats` for floats, which loads nothing.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

TYPE_CHECKING = False  # `typing` has the same, and takes a while to load
if TYPE_CHECKING:
    from typing import Any

    Rows = Sequence[Sequence[Any]]
    """Three rows of three entries, floats or arrays (...)."""

SINGULAR = 1e-12
"""Below this sine (of the middle angle) a triple of angles is singular.

It stands well above the rounding of a product of ten matrices (about 1e-15) and setting the outer
angle to zero there moves the matrix by no more than this.
"""

NO_DIGIT = 1e-16
"""An element of a unit quaternion below this is rounding of a zero."""


class Floats:
    """The functions of numpy that the formulas ask for, of floats."""

    arctan2 = staticmethod(math.atan2)
    cos = staticmethod(math.cos)
    sin = staticmethod(math.sin)
    sqrt = staticmethod(math.sqrt)
    rint = staticmethod(round)
    maximum = staticmethod(max)
    minimum = staticmethod(min)

    @staticmethod
    def hypot(x: float, y: float) -> float:
        """√(x² + y²), by the C library as numpy has it; math.hypot differs in its last digit."""
        return abs(complex(x, y))

    @staticmethod
    def where(condition: bool, value: float, other: float) -> float:
        """One of two values."""
        return value if condition else other


def rpy_of_entries(R: Rows, maths: Any) -> tuple[Any, Any, Any]:
    """Roll, pitch and yaw [rad]; see `spatial.rotations.rpy_from_rotation`."""
    cp = maths.hypot(R[2][1], R[2][2])
    roll = maths.where(cp > SINGULAR, maths.arctan2(R[2][1], R[2][2]), 0.0)
    pitch = maths.arctan2(-R[2][0], cp)
    # The second column of R Rx(-roll) is (-sin yaw, cos yaw, 0). Taken from there, yaw makes up for
    # any rounding of roll near the singularity, so that the matrix is always given back.
    c, s = maths.cos(roll), maths.sin(roll)
    yaw = maths.arctan2(s * R[0][2] - c * R[0][1], c * R[1][1] - s * R[1][2])
    return roll, pitch, yaw


def quaternion_products(R: Rows) -> list[list[Any]]:
    """4 times the products of the elements w, x, y, z with each other: the columns of 4 q qᵀ."""
    a, b, c = R[0][0], R[1][1], R[2][2]
    wx, wy, wz = R[2][1] - R[1][2], R[0][2] - R[2][0], R[1][0] - R[0][1]
    xy, xz, yz = R[0][1] + R[1][0], R[0][2] + R[2][0], R[1][2] + R[2][1]
    return [
        [1 + a + b + c, wx, wy, wz],
        [wx, 1 + a - b - c, xy, xz],
        [wy, xy, 1 - a + b - c, yz],
        [wz, xz, yz, 1 - a - b + c],
    ]


def quaternion_of_floats(R: Sequence[Sequence[float]]) -> list[float]:
    """The unit quaternion w, x, y, z of one rotation; see `spatial.rotations.quaternion_from_rotation`."""
    products = quaternion_products(R)
    greatest = max(range(4), key=lambda i: products[i][i])
    length = math.sqrt(sum(value * value for value in products[greatest]))
    q = [value / length for value in products[greatest]]
    q = [0.0 if abs(value) < NO_DIGIT else value for value in q]
    sign = math.copysign(1.0, next(value for value in q if value))
    return [value * sign for value in q]
