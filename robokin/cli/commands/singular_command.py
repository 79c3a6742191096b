"""`robokin singular`: where an arm loses a freedom."""

from __future__ import annotations

from typing import Any

from robokin.cli.commands.jacobian_command import TASKS, TaskOption
from robokin.cli.option_groups import DescriptionOptions, OutputOptions
from robokin.cli.options import RobotArgument, choose


def command(
    robot: RobotArgument, *, task: TaskOption = None, output: OutputOptions, description: DescriptionOptions
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
    from robokin.kinematics.singular import singular_configurations
    from robokin.records.singularity_records import COLUMNS, row, singular_record
    from robokin.tables.sink import sink
    from robokin.tables.written_rows import csv_records, written

    kind = output.kind
    counted: Any = choose(task, TASKS, "--task")
    model, units = description.robot(robot)
    found = singular_configurations(model, counted)
    document = singular_record(model, units, counted, found)
    head = {name: value for name, value in document.items() if name != "singularities"}
    records = document["singularities"]

    def page() -> bytes:
        from robokin.reports.singularity_pages import singularity_page

        return singularity_page(model, units, document["task"], found)

    with sink(output.file) as stream:
        lines = ({**head, **record} for record in records)
        stream.writelines(written(kind, document, lines, lambda: csv_records(COLUMNS, map(row, records)), page))
    return 0
