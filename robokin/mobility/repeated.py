"""Branches along which the constraints vanish many times over, of one dimension less than the kernel all along them.

Statement. At a point of such a branch the reduced constraints of a kernel of k dimensions are, in coordinates s (k - 1)
along it and u across,

    g(s, u) = c(s, u) (u - u0(s))^m,    c ≠ 0,

with the same m all about. A zero of order m is known to the m-th root of rounding only: 1e-5 for m = 3. But the
(m - 1)-th derivative across vanishes once on it. So g is read off at Chebyshev's points across the branch, and u0 is
the zero of that derivative of the polynomial through them. It counts if all lower derivatives vanish there, too, and if
it does so with the same m at places all about.

Source: L. N. Trefethen, Approximation Theory and Approximation Practice, 2013 (polynomials through Chebyshev's points).
"""

from __future__ import annotations

from math import factorial

import numpy as np
from numpy.polynomial import Chebyshev

from robokin.arrays import Array
from robokin.mobility.chart import Chart
from robokin.mobility.measured import Branch
from robokin.mobility.reduced import Reduced, directions
from robokin.mobility.zeros import sought

MOST = 8
"""The greatest m: the next would need a digit more than there are."""

SAMPLES, DEGREE = 25, 14
"""Points across the branch, and the degree of the polynomial through them: its next coefficient is about 1e-12 of g."""

VANISHES, LEADS = 1e-5, 1e-2
"""Terms of the series across, as parts of the greatest, below which they are none, and above which one is the leading
one: differentiating m times costs ten digits, and points are half a width away where the series is good."""

IMAGINARY = 1e-5
"""Roots of the polynomial with imaginary parts below this are real."""

BETWEEN = 0.6
"""Where across the zero has to be, in half widths of the points: beyond, polynomials are of no use."""

PART = 1e-4
"""A tremble's part in a motion that is less is an error: zeros of order 5 are read off to 1e-7 of the radius."""

SLOPE = 0.1
"""How far along [radius] the slope of u0 is taken."""


def repeated(chart: Chart, q: Array, kernel: int, radius: float) -> Branch | None:
    """The branch at a point q (n,) where the loops' kernel is as large; None where it is not of the kind."""
    reduced = Reduced(chart, q, kernel=kernel)
    if kernel < 2 or reduced.free:
        return None
    zeros, _ = sought(reduced, radius)
    if len(zeros) < 2:
        return None
    across = np.linalg.svd(zeros)[2]
    T, n = across[:-1].T, across[-1]
    first = next((m for m in range(2, MOST + 1) if _zero(reduced, np.zeros(kernel), n, radius, m) is not None), None)
    if first is None:
        return None
    at = _zero(reduced, np.zeros(kernel), n, radius, first)
    for s in radius * directions(kernel - 1):
        if at is None or _zero(reduced, T @ s, n, radius, first) is None:
            return None
    slopes = []
    for along in T.T:
        beside = [_zero(reduced, sign * SLOPE * radius * along, n, radius, first) for sign in (1.0, -1.0)]
        if beside[0] is None or beside[1] is None:
            return None
        slopes.append((beside[0] - beside[1]) / (2.0 * SLOPE * radius))
    x = at * n
    found = reduced.at(x[None])
    slope = reduced.equations(found.x, found.y)[4][0]
    lifted = reduced.V0 + reduced.V1 @ slope
    tangent = _without(lifted @ (T + np.outer(n, slopes)), lifted @ n)
    tangent = np.linalg.qr(tangent)[0]
    return Branch(kernel - 1, kernel, reduced.q(found.x, found.y)[0], tangent, tangent, first)


def _without(tangent: Array, tremble: Array) -> Array:
    """Motions (n, d) without the tremble (n,) that errors of their slopes have added: where a coordinate that trembles
    has no other part in a motion."""
    tangent = tangent.copy()
    for column in tangent.T:
        own = np.abs(column) < PART * np.abs(tremble)
        if np.any(own):
            column -= np.median(column[own] / tremble[own]) * tremble
    return tangent


def _zero(reduced: Reduced, base: Array, n: Array, width: float, m: int) -> float | None:
    """Where across, at base + u n, the constraints vanish m times, |u| < width; None where they do not."""
    u = np.cos(np.pi * (np.arange(SAMPLES) + 0.5) / SAMPLES)
    found = reduced.at(base + width * u[:, None] * n)
    if not np.all(found.solved):
        return None
    # Of all constraints the combination that is greatest.
    most = np.linalg.svd(found.g)[2][0]
    line = Chebyshev.fit(u, found.g @ most, DEGREE, domain=[-1.0, 1.0])
    lines = [line.deriv(j) if j else line for j in range(DEGREE)]
    roots = lines[m - 1].roots()
    real = roots.real[(np.abs(roots.imag) < IMAGINARY) & (np.abs(roots.real) < BETWEEN)]
    if not len(real):
        return None
    at = float(real[np.argmin(np.abs(real))])
    series = np.array([abs(float(each(at))) / factorial(j) for j, each in enumerate(lines)])
    greatest = float(np.max(series))
    if np.max(series[:m]) > VANISHES * greatest or series[m] < LEADS * greatest:
        return None
    left = reduced.at((base + width * at * n)[None])
    return width * at if np.max(np.abs(left.g)) < float(reduced.tolerance(width)) * 10.0 else None
