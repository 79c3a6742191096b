"""Answers of `robokin dof` in every format."""

from __future__ import annotations

from typing import Any

from robokin.tables.written_rows import csv_records, written


def freedoms_written(record: dict[str, Any], kind: str) -> bytes:
    """The document about a mechanism, a robot, a wheeled base or bare numbers in a format."""
    return b"".join(written(kind, record, [record], lambda: _row(record), lambda: _page(record)))


def _row(record: dict[str, Any]) -> bytes:
    """All that is one value; the id stands behind the kind."""
    cells: dict[str, Any] = {}
    for key, value in record.items():
        if key not in ("schema", "id") and not isinstance(value, (dict, list)):
            cells[key] = value
        if key == "kind" and record["id"] is not None:
            cells["id"] = record["id"]
    return csv_records(list(cells), [list(cells.values())])


def _page(record: dict[str, Any]) -> bytes:
    from robokin.reports.mobility_tables import mobility_table, wheeled_table

    return wheeled_table(record) if record["kind"] == "wheeled" else mobility_table(record)
