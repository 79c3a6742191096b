"""Rigid transforms as homogeneous matrices (..., 4, 4): make, compose, invert, apply."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from robokin.arrays import Array
from robokin.spatial.rotations import ZERO_AXIS, rotation_from_axis_angle

EXACT = 1e-15
"""An entry of a constant rotation this near to 0 or ±1 is meant to be just that: it is rounding of the
products of right angles (a few 1e-16). Exact entries cost no arithmetic later."""

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


def z_to(axis: ArrayLike) -> Array:
    """A rotation (4, 4) that takes z to the given axis (3,), of any length but zero."""
    u = np.array(axis, dtype=np.float64)
    u /= np.linalg.norm(u)
    normal = np.cross([0.0, 0.0, 1.0], u)
    sine = float(np.linalg.norm(normal))
    angle = np.arctan2(sine, u[2])
    if sine < ZERO_AXIS:  # next to z, or to its opposite
        normal = normal / sine if sine else np.array([1.0, 0.0, 0.0])
    return exact(rotation_transform(normal, angle))


def exact(T: Array) -> Array:
    """T (4, 4) with entries of the rotation that are 0 or ±1 but for rounding made exactly that."""
    T = T.copy()
    R = T[:3, :3]
    whole = np.round(R)
    T[:3, :3] = np.where(np.abs(R - whole) <= EXACT, whole, R) + 0.0
    return T
