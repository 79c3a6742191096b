"""Joints followed for many configurations at once, for real and for complex joint values.

Sines and cosines of complex values keep c² + s² = 1, so that rotations stay orthogonal, R Rᵀ = I without conjugation,
and all that is said of frames and twists holds as it stands. A joint mixes two columns of the frame before it, and
the constant after it all four, of all configurations at once.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from robokin.arrays import Array, Flags
from robokin.kernel.geometric_jacobian import CROSS


def sweep(
    links: Array, revolute: Flags, q: NDArray[Any], first: Array | None = None
) -> tuple[NDArray[Any], NDArray[Any]]:
    """Axes z and o (2, joint, 3, s) of the joints of L0 J1 L1 J2 … at q: (n, s), and its columns X (4, 3, s).

    links: (n, 4, 4) or, if nothing follows the last joint, (n - 1, 4, 4) L1 … ; first: (4, 4) L0, none if it is not
    given. The values and the results are real or complex.
    """
    n, s = q.shape
    axes = np.empty((2, n, 3, s), dtype=q.dtype)
    X = np.zeros((4, 3, s), dtype=q.dtype)
    if first is None:
        X[(0, 1, 2), (0, 1, 2)] = 1.0
    else:
        X[:] = first[:3].T[:, :, None]
    # A slide's value may be so large that its cosine is no number.
    angles = q if revolute.all() else np.where(revolute[:, None], q, 0.0)
    c, sine = np.cos(angles), np.sin(angles)
    turned = np.empty((2, 3, s), dtype=q.dtype)
    for i, turns in enumerate(revolute.tolist()):
        axes[:, i] = X[2:]
        if turns:
            np.multiply(X[:2], c[i], out=turned)
            X[:2] *= sine[i]
            turned[0] += X[1]
            turned[1] -= X[0]
            X[:2] = turned
        else:
            X[3] += q[i] * X[2]
        if i < len(links):
            # Real and imaginary parts are two real columns: half the work of a complex product.
            parts = X.view(np.float64).reshape(4, -1)
            X = (links[i].T @ parts).view(q.dtype).reshape(4, 3, s)
    return axes, X


def twists(axes: NDArray[Any], revolute: Flags) -> NDArray[Any]:
    """The joints' twists (o × z, z) or (z, 0): (joint, 6, s), for axes (2, joint, 3, s)."""
    z, o = axes
    S = np.empty((len(z), 6, z.shape[-1]), dtype=axes.dtype)
    S[:, 3:] = z
    for k, (i, j) in enumerate(CROSS):
        np.multiply(o[:, i], z[:, j], out=S[:, k])
        S[:, k] -= o[:, j] * z[:, i]
    for slides in np.flatnonzero(~revolute):
        S[slides, :3] = z[slides]
        S[slides, 3:] = 0.0
    return S


def skew_part(R: NDArray[Any], out: NDArray[Any]) -> None:
    """Twice the vector of the skew part of rotations whose columns are R (3, 3, s), into out (3, s)."""
    for k, (i, j) in enumerate(CROSS):
        np.subtract(R[i, j], R[j, i], out=out[k])
