"""Rigid transforms as homogeneous matrices (..., 4, 4): make, compose, invert, apply."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from robokin.arrays import Array
from robokin.spatial.rotations import rotation_from_axis_angle

FARTHEST = 1e12
"""Metres: no arm reaches that far, and the squares of what is much farther are no numbers."""


def transform(R: ArrayLike, p: ArrayLike) -> Array:
    """The pose with rotation R: (..., 3, 3) and origin p: (..., 3) [m]. Returns (..., 4, 4)."""
    R, p = np.asarray(R, dtype=np.float64), np.asarray(p, dtype=np.float64)
    T = np.zeros((*np.broadcast_shapes(R.shape[:-2], p.shape[:-1]), 4, 4))
    T[..., :3, :3] = R
    T[..., :3, 3] = p
    T[..., 3, 3] = 1.0
    return T


def translation_transform(p: ArrayLike) -> Array:
    """The translation by p: (..., 3) [m]. Returns (..., 4, 4)."""
    return transform(np.eye(3), p)


def rotation_transform(axis: ArrayLike, angle: ArrayLike) -> Array:
    """The rotation about axis: (..., 3) through the origin by angle: (...) [rad]. Returns (..., 4, 4)."""
    return transform(rotation_from_axis_angle(axis, angle), np.zeros(3))


def compose(*transforms: ArrayLike) -> Array:
    """The product of transforms (..., 4, 4) from left to right; the identity for none."""
    T = np.eye(4)
    for factor in transforms:
        T = T @ np.asarray(factor, dtype=np.float64)
    return T


def invert(T: ArrayLike) -> Array:
    """The inverse of rigid transforms T: (..., 4, 4): (Rᵀ, -Rᵀp), with no general matrix inversion."""
    T = np.asarray(T, dtype=np.float64)
    Rt = np.swapaxes(T[..., :3, :3], -1, -2)
    return transform(Rt, -(Rt @ T[..., :3, 3:])[..., 0])


def map_point(T_a_b: ArrayLike, point_b: ArrayLike) -> Array:
    """Points (..., 3) given in frame b, in the coordinates of frame a: R p + o."""
    T_a_b, point_b = np.asarray(T_a_b, dtype=np.float64), np.asarray(point_b, dtype=np.float64)
    return np.asarray((T_a_b[..., :3, :3] @ point_b[..., None])[..., 0] + T_a_b[..., :3, 3])
