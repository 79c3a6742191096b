"""Newton's steps on functions of joint values within a region of trust, which follows how well the steps went.

The step is that of D. P. Bertsekas, Nonlinear Programming, 2nd ed. 1999, section 1.4, negative curvatures turned over;
the radius that it keeps within is doubled where it led down, and a quarter of the step where it did not.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.kernel.damped_newton import Judged, Known, Trial, led_down

FLAT = 1e-9
"""Least curvature [size²/rad²] that a step goes by: a flat direction, along which only rounding has a slope, is not
followed far."""

STILL = 1e-14
"""A slope [size²/rad] or radius [rad | size] that is rounding."""

FIRST, WIDEST = 0.5, 1.0
"""The radius at first and at most [rad | size]."""

Derivatives = Callable[[Index, Array], Known]
"""Of functions (k,) at values (k, n): the functions (k,), their gradients (k, n) and Hessians (k, n, n)."""


class Freed(NamedTuple):
    """What limits that stand in the way leave of gradients (k, n) and Hessians (k, n, n), projections (k, n, n) on
    that, and which of c limits these are (k, c)."""

    gradient: Array
    hessian: Array
    projection: Array
    held: Flags


Free = Callable[[Array, Array, Array], Freed]
"""Of values (k, n) with the gradients and Hessians there."""

Stopped = Callable[[Array, Array, Flags], Array]
"""Where steps (k, n) from values (k, n) lead to within the limits, of which some (k, c) stand in the way."""


def polished(derivatives: Derivatives, free: Free, stopped: Stopped, q: Array, steps: int) -> tuple[Array, Array]:
    """Values to which some steps lead from q (m, n) [rad | size], and the functions there (m,)."""

    def step(_: Index, x: Array, here: Known, trust: Known) -> Trial:
        slope, H, P, held = free(x, *here[1:])
        on = (np.max(np.abs(slope), axis=1) > STILL) & (trust[0] > STILL)
        curvatures, V = np.linalg.eigh(H)
        along = np.einsum("mji,mj->mi", V, slope) / np.maximum(np.abs(curvatures), FLAT)
        dx = -np.einsum("mij,mj->mi", P, np.einsum("mij,mj->mi", V, along))
        length = np.linalg.norm(dx, axis=1)
        dx *= np.minimum(1.0, trust[0] / np.maximum(length, 1e-300))[:, None]
        return Trial(stopped(x, dx, held), trust, on, (np.minimum(length, trust[0]),))

    q, f = led_down(derivatives, step, _by_descent, q, (np.full(len(q), FIRST),), steps=steps, told=1)
    return q, f


def _by_descent(_: Array, here: Known, there: Known, trial: Trial) -> Judged:
    """Trials that lower the functions are taken."""
    better, (radius,), (length,) = there[0] < here[0], trial.trust, trial.notes
    return Judged(better, (np.where(better, np.minimum(2.0 * np.maximum(radius, length), WIDEST), 0.25 * length),))
