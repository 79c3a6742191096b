"""The answer for one target as a table, and the `Result` that is made of it when it is looked at.

Statement. Keep what was found for a pose until something of it is asked for: of the answers in a loop over poses most
are looked at in part, or not at all.
Derivation. One row a solution; the list is cut to the limits, ordered by a wish, and cut to a number.
Degenerate case. None.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np

from robokin.arrays import Array
from robokin.inverse.claims import BASES, COUNTED, counted_sentence
from robokin.inverse.later_fields import with_later_nearest, with_later_proof
from robokin.inverse.one_target_arm import OneTargetArm
from robokin.inverse.single_answer import FAR
from robokin.inverse.solution_names import branch_names
from robokin.inverse.solutions import Question, Result, Solution, named_later, regular_result
from robokin.inverse.target_block import OUTSIDE
from robokin.model import Robot
from robokin.spatial.angles import TURN

INSIDE, TURNS = 2, 3
"""Of the columns of a table after the joint values."""


@dataclass(eq=False, slots=True)
class OneAnswer:
    """The solutions for one target T (4, 4) [m].

    tried: how many candidates there were; table: (k, 10) a row for each that was found: joint values, turned into the
    limits where that can be [rad], what it lacks of the target [m, rad], whether it is within the limits, and how many
    configurations within them it is equivalent to, a column that may be left out; limits, most, wish: what was asked.
    Where the table has no row there is proof that there is no solution.
    """

    arm: OneTargetArm
    T: Array
    tried: int
    table: Array
    limits: bool
    most: int | None
    wish: Array | None

    def result(self, question: Question) -> Result:
        """The answer for a question."""
        table, most = self.table, self.most
        values: list[list[float]] = table[:, 6:].tolist()
        rows = [k for k, row in enumerate(values) if row[INSIDE] or not self.limits]
        if self.wish is not None:
            wish = self.wish.tolist()
            moves = [max([abs(a - b) for a, b in zip(q, wish, strict=True)]) for q in table[:, :6].tolist()]
            rows.sort(key=moves.__getitem__)
        within = len(rows)
        if most is not None:
            rows = rows[:most]
        everything = table[:, :6]
        copied = everything.copy()
        q = [copied[row] for row in rows]
        find = _Names(self.arm.robot, everything, rows).name
        kept = [values[row] for row in rows]
        inside, errors = [row[INSIDE] != 0.0 for row in kept], [(row[0], row[1]) for row in kept]
        solutions = named_later(find, q, inside, errors, [()] * len(rows))
        count, analysis = len(values), self.arm.analysis
        complete = len(rows) == within
        counts = {"found": self.tried, "duplicates": 0, "closing": count}
        if self.limits:
            counts["within_limits"] = within
        counts["listed"] = len(rows)
        if self.limits:
            told = table.shape[1] > 6 + TURNS
            turns = [row[TURNS] for row in kept] if told else map(self._equivalents, rows)
            counts["turns"] = int(sum(turns))
        return regular_result(
            solutions=solutions, complete=complete, method=analysis.method, counts=counts, postures=complete,
            basis=BASES[COUNTED] if complete else None,
            certificate=counted_sentence(analysis.number, count, self.arm.form is not None), all_known=True,
            question=question, families_complete=True,
        )  # fmt: skip

    @property
    def reached(self) -> bool:
        """Whether there is a solution to list."""
        return bool(self.table[:, 6 + INSIDE].any() if self.limits else len(self.table))

    def unreached(self, question: Question, ask: Callable[[], Result]) -> Result:
        """The answer for a question where there is nothing to list; `ask` gives the same with what is slow to find."""
        arm, count = self.arm, len(self.table)
        counts = {"found": self.tried, "duplicates": 0, "closing": count}
        counts |= {"within_limits": 0, "listed": 0, "turns": 0} if self.limits else {"listed": 0}
        certificate = counted_sentence(arm.analysis.number, count, arm.form is not None)
        told = regular_result(
            solutions=(), complete=True, method=arm.analysis.method, counts=counts, postures=True,
            basis=BASES[COUNTED], certificate=certificate, all_known=True, question=question, families_complete=True,
        )  # fmt: skip
        asked = cache(ask)

        def why() -> tuple[str, Solution]:
            whole = asked()
            assert whole.reason is not None and whole.nearest is not None
            return whole.reason, whole.nearest

        def proof() -> tuple[str, str]:
            whole = asked()
            # All roots are followed and complex, whatever else may have failed to prove it.
            return (whole.basis or "counted", whole.certificate) if whole.complete else ("counted", certificate)

        if count or arm.beyond(self.T):
            return with_later_nearest(told, OUTSIDE if count else FAR, why)
        return with_later_nearest(with_later_proof(told, proof), None, why)

    def _equivalents(self, row: int) -> int:
        """How many configurations within the limits a row's joint values are equivalent to, itself included."""
        values: list[float] = self.table[row].tolist()
        count = 1
        for joint, low, high in self.arm.turning:
            least = min(math.ceil((low - values[joint]) / TURN), 0)
            count *= max(math.floor((high - values[joint]) / TURN), 0) - least + 1
        return count


class _Names:
    """The names of some solutions, `rows` of all q (m, 6), which are found when one is asked for."""

    def __init__(self, robot: Robot, q: Array, rows: list[int]) -> None:
        self.asked: tuple[Robot, Array, list[int]] = robot, q, rows
        self.known: list[str] | None = None

    def name(self, k: int) -> str:
        """The name of the solution in place k of the rows."""
        robot, q, rows = self.asked
        if self.known is None:
            self.known = branch_names(robot, q, np.zeros(len(q), dtype=np.intp))
        return self.known[rows[k]]
