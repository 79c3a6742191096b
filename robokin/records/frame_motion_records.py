"""A frame on its way to another as plain data: what `robokin frame --to` says."""

from __future__ import annotations

from typing import Any

import numpy as np

from robokin.arrays import Array
from robokin.inverse.frame_motions import FrameMotion
from robokin.records.pose_records import frame_record, poses_in
from robokin.spatial import invert
from robokin.tables.orientations import pose_columns, pose_table
from robokin.units import Units


def motion_record(motion: FrameMotion, expression: str, units: Units, kind: str | None = None) -> dict[str, Any]:
    """What is said beside the first frame: the other frame, the transform between them, and the screw motion.

    expression: of the other frame; `kind` asks for an orientation beside those that are always there.
    """
    screw, metres = motion.screw, units.metres
    relative = invert(screw.first) @ screw.last
    return {
        "to": {"expression": expression, **frame_record(poses_in(screw.last.copy(), units), units, kind)},
        "relative": frame_record(poses_in(relative, units), units, kind),
        "distance": float(np.linalg.norm(screw.last[:3, 3] - screw.first[:3, 3])) / metres,
        "screw": {
            "axis": None if screw.axis is None else (screw.axis + 0.0).tolist(),
            "point": None if screw.point is None else (screw.point / metres + 0.0).tolist(),
            "angle": screw.angle / units.radians,
            "translation": screw.slide / metres + 0.0,
            "pitch": None if screw.pitch is None else screw.pitch / metres + 0.0,
        },
        "along": motion.along,
    }


def motion_table(motion: FrameMotion, orientation: str, units: Units) -> tuple[list[str], Array]:
    """The columns' names and a row for each step (m, k): t, then the pose in the units."""
    poses = pose_table(poses_in(motion.T.copy(), units), orientation, units)
    return ["t", *pose_columns(orientation)], np.hstack([motion.t[:, None], poses])
