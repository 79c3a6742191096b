"""Answers of `robokin frame` in every format."""

from __future__ import annotations

import io
from collections.abc import Iterator
from typing import Any

import numpy as np

from robokin.arrays import Array
from robokin.inverse.frame_motions import FrameMotion
from robokin.number_text import show
from robokin.records.frame_motion_records import motion_table
from robokin.records.pose_records import poses_in
from robokin.tables.orientations import pose_columns, pose_table
from robokin.tables.written_rows import csv_header, csv_rows, written
from robokin.units import Units

LABELS = {"quaternion_xyzw": "x y z w", "rotvec": "rotation vector", "abc": "A B C", "wpr": "W P R"}
"""What a table says of an orientation that it has on demand only."""


def frame_written(
    kind: str, record: dict[str, Any], T: Array, orientation: str | None, units: Units, point: Array | None = None,
    motion: FrameMotion | None = None,
) -> Iterator[bytes]:  # fmt: skip
    """A transform (4, 4) in the units and its document in a format, with a point (3,) that was mapped by it, if any.

    Of a motion to another frame a CSV and an array have a row for each step.
    """
    columns = orientation or "rpy"

    def csv() -> bytes:
        if motion is not None:
            head, rows = motion_table(motion, columns, units)
            return csv_header(head) + csv_rows(rows)
        names, row = pose_columns(columns), pose_table(T[None], columns, units)
        if point is not None:
            names, row = (*names, "point_x", "point_y", "point_z"), np.hstack([row, point[None]])
        return csv_header(names) + csv_rows(row)

    if kind == "npy":
        stream = io.BytesIO()
        if motion is not None:
            T = poses_in(motion.T.copy(), units)
            row = T if orientation in (None, "matrix") else pose_table(T, columns, units)
            np.lib.format.write_array(stream, row, version=(1, 0))
            return iter([stream.getvalue()])
        row = T if orientation in (None, "matrix") else pose_table(T[None], columns, units)[0]
        np.lib.format.write_array(stream, row, version=(1, 0))
        return iter([stream.getvalue()])
    return written(kind, record, [record], csv, lambda: _page(record, units, orientation))


def _row(values: list[float]) -> str:
    return "  ".join(show(value) for value in values)


def _page(record: dict[str, Any], units: Units, kind: str | None) -> bytes:
    """All that can be said of a transform, for eyes."""
    from robokin.reports.page_tables import heading, number_table, pairs, render

    if "to" in record:
        return _motion_page(record, units, kind)
    entries = _entries(record, kind)
    if "point" in record:
        entries.append(("point", _row(record["point"])))
    return render(
        heading(record["expression"] or "identity", f"lengths in {units.length}, angles in {units.angle}"),
        "",
        number_table("nsap", record["matrix"][:3], "xyz"),
        "",
        pairs(entries),
    )


def _entries(record: dict[str, Any], kind: str | None) -> list[tuple[str, str]]:
    """A transform's position and orientation in every form."""
    turn = record["axis_angle"]
    entries = [
        ("position", _row(record["position"])),
        ("roll pitch yaw", _row(record["rpy"])),
        ("Euler ZYZ", _row(record["euler"])),
        ("quaternion", _row(record["quaternion"])),
        ("axis, angle", f"{_row(turn['axis'])}, {show(turn['angle'])}"),
    ]
    if (key := (kind or "rpy").replace("-", "_")) in LABELS:
        entries.insert(1, (LABELS[key], _row(record[key])))
    return entries


def _motion_page(record: dict[str, Any], units: Units, kind: str | None) -> bytes:
    """Two frames, the transform from one to the other, and the screw motion, for eyes."""
    from robokin.reports.page_tables import heading, number_table, pairs, render

    screw, relative = record["screw"], record["relative"]
    entries = [("distance", show(record["distance"]))]
    if screw["axis"] is None:
        entries.append(("screw motion", "none: it is the same frame"))
    elif screw["point"] is None:
        entries += [("screw motion", "a translation"), ("direction", _row(screw["axis"]))]
    else:
        entries += [
            ("screw axis", f"{_row(screw['axis'])}, through {_row(screw['point'])}"),
            ("angle", show(screw["angle"])),
            ("translation", f"{show(screw['translation'])} along the axis"),
            ("pitch", f"{show(screw['pitch'])} {units.length}/rad"),
        ]
    names = record["expression"] or "identity", record["to"]["expression"] or "identity"
    return render(
        heading(f"{names[0]}  to  {names[1]}", f"lengths in {units.length}, angles in {units.angle}"),
        "",
        "The second frame in the first",
        number_table("nsap", relative["matrix"][:3], "xyz"),
        "",
        pairs(_entries(relative, kind)),
        "",
        "The motion, in the coordinates of both expressions",
        pairs(entries),
    )
