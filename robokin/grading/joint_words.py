"""What is said of answered joint values, in sentences."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from robokin.errors import counted
from robokin.grading.configuration_marks import DUPLICATE, OUTSIDE, Reached, SetMark
from robokin.grading.feedback import Words, alike, joined
from robokin.grading.marking import Subject
from robokin.grading.pose_difference import PASS, WRONG_ORIENTATION, WRONG_POSITION
from robokin.inverse.solutions import Result
from robokin.model.joint_units import in_units, joint_factors
from robokin.number_text import show

TOLD = 20
"""Answers of a set of which it is said one by one what is wrong; `answers` has all."""

BESIDE = 20.0
"""A target that nothing reaches, and that is so many tolerances off at most, may have been meant to be reached."""


@dataclass(frozen=True, eq=False)
class JointWords(Subject):
    """What is said of joint values of a robot, in some units."""

    def words(self, mark: Reached) -> Words:
        """What is wrong with a configuration."""
        if mark.right:
            return Words()
        if mark.status == OUTSIDE:
            return joined([self.outside(mark, i) for i in mark.outside])
        if mark.status == DUPLICATE:
            return alike("the same as another answer")
        parts = [f"{show(mark.position / self.units.metres)} {self.units.length} from the target"]
        if mark.status != WRONG_POSITION:
            parts.append(f"turned by {show(mark.angle / self.units.radians)} {self.units.angle}")
        far = " and ".join(parts if mark.status != WRONG_ORIENTATION else parts[1:])
        return Words("", far, far)

    def outside(self, mark: Reached, joint: int) -> Words:
        """How a joint (from 1) is outside its limits."""
        low, high = in_units(self.robot.limits[joint - 1], joint_factors(self.robot, self.units)[joint - 1])
        value = self.joints(mark.q)[joint - 1]
        said = f"q{joint} {show(value)}"
        off = min(abs(value - low), abs(value - high))
        return Words(
            f"q{joint} is outside its limits", f"{said}, outside its limits by {show(off)}",
            f"{said}, expected {show(low)} to {show(high)}",
        )  # fmt: skip

    def just_beside(self, result: Result) -> Words:
        """How far off the nearest pose of a target is that nothing reaches, where its digits may be why."""
        nearest, allowed, units = result.nearest, self.allowed, self.units
        if nearest is None:
            return Words()
        position, angle = nearest.position_error, nearest.angle_error
        if not (position <= BESIDE * allowed.position and angle <= BESIDE * allowed.angle):
            return Words()
        parts = [(position / units.metres, units.length), (angle / units.radians, units.angle)]
        off = " and ".join(f"{show(value)} {unit}" for value, unit in parts if show(value) != "0")
        said = f"the nearest pose is off by {off}" if off else ""
        return Words("", said, said)

    def set_words(self, mark: SetMark, answers: list[dict[str, Any]]) -> Words:
        """What is wrong with a set: the first answers that are wrong, in words, and what is missing."""
        wrong = [(i, answer) for i, answer in enumerate(answers, start=1) if answer["status"] != PASS]
        parts = [_numbered(i, answer["status"], answer["detail"]) for i, answer in wrong[:TOLD]]
        if len(wrong) > TOLD:
            parts.append(alike(f"and {len(wrong) - TOLD} more answers that are not right"))
        if mark.missing:
            shown = " and ".join(" ".join(map(show, self.joints(q))) for q in mark.missing[:2])
            more = f" and {len(mark.missing) - 2} more" if len(mark.missing) > 2 else ""
            count = f"{len(mark.missing)} of {counted(len(mark.result.solutions), 'solution')} missing"
            parts.append(Words("solutions are missing", "solutions are missing", f"{count}: {shown}{more}"))
        elif not mark.counted and mark.result.reachable:
            parts.append(alike("there may be infinitely many solutions, so each answer is marked by itself"))
        return joined(parts)


def _numbered(i: int, status: str, words: Words) -> Words:
    """What is said of answer i of a set: its status, with what there is to it in brackets."""
    start = f"answer {i}: {status}"
    if words.own:
        return Words(*[f"{start} ({words.own})"] * 3)
    return Words(*(f"{start} ({text})" if text else start for text in (words.part, words.distance, words.answer)))
