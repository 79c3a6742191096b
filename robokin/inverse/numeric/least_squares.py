"""Damped least squares, for many starts at once: what serves where no closed form does.

Statement. Find joint values that bring the pose of a chain to a target, within limits.
Derivation. With the error e = (p_target - p, rotation vector of R_target Rᵀ) and the Jacobian J, the step
dq = (JᵀJ + λ I)⁻¹ Jᵀe lowers the error; λ proportional to the error itself (T. Sugihara,
"Solvability-unconcerned inverse kinematics by the Levenberg-Marquardt method", IEEE T-RO 27(5), 2011) makes it
cautious far off and Newton's near the end, singular or not. A joint that is at a limit and would be pushed
further is left out of the step.
Degenerate case. It finds a local minimum: good starts and several of them are what makes it find the least.
"""

from __future__ import annotations

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.inverse.elimination.loop_newton import LONG
from robokin.kernel.chain import Chain
from robokin.kernel.damped_newton import brought_down, held_at, limited, singular_step
from robokin.kernel.native_kernel import handle, native
from robokin.kernel.residual import error_and_jacobian

STEP = 0.6
"""Longest step of a joint [rad | size]."""

DAMPING = 1e-2
"""λ as a part of the squared error; Sugihara's range is 1e-3 to 1e-1."""

ARRIVED = 1e-26
"""Squared error [size and rad] at which the steps end: they are quadratic, and the next would be rounding."""

FLOOR = 1e-13
"""Least λ of a joint as a part of its |column of J|², so that the matrix has an inverse at a singular configuration;
the column is great where the axis is far from the tool, as a long slide puts it."""


def descend(
    chain: Chain, T: Array, q: Array, size: float, *, limits: Array | None = None, steps: int = 40
) -> tuple[Array, Array]:
    """Joint values (s, n) [rad | m] after some steps from q towards targets T: (s, 4, 4), and the error (s, 6).

    limits: (n, 2) [rad | m]. Where an error remains, what comes closest is another module's business (`closest`).
    """
    scale = np.where(chain.revolute, 1.0, size)
    low, high = (np.full(chain.n, -np.inf), np.full(chain.n, np.inf)) if limits is None else (limits / scale[:, None]).T
    x = np.clip(q / scale, low, high)
    # Lengths in the longest slide: what rounding leaves of positions would outweigh the errors of orientation.
    far = np.max(np.abs(x[:, ~chain.revolute]), axis=1, initial=1.0)[:, None]
    known = handle(chain)
    if native is None or known is None or chain.n > native.most_moved:
        x, e = _stepped(chain, T, x, size, far, low, high, steps)
        return x * scale, e
    # Steps by singular values are left to Python.
    ends, e = native.descended(known, T, far, x, size, low, high, steps)
    rows = np.flatnonzero(far[:, 0] > LONG)
    if len(rows):
        ends[rows], e[rows] = _stepped(chain, T[rows], x[rows], size, far[rows], low, high, steps)
    return ends * scale, e


def _stepped(
    chain: Chain, T: Array, x: Array, size: float, far: Array, low: Array, high: Array, steps: int
) -> tuple[Array, Array]:
    """`descend` in Python, from x (s, n) [rad | size] with the units far (s, 1) of lengths."""
    scale = np.where(chain.revolute, 1.0, size)
    unit = np.where(chain.revolute, 1.0, far)

    def errors(rows: Index, x: Array) -> tuple[Array, Array]:
        e, J = error_and_jacobian(chain, T[rows], x * scale, size)
        e[:, :3] /= far[rows]
        J[:, :3] /= far[rows, :, None]
        J *= unit[rows, None]
        return e, J

    def step(rows: Index, x: Array, e: Array, J: Array) -> Array:
        return _step(x, e, J, low, high, far[rows, 0] > LONG) * unit[rows]

    x, e = brought_down(errors, step, x, low, high, steps=steps, arrived=ARRIVED / far[:, 0] ** 2)
    e[:, :3] *= far
    return x, e


def _step(x: Array, e: Array, J: Array, low: Array, high: Array, long: Flags) -> Array:
    """The damped step (s, n), by the normal equations or, where slides are long (s,), by singular values."""
    squared = np.sum(e * e, axis=1)
    gradient = np.einsum("sij,si->sj", J, e)
    held = held_at(x, low, high, gradient)
    J = np.where(held[:, None, :], 0.0, J)
    M = np.swapaxes(J, 1, 2) @ J
    trust = np.minimum(DAMPING * squared, 1.0)
    damping = trust[:, None] + FLOOR * np.where(held, 1.0, np.diagonal(M, axis1=1, axis2=2))
    M.reshape(len(M), -1)[:, :: J.shape[2] + 1] += damping  # its diagonal
    side = np.where(held, 0.0, gradient)[:, :, None]
    dx = np.asarray(np.linalg.solve(M, side)[:, :, 0], dtype=np.float64)
    if long.any():
        dx[long] = singular_step(J[long], e[long], trust[long])
    return limited(dx, STEP)
