"""`robokin path`: from one configuration to another, or to a pose."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from robokin.cli.completion import named_poses, words
from robokin.cli.option_groups import ArrayOutputOptions, DescriptionOptions
from robokin.cli.options import RobotArgument, choose, option, whole_number
from robokin.cli.statuses import DONE, NO, say
from robokin.cli.target_options import TargetOptions
from robokin.errors import InputError

if TYPE_CHECKING:
    from robokin.arrays import Array
    from robokin.inverse.joint_paths import Path
    from robokin.model import Robot
    from robokin.units import Units


TASKS = ("pose", "position")

STEPS = 100
"""Steps when nobody says how many."""


def command(
    robot: RobotArgument,
    *,
    from_: Annotated[
        str | None, option("--from", "Q", "Where it starts: joint values, or a named pose.", named_poses)
    ] = None,
    to: Annotated[str | None, option("--to", "Q", "Where it ends: joint values, or a named pose.", named_poses)] = None,
    target: TargetOptions,
    steps: Annotated[str | None, option("--steps", "N", "Steps; a row more is written.  [default: 100]")] = None,
    joint: Annotated[
        bool, typer.Option("--joint", help="All joints together, each from its value to the other; the default.")
    ] = False,
    line: Annotated[bool, typer.Option("--line", help="The tool in a straight line, on one branch.")] = False,
    task: Annotated[
        str | None,
        option(
            "--task",
            "TASK",
            "What follows the line: pose or position.  [default: position for arms that place a point, else pose]",
            words(*TASKS),
        ),
    ] = None,
    no_limits: Annotated[bool, typer.Option("--no-limits", help="Also outside the joint limits.")] = False,
    output: ArrayOutputOptions,
    description: DescriptionOptions,
) -> int:
    """A path with a quintic time law: at rest at both ends, t from 0 to 1.

    --xyz alone keeps the orientation of the start. A straight line turns about one fixed axis. It ends where a joint
    leaves its limits, where there is no solution, or where a joint would have to jump; the rows up to there are
    written, how far it goes is said, and the status is 3.
    Singularities on the way are said with the fraction of the path. A CSV or an array has the columns t, q1...qn, x, y,
    z, roll, pitch, yaw.

    Examples:
        robokin path puma560 --from 90,-30,60,0,40,0 --to 60,-20,70,10,30,0
        robokin path puma560 --from 90,-30,60,0,40,0 --xyz -300,700,200 --line -f csv
        robokin path planar3r --from 10,40,20 --xy 0.9,1.2 --phi 90 --line -f csv
        robokin path scara --from 0,60,100,0 --to 40,30,50,90 --json
    """
    from robokin.cli.configurations import typed_configurations
    from robokin.inverse.follow import MOST
    from robokin.model.joint_units import joint_factors
    from robokin.records.path_records import PathRecords
    from robokin.reports.path_report import PathReport
    from robokin.tables.sink import sink

    kind = output.kind
    if joint and line:
        raise InputError("--joint and --line exclude each other, expected one of them")
    if task is not None and not line:
        raise InputError("--task goes with --line, which needs to know what follows the line")
    chosen: Any = choose(task, TASKS, "--task")
    count = whole_number(steps, "--steps", 1, MOST) or STEPS
    model, units = description.moving_robot(robot)
    factors = joint_factors(model, units)
    if from_ is None:
        example = ",".join(["0"] * model.n)
        raise InputError(f"--from is missing, expected {model.n} values or a named pose, such as --from {example}")
    start = typed_configurations([from_], model, units, "--from")[0] * factors
    target.exclude("--to", to)
    if to is None and not target.given:
        raise InputError("there is no end, expected --to, --pose, --matrix, --xyz or --xy")
    end = None if to is None else typed_configurations([to], model, units, "--to")[0] * factors
    path = _path(model, units, start, end, target.texts, count, line, not no_limits, chosen)
    answer = PathReport(PathRecords(path, units), end if line else None)
    if kind not in ("table", "json"):
        for sentence in answer.notes():
            say(sentence)
    with sink(output.file) as stream:
        stream.writelines(answer.write(kind, stream))
    return DONE if path.complete else NO


def _path(
    robot: Robot,
    units: Units,
    start: Array,
    end: Array | None,
    targets: dict[str, str | None],
    steps: int,
    line: bool,
    limits: bool,
    task: Any,
) -> Path:
    """The path."""
    import numpy as np

    from robokin.cli.targets import parse_target
    from robokin.inverse.joint_paths import follow_line, interpolate_joints
    from robokin.inverse.paths_to_poses import path_to_pose
    from robokin.kinematics.forward import forward_kinematics

    with np.errstate(over="ignore", invalid="ignore"):
        poses = [forward_kinematics(robot, q) for q in (start, end) if q is not None]
    # Squares of what is larger are no numbers.
    if any(not np.all(np.abs(T) < 1e100) for T in poses):
        raise InputError("the pose is too far away for a number, expected less")
    if end is not None:
        if line:
            return follow_line(robot, start, poses[-1], steps, limits, task)
        return interpolate_joints(robot, start, end, steps, limits)
    target = parse_target(targets, robot, units)
    for note in target.notes:
        say(note)
    return path_to_pose(robot, start, target.T, target.task, steps, line=line, limits=limits, follows=task)
