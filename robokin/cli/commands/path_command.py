"""`robokin path`: from one configuration to another, or to a pose."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from robokin.cli.completion import named_poses, words
from robokin.cli.options import (
    AngleOption,
    ArrayOutputOption,
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
from robokin.cli.statuses import DONE, NO
from robokin.cli.target_options import (
    ApproachOption,
    EulerOption,
    MatrixOption,
    PhiOption,
    PoseOption,
    QuatOption,
    RpyOption,
    XyOption,
    XyzOption,
    target_texts,
)

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
    from_: Annotated[
        str | None,
        typer.Option(
            "--from", metavar="Q", help="Where it starts: joint values, or a named pose.", autocompletion=named_poses
        ),
    ] = None,
    to: Annotated[
        str | None,
        typer.Option(
            "--to", metavar="Q", help="Where it ends: joint values, or a named pose.", autocompletion=named_poses
        ),
    ] = None,
    pose: PoseOption = None,
    matrix: MatrixOption = None,
    xyz: XyzOption = None,
    rpy: RpyOption = None,
    euler: EulerOption = None,
    quat: QuatOption = None,
    approach: ApproachOption = None,
    xy: XyOption = None,
    phi: PhiOption = None,
    steps: Annotated[
        str | None, typer.Option("--steps", metavar="N", help="Steps; a row more is written.  [default: 100]")
    ] = None,
    joint: Annotated[
        bool, typer.Option("--joint", help="All joints together, each from its value to the other; the default.")
    ] = False,
    line: Annotated[bool, typer.Option("--line", help="The tool in a straight line, on one branch.")] = False,
    task: Annotated[
        str | None,
        typer.Option(
            "--task",
            metavar="TASK",
            help="What follows the line: pose or position.  [default: position for arms that place a point, else pose]",
            autocompletion=words(*TASKS),
        ),
    ] = None,
    no_limits: Annotated[bool, typer.Option("--no-limits", help="Also outside the joint limits.")] = False,
    output: ArrayOutputOption = None,
    format: FormatOption = None,
    json: JsonOption = False,
    angle: AngleOption = None,
    length: LengthOption = None,
    set_: SetOption = None,
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
    from robokin.cli.arguments import joint_factors, load_robot, parse_configuration
    from robokin.cli.output.sink import format_of, sink
    from robokin.cli.paths import PathAnswer
    from robokin.cli.statuses import say
    from robokin.errors import InputError

    kind = format_of(output, output_format(format, json), arrays=True)
    if joint and line:
        raise InputError("--joint and --line exclude each other, expected one of them")
    if task is not None and not line:
        raise InputError("--task goes with --line, which needs to know what follows the line")
    chosen: Any = choose(task, TASKS, "--task")
    count = _steps(steps)
    model = load_robot(robot, parameter_overrides(set_))
    if not model.n:
        raise InputError(f"{model.name} has no joints, expected a robot that can move")
    units = effective_units(model.units, length, angle)
    factors = joint_factors(model, units)
    if from_ is None:
        example = ",".join(["0"] * model.n)
        raise InputError(f"--from is missing, expected {model.n} values or a named pose, such as --from {example}")
    start = parse_configuration(from_, model, units, "--from") * factors
    targets = target_texts(pose, matrix, xyz, rpy, euler, quat, approach, xy, phi)
    given = [name for name, value in targets.items() if value is not None]
    if to is not None and given:
        raise InputError(f"--to and {given[0]} exclude each other, expected one of them")
    if to is None and not given:
        raise InputError("there is no end, expected --to, --pose, --matrix, --xyz or --xy")
    end = None if to is None else parse_configuration(to, model, units, "--to") * factors
    path = _path(model, units, start, end, targets, count, line, not no_limits, chosen)
    answer = PathAnswer(model, units, "line" if line else "joint", path, None if not line else end)
    if kind not in ("table", "json"):
        for sentence in answer.notes():
            say(sentence)
    with sink(output) as stream:
        for data in answer.write(kind, stream):
            stream.write(data)
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

    from robokin.cli.statuses import say
    from robokin.cli.targets import parse_target
    from robokin.errors import InputError
    from robokin.inverse.joint_paths import follow_line, interpolate_joints, line_task, no_path
    from robokin.inverse.solutions import Result
    from robokin.inverse.solve import solve_ik
    from robokin.kinematics.forward import forward_kinematics

    with np.errstate(over="ignore", invalid="ignore"):
        first = forward_kinematics(robot, start)
        last = None if end is None else forward_kinematics(robot, end)
    # Squares of what is larger are no numbers.
    if any(T is not None and not np.all(np.abs(T) < 1e100) for T in (first, last)):
        raise InputError("the pose is too far away for a number, expected less")
    if end is not None and not line:
        return interpolate_joints(robot, start, end, steps, limits)
    if last is None:
        target = parse_target(targets, robot, units)
        for note in target.notes:
            say(note)
        last, asked = target.T, target.task
        if asked == "position" and line_task(robot) == "pose":
            last = last.copy()
            last[:3, :3] = first[:3, :3]
        elif asked == "position":
            task = task or "position"
        elif asked == "approach" and line:
            # The roll about the tool's axis is free: that of the solution nearest to the start.
            found = solve_ik(robot, last, limits=limits, near=start, task="approach", most=1)
            assert isinstance(found, Result)
            if not found.solutions:
                return no_path(robot, start, found.reason or "not reached", steps)
            last = forward_kinematics(robot, found.solutions[0].q)
    if line:
        return follow_line(robot, start, last, steps, limits, task)
    wanted = "approach" if asked == "approach" else task or line_task(robot)
    result = solve_ik(robot, last, limits=limits, near=start, task=wanted, most=1)
    assert isinstance(result, Result)
    if not result.solutions:
        return no_path(robot, start, result.reason or "not reached", steps)
    return interpolate_joints(robot, start, result.solutions[0].q, steps, limits)


def _steps(text: str | None) -> int:
    from robokin.errors import InputError
    from robokin.inverse.follow import MOST

    if text is None:
        return STEPS
    digits = text.strip()
    if not (digits.isascii() and digits.isdecimal()) or len(digits) > 18 or not 1 <= int(digits) <= MOST:
        from robokin.errors import shown

        raise InputError(f"--steps: found '{shown(text)}', expected a whole number from 1 to {MOST}")
    return int(digits)
