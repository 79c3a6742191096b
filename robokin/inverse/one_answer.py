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
from functools import cache, partial
from typing import Any

import numpy as np

from robokin.arrays import Array
from robokin.inverse.claims import BASES, COUNTED, counted_sentence
from robokin.inverse.later_fields import with_later_nearest, with_later_proof
from robokin.inverse.one_target_arm import OneTargetArm
from robokin.inverse.single_answer import FAR
from robokin.inverse.solution_names import branch_names
from robokin.inverse.solutions import Result, Solution, named_later
from robokin.inverse.target_block import OUTSIDE
from robokin.inverse.unmade_result import told_result
from robokin.model import Robot
from robokin.spatial.angles import TURN

INSIDE, TURNS = 2, 3
"""Of the columns of a table after the joint values."""

COUNTED_BASIS = BASES[COUNTED]


@dataclass(eq=False, slots=True)
class OneAnswer:
    """The solutions for one target T (4, 4) [m].

    tried: how many candidates there were; table: (k, 10) a row for each that was found: joint values, turned into the
    limits where that can be [rad], what it lacks of the target [m, rad], whether it is within the limits, and how many
    configurations within them it is equivalent to, a column that may be left out; limits, most, wish: what was asked;
    inside: how many are within the limits, and `turns` how many configurations those are equivalent to, None where the
    column is left out. Where the table has no row there is proof that there is no solution.
    """

    arm: OneTargetArm
    T: Array
    tried: int
    table: Array
    limits: bool
    most: int | None
    wish: Array | None
    inside: int
    turns: int | None

    def told(
        self, question: dict[str, Any], pattern: Array | None = None, named: Robot | None = None
    ) -> dict[str, Any]:
        """The fields of the answer for a question.

        Of an arm that is left of another one, some joints being held, `pattern` (n,) has the values of these, NaN
        elsewhere, and `named` is the robot that the postures are named for, if it is not the arm.
        """
        table, limits, most, analysis = self.table, self.limits, self.most, self.arm.analysis
        count = len(table)
        within = self.inside if limits else count
        rows = None if self.wish is None and most is None else self._rows()
        find = partial(_name, [], self.arm, table, pattern, named)
        solutions = named_later(find, table, 6, (), rows, limits, pattern)
        listed = len(solutions)
        complete = listed == within
        counts = {"found": self.tried, "duplicates": 0, "closing": count}
        if limits:
            counts["within_limits"] = within
        counts["listed"] = listed
        if limits:
            counts["turns"] = self.turns if complete and self.turns is not None else self._turns(rows)
        return {
            "reason": None, "nearest": None, "families": (), "solutions": solutions, "complete": complete,
            "method": analysis.method, "counts": counts, "postures": complete,
            "basis": COUNTED_BASIS if complete else None,
            "certificate": counted_sentence(analysis.number, count, self.arm.form is not None), "all_known": True,
            "families_complete": True, **question,
        }  # fmt: skip

    def _rows(self) -> list[int]:
        """The rows that are listed, in their order."""
        inside = self.table[:, 6 + INSIDE].tolist()
        rows = [k for k, fits in enumerate(inside) if fits or not self.limits]
        if self.wish is not None:
            wish = self.wish.tolist()
            moves = [max([abs(a - b) for a, b in zip(q, wish, strict=True)]) for q in self.table[:, :6].tolist()]
            rows.sort(key=moves.__getitem__)
        return rows[: self.most]

    def _turns(self, rows: list[int] | None) -> int:
        """How many configurations within the limits those of some rows are equivalent to."""
        listed = self._rows() if rows is None else rows
        if self.turns is None:
            return sum(map(self._equivalents, listed))
        return int(sum(self.table[listed, 6 + TURNS].tolist()))

    @property
    def reached(self) -> bool:
        """Whether there is a solution to list."""
        return self.inside > 0 if self.limits else len(self.table) > 0

    def unreached(self, question: dict[str, Any], ask: Callable[[], Result]) -> Result:
        """The answer for a question where there is nothing to list; `ask` gives the same with what is slow to find."""
        arm, count = self.arm, len(self.table)
        counts = {"found": self.tried, "duplicates": 0, "closing": count}
        counts |= {"within_limits": 0, "listed": 0, "turns": 0} if self.limits else {"listed": 0}
        certificate = counted_sentence(arm.analysis.number, count, arm.form is not None)
        told = told_result({
            "solutions": (), "complete": True, "method": arm.analysis.method, "counts": counts, "postures": True,
            "basis": COUNTED_BASIS, "certificate": certificate, "all_known": True, "reason": None,
            "nearest": None, "families": (), "families_complete": True, **question,
        })  # fmt: skip
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


def _name(
    known: list[str], arm: OneTargetArm, table: Array, pattern: Array | None, named: Robot | None, row: int
) -> str:
    """The name of the solution in a row of a table, which are all found when one is asked for: see `OneAnswer.told`."""
    if not known:
        q = table[:, :6]
        if named is None or pattern is None:
            known += branch_names(arm.robot, q, np.zeros(len(q), dtype=np.intp))
        else:
            whole = np.tile(pattern, (len(q), 1))
            whole[:, np.isnan(pattern)] = q
            known += branch_names(named, whole)
    return known[row]
