"""Answers of inverse kinematics as plain data: the documents of `robokin ik`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from robokin.arrays import Array
from robokin.inverse.solutions import Result, Solution
from robokin.model import Robot
from robokin.model.joint_units import joint_factors
from robokin.records.envelope import envelope
from robokin.records.pose_records import poses_in
from robokin.records.self_motion_records import family_record
from robokin.units import Units

RECORD_KEYS = (
    "schema", "robot", "id", "units", "target", "hold", "reachable", "complete", "basis", "certificate", "counts",
    "families", "families_complete", "method", "reason", "solutions", "nearest", "explanation", "jump",
)  # fmt: skip
"""What a document says itself."""


@dataclass(frozen=True)
class SolutionRecords:
    """Makes documents of a robot's answers for a task: pose, approach or position.

    `held` are the joints, from 0, that are held, with their values in the units.
    """

    robot: Robot
    units: Units
    task: str = "pose"
    held: Mapping[int, float] = field(default_factory=dict)

    def record(self, target: Array, result: Result) -> dict[str, Any]:
        """The document of the answer to a target: (4, 4) [m]."""
        record: dict[str, Any] = {
            **envelope("robot", self.robot.id, self.units),
            "target": {"matrix": poses_in(target.copy(), self.units).tolist(), "task": self.task},
        }
        if self.held:
            record["hold"] = {f"q{joint + 1}": value for joint, value in sorted(self.held.items())}
        return record | {
            "reachable": result.reachable,
            "complete": result.complete,
            "basis": result.basis,
            "certificate": result.certificate,
            "counts": dict(result.counts),
            "families": [family_record(self.robot, self.units, family, result) for family in result.families],
            "families_complete": result.families_complete,
            "method": result.method,
            "reason": result.reason,
            "solutions": [self.solution(solution) for solution in result.solutions],
            "nearest": None if result.nearest is None else self.solution(result.nearest),
        }

    def solution(self, solution: Solution) -> dict[str, Any]:
        """A solution in the units; at a singular one also the numbers of the joints that may trade motion."""
        record: dict[str, Any] = {
            "q": self.joints(solution.q),
            "branch": solution.branch,
            "within_limits": solution.within_limits,
            "position_error": solution.position_error / self.units.metres,
            "angle_error": solution.angle_error / self.units.radians,
        }
        if solution.free:
            record["self_motion"] = list(solution.free)
        return record

    def joints(self, q: Array) -> Any:
        """Joint values (..., n) [rad | m] in the units, as lists."""
        return self.values(q).tolist()

    def values(self, q: Array) -> Array:
        """The same as an array; of held joints the digits that were asked for."""
        values = q / joint_factors(self.robot, self.units) + 0.0
        for joint, value in self.held.items():
            values[..., joint] = np.where(np.isnan(values[..., joint]), np.nan, value)
        return values
