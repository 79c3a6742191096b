"""Rows of one branch that need no list of solutions, by the native kernel.

Statement. Give the configurations along poses one after the other, as far as that is plain.
Derivation. Newton's steps of least motion lead from each row to the next, as `follow.Follower` takes them, where a row
alone costs the interpreter a hundred times what it costs the kernel. Of an arm whose solutions could be listed a
row is taken where it is told from all others: other solutions are about as far as the least singular value, and the row
is off where the last ones lead by a tenth of that at most.
Degenerate case. Beside singular configurations, at jumps and where nothing is reached it ends; `Follower` goes on.
"""

from __future__ import annotations

import numpy as np

from robokin.arrays import Array
from robokin.inverse.analysis import Analysis, General
from robokin.kernel.native_kernel import handle, native
from robokin.model import Robot
from robokin.model.robot import tolerated


class PlainRows:
    """Rows of a robot along its poses; spare: whether joints move as little as they can, and not as they last did."""

    def __init__(self, robot: Robot, analysis: Analysis, spare: bool, numeric: bool) -> None:
        chain, opened = analysis.chain, analysis.open
        self.known = None if native is None or chain.n > native.most_moved else handle(chain)
        # Closed forms list all solutions in less time than steps to one take.
        slow = isinstance(analysis.solver, General) and chain.n == 6 and not opened
        self.plain = self.known is not None and (numeric or slow)
        self.size, self.opened, self.spare, self.listed = analysis.size, opened, spare, not numeric
        self.scale = np.where(chain.revolute, 1.0, analysis.size)
        bounds = np.tile([[-np.inf], [np.inf]], (2, chain.n))
        bounds[:2, : robot.n], bounds[2:, : robot.n] = robot.limits.T, tolerated(robot.limits)
        self.limits = bounds / self.scale

    def run(self, poses: Array, q: Array, ahead: Array) -> tuple[Array, Array]:
        """The first rows (r, n) at poses (m, 4, 4) that follow q (n,), and the last move (n,); `ahead` if r is 0.

        ahead: (n,) the move before.
        """
        if native is None or not self.plain:
            return np.empty((0, len(q))), ahead
        scale, rest = self.scale[: len(q)], np.zeros(self.opened)
        x, moved = np.concatenate([q / scale, rest]), np.concatenate([ahead / scale, rest])
        arguments = self.limits, self.size, self.opened, self.spare, self.listed
        count, rows, last = native.followed_rows(self.known, poses, x[None], moved[None], *arguments)
        return rows[:count, : len(q)] * scale, last[0, : len(q)] * scale
