"""`robokin check fk`: poses answered for joint values."""

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


def command(
    robot: RobotArgument,
    q: Annotated[
        list[str] | None,
        typer.Option(
            "--q",
            metavar="Q",
            help="The joint values of the question, or a named pose; repeatable.",
            autocompletion=named_poses,
        ),
    ] = None,
    expect: Annotated[
        list[str] | None,
        typer.Option(
            "--expect",
            metavar="POSE",
            help="The answer: X,Y,Z (position alone), X,Y,Z,roll,pitch,yaw, a 4×4 matrix, or an expression.",
        ),
    ] = None,
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
    """Mark poses that were answered for joint values.

    Position and orientation are compared apart: each is half of the score of a pose. The orientation's error is
    the angle between the two, however they are said. A file has the columns that robokin fk -f csv writes (q1, …
    with the pose answered), an id or not, a student or not; with --key the joint values stand in a file of the
    teacher's, and what is not answered counts as wrong.

    Examples:
        robokin check fk puma560 --q home --expect "-149.09, 921.12, 20.32"
        robokin check fk puma560 --q home --expect=-149.09,921.12,20.32,0,90,90
        robokin check fk planar2r --q 90,0 --expect "Trans(0,1.6,0)Rot(z,90)" --json
        robokin fk puma560 -i joints.csv -f csv | robokin check fk puma560 -i -
    """
    from dataclasses import replace

    from robokin.cli.arguments import load_robot
    from robokin.cli.check_fk import ForwardCheck, needed_reader, without_repetitions
    from robokin.cli.check_rows import read_key, read_sheet
    from robokin.cli.checks import Report, tolerance_record
    from robokin.cli.marking import marked
    from robokin.errors import InputError
    from robokin.grading.tolerance import default_tolerance

    way = delivery(output, format, json, gradescope, points, visibility, feedback, budget, partial)
    one_source({"--q": q, "--expect": expect}, input, key)
    model = load_robot(robot, parameter_overrides(set_))
    if not model.n:
        raise InputError(f"{model.name} has no joints, expected a robot that can move")
    units = effective_units(model.units, length, angle)
    allowed = stated_tolerance(default_tolerance(model), tol, tol_angle, rtol, units)
    check = ForwardCheck(model, units, allowed)
    if input is not None:
        sheet = read_sheet(input, follow=follow)
        check = replace(check, reader=needed_reader(sheet, model, units))
        tasks = check.file(sheet, None if key is None else read_key(key))
    elif not q or not expect:
        missing = "--expect" if q else "--q"
        raise InputError(f"{missing} is missing, expected --q and --expect, or --input FILE")
    else:
        tasks = list(check.options(q, expect))
    items = marked(check.mark, tasks, way.rules, {"q": None, "compared": None})
    if input is not None and key is None:
        items = without_repetitions(items)
    return way.deliver(Report("fk", model.id or robot, units, tolerance_record(allowed, units), tuple(items)))
