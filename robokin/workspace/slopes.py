"""A step down the squared distance of an arm's tool from a point, many arms at once: Newton's, damped.

The step of least squares dq = Jᵀ(J Jᵀ + λ)⁻¹ e with the second derivatives of the distance, the joints that stand at a
limit and would be pushed over it left out.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robokin.arrays import Array, Flags
from robokin.kernel.damped_newton import held_at, limited, solved
from robokin.kernel.geometric_jacobian import crossed, motion
from robokin.workspace.sampling import moving_chain
from robokin.workspace.space import Space

STEP = 0.6
"""The longest step of one joint [rad | size]."""

FLOOR, LEAST = 1e-2, 1e-11
"""The least pivot, as a part of the distance, and what is always added to it and to the damping [1]."""


class Slopes:
    """How the distance of a space's tool from points changes with its moving joints."""

    def __init__(self, space: Space) -> None:
        self.chain, self.size = moving_chain(space), space.size
        self.turning = self.chain.revolute[:, None, None].astype(np.float64)
        self.all_turn = bool(self.chain.revolute.all())
        self.scale = np.where(self.chain.revolute, 1.0, space.size)[:, None]
        self.lever = self.scale[:, :, None] / space.size

    def place(self, q: Array) -> Array:
        """(3, m) [m] where q (n, m) put the tool's origin."""
        return np.asarray(motion(self.chain, q).tool[3])

    def lacking(self, t: Array, q: Array) -> tuple[Array, Array]:
        """What q (n,) lacks of t (3,), e: (k,) [size], and how much less that becomes by each joint (k, n) [size]."""
        _, e, J, _ = self.model(t[:, None], q[:, None])
        return e[:, 0], J[:, :, 0].T

    def model(self, t: Array, q: Array) -> tuple[Array, ...]:
        """The squared distance (m,) of q (n, m) from t, and what a step is made of: what they lack of t, e: (3, m)
        [size]; the derivatives J of the position (n, 3, m) and, for each joint, J_i - e × z_i (n, 3, m) [size]: its
        product with J_j, j >= i, is the second derivative of |e|² / 2."""
        J, z, tool = motion(self.chain, q)
        e = (t - tool[3]) / self.size
        J *= self.lever
        turned = crossed(e, z) if self.all_turn else crossed(e, z) * self.turning
        return np.sum(e * e, axis=0), e, J, np.subtract(J, turned, out=turned)

    def blank(self, n: int, m: int) -> list[Array]:
        """Arrays for what a step of m searches is made of, n joints each."""
        return [np.zeros((3, m)), np.zeros((n, 3, m)), np.zeros((n, 3, m))]

    def step(
        self, q: Array, box: tuple[Array, Array], far: Array, mu: Array, parts: Sequence[Array]
    ) -> tuple[Array, Array]:
        """The step (n, m) [rad | m] within a box (n, 1), (n, 1), and what it promises to take off the squared distance
        (m,)."""
        e, J, H = parts
        pull = np.sum(J * e, axis=1)
        held = held_at(q, *box, pull)
        dq, gain = newton_step(J, H, pull, held, far, mu)
        pushed = held_at(q, *box, dq) & ~held
        again = np.flatnonzero(pushed.any(axis=0))
        if len(again):
            J, H, pull, far, mu = (part.take(again, axis=-1) for part in (J, H, pull, far, mu))
            dq[:, again], gain[again] = newton_step(J, H, pull, (held | pushed)[:, again], far, mu)
        return limited(dq, STEP, axis=0) * self.scale, gain


def newton_step(J: Array, H: Array, pull: Array, held: Flags, far: Array, mu: Array) -> tuple[Array, Array]:
    """Newton's step (n, m) with some joints held, and what it promises to take off |e|² (m,), infinite where the
    second derivatives are not those of a minimum."""
    distance = np.sqrt(far)
    floor, damping = FLOOR * distance + LEAST, mu * distance + LEAST
    if held.any():
        free = np.where(held, 0.0, 1.0)
        J, H, pull = J * free[:, None], H * free[:, None], pull * free
    A = H[:, None, 0] * J[None, :, 0]
    A += H[:, None, 1] * J[None, :, 1]
    A += H[:, None, 2] * J[None, :, 2]
    return damped_step(A, pull, floor, damping)


def damped_step(A: Array, pull: Array, floor: Array, damping: Array) -> tuple[Array, Array]:
    """The x (n, m) with (A + damping) x = pull, and what they promise, with second derivatives A (n, n, m), of which
    only what is on and right of the diagonal counts."""
    plain = np.ones(len(floor), dtype=bool)

    def pivot(found: Array) -> Array:
        found = found + damping
        np.logical_and(plain, found > 0.0, out=plain)
        return np.maximum(np.abs(found), floor)

    dq, D, y = solved(A, pull, pivot)
    gain = np.sum(y * y / D, axis=0)
    gain[~plain] = np.inf
    return dq, gain
