"""Newton steps on the loop equation for complex joint values, and how many regular solutions there are among some.

Statement. Six joints have a generic number of complex solutions, the same at almost every target, and no target has
more isolated ones. Counting those that were found tells whether one is missing; for that complex values must be made
exact, and equal ones counted once.
Derivation. Sines and cosines of complex values keep c² + s² = 1, so the rotation of X = J1 L1 … J6 L6 stays
orthogonal, X Xᵀ = I without conjugation, and all of `newton` holds as it stands: S dq = -e with the joints' twists
in S and the error e = (v, w), w the skew part of X's rotation. A solution is regular where S has an inverse.
Degenerate case. The skew part vanishes at half turns as well: what is called the residual counts the trace too, and an
orthogonal matrix of trace 3 without skew part is the identity. Values with large imaginary parts make entries of X
as large as their squared hyperbolic cosines, and its rounding with them: the residual is relative to that.
Where S has no inverse to the last digit the step is the shortest least-squares one.
Reference. A. Morgan, A. Sommese, "Coefficient-parameter polynomial continuation", Applied Mathematics and
Computation 29 (1989): the generic number is an upper bound of that of isolated solutions.

All arrays inside have the candidates last, (…, s), and each operation is on all candidates at once.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robokin.arrays import Array, Complex, Flags, Index
from robokin.inverse.elimination.loop import Loop, columns_of, follow, native_loop, twist_columns
from robokin.kernel.native_kernel import native

TURN = 2.0 * np.pi

STEP = 0.5
"""The longest step of one joint [rad | size]: further off, the tangent says nothing of the curve."""

BLOCK = 1024
"""Candidates at a time: the hundred or so complex numbers of each (1.6 MB) stay in the second-level cache."""

CLOSED = 1e-9
"""Relative residual up to which a candidate is a solution: rounding leaves 1e-15, and some 1e-10 at |Im| near 8."""

REGULAR = 1e-6
"""Least singular value of S above which a solution is regular. Two solutions that meet have values about as small
as they are far apart, so that regular ones are told apart by `APART`; at rounding's 1e-16 a double one has 1e-8."""

SURE = 0.05
"""Greatest residual, as a part of the squared least singular value, that a regular solution's candidate may have. Where
X's second derivatives are of order one Newton's steps converge from 0.5 (Kantorovich's theorem); near a solution where
several meet the residual may be tiny, yet singular values are smaller still."""

APART = 1e-4
"""Solutions that differ by more in some joint [rad | size] are different."""

OUT = 2.0
"""|Im q| [rad | size] from which a candidate may be on its way to infinity, where Newton's steps go on for ever."""

STILL, FAR_OUT = 1e-13, 7.0
"""Residual up to which a candidate out there is at a solution, unless it is farther out than this: on the way to
infinity residuals are that small from |Im q| near 10 only."""

STEPS_ON = 1e-2
"""A candidate that Newton's next step takes farther [rad | size] is on its way: such steps are of about 1/2, while
rounding moves solutions by 1e-3 at most."""

COMPARED = 4
"""Neighbours in the order of a generic sum of their coordinates that each candidate is compared with: equal ones
stand side by side but for others whose sum agrees by chance, one in some thousand."""

RANK = 1e-10
"""Part of the greatest singular value below which a direction is left out of a least-squares step."""


def complex_refine(
    loop: Loop, closing: NDArray[Any], index: Index, values: NDArray[Any], steps: int
) -> tuple[Complex, Array]:
    """Complex values (s, 6) after some Newton steps, and the residual (s,) that the loop is then left with.

    closing: (m, 4, 4) L6, real or complex; index: (s,) into closing; values: (s, 6) [rad | size].
    The residual [size and rad] is relative to the size of X's terms; it is infinite where the steps led nowhere.
    """
    known = native_loop(loop)
    if native is None or known is None:
        return complex_refined_by_columns(loop, closing, index, values, steps)
    numbers = np.ascontiguousarray(values, dtype=np.complex128).reshape(-1, 6).view(np.float64)
    last = closing[index].astype(np.complex128).reshape(-1, 16).view(np.float64)
    refined, residual = native.complex_refined(known, last, numbers, steps, STEP)
    refined = refined.view(np.complex128)
    flat = np.flatnonzero(residual < 0.0)
    if len(flat):
        # Where S has no inverse to the last digit a step is one of least squares.
        refined[flat], residual[flat] = complex_refined_by_columns(loop, closing, index[flat], values[flat], steps)
    return refined, residual


def complex_refined_by_columns(
    loop: Loop, closing: NDArray[Any], index: Index, values: NDArray[Any], steps: int
) -> tuple[Complex, Array]:
    """`complex_refine` in Python."""
    refined = np.array(values, dtype=np.complex128)
    residual = np.empty(len(refined))
    last = columns_of(closing)
    for start in range(0, len(refined), BLOCK):
        part = slice(start, min(start + BLOCK, len(refined)))
        q, L = np.ascontiguousarray(refined[part].T), last[..., index[part]]
        # Values that run away overflow: the residual then says so.
        with np.errstate(over="ignore", invalid="ignore"):
            for _ in range(steps):
                axes, error, _ = follow(loop, L, q)
                dq = solved(twist_columns(loop, axes), error)
                length = np.abs(dq).max(axis=0)
                length[~np.isfinite(length)] = np.inf
                dq[:, length == np.inf] = 0.0
                q -= dq * (STEP / np.maximum(length, STEP))
            axes, error, trace = follow(loop, L, q)
            residual[part] = relative(axes, error, trace)
        refined[part] = q.T
    return refined, residual


def on_the_way_out(loop: Loop, closing: NDArray[Any], index: Index, values: Complex, residual: Array) -> Flags:
    """(s,) which candidates are no solutions but on the way to infinity, where residuals get as small as one likes.

    What is regular there is not told by `SURE`: second derivatives grow with exp(|Im q|).
    """
    out = np.zeros(len(values), dtype=bool)
    away = np.abs(values.imag).max(axis=1, initial=0.0)
    rows = np.flatnonzero((residual <= CLOSED) & (away > OUT) & ((residual > STILL) | (away > FAR_OUT)))
    if len(rows):
        new, _ = complex_refine(loop, closing, index[rows], values[rows], 1)
        out[rows] = np.abs(new - values[rows]).max(axis=1) > STEPS_ON
    return out


def regular_and_distinct(loop: Loop, index: Index, values: NDArray[Any], residual: Array) -> Flags:
    """(s,) which candidates are regular solutions, each but once.

    index: (s,) their targets; values: (s, 6) [rad | size], complex or real; residual: (s,) as `complex_refine` gives
    it. np.bincount(index[mask], minlength=m) is the number of regular solutions of each target.
    """
    keep = np.zeros(len(index), dtype=bool)
    chosen = np.flatnonzero(regular(loop, values, residual))
    keep[chosen[distinct(loop, index[chosen], values[chosen])]] = True
    return keep


def regular(loop: Loop, values: NDArray[Any], residual: Array, least: float = REGULAR) -> Flags:
    """(s,) whether values (s, 6) [rad | size] with some residual (s,) vouch for a regular solution at or beside them.

    The least singular value of S must be greater than `least` and the residual at most `SURE` times its square. The
    product of the other singular values is at most (|S|² / 5)^(5/2), so that the determinant vouches for most;
    singular values themselves are worked out for the rest.
    """
    if not len(values):
        return np.zeros(0, dtype=bool)
    z = np.ascontiguousarray(values, dtype=np.complex128)
    needed = np.maximum(least, np.sqrt(residual / SURE))
    answer = (residual <= CLOSED) & np.isfinite(z).all(axis=1)
    tried = np.flatnonzero(answer)
    known = native_loop(loop)
    if native is not None and known is not None:
        told = native.regular(known, z.view(np.float64), needed)
        answer &= told > 0.0
        tried = tried[told[tried] < 0.0]
        if not len(tried):
            return answer
    q = z.T
    for start in range(0, len(tried), BLOCK):
        part = tried[start : start + BLOCK]
        # Values that ran away overflow: their singular values are not asked for.
        with np.errstate(over="ignore", invalid="ignore"):
            S = jacobian(loop, np.ascontiguousarray(q[:, part]))
            squared = np.square(np.abs(S)).sum(axis=(1, 2))
            answer[part] = np.abs(_determinants(S)) > needed[part] * (squared / 5.0) ** 2.5
        doubtful = np.flatnonzero(~answer[part] & np.isfinite(squared))
        if len(doubtful):
            answer[part[doubtful]] = np.linalg.svd(S[doubtful], compute_uv=False)[:, -1] > needed[part[doubtful]]
    return answer


@cache
def _weights() -> Array:
    """What sines, cosines and imaginary parts count (3, 6) in the sum by which candidates are sorted."""
    return np.random.default_rng(5).uniform(0.5, 1.5, (3, 6))


def distinct(loop: Loop, index: Index, values: NDArray[Any], apart: float | Array = APART) -> Flags:
    """(s,) true for one of those candidates of one target that are nearer than `apart` to each other in every joint.

    apart: for all, or (s,) for each: of two the greater counts [rad | size].
    """
    weights = _weights()
    turning = loop.revolute
    if native is not None:
        z = np.ascontiguousarray(values, dtype=np.complex128).reshape(-1, 6)
        limit = np.full(len(z), apart)
        once: Flags = native.each_once(turning, weights, index, z.view(np.float64), limit, COMPARED)
        return once
    values = np.asarray(values, dtype=np.complex128)
    real, imaginary = values.real, values.imag
    key: Array = np.sin(real[:, turning]) @ weights[0, turning] + np.cos(real[:, turning]) @ weights[1, turning]
    key += real[:, ~turning] @ weights[0, ~turning] + imaginary @ weights[2]
    order = np.lexsort((key, index))
    at, q, sums = index[order], values[order], key[order]
    limit = np.broadcast_to(np.asarray(apart), len(order))[order]
    repeated = np.zeros(len(order), dtype=bool)
    for shift in range(1, min(COMPARED, len(order) - 1) + 1):
        least = np.maximum(limit[shift:], limit[:-shift])
        near = (at[:-shift] == at[shift:]) & (np.abs(sums[shift:] - sums[:-shift]) < 24.0 * least)
        a = np.flatnonzero(near)
        gap = q[a + shift] - q[a]
        gap -= np.where(turning, TURN * np.round(gap.real / TURN), 0.0)
        repeated[a[np.abs(gap).max(axis=1, initial=0.0) < least[a]] + shift] = True
    mask = np.empty(len(order), dtype=bool)
    mask[order] = ~repeated
    return mask


def jacobian(loop: Loop, q: Complex) -> Complex:
    """S (s, 6, 6) at q (6, s): a joint's twist in each column."""
    axes, _, _ = follow(loop, np.zeros((4, 3, 1)), q)
    return twist_columns(loop, axes)


def solved(S: Complex, right: Complex) -> Complex:
    """dq with S dq = right, for S (s, 6, 6) and right (6, s) or, for several sides, (6, s, k), of whose shape it is.

    It is the shortest of least squares where S is singular to the last digit, and NaN where S is not finite.
    """
    sides = np.ascontiguousarray(right.reshape(6, len(S), -1).transpose(1, 0, 2))
    try:
        dq = np.linalg.solve(S, sides)
    except np.linalg.LinAlgError:
        finite = np.isfinite(S).all(axis=(1, 2))
        flat = finite & (_determinants(S) == 0.0)
        rest = finite & ~flat
        dq = np.full_like(sides, np.nan)
        dq[rest] = np.linalg.solve(S[rest], sides[rest])
        dq[flat] = np.linalg.pinv(S[flat], rcond=RANK) @ sides[flat]
    return np.ascontiguousarray(dq.transpose(1, 0, 2)).reshape(right.shape)


def _determinants(S: Complex) -> Complex:
    """det S (s,) for S (s, 6, 6)."""
    # Where a pivot is zero its sign is 0 / 0; the determinant is zero all the same.
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        return np.asarray(np.nan_to_num(np.linalg.det(S)))


def relative(axes: Complex, error: Complex, trace: Complex) -> Array:
    """The residual (s,) of what `follow` gives, relative to the size of the terms of X; infinite where not finite."""
    whole = np.sqrt(np.square(np.abs(error)).sum(axis=0) + np.square(np.abs(trace)))
    size = np.square(np.abs(axes[0])).sum(axis=1).max(axis=0)
    residual = whole / size
    return np.where(np.isfinite(residual), residual, np.inf)
