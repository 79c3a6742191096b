"""`robokin show`: a robot's table as a lecture prints it, and what kind of arm it is."""

from __future__ import annotations

from typing import Annotated

import typer

from robokin.cli.option_groups import DescriptionOptions, OutputOptions
from robokin.cli.options import RobotArgument
from robokin.errors import InputError


def command(
    robot: RobotArgument,
    *,
    yaml: Annotated[
        bool, typer.Option("--yaml", help="The robot's description, formulas worked out, to begin another with.")
    ] = False,
    output: OutputOptions,
    description: DescriptionOptions,
) -> int:
    """A robot's table, its class, its wrist and its freedoms; a mechanism's joints and its count; a base's wheels.

    Examples:
        robokin show puma560
        robokin show four-bar
        robokin show car
        robokin show arm.yaml --length m --angle rad
        robokin show scara-frames --set l1=500 --json
        robokin show puma560 --yaml
    """
    from robokin.records.description_records import described_record
    from robokin.tables.sink import sink
    from robokin.tables.written_rows import written

    if yaml:
        return _described(robot, output, description)
    kind = output.kind
    loaded = description.anything(robot)
    record = described_record(loaded, description.over(loaded.units))

    def csv() -> bytes:
        from robokin.reports.table_files import csv_table

        return csv_table(record)

    def page() -> bytes:
        from robokin.reports.description_tables import description_table

        return description_table(record)

    with sink(output.file) as stream:
        stream.writelines(written(kind, record, [record], csv, page))
    return 0


def _described(robot: str, output: OutputOptions, description: DescriptionOptions) -> int:
    """Print the description of a robot."""
    from dataclasses import replace

    from robokin.formats.written_robot import written
    from robokin.tables.sink import sink

    if output.chosen is not None or output.file is not None:
        raise InputError("--yaml has one form and is printed, expected no --format, --json or --output with it; "
                         "robokin convert writes it to a file")  # fmt: skip
    loaded, units = description.robot(robot)
    text = written(replace(loaded, units=units)).encode()
    with sink(None) as stream:
        stream.write(text)
    return 0
