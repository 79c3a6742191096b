"""Rotation matrices and their parametrisations, both ways, for any leading batch shape.

Each conversion out of a matrix is defined everywhere; where a parametrisation is singular the angle
that is set to zero is named in the function's docstring.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from robokin.arrays import Array
from robokin.rotation_entries import NO_DIGIT, SINGULAR, quaternion_products, rpy_of_entries

DIGITS_LOST = 1e-3
"""A matrix or quaternion this near to a rotation is one whose digits were cut in print (four digits leave
1e-4); the nearest rotation is taken. Beyond, it is something else and is refused."""

ZERO_AXIS = 1e-12
"""An axis or a quaternion shorter than this has no direction."""


def rotation_from_axis_angle(axis: ArrayLike, angle: ArrayLike) -> Array:
    """Rotation about an axis (Rodrigues' formula, R = c I + s [u] + (1 - c) u uᵀ).

    axis: (..., 3), of any length but zero; angle: (...) [rad]. Returns (..., 3, 3).
    Cosines and sines of multiples of 90° come out as exact 0 and ±1.
    """
    axis = np.asarray(axis, dtype=np.float64)
    length = np.linalg.norm(axis, axis=-1, keepdims=True)
    if np.any(length < ZERO_AXIS):
        raise ValueError("the axis of a rotation must not be zero")
    u = axis / length
    c, s = cos_sin(angle)
    x, y, z = u[..., 0], u[..., 1], u[..., 2]
    v = 1.0 - c
    R = np.empty((*np.broadcast_shapes(x.shape, c.shape), 3, 3))
    R[..., 0, 0] = c + v * x * x
    R[..., 0, 1] = v * x * y - s * z
    R[..., 0, 2] = v * x * z + s * y
    R[..., 1, 0] = v * x * y + s * z
    R[..., 1, 1] = c + v * y * y
    R[..., 1, 2] = v * y * z - s * x
    R[..., 2, 0] = v * x * z - s * y
    R[..., 2, 1] = v * y * z + s * x
    R[..., 2, 2] = c + v * z * z
    return R


def cos_sin(angle: ArrayLike) -> tuple[Array, Array]:
    """Cosine and sine of angles [rad]; a value within 4e-16 of 0 or ±1 is exactly that.

    A right angle given as a rounded multiple of pi has a cosine of 6e-17, where 0 was meant.
    """
    angle = np.asarray(angle, dtype=np.float64)
    c, s = np.cos(angle), np.sin(angle)
    right_sine, right_cosine = np.abs(c) < 4e-16, np.abs(s) < 4e-16
    c = np.where(right_sine, 0.0, np.where(right_cosine, np.sign(c), c))
    s = np.where(right_cosine, 0.0, np.where(right_sine, np.sign(s), s))
    return c, s


def rotation_from_rpy(rpy: ArrayLike) -> Array:
    """R = Rz(yaw) Ry(pitch) Rx(roll); rpy: (..., 3) roll, pitch, yaw [rad]. Returns (..., 3, 3)."""
    rpy = np.asarray(rpy, dtype=np.float64)
    (cr, cp, cy), (sr, sp, sy) = (np.moveaxis(part, -1, 0) for part in cos_sin(rpy))
    return _matrix(
        cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr,
        sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr,
        -sp, cp * sr, cp * cr,
    )  # fmt: skip


def rpy_from_rotation(R: ArrayLike) -> Array:
    """Roll, pitch, yaw of rotations R: (..., 3, 3). Returns (..., 3) [rad], |pitch| ≤ 90°.

    Singular at pitch = ±90°, where only one sum of roll and yaw is determined: roll is 0 there.
    """
    R = np.asarray(R, dtype=np.float64)
    return np.stack(rpy_of_entries(_entries(R), np), axis=-1)


def rotation_from_euler(euler: ArrayLike) -> Array:
    """R = Rz(phi) Ry(theta) Rz(psi); euler: (..., 3) phi, theta, psi [rad]. Returns (..., 3, 3)."""
    euler = np.asarray(euler, dtype=np.float64)
    (c1, c2, c3), (s1, s2, s3) = (np.moveaxis(part, -1, 0) for part in cos_sin(euler))
    return _matrix(
        c1 * c2 * c3 - s1 * s3, -c1 * c2 * s3 - s1 * c3, c1 * s2,
        s1 * c2 * c3 + c1 * s3, -s1 * c2 * s3 + c1 * c3, s1 * s2,
        -s2 * c3, s2 * s3, c2,
    )  # fmt: skip


def euler_from_rotation(R: ArrayLike) -> Array:
    """ZYZ Euler angles of rotations R: (..., 3, 3). Returns phi, theta, psi: (..., 3) [rad], 0 ≤ theta ≤ 180°.

    Singular at theta = 0 and 180°, where only one sum of phi and psi is determined: phi is 0 there.
    """
    R = np.asarray(R, dtype=np.float64)
    s2 = np.hypot(R[..., 0, 2], R[..., 1, 2])
    phi = np.where(s2 > SINGULAR, np.arctan2(R[..., 1, 2], R[..., 0, 2]), 0.0)
    theta = np.arctan2(s2, R[..., 2, 2])
    # The second row of Rz(-phi) R is (sin psi, cos psi, 0): psi makes up for the rounding of phi.
    c, s = np.cos(phi), np.sin(phi)
    psi = np.arctan2(c * R[..., 1, 0] - s * R[..., 0, 0], c * R[..., 1, 1] - s * R[..., 0, 1])
    return np.stack([phi, theta, psi], axis=-1)


def rotation_from_quaternion(quaternion: ArrayLike) -> Array:
    """Rotation of quaternions w, x, y, z: (..., 4), of any length but zero. Returns (..., 3, 3)."""
    quaternion = np.asarray(quaternion, dtype=np.float64)
    length = np.linalg.norm(quaternion, axis=-1, keepdims=True)
    if np.any(length < ZERO_AXIS):
        raise ValueError("a quaternion must not be zero")
    w, x, y, z = np.moveaxis(quaternion / length, -1, 0)
    return _matrix(
        1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
        2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
        2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y),
    )  # fmt: skip


def quaternion_from_rotation(R: ArrayLike) -> Array:
    """Unit quaternions w, x, y, z: (..., 4) of rotations R: (..., 3, 3).

    Of q and -q, which are the same rotation, the one with w > 0 is given; at w = 0 (a half turn) the
    one whose first non-zero element is positive. S. W. Shepperd, "Quaternion from rotation matrix",
    J. Guidance and Control 1(3), 1978: the greatest of |w|, |x|, |y|, |z| is found first, so that no
    division is by a small number.
    """
    R = np.asarray(R, dtype=np.float64)
    products = quaternion_products(_entries(R))
    squares = np.stack([products[i][i] for i in range(4)], axis=-1)
    columns = np.stack([np.stack(column, axis=-1) for column in products], axis=-2)
    greatest = np.argmax(squares, axis=-1)[..., None, None]
    q = np.take_along_axis(columns, greatest, axis=-2)[..., 0, :]
    q = q / np.linalg.norm(q, axis=-1, keepdims=True)
    q = np.where(np.abs(q) < NO_DIGIT, 0.0, q)
    first = np.take_along_axis(q, np.argmax(q != 0.0, axis=-1)[..., None], axis=-1)
    return np.asarray(q * np.sign(first))


def axis_angle_from_rotation(R: ArrayLike) -> tuple[Array, Array]:
    """Unit axis (..., 3) and angle (...) [rad], 0 ≤ angle ≤ 180°, of rotations R: (..., 3, 3).

    At 0° every axis serves and z is given; at 180° both ends of the axis serve and the one whose
    first non-zero element is positive is given.
    """
    q = quaternion_from_rotation(R)
    length = np.linalg.norm(q[..., 1:], axis=-1)
    angle = 2.0 * np.arctan2(length, q[..., 0])
    turns = length[..., None] > SINGULAR
    axis = np.where(turns, q[..., 1:] / np.where(turns, length[..., None], 1.0), [0.0, 0.0, 1.0])
    return axis, np.where(turns[..., 0], angle, 0.0)


def rotation_from_rotation_vector(vector: ArrayLike) -> Array:
    """Rotation about the direction of vectors (..., 3) by their length [rad]. Returns (..., 3, 3)."""
    v = np.asarray(vector, dtype=np.float64)
    greatest = np.max(np.abs(v), axis=-1, keepdims=True)  # the squares of great numbers would not be finite
    turns = greatest > ZERO_AXIS
    u = np.where(turns, v, [0.0, 0.0, 1.0]) / np.where(turns, greatest, 1.0)
    angle = np.where(turns, greatest, 0.0)[..., 0] * np.linalg.norm(u, axis=-1)
    R = rotation_from_axis_angle(u, angle)
    x, y, z = np.moveaxis(np.where(turns, 0.0, v), -1, 0)
    zero = np.zeros_like(x)
    return R + _matrix(zero, -z, y, z, zero, -x, -y, x, zero)  # what is tiny is its own sine


def rotation_vector_from_rotation(R: ArrayLike) -> Array:
    """Rotation vectors (..., 3) [rad] of rotations R: (..., 3, 3): the axis times the angle, 0 to 180°.

    At 180° both ends of the axis serve and the one whose first non-zero element is positive is given.
    """
    q = quaternion_from_rotation(R)
    sine = np.linalg.norm(q[..., 1:], axis=-1, keepdims=True)
    ratio = 2.0 * np.arctan2(sine, q[..., :1]) / np.where(sine > 0.0, sine, 1.0)
    return np.asarray(q[..., 1:] * ratio)


def rotation_from_sequence(axes: str, angles: ArrayLike) -> Array:
    """Three turns one after another; angles: (..., 3) [rad]. Returns (..., 3, 3).

    `axes` are three letters, each unlike the one before: in lower case each turn is about an axis that the
    turns before it have moved (`zyz`: Rz Ry Rz), in upper case about a fixed one (`XYZ`: Rz Ry Rx).
    """
    angles = np.asarray(angles, dtype=np.float64)
    letters = enumerate(axes.lower())
    first, second, third = (rotation_from_axis_angle(np.eye(3)["xyz".index(a)], angles[..., k]) for k, a in letters)
    return np.asarray(first @ second @ third if axes.islower() else third @ second @ first)


def rotation_angle(R_a: ArrayLike, R_b: ArrayLike) -> Array:
    """Angle (...) [rad] by which R_b: (..., 3, 3) is turned against R_a: (..., 3, 3), 0 to 180°.

    By the arc tangent of sine and cosine, which keeps all digits at small angles and near 180°.
    """
    D = np.swapaxes(np.asarray(R_a, dtype=np.float64), -1, -2) @ np.asarray(R_b, dtype=np.float64)
    sine = 0.5 * np.sqrt(
        (D[..., 2, 1] - D[..., 1, 2]) ** 2 + (D[..., 0, 2] - D[..., 2, 0]) ** 2 + (D[..., 1, 0] - D[..., 0, 1]) ** 2
    )
    return np.asarray(np.arctan2(sine, 0.5 * (np.trace(D, axis1=-2, axis2=-1) - 1.0)))


def rotation_error(R: ArrayLike) -> Array:
    """How far matrices (..., 3, 3) are from rotations: the greatest |RᵀR - I|, or 2 where det R ≤ 0."""
    # Column by column: stacked 3×3 products take four times as long.
    x, y, z = np.ascontiguousarray(np.moveaxis(np.asarray(R, dtype=np.float64), (-1, -2), (0, 1)))
    skew = np.zeros(x.shape[1:])
    for a, b, dot in ((x, x, 1.0), (y, y, 1.0), (z, z, 1.0), (x, y, 0.0), (y, z, 0.0), (z, x, 0.0)):
        np.maximum(skew, np.abs(a[0] * b[0] + a[1] * b[1] + a[2] * b[2] - dot), out=skew)
    determinant = (
        (x[1] * y[2] - x[2] * y[1]) * z[0] + (x[2] * y[0] - x[0] * y[2]) * z[1] + (x[0] * y[1] - x[1] * y[0]) * z[2]
    )
    return np.asarray(np.where(determinant > 0.0, skew, np.maximum(skew, 2.0)))


def nearest_rotation(M: ArrayLike) -> Array:
    """The rotation nearest to matrices M: (..., 3, 3), by the polar decomposition (Higham 1986)."""
    U, _, Vt = np.linalg.svd(np.asarray(M, dtype=np.float64))
    U[..., :, 2] *= np.sign(np.linalg.det(U @ Vt))[..., None]
    return np.asarray(U @ Vt)


def _matrix(*rows: Array) -> Array:
    """Nine arrays (...) in reading order as matrices (..., 3, 3)."""
    M = np.stack(np.broadcast_arrays(*rows), axis=-1)
    return M.reshape(*M.shape[:-1], 3, 3)


def _entries(R: Array) -> list[list[Array]]:
    """The entries (...) of rotations (..., 3, 3), by rows."""
    return [[R[..., i, j] for j in range(3)] for i in range(3)]
