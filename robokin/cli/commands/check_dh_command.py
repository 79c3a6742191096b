"""`robokin check dh`: tables against a robot."""

from __future__ import annotations

from typing import Annotated

import typer

from robokin.cli.check_options import (
    BudgetOption,
    FeedbackOption,
    FollowOption,
    GradescopeOption,
    PartialOption,
    PointsOption,
    VisibilityOption,
    delivery,
    stated_tolerance,
)
from robokin.cli.completion import robots
from robokin.cli.options import (
    AngleOption,
    FormatOption,
    JsonOption,
    LengthOption,
    OutputOption,
    SetOption,
    effective_units,
    parameter_overrides,
)


def command(
    files: Annotated[
        list[str],
        typer.Argument(
            metavar="FILE...", help="The tables to be marked: descriptions, or folders of them.", show_default=False
        ),
    ],
    against: Annotated[
        str | None,
        typer.Option(
            "--against",
            metavar="ROBOT",
            help="The right robot: a name of `robokin list`, or a path.",
            autocompletion=robots,
        ),
    ] = None,
    up_to: Annotated[
        str | None,
        typer.Option("--up-to", metavar="PARTS", help="What may differ: base, tool, zero, sign, with commas; or all."),
    ] = None,
    tol: Annotated[
        str | None,
        typer.Option(
            "--tol",
            "--atol",
            metavar="L",
            help="How far a length may be off.  [default: 0.0001 of the arm]",
        ),
    ] = None,
    tol_angle: Annotated[
        str | None, typer.Option("--tol-angle", metavar="A", help="How far an angle may be off.  [default: 0.01 deg]")
    ] = None,
    follow: FollowOption = False,
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
    """Mark tables: is it kinematically the same robot?

    The joints' axes decide, not the cells: a table in another convention, or with frames elsewhere along its
    axes, is the same robot. It must bring the end effector to the same pose for the same joint values, except for what
    --up-to leaves open: another base or tool frame, the zeros of joints, their senses. Where a table differs,
    the first joint that does is named with what was found and expected; the score is the part of the joints
    that stand right to the one before; where single cells are wrong, they are named. --set is about the right
    robot. Limits are not compared. Of a folder all .yaml files are marked, whatever they are called.

    Examples:
        robokin check dh arm.yaml --against robots/arm.yaml
        robokin check dh submissions/ --against arm.yaml -f csv
        robokin check dh puma560-craig --against puma560 --up-to all
    """
    from robokin.cli.arguments import load_robot
    from robokin.cli.check_dh import NOTHING, TableCheck, open_parts
    from robokin.cli.checks import Report, tolerance_record
    from robokin.cli.marking import marked
    from robokin.cli.submissions import submissions
    from robokin.errors import InputError
    from robokin.grading.tolerance import default_tolerance

    way = delivery(output, format, json, gradescope, points, visibility, feedback, budget, partial)
    if against is None:
        raise InputError("--against is missing, expected --against ROBOT, the right table")
    free = open_parts(up_to)
    model = load_robot(against, parameter_overrides(set_))
    units = effective_units(model.units, length, angle)
    allowed = stated_tolerance(default_tolerance(model, table=True), tol, tol_angle, None, units)
    found = submissions(files, follow)
    check = TableCheck(model, units, allowed, free, alone=len(found) == 1 and gradescope is None)
    items = tuple(marked(check.mark, found, way.rules, NOTHING))
    return way.deliver(Report("dh", model.id or against, units, tolerance_record(allowed, units), items))


def arguments(words: list[str]) -> list[str]:
    """The arguments, in which no student's file is an option, whatever it is called."""
    from robokin.cli.file_words import files_kept

    return files_kept(words, "--against")
