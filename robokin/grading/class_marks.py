"""Answers of a class marked from Python, as `robokin check` marks them: statuses, scores, known mistakes, words.

The report has an item for each answer; `report.score` is what they make together and `item.detail(level)` says what is
wrong, as much of it as a level of feedback (verdict, part, distance, answer) tells. `ids` name the questions (by
default their numbers from 1) and `students` who answered, one each. `budget` are seconds of processor time for each
answer, which is then marked in a process of its own and not decided where it takes more; without one answers are
marked in this process. `partial` is the least score, 0 to 1, of an answer with a known mistake such as another unit.
Errors and words are in `units`, by default the robot's own.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

from numpy.typing import ArrayLike

from robokin.errors import InputError
from robokin.expected import expect_choice, expect_finite, expect_flag, expect_kind, expect_number
from robokin.grading.answers.answered_poses import AnsweredPose
from robokin.grading.jacobian_marks import IN_PLANE, JacobianCheck, jacobian_shapes
from robokin.grading.joint_marks import JointCheck
from robokin.grading.mark_items import Report
from robokin.grading.marking import AnswerTask, GivenAnswer, GivenValue, Rules, Subject, marked
from robokin.grading.marks import expect_configuration, expect_open, expect_target, expect_tolerance
from robokin.grading.pose_marks import PoseCheck
from robokin.grading.table_marks import TableCheck
from robokin.grading.tolerance import Tolerance
from robokin.inverse.solve import TASKS
from robokin.model import Robot, expect_robot
from robokin.units import Units

LONGEST = 1e6
"""Seconds that an answer may be given."""


def grade_poses(
    robot: Robot, q: Sequence[ArrayLike], T: Sequence[ArrayLike], tolerance: Tolerance | None = None, *,
    task: str = "pose", units: Units | None = None, ids: Sequence[str] | None = None,
    students: Sequence[str] | None = None, budget: float | None = None, partial: float | None = None,
) -> Report:  # fmt: skip
    """The marks of poses T: m times (4, 4) [m] that were answered for joint values q: m times (n,) [rad | m].

    Position and orientation are half of the score each; with the task `position` the orientation does not count.
    Raises InputError.
    """
    check = PoseCheck(*_subject(robot, tolerance, units))
    chosen = expect_choice(task, ("pose", "position"), "task")
    answers = [[GivenAnswer(GivenValue(AnsweredPose(expect_target(one), chosen)))] for one in T]
    questions = [expect_configuration(check.robot, one) for one in q]
    return _graded("fk", check, questions, answers, ids, students, expect_rules(budget, partial))


def grade_configurations(
    robot: Robot, T: Sequence[ArrayLike], answers: Sequence[Sequence[ArrayLike] | None],
    tolerance: Tolerance | None = None, *, task: str = "pose", limits: bool = True, every: bool | None = None,
    units: Units | None = None, ids: Sequence[str] | None = None, students: Sequence[str] | None = None,
    budget: float | None = None, partial: float | None = None,
) -> Report:  # fmt: skip
    """The marks of joint values that were answered for targets T: m times (4, 4) [m].

    answers: for each target the configurations, each (n,) [rad | m], or None for the answer that there is no solution.
    With `every` they are compared with all solutions, as they are by default (None) where there are several; with
    False each is marked by itself. Raises InputError.
    """
    asked = None if every is None else expect_flag(every, "every")
    check = JointCheck(*_subject(robot, tolerance, units), expect_flag(limits, "limits"), asked)
    chosen = expect_choice(task, TASKS, "task")
    given = [
        [GivenAnswer(GivenValue(None), claims_none=True)]
        if one is None
        else [GivenAnswer(GivenValue(expect_configuration(check.robot, q))) for q in one]
        for one in answers
    ]
    questions = [AnsweredPose(expect_target(one), chosen) for one in T]
    return _graded("ik", check, questions, given, ids, students, expect_rules(budget, partial), check.prepared)


def grade_jacobians(
    robot: Robot, q: Sequence[ArrayLike], J: Sequence[ArrayLike], tolerance: Tolerance | None = None, *,
    frame: str = "base", units: Units | None = None, ids: Sequence[str] | None = None,
    students: Sequence[str] | None = None, budget: float | None = None, partial: float | None = None,
) -> Report:  # fmt: skip
    """The marks of Jacobians J: m times (6, n), linear rows [m | 1] first, answered for q: m times (n,) [rad | m].

    Of an arm in the plane of x and y the rows vx, vy, wz, or vx, vy, will do. The score is the part of the columns that
    are right. Raises InputError.
    """
    chosen = expect_choice(frame, ("base", "tool"), "frame")
    check = JacobianCheck(*_subject(robot, tolerance, units), chosen)
    shapes, answers = jacobian_shapes(check.robot, chosen), []
    for one in J:
        values = expect_finite(one, "J", "a Jacobian of finite numbers", None)
        if values.shape not in shapes:
            expected = " or ".join(map(str, shapes))
            raise InputError(f"J: found an array of shape {values.shape}, expected {expected}")
        # Answers are read in the units: linear entries of turning joints are lengths.
        scale = check.scale(IN_PLANE.get(len(values), range(6)))
        answers.append([GivenAnswer(GivenValue(values / scale))])
    questions = [expect_configuration(check.robot, one) for one in q]
    return _graded("jacobian", check, questions, answers, ids, students, expect_rules(budget, partial))


def grade_tables(
    robot: Robot, tables: Sequence[Robot], tolerance: Tolerance | None = None, *, up_to: Iterable[str] = (),
    units: Units | None = None, ids: Sequence[str] | None = None, students: Sequence[str] | None = None,
    budget: float | None = None, partial: float | None = None,
) -> Report:  # fmt: skip
    """The marks of tables: whether each is kinematically the robot, but for `up_to` (base, tool, zero, sign).

    The score is the part of the joints that stand right to the one before. Raises InputError.
    """
    check = TableCheck(*_subject(robot, tolerance, units, table=True), expect_open(up_to))
    answers = [[GivenAnswer(GivenValue(expect_robot(one, "tables")))] for one in tables]
    return _graded("dh", check, [None] * len(answers), answers, ids, students, expect_rules(budget, partial))


def _subject(
    robot: Robot, tolerance: Tolerance | None, units: Units | None, *, table: bool = False
) -> tuple[Robot, Units, Tolerance]:
    robot = expect_robot(robot)
    own = (
        robot.units
        if units is None
        else expect_kind(units, Units, "units", "units, such as robokin.Units('mm', 'deg')")
    )
    return robot, own, expect_tolerance(robot, tolerance, table=table)


def expect_rules(budget: float | None, partial: float | None) -> Rules:
    """What holds for all marks. Raises InputError."""
    for name, value, most in (("budget", budget, LONGEST), ("partial", partial, 1.0)):
        if value is not None and not 0.0 < expect_number(value, name, f"a number up to {most:g}, or None") <= most:
            raise InputError(f"{name}: found {value:g}, expected a number above 0 up to {most:g}, or None")
    return Rules(budget, partial)


def _graded(
    kind: str, check: Subject, questions: Sequence[Any], answers: Sequence[Sequence[GivenAnswer]],
    ids: Sequence[str] | None, students: Sequence[str] | None, rules: Rules,
    prepared: Callable[[Sequence[AnswerTask]], Sequence[AnswerTask]] = list,
) -> Report:  # fmt: skip
    names = [str(i + 1) for i in range(len(questions))] if ids is None else list(ids)
    who = [None] * len(questions) if students is None else list(students)
    for found, what in ((len(answers), "answers"), (len(names), "ids"), (len(who), "students")):
        if found != len(questions):
            raise InputError(f"found {len(questions)} questions and {found} {what}, expected one for each question")
    columns = zip(names, questions, answers, who, strict=True)
    tasks = [AnswerTask(name, GivenValue(question), tuple(own), one) for name, question, own, one in columns]
    return check.report(kind, check.robot.id or check.robot.name, tuple(marked(check, prepared(tasks), rules)))
