"""The roots x and vectors v of M(x) v = 0 for the 12 × 12 matrices of the elimination, by eigenvalues.

M stacks E and y E: its rows are those of a (6, 9) matrix on the products (1, y, y²) × (1, w, w²), once as they are
and once moved by one power of y. Let the rows of M be quadratic, M2 x² + M1 x + M0, or of first degree,
L1 x + L0. With w = x M2 v for the quadratic rows only,

    [L1; M2] (x v) = [-L0 v; w],    x w = -M1 (x v) - M0 v,

so that (v, w) is an eigenvector of a real matrix C, x its eigenvalue, provided that [L1; M2] is regular. Rows B that
are free of x restrict v to their null space first.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from robokin.arrays import Array, Complex, Index

NOTHING = 1e-11
"""A singular value that is less, the greatest being about 1, is zero but for rounding: structure of the arm."""

CLEAR = 1e-3
"""A singular value that is greater is not. What lies between is no structure to build on."""

TOGETHER = 3e-3
"""Roots nearer than this to the next [rad] are told apart by their products. Eigenvectors lose as many digits as
the distance of their roots has zeros; further apart they are good enough for Newton's steps."""

# Ratios in y and w are turned by these angles' cosine and sine, so that none is infinite but by chance.
_TURN_Y = (np.cos(0.4), np.sin(0.4))
_TURN_W = (np.cos(1.1), np.sin(1.1))


@cache
def _jitter() -> Array:
    """A relative error (12, 12) that makes a leading matrix regular where it is exactly singular."""
    return 1e-13 * np.random.default_rng(0).uniform(-1.0, 1.0, (12, 12))


@cache
def _mixture() -> Array:
    """What columns are mixed by (8, 6) before a QR is asked for a rank, lest the first of them depend on each other."""
    return np.random.default_rng(1).normal(size=(8, 6))


class PencilDegrees(NamedTuple):
    """Of six rows: `free` can be made free of θ0, and `paired` complex ones of first degree in half of it."""

    free: int
    paired: int


def degrees(turning: Complex) -> PencilDegrees | None:
    """The degrees of the rows for samples of what turns with joint 0 (k, 6, 4); None where they are not clear-cut."""
    real = np.linalg.svd(np.concatenate([turning.real, turning.imag], axis=-1), compute_uv=False)
    whole = np.linalg.svd(turning, compute_uv=False)
    both = np.concatenate([real, whole], axis=-1) / real[:, :1]
    free, null = (6 - np.sum(values > CLEAR, axis=-1) for values in (real / real[:, :1], whole / real[:, :1]))
    unclear = (both > NOTHING) & (both < CLEAR)
    if np.any(unclear) or np.ptp(free) or np.ptp(null) or 6 - 2 * null[0] + free[0] < 0:
        return None
    return PencilDegrees(int(free[0]), int(null[0] - free[0]))


def of_turning(E: Array, turning: Complex, rows: PencilDegrees) -> tuple[Array, Array | None]:
    """C (b, n, n) for E on 1, cos, sin (b, 3, 6, 9), and the null space (b, 12, k) that v is given in, if any."""
    E1, Ec, Es = E[:, 0], E[:, 1], E[:, 2]
    basis = None
    if rows.free:
        real = np.concatenate([turning.real, turning.imag], axis=-1) @ _mixture()
        Q = np.swapaxes(np.linalg.qr(real)[0], -1, -2)
        free, P = Q[:, 6 - rows.free :], Q[:, : 6 - rows.free]
        B = _twice(free @ E1)
        basis = np.linalg.qr(np.swapaxes(B, -1, -2), mode="complete")[0][..., 2 * rows.free :]
        E1, Ec, Es, turning = P @ E1, P @ Ec, P @ Es, P @ turning
    rest = 6 - rows.free
    at_zero, change = E1 + Ec, Ec - E1
    if rows.paired:
        u = np.linalg.qr(turning, mode="complete")[0][..., rest - rows.paired :]
        u = np.swapaxes(u.conj(), -1, -2)
        U = np.concatenate([u.real, u.imag], axis=1)
        # u E = e^(iθ/2) (cos θ/2 u (E1 + Ec) + i sin θ/2 u (Ec - E1)): its real and imaginary part are rows.
        L0, L1 = U @ at_zero, np.concatenate([-u.imag, u.real], axis=1) @ change
        R = np.linalg.qr(np.swapaxes(U, -1, -2), mode="complete")[0][..., 2 * rows.paired :]
        R = np.swapaxes(R, -1, -2)
    else:
        L0 = L1 = E1[:, :0]
        R = np.eye(rest)
    return _linearised(L1, L0, -R @ change, 2.0 * R @ Es, R @ at_zero, basis), basis


def of_quadratic(E: Array, turns: bool, shift: float) -> tuple[Array, None]:
    """C (b, 24, 24) for E on 1, cos, sin or 1, d, d² (b, 3, 6, 9), whatever the rows' degrees.

    d = tan(atan x + shift): where the arm lets d be infinite, x is not.
    """
    E0, E1, E2 = E[:, 0], E[:, 1], E[:, 2]
    none = E0[:, :0]
    if turns:
        return _linearised(none, none, E0 - E1, 2.0 * E2, E0 + E1, None), None
    c, s = np.cos(shift), np.sin(shift)
    M2 = s * s * E0 - s * c * E1 + c * c * E2
    M1 = -2.0 * s * c * E0 + (c * c - s * s) * E1 + 2.0 * s * c * E2
    return _linearised(none, none, M2, M1, c * c * E0 + s * c * E1 + s * s * E2, None), None


def _linearised(L1: Array, L0: Array, M2: Array, M1: Array, M0: Array, basis: Array | None) -> Array:
    """C (b, n, n) for rows (b, k, 9) of first degree and quadratic ones, v in a basis (b, 12, columns)."""
    stacked = [_twice(rows) for rows in (L1, L0, M2, M1, M0)]
    if basis is not None:
        stacked = [rows @ basis for rows in stacked]
    L1, L0, M2, M1, M0 = stacked
    linear, quadratic, columns = L1.shape[1], M2.shape[1], M2.shape[2]
    lead = np.concatenate([L1, M2], axis=1)
    right = np.zeros((len(lead), columns, columns + quadratic))
    right[:, :linear, :columns] = -L0
    i = np.arange(quadratic)
    right[:, linear + i, columns + i] = 1.0
    try:
        top = np.linalg.solve(lead, right)
    except np.linalg.LinAlgError:
        scale = np.max(np.abs(lead), axis=(1, 2), keepdims=True) + 1e-300
        top = np.linalg.solve(lead + scale * _jitter()[:columns, :columns], right)
    bottom = -M1 @ top
    bottom[..., :columns] -= M0
    return np.concatenate([top, bottom], axis=1)


def _twice(rows: Array) -> Array:
    """Rows (b, k, 9) on the products, and y times them: (b, 2 k, 12)."""
    k = rows.shape[1]
    stacked = np.zeros((len(rows), 2 * k, 12))
    stacked[:, :k, :9] = rows
    stacked[:, k:, 3:] = rows
    return stacked


def eigenvectors(C: Array) -> tuple[Complex, Complex]:
    """Eigenvalues (m, n) and eigenvectors (m, n, n) of matrices (m, n, n); NaN for a matrix that has none to give."""
    sound = np.all(np.isfinite(C), axis=(1, 2))
    if not np.all(sound):
        C = np.where(sound[:, None, None], C, 0.0)
    roots, vectors = _eig(C)
    if not np.all(sound):
        roots[~sound] = np.nan
    return roots, vectors


def _eig(C: Array) -> tuple[Complex, Complex]:
    try:
        roots, vectors = np.linalg.eig(C)
    except np.linalg.LinAlgError:
        # One matrix of the batch did not converge: halve until it stands alone.
        if len(C) == 1:
            return np.full(C.shape[:2], np.nan + 0j), np.zeros(C.shape, dtype=complex)
        halves = [_eig(half) for half in np.array_split(C, 2)]
        return np.concatenate([h[0] for h in halves]), np.concatenate([h[1] for h in halves])
    return np.asarray(roots, dtype=np.complex128), np.asarray(vectors, dtype=np.complex128)


def separated(index: Index, roots: Complex, vectors: Complex) -> tuple[Complex, Complex]:
    """Roots (s,) and vectors (s, 12) of targets index (s,), with those of roots that lie together told apart.

    The eigenvectors of roots that coincide are any combinations V of the products p = (1, y, …) × (1, w, w²) that
    they should be, and nearly so if the roots nearly coincide. But taking from p the products with one power of y
    more, or of w, multiplies it by y or w. So with S and S' taking some products and their multiples, S'V = SV Y
    where Y has the eigenvalues y (here: of a fraction in y and w, lest they be infinite), and its eigenvectors K
    make V K the products themselves. That holds for any set of roots, near or not.
    """
    angle = 2.0 * np.arctan(roots.real)
    order = np.lexsort((angle, index))
    near = (np.diff(index[order]) == 0) & (np.diff(angle[order]) < TOGETHER)
    if not near.any():
        return roots, vectors
    roots, vectors = roots.copy(), vectors.copy()
    first = np.flatnonzero(np.concatenate([[True], ~near]))
    counts = np.diff(np.append(first, len(order)))
    for k in range(2, min(counts.max(), 6) + 1):
        members = order[first[counts == k][:, None] + np.arange(k)]
        if not len(members):
            continue
        V = np.swapaxes(vectors[members], -1, -2)
        P = V.reshape(-1, 4, 3, k)
        (c, s), (e, f) = _TURN_Y, _TURN_W
        whole, over = c * P[:, :-1] + s * P[:, 1:], c * P[:, 1:] - s * P[:, :-1]
        S = e * whole[:, :, :-1] + f * whole[:, :, 1:]
        moved = (e * over[:, :, :-1] + f * over[:, :, 1:]) + (e * whole[:, :, 1:] - f * whole[:, :, :-1])
        Y = np.linalg.pinv(S.reshape(-1, 6, k)) @ moved.reshape(-1, 6, k)
        K = _eig(Y)[1]
        own = np.linalg.pinv(K) @ (roots[members][:, :, None] * K)
        products = np.swapaxes(V @ K, -1, -2)
        # The phase that makes the greatest product real: that of a real solution then is real throughout.
        largest = np.take_along_axis(products, np.argmax(np.abs(products), axis=2)[..., None], axis=2)
        vectors[members] = products * (np.conj(largest) / (np.abs(largest) ** 2 + 1e-300))
        roots[members] = np.diagonal(own, axis1=1, axis2=2)
    return roots, vectors
