"""Where joints put the tool's origin, and how it moves with each of them, a block of configurations at a time."""

from __future__ import annotations

import numpy as np

from robokin.arrays import Array
from robokin.kernel.chain import Chain
from robokin.kernel.columns import ChainPlan, Constant

BLOCK = 2048
"""Configurations at a time: their columns stay in the second-level cache."""


class Placing:
    """The positions and Jacobians of a chain's tool."""

    def __init__(self, chain: Chain) -> None:
        self.revolute = chain.revolute
        self.sliding = np.flatnonzero(~chain.revolute)
        self.constants = chain.constants
        # A frame is marked before each joint; behind the last the whole transform leads to the tool.
        self.plan = ChainPlan([[Constant(C, mark=True)] for C in chain.constants], chain.revolute, chain.offsets)

    def placed(self, q: Array) -> tuple[Array, Array]:
        """Positions (3, m) [m] and their derivatives (n, 3, m) [m/rad | 1] at q: (n, m) [rad | m]."""
        p, J, _ = self.with_axes(q)
        return p, J

    def with_axes(self, q: Array) -> tuple[Array, Array, Array]:
        """Positions (3, m) [m], their derivatives (n, 3, m) [m/rad | 1], the joints' axes (n, 3, m)."""
        n, m = q.shape
        p, J, Z = np.empty((3, m)), np.empty((n, 3, m)), np.empty((n, 3, m))
        for start in range(0, m, BLOCK):
            part = slice(start, start + BLOCK)
            self._block(q[:, part], p[:, part], J[:, :, part], Z[:, :, part])
        return p, J, Z

    def _block(self, q: Array, p: Array, J: Array, Z: Array) -> None:
        *frames, (_, _, _, tool) = self.plan.columns(q)
        for row, entry in zip(p, tool, strict=True):
            row[:] = entry
        lever = np.empty_like(Z)
        for i, (_, _, z, o) in enumerate(frames):
            for k in range(3):
                Z[i, k] = z[k]
                np.subtract(p[k], o[k], out=lever[i, k])
        J[:] = crossed(Z, lever)
        J[self.sliding] = Z[self.sliding]


def crossed(u: Array, v: Array) -> Array:
    """u × v of vectors (..., 3, m)."""
    w = np.empty(np.broadcast_shapes(u.shape, v.shape))
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        np.multiply(u[..., i, :], v[..., j, :], out=w[..., k, :])
        w[..., k, :] -= u[..., j, :] * v[..., i, :]
    return w
