"""Jacobians as plain data: the documents of `robokin jacobian`.

The twists are in the length unit and radians, and joint rates too: with angles in degrees a column per degree would
make every book's formula wrong by 57.3.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from robokin.arrays import Array
from robokin.kinematics.velocity import Differential, TaskName, lost_directions, null_space_joints
from robokin.model import Robot
from robokin.model.joint_units import joint_factors
from robokin.records.envelope import envelope
from robokin.units import Units


@dataclass(frozen=True)
class JacobianRecords:
    """Makes documents of a robot's Jacobians, in the axes of a frame and for a task."""

    robot: Robot
    units: Units
    frame: Literal["base", "tool"] = "base"
    task: TaskName | None = None
    force: tuple[float, ...] = ()
    """The force [N] and the moment [N m] at the tool's origin, six numbers in the frame's axes; empty for none."""

    def torques(self, found: Differential) -> Array:
        """The joint torques [N m] and forces of slides [N], (m, n), that hold the force: τ = Jᵀ F.

        Source: B. Siciliano et al., Robotics: Modelling, Planning and Control, 2009, eq. (3.111).
        """
        return np.asarray(np.einsum("mij,i->mj", found.jacobian, np.array(self.force)) + 0.0)

    def matrices(self, found: Differential) -> Array:
        """The Jacobians (m, 6, n) in the length unit and radians."""
        J = found.jacobian.copy()
        J[:, :3, self.robot.revolute] /= self.units.metres
        return J + 0.0

    def volumes(self, found: Differential) -> Array:
        """The manipulability (m,) of the Jacobians as they are printed."""
        values = np.linalg.svd(self.matrices(found)[:, found.task.rows], compute_uv=False)
        product = np.prod(values[:, : found.task.dimension], axis=1)
        return np.where(np.isfinite(found.condition), product, 0.0)

    def records(self, q: Array, found: Differential) -> Iterator[dict[str, Any]]:
        """The JSON documents of a block."""
        kind = found.task
        torques = self.torques(found) if self.force else found.jacobian
        rows = zip(
            q.tolist(),
            self.matrices(found).tolist(),
            found.rank.tolist(),
            found.singular_values.tolist(),
            self.volumes(found).tolist(),
            found.condition.tolist(),
            null_space_joints(found),
            strict=True,
        )
        for i, (values, J, rank, singular, volume, condition, null) in enumerate(rows):
            lost = []
            if rank < kind.dimension:
                lost = lost_directions(self.robot, q[i] * joint_factors(self.robot, self.units), self.frame, self.task)
            record = {
                **envelope("robot", self.robot.id, self.units),
                "jacobian_units": {"length": self.units.length, "angle": "rad"},
                "q": values,
                "frame": self.frame,
                "task": kind.name,
                "jacobian": J,
                "rank": rank,
                "full_rank": kind.dimension,
                "size": kind.size / self.units.metres,
                "singular_values": singular,
                "manipulability": volume,
                "condition": condition if np.isfinite(condition) else None,
                "singular_direction": [{"twist": one.twist.tolist(), "words": one.words} for one in lost] or None,
                "null_space_joints": list(null),
            }
            if self.force:
                record |= {"force": [*self.force], "torques": torques[i].tolist()}
            yield record
