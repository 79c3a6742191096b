"""`robokin check ik`: joint values answered for poses."""

from __future__ import annotations

from typing import Annotated

import typer

from robokin.cli.check_options import AnswerFileOptions, MarkOptions, ToleranceOptions
from robokin.cli.cluster_options import working_on
from robokin.cli.completion import named_poses
from robokin.cli.options import RobotArgument, option
from robokin.cli.target_options import TargetOptions
from robokin.errors import InputError


def command(
    robot: RobotArgument,
    *,
    q: Annotated[
        list[str] | None,
        option("--q", "Q", "The answer, or `none`; several are marked as the set of all solutions.", named_poses),
    ] = None,
    target: TargetOptions,
    every: Annotated[
        bool, typer.Option("--all", help="All solutions are asked for, also of a question with one answer.")
    ] = False,
    any_: Annotated[bool, typer.Option("--any", help="Each answer is marked by itself, also several.")] = False,
    no_limits: Annotated[bool, typer.Option("--no-limits", help="The joint limits do not matter.")] = False,
    sheet: AnswerFileOptions,
    allowed: ToleranceOptions,
    way: MarkOptions,
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
    from robokin.cli.configurations import note_answered_units
    from robokin.cli.statuses import say
    from robokin.cli.targets import parse_target
    from robokin.grading.answers.answer_tasks import joint_tasks
    from robokin.grading.answers.answered_poses import AnsweredPose
    from robokin.grading.answers.typed_answers import typed_joints
    from robokin.grading.joint_marks import JointCheck
    from robokin.grading.marking import AnswerTask, GivenValue, marked

    sheet.refuse_beside({**target.texts, "--q": q})
    if every and any_:
        raise InputError("--all and --any exclude each other, expected one of them")
    asked = True if every else False if any_ else None
    check = way.subject(JointCheck, robot, allowed, limits=not no_limits, every=asked)
    if sheet.input is not None:
        tasks = joint_tasks(sheet.input, sheet.key, check.robot, check.units, say, follow=sheet.follow)
    else:
        question = parse_target(target.texts, check.robot, check.units)
        if not q:
            raise InputError("--q is missing, expected the joint values that were answered, or --input FILE")
        for note in question.notes:
            say(note)
        note_answered_units(q, check.robot, check.units)
        answers = tuple(typed_joints(text, check.robot, check.units) for text in q)
        tasks = [AnswerTask("1", GivenValue(AnsweredPose(question.T, question.task)), answers)]
    with working_on(sheet.cluster):
        return way.finish("ik", robot, check, marked(check, check.prepared(tasks), way.rules))
