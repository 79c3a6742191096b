"""Poses that a function is given, checked; and what a pose says, in every form in which orientations are said."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from robokin.arrays import Array
from robokin.brief import Brief
from robokin.errors import InputError
from robokin.expected import expect_numbers
from robokin.spatial.rotations import (
    DIGITS_LOST,
    axis_angle_from_rotation,
    euler_from_rotation,
    nearest_rotation,
    quaternion_from_rotation,
    rotation_error,
    rpy_from_rotation,
)
from robokin.spatial.transforms import FARTHEST, invert, transform
from robokin.units import Units

LAST_ROW = 1e-9
"""How far the last row of a homogeneous matrix may be from 0 0 0 1."""

CLEAN = 1e-14
"""A rotation that is off by no more is taken as it stands: the rounding of a few products."""


def rigid(poses: Array, argument: str) -> Array:
    """Poses (..., 4, 4) [m], each with the rotation that is nearest to the given one.

    Rotations may be off by `DIGITS_LOST`: a matrix copied from print has three or four digits. Raises InputError for
    what is no rigid transform, saying how far off.
    """
    if not np.all(np.isfinite(poses)):
        raise InputError(f"{argument}: found a pose with a number that is not finite, expected finite numbers")
    if np.any(np.abs(poses[..., :3, 3]) > FARTHEST):
        raise InputError(f"{argument}: found a pose too far away, expected less than {FARTHEST:g} m")
    if np.any(np.abs(poses[..., 3, :] - [0.0, 0.0, 0.0, 1.0]) > LAST_ROW):
        raise InputError(f"{argument}: found a pose whose last row is not 0 0 0 1, expected a homogeneous matrix")
    with np.errstate(over="ignore", invalid="ignore"):  # of great numbers the products overflow, and are refused
        off = rotation_error(poses[..., :3, :3])
    if not np.all(off <= DIGITS_LOST):
        worst = np.max(off)
        raise InputError(
            f"{argument}: found a pose whose rotation is off by {worst:.2g}, expected at most {DIGITS_LOST:g}"
        )
    if np.any(off > CLEAN):
        poses = transform(nearest_rotation(poses[..., :3, :3]), poses[..., :3, 3])
    return poses


def expect_poses(value: ArrayLike, argument: str) -> Array:
    """Poses (..., 4, 4) [m], checked as `rigid` does. Raises InputError."""
    poses = expect_numbers(value, argument, "poses: numbers in an array (..., 4, 4)")
    if poses.ndim < 2 or poses.shape[-2:] != (4, 4):
        raise InputError(f"{argument}: found an array of shape {poses.shape}, expected poses (..., 4, 4)")
    return rigid(poses, argument)


@dataclass(frozen=True, eq=False, repr=False)
class PoseParts(Brief):
    """What poses (..., 4, 4) say, lengths and angles in `units`.

    position: (..., 3); rotation: (..., 3, 3), whose columns are n, s, a; rpy: (..., 3) of Rz(yaw) Ry(pitch) Rx(roll);
    euler: (..., 3) of Rz(phi) Ry(theta) Rz(psi); quaternion: (..., 4) w, x, y, z; axis: (..., 3) of length 1, about
    which it is turned by angle: (...), from 0 to 180°.
    """

    position: Array
    rotation: Array
    rpy: Array
    euler: Array
    quaternion: Array
    axis: Array
    angle: Array
    units: Units

    @property
    def rotvec(self) -> Array:
        """The rotation vector (..., 3), axis times angle."""
        return np.asarray(self.axis * self.angle[..., None])


def pose_parts(T: ArrayLike, *, length: str = "m", angle: str = "rad") -> PoseParts:
    """Position, roll pitch yaw, Euler angles, quaternion, axis and angle of poses T: (..., 4, 4) [m].

    length, angle: the units of what comes out. Raises InputError for what is no pose.
    Source: B. Siciliano et al., Robotics: Modelling, Planning and Control, 2009, sections 2.4 to 2.6.
    """
    units = Units(length, angle)
    poses = expect_poses(T, "T")
    R = poses[..., :3, :3]
    axis, turn = axis_angle_from_rotation(R)
    return PoseParts(
        poses[..., :3, 3] / units.metres + 0.0,
        R + 0.0,
        rpy_from_rotation(R) / units.radians + 0.0,
        euler_from_rotation(R) / units.radians + 0.0,
        quaternion_from_rotation(R),
        axis + 0.0,
        np.asarray(turn / units.radians),
        units,
    )


def invert_pose(T: ArrayLike) -> Array:
    """The inverses (..., 4, 4) [m] of poses T: (..., 4, 4) [m]: Rᵀ and −Rᵀp. Raises InputError for what is no pose.

    Source: B. Siciliano et al., Robotics: Modelling, Planning and Control, 2009, eq. (2.45).
    """
    return invert(expect_poses(T, "T")) + 0.0
