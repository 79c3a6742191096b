"""All complex solutions of a six-joint loop by following paths, and an account of where each of them ends.

Statement. A loop has a generic number N of complex solutions: no target has more isolated ones. From a target at which
all N are known as many paths lead to any other. Where each of them ends in a regular solution, in a singular one or at
infinity, all regular solutions have been found, also where the arm is singular.
Derivation. Near the target of a regular solution all targets have one close by, so that it is where one of the N paths
from a start in general position ends. Regular ends are then all regular solutions. Where all N are known at a pose
close by (`starts_close_by`) the way from there takes a third of the steps; bent into the complex (`paths`), it misses
the targets at which solutions meet as one from a complex start does.
Degenerate case. Two paths may pass so near to each other that a step goes over to the wrong one; then both end alike,
and a regular solution is missing. An account is closed only where two starts, with other targets and so other paths,
agree. For a real target the conjugates of solutions are solutions: this is checked as well.
Reference. C. Wampler, A. Morgan, "Solving the 6R inverse position problem using a generic-case solution methodology",
Mechanism and Machine Theory 26 (1991); A. Morgan, A. Sommese, "Coefficient-parameter polynomial continuation", Applied
Mathematics and Computation 29 (1989).
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import NamedTuple

import numpy as np

from robokin.arrays import Array, Complex, Index
from robokin.inverse.elimination.account_of_paths import (
    MOVED,
    OUT,
    REGULAR,
    SOON,
    Account,
    Ends,
    judged,
    told_apart,
    with_paths_near_motions,
    with_seeds_refined,
)
from robokin.inverse.elimination.complex_newton import complex_refine, regular
from robokin.inverse.elimination.homotopy_paths import NEAR, Points, distance, points_of, track
from robokin.inverse.elimination.loop import Loop
from robokin.inverse.elimination.monodromy import Known, Start, another_start, started, two_starts
from robokin.inverse.elimination.starts_close_by import Beside

BENDS = np.exp(1.3j), np.exp(1.0j)
"""γ of the ways from two targets close by: they go around what is between them and the target, at about a right angle.
Not one the conjugate of the other, which would lead to the conjugate paths."""

SPEED = 0.05
"""Least u times speed of a path that leads to infinity, where it tends to a fraction that is rarely below 1/4; at
singular ends it tends to zero."""

GONE = 2.5
"""|Im q| [rad] (or the logarithm of a slide's length [size]) that such a path has reached at u = 1e-9, 1/8 of 20.7 and
more. A path to a place where four solutions meet, or near a self-motion, may be fast as well, but has not gone far."""

LATE = 1e-3
"""Value of u before which no path is taken to have gone to infinity unless it is as far out as `OUT`."""

POLISH = 4
"""Newton steps for ends; from 1e-3, where paths that passed close to a singular solution may have been left, and
less."""


class _Begun(NamedTuple):
    """Where the paths to some targets begin.

    chosen: (m,) the targets; point: (m,) points; values: (6, m, N) the solutions there [rad | size]; bend: γ.
    """

    chosen: Index
    point: Points
    values: Complex
    bend: complex


class Homotopy:
    """What follows the paths of a loop. Starts are made when they are first needed, and kept."""

    def __init__(
        self,
        loop: Loop,
        known: Callable[[], list[Known]] | None = None,
        beside: Callable[[Array], Beside] | None = None,
    ) -> None:
        """`known` gives all solutions at two targets, if another solver can: a start is then one track away.

        `beside` gives all those at two targets close to each of some, as far as it can, which makes short ways.
        """
        self.loop, self._known, self._beside = loop, known, beside
        self._starts: list[Start] = []

    @cached_property
    def count(self) -> int | None:
        """N, the generic number of complex solutions; None where two independent searches do not agree on it.

        It is even: an odd one is not believed.
        """
        found = started(self.loop, self._known()) if self._known is not None else None
        found = found or two_starts(self.loop)
        if found is None:
            return None
        number: int = found[0].values.shape[1]
        if number % 2:
            return None
        self._starts = list(found)
        return number

    def account(self, closing: Array, most: int = 4) -> Account:
        """Follow all paths to L6 (m, 4, 4) from two starts, and from more, where these do not agree.

        These are two targets close by where all solutions are known, else two complex ones that serve for all; then
        further ones of these, up to `most`. Raises ValueError where the number of solutions is not known.
        """
        if self.count is None:
            raise ValueError("the number of complex solutions of this arm could not be established")
        m = len(closing)
        begun = self._close_by(closing)
        used = np.full(m, 2)
        for one in begun:
            used[one.chosen] = 0
        begun += [self._far(k, np.flatnonzero(used == 2)) for k in range(2)]
        tried = self._ends(closing, begun)
        verdict = judged(self.loop, self.count, m, tried)
        for k in (0, *range(2, most)):
            # After starts close by two that serve for all, thereafter one more.
            starts = range(2) if k == 0 else range(k, k + 1)
            open_ = np.flatnonzero(~verdict.closed & (used == k))
            if len(open_) and all(self._start(i) is not None for i in starts):
                tried += self._ends(closing, [self._far(i, open_) for i in starts])
                verdict = judged(self.loop, self.count, m, tried)
                used[open_] = starts.stop
        return with_paths_near_motions(self.loop, closing, with_seeds_refined(self.loop, closing, verdict), tried)

    def _close_by(self, closing: Array) -> list[_Begun]:
        """Starts for those of the targets beside which all solutions are known at two poses."""
        found = None if self._beside is None else self._beside(closing)
        if found is None or not len(found.chosen) or found.values.shape[2] != self.count:
            return []
        return [
            _Begun(found.chosen, points_of(near), np.ascontiguousarray(values.transpose(2, 0, 1)), bend)
            for near, values, bend in zip(found.closing, found.values, BENDS, strict=True)
        ]

    def _far(self, k: int, chosen: Index) -> _Begun:
        """Start k for some targets (m,)."""
        start = self._starts[k]
        many = np.broadcast_to(start.values[:, None], (6, len(chosen), start.values.shape[1]))
        return _Begun(chosen, start.point.pick(np.zeros(len(chosen), dtype=np.intp)), many, 1.0)

    def _start(self, k: int) -> Start | None:
        """Start k, from 0: the first two are independent, further ones are reached from the first, if they are."""
        while len(self._starts) <= k:
            more = another_start(self.loop, self._starts[0], seed=100 + len(self._starts))
            if more is None:
                return None
            self._starts.append(more)
        return self._starts[k]

    def _ends(self, closing: Array, begun: list[_Begun]) -> list[Ends]:
        """The ends of the paths from some starts, all followed together."""
        loop = self.loop
        N = begun[0].values.shape[2]
        target = np.concatenate([np.repeat(one.chosen, N) for one in begun])
        bend = np.concatenate([np.full(N * len(one.chosen), one.bend, dtype=np.complex128) for one in begun])
        home = Points(
            np.concatenate([np.repeat(one.point.r, N, axis=1) for one in begun], axis=1),
            np.concatenate([np.repeat(one.point.p, N, axis=1) for one in begun], axis=1),
        )
        at = np.concatenate([one.values.reshape(6, -1) for one in begun], axis=1)
        ends = track(loop, home, points_of(closing).pick(target), at, bend)
        values = np.ascontiguousarray(ends.values.T)
        # Paths left shortly before a nearly singular solution may still reach it: all that came near the end are tried.
        late = np.flatnonzero(~ends.lost & (ends.u < LATE))
        refined, residual = complex_refine(loop, closing, target[late], values[late], POLISH)
        moved = np.abs(refined - values[late]).max(axis=1, initial=0.0)
        good = np.flatnonzero(regular(loop, refined, residual, REGULAR) & (moved < MOVED))
        values[late[good]] = refined[good]
        whole = np.zeros(len(target), dtype=bool)
        whole[late[good]] = True
        out = distance(loop, ends.values)
        gone = np.where(ends.u < LATE, out > GONE, (ends.u < SOON) & (out > OUT))
        infinite = ~whole & gone & (ends.speed > SPEED)
        lost = ~whole & ~infinite & (ends.lost | (ends.u > NEAR))
        singular = ~whole & ~infinite & ~lost
        fine = told_apart(loop, closing, target, values, whole, np.flatnonzero(singular & (ends.u < LATE)))
        everything = Ends(target, values, whole, singular, infinite, lost, *fine)
        last = np.cumsum([N * len(one.chosen) for one in begun]).tolist()
        return [everything.part(slice(end - N * len(one.chosen), end)) for one, end in zip(begun, last, strict=True)]
