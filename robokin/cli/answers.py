"""Answers of `robokin ik`, a block at a time: from poses to every format."""

from __future__ import annotations

import tempfile
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import IO, TYPE_CHECKING, Any

import numpy as np

from robokin.arrays import Array
from robokin.cli.answer_families import FamilyWords
from robokin.cli.arguments import joint_factors
from robokin.cli.output.text import csv_header, csv_records, json_document, json_line, json_list
from robokin.cli.records import poses_in
from robokin.inverse.full_turns import turns_of_limits
from robokin.inverse.solutions import BatchResult, Result, Solution
from robokin.inverse.solve import solve_many
from robokin.inverse.verify import CLOSES
from robokin.model import Robot
from robokin.records.envelope import envelope
from robokin.tables.carried import Carried, nothing
from robokin.units import Units

if TYPE_CHECKING:
    from robokin.cli.explanations import Explanation


TURNED_ROWS = 10_000
"""Full turns of so many postures are held at a time: with eight postures a target some 50 MB of rows."""

NEAREST = "solved for the nearest pose, within the tolerances"
"""Why a list of solutions that miss the target by no more than the tolerances is not said to be complete."""


RECORD_KEYS = (
    "schema", "robot", "units", "target", "hold", "reachable", "complete", "basis", "certificate", "counts", "families",
    "method", "reason", "solutions", "nearest", "explanation",
)  # fmt: skip
"""What a JSON document says itself; an `id` of the input takes the place of its own, which `robot` says too."""


def csv_columns(robot: Robot) -> list[str]:
    """The columns of a CSV."""
    names = [f"q{i}" for i in range(1, robot.n + 1)]
    return ["target", "solution", *names, "branch", "within_limits", "position_error", "angle_error", "reason"]


@dataclass
class Answers:
    """Answers to bytes, and how many targets had none.

    `tolerances` [m, rad]: within them the nearest pose will do; None asks for exact ones. `arguments` go to
    the solver; `alone` tells that one target was asked for, by an option; `explain` that its lesson is wanted;
    `held` are the joints, from 0, that are held, with their values in the units.
    """

    robot: Robot
    units: Units
    tolerances: tuple[float | None, float | None]
    arguments: dict[str, Any]
    alone: bool
    explain: bool = False
    held: Mapping[int, float] = field(default_factory=dict)
    carried: Carried = field(default_factory=nothing)
    count: int = 0
    unreached: int = 0

    @property
    def task(self) -> str:
        """What is asked of the tool: pose, approach or position."""
        return str(self.arguments.get("task", "pose"))

    def write(self, kind: str, blocks: Iterable[Array], stream: IO[bytes]) -> Iterator[bytes]:
        """The answers to blocks of poses (m, 4, 4) [m] in a format; arrays go to the stream themselves."""
        if kind == "npy":
            self.npy(blocks, stream)
            return iter(())
        return {"csv": self.csv, "jsonl": self.jsonl, "json": self.json, "table": self.table}[kind](blocks)

    # The answers ------------------------------------------------------------------------------------------

    def batches(self, blocks: Iterable[Array]) -> Iterator[tuple[Array, BatchResult]]:
        """Each block (m, 4, 4) [m] with its answers."""
        step = TURNED_ROWS // turns_of_limits(self.robot) + 1 if self.arguments.get("turns") else None
        for block in blocks:
            for start in range(0, len(block), step or max(len(block), 1)):
                T = block[start : start + step] if step else block
                yield T, solve_many(self.robot, T, motions=self.alone, **self.arguments)

    def results(self, blocks: Iterable[Array]) -> Iterator[tuple[Array, Result]]:
        """Each target (4, 4) [m] with its answer."""
        for T, batch in self.batches(blocks):
            for target, result in zip(T, batch, strict=True):
                result = self.accepted(target, result)
                self.count += 1
                self.unreached += not result.reachable
                yield target, result

    def accepted(self, target: Array, result: Result) -> Result:
        """The result, or where it has no solution those of the nearest pose, if the tolerances allow it."""
        nearest, (position, angle) = result.nearest, self.tolerances
        if nearest is None or (position is None and angle is None):
            return result
        if nearest.position_error > max(position or 0.0, CLOSES) or nearest.angle_error > max(angle or 0.0, CLOSES):
            return result
        from robokin.inverse.verify import residuals
        from robokin.kinematics.forward import forward_kinematics

        # The nearest pose has other solutions than the one that was found first.
        T = forward_kinematics(self.robot, nearest.q)
        found = solve_many(self.robot, T[None], **{**self.arguments, "task": "pose"})[0].solutions
        solutions = [nearest] if nearest.within_limits or not self.arguments["limits"] else []
        if found and self.task == "pose":
            errors = residuals(np.array([target] * len(found)), np.array([T] * len(found)))
            solutions = [
                replace(solution, position_error=float(off), angle_error=float(turn))
                for solution, off, turn in zip(found, *errors, strict=True)
            ]
        if not solutions:
            return result
        return replace(
            result, solutions=tuple(solutions), complete=False, basis=None, certificate=NEAREST, families=(),
            reason=None, nearest=None, postures=False, counts={"listed": len(solutions)},
        )  # fmt: skip

    # Plain data -------------------------------------------------------------------------------------------

    @property
    def families(self) -> FamilyWords:
        """Writes self-motions."""
        return FamilyWords(self.robot, self.units, bool(self.arguments.get("limits", True)))

    def record(self, target: Array, result: Result) -> dict[str, Any]:
        """The JSON document of an answer."""
        record: dict[str, Any] = {
            **envelope("robot", self.robot.id, self.units),
            "target": {"matrix": poses_in(target.copy(), self.units).tolist(), "task": self.task},
        }
        if self.held:
            record["hold"] = {f"q{joint + 1}": value for joint, value in sorted(self.held.items())}
        record |= {
            "reachable": result.reachable,
            "complete": result.complete,
            "basis": result.basis,
            "certificate": result.certificate,
            "counts": dict(result.counts),
            "families": [self.families.record(family, result) for family in result.families],
            "method": result.method,
            "reason": result.reason,
            "solutions": [self.solution(solution) for solution in result.solutions],
            "nearest": None if result.nearest is None else self.solution(result.nearest),
        }
        if self.explain:
            record["explanation"] = self.explanation(target, result).record()
        return self.carried.in_front_of(record)

    def explanation(self, target: Array, result: Result) -> Explanation:
        """The lesson behind an answer."""
        from robokin.cli.explanations import Explanation
        from robokin.derivation.explain import explain_ik

        asked = {name: self.arguments[name] for name in ("task", "limits", "near") if name in self.arguments}
        return Explanation(self.robot, self.units, explain_ik(self.robot, target, **asked), result)

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
        """Joint values (..., n) in the units; of held joints the digits that were asked for."""
        values = q / joint_factors(self.robot, self.units) + 0.0
        for joint, value in self.held.items():
            values[..., joint] = np.where(np.isnan(values[..., joint]), np.nan, value)
        return values.tolist()

    # Formats ----------------------------------------------------------------------------------------------

    def json(self, blocks: Iterable[Array]) -> Iterator[bytes]:
        """One document, or a list of them."""
        records = (self.record(target, result) for target, result in self.results(blocks))
        if self.alone:
            yield json_document(next(records))
        else:
            yield from json_list([record] for record in records)

    def jsonl(self, blocks: Iterable[Array]) -> Iterator[bytes]:
        """A document a line."""
        for target, result in self.results(blocks):
            yield json_line(self.record(target, result))

    def csv(self, blocks: Iterable[Array]) -> Iterator[bytes]:
        """A row a solution. Works on arrays: most of the time of a batch would else go into objects."""
        header = csv_header(csv_columns(self.robot))
        for T, batch in self.batches(blocks):
            listed = np.arange(batch.q.shape[1]) < batch.count[:, None]
            solutions = zip(
                self.joints(batch.q[listed]),
                batch.branches(),
                batch.within_limits[listed].tolist(),
                (batch.position_error[listed] / self.units.metres).tolist(),
                (batch.angle_error[listed] / self.units.radians).tolist(),
                strict=True,
            )
            rows: list[list[Any]] = []
            through: list[list[str]] = []
            for i, count in enumerate(batch.count.tolist()):
                self.count += 1
                for k in range(1, count + 1):
                    q, branch, *rest = next(solutions)
                    rows.append([self.count, k, *q, _one_cell(branch), *rest, ""])
                if not count:
                    rows += self.exceptional(T[i], batch, i)
                through += [self.carried.cells()] * (len(rows) - len(through))
            yield self.carried.before(header, csv_records(None, rows), through)
            header = b""
        yield self.carried.before(header, b"")

    def exceptional(self, target: Array, batch: BatchResult, i: int) -> Iterator[list[Any]]:
        """The rows of a target without an exact solution."""
        reason = None
        if self.tolerances == (None, None):
            reason = batch.reason(i)
        else:
            result = self.accepted(target, batch[i])
            reason = result.reason
            for k, solution in enumerate(result.solutions, start=1):
                q, branch, inside, position, angle, *_ = self.solution(solution).values()
                yield [self.count, k, *q, _one_cell(branch), inside, position, angle, ""]
        if reason is not None:
            self.unreached += 1
            yield [self.count, 0, *[""] * (self.robot.n + 4), reason]

    def npy(self, blocks: Iterable[Array], stream: IO[bytes]) -> None:
        """The solutions (m, k, n) in the units, padded with NaN; k is the greatest number of solutions.

        How many columns the array has is known at the end only: a temporary file holds the solutions until then.
        """
        from robokin.cli.output.array_files import ArrayWriter

        with tempfile.TemporaryFile() as kept:
            shapes: list[tuple[int, int]] = []
            for block in blocks:
                q = [np.array(self.joints(_listed(result, self.robot.n))) for _, result in self.results([block])]
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
        from robokin.cli.answer_tables import AnswerTable

        limits, turns = bool(self.arguments.get("limits", True)), bool(self.arguments.get("turns", False))
        most = self.arguments.get("most")
        drawn = AnswerTable(self.robot, self.units, self.task, limits, turns, most, self.held)
        shown = self.joints
        head = drawn.head()
        for target, result in self.results(blocks):
            label = "" if self.alone else f"target {self.count}: "
            yield head + drawn.paragraph(label, result, [shown(solution.q) for solution in drawn.solutions(result)])
            head = b""
            if self.explain:
                yield self.explanation(target, result).page()
        yield head


def _one_cell(branch: str) -> str:
    """A branch without commas, so that whoever splits a line at its commas finds the columns."""
    return branch.replace(", ", " / ")


def _listed(result: Result, n: int) -> Array:
    return np.array([solution.q for solution in result.solutions]).reshape(-1, n)
