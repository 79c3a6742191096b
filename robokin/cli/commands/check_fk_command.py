"""`robokin check fk`: poses answered for joint values."""

from __future__ import annotations

from typing import Annotated

from robokin.cli.check_options import AnswerFileOptions, MarkOptions, ToleranceOptions
from robokin.cli.cluster_options import working_on
from robokin.cli.completion import named_poses
from robokin.cli.options import RobotArgument, option
from robokin.errors import InputError


def command(
    robot: RobotArgument,
    *,
    q: Annotated[
        list[str] | None,
        option("--q", "Q", "The joint values of the question, or a named pose; repeatable.", named_poses),
    ] = None,
    expect: Annotated[
        list[str] | None,
        option(
            "--expect",
            "POSE",
            "The answer: X,Y,Z (position alone), X,Y,Z,roll,pitch,yaw, a 4×4 matrix, or an expression.",
        ),
    ] = None,
    sheet: AnswerFileOptions,
    allowed: ToleranceOptions,
    way: MarkOptions,
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
    from robokin.cli.configurations import typed_configurations
    from robokin.cli.statuses import say
    from robokin.grading.answers.answer_tasks import pose_tasks
    from robokin.grading.answers.typed_answers import typed_pose_tasks
    from robokin.grading.marking import marked, without_repetitions
    from robokin.grading.pose_marks import PoseCheck

    sheet.refuse_beside({"--q": q, "--expect": expect})
    check = way.subject(PoseCheck, robot, allowed)
    if sheet.input is not None:
        tasks = pose_tasks(sheet.input, sheet.key, check.robot, check.units, say, follow=sheet.follow)
    elif not q or not expect:
        missing = "--expect" if q else "--q"
        raise InputError(f"{missing} is missing, expected --q and --expect, or --input FILE")
    else:
        tasks = typed_pose_tasks(q, expect, check.robot, check.units)
        typed_configurations(q, check.robot, check.units)  # which notes values in the other angle unit
    items = marked(check, tasks, way.rules)
    if sheet.input is not None and sheet.key is None:
        items = without_repetitions(items)
    with working_on(sheet.cluster):
        return way.finish("fk", robot, check, items)
