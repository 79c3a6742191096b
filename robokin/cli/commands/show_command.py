"""`robokin show`: a robot's table as a lecture prints it, and what kind of arm it is."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from robokin.cli.option_groups import DescriptionOptions, OutputOptions
from robokin.cli.options import RobotArgument
from robokin.errors import InputError

if TYPE_CHECKING:
    from robokin.model import Mechanism, Robot, Tree, WheeledBase


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

    Of a chain of a tree, and of a URDF, MJCF or SDF file, the standard Denavit-Hartenberg table is made.

    Examples:
        robokin show puma560
        robokin show four-bar
        robokin show car
        robokin show arm.yaml --length m --angle rad
        robokin show scara-frames --set l1=500 --json
        robokin show human-hand --tip index
        robokin show puma560 --yaml
    """
    from robokin.records.description_records import described_record
    from robokin.tables.sink import sink
    from robokin.tables.written_rows import written

    if yaml:
        return _described(robot, output, description)
    kind = output.kind
    loaded = description.anything(robot)
    made = _table_of_chain(loaded) if _a_chain_of_links(robot, loaded, description) else None
    record = described_record(made or loaded, description.over(loaded.units))
    if made is not None:
        record["made_from"] = "frames"

    def csv() -> bytes:
        from robokin.reports.table_files import csv_table

        return csv_table(record)

    def page() -> bytes:
        from robokin.reports.description_tables import description_table

        return description_table(record)

    with sink(output.file) as stream:
        stream.writelines(written(kind, record, [record], csv, page))
    return 0


def _a_chain_of_links(
    robot: str, loaded: Robot | Mechanism | WheeledBase | Tree, description: DescriptionOptions
) -> bool:
    """Whether what is shown is a chain of a tree, or of a file in another format, and no table that someone wrote."""
    from robokin.formats.library import FOREIGN
    from robokin.model import Robot

    if description.tip or description.root or Path(robot).suffix.lower() in FOREIGN:
        return True
    return isinstance(loaded, Robot) and loaded.convention == "frames" and description.describes_tree(robot)


def _table_of_chain(loaded: Robot | Mechanism | WheeledBase | Tree) -> Robot | None:
    """The standard Denavit-Hartenberg table of a robot of frames; None, and a word on stderr, where it has none."""
    from dataclasses import replace

    from robokin.cli.statuses import say
    from robokin.kinematics.dh_table import to_convention
    from robokin.model import Robot

    if not isinstance(loaded, Robot) or loaded.convention != "frames" or not loaded.n:
        return None
    try:
        made = to_convention(loaded, "standard")
    except InputError as error:
        say(str(error))
        return None
    for note in made.notes[len(loaded.notes) :]:
        say(str(note))
    return replace(made, parameters=loaded.parameters)


def _described(robot: str, output: OutputOptions, description: DescriptionOptions) -> int:
    """Print the description of a robot or a tree."""
    from robokin.cli.written_forms import written_form
    from robokin.tables.sink import sink

    if output.chosen is not None or output.file is not None:
        raise InputError("--yaml has one form and is printed, expected no --format, --json or --output with it; "
                         "robokin convert writes it to a file")  # fmt: skip
    text = written_form(*description.robot_or_tree(robot), "yaml")
    with sink(None) as stream:
        stream.write(text)
    return 0
