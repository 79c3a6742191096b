"""Error and Jacobian of a chain for few configurations at a time.

Statement. The same as `numeric.error_and_jacobian`, for a handful of configurations.
Derivation. A joint and the constant after it, J(q) C, are linear in (1, cos q, sin q, q): all joints' matrices come
from one product, and n products of matrices (4, 4) follow. Columns kept apart, as in `kinematics.columns`, are faster
for thousands of configurations; for ten of them the interpreter's share of the work is what counts.
Degenerate case. None.
"""

from __future__ import annotations

from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from robokin.inverse.numeric import error_and_jacobian
from robokin.kinematics.chain import Chain

Array = NDArray[np.float64]

FEW = 200
"""Configurations up to which products of matrices take less time."""

HALF_TURN = 1e-9
"""Sine of the angle error below which, with a negative cosine, the error is half a turn and has no direction here."""

_parts: WeakKeyDictionary[Chain, Array] = WeakKeyDictionary()


def _joint_parts(chain: Chain) -> Array:
    """(n, 4, 16) the entries of J(q) C as multiples of 1, cos, sin and q. Kept."""
    parts = _parts.get(chain)
    if parts is None:
        one, cosine, sine, slide = (np.zeros((chain.n, 4, 4)) for _ in range(4))
        turns = chain.revolute.astype(np.float64)
        one[:, (2, 3), (2, 3)] = 1.0
        one[:, (0, 1), (0, 1)] = 1.0 - turns[:, None]
        cosine[:, (0, 1), (0, 1)] = turns[:, None]
        sine[:, 0, 1], sine[:, 1, 0] = -turns, turns
        slide[:, 2, 3] = 1.0 - turns
        matrices = np.stack([one, cosine, sine, slide], axis=1) @ chain.constants[1:, None]
        parts = _parts[chain] = np.ascontiguousarray(matrices.reshape(chain.n, 4, 16))
    return parts


def errors(chain: Chain, T: Array, q: Array, size: float) -> tuple[Array, Array]:
    """The error (s, 6) and the Jacobian (s, 6, n) at q (s, n) against T (s, 4, 4), as `error_and_jacobian` has them."""
    s, n = q.shape
    if s > FEW:
        return error_and_jacobian(chain, T, q, size)
    values = (q + chain.offsets).T
    weights = np.empty((n, s, 4))
    weights[:, :, 0] = 1.0
    weights[:, :, 1], weights[:, :, 2], weights[:, :, 3] = np.cos(values), np.sin(values), values
    M = (weights @ _joint_parts(chain)).reshape(n, s, 4, 4)
    F = np.empty((n + 1, s, 4, 4))
    F[0] = chain.constants[0]
    for i in range(n):
        np.matmul(F[i], M[i], out=F[i + 1])
    axes = F[:-1, :, :3].transpose(3, 2, 0, 1)  # column, entry, joint, row
    z, o, end = axes[2], axes[3], F[-1]
    lever = (end[:, :3, 3].T[:, None] - o) / size
    J = np.empty((6, n, s))
    for k, (a, b) in enumerate(((1, 2), (2, 0), (0, 1))):
        np.subtract(z[a] * lever[b], z[b] * lever[a], out=J[k])
    J[3:] = z
    if not chain.revolute.all():
        slides = ~chain.revolute
        J[:3, slides], J[3:, slides] = z[:, slides], 0.0
    return _pose_error(T, end, size), J.transpose(2, 0, 1)


def _pose_error(T: Array, found: Array, size: float) -> Array:
    """As `numeric.pose_error`."""
    D = T[:, :3, :3] @ found[:, :3, :3].transpose(0, 2, 1)
    e = np.empty((len(D), 6))
    np.subtract(T[:, :3, 3], found[:, :3, 3], out=e[:, :3])
    e[:, :3] /= size
    w = e[:, 3:]
    w[:, 0], w[:, 1], w[:, 2] = D[:, 2, 1] - D[:, 1, 2], D[:, 0, 2] - D[:, 2, 0], D[:, 1, 0] - D[:, 0, 1]
    sine = 0.5 * np.sqrt((w * w).sum(axis=1))
    cosine = 0.5 * (D[:, 0, 0] + D[:, 1, 1] + D[:, 2, 2] - 1.0)
    w *= (0.5 * np.arctan2(sine, cosine) / np.maximum(sine, 1e-300))[:, None]
    stuck = (sine < HALF_TURN) & (cosine < 0.0)
    if stuck.any():
        w[stuck] = [np.pi, 0.0, 0.0]
    return e
