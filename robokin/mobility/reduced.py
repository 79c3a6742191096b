"""The constraints that are left when all regular ones are solved: Lyapunov and Schmidt's reduction.

Statement. F(q) = 0 are the loops and rows of a part, J their derivative at a configuration q0 where they hold, of rank
r. With J = U S Vᵀ let V1, U1 belong to the r singular values that count and V0, U0 to the rest. For x (k,) in the
kernel's coordinates

    U1ᵀ F(q0 + V0 x + V1 y) = 0

has near 0 just one solution y(x), smooth, by the implicit function theorem. What is left are the reduced constraints

    g(x) = U0ᵀ F(q0 + V0 x + V1 y(x)),    g(0) = 0, Dg(0) = 0,

and the configurations near q0 are, one to one, the x near 0 with g(x) = 0.

Here x stays where it is while Newton's steps find y: a constraint of order n is seen as c |x|^n at the radius |x| that
was asked for, not at one that the steps have slid back to. At |x| = 0.5 the order 5 leaves 3 % and 16 still 1e-5 of c,
against a rounding of 1e-15.

Source: E. Allgower, K. Georg, Introduction to Numerical Continuation Methods, 2003, chapter 8.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array, Flags
from robokin.mobility.chart import Chart

NEWTON_STEPS = 14
"""Steps for y(x); most take five."""

SOLVED = 1e-12
"""Regular equations [size, rad] that lack less are solved: some thousand times their rounding."""

LONGEST = 0.5
"""Greatest step of y [rad | size]."""

FARTHEST = 2.5
"""Joints [rad | size] that have gone farther have left the neighbourhood."""

RADII = (0.5, 0.3, 0.2, 0.1, 0.05, 0.02, 0.01, 0.004, 0.001)
"""Radii |x| [rad | size] at which constraints are looked at, the greatest that can be solved in each direction: the
higher the order of a constraint, the more it grows with the radius."""

FLAT = 1e-13
"""Reduced constraints [size, rad] below this are none: a hundred times the rounding of a loop."""

LEAP = 1e-6
"""Constraints [size, rad] that are none at half a radius and more than this at it would be of an order beyond 23."""

NOISE = 100.0
"""Dimensions wrong by the noise e leave constraints of some times e times the radius."""


@dataclass(frozen=True, eq=False)
class ReducedPoints:
    """Points of a reduction: x (N, k), y (N, r), the reduced constraints g (N, c) there, their derivative (N, c, k),
    and where Newton's steps have solved the regular ones."""

    x: Array
    y: Array
    g: Array
    Dg: Array
    solved: Flags


class Reduced:
    """The reduction of a chart's constraints at q0 (n,) to the `kernel` least singular values, or those below a cut."""

    def __init__(self, chart: Chart, q0: Array, kernel: int | None = None, cut: float = 0.0) -> None:
        self.chart, self.q0 = chart, q0
        J = chart.both(q0[None])[1][0]
        U, values, Vt = np.linalg.svd(J)
        self.greatest = float(values[0]) if len(values) and values[0] > 0.0 else 1.0
        self.values = np.concatenate([values, np.zeros(chart.n - len(values))]) / self.greatest
        rank = int(np.sum(self.values > cut)) if kernel is None else chart.n - kernel
        self.rank, self.k = rank, chart.n - rank
        self.U1, self.V1, self.U0 = U[:, :rank], Vt[:rank].T, U[:, rank:]
        self.V0 = _plain(Vt[rank:].T)
        self.noise = float(self.values[rank]) if rank < chart.n and len(values) > rank else 0.0

    @property
    def free(self) -> bool:
        """Whether no constraint is left: the regular ones are all."""
        return bool(self.U0.shape[1] == 0)

    def q(self, x: Array, y: Array) -> Array:
        """Coordinates (N, n) of points."""
        return np.asarray(self.q0 + x @ self.V0.T + y @ self.V1.T)

    def equations(self, x: Array, y: Array) -> tuple[Array, Array, Array, Array, Array]:
        """At x, y: what the regular equations lack (N, r) and, with their steps taken, g (N, c) and Dg (N, c, k); then
        the step of y (N, r) and its change with x (N, r, k)."""
        F, J = self.chart.both(self.q(x, y))
        lacking = F @ self.U1
        JV1 = J @ self.V1
        step = _solved(self.U1.T @ JV1, np.concatenate([lacking[..., None], self.U1.T @ J @ self.V0], axis=2))
        dy, slope = -step[..., 0], -step[..., 1:]
        C = self.U0.T @ JV1
        g = F @ self.U0 + (C @ dy[..., None])[..., 0]
        return lacking, g, self.U0.T @ J @ self.V0 + C @ slope, dy, slope

    def at(self, x: Array, y: Array | None = None) -> ReducedPoints:
        """The points over x (N, k); y (N, r) where the steps begin."""
        y = np.zeros((len(x), self.rank)) if y is None else y.copy()
        for _ in range(NEWTON_STEPS):
            lacking, g, Dg, dy, _ = self.equations(x, y)
            size = np.max(np.abs(dy), axis=1, initial=0.0)
            y += dy * np.minimum(1.0, LONGEST / np.maximum(size, LONGEST))[:, None]
            off = np.max(np.abs(lacking), axis=1, initial=0.0)
            if np.all((off < 1e-9) & (size < 1e-7) | (np.max(np.abs(y), axis=1, initial=0.0) > FARTHEST)):
                break  # the step just taken squares what is lacking
        solved = (off < 1e-6) & (size < 1e-5) & (np.max(np.abs(y), axis=1, initial=0.0) < FARTHEST)
        lacking, g, Dg, _, _ = self.equations(x, y)
        solved &= np.max(np.abs(lacking), axis=1, initial=0.0) < SOLVED
        return ReducedPoints(x, y, np.where(solved[:, None], g, np.inf), Dg, solved)

    def tolerance(self, radius: Array | float) -> Array | float:
        """Reduced constraints below this at a radius are none."""
        return np.maximum(FLAT, NOISE * self.noise * radius)

    def flat(self, radii: tuple[float, ...] = RADII) -> tuple[bool | None, Array]:
        """Whether g vanishes all about q0, so that the configurations are a smooth surface of dimension k; None where
        the regular equations cannot be solved in every direction. And the greatest radius (N,) solved in each."""
        d = directions(self.k)
        reached = np.zeros(len(d))
        for radius in radii:
            (left,) = np.nonzero(reached == 0.0)
            found = self.at(radius * d[left])
            size = np.max(np.abs(found.g), axis=1, initial=0.0)
            broken = found.solved & (size > self.tolerance(radius))
            solved = found.solved
            if np.any(broken):
                nearer = self.at(0.5 * radius * d[left])
                before = np.max(np.abs(nearer.g), axis=1, initial=0.0)
                # What is nothing at half the way cannot be as much here: Newton's steps leapt to other configurations.
                leapt = broken & (size > LEAP) & (before < self.tolerance(radius))
                solved = solved & ~leapt
                broken &= ~leapt
            reached[left[solved]] = radius
            if np.any(broken):
                return False, reached
            if np.all(reached > 0.0):
                return True, reached
        return None, reached

    def order(self) -> int | None:
        """The order n of a constraint c x^n on a kernel of one dimension: at the least radii at which it is clear."""
        sizes: list[float] = []
        radius = 0.4
        orders = []
        for _ in range(16):
            g = self.at(radius * np.array([[1.0], [-1.0]])).g
            sizes.append(float(np.max(np.abs(g))))
            radius /= 2.0
            if sizes[-1] < 1e3 * float(self.tolerance(radius)):
                break
            if len(sizes) > 1 and np.isfinite(sizes[-2]):
                orders.append(np.log2(sizes[-2] / sizes[-1]))
        return max(2, round(orders[-1])) if orders else None


def directions(k: int) -> Array:
    """Unit vectors (N, k) that no symmetry of a mechanism has: along the axes and between them, both ways."""
    numbers = np.arange(2.0, k + 2.0)
    between = np.modf(np.outer(np.arange(1, 4 + min(k, 8)), np.sqrt(numbers) + np.cbrt(numbers)))[0] - 0.5
    d = np.concatenate([np.eye(k) + 0.0123, between[: 0 if k == 1 else None]])
    d /= np.linalg.norm(d, axis=1)[:, None]
    return np.concatenate([d, -0.83 * d])


def _solved(A: Array, right: Array) -> Array:
    """A⁻¹ right for matrices (N, r, r), (N, r, m); where one is singular, the least solution."""
    if not A.shape[1]:
        return np.zeros(right.shape)
    try:
        return np.asarray(np.linalg.solve(A, right))
    except np.linalg.LinAlgError:
        return np.asarray(np.linalg.pinv(A, rcond=1e-12) @ right)


def _plain(V: Array) -> Array:
    """An orthonormal basis (n, k) of the same space that does not hang on how it was found: along the coordinates that
    have most of it."""
    P = V @ V.T
    basis = np.zeros(V.shape)
    for i in range(V.shape[1]):
        column = P[:, int(np.argmax(np.diag(P) > np.max(np.diag(P)) - 1e-9))]
        basis[:, i] = column / np.linalg.norm(column)
        P = P - np.outer(basis[:, i], basis[:, i]) @ P
        P = P - P @ np.outer(basis[:, i], basis[:, i])
    return np.asarray(np.linalg.qr(basis)[0]) if V.shape[1] else basis
