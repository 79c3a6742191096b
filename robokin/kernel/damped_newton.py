"""Damped Newton steps for many configurations at once, within joint limits: what all descents are made of.

Two loops, one for each way to use a step. `brought_down` takes every step and keeps of each row what was best: its
damping hangs on the error alone, and it may leap out of a valley. `led_down` tries steps and takes those that lead
down: its damping, or the radius that steps keep within, follows their success, and where it ends is a minimum.

Least squares. With an error e (what a target asks for less what is there) and its Jacobian J the step
dq = (JᵀJ + λ I)⁻¹ Jᵀe lowers |e|² (K. Levenberg, Quart. Appl. Math. 2, 1944; D. Marquardt, SIAM J. 11, 1963); λ about
as great as |e|² makes it cautious far off and Newton's near the end, singular or not (T. Sugihara,
"Solvability-unconcerned inverse kinematics by the Levenberg-Marquardt method", IEEE T-RO 27(5), 2011). The singular
values of J give it also where JᵀJ would lose those below the root of its rounding.
Second order. With a gradient g and a Hessian H the step solves (H + λ I) dq = -g by elimination, whose pivots tell
where H + λ I is positive definite.
Limits. A joint at a limit that the way down pushes outwards is held, and a step ends at the limits (D. P. Bertsekas,
"Projected Newton methods for optimization problems with simple constraints", SIAM J. Control Optim. 20(2), 1982).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from robokin.arrays import Array, Flags, Index

Errors = Callable[[Index, Array], tuple[Array, Array]]
"""Of some rows (k,) at values x (k, n): the errors (k, m) and their Jacobians (k, m, n)."""

Step = Callable[[Index, Array, Array, Array], Array]
"""Of some rows (k,) at values x (k, n), with errors (k, m) and Jacobians (k, m, n): steps (k, n)."""

Known = tuple[Array, ...]
"""What is known at the values of rows: what steps are made of and judged by, each array with the rows on one axis."""


class Trial(NamedTuple):
    """Steps that are tried: where they lead, what is trusted of them, which rows go on, and what judges them.

    x: as the values; trust, notes: arrays of (s,); on: (s,).
    """

    x: Array
    trust: Known
    on: Flags | None = None
    notes: tuple[Any, ...] = ()


class Judged(NamedTuple):
    """Which trials are taken (s,), what is trusted of the next ones, (s,) each, and which rows have arrived (s,)."""

    taken: Flags
    trust: Known
    arrived: Flags | None = None


Look = Callable[[Index, Array], Known]
"""Of some rows (k,) at their values: what is known there."""

Try = Callable[[Index, Array, Known, Known], Trial]
"""Of some rows (k,) at their values, with what is known there and what is trusted: the steps to try."""

Judge = Callable[[Array, Known, Known, Trial], Judged]
"""Of rows at their values, with what is known there and where the trials lead: what becomes of them."""


def brought_down(
    errors: Errors, step: Step, x: Array, low: Array, high: Array, *, steps: int, arrived: float | Array
) -> tuple[Array, Array]:
    """Values (s, n) after some steps from x (s, n) within low and high, (n,), and the errors (s, m) there.

    arrived: |e|², one or (s,), below which a row is left alone. Of each row what was best stays, and where it ends does
    not depend on the others.
    """
    rows, x = np.arange(len(x)), np.clip(x, low, high)
    best, least = x.copy(), np.full(len(x), np.inf)
    enough = np.broadcast_to(arrived, least.shape)
    e, J = errors(rows, x)
    left = np.zeros(e.shape)
    for count in range(steps + 1):
        if count:
            x = np.clip(x + step(rows, x, e, J), low, high)
            e, J = errors(rows, x)
        squared = np.sum(e * e, axis=1)
        better = squared <= least[rows]
        which = rows[better]
        best[which], least[which], left[which] = x[better], squared[better], e[better]
        # Those that have arrived, or ran away to where there are no numbers, cost no more time.
        on = squared >= enough[rows]
        if not on.all():
            rows, x, e, J = rows[on], x[on], e[on], J[on]
        if not len(rows):
            break
    return best, left


def led_down(
    look: Look, step: Try, judge: Judge, x: Array, trust: Known, *, steps: int, told: int, axis: int = 0
) -> tuple[Array, ...]:
    """Values to which some steps lead from x that are taken only where the judge says so, and what is known there.

    axis: 0 or -1, that of the rows in all arrays of `look` and in x; trust: what the first steps are made with, arrays
    of (s,); told: how many of the arrays that `look` gives are given back, the first ones. Where a row ends does not
    depend on the others: what look, step and judge tell of it must not.
    """
    rows, here, x = np.arange(x.shape[axis]), look(np.arange(x.shape[axis]), x), x.copy()
    end = x.copy(), *(part.copy() for part in here[:told])
    over = np.zeros(len(rows), dtype=bool)

    def at(which: Index | Flags) -> Any:
        return (..., which) if axis else which

    for count in range(steps):
        trial = step(rows, x, here, trust)
        if trial.on is not None:
            over |= ~trial.on
            if over.all():
                break
        there = look(rows, trial.x)
        taken, trust, arrived = judge(x, here, there, trial)
        taken &= ~over
        for new, old in zip((trial.x, *there), (x, *here), strict=True):
            np.copyto(old, new, where=taken if axis else taken.reshape(-1, *(1,) * (old.ndim - 1)))
        if arrived is not None:
            over |= arrived
            if over.all():
                break
        if 3 * np.count_nonzero(over) > len(over) and count < steps - 1:
            # Those that have arrived cost no more time.
            for whole, part in zip(end, (x, *here), strict=False):
                whole[at(rows)] = part
            on = ~over
            x, here = x[at(on)], tuple(part[at(on)] for part in here)
            rows, over, trust = rows[on], over[on], tuple(part[on] for part in trust)
    for whole, part in zip(end, (x, *here), strict=False):
        whole[at(rows)] = part
    return end


def held_at(x: Array, low: Array, high: Array, uphill: Array) -> Flags:
    """Which joints stand at a limit that the way, `uphill` being its direction, leads beyond."""
    return np.asarray(((x <= low) & (uphill < 0.0)) | ((x >= high) & (uphill > 0.0)))


def limited(dx: Array, longest: float, axis: int = 1) -> Array:
    """Steps shortened so that no joint moves by more than `longest`; axis: that of the joints."""
    return np.asarray(dx * (longest / np.maximum(np.max(np.abs(dx), axis=axis, keepdims=True), longest)))


def singular_step(J: Array, e: Array, damping: Array) -> Array:
    """The dq (s, n) with (JᵀJ + damping I) dq = Jᵀe, from the singular values of J (s, m, n).

    e: (s, m); damping: (s,).
    """
    U, values, Vt = np.linalg.svd(J, full_matrices=False)
    squares = values * values + damping[:, None] + (np.finfo(float).eps * values[:, :1]) ** 2
    part = np.einsum("sik,si->sk", U, e) * values / np.maximum(squares, np.finfo(float).tiny)
    return np.asarray(np.einsum("ski,sk->si", Vt, part))


def solved(A: Array, b: Array, pivot: Callable[[Array], Array] | None = None) -> tuple[Array, Array, Array]:
    """x (n, s) with A x = b, the pivots D (n, s), and y = L⁻¹ b (n, s), for A (n, n, s), overwritten, and b (n, s).

    Only what is on and right of the diagonal of the symmetric A counts. A = L D Lᵀ by elimination without interchanges,
    which is stable where A is definite, that is where D > 0 (N. J. Higham, "Accuracy and Stability of Numerical
    Algorithms", 2nd ed., 2002, section 10.1). pivot: what is taken for each of the pivots (s,). Every operation is on
    all columns at once and does not mix them.
    """
    n = len(A)
    y, D = b.copy(), np.empty(b.shape)
    for k in range(n):
        D[k] = A[k, k] if pivot is None else pivot(A[k, k])
        row = A[k, k + 1 :]
        column = row / D[k]
        A[k + 1 :, k + 1 :] -= column[:, None] * row
        y[k + 1 :] -= column * y[k]
    x = y.copy()
    for k in range(n - 1, -1, -1):
        x[k] /= D[k]
        x[:k] -= A[:k, k] * x[k]
    return x, D, y
