"""`robokin check ik`: joint values answered for poses."""

from __future__ import annotations

from typing import Annotated

import typer

from robokin.cli.check_options import (
    BudgetOption,
    FeedbackOption,
    FollowOption,
    GradescopeOption,
    InputAnswersOption,
    KeyOption,
    PartialOption,
    PointsOption,
    RtolOption,
    TolAngleOption,
    TolOption,
    VisibilityOption,
    delivery,
    one_source,
    stated_tolerance,
)
from robokin.cli.completion import named_poses
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


def command(
    robot: RobotArgument,
    q: Annotated[
        list[str] | None,
        typer.Option(
            "--q",
            metavar="Q",
            help="The answer, or `none`; several are marked as the set of all solutions.",
            autocompletion=named_poses,
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
    every: Annotated[
        bool, typer.Option("--all", help="All solutions are asked for, also of a question with one answer.")
    ] = False,
    any_: Annotated[bool, typer.Option("--any", help="Each answer is marked by itself, also several.")] = False,
    no_limits: Annotated[bool, typer.Option("--no-limits", help="The joint limits do not matter.")] = False,
    input: InputAnswersOption = None,
    key: KeyOption = None,
    follow: FollowOption = False,
    tol: TolOption = None,
    tol_angle: TolAngleOption = None,
    rtol: RtolOption = None,
    budget: BudgetOption = None,
    partial: PartialOption = None,
    feedback: FeedbackOption = None,
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
    from dataclasses import replace

    from robokin.cli.arguments import load_robot
    from robokin.cli.check_ik import InverseCheck, JointsTask
    from robokin.cli.check_poses import pose_reader
    from robokin.cli.check_rows import read_key, read_sheet
    from robokin.cli.checks import Report, tolerance_record
    from robokin.cli.marking import marked
    from robokin.cli.statuses import say
    from robokin.cli.targets import parse_target
    from robokin.errors import InputError
    from robokin.grading.tolerance import default_tolerance

    way = delivery(output, format, json, gradescope, points, visibility, feedback, budget, partial)
    targets = target_texts(pose, matrix, xyz, rpy, euler, quat, approach, xy, phi)
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
        sheet = read_sheet(input, follow=follow)
        if key is None:
            check = replace(check, reader=pose_reader(sheet, model, units))
        tasks = check.file(sheet, None if key is None else read_key(key))
    else:
        target = parse_target(targets, model, units)
        if not q:
            raise InputError("--q is missing, expected the joint values that were answered, or --input FILE")
        for note in target.notes:
            say(note)
        known = check.solutions(target) if check.needs_all(q) else None
        tasks = [JointsTask("1", target, tuple(q), known=known)]
    items = tuple(marked(check.mark, tasks, way.rules))
    return way.deliver(Report("ik", model.id or robot, units, tolerance_record(allowed, units), items))
