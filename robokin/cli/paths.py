"""Answers of `robokin path`: rows for programs, a summary for eyes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import IO, Any

import numpy as np

from robokin.arrays import Array
from robokin.cli.arguments import in_units, joint_factors
from robokin.cli.output.numbers import counted, show
from robokin.cli.output.text import csv_header, csv_rows, json_document, json_line
from robokin.cli.records import poses_in
from robokin.inverse.joint_paths import Event, Path
from robokin.model import Robot
from robokin.records.envelope import envelope
from robokin.tables.orientations import pose_columns, pose_table
from robokin.units import Units

SAME = 1e-6
"""Joint values [rad | m] that differ by less are one."""

SHOWN = 11
"""Rows of the table: the whole path is for CSV, JSON lines and arrays."""

WIDEST = 7
"""Joints whose values fit the width of a page."""


@dataclass(frozen=True, eq=False)
class PathAnswer:
    """A path in the units; `wanted` are joint values (n,) [rad | m] that a line was asked to end with, if it was."""

    robot: Robot
    units: Units
    kind: str
    path: Path
    wanted: Array | None

    def write(self, kind: str, stream: IO[bytes]) -> Iterator[bytes]:
        """The path in a format; arrays go to the stream themselves."""
        if kind == "npy":
            np.lib.format.write_array(stream, self.rows(), version=(1, 0))
        elif kind == "csv":
            yield csv_header(self.columns()) + csv_rows(self.rows())
        elif kind == "jsonl":
            head = envelope("robot", self.robot.id, self.units)
            yield b"".join(json_line({**head, **record}) for record in self.records())
        elif kind == "json":
            yield json_document(self.document())
        else:
            yield from self.page()

    def columns(self) -> list[str]:
        """The columns' names."""
        return ["t", *(f"q{i}" for i in range(1, self.robot.n + 1)), *pose_columns("rpy")]

    def joints(self) -> Array:
        """The joint values (m, n) in the units."""
        factors = joint_factors(self.robot, self.units)
        q = np.asarray(self.path.q / factors + 0.0)
        # The ends are what was typed, without the dust of a change of units.
        for i in (0, -1):
            q[i] = in_units(self.path.q[i], factors)
        return q

    def rows(self) -> Array:
        """(m, 7 + n) the columns in the units."""
        poses = pose_table(poses_in(self.path.T.copy(), self.units), "rpy", self.units)
        return np.concatenate([self.path.t[:, None], self.joints(), poses], axis=1)

    def records(self) -> Iterator[dict[str, Any]]:
        """A record for each row."""
        n = self.robot.n
        for row in self.rows().tolist():
            yield {"t": row[0], "q": row[1 : n + 1], "position": row[n + 1 : n + 4], "rpy": row[n + 4 :]}

    def document(self) -> dict[str, Any]:
        """The whole path with its summary."""
        path, events = self.path, self.path.events
        return {
            **envelope("robot", self.robot.id, self.units),
            "kind": self.kind,
            "steps": path.steps,
            "complete": path.complete,
            "fraction": path.fraction,
            "length": path.length / self.units.metres,
            "greatest_moves": self.moves().tolist(),
            "least_manipulability": self.least(),
            "events": [self.event(event) for event in events],
            "path": list(self.records()),
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

    def least(self) -> float:
        """The least manipulability on the way, of the Jacobian in the length unit and radians."""
        from robokin.cli.jacobians import Jacobians
        from robokin.inverse.joint_paths import line_task
        from robokin.kinematics.velocity import differential_kinematics

        task: Any = "position" if self.kind == "line" and line_task(self.robot) == "position" else None
        i = int(np.argmin(self.path.manipulability))
        found = differential_kinematics(self.robot, self.path.q[i : i + 1], task=task)
        return float(Jacobians(self.robot, self.units, "base", task, True).volumes(found)[0])

    def notes(self) -> Iterator[str]:
        """Sentences on what happens on the way, and on where the path ends."""
        for event in self.path.events:
            record = self.event(event)
            value = ""
            if record["value"] is not None:
                assert event.joint is not None
                turns = self.robot.revolute[event.joint - 1]
                value = f" at {show(record['value'])} {self.units.angle if turns else self.units.length}"
            yield f"at {show(event.fraction)} of the path: {event.words}{value}"
        if not self.path.complete:
            rows = counted(len(self.path.t), "row")
            yield f"it can be followed up to {show(self.path.fraction)} of the path: {rows} of {self.path.steps + 1}"
        elif self.wanted is not None:
            gap = self.path.q[-1] - self.wanted
            if np.max(np.abs(gap)) > SAME:
                end = "  ".join(show(value) for value in self.joints()[-1])
                yield f"the line ends at that pose with another configuration: {end}"

    def page(self) -> Iterator[bytes]:
        """A summary, and some rows."""
        from robokin.cli.output.number_columns import NumberColumns
        from robokin.cli.output.tables import heading, pairs, render

        path = self.path
        what = "a straight line" if self.kind == "line" else "joint by joint"
        entries = [
            ("steps", f"{path.steps}"),
            ("length", f"{show(path.length / self.units.metres)} {self.units.length}"),
            ("joint moves", "  ".join(show(value) for value in self.moves())),
            ("least manipulability", f"{self.least():.9g}"),
        ]
        entries += [("note", sentence) for sentence in self.notes()]
        units = f"{what}, lengths in {self.units.length}, angles in {self.units.angle}"
        yield render(heading(self.robot.name, units), "", pairs(entries))
        if self.robot.n <= WIDEST:
            q = self.joints()
            picked = np.unique(np.linspace(0, len(q) - 1, min(SHOWN, len(q))).round().astype(int))
            names = [f"q{i}" for i in range(1, self.robot.n + 1)]
            kinds = "".join("a" if turns else "l" for turns in self.robot.revolute)
            columns = NumberColumns([("t", 6)], names, kinds, self.units)
            lines = columns.lines(((f"{path.t[i]:.4f}",) for i in picked.tolist()), q[picked])
            yield f"\n{columns.heading}{lines}".encode()
