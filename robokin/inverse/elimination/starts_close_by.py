"""All complex solutions at poses close to given ones, as far as an arm's own solver knows them.

Statement. For each of some targets give two poses close by at which all N complex solutions are known.
Derivation. An elimination gives the complex solutions as well; they are refined and counted. Of a closed form only the
real ones are worked out: they are all where there are N of them. Where the target is singular the poses around it are
not, and are far enough from it for their solutions to be told apart.
Degenerate case. Around some targets fewer than N are known: such a target is left out.
"""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple

import numpy as np

from robokin.arrays import Array, Complex, Index
from robokin.inverse.elimination.complex_newton import regular_and_distinct
from robokin.inverse.elimination.loop import Loop
from robokin.inverse.elimination.loop_newton import refine
from robokin.inverse.elimination.native_elimination import candidates_at
from robokin.inverse.elimination.splits import REAL, Elimination, count_solutions
from robokin.spatial import rotation_from_rpy, transform

AWAY = 0.05
"""How far away [size and rad] these poses are: solutions that meet at the target are some 0.3 apart there."""

TRIED, TRIED_REAL = 4, 12
"""Poses around each target that are tried: of an elimination, and where only the real solutions are known."""

STEPS = 3
"""Newton steps for what is found."""

WANTED = 2
"""Poses at which all solutions are known that a target needs: from two its paths must end alike."""


class Beside(NamedTuple):
    """Poses close to targets, and all solutions there.

    chosen: (k,) the targets that have them; closing: (2, k, 4, 4) their L6; values: (2, k, N, 6) [rad | size].
    """

    chosen: Index
    closing: Array
    values: Complex


@cache
def _around(count: int) -> Array:
    """Motions (count, 4, 4) to the poses that are tried."""
    turns, moves = AWAY * np.random.default_rng(13).normal(size=(2, count, 3)) / np.sqrt(3.0)
    return transform(rotation_from_rpy(turns), moves)


class CloseBy:
    """What finds starts close to the targets of a loop that is solved by some solver and has `number` solutions."""

    def __init__(self, loop: Loop, solver: Any, number: int | None) -> None:
        self.loop, self.solver, self.number = loop, solver, number

    def __call__(self, closing: Array) -> Beside:
        """Two starts for those of the targets L6 (m, 4, 4) that have some."""
        m, N = len(closing), self.number or 0
        tried = TRIED if isinstance(self.solver, Elimination) else TRIED_REAL
        around = (_around(tried)[:, None] @ closing[None]).reshape(-1, 4, 4)
        index, values = self._solutions(around)
        whole = np.flatnonzero(np.bincount(index, minlength=len(around)) == N) if N else np.empty(0, dtype=np.intp)
        # The first two poses of each target at which none is missing.
        order = whole[np.argsort(whole % m, kind="stable")]
        rank = np.arange(len(order)) - np.searchsorted(order % m, order % m)
        some = order[rank < WANTED]
        enough = np.bincount(some % m, minlength=m) == WANTED
        some = some[enough[some % m]]
        rows = np.argsort(index, kind="stable")
        first = np.searchsorted(index[rows], some)
        found = values[rows[first[:, None] + np.arange(N)]].reshape(len(some) // WANTED, WANTED, N, 6)
        near = around[some].reshape(-1, WANTED, 4, 4)
        return Beside(np.flatnonzero(enough), near.swapaxes(0, 1), found.swapaxes(0, 1))

    def _solutions(self, closing: Array) -> tuple[Index, Complex]:
        """The distinct regular complex solutions (s, 6) that are known at L6 (k, 4, 4), and the pose of each (s,)."""
        if isinstance(self.solver, Elimination):
            parts = [(part.index, part.values) for part in candidates_at(self.solver, self.loop, closing)]
            counted = count_solutions(self.loop, closing, parts, STEPS)
            index, values = counted.target[counted.kept], counted.values[counted.kept]
            paired = np.abs(values.imag).max(axis=1, initial=0.0) > REAL
            return np.append(index, index[paired]), np.concatenate([values, values[paired].conj()])
        candidates = self.solver.candidates(closing)
        real, position, angle = refine(self.loop, closing, candidates.index, candidates.values, STEPS)
        kept = regular_and_distinct(self.loop, candidates.index, real, position + angle)
        return candidates.index[kept], real[kept].astype(np.complex128)
