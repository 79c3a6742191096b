"""Solutions of many targets by their columns, a row a solution: as lines of a CSV, or as columns with a type."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain, repeat
from typing import Any

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.inverse.solutions import Solution
from robokin.records.solution_records import SolutionRecords
from robokin.tables.carried import Carried
from robokin.tables.written_rows import BOOLEANS, csv_cell, encode, number_lines


@dataclass(frozen=True)
class SolutionRows:
    """The rows of a block of targets, target after target.

    target: (r,) numbers of the targets, from `first` on; solution: (r,) numbers of their solutions, 0 in the row that
    says why there is none, whose other columns are empty. q: (r, n) and errors: (r, 2) in the units; branch, reason:
    texts; inside: whether within the limits. `jump`: what stands in a last column, None for no such column.
    """

    first: int
    target: Index
    solution: Index
    q: Array
    branch: Sequence[str]
    inside: Flags
    errors: Array
    reason: Sequence[str]
    jump: bool | None = None

    @classmethod
    def merged(cls, solved: SolutionRows, others: Iterable[SolutionRows]) -> SolutionRows:
        """Rows with those of other targets between them."""
        parts = [solved, *others]
        if len(parts) == 1:
            return solved
        order = np.argsort(np.concatenate([part.target for part in parts]), kind="stable")
        rows = order.tolist()

        def joined(name: str) -> Any:
            return np.concatenate([getattr(part, name) for part in parts])[order]

        def texts(name: str) -> list[str]:
            known = list(chain.from_iterable(getattr(part, name) for part in parts))
            return [known[row] for row in rows]

        return cls(
            solved.first, joined("target"), joined("solution"), joined("q"), texts("branch"), joined("inside"),
            joined("errors"), texts("reason"), solved.jump,
        )  # fmt: skip

    @classmethod
    def of(cls, target: int, solutions: Sequence[Solution], records: SolutionRecords) -> SolutionRows:
        """The rows of the solutions of one target, which has a number."""
        count = len(solutions)
        errors = np.array([(solution.position_error, solution.angle_error) for solution in solutions])
        return cls(
            target, np.full(count, target), np.arange(1, count + 1),
            records.values(np.array([solution.q for solution in solutions])),
            [solution.branch for solution in solutions], np.array([solution.within_limits for solution in solutions]),
            errors / (records.units.metres, records.units.radians), [""] * count,
        )  # fmt: skip

    @classmethod
    def without(cls, target: int, n: int, reason: str) -> SolutionRows:
        """The row of a target that has no solution, of an arm of n joints."""
        nothing = np.zeros((1, n)), np.zeros((1, 2))
        return cls(
            target, np.array([target]), np.zeros(1, dtype=int), nothing[0], [""], np.zeros(1, dtype=bool), nothing[1],
            [reason],
        )  # fmt: skip

    def text(self, carried: Carried, count: int) -> bytes:
        """Lines of a CSV, each behind the cells that go through, which are those of the next `count` targets."""
        branches = {branch: csv_cell(one_cell(branch)) for branch in {*self.branch}}
        ends = {reason: csv_cell(reason) for reason in {*self.reason}}
        behind = "\n" if self.jump is None else f",{BOOLEANS[self.jump]}\n"
        columns: Iterator[tuple[int, int, str, str, bool, str, str]] = zip(
            self.target.tolist(), self.solution.tolist(), number_lines(self.q), self.branch, self.inside.tolist(),
            number_lines(self.errors), self.reason, strict=True,
        )  # fmt: skip
        lines = [
            f"{target},{k},{q},{branches[branch]},{'true' if inside else 'false'},{errors},{ends[reason]}{behind}"
            if k
            else f"{target},0{',' * (self.q.shape[1] + 4)},{ends[reason]}{behind}"
            for target, k, q, branch, inside, errors, reason in columns
        ]
        if carried.names:
            fronts = carried.fronts(count)
            lines = [f"{fronts[i]}{line}" for i, line in zip((self.target - self.first).tolist(), lines, strict=True)]
        return encode("".join(lines))

    def columns(self, carried: Carried, count: int) -> list[Any]:
        """The columns of the CSV for an `ArrowWriter`, those that go through in front: empty cells are nothing."""
        times = np.bincount(self.target - self.first, minlength=count).tolist()
        through = [list(chain.from_iterable(map(repeat, column, times))) for column in carried.columns(count)]
        bare = self.solution == 0
        kept = (lambda column: np.ma.array(column, mask=bare)) if bare.any() else np.ascontiguousarray
        cells = {branch: one_cell(branch) for branch in {*self.branch}}
        columns = [
            *through,
            self.target,
            self.solution,
            *map(kept, self.q.T),
            [cells[branch] for branch in self.branch],
            kept(self.inside),
            *map(kept, self.errors.T),
            self.reason,
        ]
        return columns if self.jump is None else [*columns, [self.jump] * len(self.target)]


def one_cell(branch: str) -> str:
    """A branch without commas, so that whoever splits a line at its commas finds the columns."""
    return branch.replace(", ", " / ")
