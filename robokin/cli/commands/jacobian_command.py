"""`robokin jacobian`: how joint rates move the tool, and where they cannot."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from robokin.cli.completion import named_poses, words
from robokin.cli.options import (
    AngleOption,
    ArrayOutputOption,
    DropOption,
    FormatOption,
    JsonOption,
    LengthOption,
    RobotArgument,
    SetOption,
    choose,
    effective_units,
    output_format,
    parameter_overrides,
)

FRAMES = ("base", "tool")
TASKS = ("pose", "position", "orientation")

TaskOption = Annotated[
    str | None,
    typer.Option(
        "--task",
        metavar="TASK",
        help="What counts: pose, position or orientation.  [default: position or orientation for arms of up to three "
        "joints that place a point or turn the tool, else pose]",
        autocompletion=words(*TASKS),
    ),
]


def command(
    robot: RobotArgument,
    q: Annotated[
        list[str] | None,
        typer.Option(
            "--q",
            metavar="Q",
            help="Joint values, or the name of a pose of the description; - for a configuration a line on standard "
            "input. Repeatable.",
            autocompletion=named_poses,
        ),
    ] = None,
    input: Annotated[
        str | None,
        typer.Option(
            "--input",
            "-i",
            metavar="FILE",
            help="A configuration a line: .csv (with a header or without), .jsonl, .json or .npy; - for standard "
            "input.",
        ),
    ] = None,
    frame: Annotated[
        str | None,
        typer.Option(
            "--frame",
            metavar="FRAME",
            help="The twist's axes: base or tool.  [default: base]",
            autocompletion=words(*FRAMES),
        ),
    ] = None,
    task: TaskOption = None,
    drop: DropOption = False,
    output: ArrayOutputOption = None,
    format: FormatOption = None,
    json: JsonOption = False,
    angle: AngleOption = None,
    length: LengthOption = None,
    set_: SetOption = None,
) -> int:
    """The geometric Jacobian: twist of the tool = J times joint rates, linear part before angular part.

    Joint values are in the description's units unless --angle and --length say otherwise; the matrix is always per
    radian, and its lengths are in the length unit. Rank, singular values and condition number have lengths in the
    arm's size; manipulability is that of the matrix as printed.

    Examples:
        robokin jacobian puma560 --q 10,20,30,40,50,60
        robokin jacobian puma560 --q 10,20,30,40,0,60 --frame tool --json
        robokin jacobian planar2r --q 30,60 --task position
        robokin jacobian puma560 --input joints.csv --output jacobians.npy
    """
    from robokin.cli.arguments import load_robot
    from robokin.cli.configurations import configurations
    from robokin.cli.jacobians import Jacobians, taken_by
    from robokin.cli.output.sink import format_of, sink
    from robokin.cli.statuses import say
    from robokin.tables.carried import Carried

    kind = format_of(output, output_format(format, json), arrays=True)
    axes: Any = choose(frame, FRAMES, "--frame") or "base"
    counted: Any = choose(task, TASKS, "--task")
    model = load_robot(robot, parameter_overrides(set_))
    units = effective_units(model.units, length, angle)
    carried = Carried(taken_by(kind, model.n), say, wanted=not drop and kind in ("csv", "json", "jsonl"))
    blocks, _, alone = configurations(model, units, q, input, carried)
    answers = Jacobians(model, units, axes, counted, alone, carried)
    with sink(output) as stream:
        for data in answers.write(kind, blocks, stream):
            stream.write(data)
            stream.flush()  # whoever waits for an answer gets it before the next question
    return 0
