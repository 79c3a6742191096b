"""The ways to say an orientation in columns, each in one place: headings, what is an angle, there and back."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array
from robokin.spatial import (
    euler_from_rotation,
    quaternion_from_rotation,
    rotation_from_euler,
    rotation_from_quaternion,
    rotation_from_rotation_vector,
    rotation_from_rpy,
    rotation_vector_from_rotation,
    rpy_from_rotation,
)
from robokin.units import Units


@dataclass(frozen=True)
class Orientation:
    """A way to say an orientation: its columns, whether they are angles, and numbers (..., k) from and to rotations."""

    columns: tuple[str, ...]
    angles: bool
    of: Callable[[Array], Array]
    rotation: Callable[[Array], Array]


MATRIX = tuple(f"m{i}{j}" for i in range(1, 5) for j in range(1, 5))
"""Columns of a 4×4 matrix, row by row."""

ORIENTATIONS = {
    "rpy": Orientation(("roll", "pitch", "yaw"), True, rpy_from_rotation, rotation_from_rpy),
    "quaternion": Orientation(
        ("qw", "qx", "qy", "qz"), False, quaternion_from_rotation, rotation_from_quaternion
    ),
    "quaternion-xyzw": Orientation(
        ("qx", "qy", "qz", "qw"),
        False,
        lambda R: quaternion_from_rotation(R)[..., [1, 2, 3, 0]],
        lambda q: rotation_from_quaternion(q[..., [3, 0, 1, 2]]),
    ),
    "euler": Orientation(("phi", "theta", "psi"), True, euler_from_rotation, rotation_from_euler),
    "rotvec": Orientation(("rx", "ry", "rz"), True, rotation_vector_from_rotation, rotation_from_rotation_vector),
    "abc": Orientation(
        ("A", "B", "C"),
        True,
        lambda R: rpy_from_rotation(R)[..., ::-1],
        lambda abc: rotation_from_rpy(abc[..., ::-1]),
    ),
    "wpr": Orientation(("W", "P", "R"), True, rpy_from_rotation, rotation_from_rpy),
}  # fmt: skip
"""The ways but for `matrix`: KUKA's A, B, C are yaw, pitch, roll and FANUC's W, P, R roll, pitch, yaw."""

KINDS = (*ORIENTATIONS, "matrix")
"""What --as may say."""

SHORT = {"quat": "quaternion", "quat-xyzw": "quaternion-xyzw", "quaternion-wxyz": "quaternion"}
"""Other words for some of them."""


def orientation(T: Array, kind: str, units: Units) -> Array:
    """The orientation's columns (..., k) of poses (..., 4, 4), angles in the angle unit."""
    if kind == "matrix":
        return T.reshape(*T.shape[:-2], 16)
    way = ORIENTATIONS[kind]
    values = way.of(T[..., :3, :3])
    return (values / units.radians if way.angles else values) + 0.0


def orientation_columns(kind: str) -> tuple[str, ...]:
    """Their headings; those of `matrix` are the whole 4×4 row by row."""
    return MATRIX if kind == "matrix" else ORIENTATIONS[kind].columns


def pose_columns(kind: str) -> tuple[str, ...]:
    """Columns of a CSV for a pose: the origin, then the orientation."""
    return ("x", "y", "z", *orientation_columns(kind))


def pose_table(T: Array, kind: str, units: Units) -> Array:
    """The columns (m, k) of poses (m, 4, 4) that `pose_columns` names."""
    return np.concatenate([T[:, :3, 3], orientation(T, kind, units)], axis=1)
