"""Rotations and rigid transforms on plain arrays: (..., 3, 3) and (..., 4, 4).

Knows no robot. Conventions, said once: right-handed frames; `T_a_b` is the pose of frame b in frame a,
so that inner letters cancel in a product; quaternions are w, x, y, z; roll-pitch-yaw is
Rz(yaw) Ry(pitch) Rx(roll); Euler angles are Z Y Z: Rz(phi) Ry(theta) Rz(psi).
"""

from robokin.spatial.rotations import (
    axis_angle_from_rotation,
    euler_from_rotation,
    nearest_rotation,
    quaternion_from_rotation,
    rotation_angle,
    rotation_error,
    rotation_from_axis_angle,
    rotation_from_euler,
    rotation_from_quaternion,
    rotation_from_rotation_vector,
    rotation_from_rpy,
    rotation_from_sequence,
    rotation_vector_from_rotation,
    rpy_from_rotation,
)
from robokin.spatial.transforms import (
    compose,
    exact,
    invert,
    map_point,
    rotation_transform,
    transform,
    translation_transform,
    z_to,
)

__all__ = [
    "axis_angle_from_rotation",
    "compose",
    "euler_from_rotation",
    "exact",
    "invert",
    "map_point",
    "nearest_rotation",
    "quaternion_from_rotation",
    "rotation_angle",
    "rotation_error",
    "rotation_from_axis_angle",
    "rotation_from_euler",
    "rotation_from_quaternion",
    "rotation_from_rotation_vector",
    "rotation_from_rpy",
    "rotation_from_sequence",
    "rotation_transform",
    "rotation_vector_from_rotation",
    "rpy_from_rotation",
    "transform",
    "translation_transform",
    "z_to",
]
