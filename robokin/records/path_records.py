"""Paths as plain data: the document of `robokin path`, and its rows."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from robokin.arrays import Array
from robokin.inverse.joint_paths import Event, Path, PathBranch, PathTurn, line_task
from robokin.inverse.path_branches import posture
from robokin.inverse.rounded_curves import PathBlend
from robokin.kinematics.velocity import differential_kinematics
from robokin.model import Robot
from robokin.model.joint_units import in_units, joint_factors
from robokin.records.envelope import envelope
from robokin.records.jacobian_records import JacobianRecords
from robokin.records.pose_records import poses_in
from robokin.tables.orientations import pose_columns, pose_table
from robokin.units import Units


@dataclass(frozen=True, eq=False)
class PathRecords:
    """Makes a document of a path."""

    path: Path
    units: Units

    @property
    def robot(self) -> Robot:
        """The robot that follows the path."""
        return self.path.robot

    def columns(self) -> list[str]:
        """The columns' names."""
        joints = range(1, self.robot.n + 1)
        columns = ["t", *(f"q{i}" for i in joints), *pose_columns("rpy")]
        return columns + [f"{name}{i}" for name in ("qd", "qdd") if self.timed for i in joints]

    @property
    def timed(self) -> bool:
        """Whether the path is in seconds, with velocities and accelerations."""
        return self.path.duration is not None

    def joints(self) -> Array:
        """The joint values (m, n) in the units."""
        factors = joint_factors(self.robot, self.units)
        q = np.asarray(self.path.q / factors + 0.0)
        # The ends are what was typed, without the dust of a change of units.
        for i in (0, -1):
            q[i] = in_units(self.path.q[i], factors)
        return q

    def rows(self) -> Array:
        """(m, 7 + n), or of a path in time (m, 7 + 3 n): the columns in the units."""
        poses = pose_table(poses_in(self.path.T.copy(), self.units), "rpy", self.units)
        factors = joint_factors(self.robot, self.units)
        rates = (self.path.velocity, self.path.acceleration)
        timed = [rate / factors + 0.0 for rate in rates if rate is not None]
        return np.concatenate([self.path.t[:, None], self.joints(), poses, *timed], axis=1)

    def records(self) -> Iterator[dict[str, Any]]:
        """A record for each row."""
        n = self.robot.n
        for row in self.rows().tolist():
            record = {"t": row[0], "q": row[1 : n + 1], "position": row[n + 1 : n + 4], "rpy": row[n + 4 : n + 7]}
            if self.timed:
                record |= {"velocity": row[n + 7 : 2 * n + 7], "acceleration": row[2 * n + 7 :]}
            yield record

    def fields(self) -> list[tuple[str, int]]:
        """What a record of a row has, and how many numbers each; 0 for one alone."""
        n = self.robot.n
        fields = [("t", 0), ("q", n), ("position", 3), ("rpy", 3)]
        return fields + ([("velocity", n), ("acceleration", n)] if self.timed else [])

    def document(self) -> dict[str, Any]:
        """The whole path with its summary."""
        return {**self.summary(), "path": list(self.records())}

    def summary(self) -> dict[str, Any]:
        """The document without the rows."""
        path, events = self.path, self.path.events
        return {
            **envelope("robot", self.robot.id, self.units),
            "kind": self.path.kind,
            "steps": path.steps,
            **({"hold": self.held()} if path.held is not None else {}),
            **({"duration": path.duration, "fastest": self.fastest()} if self.timed else {}),
            "complete": path.complete,
            "fraction": path.fraction,
            "length": path.length / self.units.metres,
            "greatest_moves": self.moves().tolist(),
            "least_manipulability": self.least(),
            **self.postures(),
            **({"reorientation": self.reorientation()} if path.reorientation else {}),
            **({"reorientations": [self.turn(one) for one in path.turns]} if path.turns else {}),
            **({"branches": [self.branch(one) for one in path.branches]} if path.branches else {}),
            **({"blends": [self.blend(one) for one in path.blends]} if path.blends else {}),
            **({"choices": list(path.choices)} if path.choices else {}),
            "events": [self.event(event) for event in events],
        }

    def postures(self) -> dict[str, str]:
        """The names of the postures at which the tool's line begins and ends, of an arm that has them."""
        path = self.path
        if path.kind == "joint":
            return {}
        robot, q = self.moving()
        ends = [posture(robot, q[i]) for i in (path.reorientation, -1)]
        # On a singular configuration a sign is a toss: the row beside it tells.
        if len(path) - path.reorientation > 2:
            ends = [posture(robot, q[i]) for i in (path.reorientation + 1, -2)]
        return {"branch": ends[0], "branch_at_end": ends[1]} if all(ends) else {}

    def reorientation(self) -> dict[str, Any]:
        """The JSON of the first move, in which joints turn while the tool stands still."""
        return {name: value for name, value in self.turn(self.path.turns[0]).items() if name not in ("fraction", "row")}

    def turn(self, one: PathTurn) -> dict[str, Any]:
        """The JSON of a turn of joints while the tool stands still."""
        end = in_units(one.end, joint_factors(self.robot, self.units)).tolist()
        return {"fraction": one.fraction, "row": one.row, "steps": one.steps, "joints": one.joints, "end": end}

    def branch(self, one: PathBranch) -> dict[str, Any]:
        """The JSON of a branch that was tried."""
        factors = joint_factors(self.robot, self.units)
        return {
            "branch": one.name,
            "start": in_units(one.start, factors).tolist(),
            "complete": one.complete,
            "fraction": one.fraction,
            "travel": in_units(one.travel, factors).tolist(),
            "ends_by": None if one.event is None else one.event.words,
            "chosen": one.chosen,
        }

    def blend(self, one: PathBlend) -> dict[str, Any]:
        """The JSON of a point that the tool passes by."""
        return {
            "point": one.point,
            "fraction": one.fraction,
            "begins": one.begins,
            "ends": one.ends,
            "distance": one.distance / self.units.metres,
            "angle": one.angle / self.units.radians,
        }

    def event(self, event: Event) -> dict[str, Any]:
        """The JSON of an event, its value in the joint's unit."""
        value = None
        if event.joint is not None and event.value is not None:
            value = event.value / float(joint_factors(self.robot, self.units)[event.joint - 1])
        return {
            "kind": event.kind,
            "fraction": event.fraction,
            "joint": event.joint,
            "value": value,
            "words": event.words,
        }

    def moves(self) -> Array:
        """(n,) how far each joint's least and greatest values are apart."""
        q = self.path.q
        return in_units(np.max(q, axis=0) - np.min(q, axis=0), joint_factors(self.robot, self.units))

    def fastest(self) -> dict[str, list[float]]:
        """The greatest velocity and acceleration of each joint among the rows."""
        factors = joint_factors(self.robot, self.units)
        named = {"velocity": self.path.velocity, "acceleration": self.path.acceleration}
        return {
            name: np.max(np.abs(rates) / factors, axis=0).tolist() for name, rates in named.items() if rates is not None
        }

    def least(self) -> float:
        """The least manipulability on the way, of the Jacobian in the length unit and radians."""
        robot, q = self.moving()
        task: Any = "position" if self.path.kind != "joint" and line_task(robot) == "position" else None
        i = int(np.argmin(self.path.manipulability))
        found = differential_kinematics(robot, q[i : i + 1], task=task)
        return float(JacobianRecords(robot, self.units, "base", task).volumes(found)[0])

    def moving(self) -> tuple[Robot, Array]:
        """The arm of the joints that are not held, and their values (m, k)."""
        held = self.path.held
        return (self.robot, self.path.q) if held is None else (held.part, held.own(self.path.q))

    def held(self) -> dict[str, float]:
        """The joints that are held, with their values in the units."""
        arm = self.path.held
        assert arm is not None
        values = in_units(arm.whole(np.zeros(len(arm.free))), joint_factors(self.robot, self.units))
        return {f"q{j + 1}": float(values[j]) for j in arm.joints.tolist()}
