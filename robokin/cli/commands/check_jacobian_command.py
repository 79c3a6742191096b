"""`robokin check jacobian`: an answered Jacobian."""

from __future__ import annotations

from typing import Annotated

import typer

from robokin.cli.check_options import (
    BudgetOption,
    FeedbackOption,
    GradescopeOption,
    PartialOption,
    PointsOption,
    RtolOption,
    VisibilityOption,
    delivery,
    stated_tolerance,
)
from robokin.cli.completion import named_poses, words
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
    parameter_overrides,
)


def command(
    robot: RobotArgument,
    q: Annotated[
        str | None,
        typer.Option(
            "--q", metavar="Q", help="The joint values of the question, or a named pose.", autocompletion=named_poses
        ),
    ] = None,
    expect: Annotated[
        str | None, typer.Option("--expect", metavar="[[..]]", help="The answer: six rows of one number a joint.")
    ] = None,
    frame: Annotated[
        str | None,
        typer.Option(
            "--frame",
            metavar="FRAME",
            help="Its axes: base or tool.  [default: base]",
            autocompletion=words("base", "tool"),
        ),
    ] = None,
    tol: Annotated[
        str | None,
        typer.Option(
            "--tol",
            "--atol",
            metavar="L",
            help="How far a length may be off.  [default: 0.001 of the arm]",
        ),
    ] = None,
    tol_angle: Annotated[
        str | None,
        typer.Option("--tol-angle", metavar="A", help="How far a direction may be off.  [default: 0.1 deg]"),
    ] = None,
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
    """Mark a geometric Jacobian, linear rows before angular ones, entry by entry.

    Of a planar arm the rows vx, vy, wz, or vx, vy alone, will do.
    Linear entries of turning joints are lengths (for a radian); all others are pure numbers and may be off by
    --tol-angle in radians. The score is the part of the columns that are right. Where the answer is the Jacobian
    in the other frame, or has its angular rows first, the detail says so.

    Examples:
        robokin check jacobian planar2r --q 0,90 --expect "$(cat jacobian.txt)"
        robokin check jacobian planar2r --q 0,90 --frame tool --expect "$J"
    """
    from robokin.cli.arguments import joint_factors, load_robot, parse_configuration
    from robokin.cli.check_jacobian import JacobianCheck, JacobianTask
    from robokin.cli.checks import Report, tolerance_record
    from robokin.cli.marking import marked
    from robokin.errors import InputError
    from robokin.grading.tolerance import default_tolerance

    way = delivery(output, format, json, gradescope, points, visibility, feedback, budget, partial)
    for option, value in (("--q", q), ("--expect", expect)):
        if value is None:
            raise InputError(f"{option} is missing, expected --q and --expect")
    assert q is not None
    assert expect is not None
    chosen = choose(frame, ("base", "tool"), "--frame") or "base"
    model = load_robot(robot, parameter_overrides(set_))
    if not model.n:
        raise InputError(f"{model.name} has no joints, expected a robot that can move")
    units = effective_units(model.units, length, angle)
    allowed = stated_tolerance(default_tolerance(model), tol, tol_angle, rtol, units)
    values = parse_configuration(q, model, units) * joint_factors(model, units)
    check = JacobianCheck(model, units, allowed)
    items = tuple(marked(check.mark, [JacobianTask(expect, values, chosen)], way.rules, {"q": None, "frame": None}))
    return way.deliver(Report("jacobian", model.id or robot, units, tolerance_record(allowed, units), items))
