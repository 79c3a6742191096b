"""`robokin check ik`: joint values answered for poses."""

from __future__ import annotations

from typing import Annotated

import typer

from robokin.cli.check_options import (
    GradescopeOption,
    InputAnswersOption,
    KeyOption,
    PointsOption,
    RtolOption,
    TolAngleOption,
    TolOption,
    VisibilityOption,
    delivery,
    one_source,
    stated_tolerance,
)
from robokin.cli.options import (
    AngleOption,
    FormatOption,
    JsonOption,
    LengthOption,
    OutputOption,
    RobotArgument,
    SetOption,
    effective_units,
    parameter_overrides,
)


def command(
    robot: RobotArgument,
    q: Annotated[
        list[str] | None,
        typer.Option("--q", metavar="Q", help="The answer, or `none`; several are marked as the set of all solutions."),
    ] = None,
    pose: Annotated[
        str | None, typer.Option("--pose", metavar="EXPR", help="The target as a transform expression.")
    ] = None,
    matrix: Annotated[
        str | None,
        typer.Option("--matrix", metavar="[[..]]|FILE", help="The target as a 4×4 matrix, or a file of one."),
    ] = None,
    xyz: Annotated[
        str | None, typer.Option("--xyz", metavar="X,Y,Z", help="The target's position; alone: any orientation.")
    ] = None,
    rpy: Annotated[str | None, typer.Option("--rpy", metavar="R,P,Y", help="With --xyz: roll, pitch, yaw.")] = None,
    euler: Annotated[
        str | None, typer.Option("--euler", metavar="PHI,THETA,PSI", help="With --xyz: ZYZ Euler angles.")
    ] = None,
    quat: Annotated[
        str | None, typer.Option("--quat", metavar="W,X,Y,Z", help="With --xyz: a quaternion of length 1.")
    ] = None,
    approach: Annotated[
        str | None, typer.Option("--approach", metavar="X,Y,Z", help="With --xyz: the tool's z axis only, any roll.")
    ] = None,
    xy: Annotated[str | None, typer.Option("--xy", metavar="X,Y", help="The position for a planar arm.")] = None,
    phi: Annotated[str | None, typer.Option("--phi", metavar="PHI", help="With --xy: the hand's angle.")] = None,
    every: Annotated[
        bool, typer.Option("--all", help="All solutions are asked for, also of a question with one answer.")
    ] = False,
    any_: Annotated[bool, typer.Option("--any", help="Each answer is marked by itself, also several.")] = False,
    no_limits: Annotated[bool, typer.Option("--no-limits", help="The joint limits do not matter.")] = False,
    input: InputAnswersOption = None,
    key: KeyOption = None,
    tol: TolOption = None,
    tol_angle: TolAngleOption = None,
    rtol: RtolOption = None,
    gradescope: GradescopeOption = None,
    points: PointsOption = None,
    visibility: VisibilityOption = None,
    output: OutputOption = None,
    format: FormatOption = None,
    json: JsonOption = False,
    angle: AngleOption = None,
    length: LengthOption = None,
    set_: SetOption = None,
) -> int:
    """Mark joint values that were answered for a target, given as for robokin ik.

    An answer is right when it reaches the target within the tolerance and its values, or those turned by 360°,
    are within the limits. Several answers to one target, or any with --all, are compared with all solutions:
    each may be given once, modulo 360°, and what is missing is named. The score is the right ones as a part of
    all that were given and all that are missing. A file has the columns of the target (x, y, z, roll, pitch, yaw
    or the like; or an id, and --key has the targets) and q1, …; lines of one target and id are a set.

    Examples:
        robokin check ik planar3r-brac --xy 26.4743,50.8716 --phi 85 --q 30,45,10
        robokin check ik planar2r --xy 1,1 --q 23.968,57.769 --q 66.032,-57.769
        robokin check ik puma560 --xyz=-149.09,921.12,20.32 --rpy 0,90,90 --q home
        robokin check ik planar2r --xy 5,0 --q none
    """
    from robokin.cli import say
    from robokin.cli.arguments import load_robot
    from robokin.cli.check_ik import InverseCheck
    from robokin.cli.checks import Report, tolerance_record
    from robokin.cli.targets import parse_target
    from robokin.errors import InputError
    from robokin.grading.tolerance import default_tolerance

    way = delivery(output, format, json, gradescope, points, visibility)
    targets = {
        "--pose": pose, "--matrix": matrix, "--xyz": xyz, "--rpy": rpy, "--euler": euler, "--quat": quat,
        "--approach": approach, "--xy": xy, "--phi": phi,
    }  # fmt: skip
    one_source({**targets, "--q": q}, input, key)
    if every and any_:
        raise InputError("--all and --any exclude each other, expected one of them")
    model = load_robot(robot, parameter_overrides(set_))
    if not model.n:
        raise InputError(f"{model.name} has no joints, expected a robot that can move")
    units = effective_units(model.units, length, angle)
    allowed = stated_tolerance(default_tolerance(model), tol, tol_angle, rtol, units)
    check = InverseCheck(model, units, allowed, not no_limits, True if every else False if any_ else None)
    if input is not None:
        items = tuple(check.file(input, key))
    else:
        target = parse_target(targets, model, units)
        if not q:
            raise InputError("--q is missing, expected the joint values that were answered, or --input FILE")
        for note in target.notes:
            say(note)
        items = tuple(check.items("1", target, [check.option(text) for text in q]))
    return way.deliver(Report("ik", model.id or robot, units, tolerance_record(allowed, units), items))
