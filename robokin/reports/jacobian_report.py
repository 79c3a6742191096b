"""Answers of `robokin jacobian`, a block at a time: from configurations to every format."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import IO, Any

import numpy as np

from robokin.arrays import Array
from robokin.errors import InputError
from robokin.kinematics.jacobian import jacobian
from robokin.kinematics.velocity import Differential, differential_kinematics
from robokin.model.joint_units import joint_factors
from robokin.number_text import show
from robokin.records.envelope import envelope
from robokin.records.jacobian_records import JacobianRecords
from robokin.reports.answer_stream import AnswerStream
from robokin.tables.arrow_library import KINDS
from robokin.tables.carried import Carried, nothing
from robokin.tables.written_rows import csv_header, csv_records, page

ROWS = ("vx", "vy", "vz", "wx", "wy", "wz")
"""The Jacobian's rows: linear velocity, then angular."""


def joint_and_matrix_columns(n: int) -> list[str]:
    """The columns of the joint values and of the Jacobian."""
    gap = "_" if n > 9 else ""  # j111 would be two things
    return [f"q{i}" for i in range(1, n + 1)] + [f"j{i}{gap}{k}" for i in range(1, 7) for k in range(1, n + 1)]


def taken_by(kind: str, n: int) -> list[str]:
    """The names that an answer has itself, in CSV or in JSON."""
    if kind in ("csv", *KINDS):
        values = [f"sigma{i}" for i in range(1, n + 1)]
        torques = [f"tau{i}" for i in range(1, n + 1)]
        return [*joint_and_matrix_columns(n), "rank", *values, "manipulability", "condition", *torques]
    return ["schema", "robot", "id", "units", "jacobian_units", "q", "frame", "task", "jacobian", "rank", "full_rank",
            "size", "singular_values", "manipulability", "condition", "singular_direction",
            "null_space_joints", "force", "torques"]  # fmt: skip


@dataclass
class JacobianReport(AnswerStream):
    """Blocks of configurations (m, n) in the units as bytes.

    `alone` tells that one was asked for, `carried` what goes through.
    """

    records: JacobianRecords
    alone: bool
    carried: Carried = field(default_factory=nothing)

    @property
    def about(self) -> dict[str, Any]:
        """What a file says of the answers beside its columns."""
        return envelope("robot", self.records.robot.id, self.records.units)

    def found(self, blocks: Iterable[Array]) -> Iterator[tuple[Array, Differential]]:
        """Each block with its answers. Raises InputError where a number is too large."""
        count = 0
        for q in blocks:
            si = q * joint_factors(self.records.robot, self.records.units)
            with np.errstate(over="ignore", invalid="ignore"):
                finite = np.isfinite(jacobian(self.records.robot, si)).reshape(len(q), -1).all(axis=1)
            # Beyond this the squares in a singular value are too large for a number.
            finite &= np.all(np.abs(si) < 1e150, axis=1)
            if not finite.all():
                number = count + int(finite.argmin()) + 1
                raise InputError(f"configuration {number}: the pose is too far away for a number, expected less")
            count += len(q)
            yield q + 0.0, differential_kinematics(self.records.robot, si, self.records.frame, self.records.task)

    def documents(self, blocks: Iterable[Array]) -> Iterator[Iterable[dict[str, Any]]]:
        """The documents of each block."""
        for q, found in self.found(blocks):
            yield map(self.carried.in_front_of, self.records.records(q, found))

    def npy(self, blocks: Iterable[Array], stream: IO[bytes]) -> None:
        """The Jacobians (m, 6, n)."""
        from robokin.tables.array_writer import ArrayWriter

        writer = ArrayWriter(stream, (6, self.records.robot.n))
        for _, found in self.found(blocks):
            writer.write(self.records.matrices(found))
        writer.close()

    def csv(self, blocks: Iterable[Array]) -> Iterator[bytes]:
        """A row a configuration; an infinite condition number is an empty cell."""
        names = joint_and_matrix_columns(self.records.robot.n)
        header = b""
        for q, found in self.found(blocks):
            if not header:
                count = found.singular_values.shape[1]
                values = [f"sigma{i}" for i in range(1, count + 1)]
                more = [f"tau{i}" for i in range(1, self.records.robot.n + 1)] if self.records.force else []
                header = csv_header([*names, "rank", *values, "manipulability", "condition", *more])
                yield self.carried.before(header, b"")
            numbers = np.concatenate([q, self.records.matrices(found).reshape(len(q), -1)], axis=1).tolist()
            ends = zip(
                found.rank.tolist(), found.singular_values.tolist(), self.records.volumes(found).tolist(), strict=True
            )
            conditions = ["" if np.isinf(value) else value for value in found.condition.tolist()]
            held = self.records.torques(found).tolist() if self.records.force else [[] for _ in numbers]
            rows = [
                [*row, rank, *singular, volume, condition, *torques]
                for row, (rank, singular, volume), condition, torques in zip(
                    numbers, ends, conditions, held, strict=True
                )
            ]
            yield self.carried.before(b"", csv_records(None, rows))

    def table(self, blocks: Iterable[Array]) -> Iterator[bytes]:
        """A page, or a line for each configuration."""
        if self.alone:
            from robokin.reports.page_tables import render

            for documents in self.documents(blocks):
                for record in documents:
                    yield render(*self.page(record))
            return
        yield page(f"{self.records.robot.name}  {self.heading()}\n\n")
        names = f"{'#':>6}  {'rank':>4}  {'least singular value':>20}  {'manipulability':>16}  {'condition':>12}\n"
        yield names.encode()
        number = 0
        for _, found in self.found(blocks):
            lines = []
            for rank, singular, volume, condition in zip(
                found.rank, found.singular_values, self.records.volumes(found), found.condition, strict=True
            ):
                number += 1
                shown = "-" if np.isinf(condition) else f"{condition:.4f}"
                lines.append(f"{number:>6}  {rank:>4}  {show(singular[-1]):>20}  {volume:>16.9g}  {shown:>12}\n")
            yield "".join(lines).encode()

    def heading(self) -> str:
        """The axes and the units."""
        unit = self.records.units.length
        return f"twist in the {self.records.frame}'s axes, in {unit} and rad, joints in {unit} and rad"

    def page(self, record: dict[str, Any]) -> list[Any]:
        """All that can be said at one configuration, for eyes."""
        from robokin.reports.page_tables import heading, number_table, pairs

        def listed(values: list[float]) -> str:
            return "  ".join(show(value) for value in values)

        n = self.records.robot.n
        parts: list[Any] = [heading(self.records.robot.name, self.heading()), ""]
        for first in range(0, n, 6):  # six columns fit a page
            names = [f"q{k + 1}" for k in range(first, min(first + 6, n))]
            parts += [number_table(names, [row[first : first + 6] for row in record["jacobian"]], ROWS), ""]
        task = "" if record["task"] == "pose" else f" (of the {record['task']}'s rows)"
        size = f"lengths in the arm's size, {show(record['size'])} {self.records.units.length}"
        condition = record["condition"]
        entries = [
            ("q", listed(record["q"])),
            ("rank", f"{record['rank']} of {record['full_rank']}{task}"),
            ("singular values", f"{listed(record['singular_values'])}  ({size})"),
            ("manipulability", f"{record['manipulability']:.9g}"),
            ("condition", "infinite" if condition is None else show(condition)),
        ]
        if "torques" in record:
            slides = "" if self.records.robot.revolute.all() else ", of slides N"
            entries.append(("torques", f"{listed(record['torques'])}  (N m{slides}, for the force at the tool)"))
        entries += [("lost", one["words"]) for one in record["singular_direction"] or []]
        if record["null_space_joints"]:
            entries.append(("self-motion", f"joints {', '.join(map(str, record['null_space_joints']))}"))
        return [*parts, pairs(entries)]
