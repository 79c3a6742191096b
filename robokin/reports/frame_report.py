"""Answers of `robokin frame` in every format."""

from __future__ import annotations

import io
from collections.abc import Iterator
from typing import Any

import numpy as np

from robokin.arrays import Array
from robokin.number_text import show
from robokin.tables.orientations import pose_columns, pose_table
from robokin.tables.written_rows import csv_header, csv_rows, written
from robokin.units import Units

LABELS = {"quaternion_xyzw": "x y z w", "rotvec": "rotation vector", "abc": "A B C", "wpr": "W P R"}
"""What a table says of an orientation that it has on demand only."""


def frame_written(
    kind: str, record: dict[str, Any], T: Array, orientation: str | None, units: Units, point: Array | None = None
) -> Iterator[bytes]:
    """A transform (4, 4) in the units and its document in a format, with a point (3,) that was mapped by it, if any."""
    columns = orientation or "rpy"

    def csv() -> bytes:
        names, row = pose_columns(columns), pose_table(T[None], columns, units)
        if point is not None:
            names, row = (*names, "point_x", "point_y", "point_z"), np.hstack([row, point[None]])
        return csv_header(names) + csv_rows(row)

    if kind == "npy":
        stream = io.BytesIO()
        row = T if orientation in (None, "matrix") else pose_table(T[None], columns, units)[0]
        np.lib.format.write_array(stream, row, version=(1, 0))
        return iter([stream.getvalue()])
    return written(kind, record, [record], csv, lambda: _page(record, units, orientation))


def _page(record: dict[str, Any], units: Units, kind: str | None) -> bytes:
    """All that can be said of a transform, for eyes."""
    from robokin.reports.page_tables import heading, number_table, pairs, render

    def row(values: list[float]) -> str:
        return "  ".join(show(value) for value in values)

    turn = record["axis_angle"]
    entries = [
        ("position", row(record["position"])),
        ("roll pitch yaw", row(record["rpy"])),
        ("Euler ZYZ", row(record["euler"])),
        ("quaternion", row(record["quaternion"])),
        ("axis, angle", f"{row(turn['axis'])}, {show(turn['angle'])}"),
    ]
    if (key := (kind or "rpy").replace("-", "_")) in LABELS:
        entries.insert(1, (LABELS[key], row(record[key])))
    if "point" in record:
        entries.append(("point", row(record["point"])))
    return render(
        heading(record["expression"] or "identity", f"lengths in {units.length}, angles in {units.angle}"),
        "",
        number_table("nsap", record["matrix"][:3], "xyz"),
        "",
        pairs(entries),
    )
