"""How far a pose is from a target, with slope and curvature, and the way down from there within joint limits.

Statement. For targets with position t and orientation R*, and a weight w >= 0, let

    f(q) = ½ |p(q) - t|² + w (1 - cos θ(q)),      θ the angle between R(q) and R*,

lengths in the arm's size. Find a local minimum of f within limits low <= q <= high, for many starts at once.
Derivation. 1 - cos θ = ½ (3 - tr M) with M = R R*ᵀ; it rises with θ and is smooth everywhere, half a turn
included. With the axis z_i of joint i, J_i its column of the position's Jacobian, ω_i = z_i (0 for a sliding
joint), e = p - t and a half the vector of the skew part of M, and i <= j counted from the base,

    ∂f/∂q_i      = J_i · e + w ω_i · a
    ∂²f/∂q_i∂q_j = J_j · (J_i + e × ω_i) + ½ w ω_j · (tr M ω_i - Mᵀ ω_i)

because joint i turns all that joint j does: ∂J_j/∂q_i = ω_i × J_j, ∂ω_j/∂q_i = ω_i × ω_j. Each step solves
(H + λ I) dq = -g with these exact second derivatives, so that it converges quadratically also where an error
remains, and where an arm is stretched towards its target and has no first-order motion left. λ is raised
until the matrix is positive definite (its L D Lᵀ factors say so) and then by how well the quadratic model foretold
what the step gained (H. B. Nielsen, "Damping parameter in Marquardt's method", IMM-REP-1999-05, Technical
University of Denmark, 1999; J. J. Moré, D. C. Sorensen, "Computing a trust region step", SIAM J. Sci. Stat.
Comput. 4(3), 1983, for why a damped step is one within a region of trust). A joint at a limit that the slope
pushes outwards takes no part in a step, and a step ends at the limits (D. P. Bertsekas, "Projected Newton
methods for optimization problems with simple constraints", SIAM J. Control Optim. 20(2), 1982).
Degenerate case. Where joints may trade motion at no cost H is singular; a least λ keeps them nearly still.
At a target exactly at the edge of the reach f is quartic and each step takes a third of the way that is left.

Arrays have the starts last, (n, s), and are only added and multiplied start by start: what one start comes to
does not depend on which others are beside it, to the last digit.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.kernel.chain import Chain
from robokin.kernel.damped_newton import Judged, Known, Trial, held_at, led_down, solved
from robokin.kernel.frames import pose
from robokin.kernel.geometric_jacobian import Motion, crossed, motion
from robokin.kernel.native_kernel import handle, native

STEP = 0.6
"""Longest step of a joint [rad | size]: about as far as a quadratic model of a turn means anything. What has slid
further than a size may slide by this part of that."""

CAUTION = 0.1
"""λ at first, as a part of w: not above the curvature of what only w lets move, or it would hardly move."""

LEAST = 1e-14
"""Least λ: above the rounding of H, far below the curvatures that matter."""

PIVOT = 1e-16
"""What a pivot must be above: the rounding of H."""

INDEFINITE = 0.03
"""λ tried first where H has a negative curvature, as a part of the greatest that it can have: |e| + w."""

TRIES = 4
"""How often λ is raised within a step, eightfold, before the step is given up."""

SHRINK = 0.25
"""λ's factor after a step that went as foretold."""

NOISE = 1e-15
"""Rounding of f, as a part of it: near a minimum that is not zero, f cannot judge a step any more."""

STUCK = 1e8
"""λ at which no step is worth anything: rounding is all that is left."""

HOPELESS = 1e20
"""Greatest λ: starts that are stuck wait for others and must not overflow."""


class Slope(NamedTuple):
    """f's parts ½|p - t|² [size²] and 1 - cos θ, each (s,), f (s,), its gradient (n, s) and Hessian (n, n, s)."""

    place: Array
    turn: Array
    f: Array
    gradient: Array
    hessian: Array


def slope(chain: Chain, T: Array, x: Array, size: float, weight: Array) -> Slope:
    """f and its derivatives at x: (n, s) [rad | size].

    T: (4, 3, s) the targets' columns x, y, z, p [m]; weight: w (s,).
    """
    J, z, R = _motion(chain, x, size)
    w = np.where(chain.revolute[:, None, None], z, 0.0)
    e = (R[3] - T[3]) / size
    M = R[0, :, None] * T[0] + R[1, :, None] * T[1] + R[2, :, None] * T[2]
    trace = M[0, 0] + M[1, 1] + M[2, 2]
    a = 0.5 * np.stack([M[2, 1] - M[1, 2], M[0, 2] - M[2, 0], M[1, 0] - M[0, 1]])
    D = R[:3] - T[:3]
    place, turn = 0.5 * _dot(e, e), 0.25 * (_dot(D[0], D[0]) + _dot(D[1], D[1]) + _dot(D[2], D[2]))
    U = J + crossed(e, w)
    V = (0.5 * weight) * (trace * w - (w[:, 0, None] * M[0] + w[:, 1, None] * M[1] + w[:, 2, None] * M[2]))
    H = np.zeros((chain.n, *x.shape))
    for left, right in ((U, J), (V, w)):
        for row in range(3):
            H += left[:, None, row] * right[:, row]
    for i in range(1, chain.n):
        H[i, :i] = H[:i, i]
    return Slope(place, turn, place + weight * turn, _dot(J, e) + weight * _dot(w, a), H)


def go_down(
    chain: Chain,
    T: Array,
    x: Array,
    size: float,
    limits: tuple[Array, Array],
    weight: Array,
    *,
    steps: int,
    still: float,
    least: float = LEAST,
) -> tuple[Array, Array, Array]:
    """Where x: (n, s) [rad | size] comes to in some steps, and ½|p - t|² [size²] and 1 - cos θ there, each (s,).

    T: (4, 3, s) the targets' columns [m]; limits: (n, 1) or (n, s) twice [rad | size]; weight: w (s,); still: a
    step [rad | size] that ends the way; least: the least λ.
    """
    known = handle(chain)
    if native is None or known is None or chain.n > native.most_moved:
        return go_down_by_columns(chain, T, x, size, limits, weight, steps=steps, still=still, least=least)
    low, high = limits
    ends, parts = native.gone_down(known, T.reshape(12, -1).T, x.T, size, low.T, high.T, weight, steps, still, least)
    return np.ascontiguousarray(ends.T), parts[:, 0].copy(), parts[:, 1].copy()


def go_down_by_columns(
    chain: Chain,
    T: Array,
    x: Array,
    size: float,
    limits: tuple[Array, Array],
    weight: Array,
    *,
    steps: int,
    still: float,
    least: float = LEAST,
) -> tuple[Array, Array, Array]:
    """`go_down` in Python."""
    low, high = limits

    def look(rows: Index, x: Array) -> Known:
        return slope(chain, _of(T, rows), x, size, _of(weight, rows))

    def step(rows: Index, x: Array, here: Known, trust: Known) -> Trial:
        bounds = _of(low, rows), _of(high, rows)
        known, damping, growth = Slope(*here), *trust
        held = held_at(x, *bounds, -known.gradient)
        unit = np.where(chain.revolute[:, None], 1.0, np.maximum(np.abs(x), 1.0))
        wish, damping, definite = _step(known, held, damping, _of(weight, rows), unit)
        ahead = np.minimum(np.maximum(x + wish, bounds[0]), bounds[1])
        return Trial(ahead, (damping, growth), notes=(_greatest(wish), definite))

    def judge(x: Array, here: Known, there: Known, trial: Trial) -> Judged:
        now, after, dx = Slope(*here), Slope(*there), trial.x - x
        (damping, growth), (longest, definite) = trial.trust, trial.notes
        foretold = -_sum(dx * (now.gradient + 0.5 * _product(now.hessian, dx)))
        noise = NOISE * now.f + np.finfo(float).tiny
        ratio = (now.f - after.f + noise) / (np.maximum(foretold, 0.0) + noise)
        taken = definite & (after.f <= now.f + noise) & (ratio > 1e-4)
        shrunk = np.maximum(SHRINK, 1.0 - (2.0 * np.clip(ratio, 0.0, 1.0) - 1.0) ** 3)
        damping = np.clip(np.where(taken, shrunk, growth) * damping, least, HOPELESS)
        growth = np.where(taken, 4.0, 2.0 * growth)
        return Judged(taken, (damping, growth), (taken & (longest < still)) | (damping > STUCK))

    x = np.minimum(np.maximum(x, low), high)
    trust = CAUTION * weight + least, np.full(x.shape[1], 4.0)
    x, place, turn = led_down(look, step, judge, x, trust, steps=steps, told=2, axis=-1)
    return x, place, turn


def _step(here: Slope, held: Flags, damping: Array, weight: Array, unit: Array) -> tuple[Array, Array, Flags]:
    """The damped Newton step (n, s) of the joints that are not held, λ (s,), and where the matrix was definite.

    unit: (n, s) what joint moves are counted in [rad | size].
    """
    n = len(held)
    free = np.where(held[:, None] | held, 0.0, here.hessian)
    right = np.where(held, 0.0, -here.gradient)
    for _ in range(TRIES):
        A = free.copy()
        A.reshape(n * n, -1)[:: n + 1] += np.where(held, 1.0, damping)  # its diagonal
        dx, definite = solve_definite(A, right)
        if definite.all():
            break
        more = np.maximum(8.0 * damping, INDEFINITE * (np.sqrt(2.0 * here.place) + weight))
        damping = np.where(definite, damping, more)
    dx = np.where(definite, dx, 0.0)
    return dx * (STEP / np.maximum(_greatest(dx / unit), STEP)), damping, definite


def solve_definite(A: Array, b: Array) -> tuple[Array, Flags]:
    """x with A x = b, for A: (n, n, s) symmetric, overwritten, and b: (n, s); and where A is positive definite.

    That is where its pivots are above rounding; elsewhere x means nothing.
    """
    # What is not positive is made infinite: nothing is taken from the rows below it, and nothing grows.
    x, pivots, _ = solved(A, b, lambda pivot: np.where(pivot > PIVOT, pivot, np.inf))
    definite: Flags = np.all(np.isfinite(pivots), axis=0)
    return x, definite


def _motion(chain: Chain, x: Array, size: float) -> Motion:
    """How the tool moves at x: (n, s) [rad | size]."""
    q = x if chain.revolute.all() else np.where(chain.revolute[:, None], x, x * size)
    return motion(chain, q, size)


def place_jacobian(chain: Chain, x: Array, size: float) -> Array:
    """∂p/∂x (n, 3, s) [size] at x: (n, s) [rad | size]."""
    known = handle(chain)
    if native is None or known is None:
        return _motion(chain, x, size).linear
    J: Array = native.jacobian(known, _values(chain, x, size), size, False)
    return J[:, :3].transpose(2, 1, 0)


def offsets(chain: Chain, T: Array, x: Array, size: float) -> Array:
    """p - t (3, s) [size] at x: (n, s) [rad | size], for targets T: (4, 3, s) [m]."""
    known = handle(chain)
    p = _motion(chain, x, size).tool[3] if known is None else pose(chain, _values(chain, x, size))[:, :3, 3].T
    away: Array = (p - T[3]) / size
    return away


def _values(chain: Chain, x: Array, size: float) -> Array:
    """x (n, s) [rad | size] as joint values (s, n) [rad | m]."""
    return np.ascontiguousarray((x if chain.revolute.all() else np.where(chain.revolute[:, None], x, x * size)).T)


def _of(part: Array, rows: Index) -> Array:
    """What some of the starts, in order, have of (..., s), or what they all share, (..., 1)."""
    return part if part.shape[-1] in (1, len(rows)) else part[..., rows]


def _dot(u: Array, v: Array) -> Array:
    """u · v of (..., 3, s), the components next to last."""
    return u[..., 0, :] * v[..., 0, :] + u[..., 1, :] * v[..., 1, :] + u[..., 2, :] * v[..., 2, :]


def _sum(u: Array) -> Array:
    """The sum (s,) of the rows of (n, s), one after the other."""
    total: Array = u[0].copy()
    for row in u[1:]:
        total += row
    return total


def _product(A: Array, u: Array) -> Array:
    """A u of A: (n, n, s) and u: (n, s), column after column."""
    product: Array = A[:, 0] * u[0]
    for j in range(1, len(u)):
        product += A[:, j] * u[j]
    return product


def _greatest(u: Array) -> Array:
    """The greatest absolute value (s,) in the columns of (n, s)."""
    greatest: Array = np.max(np.abs(u), axis=0)
    return greatest
