"""Double roots to full digits: the configuration at which two solutions merge.

Statement. Near a configuration q at which two solutions of F(q) = 0 (the pose is the target) merge, find it exactly.
Derivation. Newton's method on F converges linearly there and stops some 1e-8 to 1e-6 off, as F grows with the square
of the distance along the null vector v of the Jacobian J. The system

    F(q) + μ u = 0,    σ(q) = uᵀ J(q) v = 0

in q and μ is regular at a fold: σ, the least singular value with its sign, has the gradient
∂σ/∂q_i = Σ_{j>i} v_j u · [S_i, S_j] for the twists S_j of the joints, and along v that is what makes the fold, not 0.
Newton's method on it converges quadratically, and |μ| is how far the target lies from the fold: at 0 there is one
double solution, on one side of it there are two, 2 √(|μ| / curvature) apart, and on the other none.
An arm of n joints has 7 - n vectors u that no joint feels to first order; the one that the arm can move along to
second order is taken, the part of P(v) = Σ_{i<j} [S_i, S_j] v_i v_j at right angles to the columns of J.
Degenerate case. Where P(v) has no such part there is no simple fold: a self-motion, or three solutions merge. Where a
shoulder and a wrist are both at a fold there are two null vectors, and four solutions merge. Such roots solve the
same equations with all null vectors v_b and all left ones u_a,

    F(q) + Σ μ_a u_a = 0,    u_aᵀ J(q) v_b = 0,    and u_aᵀ P(v) = 0 where there is one v,

more equations than unknowns, all of which a true multiple root satisfies: Gauss and Newton's steps.
Reference: W. J. F. Govaerts, "Numerical Methods for Bifurcations of Dynamical Equilibria", SIAM 2000, chapters 3 and 4.

Here x are joint values [rad | size] and lengths are in the arm's size.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from robokin.arrays import Array, Flags
from robokin.inverse.self_motion.pose_correction import errors, scale_of
from robokin.inverse.self_motion.tangent_cone import brackets
from robokin.kernel.chain import Chain

STEPS = 12
"""Steps at most; from 1e-3 four are enough."""

BEND = 1e-4
"""The part of P(v) [size and rad per rad²] below which a seed may be on a self-motion, where it is zero: a seed that is
off by 1e-6 changes it by as much."""

SLIGHT_BEND = 1e-8
"""The same where the seed is known not to be on a self-motion."""

FAR = 0.05
"""A fold farther from its seed [rad | size] is another one."""

DOUBLE = 1e-12
"""|μ| [size and rad] up to which the target is at the fold itself: the rounding of the pose of a long arm. Two
solutions at this distance would be 1e-6 apart, which is what their joint values are known to."""


MULTIPLE_STEPS = 25
"""Steps at most to a root of more solutions; some six are usual from 1e-4."""

MULTIPLE_FAR = 1e-2
"""A root of more solutions farther from its seed [rad | size] is another one: where three merge Newton's method stops
some 1e-4 off."""

CUT = 1e-7
"""Singular values of these equations below this are zero; those of a multiple root are of the size of its forms."""

DIFFERENCE = 1e-4
"""Step of the differences that give the slope of P(v) [rad | size]; it only decides how fast the steps converge."""


class Fold(NamedTuple):
    """Folds near seeds.

    q: (s, n) [rad | m]; mu: (s,) the target's distance from each [size and rad]; double: (s,) whether the target is
    at the fold, which then is the solution, to full digits. Where no fold was found q is the seed and mu infinite.
    """

    q: Array
    mu: Array
    double: Flags


def to_fold(chain: Chain, T: Array, q: Array, size: float, least_bend: float = BEND) -> Fold:
    """The folds near seeds q (s, n) [rad | m] for targets T (s, 4, 4) or (4, 4)."""
    if not len(q):
        return Fold(q, np.zeros(0), np.zeros(0, dtype=bool))
    scale = scale_of(chain, size)
    T = np.broadcast_to(T, (len(q), 4, 4))
    seeds = q / scale
    x, mu = seeds.copy(), np.zeros(len(q))
    fine = np.ones(len(q), dtype=bool) if chain.n <= 6 else np.zeros(len(q), dtype=bool)
    change = np.full(len(q), np.inf)
    for _ in range(STEPS):
        rows = np.flatnonzero(fine & (change > 1e-15))
        if not len(rows):
            break
        e, J = errors(chain, T[rows], x[rows], size)
        u, sigma, slope, bend = _least(J)
        A = np.zeros((len(rows), 7, chain.n + 1))
        A[:, :6, :-1], A[:, :6, -1], A[:, 6, :-1] = J, u, slope
        b = np.concatenate([e, -sigma[:, None]], axis=1)
        step = _solved(A, b)
        dx = step[:, :-1]
        size_of_step = np.max(np.abs(dx), axis=1)
        x[rows] += dx
        mu[rows] = np.abs(step[:, -1])
        off = np.max(np.abs(x[rows] - seeds[rows]), axis=1)
        fine[rows] = (bend > least_bend) & (off <= FAR)
        # Rounding ends it: a step that is no shorter than the last, near zero, gains nothing.
        change[rows] = np.where((size_of_step < 1e-12) & (size_of_step >= 0.5 * change[rows]), 0.0, size_of_step)
    fine &= change <= 1e-10
    return Fold(np.where(fine[:, None], x * scale, q), np.where(fine, mu, np.inf), fine & (mu <= DOUBLE))


def _least(J: Array) -> tuple[Array, Array, Array, Array]:
    """The fold's u (s, 6), σ (s,), its gradient (s, n) and the length of P(v)'s part (s,), for J (s, 6, n)."""
    n = J.shape[2]
    U, _, Vt = np.linalg.svd(J)
    v = Vt[:, n - 1]
    B = brackets(J)
    both = (v[:, :, None] * v[:, None]).reshape(len(v), 1, n * n)
    P = (both @ B.reshape(len(v), n * n, 6))[:, 0]
    # What is left of P(v) at right angles to the other columns' span, which the n - 1 greatest values belong to.
    left = U[:, :, n - 1 :]
    part = np.einsum("sck,skm->scm", left, np.einsum("skm,sk->sm", left, P)[:, :, None])[:, :, 0]
    bend = np.linalg.norm(part, axis=1)
    u = part / np.maximum(bend, 1e-300)[:, None]
    sigma = np.einsum("sk,skj,sj->s", u, J, v)
    slope = np.einsum("sij,sj->si", (B.reshape(len(v), n * n, 6) @ u[:, :, None]).reshape(len(v), n, n), v)
    return u, sigma, slope, bend


def _solved(A: Array, b: Array) -> Array:
    """Least squares for A (s, 7, k), which has full rank at a fold."""
    U, values, Vt = np.linalg.svd(A, full_matrices=False)
    inverse = np.where(values > 1e-13, 1.0 / np.maximum(values, 1e-13), 0.0)
    return np.asarray((((b[:, None, :] @ U)[:, 0] * inverse)[:, None, :] @ Vt)[:, 0])


def to_multiple_roots(chain: Chain, T: Array, q: Array, size: float, null: int) -> tuple[Array, Flags]:
    """The configurations (s, n) at which several solutions for T (s, 4, 4) merge, near q (s, n) [rad | m].

    null: the dimension of the null space at all q. The seeds must not be on a self-motion. Also (s,) whether such a
    root was found; where none was, the configuration says nothing.
    """
    scale = scale_of(chain, size)
    seeds, n = q / scale, chain.n
    x, found, last = seeds.copy(), np.ones(len(q), dtype=bool), np.full(len(q), np.inf)
    on = np.arange(len(q))
    for _ in range(MULTIPLE_STEPS):
        if not len(on):
            break
        e, J = errors(chain, T[on], x[on], size)
        U, V, level, slope = _level(J, null)
        if null == 1:
            third, third_slope = _third(chain, T[on], x[on], size, U, V)
            level, slope = np.concatenate([level, third], axis=1), np.concatenate([slope, third_slope], axis=1)
        A = np.zeros((len(on), 6 + level.shape[1], n + U.shape[2]))
        A[:, :6, :n], A[:, :6, n:], A[:, 6:, :n] = J, -U, slope
        step = _shortest(A, np.concatenate([e, -level], axis=1))[:, :n]
        x[on] += step
        length = np.max(np.abs(step), axis=1)
        away = np.max(np.abs(x[on] - seeds[on]), axis=1)
        found[on] = ~((length > MULTIPLE_FAR) | (away > MULTIPLE_FAR))
        arrived = (length < 1e-14) | ((length < 1e-11) & (length >= 0.5 * last[on]))
        last[on] = length
        on = on[found[on] & ~arrived]
    rows = np.flatnonzero(found)
    if not len(rows):
        return x * scale, found
    e, J = errors(chain, T[rows], x[rows], size)
    level = _level(J, null)[2]
    found[rows] = np.maximum(np.max(np.abs(e), axis=1), np.max(np.abs(level), axis=1)) <= DOUBLE
    return x * scale, found


def _shortest(A: Array, b: Array) -> Array:
    """Least squares for A (s, k, n), singular values below `CUT` of the greatest left out."""
    U, values, Vt = np.linalg.svd(A, full_matrices=False)
    kept = np.where(values > CUT * values[:, :1], 1.0 / np.maximum(values, 1e-300), 0.0)
    return np.asarray((((b[:, None, :] @ U)[:, 0] * kept)[:, None, :] @ Vt)[:, 0])


def _level(J: Array, null: int) -> tuple[Array, Array, Array, Array]:
    """U (s, 6, m), V (s, n, null), the values u_aᵀ J v_b (s, m · null) and their slopes (s, m · null, n)."""
    s, _, n = J.shape
    left, _, Vt = np.linalg.svd(J)
    U, V = left[:, :, n - null :], np.swapaxes(Vt[:, n - null :], 1, 2)
    # u_a · [S_i, S_j] v_b
    slope = (brackets(J).reshape(s, n * n, 6) @ U).reshape(s, n, n, -1)
    slope = np.einsum("sija,sjb->sabi", slope, V)
    return U, V, (np.swapaxes(U, 1, 2) @ J @ V).reshape(s, -1), slope.reshape(s, -1, n)


def _third(chain: Chain, T: Array, x: Array, size: float, U: Array, V: Array) -> tuple[Array, Array]:
    """u_aᵀ P(v) (s, m) for one null vector, and its slopes (s, m, n) by differences."""
    s, n = x.shape
    moved = DIFFERENCE * np.concatenate([np.zeros((1, n)), np.eye(n), -np.eye(n)])
    around = (x[:, None] + moved).reshape(-1, n)
    _, J = errors(chain, np.repeat(T, 2 * n + 1, axis=0), around, size)
    # The null vector of each, and a left one that varies with it as little as can be.
    left, _, Vt = np.linalg.svd(J)
    v = Vt[:, n - 1]
    v = v * np.sign(np.einsum("si,si->s", v, np.repeat(V[:, :, 0], 2 * n + 1, axis=0)))[:, None]
    kept = left[:, :, n - 1 :]
    u = kept @ (np.swapaxes(kept, 1, 2) @ np.repeat(U, 2 * n + 1, axis=0))
    P = ((v[:, :, None] * v[:, None]).reshape(len(v), 1, n * n) @ brackets(J).reshape(len(v), n * n, 6))[:, 0]
    value = np.einsum("ska,sk->sa", u, P).reshape(s, 2 * n + 1, -1)
    return value[:, 0], np.swapaxes(value[:, 1 : n + 1] - value[:, n + 1 :], 1, 2) / (2.0 * DIFFERENCE)
