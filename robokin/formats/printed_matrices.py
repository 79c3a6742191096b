"""Homogeneous matrices as people write them: printed with few digits, or without their last row."""

from __future__ import annotations

import numpy as np

from robokin.arrays import Array
from robokin.spatial import nearest_rotation, rotation_error, transform
from robokin.spatial.rotations import DIGITS_LOST
from robokin.units import Units

ROUNDING = 1e-12
"""A matrix this near to a rotation is taken as it stands."""


def pose_from_matrix(rows: object, units: Units) -> tuple[Array, str]:
    """A pose (4, 4) [m] from a homogeneous matrix in the given length unit, and a note or "".

    Three rows of four are taken too (the last one is 0 0 0 1). A rotation whose digits were cut is made
    a rotation and a note says by how much it was off. Raises ValueError when it is no pose, saying how far off.
    """
    try:
        M = np.array(rows, dtype=np.float64)
    except (TypeError, ValueError):
        raise ValueError("found rows that are not numbers of one count, expected 4 rows of 4 numbers") from None
    if M.shape == (3, 4):
        M = np.vstack([M, [0.0, 0.0, 0.0, 1.0]])
    if M.shape != (4, 4):
        shape = "×".join(str(count) for count in M.shape)
        raise ValueError(f"found a matrix of {shape}, expected 4×4")
    if not np.all(np.isfinite(M)):
        raise ValueError("found a number that is not finite in the matrix, expected finite numbers")
    if np.max(np.abs(M[3] - [0.0, 0.0, 0.0, 1.0])) > ROUNDING:
        raise ValueError(f"found the last row {' '.join(f'{v:g}' for v in M[3])}, expected 0 0 0 1")
    R = M[:3, :3]
    with np.errstate(all="ignore"):  # of great numbers the products overflow, and are refused
        off = float(rotation_error(R))
        reflects = np.linalg.det(R) < 0.0
    if reflects:
        raise ValueError("found a reflection in the upper left 3×3 (its determinant is negative), expected a rotation")
    if not off <= DIGITS_LOST:
        raise ValueError(
            f"found no rotation in the upper left 3×3: RᵀR is off by {off:.2g}, expected at most {DIGITS_LOST:g}"
        )
    note = ""
    if off > ROUNDING:
        R = nearest_rotation(R)
        note = f"the matrix is a rotation only to {off:.1g}; the nearest rotation is taken"
    return transform(R, M[:3, 3] * units.metres), note
