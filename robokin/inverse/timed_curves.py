"""Joint values as polynomials of the time, piece by piece: positions, velocities, accelerations, where limits are left.

Statement. A move through points takes its time: give the values of all joints, their velocities and accelerations at
any time, exactly, and the greatest of each on the way.
Derivation. A piece from time t_i on is Σ c_k (t - t_i)^k: of degree 3 at most, or the quintic that is at rest at both
of its ends, 10 τ³ - 15 τ⁴ + 6 τ⁵ of the way. Of these the places of the greatest velocity and acceleration are known.
Where a limit is left is a root, by the companion matrix.
Degenerate case. Where a curve touches a limit two roots meet, and are looked at as one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array
from robokin.model.robot import LIMIT_TOLERANCE

DEGREE = 5
REAL = 3e-5
"""Imaginary part, in the piece's duration, up to which a root counts as real: where two meet they are off by the root
of rounding."""
TINY = 1e-14
"""Coefficients below this part of the greatest are rounding."""

FAST = np.array([0.0, 0.5, 1.0])
HARD = np.array([0.0, (3.0 - np.sqrt(3.0)) / 6.0, (3.0 + np.sqrt(3.0)) / 6.0, 1.0])
"""Where, in parts of its duration, a piece may have its greatest velocity, beside a parabola's vertex, and
acceleration: at its ends, and where a quintic has them."""


@dataclass(frozen=True, eq=False)
class TimedCurve:
    """Joint values over the time.

    times: (k + 1,) [s], from 0, at which pieces begin and the last ends; coefficients: (k, 6, n), of the powers 0 to 5
    of the time since a piece began [rad | m].
    """

    times: Array
    coefficients: Array

    @property
    def duration(self) -> float:
        """How long it takes [s]."""
        return float(self.times[-1])

    def at(self, t: Array) -> tuple[Array, Array, Array]:
        """Values, velocities and accelerations, (m, n) each, at times t (m,) [s]."""
        piece = np.clip(np.searchsorted(self.times, t, side="right") - 1, 0, len(self.coefficients) - 1)
        since = (t - self.times[piece])[:, None]
        c = self.coefficients[piece]
        q, velocity, acceleration = (np.zeros((len(t), c.shape[2])) for _ in range(3))
        for k in range(DEGREE, -1, -1):
            acceleration = acceleration * since + 2.0 * velocity
            velocity = velocity * since + q
            q = q * since + c[:, k]
        return q, velocity, acceleration

    def slowed(self, factor: float) -> TimedCurve:
        """The same way in a time that is longer by a factor."""
        powers = factor ** -np.arange(DEGREE + 1.0)
        return TimedCurve(self.times * factor, self.coefficients * powers[:, None])

    def greatest(self) -> tuple[Array, Array]:
        """(n,) each: the greatest absolute velocity and acceleration of each joint [rad/s | m/s, per s²]."""
        c, lengths = self.coefficients, np.diff(self.times)[:, None, None]
        with np.errstate(divide="ignore", invalid="ignore"):
            vertex = np.where(c[:, 3] != 0.0, -c[:, 2] / (3.0 * c[:, 3]), 0.0)[:, None]
        fast = np.concatenate([lengths * FAST[:, None] + 0.0 * vertex, np.clip(vertex, 0.0, lengths)], axis=1)
        hard = lengths * HARD[:, None]
        velocity = c[:, None, 1] + fast * (
            2.0 * c[:, None, 2]
            + fast * (3.0 * c[:, None, 3] + fast * (4.0 * c[:, None, 4] + fast * 5.0 * c[:, None, 5]))
        )
        acceleration = 2.0 * c[:, None, 2] + hard * (
            6.0 * c[:, None, 3] + hard * (12.0 * c[:, None, 4] + hard * 20.0 * c[:, None, 5])
        )
        return np.max(np.abs(velocity), axis=(0, 1)), np.max(np.abs(acceleration), axis=(0, 1))

    def leaves(self, limits: Array) -> tuple[float, int, float] | None:
        """Where a joint first leaves limits (n, 2): the time [s], the joint from 0, and the limit; None for nowhere."""
        lengths = np.diff(self.times)
        q, velocity, _ = self.at(self.times)
        for k, length in enumerate(lengths):
            c = self.coefficients[k]
            # A piece stays within its control points' hull: its ends, and its ends' tangents a third on.
            ends = np.stack([q[k], q[k + 1], q[k] + velocity[k] * length, q[k + 1] - velocity[k + 1] * length])
            near = (ends.min(axis=0) < limits[:, 0]) | (ends.max(axis=0) > limits[:, 1])
            found = [(*one, j) for j in np.flatnonzero(near) if (one := _exit(c[:, j], limits[j], float(length)))]
            if found:
                at, limit, j = min(found)
                return float(self.times[k] + at), int(j), limit
        return None


def _exit(c: Array, limits: Array, length: float) -> tuple[float, float] | None:
    """When a polynomial first leaves limits (2,) beyond rounding, within a length, and which; None for never."""
    turning = _roots(c[1:] * np.arange(1.0, len(c)), length)
    found = []
    for limit, side in ((float(limits[0]), -1.0), (float(limits[1]), 1.0)):
        away = side * c
        away[0] -= side * limit
        marks = sorted([0.0, length, *turning, *_roots(away, length)])
        for before, mark in zip([0.0, *marks], marks, strict=False):
            if np.polynomial.polynomial.polyval(mark, away) > LIMIT_TOLERANCE:
                found.append((before, limit))
                break
    return min(found, default=None)


def _roots(c: Array, length: float) -> list[float]:
    """The real roots between 0 and a length of a polynomial with coefficients c, the constant first."""
    scaled = c * length ** np.arange(float(len(c)))
    kept = np.flatnonzero(np.abs(scaled) > TINY * float(np.max(np.abs(scaled), initial=0.0)))
    if not len(kept) or kept[-1] == 0:
        return []
    roots = np.polynomial.polynomial.polyroots(scaled[: kept[-1] + 1])
    real = roots.real[(np.abs(roots.imag) <= REAL) & (roots.real > 0.0) & (roots.real < 1.0)]
    return [float(root) * length for root in real]
