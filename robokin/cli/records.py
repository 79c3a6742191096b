"""Results to plain data: what JSON says and what the other writers pick from."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from robokin.model import Mechanism, Robot, WheeledBase
from robokin.spatial import (
    axis_angle_from_rotation,
    euler_from_rotation,
    quaternion_from_rotation,
    rpy_from_rotation,
)
from robokin.units import Units

if TYPE_CHECKING:
    from robokin.cli.poses import Poses

Array = NDArray[np.float64]


KINDS = {Robot: "robot", Mechanism: "mechanism", WheeledBase: "wheeled"}
"""What the key `kind` says of that which a description describes."""


def kind_of(entry: Robot | Mechanism | WheeledBase) -> str:
    """`robot`, `mechanism` or `wheeled`."""
    return KINDS[type(entry)]


def poses_in(T: Array, units: Units) -> Array:
    """Poses (..., 4, 4) [m] with their origins in the length unit, and no negative zeros; T is reused."""
    if units.metres != 1.0:
        T[..., :3, 3] /= units.metres
    T += 0.0
    return T


def orientation(T: Array, kind: str, units: Units) -> Array:
    """The orientation's columns (..., k) of poses (..., 4, 4), angles in the angle unit."""
    R = T[..., :3, :3]
    if kind == "quaternion":
        return quaternion_from_rotation(R) + 0.0
    if kind == "matrix":
        return T.reshape(*T.shape[:-2], 16)
    return (rpy_from_rotation(R) if kind == "rpy" else euler_from_rotation(R)) / units.radians + 0.0


ORIENTATION_COLUMNS = {
    "rpy": ("roll", "pitch", "yaw"),
    "quaternion": ("qw", "qx", "qy", "qz"),
    "euler": ("phi", "theta", "psi"),
    "matrix": tuple(f"m{i}{j}" for i in range(1, 5) for j in range(1, 5)),
}
"""Columns of a CSV for each way to say an orientation; those of `matrix` are the whole 4×4 row by row."""


def pose_columns(kind: str) -> tuple[str, ...]:
    """Columns of a CSV for a pose: the origin, then the orientation."""
    return ("x", "y", "z", *ORIENTATION_COLUMNS[kind])


def pose_table(T: Array, kind: str, units: Units) -> Array:
    """The columns (m, k) of poses (m, 4, 4) that `pose_columns` names."""
    return np.concatenate([T[:, :3, 3], orientation(T, kind, units)], axis=1)


def pose_records(T: Array, units: Units, more: Sequence[str] = ()) -> list[dict[str, Any]]:
    """Poses (m, 4, 4), their origins in the length unit already; `more` orientations than all have."""
    columns = {"matrix": T.tolist(), "position": T[:, :3, 3].tolist()}
    for kind in dict.fromkeys(["rpy", "quaternion", *more]):
        if kind not in columns:
            columns[kind] = orientation(T, kind, units).tolist()
    return [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]


def frame_record(T: Array, units: Units) -> dict[str, Any]:
    """Everything that can be said of a transform (4, 4), its origin in the length unit already."""
    axis, angle = axis_angle_from_rotation(T[:3, :3])
    n, s, a, p = T[:3].T.tolist()
    (pose,) = pose_records(T[None], units, ["euler"])
    return {
        "matrix": pose["matrix"],
        "n": n,
        "s": s,
        "a": a,
        "p": p,
        "position": pose["position"],
        "rpy": pose["rpy"],
        "euler": pose["euler"],
        "quaternion": pose["quaternion"],
        "axis_angle": {"axis": (axis + 0.0).tolist(), "angle": float(angle) / units.radians + 0.0},
    }


def configuration_records(robot: Robot, units: Units, poses: Poses, more: Sequence[str]) -> Iterator[dict[str, Any]]:
    """The answers of `fk` for a block of configurations; `more` orientations than all have."""
    stated = units.as_record()
    names = [str(i) for i in range(1, len(robot.rows) + 1)]
    rows = zip(poses.q.tolist(), poses.within.tolist(), pose_records(poses.T, units, more), strict=True)
    for i, (q, within, pose) in enumerate(rows):
        record: dict[str, Any] = {"robot": robot.id, "units": stated, "q": q, "within_limits": within, "pose": pose}
        if poses.frames is not None:
            matrices = zip(names, poses.frames[i].tolist(), strict=True)
            record["frames"] = [{"name": name, "matrix": matrix} for name, matrix in matrices]
        yield record
