"""Rotations from one form to another, with what is given checked: the package's public conversions.

Quaternions are w, x, y, z; roll-pitch-yaw is Rz(yaw) Ry(pitch) Rx(roll); Euler angles are Z Y Z.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from robokin.arrays import Array
from robokin.errors import InputError
from robokin.expected import expect_finite
from robokin.spatial import rotations
from robokin.spatial.rigid_poses import CLEAN
from robokin.spatial.rotations import DIGITS_LOST, nearest_rotation, rotation_error

LEAST = 1e-12
"""Length of an axis or a quaternion below which it says no direction."""


def rotation_from_rpy(rpy: ArrayLike) -> Array:
    """R = Rz(yaw) Ry(pitch) Rx(roll); rpy: (..., 3) roll, pitch, yaw [rad]. Returns (..., 3, 3).

    Raises InputError for another shape and for what is not finite.
    Source: B. Siciliano et al., Robotics: Modelling, Planning and Control, 2009, section 2.4.2.
    """
    return rotations.rotation_from_rpy(_vectors(rpy, "rpy", 3, "roll, pitch, yaw [rad]"))


def rpy_from_rotation(R: ArrayLike) -> Array:
    """Roll, pitch, yaw (..., 3) [rad] of rotations R: (..., 3, 3); at pitch = ±90° roll is 0.

    Raises InputError for what is no rotation to 1e-3.
    Source: B. Siciliano et al., Robotics: Modelling, Planning and Control, 2009, section 2.4.2.
    """
    return rotations.rpy_from_rotation(rotation_of(R))


def rotation_from_euler(euler: ArrayLike) -> Array:
    """R = Rz(phi) Ry(theta) Rz(psi); euler: (..., 3) phi, theta, psi [rad]. Returns (..., 3, 3).

    Raises InputError for another shape and for what is not finite.
    Source: B. Siciliano et al., Robotics: Modelling, Planning and Control, 2009, section 2.4.1.
    """
    return rotations.rotation_from_euler(_vectors(euler, "euler", 3, "phi, theta, psi [rad]"))


def euler_from_rotation(R: ArrayLike) -> Array:
    """Z Y Z Euler angles (..., 3) [rad] of rotations R: (..., 3, 3); at theta = 0 and 180° phi is 0.

    Raises InputError for what is no rotation to 1e-3.
    Source: B. Siciliano et al., Robotics: Modelling, Planning and Control, 2009, section 2.4.1.
    """
    return rotations.euler_from_rotation(rotation_of(R))


def rotation_from_quaternion(quaternion: ArrayLike) -> Array:
    """The rotation (..., 3, 3) of a quaternion: (..., 4) w, x, y, z, of any length but zero.

    Raises InputError for another shape, for what is not finite and for zeros.
    Source: B. Siciliano et al., Robotics: Modelling, Planning and Control, 2009, section 2.6.
    """
    q = _vectors(quaternion, "quaternion", 4, "w, x, y, z")
    return rotations.rotation_from_quaternion(_directions(q, "quaternion"))


def quaternion_from_rotation(R: ArrayLike) -> Array:
    """Unit quaternions w, x, y, z (..., 4) of rotations R: (..., 3, 3), with w ≥ 0.

    Raises InputError for what is no rotation to 1e-3.
    Source: B. Siciliano et al., Robotics: Modelling, Planning and Control, 2009, section 2.6.
    """
    return rotations.quaternion_from_rotation(rotation_of(R))


def rotation_from_axis_angle(axis: ArrayLike, angle: ArrayLike) -> Array:
    """The rotation (..., 3, 3) by angle: (...) [rad] about axis: (..., 3), of any length but zero.

    Raises InputError for other shapes, for what is not finite and for an axis of zeros.
    Source: B. Siciliano et al., Robotics: Modelling, Planning and Control, 2009, section 2.5.
    """
    direction = _directions(_vectors(axis, "axis", 3, "x, y, z"), "axis")
    turn = expect_finite(angle, "angle", "angles [rad]")
    try:
        np.broadcast_shapes(direction.shape[:-1], turn.shape)
    except ValueError:
        raise InputError(f"angle: found an array of shape {turn.shape}, expected one for each axis") from None
    return rotations.rotation_from_axis_angle(direction, turn)


def axis_angle_from_rotation(R: ArrayLike) -> tuple[Array, Array]:
    """Unit axis (..., 3) and angle (...) [rad], from 0 to 180°, of rotations R: (..., 3, 3).

    Raises InputError for what is no rotation to 1e-3.
    Source: B. Siciliano et al., Robotics: Modelling, Planning and Control, 2009, section 2.5.
    """
    return rotations.axis_angle_from_rotation(rotation_of(R))


def rotation_from_rotvec(rotvec: ArrayLike) -> Array:
    """The rotation (..., 3, 3) of a rotation vector, axis times angle, rotvec: (..., 3) [rad]; zero is no rotation.

    Raises InputError for another shape and for what is not finite.
    Source: B. Siciliano et al., Robotics: Modelling, Planning and Control, 2009, section 2.5.
    """
    v = _vectors(rotvec, "rotvec", 3, "axis times angle [rad]")
    angle = np.linalg.norm(v, axis=-1)
    still = angle == 0.0
    axis = np.where(still[..., None], [0.0, 0.0, 1.0], v / np.where(still, 1.0, angle)[..., None])
    return rotations.rotation_from_axis_angle(axis, angle)


def rotvec_from_rotation(R: ArrayLike) -> Array:
    """Rotation vectors, axis times angle: (..., 3) [rad], of rotations R: (..., 3, 3), no longer than 180°.

    Raises InputError for what is no rotation to 1e-3.
    Source: B. Siciliano et al., Robotics: Modelling, Planning and Control, 2009, section 2.5.
    """
    axis, angle = rotations.axis_angle_from_rotation(rotation_of(R))
    return np.asarray(axis * angle[..., None])


# What is given ------------------------------------------------------------------------------------------------


def _vectors(values: ArrayLike, argument: str, count: int, what: str) -> Array:
    array = expect_finite(values, argument, f"{what}: an array (..., {count})")
    if array.ndim == 0 or array.shape[-1] != count:
        raise InputError(f"{argument}: found an array of shape {array.shape}, expected {what}: (..., {count})")
    return array


def _directions(vectors: Array, argument: str) -> Array:
    scale = np.max(np.abs(vectors), axis=-1, keepdims=True)
    if np.any(scale < LEAST):
        raise InputError(f"{argument}: found a vector of zeros, expected one with a direction")
    return np.asarray(vectors / scale)


def rotation_of(R: ArrayLike) -> Array:
    """Rotations (..., 3, 3); those whose digits were cut in print are made the nearest one. Raises InputError."""
    array = expect_finite(R, "R", "rotation matrices (..., 3, 3)")
    if array.ndim < 2 or array.shape[-2:] != (3, 3):
        raise InputError(f"R: found an array of shape {array.shape}, expected rotation matrices (..., 3, 3)")
    with np.errstate(over="ignore", invalid="ignore"):
        off = rotation_error(array)
    if not np.all(off <= DIGITS_LOST):
        raise InputError(f"R: found a matrix that is off by {np.max(off):.2g}, expected a rotation")
    return nearest_rotation(array) if np.any(off > CLEAN) else array
