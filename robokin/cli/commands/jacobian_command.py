"""`robokin jacobian`: how joint rates move the tool, and where they cannot."""

from __future__ import annotations

from typing import Annotated, Any

from robokin.cli.completion import named_poses, words
from robokin.cli.option_groups import DescriptionOptions, RowOutputOptions
from robokin.cli.options import DropOption, RobotArgument, choose, option
from robokin.cli.statuses import say
from robokin.errors import InputError, shown

FRAMES = ("base", "tool")
TASKS = ("pose", "position", "orientation")

TaskOption = Annotated[
    str | None,
    option(
        "--task",
        "TASK",
        "What counts: pose, position or orientation.  [default: position or orientation for arms of up "
        "to three joints that place a point or turn the tool, else pose]",
        words(*TASKS),
    ),
]


def command(
    robot: RobotArgument,
    *,
    q: Annotated[
        list[str] | None,
        option(
            "--q",
            "Q",
            "Joint values, or the name of a pose of the description; - for a configuration a line on "
            "standard input. Repeatable.",
            named_poses,
        ),
    ] = None,
    input: Annotated[
        str | None,
        option(
            "--input -i",
            "FILE",
            "A configuration a line: .csv (with a header or without), .jsonl, .json, .npy or .parquet; "
            "- for standard input.",
        ),
    ] = None,
    frame: Annotated[
        str | None, option("--frame", "FRAME", "The twist's axes: base or tool.  [default: base]", words(*FRAMES))
    ] = None,
    task: TaskOption = None,
    force: Annotated[
        str | None,
        option(
            "--force",
            "FX,FY,FZ[,MX,MY,MZ]",
            "Also the joint torques for this force (N) and moment (N m) of the tool, in the axes of --frame.",
        ),
    ] = None,
    drop: DropOption = False,
    output: RowOutputOptions,
    description: DescriptionOptions,
) -> int:
    """The geometric Jacobian: twist of the tool = J times joint rates, linear part before angular part.

    Joint values are in the description's units unless --angle and --length say otherwise; the matrix is always per
    radian, and its lengths are in the length unit. Rank, singular values and condition number have lengths in the
    arm's size; manipulability is that of the matrix as printed.

    --force says what the tool exerts on what it touches, at its origin; the joints hold it with the torques Jᵀ F (N m,
    of slides N, whatever the units), gravity and friction apart.

    Examples:
        robokin jacobian puma560 --q 10,20,30,40,50,60
        robokin jacobian puma560 --q 10,20,30,40,0,60 --frame tool --json
        robokin jacobian planar2r --q 30,60 --task position
        robokin jacobian planar2r --q 30,60 --force 0,-10,0
        robokin jacobian puma560 --input joints.csv --output jacobians.npy
    """
    from robokin.cli.configurations import configurations
    from robokin.records.jacobian_records import JacobianRecords
    from robokin.reports.jacobian_report import JacobianReport, taken_by
    from robokin.tables.carried import Carried

    kind = output.kind
    axes: Any = choose(frame, FRAMES, "--frame") or "base"
    counted: Any = choose(task, TASKS, "--task")
    model, units = description.robot(robot)
    carried = Carried(taken_by(kind, model.n), say, wanted=not drop and kind not in ("table", "npy"))
    blocks, _, alone = configurations(model, units, q, input, carried)
    records = JacobianRecords(model, units, axes, counted, _wrench(force))
    if records.force and kind == "npy":
        raise InputError("--force: found an array as output, which holds the Jacobians, expected .csv, .jsonl or .json")
    JacobianReport(records, alone, carried).send(output.file, kind, blocks)
    return 0


def _wrench(text: str | None) -> tuple[float, ...]:
    """The force [N] and the moment [N m] that are typed, six numbers; none for None. Raises InputError."""
    from robokin.cli.arguments import parse_numbers, split_vector
    from robokin.units import Units

    if text is None:
        return ()
    count = len(split_vector(text))
    if count not in (3, 6):
        raise InputError(f"--force: found '{shown(text)}', expected three values in N, or six with the moment in N m")
    values = parse_numbers(text, "--force", [False] * count, Units(), "a force in N, and a moment in N m")
    return tuple(float(value) for value in [*values, 0.0, 0.0, 0.0][:6])
