"""What an extreme is sought of: linear functions of the tool's origin, and its squared distance from a point."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array, Index
from robokin.kernel.chain import Chain
from robokin.kernel.frames import frames
from robokin.kernel.geometric_jacobian import jacobian_of


@dataclass(frozen=True, eq=False)
class Goals:
    """m functions f, in the arm's size: g (m, 3), w (m,), and c (3,)."""

    g: Array
    w: Array
    c: Array

    def values(self, p: Array) -> Array:
        """The functions at p: (m, 3)."""
        away = p - self.c
        f: Array = np.sum(self.g * p, axis=1) + 0.5 * self.w * np.sum(away * away, axis=1)
        return f

    def slopes(self, p: Array) -> Array:
        """Their gradients (m, 3) at p: (m, 3)."""
        return self.g + self.w[:, None] * (p - self.c)

    def taken(self, rows: Index) -> Goals:
        """Those of the numbers (k,)."""
        return Goals(self.g[rows], self.w[rows], self.c)


def derivatives(chain: Chain, goals: Goals, q: Array) -> tuple[Array, Array, Array]:
    """p (m, 3), and the functions' gradients (m, n) and Hessians (m, n, n) at q: (m, n)."""
    F = frames(chain, q)
    p, J = F[:, -1, :3, 3], jacobian_of(F, chain.revolute)[:, :3].swapaxes(1, 2)
    slope = goals.slopes(p)
    gradient = np.einsum("mik,mk->mi", J, slope)
    bent = np.where(chain.revolute[:, None], np.cross(slope[:, None], F[:, :-1, :3, 2]), 0.0)
    second = np.triu(bent @ J.swapaxes(1, 2))
    second = second + np.triu(second, 1).swapaxes(1, 2)
    return p, gradient, second + goals.w[:, None, None] * (J @ J.swapaxes(1, 2))
