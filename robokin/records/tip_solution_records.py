"""Answers for targets of several tips as plain data: the document of `robokin ik --target`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from robokin.arrays import Array
from robokin.inverse.solutions import Solution
from robokin.inverse.tip_targets import TipAnswer, TipGroup
from robokin.model import Tree
from robokin.model.joint_units import in_units, joint_factors
from robokin.records.envelope import envelope
from robokin.records.pose_records import poses_in
from robokin.records.self_motion_records import family_record
from robokin.units import Units


@dataclass(frozen=True)
class TipSolutionRecords:
    """Makes the document of an answer in units."""

    answer: TipAnswer
    units: Units

    @property
    def tree(self) -> Tree:
        """The tree that was asked about."""
        return self.answer.question.tree

    def document(self) -> dict[str, Any]:
        """The document: the groups of tips that share joints, each with its solutions."""
        answer, question = self.answer, self.answer.question
        targets = {
            tip: {"matrix": poses_in(T.copy(), self.units).tolist(), "task": question.tasks[tip]}
            for tip, T in question.T.items()
        }
        return {
            **envelope("robot", self.tree.id, self.units),
            "targets": targets,
            "reachable": answer.reachable,
            "complete": answer.complete,
            "q": None if answer.q is None else self.joints(answer.q),
            "still": list(answer.still),
            "groups": [self.group(group) for group in answer.groups],
        }

    def group(self, group: TipGroup) -> dict[str, Any]:
        """Tips that are solved for together."""
        result = group.result
        listed = [self.solution(one, group, k) for k, one in enumerate(result.solutions)]
        return {
            "tips": list(group.tips),
            "joints": list(group.joints),
            "reachable": result.reachable,
            "complete": result.complete,
            "basis": result.basis,
            "certificate": result.certificate,
            "counts": dict(result.counts),
            "families": [family_record(self.tree, self.units, family, result) for family in result.families],
            "families_complete": result.families_complete,
            "method": result.method,
            "reason": result.reason,
            "solutions": listed,
            "nearest": None if result.nearest is None else self.solution(result.nearest, group, 0),
        }

    def solution(self, solution: Solution, group: TipGroup, row: int) -> dict[str, Any]:
        """A configuration of the whole tree, with how far each tip of the group is from its target."""
        errors = {
            tip: {"position_error": position / self.units.metres, "angle_error": angle / self.units.radians}
            for tip, (position, angle) in zip(group.tips, group.errors[row].tolist(), strict=True)
        }
        record: dict[str, Any] = {
            "q": self.joints(solution.q),
            "branch": solution.branch,
            "within_limits": solution.within_limits,
            "tips": errors,
        }
        if solution.free:
            record["self_motion"] = list(solution.free)
        return record

    def joints(self, q: Array) -> Any:
        """Joint values (n,) [rad | m] in the units."""
        return in_units(q, joint_factors(self.tree, self.units)).tolist()
