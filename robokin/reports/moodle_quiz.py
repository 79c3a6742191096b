"""The questions of a sheet as a Moodle quiz in XML: a category for each question, a variant for each student.

A quiz takes a random question from each category. Each is a cloze question whose gaps are numbers with a tolerance,
equal parts of its mark. Moodle compares numbers one by one: of inverse kinematics it is told which solution is meant,
and questions of which it cannot be told are left out.
Source: Moodle documentation, Moodle XML format; Embedded answers (Cloze) question type.
"""

from __future__ import annotations

from base64 import b64encode
from html import escape

import numpy as np

from robokin.arrays import Array
from robokin.errors import counted
from robokin.grading.questions.exercise import Exercise, RobotExercise
from robokin.grading.questions.joint_exercise import JointExercise, SolutionsExercise
from robokin.grading.questions.sheets import Sheet, StudentQuestion
from robokin.grading.questions.table_exercise import TableExercise
from robokin.model import Robot
from robokin.records.description_records import robot_record
from robokin.reports.question_markup import Block, TableBlock, TextBlock
from robokin.reports.question_texts import each_joint_off, question_text, robots_of, sketch_of, target_text
from robokin.reports.table_files import html_table, printable

CLEAR = np.radians(1.0)
"""Solutions are told apart by the first joint that differs; it differs by this [rad], or not at all."""

EQUAL = 1e-6
"""Joint values [rad | m] that differ by less are the same."""


FIRST = (
    "Of all solutions within the limits, with angles between minus and plus half a turn, give the one with the "
    "smallest q1; where several have that q1, the one of these with the smallest q2, and so on."
)
ONLY = "Give joint values within the limits; there is one solution."


def moodle_quiz(sheet: Sheet, name: str) -> tuple[bytes, list[str]]:
    """The quiz, and a sentence for each question that is left out."""
    parts = ['<?xml version="1.0" encoding="UTF-8"?>', "<quiz>"]
    notes = []
    for number, exercise in enumerate(sheet.exercises):
        why = left_out(exercise)
        if why:
            notes.append(f"question {exercise.id} ({exercise.kind}) is not in the quiz: {why}")
            continue
        category = f"$course$/{name}/question {exercise.id}".replace("//", "/")
        parts.append(f'<question type="category"><category><text>{_xml(category)}</text></category></question>')
        pictures, unclear = "".join(_picture(name, one.robot) for name, one in robots_of([exercise]).items()), 0
        for i in range(len(sheet.students)):
            question = sheet.questions(i)[number]
            gaps = cloze_gaps(question)
            if gaps is None:
                unclear += 1
                continue
            text = _html(question) + gaps
            title = f"{name} {exercise.id} {question.student}"
            parts.append(
                f'<question type="cloze"><name><text>{_xml(title)}</text></name>'
                f'<questiontext format="html"><text>{_xml(text)}</text>{pictures}</questiontext>'
                "<generalfeedback><text></text></generalfeedback><penalty>0.3333333</penalty><hidden>0</hidden>"
                "</question>"
            )
        if unclear:
            notes.append(
                f"question {exercise.id}: {counted(unclear, 'variant')} not in the quiz: two solutions begin alike"
            )
    return ("\n".join([*parts, "</quiz>"]) + "\n").encode(), notes


def left_out(exercise: Exercise) -> str:
    """Why Moodle cannot mark a question, or ""."""
    if isinstance(exercise, TableExercise):
        return "several tables are right"
    if isinstance(exercise, SolutionsExercise):
        return "its solutions have no order"
    if isinstance(exercise, JointExercise) and exercise.redundant:
        return "infinitely many solutions are right"
    return ""


def cloze_gaps(question: StudentQuestion) -> str | None:
    """The gaps of a question, None where it cannot be said which solution is meant."""
    exercise, given = question.exercise, question.given
    said, answers = "", exercise.answers(given)
    if isinstance(exercise, JointExercise):
        solutions = exercise.solutions(given)
        first = first_solution(exercise, solutions)
        if first is None:
            return None
        answers = exercise.texts(first)
        said = f"<p>{FIRST if len(solutions) > 1 else ONLY} {escape(each_joint_off(exercise))}</p>"
    gaps = []
    for quantity, answer in zip(exercise.quantities(given), answers, strict=True):
        far, turn = _allowed(exercise, quantity.unit)
        right = f"={answer}:{far}"
        if turn and float(answer):
            other = float(answer) - np.sign(float(answer)) * turn
            right += f"~={other:.9g}:{far}"
        unit = f" {quantity.unit}" if quantity.unit else ""
        gaps.append(f"<p>{escape(quantity.name)} = {{1:NUMERICAL:{right}}}{unit}</p>")
    return said + "".join(gaps)


def first_solution(exercise: JointExercise, solutions: list[Array]) -> Array | None:
    """The solution with the smallest joint values, q1 first; None where a last digit decides which that is."""
    wrapped = [np.where(exercise.robot.revolute, np.remainder(q + np.pi, 2.0 * np.pi) - np.pi, q) for q in solutions]
    clear = np.where(exercise.robot.revolute, CLEAR, 0.01 * exercise.allowed.size)
    for q in wrapped:
        if np.any(exercise.robot.revolute & (np.pi - np.abs(q) < CLEAR)):
            return None
    for i, one in enumerate(wrapped):
        for other in wrapped[:i]:
            off = np.abs(one - other)
            differs = np.flatnonzero(off > EQUAL)
            if not len(differs) or off[differs[0]] < clear[differs[0]]:
                return None
    order = sorted(range(len(wrapped)), key=lambda i: [round(value, 5) for value in wrapped[i].tolist()])
    return wrapped[order[0]] if order else None


def _allowed(exercise: Exercise, unit: str) -> tuple[str, float]:
    """How far an answer may be off, and a full turn of an angle, 0 for what is none."""
    if not isinstance(exercise, RobotExercise):
        return "0", 0.0
    units, allowed = exercise.robot.units, exercise.allowed
    if unit == units.length:
        return f"{allowed.position / units.metres:.6g}", 0.0
    if unit == units.angle:
        return f"{allowed.angle / units.radians:.6g}", 2.0 * np.pi / units.radians
    return f"{allowed.angle:.6g}", 0.0


def _html(question: StudentQuestion) -> str:
    """The text of a question with its robot's table."""
    parts = []
    for robot in robots_of([question.exercise]).values():
        record = robot_record(robot.robot, robot.robot.units)
        sketch = sketch_of(robot.robot)
        parts.append(f"<p>{escape(printable(robot.robot.name))}</p>{html_table(record)}")
        picture = f'<img src="@@PLUGINFILE@@/{escape(robot.about)}.svg" alt="sketch of {escape(robot.about)}"/>'
        parts.append(f"<p>{picture}<br/>{escape(sketch.about)}</p>")
    exercise, given = question.exercise, question.given
    # Moodle compares number by number: what is asked of joint values stands before their gaps.
    text = target_text(exercise, given) if isinstance(exercise, JointExercise) else question_text(exercise, given)
    return "".join([*parts, *map(_html_block, text)]).replace("{", "&#123;")


def _picture(name: str, robot: Robot) -> str:
    """The sketch of a robot, as a file of a question."""
    data = b64encode(sketch_of(robot).svg(robot.name)).decode()
    return f'<file name="{escape(name)}.svg" path="/" encoding="base64">{data}</file>'


def _html_block(block: Block) -> str:
    if isinstance(block, TextBlock):
        return f"<p>{escape(printable(block.text))}</p>"
    assert isinstance(block, TableBlock)
    lines = "".join(f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in row)}</tr>" for row in block.rows)
    head = "".join(f"<th>{escape(cell)}</th>" for cell in block.headings)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{lines}</tbody></table>"


def _xml(text: str) -> str:
    """A text as XML holds it."""
    return escape(text, quote=False)
