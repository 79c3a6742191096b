"""The Denavit-Hartenberg matrices, in both conventions."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from robokin.arrays import Array
from robokin.spatial.rotations import cos_sin


def standard_dh(theta: ArrayLike, d: ArrayLike, a: ArrayLike, alpha: ArrayLike) -> Array:
    """Standard (distal) step A = Rot(z, theta) Trans(0, 0, d) Trans(a, 0, 0) Rot(x, alpha).

    theta, alpha: (...) [rad]; d, a: (...) [m]. Returns (..., 4, 4).
    Source: B. Siciliano et al., Robotics: Modelling, Planning and Control, 2009, eq. (2.52).
    """
    ct, st, ca, sa, d, a = _cells(theta, alpha, d, a)
    return _homogeneous([
        [ct, -st * ca, st * sa, a * ct],
        [st, ct * ca, -ct * sa, a * st],
        [0.0 * sa, sa, ca, d],
    ])  # fmt: skip


def modified_dh(alpha: ArrayLike, a: ArrayLike, theta: ArrayLike, d: ArrayLike) -> Array:
    """Modified (proximal) step A = Rot(x, alpha) Trans(a, 0, 0) Rot(z, theta) Trans(0, 0, d).

    The row of joint i holds alpha and a of i - 1. alpha, theta: (...) [rad]; a, d: (...) [m].
    Returns (..., 4, 4). Source: J. J. Craig, Introduction to Robotics, 3rd ed., eq. (3.6).
    """
    ct, st, ca, sa, d, a = _cells(theta, alpha, d, a)
    return _homogeneous([
        [ct, -st, 0.0 * st, a],
        [st * ca, ct * ca, -sa, -sa * d],
        [st * sa, ct * sa, ca, ca * d],
    ])  # fmt: skip


def _cells(theta: ArrayLike, alpha: ArrayLike, d: ArrayLike, a: ArrayLike) -> list[Array]:
    cells = (*cos_sin(theta), *cos_sin(alpha), np.asarray(d, dtype=float), np.asarray(a, dtype=float))
    return list(np.broadcast_arrays(*cells))


def _homogeneous(rows: list[list[Array]]) -> Array:
    T = np.zeros((*np.shape(rows[0][0]), 4, 4))
    for i, row in enumerate(rows):
        for j, cell in enumerate(row):
            T[..., i, j] = cell
    T[..., 3, 3] = 1.0
    return T + 0.0  # no negative zeros
