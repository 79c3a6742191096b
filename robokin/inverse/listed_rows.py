"""One branch through the solutions of many poses, many rows at a time.

Statement. Given all solutions at poses one after the other, and the configuration before them, give at each pose the
solution with which the branch goes on.
Derivation. It is the one nearest to where the last two configurations lead. Solvers list the solutions of neighbouring
poses in one order nearly everywhere: it is taken that the branch stays at its place of the list, all rows are looked at
together whether that is so, and where it is not another place is taken from there on.
Degenerate case. A row that is farther from the last one than a bound ends what is found: there the step is too long,
or a jump.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.spatial.angles import TURN, circled

BLOCK = 1024
"""Poses that are solved together."""

WINDOW = 32
"""Rows that are looked at together at first; twice as many while the branch keeps its place."""

STEEPEST = 10.0
"""A step that is longer than the last one by more than this factor says nothing of where the branch leads."""

SURE, BENT = 0.01, 0.25
"""A step is off where the last ones lead [rad | size] by the former or by this part of its length at most: beside a
singular configuration another branch may be as near as the end of too long a step."""

Solve = Callable[[Array], tuple[Array, Index]]


def leads(off: Array, far: Array) -> Flags:
    """Whether steps of lengths far (m,) that are off where the last ones lead by off (m,) stay on their branch."""
    return np.asarray(off <= np.maximum(SURE, BENT * far))


class ListedRows:
    """The solutions at poses (m, 4, 4), at the places s (m,) of a way; solved in blocks, when they are asked for.

    solve: gives all solutions q (b, k, n), padded with NaN, and their count (b,); scale: (n,) what joint moves are
    compared in [rad | m]; revolute: (n,); block: how many poses are solved together, and found in a run at most where
    few: there the solutions take long, and something else goes on.
    """

    def __init__(
        self, solve: Solve, poses: Array, s: Array, scale: Array, revolute: Flags, block: int | None = None
    ) -> None:
        self.block, self.most = block or BLOCK, block or len(poses)
        self.solve, self.poses, self.s, self.scale, self.revolute = solve, poses, s, scale, revolute
        self.blocks: dict[int, tuple[Array, Index]] = {}

    def at(self, i: int) -> Array:
        """All configurations (k, n) at place i."""
        rows, count = self._block(i // self.block)
        return rows[i % self.block, : count[i % self.block]]

    def run(self, q: Array, rate: Array, i: int, bound: float) -> tuple[Array, Array]:
        """The rows (r, n) from place i on that follow q (n,) at place i - 1, each at most `bound` [1] from the last.

        rate: (n,) how the branch came to q, by s; zeros where that is not known. Also the rate at the last row.
        """
        found = [np.empty((0, len(q)))]
        window, end = WINDOW, min(i + self.most, len(self.poses))
        while i < end:
            first, place = divmod(i, self.block)
            rows = self._block(first)[0][place : place + window]
            ahead, whole = self._kept(q, rate, rows, np.diff(self.s[i - 1 : i + len(rows)]), bound)
            if not len(ahead):
                break
            found.append(ahead)
            last = np.concatenate([q[None], ahead])[-2:]
            i += len(ahead)
            step = self.s[i - 1] - self.s[i - 2]
            rate = (last[1] - last[0]) / step if step > 0.0 else np.zeros_like(q)
            q = last[1]
            window = 2 * window if whole else WINDOW
        return np.concatenate(found), rate

    def _kept(self, q: Array, rate: Array, rows: Array, steps: Array, bound: float) -> tuple[Array, bool]:
        """Those of the first rows at which the branch keeps its place in the list (r, n), and whether these are all.

        rows: (b, k, n), steps: (b,) from one to the next by s.
        """
        place = self._nearest(rows[:1], self._led(q, rate, steps[0])[None])[0][0]
        branch = rows[:, place]
        before = np.concatenate([q[None], branch[:-1]])
        moves = circled(branch - before, self.revolute)
        led = before.copy()
        with np.errstate(divide="ignore", invalid="ignore"):
            led[0] += self._led(q, rate, steps[0]) - q
            longer = (steps[1:] / steps[:-1])[:, None]
            led[1:] += np.where(longer <= STEEPEST, longer * moves[:-1], 0.0)
        places, off = self._nearest(rows, led)
        far = np.max(np.abs(moves) / self.scale, axis=1)
        good = (places == place) & (far <= bound) & leads(off, far)
        r = len(good) if good.all() else int(np.argmin(good))
        unwound = q + np.cumsum(moves[:r], axis=0)
        turned = branch[:r] + TURN * np.round((unwound - branch[:r]) / TURN)
        return np.where(self.revolute, turned, branch[:r]), r == len(good)

    def _led(self, q: Array, rate: Array, step: float) -> Array:
        """Where a branch at q (n,) leads to by its rate."""
        return np.asarray(q + rate * step)

    def _nearest(self, rows: Array, led: Array) -> tuple[Index, Array]:
        """Of each row's solutions (b, k, n) the place of that nearest to led (b, n), and how far it is (b,)."""
        gap = np.max(np.abs(circled(rows - led[:, None], self.revolute)) / self.scale, axis=2)
        gap = np.where(np.isnan(gap), np.inf, gap)
        best = np.argmin(gap, axis=1)
        return best, gap[np.arange(len(rows)), best]

    def _block(self, number: int) -> tuple[Array, Index]:
        if number not in self.blocks:
            q, count = self.solve(self.poses[number * self.block : (number + 1) * self.block])
            if q.shape[1] == 0:
                q = np.full((len(q), 1, q.shape[2]), np.nan)
            self.blocks[number] = q, count
        return self.blocks[number]
