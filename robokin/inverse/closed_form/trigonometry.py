"""The equations in one joint that the closed forms come down to.

1. a cos θ + b sin θ = e. With r² = a² + b² and (a, b) = r (cos φ, sin φ) it reads cos(θ - φ) = e / r: two
   solutions for |e| < r, one (double) for |e| = r, none beyond. At r = 0 it says nothing of θ.

2. h0 + h1 cos θ + h2 sin θ + h3 cos 2θ + h4 sin 2θ = 0. With t = tan((θ - φ) / 2) a quartic in t: at most
   four solutions. Its leading coefficient is the value of the left side at θ = φ + 180°; φ is chosen from
   five angles, one of which is far from every root, since five equally spaced values determine the h.

3. Polynomials of degree 1, 2 and 4 in the length of a prismatic joint.

Near a double root, rounding may have moved the two solutions a little off the real line. They are kept,
as the real number nearest: what is found here is a beginning for Newton's method, and is verified.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robokin.arrays import Array, Flags
from robokin.kernel.entries import (
    Entry,
    minus,
    plus,
    quotient,
    root,
    times,
)

Turn = tuple[Entry, Entry]
"""An angle as its cosine and sine."""

CLAMP = 1e-5
"""How far |e| may exceed r (cosines, or squares of lengths in units of the arm's size) and still count as
the double root. Rounding of what comes in is 1e-15, its square root, 3e-8, after an earlier double root,
and what is neglected of an almost special arm is 1e-5."""

FREE = 1e-12
"""A lever (in units of the arm's size) shorter than this does not tell an angle: the angle is set to 0.
The pose moves by no more than this."""

REAL = 1e-3
"""How large an imaginary part of a root counts as rounding. A double root of a quartic is split by 1e-8, a
fourfold one by 1e-4."""

ANGLES = 0.3 + 2.0 * np.pi / 5.0 * np.arange(5)
"""Where to look for a large value of equation 2; unlike right angles, no robot's favourites."""
HARMONICS = np.stack([np.ones(5), np.cos(ANGLES), np.sin(ANGLES), np.cos(2 * ANGLES), np.sin(2 * ANGLES)], axis=1)


def turned(turn: Turn, v: Sequence[Entry]) -> list[Entry]:
    """Rz v; what follows x and y in v is left as it is."""
    c, s = turn
    x, y = v[0], v[1]
    return [minus(times(c, x), times(s, y)), plus(times(s, x), times(c, y)), *v[2:]]


def turned_back(turn: Turn, v: Sequence[Entry]) -> list[Entry]:
    """Rzᵀ v."""
    c, s = turn
    x, y = v[0], v[1]
    return [plus(times(c, x), times(s, y)), minus(times(c, y), times(s, x)), *v[2:]]


def turn_between(v: Sequence[Entry], u: Sequence[Entry], free: float | None = None) -> Turn:
    """The turn about z that takes the direction of v to that of u (x and y count).

    None, (1, 0), where |v| |u| < free; by default where both levers are FREE.
    """
    c = plus(times(u[0], v[0]), times(u[1], v[1]))
    s = minus(times(u[1], v[0]), times(u[0], v[1]))
    return normalized(c, s, FREE**2 if free is None else free)


def normalized(c: Entry, s: Entry, free_below: float = FREE) -> Turn:
    """(c, s) made a cosine and a sine; (1, 0) where they are shorter than free_below."""
    square = plus(times(c, c), times(s, s))
    least = free_below * free_below
    if isinstance(square, float):
        return (1.0, 0.0) if square < least else (quotient(c, root(square)), quotient(s, root(square)))
    free = square < least
    if free.any():
        c, s, square = np.where(free, 1.0, c), np.where(free, 0.0, s), np.where(free, 1.0, square)
    scale = 1.0 / np.sqrt(square)
    return times(c, scale), times(s, scale)


def both(middle: Entry, side: Entry) -> Array:
    """middle + side and middle - side on a new first axis."""
    out = np.empty((2, *np.broadcast_shapes(np.shape(middle), np.shape(side))))
    np.add(middle, side, out=out[0])
    np.subtract(middle, side, out=out[1])
    return out


def linear_roots(a: Entry, b: Entry, e: Entry) -> tuple[Turn, Flags]:
    """Both θ of a cos θ + b sin θ = e as (cos, sin), each (2, …), and whether they are real: (1, …).

    Where a, b and e all vanish, θ = 0 stands for all.
    """
    r = root(plus(times(a, a), times(b, b)))
    size = np.abs(e)
    real = np.asarray(size <= r + CLAMP)
    free = np.asarray(r < FREE)
    if free.any():
        a, b, e = np.where(free, 1.0, a), np.where(free, 0.0, b), np.where(free, 1.0, e)
        r = np.where(free, 1.0, r)
    scale = 1.0 / r
    a, b = times(a, scale), times(b, scale)
    c = np.minimum(np.maximum(times(e, scale), -1.0), 1.0)
    s = np.sqrt((1.0 - c) * (1.0 + c))
    return (both(times(a, c), -times(b, s)), both(times(b, c), times(a, s))), real[None]


def second_degree_roots(h: Sequence[Entry]) -> tuple[Turn, Flags]:
    """All θ of equation 2 as (cos, sin), each (4, m), and which are real: (4, m). h: five entries (m,)."""
    H = np.stack(np.broadcast_arrays(*np.atleast_1d(*h)))
    values = HARMONICS @ H
    pick = np.argmax(np.abs(values), axis=0)
    leading = np.take_along_axis(values, pick[None], axis=0)[0]
    c, s = -np.cos(ANGLES)[pick], -np.sin(ANGLES)[pick]
    c2, s2 = c * c - s * s, 2.0 * s * c
    h0 = H[0]
    h1, h2 = c * H[1] + s * H[2], c * H[2] - s * H[1]
    h3, h4 = c2 * H[3] + s2 * H[4], c2 * H[4] - s2 * H[3]
    t, real = quartic_roots([leading, 2.0 * h2 - 4.0 * h4, 2.0 * h0 - 6.0 * h3, 2.0 * h2 + 4.0 * h4, h0 + h1 + h3])
    r = 2.0 / (1.0 + t * t)
    return (c * (r - 1.0) - s * (t * r), s * (r - 1.0) + c * (t * r)), real


def quartic_roots(k: Sequence[Entry]) -> tuple[Array, Flags]:
    """The real parts (4, m) of the roots of k[0] t⁴ + … + k[4] = 0, and which are real.

    By the eigenvalues of the companion matrix. Where k[0] vanishes the polynomial is taken to vanish,
    and t = 0 stands for all.
    """
    K = np.stack(np.broadcast_arrays(*np.atleast_1d(*k)))
    lost = ~(np.abs(K[0]) > FREE) | ~np.isfinite(K).all(axis=0)
    if lost.any():
        K = np.where(lost, np.array([1.0, 0.0, 0.0, 0.0, 0.0])[:, None], K)
    companion = np.zeros((K.shape[1], 4, 4))
    companion[:, 0, :] = (-K[1:] / K[0]).T
    companion[:, (1, 2, 3), (0, 1, 2)] = 1.0
    roots = np.linalg.eigvals(companion).T
    t = np.ascontiguousarray(roots.real)
    if not np.iscomplexobj(roots):
        return t, np.ones(t.shape, dtype=bool)
    return t, np.abs(roots.imag) <= REAL * (1.0 + np.abs(t))


def quadratic_roots(a: Entry, b: Entry, c: Entry) -> tuple[Array, Flags]:
    """Both x (2, …) of a x² + b x + c = 0, and which are real and finite: (2, …).

    With q = -(b ± √(b² - 4ac)) / 2, the sign that of b, they are c / q and q / a: no cancellation, and
    for a = 0 the first is the root of the linear equation. Where all three vanish x = 0 stands for all.
    """
    a, b, c = np.broadcast_arrays(a, b, c)
    D = b * b - 4.0 * a * c
    real = D + CLAMP * (b * b + np.abs(4.0 * a * c) + CLAMP) >= 0.0
    q = -0.5 * (b + np.copysign(np.sqrt(np.maximum(D, 0.0)), b))
    double = np.abs(q) < FREE
    x = np.zeros((2, *q.shape))
    np.divide(c, q, out=x[0], where=~double)
    finite = np.abs(a) > FREE
    np.divide(q, a, out=x[1], where=finite)
    # b = 0 and D = 0: the double root 0, or no equation at all, or one without a solution.
    solvable = ~double | finite | (np.abs(c) < CLAMP)
    return x, np.stack([real & solvable, real & finite])
