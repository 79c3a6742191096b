"""`robokin singular`: where an arm loses a freedom."""

from __future__ import annotations

from typing import Any

from robokin.cli.commands.jacobian_command import TASKS, TaskOption
from robokin.cli.options import (
    AngleOption,
    FormatOption,
    JsonOption,
    LengthOption,
    OutputOption,
    RobotArgument,
    SetOption,
    choose,
    effective_units,
    output_format,
    parameter_overrides,
)


def command(
    robot: RobotArgument,
    task: TaskOption = None,
    output: OutputOption = None,
    format: FormatOption = None,
    json: JsonOption = False,
    angle: AngleOption = None,
    length: LengthOption = None,
    set_: SetOption = None,
) -> int:
    """The singular configurations of an arm, with the conditions on its joints.

    Each condition is on the joints that it names, whatever the others are, and tested at random values of those. c23
    is the cosine of q2 + q3, s23 the sine; letters such as a2 and d4 are the table's cells. What is lost is said at
    the example.

    Examples:
        robokin singular puma560
        robokin singular anthropomorphic --json
        robokin singular planar3r -f csv
    """
    from robokin.cli.arguments import load_robot
    from robokin.cli.output.sink import format_of, sink
    from robokin.cli.output.text import csv_records, json_document, json_line
    from robokin.cli.singularities import COLUMNS, page, row, singular_record
    from robokin.kinematics.singular import singular_configurations
    from robokin.kinematics.velocity import motion_task

    kind = format_of(output, output_format(format, json))
    counted: Any = choose(task, TASKS, "--task")
    model = load_robot(robot, parameter_overrides(set_))
    units = effective_units(model.units, length, angle)
    whole = motion_task(model, counted)
    found = singular_configurations(model, counted)
    document = singular_record(model, units, counted)
    records = document["singularities"]
    with sink(output) as stream:
        if kind == "json":
            stream.write(json_document(document))
        elif kind == "jsonl":
            head = {name: value for name, value in document.items() if name != "singularities"}
            stream.writelines(json_line({**head, **record}) for record in records)
        elif kind == "csv":
            stream.write(csv_records(COLUMNS, map(row, records)))
        else:
            stream.write(page(model, units, whole.name, found))
    return 0
