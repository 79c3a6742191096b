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

from robokin.arrays import Array
from robokin.inverse.elimination.loop_newton import LONG, singular_step
from robokin.inverse.numeric.pose_error import error_and_jacobian
from robokin.kernel.chain import Chain

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
    x = q / scale
    low, high = (np.full(chain.n, -np.inf), np.full(chain.n, np.inf)) if limits is None else (limits / scale[:, None]).T
    x = np.clip(x, low, high)
    ends, errors = x.copy(), np.zeros((len(x), 6))
    best, least, error = x.copy(), np.full(len(x), np.inf), np.zeros((len(x), 6))
    on, identity = np.arange(len(x)), np.eye(chain.n)
    # Lengths in the longest slide: what rounding leaves of positions would outweigh the errors of orientation.
    far = np.max(np.abs(x[:, ~chain.revolute]), axis=1, initial=1.0)[:, None]
    unit, long = np.where(chain.revolute, 1.0, far), far[:, 0] > LONG
    for step in range(steps + 1):
        e, J = error_and_jacobian(chain, T, x * scale, size)
        e[:, :3] /= far
        J[:, :3] /= far[:, :, None]
        J *= unit[:, None]
        squared = np.sum(e * e, axis=1)
        better = squared <= least
        best[better], least[better], error[better] = x[better], squared[better], e[better]
        # What has arrived stays: where a row ends must not depend on the others.
        done = least * far[:, 0] ** 2 < ARRIVED
        if step == steps or 3 * np.count_nonzero(done) >= len(done):
            ends[on], errors[on, :3], errors[on, 3:] = best, error[:, :3] * far, error[:, 3:]
            rest = ~done
            if step == steps or not rest.any():
                break
            # Those that have arrived cost no more time.
            on, T, x, best, least, error = on[rest], T[rest], x[rest], best[rest], least[rest], error[rest]
            far, unit, long, done = far[rest], unit[rest], long[rest], done[rest]
            e, J, squared = e[rest], J[rest], squared[rest]
        gradient = np.einsum("sij,si->sj", J, e)
        # A joint at its limit that the gradient pushes outwards takes no part.
        held = ((x <= low) & (gradient < 0.0)) | ((x >= high) & (gradient > 0.0))
        J = np.where(held[:, None, :], 0.0, J)
        M = np.swapaxes(J, 1, 2) @ J
        damping = np.minimum(DAMPING * squared, 1.0)[:, None]
        damping = damping + FLOOR * np.where(held, 1.0, np.diagonal(M, axis1=1, axis2=2))
        M += damping[:, :, None] * identity
        dx = np.linalg.solve(M, np.where(held, 0.0, gradient)[:, :, None])[:, :, 0]
        if long.any():
            dx[long] = singular_step(J[long], e[long], np.minimum(DAMPING * squared[long], 1.0))
        dx *= (STEP / np.maximum(np.max(np.abs(dx), axis=1), STEP))[:, None]
        dx[done] = 0.0
        x = np.clip(x + dx * unit, low, high)
    return ends * scale, errors
