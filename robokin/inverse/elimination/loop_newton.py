"""Newton steps on the loop equation: approximate joint values made exact.

Statement. Given values close to a solution of J1 L1 … J6 L6 = I, find the solution.
Derivation. Let X = J1 L1 … J6 L6 at the values. Moving joint i by dq turns X by the twist s_i dq about the
axis where the joint then is: s_i = (o × z, z) for a joint that turns about z through o, (z, 0) for one that
slides along z. X = exp(e) with e = (v, w), w the rotation vector, v the translation to first order. So S dq = -e
with the columns s_i is a Newton step on X = I.
Degenerate case. Where the arm is singular S has no inverse. The step solves (SᵀS + |e|² I) dq = -Sᵀe instead:
far off it is cautious, near the end it is Newton's. It converges quadratically where S is regular and, given that
the error grows like the distance from the solutions, where these form a curve (J. Fan, Y. Yuan, "On the quadratic
convergence of the Levenberg-Marquardt method without nonsingularity assumption", Computing 74, 2005). At an
isolated double solution it converges linearly, as Newton's method does.

All arrays here have the candidates last, (…, s), and each operation is on all candidates at once.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from robokin.arrays import Array, Index
from robokin.inverse.elimination.loop import Loop, follow, native_loop
from robokin.kernel.damped_newton import limited, singular_step, solved
from robokin.kernel.native_kernel import native
from robokin.kernel.sweep import sweep, twists

STEP = 0.5
"""The longest step of one joint [rad | size]: further off, the tangent says nothing of the curve."""

FLOOR = 1e-15
"""Least damping of joint i as a part of |s_i|²: some four times the rounding of SᵀS, so that its factors stay
positive. |s_i| is great where the axis is far from the origin, as a slide that is long against the arm puts it."""

DONE = 1e-14
"""Candidates whose error [size and rad] is less are left alone: some ten times the rounding of X."""

LONG = 30.0
"""A slide [size] above which SᵀS, whose singular values are squares of ratios of links and slides, has too few digits,
and the step comes from the singular values of S itself."""

BLOCK = 2048
"""Candidates at a time: the forty or so numbers of each (650 kB) stay in the second-level cache."""


def refine(loop: Loop, closing: Array, index: Index, values: Array, steps: int) -> tuple[Array, Array, Array]:
    """Values (s, 6) after some Newton steps, and what the loop then lacks of closing.

    closing: (m, 4, 4) L6; index: (s,) into closing; values: (s, 6) [rad | size].
    Returns values (s, 6) [rad | size], position (s,) [size] and angle (s,) [rad].
    """
    known = native_loop(loop) if loop.revolute.all() else None
    if native is None or known is None:
        return refined_by_columns(loop, closing, index, values, steps)
    refined, off = native.refined(known, closing[index], values, steps)
    return refined, off[:, 0], off[:, 1]


def refined_by_columns(
    loop: Loop, closing: Array, index: Index, values: Array, steps: int
) -> tuple[Array, Array, Array]:
    """`refine` in Python."""
    refined = np.array(values, dtype=np.float64)
    position, angle = np.empty(len(refined)), np.empty(len(refined))
    slides = np.flatnonzero(~loop.revolute)
    # Columns x, y, z, p of L6, each (3, m): rows are the entries of what comes before in X.
    last = np.ascontiguousarray(closing[:, :3].transpose(2, 1, 0))
    # Values that run away are no numbers in the end, and close nothing.
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        for start in range(0, len(refined), BLOCK):
            part = np.arange(start, min(start + BLOCK, len(refined)))
            q, L = refined[part].T.copy(), last[..., index[part]]
            far = _farness(loop, q)
            for step in range(steps + 1):
                axes, error = _follow(loop, L, q)
                if len(slides):
                    error[:3] /= far
                squares = error * error
                v, w = squares[:3].sum(axis=0), squares[3:].sum(axis=0)
                open_ = v + w > DONE * DONE
                ready = step == steps or not open_.any()
                if ready or np.count_nonzero(open_) < 0.75 * len(part):
                    done = slice(None) if ready else ~open_
                    refined[part[done]] = q.T[done]
                    position[part[done]], angle[part[done]] = far[done] * np.sqrt(v[done]), np.sqrt(w[done])
                    if ready:
                        break
                    part, q, L, far = part[open_], q[:, open_], L[..., open_], far[open_]
                    axes, error = axes[..., open_], error[:, open_]
                    open_ = open_[open_]
                S = twists(axes, loop.revolute)
                dq = _step_of_slides(S, error, slides, far) if len(slides) else _step(S, error)
                # What has arrived stays, so that it does not depend on the others.
                q += dq * open_
    return refined, position, angle


def _step_of_slides(S: Array, error: Array, slides: Index, far: Array) -> Array:
    """`_step` of a loop some of whose joints slide: lengths of the step are in units of far (s,), and it is in sizes.

    error: (6, s) with its lengths in these units.
    """
    S[:, :3] /= far
    S[slides] *= far
    dq = _step(S, error)
    if (long := far > LONG).any():
        damping = np.einsum("cs,cs->s", error[:, long], error[:, long])
        dx = singular_step(S[..., long].transpose(2, 1, 0), error[:, long].T, damping)
        dq[:, long] = -limited(dx, STEP).T
    dq[slides] *= far
    return dq


def _farness(loop: Loop, q: Array) -> Array:
    """(s,) the longest slide of q (6, s) [size], at least 1: the unit of lengths in a step.

    A turn moves the end of a long slide by that much, and what rounding leaves of its position would otherwise
    outweigh the whole error of its orientation.
    """
    return np.asarray(np.max(np.abs(q[~loop.revolute]), axis=0, initial=1.0))


def determinants(loop: Loop, values: Array) -> Array:
    """|det S| (s,) at values (s, 6) [rad | size]: zero where the arm is singular. It depends on no target."""
    q = np.asarray(values, dtype=np.float64).T
    axes, _ = _follow(loop, np.zeros((4, 3, 1)), q)
    return np.asarray(np.abs(np.linalg.det(twists(axes, loop.revolute).transpose(2, 0, 1))))


def closing_at(loop: Loop, values: NDArray[Any]) -> NDArray[Any]:
    """The L6 (k, 4, 4) that close the loop at values (k, 6) [rad | size], real or complex."""
    _, X = sweep(loop.links, loop.revolute, np.ascontiguousarray(values.T))
    closing = np.zeros((len(values), 4, 4), dtype=X.dtype)
    closing[:, :3, :3] = X[:3].transpose(2, 0, 1)
    closing[:, :3, 3] = -np.einsum("crs,rs->sc", X[:3], X[3])
    closing[:, 3, 3] = 1.0
    return closing


def _follow(loop: Loop, last: Array, q: Array) -> tuple[Array, Array]:
    """The joints' axes (2, joint, 3, s) and X's error v [size], w [rad] (6, s) at q (6, s)."""
    axes, error, lack = follow(loop, last, q)
    w = error[3:]
    sine_of_error = np.sqrt((w * w).sum(axis=0))
    angle = np.arctan2(sine_of_error, 1.0 - 0.5 * lack)
    none = sine_of_error == 0.0
    w *= angle / np.where(none, 1.0, sine_of_error)
    # A half turn has no sine and so no direction here: it must still not pass for the identity.
    w[0] += np.where(none, angle, 0.0)
    return axes, error


def _step(S: Array, error: Array) -> Array:
    """The damped Newton step (6, s) for twists (joint, 6, s) and error (6, s), by elimination."""
    n, s = len(S), error.shape[1]
    M, b = np.empty((n, n, s)), np.einsum("cs,jcs->js", error, S)  # SᵀS + damping, its upper triangle, and Sᵀe
    damping = np.einsum("cs,cs->s", error, error)
    for i in range(n):
        np.einsum("cs,jcs->js", S[i], S[i:], out=M[i, i:])
    diagonal = np.einsum("iis->is", M)
    diagonal += damping + FLOOR * diagonal
    return -limited(solved(M, b)[0], STEP, axis=0)
