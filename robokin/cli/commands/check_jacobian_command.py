"""`robokin check jacobian`: an answered Jacobian."""

from __future__ import annotations

from typing import Annotated

from robokin.cli.check_options import JacobianToleranceOptions, MarkOptions
from robokin.cli.completion import named_poses, words
from robokin.cli.options import RobotArgument, choose, option
from robokin.errors import InputError

FRAMES = ("base", "tool")


def command(
    robot: RobotArgument,
    *,
    q: Annotated[
        str | None, option("--q", "Q", "The joint values of the question, or a named pose.", named_poses)
    ] = None,
    expect: Annotated[str | None, option("--expect", "[[..]]", "The answer: six rows of one number a joint.")] = None,
    frame: Annotated[
        str | None, option("--frame", "FRAME", "Its axes: base or tool.  [default: base]", words(*FRAMES))
    ] = None,
    allowed: JacobianToleranceOptions,
    way: MarkOptions,
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
    from robokin.cli.configurations import typed_configurations
    from robokin.grading.answers.typed_answers import jacobian_answer
    from robokin.grading.jacobian_marks import JacobianCheck
    from robokin.grading.marking import AnswerTask, GivenValue, marked
    from robokin.model.joint_units import joint_factors

    for name, value in (("--q", q), ("--expect", expect)):
        if value is None:
            raise InputError(f"{name} is missing, expected --q and --expect")
    chosen = choose(frame, FRAMES, "--frame") or "base"
    check = way.subject(JacobianCheck, robot, allowed, frame=chosen)
    (given,) = typed_configurations([str(q)], check.robot, check.units)
    values = given * joint_factors(check.robot, check.units)
    task = AnswerTask("1", GivenValue(values), (jacobian_answer(str(expect), check.robot, check.units, chosen),))
    return way.finish("jacobian", robot, check, marked(check, [task], way.rules))
