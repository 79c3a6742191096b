"""Answers of `robokin ik`, a block at a time: from poses to every format."""

from __future__ import annotations

import tempfile
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from typing import IO, TYPE_CHECKING, Any

import numpy as np

from robokin.arrays import Array
from robokin.inverse.full_turns import turns_of_limits
from robokin.inverse.solutions import BatchResult, Result
from robokin.inverse.solve import solve_many
from robokin.inverse.within_tolerance import within_tolerance
from robokin.model import Robot
from robokin.records.envelope import envelope
from robokin.records.solution_records import SolutionRecords
from robokin.reports.answer_stream import SharedStream
from robokin.reports.solution_rows import SolutionRows
from robokin.tables.carried import Carried, nothing
from robokin.tables.written_rows import csv_header
from robokin.units import Units

if TYPE_CHECKING:
    from robokin.inverse.answers_in_turn import Following
    from robokin.records.worked_step_records import Explanation


TURNED_ROWS = 10_000
"""Full turns of so many postures are held at a time: with eight postures a target some 50 MB of rows."""


def csv_columns(robot: Robot, following: bool = False) -> list[str]:
    """The columns of a CSV; following: of answers that each follow the one before."""
    names = [f"q{i}" for i in range(1, robot.n + 1)]
    columns = ["target", "solution", *names, "branch", "within_limits", "position_error", "angle_error", "reason"]
    return [*columns, "jump"] if following else columns


@dataclass
class SolutionReport(SharedStream):
    """Answers to blocks of poses (m, 4, 4) [m] as bytes, and how many targets had none.

    `tolerances` [m, rad]: within them the nearest pose will do; None asks for exact ones. `arguments` go to
    the solver; `alone` tells that one target was asked for, by an option; `explain` that worked steps are wanted.
    """

    records: SolutionRecords
    tolerances: tuple[float | None, float | None]
    arguments: dict[str, Any]
    alone: bool
    explain: bool = False
    carried: Carried = field(default_factory=nothing)
    count: int = 0
    unreached: int = 0
    begun: bool = False
    """Whether what stands above all answers is written."""
    cores: int | None = 1
    following: Following | None = None
    """Where each target is answered by the solution nearest to the answer before it: what that was."""

    @property
    def robot(self) -> Robot:
        """The robot that is asked about."""
        return self.records.robot

    @property
    def units(self) -> Units:
        """The units of what comes out."""
        return self.records.units

    @property
    def about(self) -> dict[str, Any]:
        """What a file says of the answers beside its columns."""
        return envelope("robot", self.robot.id, self.records.units)

    def from_number(self, first: int, carried: Carried) -> SolutionReport:
        """The same for the targets behind the first ones."""
        return replace(self, carried=carried, count=first, unreached=0, begun=first > 0, cores=1)

    def alone_from(self, first: int, carried: Carried) -> SolutionReport:
        """The same, with what stands above all answers."""
        return replace(self.from_number(first, carried), begun=False)

    def bare(self) -> SolutionReport:
        """The same without what is carried."""
        return replace(self, carried=nothing())

    @property
    def found(self) -> int:
        """How many targets had no solution."""
        return self.unreached

    def add(self, rows: int, found: int) -> None:
        """Count targets that were answered elsewhere, and those among them without a solution."""
        self.count, self.unreached = self.count + rows, self.unreached + found

    # The answers ------------------------------------------------------------------------------------------

    def batches(self, blocks: Iterable[Array], motions: bool = False) -> Iterator[tuple[Array, BatchResult]]:
        """Each block (m, 4, 4) [m] with its answers; motions: whether with their self-motions, as for one target."""
        if self.following is not None:
            yield from self.following.batches(self.robot, blocks, self.arguments)
            return
        step = TURNED_ROWS // turns_of_limits(self.robot) + 1 if self.arguments.get("turns") else None
        for block in blocks:
            for start in range(0, len(block), step or max(len(block), 1)):
                T = block[start : start + step] if step else block
                yield T, solve_many(self.robot, T, motions=self.alone or motions, **self.arguments)

    def results(self, blocks: Iterable[Array], motions: bool = False) -> Iterator[tuple[Array, Result]]:
        """Each target (4, 4) [m] with its answer; motions: as for `batches`."""
        for T, batch in self.batches(blocks, motions):
            for target, result in zip(T, batch, strict=True):
                result = self.accepted(target, result)
                self.count += 1
                self.unreached += not result.reachable
                yield target, result

    def accepted(self, target: Array, result: Result) -> Result:
        """The result, or that of the nearest pose where the tolerances allow it."""
        return within_tolerance(self.robot, target, result, *self.tolerances, **self.arguments)

    def documents(self, blocks: Iterable[Array]) -> Iterator[Iterable[dict[str, Any]]]:
        """The document of each answer, as it comes."""
        for target, result in self.results(blocks, motions=True):
            record = self.records.record(target, result)
            if self.following is not None:
                record["jump"] = self.following.jumped
            if self.explain:
                record["explanation"] = self.explanation(target, result).record()
            yield [self.carried.in_front_of(record)]

    def explanation(self, target: Array, result: Result) -> Explanation:
        """The worked steps behind an answer."""
        from robokin.records.worked_step_records import explanation_of

        return explanation_of(self.records.robot, self.records.units, target, result, **self.arguments)

    # Formats ----------------------------------------------------------------------------------------------

    def csv(self, blocks: Iterable[Array]) -> Iterator[bytes]:
        """A row a solution. Works on arrays: most of the time of a batch would else go into objects."""
        header = b"" if self.begun else csv_header(csv_columns(self.robot, self.following is not None))
        for count, rows in self.rows(blocks):
            yield self.carried.before(header, b"") + rows.text(self.carried, count)
            header = b""
        yield self.carried.before(header, b"")

    def arrow(self, kind: str, blocks: Iterable[Array], stream: IO[bytes]) -> int:
        """The columns of the CSV; the number of rows. Text in between would take several times as long."""
        from robokin.tables.arrow_writer import ArrowWriter, columns_of

        def begun() -> ArrowWriter:
            """A writer; what goes through is known when the first block is."""
            columns = [*self.carried.names, *csv_columns(self.robot, self.following is not None)]
            return ArrowWriter(stream, kind, columns_of(columns, self.carried), self.about)

        writer = None
        for count, rows in self.rows(blocks):
            writer = writer or begun()
            writer.columns(rows.columns(self.carried, count))
        return (writer or begun()).close()

    def rows(self, blocks: Iterable[Array]) -> Iterator[tuple[int, SolutionRows]]:
        """How many targets a block has, and the rows of their solutions."""
        units = self.records.units
        for T, batch in self.batches(blocks):
            first = self.count + 1
            listed = np.arange(batch.q.shape[1]) < batch.count[:, None]
            target, k = np.nonzero(listed)
            errors = np.stack([batch.position_error[listed], batch.angle_error[listed]], axis=1)
            solved = SolutionRows(
                first, target + first, k + 1, self.records.values(batch.q[listed]), batch.branches(),
                batch.within_limits[listed], errors / (units.metres, units.radians), [""] * len(k),
                None if self.following is None else self.following.jumped,
            )  # fmt: skip
            unsolved = np.flatnonzero(batch.count == 0).tolist()
            others = [row for i in unsolved for row in self.exceptional(T[i], batch, i, first + i)]
            self.count += len(T)
            yield len(T), SolutionRows.merged(solved, others)

    def exceptional(self, target: Array, batch: BatchResult, i: int, number: int) -> Iterator[SolutionRows]:
        """The rows of target i, which has a number, without an exact solution."""
        if self.tolerances == (None, None):
            reason = batch.reason(i)
        else:
            result = self.accepted(target, batch[i])
            reason = result.reason
            if result.solutions:
                yield SolutionRows.of(number, result.solutions, self.records)
        if reason is not None:
            self.unreached += 1
            yield SolutionRows.without(number, self.robot.n, reason)

    def npy(self, blocks: Iterable[Array], stream: IO[bytes]) -> None:
        """The solutions (m, k, n) in the units, padded with NaN; k is the greatest number of solutions.

        How many columns the array has is known at the end only: a temporary file holds the solutions until then.
        """
        from robokin.tables.array_writer import ArrayWriter

        with tempfile.TemporaryFile() as kept:
            shapes: list[tuple[int, int]] = []
            for block in blocks:
                results = [result for _, result in self.results([block])]
                q = [np.array(self.records.joints(_listed(result, self.robot.n))) for result in results]
                most = max(map(len, q), default=0)
                padded = np.full((len(q), most, self.robot.n), np.nan)
                for row, values in zip(padded, q, strict=True):
                    row[: len(values)] = values.reshape(-1, self.robot.n)
                kept.write(padded.tobytes())
                shapes.append((len(q), most))
            kept.seek(0)
            most = max((count for _, count in shapes), default=0)
            writer = ArrayWriter(stream, (most, self.robot.n))
            for rows, count in shapes:
                whole = np.full((rows, most, self.robot.n), np.nan)
                size = rows * count * self.robot.n
                whole[:, :count] = np.frombuffer(kept.read(8 * size)).reshape(rows, count, self.robot.n)
                writer.write(whole)
            writer.close()

    def table(self, blocks: Iterable[Array]) -> Iterator[bytes]:
        """A page, or a heading and a paragraph for each target."""
        from robokin.reports.solution_tables import AnswerTable

        limits, turns = bool(self.arguments.get("limits", True)), bool(self.arguments.get("turns", False))
        drawn = AnswerTable(self.records, limits, turns, self.arguments.get("most"))
        head = b"" if self.begun else drawn.head()
        for target, result in self.results(blocks):
            jump = " (a jump)" if self.following is not None and self.following.jumped else ""
            yield head + drawn.paragraph("" if self.alone else f"target {self.count}{jump}: ", result)
            head = b""
            if self.explain:
                from robokin.reports.worked_step_pages import WorkedStepPage

                yield WorkedStepPage(self.explanation(target, result)).page()
        yield head


def _listed(result: Result, n: int) -> Array:
    return np.array([solution.q for solution in result.solutions]).reshape(-1, n)
