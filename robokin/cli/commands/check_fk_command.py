"""`robokin check fk`: poses answered for joint values."""

from __future__ import annotations

from typing import Annotated

import typer

from robokin.cli.check_options import FILES, MARKS, TOLERANCES, Marking, marking
from robokin.cli.completion import named_poses
from robokin.cli.options import RobotArgument
from robokin.errors import InputError


@marking(*FILES, *TOLERANCES, *MARKS)
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
    *,
    way: Marking,
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
    from robokin.cli.statuses import say
    from robokin.grading.answers.answer_tasks import pose_tasks
    from robokin.grading.answers.typed_answers import typed_pose_tasks
    from robokin.grading.marking import marked, without_repetitions
    from robokin.grading.pose_marks import PoseCheck

    way.one_source({"--q": q, "--expect": expect})
    check = way.subject(PoseCheck, robot)
    if way.input is not None:
        tasks = pose_tasks(way.input, way.key, check.robot, check.units, say, follow=way.follow)
    elif not q or not expect:
        missing = "--expect" if q else "--q"
        raise InputError(f"{missing} is missing, expected --q and --expect, or --input FILE")
    else:
        tasks = typed_pose_tasks(q, expect, check.robot, check.units)
    items = marked(check, tasks, way.rules)
    if way.input is not None and way.key is None:
        items = without_repetitions(items)
    return way.finish("fk", robot, check, items)
