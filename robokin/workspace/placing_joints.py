"""The joint values of an arm whose tool's origin is placed by as many joints as its set has dimensions.

There are then finitely many for each position but for a set of no size, and the closed forms of inverse kinematics
give them all: the joints that do not move the origin are left out, and an arm with one or two moving joints gets
sliding ones at its tool that must come out as zero.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np

from robokin.arrays import Array, Index
from robokin.inverse.analysis import Analysis, analyse
from robokin.inverse.solve_blocks import BLOCK, quick_block
from robokin.inverse.verify import within_limits
from robokin.kernel.chain import Chain, with_joints
from robokin.kernel.facts import fact
from robokin.kernel.geometric_jacobian import motion
from robokin.workspace.sampling import moving_chain
from robokin.workspace.space import Space

STANDS = 1e-7
"""A virtual slide at less than this part of the arm's size stands still: a point this near to a curve or surface
is taken for one of its own."""

PROBES = 32
"""Configurations at which a choice of virtual slides is judged."""


class ClosedForm:
    """All joint values for a position; exists where `space.moving` are as many as `space.dimension`.

    first_free leaves out the limits of the first moving joint.
    """

    def __init__(self, space: Space, first_free: bool = False) -> None:
        moving = list(space.moving)
        self.chain = moving_chain(space)
        self.limits = np.stack([space.low, space.high], axis=1)[moving]
        self.limits[space.full[moving]] = -np.inf, np.inf
        if first_free:
            self.limits[0] = -np.inf, np.inf
        self.size = space.size
        self.own = len(moving)
        whole = self.chain
        if self.own < 3:
            whole = _with_slides(whole, 3 - self.own, space.low[moving], space.high[moving])
        self.analysis: Analysis = analyse(whole, "position")
        self.all_limits = np.concatenate([self.limits, np.tile([-np.inf, np.inf], (3 - self.own, 1))])

    def solutions(self, points: Array) -> tuple[Index, Array]:
        """Every configuration within the limits: index (s,) into points (m, 3) [m], rising; q (s, k) [rad | m]."""
        indices, values = [np.empty(0, dtype=np.intp)], [np.empty((0, self.own))]
        rest = np.zeros(self.analysis.chain.n - self.analysis.open)
        for start in range(0, len(points), BLOCK):
            part = points[start : start + BLOCK]
            T = np.zeros((len(part), 4, 4))
            T[:, range(4), range(4)] = 1.0
            T[:, :3, 3] = part
            found = quick_block(self.analysis, T, self.all_limits, rest)
            q, inside = within_limits(found.q[:, : self.own], self.chain.revolute, self.limits, None)
            inside &= np.all(np.abs(found.q[:, self.own :]) <= STANDS * self.size, axis=1)
            indices.append(found.index[inside] + start)
            values.append(q[inside])
        return np.concatenate(indices), np.concatenate(values)

    def counts(self, points: Array) -> Index:
        """(m,) how many configurations within the limits reach each of the points (m, 3) [m]."""
        return np.bincount(self.solutions(points)[0], minlength=len(points))


def closed_form_of(space: Space, first_free: bool = False) -> ClosedForm:
    """The closed form of a space, made when it is first asked for."""
    return _closed_form(space, first_free)


@fact
def _closed_form(space: Space, first_free: bool) -> ClosedForm:
    return ClosedForm(space, first_free)


def _with_slides(chain: Chain, count: int, low: Array, high: Array) -> Chain:
    """The chain with sliding joints along axes of the tool, those that are the most upright on what it can do."""
    q = low[:, None] + (high - low)[:, None] * np.random.default_rng(5).random((chain.n, PROBES))

    def made(axes: tuple[int, ...]) -> Chain:
        return with_joints(chain, axes, [False] * count)

    def rated(axes: tuple[int, ...]) -> float:
        J = motion(made(axes), np.concatenate([q, np.zeros((count, PROBES))])).linear
        return float(np.median(np.abs(np.linalg.det(J.transpose(2, 0, 1)))))

    return made(max(combinations(range(3), count), key=rated))
