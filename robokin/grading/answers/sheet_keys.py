"""The key of a sheet, read from its folder: the questions of each student, from which marks follow.

The right answers in the folder are for eyes: marks are worked out anew from the questions' numbers.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from robokin.errors import InputError, shown
from robokin.files import open_path, read_up_to
from robokin.formats.read import MAX_BYTES, read_bytes
from robokin.grading.questions.count_exercise import CountExercise, Pairs
from robokin.grading.questions.exercise import Exercise, Given
from robokin.grading.questions.sheets import KINDS, exercise_of
from robokin.grading.tolerance import Tolerance
from robokin.json_text import value_in
from robokin.kinematics.structure import arm_size
from robokin.model import Robot

SHEET, QUESTIONS = "sheet.json", "questions.jsonl"
"""Files of a key: what is asked, and each student's numbers."""

VERSION = 1
"""Of the key's files."""

LARGEST = 256 << 20
"""Bytes of a file of a key."""


@dataclass(frozen=True)
class SheetKey:
    """A key: its exercises by their ids, the students with their files' names, and the numbers by student and id."""

    exercises: Mapping[str, Exercise]
    students: Mapping[str, str]
    numbers: Mapping[tuple[str, str], Given]
    name: str


def read_sheet_key(folder: str) -> SheetKey:
    """The key in a folder. Raises InputError for what is none, naming the file."""
    if not os.path.isfile(os.path.join(folder, SHEET)):  # noqa: PTH113, PTH118 - pathlib refuses what is no path
        raise InputError(f"{shown(folder)}: found no {SHEET}, expected the folder `key` that robokin check new wrote")
    place, sheet = _json(folder, SHEET)
    try:
        if sheet["version"] != VERSION:
            raise InputError(f"{place}: found the version {sheet['version']!r}, expected {VERSION}")
        robots = {name: _robot(folder, one) for name, one in sheet["robots"].items()}
        exercises = {str(one["id"]): _exercise(one, robots) for one in sheet["questions"]}
        students = {str(one["student"]): str(one["folder"]) for one in sheet["students"]}
        name = str(sheet["name"])
    except (KeyError, TypeError, AttributeError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{place}: found no {error}, expected the file as robokin check new wrote it") from None
    numbers: dict[tuple[str, str], Given] = {}
    place, text = _text(folder, QUESTIONS)
    for line, one in enumerate(text.splitlines(), start=1):
        try:
            record = value_in(one)
            at = str(record["student"]), str(record["id"])
            known = at[0] in students and at[1] in exercises and at not in numbers
            numbers[at] = dict(record["given"])
        except (KeyError, TypeError, ValueError, RecursionError) as error:
            raise InputError(f"{place}, line {line}: {error}, expected a question of the sheet") from None
        if not known:
            raise InputError(
                f"{place}, line {line}: found {shown(repr(at))}, expected each question once, of the sheet"
            )
    return SheetKey(exercises, students, numbers, name)


def _text(folder: str, name: str) -> tuple[str, str]:
    place = os.path.join(folder, name)  # noqa: PTH118 - sentences show it as it was typed
    with open_path(place, "a file of a key") as stream:
        data = read_up_to(stream, place, LARGEST, "a file of a key")
    try:
        return place, data.decode()
    except UnicodeDecodeError:
        raise InputError(f"{place}: found bytes that are no text, expected UTF-8") from None


def _json(folder: str, name: str) -> tuple[str, Any]:
    place, text = _text(folder, name)
    try:
        return place, value_in(text)
    except (ValueError, RecursionError) as error:
        raise InputError(f"{place}: {error}, expected JSON") from None


def _robot(folder: str, record: dict[str, Any]) -> tuple[Robot, Tolerance]:
    place = os.path.join(folder, *str(record["file"]).split("/"))  # noqa: PTH118 - as above
    with open_path(place, "a description") as stream:
        robot = read_bytes(stream.read(MAX_BYTES + 1), place)
    if not isinstance(robot, Robot):
        raise InputError(f"{place}: found no robot, expected the one of the sheet")
    stated, units = record["tolerance"], robot.units
    position, angle = float(stated["position"]) * units.metres, float(stated["angle"]) * units.radians
    return robot, Tolerance(position, angle, size=arm_size(robot))


def _exercise(record: dict[str, Any], robots: Mapping[str, tuple[Robot, Tolerance]]) -> Exercise:
    kind, id, about = str(record["kind"]), str(record["id"]), str(record["about"])
    if kind == CountExercise.kind:
        return CountExercise(id, about, Pairs("planar", 0, ()))  # what is counted stands in each student's question
    if kind not in KINDS:
        raise InputError(f"question {id}: found the kind '{shown(kind)}', expected one of {', '.join(KINDS)}")
    robot, allowed = robots[about]
    return exercise_of(kind, id, about, robot, allowed)
