"""Answers of `robokin jacobian`, a block at a time: from configurations to every format.

The Jacobian's twists are in the length unit and radians, and joint rates too: with angles in degrees a column per
degree would make every book's formula wrong by 57.3.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import IO, Any, Literal

import numpy as np

from robokin.arrays import Array
from robokin.cli.arguments import joint_factors
from robokin.cli.output.text import csv_header, csv_records, json_document, json_line, json_list, page
from robokin.errors import InputError
from robokin.kinematics.velocity import (
    Differential,
    TaskName,
    differential_kinematics,
    lost_directions,
    null_space_joints,
)
from robokin.model import Robot
from robokin.records.envelope import envelope
from robokin.tables.carried import Carried, nothing
from robokin.units import Units

ROWS = ("vx", "vy", "vz", "wx", "wy", "wz")
"""The Jacobian's rows: linear velocity, then angular."""


def _columns(n: int) -> list[str]:
    """The columns of the joint values and of the Jacobian."""
    gap = "_" if n > 9 else ""  # j111 would be two things
    return [f"q{i}" for i in range(1, n + 1)] + [f"j{i}{gap}{k}" for i in range(1, 7) for k in range(1, n + 1)]


def taken_by(kind: str, n: int) -> list[str]:
    """The names that an answer has itself, in CSV or in JSON."""
    if kind == "csv":
        values = [f"sigma{i}" for i in range(1, n + 1)]
        return [*_columns(n), "rank", *values, "manipulability", "condition"]
    return ["robot", "units", "jacobian_units", "q", "frame", "task", "jacobian", "rank", "full_rank", "size",
            "singular_values", "manipulability", "condition", "singular_direction", "null_space_joints"]  # fmt: skip


@dataclass
class Jacobians:
    """Configurations to bytes; `alone` tells that one was asked for, `carried` what goes through."""

    robot: Robot
    units: Units
    frame: Literal["base", "tool"]
    task: TaskName | None
    alone: bool
    carried: Carried = field(default_factory=nothing)

    def write(self, kind: str, blocks: Iterable[Array], stream: IO[bytes]) -> Iterator[bytes]:
        """The answers to blocks of configurations (m, n) in the units; arrays go to the stream themselves."""
        if kind == "npy":
            from robokin.cli.output.array_files import ArrayWriter

            writer = ArrayWriter(stream, (6, self.robot.n))
            for _, found in self.found(blocks):
                writer.write(self.matrices(found))
            writer.close()
            return iter(())
        return {"csv": self.csv, "jsonl": self.jsonl, "json": self.json, "table": self.table}[kind](blocks)

    def found(self, blocks: Iterable[Array]) -> Iterator[tuple[Array, Differential]]:
        """Each block with its answers. Raises InputError where a number is too large."""
        count = 0
        for q in blocks:
            si = q * joint_factors(self.robot, self.units)
            with np.errstate(over="ignore", invalid="ignore"):
                from robokin.kinematics.jacobian import jacobian

                finite = np.isfinite(jacobian(self.robot, si)).reshape(len(q), -1).all(axis=1)
            # Beyond this the squares in a singular value are too large for a number.
            finite &= np.all(np.abs(si) < 1e150, axis=1)
            if not finite.all():
                number = count + int(finite.argmin()) + 1
                raise InputError(f"configuration {number}: the pose is too far away for a number, expected less")
            count += len(q)
            yield q + 0.0, differential_kinematics(self.robot, si, self.frame, self.task)

    # Plain data -------------------------------------------------------------------------------------------

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
            yield self.carried.in_front_of(record)

    # Formats ----------------------------------------------------------------------------------------------

    def json(self, blocks: Iterable[Array]) -> Iterator[bytes]:
        """One document, or a list of them."""
        answers = (self.records(q, found) for q, found in self.found(blocks))
        if self.alone:
            yield from (json_document(record) for records in answers for record in records)
        else:
            yield from json_list(answers)

    def jsonl(self, blocks: Iterable[Array]) -> Iterator[bytes]:
        """A document a line."""
        for q, found in self.found(blocks):
            yield b"".join(map(json_line, self.records(q, found)))

    def csv(self, blocks: Iterable[Array]) -> Iterator[bytes]:
        """A row a configuration; an infinite condition number is an empty cell."""
        names = _columns(self.robot.n)
        header = b""
        for q, found in self.found(blocks):
            if not header:
                count = found.singular_values.shape[1]
                values = [f"sigma{i}" for i in range(1, count + 1)]
                header = csv_header([*names, "rank", *values, "manipulability", "condition"])
                yield self.carried.before(header, b"")
            numbers = np.concatenate([q, self.matrices(found).reshape(len(q), -1)], axis=1).tolist()
            ends = zip(found.rank.tolist(), found.singular_values.tolist(), self.volumes(found).tolist(), strict=True)
            conditions = ["" if np.isinf(value) else value for value in found.condition.tolist()]
            rows = [
                [*row, rank, *singular, volume, condition]
                for row, (rank, singular, volume), condition in zip(numbers, ends, conditions, strict=True)
            ]
            yield self.carried.before(b"", csv_records(None, rows))

    def table(self, blocks: Iterable[Array]) -> Iterator[bytes]:
        """A page, or a line for each configuration."""
        if self.alone:
            from robokin.cli.output.tables import render

            for q, found in self.found(blocks):
                (record,) = self.records(q, found)
                yield render(*self.page(record))
            return
        from robokin.cli.output.numbers import show

        yield page(f"{self.robot.name}  {self.heading()}\n\n")
        names = f"{'#':>6}  {'rank':>4}  {'least singular value':>20}  {'manipulability':>16}  {'condition':>12}\n"
        yield names.encode()
        number = 0
        for _, found in self.found(blocks):
            lines = []
            for rank, singular, volume, condition in zip(
                found.rank, found.singular_values, self.volumes(found), found.condition, strict=True
            ):
                number += 1
                shown = "-" if np.isinf(condition) else f"{condition:.4f}"
                lines.append(f"{number:>6}  {rank:>4}  {show(singular[-1]):>20}  {volume:>16.9g}  {shown:>12}\n")
            yield "".join(lines).encode()

    def heading(self) -> str:
        """The axes and the units."""
        return (
            f"twist in the {self.frame}'s axes, in {self.units.length} and rad, joints in {self.units.length} and rad"
        )

    def page(self, record: dict[str, Any]) -> list[Any]:
        """All that can be said at one configuration, for eyes."""
        from robokin.cli.output.numbers import show
        from robokin.cli.output.tables import heading, number_table, pairs

        def listed(values: list[float]) -> str:
            return "  ".join(show(value) for value in values)

        n = self.robot.n
        parts: list[Any] = [heading(self.robot.name, self.heading()), ""]
        for first in range(0, n, 6):  # six columns fit a page
            names = [f"q{k + 1}" for k in range(first, min(first + 6, n))]
            parts += [number_table(names, [row[first : first + 6] for row in record["jacobian"]], ROWS), ""]
        task = "" if record["task"] == "pose" else f" (of the {record['task']}'s rows)"
        size = f"lengths in the arm's size, {show(record['size'])} {self.units.length}"
        condition = record["condition"]
        entries = [
            ("q", listed(record["q"])),
            ("rank", f"{record['rank']} of {record['full_rank']}{task}"),
            ("singular values", f"{listed(record['singular_values'])}  ({size})"),
            ("manipulability", f"{record['manipulability']:.9g}"),
            ("condition", "infinite" if condition is None else show(condition)),
        ]
        entries += [("lost", one["words"]) for one in record["singular_direction"] or []]
        if record["null_space_joints"]:
            entries.append(("self-motion", f"joints {', '.join(map(str, record['null_space_joints']))}"))
        return [*parts, pairs(entries)]
