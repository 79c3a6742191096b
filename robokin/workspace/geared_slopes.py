"""The same steps for robots whose joints hang on each other: in the variables, and with limits of joints as cuts.

With v = S u the derivatives by u are J S, and the second derivatives of the squared distance Sᵀ A S. What joints that
several variables move lack of their limits is added to what the tool lacks of the point: G u - h where that is greater
than 0, of the greatest coefficient 1. A point is reached where both vanish.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robokin.arrays import Array
from robokin.kernel.damped_newton import held_at, limited
from robokin.kernel.geometric_jacobian import crossed, motion
from robokin.workspace.half_spaces import HalfSpaces
from robokin.workspace.sampling import moving_chain, moving_cuts, moving_gears
from robokin.workspace.slopes import FLOOR, LEAST, STEP, damped_step
from robokin.workspace.space import Space


class GearedSlopes:
    """How the distance of a space's tool from points changes with its moving variables; see `Slopes`."""

    def __init__(self, space: Space) -> None:
        self.chain, self.size, self.S = moving_chain(space), space.size, moving_gears(space)
        turns = space.robot.revolute[list(space.moving)]
        self.scale = np.where(turns, 1.0, space.size)[:, None]
        own = np.where(self.chain.revolute, 1.0, space.size)[:, None]
        self.lever = own[:, :, None] / space.size
        self.turning = self.chain.revolute[:, None, None].astype(np.float64)
        self.scaled = self.S * self.scale[:, 0] / own
        cuts = moving_cuts(space)
        self.cuts = HalfSpaces.of(cuts.G * self.scale[:, 0], cuts.h)

    def place(self, q: Array) -> Array:
        """(3, m) [m] where q (n, m) put the tool's origin."""
        return np.asarray(motion(self.chain, self.S @ q).tool[3])

    def by_variables(self, q: Array) -> Array:
        """(n, 3, m) how each variable moves the tool's origin at q (n, m) [m by rad | m]."""
        J = motion(self.chain, self.S @ q).linear
        return np.asarray((self.S.T @ J.reshape(len(J), -1)).reshape(len(q), *J.shape[1:]))

    def lacking(self, t: Array, q: Array) -> tuple[Array, Array]:
        """What q (n,) lacks of t (3,) and of the cuts, (k,) [size | rad], and how much less that becomes by each
        variable (k, n)."""
        J, _, tool = motion(self.chain, self.S @ q[:, None])
        over = self._over(q[:, None])[:, 0]
        e = np.concatenate([(t - tool[3, :, 0]) / self.size, -over])
        slopes = (J * self.lever)[:, :, 0].T @ self.scaled
        return e, np.concatenate([slopes, np.where(over[:, None] > 0.0, self.cuts.G, 0.0)])

    def model(self, t: Array, q: Array) -> tuple[Array, ...]:
        """The squared distance (m,) of q (n, m) from t and the cuts, half its slope downwards (n, m) and half its
        second derivatives (n, n, m) [size², by rad | size]."""
        J, z, tool = motion(self.chain, self.S @ q)
        e = (t - tool[3]) / self.size
        J = J * self.lever
        H = J - crossed(e, z) * self.turning
        r, n, m = *self.S.shape, q.shape[1]
        A = np.einsum("ick,jck->ijk", H, J)
        # Of the products only those with j >= i are second derivatives.
        for i in range(r):
            A[i + 1 :, i] = A[i, i + 1 :]
        A = (self.scaled.T @ A.reshape(r, -1)).reshape(n, r, m)
        A = (self.scaled.T @ A.transpose(1, 0, 2).reshape(r, -1)).reshape(n, n, m)
        pull = self.scaled.T @ np.sum(J * e, axis=1)
        far = np.sum(e * e, axis=0)
        if len(self.cuts.h):
            over = self._over(q)
            far = far + np.sum(over * over, axis=0)
            pull = pull - self.cuts.G.T @ over
            A = A + np.einsum("ci,ck,cj->ijk", self.cuts.G, (over > 0.0).astype(np.float64), self.cuts.G)
        return far, pull, A

    def _over(self, q: Array) -> Array:
        """(c, m) by how much q (n, m) are beyond each of the cuts."""
        return np.maximum(self.cuts.G @ (q / self.scale) - self.cuts.h[:, None], 0.0)

    def blank(self, n: int, m: int) -> list[Array]:
        """Arrays for what a step of m searches is made of, n variables each."""
        return [np.zeros((n, m)), np.zeros((n, n, m))]

    def step(
        self, q: Array, box: tuple[Array, Array], far: Array, mu: Array, parts: Sequence[Array]
    ) -> tuple[Array, Array]:
        """The step (n, m) [rad | m] within a box (n, 1), (n, 1), and what it promises to take off the squared distance
        (m,)."""
        pull, A = parts
        distance = np.sqrt(far)
        floor, damping = FLOOR * distance + LEAST, mu * distance + LEAST
        held = held_at(q, *box, pull)
        for _ in range(2):
            free = np.where(held, 0.0, 1.0)
            dq, gain = damped_step(A * free[:, None] * free[None], pull * free, floor, damping)
            pushed = held_at(q, *box, dq) & ~held
            if not pushed.any():
                break
            held = held | pushed
        return limited(dq, STEP, axis=0) * self.scale, gain
