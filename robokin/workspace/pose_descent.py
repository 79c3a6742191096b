"""Reaching for poses with a joint to spare, by going down from configurations that come near: one solution is enough.

Statement. For poses T find whether a configuration within the limits puts the tool there, of an arm that has more
joints than it needs and no closed form when one of them is held.
Derivation. Such an arm could be solved completely for many values of the joint to spare, but each of these is an
elimination, and of all its solutions one would do. So the way down from a handful of configurations is gone instead
(`second_order`), of those drawn in the box of the limits, on its faces and at its corners (`initial_guesses`), which
are as far apart as its parts. From the nearest two a pose is mostly reached; else all of them go a few steps, and those
that came nearest go on. A pose at whose place the tool's origin does not come at all is not looked at.
Degenerate case. At a pose at which the arm is stretched, or several joints are at their limits, steps gain ever less:
what is nearly there is made exact by the singular values' steps (`exact_within`).
What is not found is not proven to be out of reach.
"""

from __future__ import annotations

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.inverse.analysis import General, Task, analysis_of
from robokin.inverse.numeric.closing import BALANCE, exact_within
from robokin.inverse.numeric.initial_guesses import Guesses, guesses
from robokin.inverse.numeric.second_order import go_down
from robokin.kernel.facts import fact
from robokin.spatial import transform
from robokin.workspace.membership import reachable
from robokin.workspace.space import Space

TOGETHER = 256
"""Poses searched for at once: enough that the interpreter's share is spread thin."""

POOL = 2048
"""Ways down that go on together: their columns stay in cache."""

NEAREST, STEPS = 2, 25
"""The nearest configurations that go all the way down first, and the steps of a whole way."""

STILL = 1e-7
"""A step [rad | size] that ends a way."""

NEARLY = 1e-8
"""½|p - t|² [size²] + w (1 - cos θ) below which an end is made exact: 1e-4 sizes or 4e-4 rad off."""


BEGIN, FIRST_STEPS, GO_ON = 62, 8, 16
"""Configurations beside the nearest that go some steps down, and how many of these go on: of poses that are reached,
with joints at their limits as often as not, one in a thousand is missed, and 40 that go on miss as many."""


HOPELESS = 0.01
"""½|p - t|² + w (1 - cos θ) after the first steps above which none goes on: 0.14 sizes or 0.45 rad off."""


def searched(space: Space, task: Task) -> bool:
    """Whether a space's arm is one of those that are searched: with joints to spare, and solved by elimination."""
    analysis = analysis_of(space.arm, task)
    return analysis.redundancy > 0 and isinstance(analysis.solver, General)


def sought_poses(space: Space, task: Task, points: Array, rotations: Array) -> tuple[Flags, Array]:
    """(m,) at which of points (m, 3) [m] the tool gets rotations (m, 3, 3) within the limits, and by what (m, n)
    [rad | m], NaN where nothing was found. What is found for one does not depend on the others."""
    inside, q = np.zeros(len(points), dtype=bool), np.full((len(points), space.arm.n), np.nan)
    places, which = np.unique(points, axis=0, return_inverse=True)
    left = np.flatnonzero(reachable(space, places)[which.ravel()])
    for start in range(0, len(left), TOGETHER):
        some = left[start : start + TOGETHER]
        there, values = _Search(space, task, transform(rotations[some], points[some])).done()
        inside[some], q[some] = there, values
    return inside, q


class _Search:
    """The search for poses T (m, 4, 4)."""

    def __init__(self, space: Space, task: Task, T: Array) -> None:
        self.analysis, self.T = analysis_of(space.arm, task), T
        self.limits, self.drawn = _drawn(space, task)
        chain, size = self.analysis.chain, self.analysis.size
        self.scale = np.where(chain.revolute, 1.0, size)
        self.bounds = tuple(np.ascontiguousarray(bound[:, None]) for bound in (self.limits / self.scale[:, None]).T)
        self.columns = np.ascontiguousarray(T[:, :3].transpose(2, 1, 0))
        self.inside, self.q = np.zeros(len(T), dtype=bool), np.full((len(T), space.arm.n), np.nan)

    def done(self) -> tuple[Flags, Array]:
        """Which of the poses are reached (m,), and by what (m, n)."""
        first = self.drawn.nearest_first(self.T, self.analysis.size, NEAREST + BEGIN)
        rows = np.arange(len(self.T))
        x = (self.drawn.q / self.scale).T[:, first]
        self._down(rows, x[:, :, :NEAREST], STEPS)
        rows = np.flatnonzero(~self.inside)
        ends, f = self._down(rows, x[:, rows, NEAREST:], FIRST_STEPS)
        on = ~self.inside[rows]
        rows, ends, f = rows[on], ends[:, on], f[on]
        order = np.argsort(f, axis=1, kind="stable")
        # A quarter of them at first: mostly one of the very nearest arrives.
        for part in (slice(0, GO_ON // 4), slice(GO_ON // 4, GO_ON)):
            on = ~self.inside[rows]
            rows, ends, f, order = rows[on], ends[:, on], f[on], order[on]
            row, rank = np.nonzero(np.take_along_axis(f, order[:, part], axis=1) <= HOPELESS)
            self._down(rows[row], ends[:, row, order[:, part][row, rank], None], STEPS)
        return self.inside, self.q

    def _down(self, rows: Index, x: Array, steps: int) -> tuple[Array, Array]:
        """Ends (n, k, c) of ways from x (n, k, c) to poses `rows` (k,), and f there (k, c); what arrives is noted."""
        n, k, c = x.shape
        index = np.repeat(rows, c)
        flat = np.ascontiguousarray(x.reshape(n, k * c))
        ends, f = np.empty_like(flat), np.empty(k * c)
        chain, size = self.analysis.chain, self.analysis.size
        for start in range(0, k * c, POOL):
            part = slice(start, start + POOL)
            weight = np.full(len(index[part]), BALANCE)
            T = np.ascontiguousarray(self.columns[..., index[part]])
            here = np.ascontiguousarray(flat[:, part])
            ends[:, part], place, turn = go_down(
                chain, T, here, size, (self.bounds[0], self.bounds[1]), weight, steps=steps, still=STILL
            )
            f[part] = place + BALANCE * turn
        self._note(rows, ends.reshape(n, k, c), f.reshape(k, c))
        return ends.reshape(n, k, c), f.reshape(k, c)

    def _note(self, rows: Index, ends: Array, f: Array) -> None:
        """Make the nearest ends exact where they nearly are, and keep what is."""
        if not f.size:
            return
        best = np.argmin(f, axis=1)
        near = np.flatnonzero(f[np.arange(len(rows)), best] <= NEARLY)
        if not len(near):
            return
        q = ends[:, near, best[near]].T * self.scale
        found = exact_within(self.analysis, self.T, rows[near], q, self.limits, np.inf)
        self.inside[found.index], self.q[found.index] = True, found.q


@fact
def _drawn(space: Space, task: Task) -> tuple[Array, Guesses]:
    """The limits (n, 2) of all joints, also of those that the task leaves open, and configurations within them."""
    analysis, arm = analysis_of(space.arm, task), space.arm
    limits = np.concatenate([arm.limits, np.tile([-np.inf, np.inf], (analysis.open, 1))])
    idle = list(analysis.idle)
    limits[idle] = np.clip(0.0, arm.limits[:, 0], arm.limits[:, 1])[idle, None]
    return limits, guesses(analysis.chain, limits, analysis.size, 0)
