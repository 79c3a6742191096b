"""`robokin show`: a robot's table as a lecture prints it, and what kind of arm it is."""

from __future__ import annotations

from typing import Any

from robokin.cli.option_groups import DescriptionOptions, OutputOptions
from robokin.cli.options import RobotArgument

ROWS = {"robot": "rows", "mechanism": "joints", "wheeled": "wheels"}
"""What a CSV has a row for, by the kind of what is described."""


def command(robot: RobotArgument, *, output: OutputOptions, description: DescriptionOptions) -> int:
    """A robot's table, its class, its wrist and its freedoms; a mechanism's joints and its count; a base's wheels.

    Examples:
        robokin show puma560
        robokin show four-bar
        robokin show car
        robokin show arm.yaml --length m --angle rad
        robokin show scara-frames --set l1=500 --json
    """
    from robokin.records.description_records import described_record
    from robokin.tables.sink import sink
    from robokin.tables.written_rows import csv_records, written

    kind = output.kind
    loaded = description.entry(robot)
    record = described_record(loaded, description.over(loaded.units))

    def csv() -> bytes:
        rows = record[ROWS[record["kind"]]]
        return csv_records(list(rows[0]), [[_cell(value) for value in row.values()] for row in rows])

    def page() -> bytes:
        from robokin.reports.description_tables import description_table

        return description_table(record)

    with sink(output.file) as stream:
        stream.writelines(written(kind, record, [record], csv, page))
    return 0


def _cell(value: Any) -> Any:
    return " ".join(map(str, value)) if isinstance(value, list) else "" if value is None else value
