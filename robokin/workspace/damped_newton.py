"""Newton's step for the squared distance of many configurations at a time, damped, with some joints held."""

from __future__ import annotations

import numpy as np

from robokin.arrays import Array, Flags

FLOOR, LEAST = 1e-2, 1e-11
"""The least pivot, as a part of the distance, and what is always added to it and to the damping [1]."""


def newton_step(J: Array, H: Array, pull: Array, held: Flags, far: Array, mu: Array) -> tuple[Array, Array]:
    """Newton's step (n, m) with some joints held, and what it promises to take off |e|² (m,), infinite where the
    second derivatives are not those of a minimum."""
    n = len(J)
    damping = np.sqrt(far)
    floor = FLOOR * damping + LEAST
    damping *= mu
    damping += LEAST
    y = pull
    if held.any():
        free = np.where(held, 0.0, 1.0)
        J, H, y = J * free[:, None], H * free[:, None], y * free
    else:
        y = y.copy()
    # Only what is on and right of the diagonal counts; it is brought to L D Lᵀ row by row.
    A = H[:, None, 0] * J[None, :, 0]
    A += H[:, None, 1] * J[None, :, 1]
    A += H[:, None, 2] * J[None, :, 2]
    plain = np.ones(len(far), dtype=bool)
    for j in range(n):
        pivot = A[j, j]
        pivot += damping
        plain &= pivot > 0.0
        np.abs(pivot, out=pivot)
        np.maximum(pivot, floor, out=pivot)
        row = A[j, j + 1 :].copy()
        A[j, j + 1 :] /= pivot
        for i in range(j + 1, n):
            A[i, i:] -= A[j, i] * row[i - j - 1 :]
        y[j + 1 :] -= A[j, j + 1 :] * y[j]
    diagonal = A[range(n), range(n)]
    scaled = y / diagonal
    gain = np.sum(scaled * y, axis=0)
    for j in reversed(range(n - 1)):
        scaled[j] -= np.sum(A[j, j + 1 :] * scaled[j + 1 :], axis=0)
    gain[~plain] = np.inf
    return scaled, gain
