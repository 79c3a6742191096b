"""Configurations near those that reach a pose, brought onto these by Newton steps of the shortest length.

Statement. Given x near the curves, surfaces or points of configurations that reach T, find one that does, near by, and
with a plane that it shall stay in, if one is given.
Derivation. Newton's steps on the error with the shortest solution of J dx = e: singular values that are zero take no
part, so that x hardly moves along the set. Most steps come from the normal equations, which have the digits where no
singular value is small.
Degenerate case. At a double root each step halves the distance and leaves a fourth of the error: then twice the step
goes there.
Not `damped_newton.brought_down`: damping would draw x along the set, and what counts is the last step that is not
rounding, not the least error.
Reference: E. L. Allgower, K. Georg, "Introduction to Numerical Continuation Methods", SIAM 2003, chapters 2, 8.

Here x are joint values [rad | size] and lengths are in the arm's size.
"""

from __future__ import annotations

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.kernel.chain import Chain
from robokin.kernel.damped_newton import limited
from robokin.kernel.native_kernel import handle, native
from robokin.kernel.ranks import ROOT_RANK
from robokin.kernel.residual import error_and_jacobian

SETTLED = 1e-13
"""Error [size and rad] at which Newton steps end: some hundred times the rounding of the pose."""

CLOSES = 5e-10
"""The greatest part of the error [size and rad] up to which a configuration reaches the pose: its length is then below
1e-9, which a solution may have. A pose that was printed and read again is off by as much."""

STEPS = 8
"""Newton steps of a correction at most: three do on a curve, as the error is squared each time."""

SLOW_STEPS = 40
"""The same where the solutions count twice along a curve: each step halves the error, from 1e-3 to below 1e-10."""

IDLE, IDLE_STEPS = 0.02, 4
"""Newton steps end after so many in a row by which the error changed by less than this part of itself."""

LONGEST = 0.3
"""The longest Newton step of a joint [rad | size]: farther off the tangent says nothing of the curve."""

PLAIN = 1e-3
"""Least singular value from which a step may come from the normal equations: it is then off by a millionth of itself at
most, and the next step makes up for that."""

TRIFLE = 1e-13
"""What is added to the diagonals of normal equations, as a part of their sum: some hundred times the rounding."""

NO_TRIFLE = 1e4
"""How many times that the square of a singular value must be: the trifle then changes a step by 1e-4 at most."""


def scale_of(chain: Chain, size: float) -> Array:
    """(n,) what joint values q are divided by [1 | m] to be x."""
    return np.where(chain.revolute, 1.0, size)


def errors(chain: Chain, T: Array, x: Array, size: float) -> tuple[Array, Array]:
    """The error (s, 6) against poses T: (s, 4, 4) and the Jacobian (s, 6, n) at x (s, n) [rad | size]."""
    return error_and_jacobian(chain, T, x * scale_of(chain, size), size)


def least_squares(A: Array, b: Array, zero: float = ROOT_RANK) -> Array:
    """(s, n) the shortest solution of A (s, m, n) dx = b (s, m), singular values up to `zero` left out.

    Where none is below `PLAIN` the normal equations have the digits that a Newton step needs, and take a tenth of the
    time that singular values take.
    """
    if native is not None and 0 < A.shape[1] <= 7 and 0 < A.shape[2] <= native.most_moved:
        shortest: Array = native.shortest(A, b, zero)
        return shortest
    wide = A.shape[1] < A.shape[2]
    At = np.swapaxes(A, 1, 2)
    inverse, plain = normal_inverse(A @ At if wide else At @ A)
    side = b[:, :, None]
    dx: Array = (At @ (inverse @ side) if wide else inverse @ (At @ side))[:, :, 0]
    if not plain.all():
        rest = np.flatnonzero(~plain)
        U, values, Vt = np.linalg.svd(A[rest], full_matrices=False)
        kept = np.where(values > zero, 1.0 / np.maximum(values, zero), 0.0)
        along = (b[rest][:, None, :] @ U)[:, 0] * kept
        dx[rest] = (along[:, None, :] @ Vt)[:, 0]
    return dx


def normal_inverse(G: Array) -> tuple[Array, Flags]:
    """G⁻¹ (s, k, k) for G = AᵀA or A Aᵀ, and (s,) whether no singular value of A is below `PLAIN`.

    Where one is, what stands there is no inverse.
    """
    # An exactly singular matrix would stop all: a trifle on the diagonal, above rounding, keeps off zero pivots.
    trifle = TRIFLE * np.einsum("sii->s", G) + TRIFLE
    inverse = np.linalg.inv(G + trifle[:, None, None] * np.eye(G.shape[1]))
    # The greatest singular value of an inverse is at most its Frobenius norm. Beside long slides the trifle is none.
    least = np.maximum(PLAIN**2, NO_TRIFLE * trifle)
    plain = np.einsum("sij,sij->s", inverse, inverse) * least * least < 1.0
    return inverse, plain


def corrected(
    chain: Chain,
    T: Array,
    x: Array,
    size: float,
    normals: Array | None = None,
    steps: int | Index = STEPS,
    settled: float = SETTLED,
    zero: float = ROOT_RANK,
) -> tuple[Array, Array, Array]:
    """Newton steps from x (s, n) onto the configurations that reach T: (s, 4, 4).

    normals: (s, k, n), directions that x keeps its place along; steps: at most, of all or of each (s,); settled: the
    error at which steps end; zero: what a singular value must exceed to count. Returns x (s, n)
    [rad | size], the greatest part of the error left (s,) and the Jacobian there (s, 6, n).
    """
    known = handle(chain)
    if native is None or known is None or chain.n > native.most_moved:
        return corrected_by_rows(chain, T, x, size, normals, steps, settled, zero)
    extra = 0 if normals is None else normals.shape[1]
    rows = np.zeros((len(x), 0)) if normals is None else normals
    most = np.broadcast_to(np.asarray(steps, dtype=np.float64), len(x))
    ends: tuple[Array, Array, Array] = native.corrected(known, T, rows, extra, most, x, size, settled, zero)
    return ends


def corrected_by_rows(
    chain: Chain,
    T: Array,
    x: Array,
    size: float,
    normals: Array | None,
    steps: int | Index,
    settled: float,
    zero: float,
) -> tuple[Array, Array, Array]:
    """`corrected` in Python."""
    e, J = errors(chain, T, x, size)
    off = np.max(np.abs(e), axis=1)
    rows = np.flatnonzero(off > settled)
    many = np.broadcast_to(np.asarray(steps), len(off))[rows]
    if not len(rows):
        return x, off, J
    x = np.array(x)
    # What is still moved, by its rows: x, T, the equations and what the error was.
    here, target, before = x[rows], T[rows], off[rows]
    extra = 0 if normals is None else normals.shape[1]
    A, b = np.zeros((len(rows), 6 + extra, x.shape[1])), np.zeros((len(rows), 6 + extra))
    A[:, :6], b[:, :6] = J[rows], e[rows]
    if normals is not None:
        A[:, 6:] = normals[rows]
    factor, idle = np.ones(len(rows)), np.zeros(len(rows), dtype=np.intp)
    for step in range(1, int(np.max(many)) + 1):
        dx = limited(least_squares(A, b, zero), LONGEST)
        new = here + dx * factor[:, None]
        e_new, J_new = errors(chain, target, new, size)
        after = np.max(np.abs(e_new), axis=1)
        # Once close, a step that gains nothing is rounding; it would only wander.
        better = (after < before) | (before > CLOSES)
        whole = bool(better.all())
        went = rows if whole else rows[better]
        x[went], off[went], J[went] = (new, after, J_new) if whole else (new[better], after[better], J_new[better])
        # At a double root each step halves the distance and leaves a fourth of the error: twice the step goes there.
        double = (after > 0.2 * before) & (after < 0.3 * before)
        # What is left of an error in directions that are left out stays as it is.
        idle = np.where(np.abs(after - before) < IDLE * before, idle + 1, 0)
        on = np.where(better, (after > settled) & (idle < IDLE_STEPS), factor > 1.0) & (step < many)
        factor = np.where(double, 2.0, 1.0)
        if whole:
            here, before = new, after
            A[:, :6], b[:, :6] = J_new, e_new
        else:
            here, before = np.where(better[:, None], new, here), np.where(better, after, before)
            A[better, :6], b[better, :6] = J_new[better], e_new[better]
        if not on.all():
            if not on.any():
                break
            rows, here, target, before = rows[on], here[on], target[on], before[on]
            A, b, factor, idle, many = A[on], b[on], factor[on], idle[on], many[on]
    return x, off, J
