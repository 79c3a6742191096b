"""Configurations along a motion in every format."""

from __future__ import annotations

import io
from typing import Any

import numpy as np

from robokin.records.motion_records import MotionRecords
from robokin.tables.array_writer import ArrayWriter
from robokin.tables.written_rows import csv_records, csv_rows, json_document, json_line

PAGE_COLUMNS = 6
"""Columns of numbers that fit beside one another on a page."""


def motion_written(motion: MotionRecords, kind: str) -> bytes:
    """The motion in a format."""
    if kind == "csv":
        return csv_records(motion.columns, []) + csv_rows(motion.numbers)
    if kind == "jsonl":
        head = motion.head()
        return b"".join(json_line(head | record) for record in motion.records())
    if kind == "json":
        return json_document(motion.head() | {"configurations": list(motion.records())})
    if kind == "npy":
        stream = io.BytesIO()
        numbers = motion.numbers
        writer = ArrayWriter(stream, numbers.shape[1:])
        writer.write(numbers)
        writer.close()
        return stream.getvalue()
    return _page(motion)


def _page(motion: MotionRecords) -> bytes:
    """Joint values and points, some columns at a time; the links' poses are for programs."""
    from robokin.reports.page_tables import heading, number_table, render

    trace, units = motion.trace, motion.units
    names = [*trace.labels, *motion.point_columns]
    rows = np.concatenate([motion.values, motion.point_numbers], axis=1)
    steps = [str(i) for i in range(1, len(rows) + 1)]
    outcome = "the motion comes back to its beginning" if trace.closed else "the motion does not come back"
    parts: list[Any] = [
        heading(trace.mechanism.name, f"lengths in {units.length}, angles in {units.angle}"),
        f"{trace.driven} leads; {outcome}",
    ]
    for first in range(0, len(names), PAGE_COLUMNS):
        part = slice(first, first + PAGE_COLUMNS)
        parts += ["", number_table(names[part], rows[:, part].tolist(), steps)]
    return render(*parts)
