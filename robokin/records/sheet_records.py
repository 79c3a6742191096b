"""The files of a key, and the document of `robokin check new`."""

from __future__ import annotations

from typing import Any

from robokin.grading.answers.sheet_keys import VERSION
from robokin.grading.questions.exercise import RobotExercise
from robokin.grading.questions.sheets import Sheet, StudentQuestion
from robokin.records.envelope import envelope


def key_record(sheet: Sheet, name: str, folders: dict[str, str]) -> dict[str, Any]:
    """What a key says of a sheet: its questions, its robots with their tolerances, its students."""
    return {
        "version": VERSION,
        "name": name,
        "seed": sheet.seed,
        "questions": [question_record(sheet, i) for i in range(len(sheet.exercises))],
        "robots": {
            one.about: {"file": f"robots/{one.about}.yaml", "tolerance": tolerance_record(one)}
            for one in sheet.exercises if isinstance(one, RobotExercise)
        },
        "students": [{"student": student, "folder": folders[student]} for student in sheet.students],
    }  # fmt: skip


def question_record(sheet: Sheet, i: int) -> dict[str, Any]:
    """A question of a sheet, by its place."""
    one = sheet.exercises[i]
    return {"id": one.id, "kind": one.kind, "about": one.about}


def tolerance_record(exercise: RobotExercise) -> dict[str, float]:
    """How far answers may be off, in the robot's units."""
    units, allowed = exercise.robot.units, exercise.allowed
    return {
        "position": float(f"{allowed.position / units.metres:.9g}"),
        "angle": float(f"{allowed.angle / units.radians:.9g}"),
    }


def numbers_record(question: StudentQuestion) -> dict[str, Any]:
    """The numbers of a student's question, from which marks follow."""
    return {"student": question.student, "id": question.id, "given": question.given}


def new_sheet_record(sheet: Sheet, name: str, folder: str, others: dict[str, str | None]) -> dict[str, Any]:
    """The document about a sheet that was made; others: files beside its folder, null for those that were not asked."""
    return envelope("sheet", name, None) | {
        "folder": folder,
        "seed": sheet.seed,
        "students": len(sheet.students),
        "questions": [question_record(sheet, i) for i in range(len(sheet.exercises))],
        **others,
    }
