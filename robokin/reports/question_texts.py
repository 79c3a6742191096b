"""A student's sheet in words: the robots' tables, the questions, and what is asked for."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

from robokin.arrays import Array
from robokin.errors import counted
from robokin.grading.questions.count_exercise import CountExercise
from robokin.grading.questions.exercise import Exercise, Given, RobotExercise
from robokin.grading.questions.jacobian_exercise import JacobianExercise
from robokin.grading.questions.joint_exercise import JointExercise, SolutionsExercise
from robokin.grading.questions.pose_exercise import PoseExercise
from robokin.grading.questions.pose_forms import PoseForm
from robokin.grading.questions.sheets import StudentQuestion
from robokin.grading.questions.table_exercise import TableExercise
from robokin.grading.questions.typed_numbers import decimal_text
from robokin.kernel.facts import fact
from robokin.model import Robot
from robokin.number_text import show
from robokin.pictures.arm_sketch import ArmSketch, arm_sketch
from robokin.records.description_records import robot_record
from robokin.reports.question_markup import Block, RawBlock, TableBlock, TextBlock, in_both
from robokin.reports.table_files import latex_table, markdown_table

MATRICES = {
    "standard": "Each row is A = Rot(z, θ) Trans(0, 0, d) Trans(a, 0, 0) Rot(x, α).",
    "modified": "Each row is A = Rot(x, α i-1) Trans(a i-1, 0, 0) Rot(z, θ) Trans(0, 0, d).",
    "frames": "Each row is its origin, then the motion about or along its axis.",
}

TURNS = "roll, pitch, yaw: R = Rot(z, yaw) Rot(y, pitch) Rot(x, roll), pitch between -90° and 90°"


@fact
def sketch_of(robot: Robot) -> ArmSketch:
    """The sketch of a robot, drawn once."""
    return arm_sketch(robot)


def sheet_text(title: str, student: str, questions: Sequence[StudentQuestion]) -> list[Block]:
    """A student's sheet."""
    blocks: list[Block] = [
        TextBlock(f"{title}: {student}", 1),
        TextBlock(
            "These numbers are yours alone. Write each answer into answers.csv, a number a line, in the unit that "
            "stands there; leave the other columns as they are."
        ),
    ]
    for name, exercise in robots_of([question.exercise for question in questions]).items():
        blocks.append(_robot_part(exercise.robot, name))
    for question in questions:
        blocks += [TextBlock(f"Question {question.id}", 2), *question_text(question.exercise, question.given)]
    return blocks


def robots_of(exercises: Sequence[Exercise]) -> dict[str, RobotExercise]:
    """The robots whose tables a sheet shows, by their names on it: not those whose table is asked for."""
    return {
        one.about: one for one in exercises if isinstance(one, RobotExercise) and not isinstance(one, TableExercise)
    }


@fact
def _described(robot: Robot) -> RawBlock:
    """A robot's table."""
    record = robot_record(robot, robot.units)
    tex = "\n".join(line for line in latex_table(record).decode().splitlines() if not line.startswith("%"))
    return RawBlock(markdown_table(record).decode().rstrip("\n").partition("\n\n")[2], tex)


@fact
def _robot_part(robot: Robot, name: str) -> RawBlock:
    """A robot's table and its sketch."""
    units, sketch = robot.units, sketch_of(robot)
    return in_both(
        [
            TextBlock(f"Robot {name}: {robot.name}", 2),
            TextBlock(f"Lengths in {units.length}, angles in {units.angle}. {MATRICES[robot.convention]}"),
            _described(robot),
            RawBlock(f"![Sketch of {name}]({name}.svg)", "\n".join(sketch.tikz())),
            TextBlock(f"The arm, {sketch.about}."),
        ]
    )


def question_text(exercise: Exercise, given: Given) -> list[Block]:
    """One question, with its numbers."""
    if isinstance(exercise, CountExercise):
        return _count_text(given)
    if isinstance(exercise, TableExercise):
        return _table_text(exercise, given)
    if isinstance(exercise, JointExercise):
        return _joint_text(exercise, given)
    assert isinstance(exercise, PoseExercise)
    values = TableBlock([f"{one.name} [{one.unit}]" for one in exercise.joint_quantities()], [[*map(show, given["q"])]])
    if isinstance(exercise, JacobianExercise):
        return [
            TextBlock(f"Give the geometric Jacobian of {exercise.about}, for the end effector and in the axes of the "
                      "base, at"),
            values,
            TextBlock(
                f"Rows {', '.join(dict.fromkeys(one.name.split()[0] for one in exercise.quantities(given)))}, linear "
                "before angular; a column for each joint, of a revolute one for a radian. A length may be off by "
                f"{allowed_texts(exercise)[0]}, a number without a unit by {decimal_text(exercise.allowed.angle, 4)}."
            ),
        ]  # fmt: skip
    return [
        TextBlock(f"Give the pose of the end effector of {exercise.about} at"),
        values,
        TextBlock(
            f"Asked for: {_form_in_words(exercise.form)}. A length may be off by {_off(exercise, ', an angle by')}."
        ),
    ]


def _form_in_words(form: PoseForm) -> str:
    names = ", ".join(form.names)
    if form.kind == "rpy":
        return f"x, y, z and {TURNS}"
    if form.kind == "matrix":
        return "the first three rows of the 4×4 matrix, m11 to m34"
    return f"{names}, where phi is the angle of the end effector's x axis" if "phi" in form.names else names


def allowed_texts(exercise: RobotExercise) -> tuple[str, str]:
    """How far a length may be off, and an angle."""
    units, allowed = exercise.robot.units, exercise.allowed
    length, angle = allowed.position / units.metres, allowed.angle / units.radians
    return f"{show(length)} {units.length}", f"{show(angle)} {units.angle}"


def _off(exercise: PoseExercise | JointExercise, between: str) -> str:
    """How far a pose may be off; of a position no angle is said."""
    length, angle = allowed_texts(exercise)
    return f"{length}{between} {angle}" if exercise.form.turns else length


def _precision(exercise: JointExercise, given: Given) -> str:
    """How far the pose of joint values may be off, and with how many decimals it never is for being rounded."""
    lengths, angles = exercise.enough_decimals(given)
    turning = exercise.robot.revolute
    said = [f"angles with {counted(angles, 'decimal')}"] if turning.any() else []
    said += [f"lengths with {counted(lengths, 'decimal')}"] if not turning.all() else []
    where = "pose" if exercise.form.turns else "place"
    return f"The {where} they lead to may be off by {_off(exercise, ' and')}: {' and '.join(said)} are enough."


def target_text(exercise: JointExercise, given: Given) -> list[Block]:
    """Where the end effector is to be, without what is asked for."""
    form, units = exercise.form, exercise.robot.units
    headings = [f"{name} [{unit}]" if (unit := form.unit(name, units)) else name for name in form.names]
    turns = f" ({TURNS})" if form.kind == "rpy" else ""
    return [
        TextBlock(f"The end effector of {exercise.about} is to be at{turns}"),
        TableBlock(headings, [[show(given[name]) for name in form.names]]),
    ]


def each_joint_off(exercise: JointExercise) -> str:
    """How far each joint value may be off where they are compared one by one."""
    (length, angle), turning = allowed_texts(exercise), exercise.robot.revolute
    said = [f"each angle may be off by {angle}"] if turning.any() else []
    said += [f"each length {'by' if said else 'may be off by'} {length}"] if not turning.all() else []
    return ", ".join(said).capitalize() + "."


def _joint_text(exercise: JointExercise, given: Given) -> list[Block]:
    asked = "Give joint values within the limits; any solution will do."
    if isinstance(exercise, SolutionsExercise):
        count = given["count"]
        asked = f"Give all solutions within the limits, in any order: there {'is 1' if count == 1 else f'are {count}'}."
    return [*target_text(exercise, given), TextBlock(f"{asked} {_precision(exercise, given)}")]


def _table_text(exercise: TableExercise, given: Given) -> list[Block]:
    arm = exercise.robot
    axes, last = exercise.axes(given)
    types = {"R": "revolute", "P": "prismatic"}
    lines = [
        [str(i), types[row["type"]], _vector(point), _vector(direction)]
        for i, (row, (point, direction)) in enumerate(zip(given["rows"], axes, strict=True), start=1)
    ]
    frame = f"origin {_vector(last[:3, 3])}, x axis {_vector(last[:3, 0])}, z axis {_vector(last[:3, 2])}"
    slides = ", d of a prismatic joint" if "P" in arm.types else ""
    return [
        TextBlock(
            f"An arm like {exercise.about}, with all joints at zero; coordinates in {arm.units.length}, in the frame "
            "of the base. Each joint moves about or along the direction of its axis."
        ),
        TableBlock(["joint", "type", "a point of its axis", "direction"], lines),
        TextBlock(
            f"The last frame is the end effector's, at zero: {frame}. Frame 0 is the base's. Give the "
            f"Denavit-Hartenberg table in the {arm.convention} convention, theta of a revolute joint{slides} as it is "
            f"at zero. {MATRICES[arm.convention]} Any table that moves the last frame as this arm does is right."
        ),
    ]


def _vector(values: Array) -> str:
    return f"({', '.join(decimal_text(value, 6) for value in values)})"


def _count_text(given: Given) -> list[Block]:
    joints = given["joints"]
    links = 1 + max(max(joint[1:]) for joint in joints)
    order = {"planar": "plane: a free link has 3 freedoms", "spherical": "sphere: a free link has 3 freedoms"}
    where = order.get(given["space"], "space: a free link has 6 freedoms")
    lines = [[_letter(i), kind, _link(a), _link(b)] for i, (kind, a, b) in enumerate(joints)]
    return [
        TextBlock(f"A mechanism moves in the {where}. Link 0 is the ground; the links are numbered to {links - 1}."),
        TableBlock(["joint", "type", "link", "link"], lines),
        TextBlock("How many freedoms has it by Grübler's count?"),
    ]


def _link(number: int) -> str:
    return "0 (ground)" if number == 0 else str(number)


@cache
def _letter(i: int) -> str:
    return chr(ord("A") + i) if i < 26 else f"A{i - 25}"
