"""Answered poses of the end effector as items."""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, ClassVar

from robokin.arrays import Array
from robokin.grading.answer_mistakes import pose_mistake
from robokin.grading.answers.answered_poses import AnsweredPose
from robokin.grading.feedback import Words, joined
from robokin.grading.mark_items import Item
from robokin.grading.marking import AnswerTask, NoAnswerError, Subject
from robokin.grading.pose_difference import (
    PASS,
    WRONG_ORIENTATION,
    WRONG_POSITION,
    pose_errors,
    pose_score,
    pose_status,
    pose_value,
)
from robokin.kinematics.forward import forward_kinematics
from robokin.number_text import show


@dataclass(frozen=True, eq=False)
class PoseCheck(Subject):
    """What poses are marked against."""

    unsaid: ClassVar = MappingProxyType({"q": None, "compared": None})

    def mark(self, task: AnswerTask) -> tuple[Item]:
        """The mark of a pose answered for joint values. Raises InputError for a text that cannot be read."""
        q: Array | None = None
        try:
            q = task.question()
            answer = task.answers[0].read()
        except NoAnswerError as wrong:
            expected = None if q is None else pose_value(forward_kinematics(self.robot, q), "pose", self.units)
            return (
                task.item(
                    wrong.status, 0.0, Words(own=wrong.detail), expected=expected, got=task.answers[0].written,
                    error={"position": None}, more={"q": None if q is None else self.joints(q), "compared": None},
                ),
            )  # fmt: skip
        return (self.item(task, q, answer),)

    def item(self, task: AnswerTask, q: Array, answer: AnsweredPose) -> Item:
        """The mark of a pose answered for q: (n,) [rad | m]."""
        right = forward_kinematics(self.robot, q)
        position, angle = pose_errors(right, answer.T, answer.task)
        status = pose_status(position, angle, self.allowed, right)
        errors = self.errors(position, angle, answer.task)
        expected, got = (pose_value(T, answer.task, self.units) for T in (right, answer.T))
        words, mistake = Words(), None
        if status != PASS:
            words = self.words(status, expected, got, errors)
            mistake = pose_mistake(self, q, answer)
        more = {"q": self.joints(q), "compared": answer.task}
        score = pose_score(status, answer.task)
        return task.item(status, score, words, expected=expected, got=got, error=errors, more=more, mistake=mistake)

    def words(
        self, status: str, expected: dict[str, list[Any]], got: dict[str, list[Any]], errors: dict[str, float | None]
    ) -> Words:
        """What was expected and what was given, of the part that is wrong."""
        parts = []
        for name, wanted in expected.items():
            if status == (WRONG_ORIENTATION if name == "position" else WRONG_POSITION):
                continue
            given = got.get(name)
            said = "no such rotation" if given is None else " ".join(map(show, given))
            label = "roll pitch yaw" if name == "rpy" else name
            part, key, unit = ("position", "position", self.units.length)
            if name != "position":
                part, key, unit = ("orientation", "angle", self.units.angle)
            off = f"{part} off by {show(errors.get(key) or 0.0)} {unit}"
            parts.append(Words("", off, f"{label} {said}, expected {' '.join(map(show, wanted))}"))
        return joined(parts)
