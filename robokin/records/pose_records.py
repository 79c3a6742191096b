"""Poses as plain data: what `robokin fk` and `robokin frame` say."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from robokin.arrays import Array, Flags
from robokin.model import Robot, Tree
from robokin.records.envelope import configuration_record, envelope
from robokin.spatial import axis_angle_from_rotation
from robokin.tables.orientations import orientation
from robokin.units import Units


@dataclass(frozen=True)
class PoseBlock:
    """A block of answers: q (m, n), T (m, 4, 4), frames (m, rows, 4, 4) or None, in the units.

    `within` (m,) tells whether each q respects the limits, `first` is the number of the block's first one.
    """

    first: int
    q: Array
    within: Flags
    T: Array
    frames: Array | None


def poses_in(T: Array, units: Units) -> Array:
    """Poses (..., 4, 4) [m] with their origins in the length unit, and no negative zeros; T is reused."""
    if units.metres != 1.0:
        T[..., :3, 3] /= units.metres
    T += 0.0
    return T


def pose_records(T: Array, units: Units, more: Sequence[str] = ()) -> list[dict[str, Any]]:
    """Poses (m, 4, 4), their origins in the length unit already; `more` orientations than all have."""
    columns = {"matrix": T.tolist(), "position": T[:, :3, 3].tolist()}
    for kind in dict.fromkeys(["rpy", "quaternion", *more]):
        if kind not in columns:
            columns[kind.replace("-", "_")] = orientation(T, kind, units).tolist()
    return [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]


def frame_record(T: Array, units: Units, kind: str | None = None) -> dict[str, Any]:
    """Everything that can be said of a transform (4, 4), its origin in the length unit already.

    `kind` asks for an orientation beside those that are always there.
    """
    axis, angle = axis_angle_from_rotation(T[:3, :3])
    n, s, a, p = T[:3].T.tolist()
    (pose,) = pose_records(T[None], units, ["euler", "rotvec", *([kind] if kind else [])])
    record = {
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
        "rotvec": pose["rotvec"],
    }
    return record | {key: value for key, value in pose.items() if key not in record}


def tip_records(tree: Tree, units: Units, poses: PoseBlock, more: Sequence[str]) -> Iterator[dict[str, Any]]:
    """The answers of `fk` about a tree's tips for a block of configurations; `more` orientations than all have."""
    head = envelope("robot", tree.id, units)
    count = len(tree.tips)
    found = pose_records(poses.T.reshape(-1, 4, 4), units, more)
    for i, (q, within) in enumerate(zip(poses.q.tolist(), poses.within.tolist(), strict=True)):
        tips = dict(zip(tree.tips, found[i * count : (i + 1) * count], strict=True))
        yield {**head, "q": q, "within_limits": within, "tips": tips}


def configuration_records(
    robot: Robot, units: Units, poses: PoseBlock, more: Sequence[str]
) -> Iterator[dict[str, Any]]:
    """The answers of `fk` for a block of configurations; `more` orientations than all have."""
    head = envelope("robot", robot.id, units)
    names = [str(i) for i in range(1, len(robot.rows) + 1)]
    rows = zip(poses.q.tolist(), poses.within.tolist(), pose_records(poses.T, units, more), strict=True)
    for i, (q, within, pose) in enumerate(rows):
        record = configuration_record(head, q, within, pose)
        if poses.frames is not None:
            matrices = zip(names, poses.frames[i].tolist(), strict=True)
            record["frames"] = [{"name": name, "matrix": matrix} for name, matrix in matrices]
        yield record
