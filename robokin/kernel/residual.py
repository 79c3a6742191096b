"""What a chain's pose lacks of a target, and how that changes with the joint values.

Statement. Give the difference of the poses of a chain from targets, and the Jacobian there, for one configuration, a
handful or some thousands.
Derivation. A joint and the constant after it, J(q) C, are linear in (1, cos q, sin q, q): all joints' matrices come
from one product, and n products of matrices (4, 4) follow. For ten configurations the interpreter's share of the work
is what counts. For hundreds all go through the chain at once (`sweep`).
With the columns r_k of the rotation that is found and t_k of the one that is wished for the vector of the skew part of
their difference is ½ Σ r_k × t_k.
Degenerate case. None.
"""

from __future__ import annotations

import numpy as np

from robokin.arrays import Array, Index
from robokin.kernel.chain import Chain
from robokin.kernel.columns import BLOCK
from robokin.kernel.facts import fact
from robokin.kernel.frames import program_to_tool
from robokin.kernel.geometric_jacobian import CROSS
from robokin.kernel.native_kernel import handle, native
from robokin.kernel.sweep import sweep

FEW = 80
"""Configurations up to which a product of matrices for each takes less time."""

TOGETHER = 1000
"""Configurations at a time: their numbers stay in the second-level cache."""

HALF_TURN = 1e-9
"""Sine of the angle error below which, with a negative cosine, the error is half a turn and has no direction here."""


@fact
def _joint_parts(chain: Chain) -> Array:
    """(n, 4, 16) the entries of J(q) C as multiples of 1, cos, sin and q."""
    one, cosine, sine, slide = (np.zeros((chain.n, 4, 4)) for _ in range(4))
    turns = chain.revolute.astype(np.float64)
    one[:, (2, 3), (2, 3)] = 1.0
    one[:, (0, 1), (0, 1)] = 1.0 - turns[:, None]
    cosine[:, (0, 1), (0, 1)] = turns[:, None]
    sine[:, 0, 1], sine[:, 1, 0] = -turns, turns
    slide[:, 2, 3] = 1.0 - turns
    matrices = np.stack([one, cosine, sine, slide], axis=1) @ chain.constants[1:, None]
    return np.ascontiguousarray(matrices.reshape(chain.n, 4, 16))


def error_and_jacobian(chain: Chain, T: Array, q: Array, size: float) -> tuple[Array, Array]:
    """The error (..., 6) of the poses at q (..., n) [rad | m] against T (..., 4, 4), and the Jacobian (..., 6, n).

    Lengths, also those of prismatic joints, are in sizes; both are in the base's axes.
    """
    if q.ndim != 2:
        before = q.shape[:-1]
        e, J = error_and_jacobian(chain, T.reshape(-1, 4, 4), q.reshape(-1, chain.n), size)
        return e.reshape(*before, 6), J.reshape(*before, 6, chain.n)
    known = handle(chain)
    if native is not None and known is not None:
        both: tuple[Array, Array] = native.errors(known, T, q, size)
        return both
    return errors_by_columns(chain, T, q, size)


def errors_by_columns(chain: Chain, T: Array, q: Array, size: float) -> tuple[Array, Array]:
    """`error_and_jacobian` for q (s, n) and T (s, 4, 4), in Python."""
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
    (z, o), end = sweep(
        chain.constants[1:], chain.revolute, np.ascontiguousarray((q + chain.offsets).T), chain.constants[0]
    )
    z, lever = z.transpose(1, 0, 2), (end[3] - o).transpose(1, 0, 2)
    lever /= size
    J = np.empty((6, *z.shape[1:]))
    for k, (a, b) in enumerate(CROSS):
        np.multiply(z[a], lever[b], out=J[k])
        J[k] -= z[b] * lever[a]
    J[3:] = z
    if not chain.revolute.all():
        slides = ~chain.revolute
        J[:3, slides], J[3:, slides] = z[:, slides], 0.0
    return _pose_error(T, end, size), np.ascontiguousarray(J.transpose(2, 0, 1))


def distance_and_angle(error: Array) -> tuple[Array, Array]:
    """The distances (s,), in the errors' lengths, and angles (s,) [rad] of errors (s, 6)."""
    return np.linalg.norm(error[:, :3], axis=1), np.linalg.norm(error[:, 3:], axis=1)


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


class TargetPoses:
    """Forward kinematics of a chain (base, joints, virtual joints, tool) against a block of targets."""

    def __init__(self, chain: Chain, T: Array) -> None:
        self.program = program_to_tool(chain)
        # The twelve entries of each target, column by column, as the program gives them.
        self.targets = np.ascontiguousarray(T[:, :3].transpose(2, 1, 0)).reshape(12, -1)

    def residuals(self, index: Index, q: Array) -> tuple[Array, Array]:
        """Distances (s,) [m] and angles (s,) [rad] of the poses at q (n, s) from the targets index (s,).

        The angle comes from the chord |R_a - R_b| = 2 √2 sin(angle / 2), which keeps all digits of small
        ones; up to 1e-8 it is chord / √2 to the last digit, and beyond that its size does not matter here.
        """
        position, angle = np.empty(len(index)), np.empty(len(index))
        off = np.empty((12, min(BLOCK, len(index))))
        for start in range(0, len(index), BLOCK):
            part = slice(start, start + BLOCK)
            block = off[:, : len(index[part])]
            self.targets.take(index[part], axis=1, out=block, mode="clip")
            (frame,) = self.program.columns(q[:, part])
            for row, entry in zip(block, (entry for column in frame for entry in column), strict=True):
                row -= entry
            block *= block
            block[:9].sum(axis=0, out=angle[part])
            block[9:].sum(axis=0, out=position[part])
        angle *= 0.5
        return np.sqrt(position, out=position), np.sqrt(angle, out=angle)
