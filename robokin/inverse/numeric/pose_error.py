"""Error and Jacobian of a chain for many configurations at once, be they a handful or some thousands.

Statement. Give the difference of the poses of a chain from targets, and how it changes with the joint values.
Derivation. A joint and the constant after it, J(q) C, are linear in (1, cos q, sin q, q): all joints' matrices come
from one product, and n products of matrices (4, 4) follow. For ten configurations the interpreter's share of the work
is what counts. For hundreds a joint mixes two columns of the frame before it, and the constant after it all four, of
all configurations at once: one product of matrices (4, 4) and (4, 3 s).
With the columns r_k of the rotation that is found and t_k of the one that is wished for the vector of the skew part of
their difference is ½ Σ r_k × t_k.
Degenerate case. None.
"""

from __future__ import annotations

from weakref import WeakKeyDictionary

import numpy as np

from robokin.arrays import Array
from robokin.kernel.chain import Chain

FEW = 80
"""Configurations up to which a product of matrices for each takes less time."""

TOGETHER = 1000
"""Configurations at a time: their numbers stay in the second-level cache."""

CROSS = ((1, 2), (2, 0), (0, 1))
"""Entry k of a × b is a[i] b[j] - a[j] b[i]."""

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


def error_and_jacobian(chain: Chain, T: Array, q: Array, size: float) -> tuple[Array, Array]:
    """The error (s, 6) of the poses at q (s, n) [rad | m] against T (s, 4, 4), and the Jacobian (s, 6, n).

    Lengths, also those of prismatic joints, are in sizes.
    """
    if len(q) <= FEW:
        return _of_few(chain, T, q, size)
    starts = range(0, len(q), TOGETHER)
    parts = [_of_many(chain, T[i : i + TOGETHER], q[i : i + TOGETHER], size) for i in starts]
    if len(parts) == 1:
        return parts[0]
    return np.concatenate([part[0] for part in parts]), np.concatenate([part[1] for part in parts])


def _of_few(chain: Chain, T: Array, q: Array, size: float) -> tuple[Array, Array]:
    """`error_and_jacobian`, by a product of matrices for each configuration and joint."""
    s, n = q.shape
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
    for k, (a, b) in enumerate(CROSS):
        np.subtract(z[a] * lever[b], z[b] * lever[a], out=J[k])
    J[3:] = z
    if not chain.revolute.all():
        slides = ~chain.revolute
        J[:3, slides], J[3:, slides] = z[:, slides], 0.0
    return _pose_error(T, end[:, :3].transpose(2, 1, 0), size), J.transpose(2, 0, 1)


def _of_many(chain: Chain, T: Array, q: Array, size: float) -> tuple[Array, Array]:
    """`error_and_jacobian`, by a product of matrices for each joint."""
    s, n = q.shape
    constants, revolute = chain.constants.transpose(0, 2, 1), chain.revolute.tolist()
    values = (q + chain.offsets).T
    cosine, sine = np.cos(values), np.sin(values)
    X = np.empty((4, 3, s))
    X[:] = constants[0, :, :3, None]
    axes, turned = np.empty((2, 3, n, s)), np.empty((2, 3, s))
    for i, turns in enumerate(revolute):
        axes[:, :, i] = X[2:]
        if turns:
            np.multiply(X[:2], cosine[i], out=turned)
            X[:2] *= sine[i]
            turned[0] += X[1]
            turned[1] -= X[0]
            X[:2] = turned
        else:
            X[3] += values[i] * X[2]
        X = (constants[i + 1] @ X.reshape(4, 3 * s)).reshape(4, 3, s)
    z, lever = axes
    np.subtract(X[3][:, None], lever, out=lever)
    lever /= size
    J = np.empty((6, n, s))
    for k, (a, b) in enumerate(CROSS):
        np.multiply(z[a], lever[b], out=J[k])
        J[k] -= z[b] * lever[a]
    J[3:] = z
    if not all(revolute):
        slides = ~chain.revolute
        J[:3, slides], J[3:, slides] = z[:, slides], 0.0
    return _pose_error(T, X, size), np.ascontiguousarray(J.transpose(2, 0, 1))


def pose_error(T: Array, found: Array, size: float) -> Array:
    """(s, 6): origin's distance [size] and rotation vector [rad] from found to T, (s, 4, 4), in the base's axes."""
    return _pose_error(T, found[:, :3].transpose(2, 1, 0), size)


def _pose_error(T: Array, X: Array, size: float) -> Array:
    """The error (s, 6) for the columns x, y, z, p (4, 3, s) of what was found."""
    wish = T[:, :3].transpose(2, 1, 0)
    e = np.empty((6, X.shape[2]))
    np.subtract(wish[3], X[3], out=e[:3])
    e[:3] /= size
    w = e[3:]
    for k, (a, b) in enumerate(CROSS):
        np.subtract(X[:3, a] * wish[:3, b], X[:3, b] * wish[:3, a]).sum(axis=0, out=w[k])
    sine = 0.5 * np.sqrt((w * w).sum(axis=0))
    cosine = 0.5 * ((X[:3] * wish[:3]).sum(axis=(0, 1)) - 1.0)
    w *= 0.5 * np.arctan2(sine, cosine) / np.maximum(sine, 1e-300)
    stuck = (sine < HALF_TURN) & (cosine < 0.0)
    if stuck.any():
        w[:, stuck] = np.array([np.pi, 0.0, 0.0])[:, None]
    return np.ascontiguousarray(e.T)
