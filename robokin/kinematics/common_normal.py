"""The step from one axis to the next along their common normal."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

from robokin.arrays import Array
from robokin.spatial.dh import standard_dh

PARALLEL = 1e-9
"""Sine of an angle below which axes count as parallel."""

NEARLY_PARALLEL = 1e-3
"""Sine of an angle below which the common normal may be anywhere: a change of 1e-16 of it moves the feet by 1e-10."""

FAR_FEET = 100.0
"""Distance from the frames to the feet of the common normal, in the arm's size, that a table of nearly parallel axes
may have: rounding of cells is as many times that of a plain table."""


@dataclass(frozen=True)
class NormalStep:
    """Rot(z, theta) Trans(0, 0, d) Trans(a, 0, 0) Rot(x, alpha) Trans(0, 0, e) Rot(z, phi): angles [rad], lengths [m].

    tilt: the angle between the axes, taken as lines without a direction; snapped: the same where it counts as none.
    """

    theta: float
    d: float
    a: float
    alpha: float
    e: float = 0.0
    phi: float = 0.0
    tilt: float = 0.0
    snapped: float = 0.0

    @cached_property
    def feet(self) -> float:
        """How far [m] the farther foot of the common normal is from the frames."""
        return max(abs(self.d), abs(self.e))

    def tilted(self, far: float) -> bool:
        """Whether the axes are nearly parallel and their common normal is farther away than that [m]."""
        return PARALLEL <= self.tilt < NEARLY_PARALLEL and self.feet > far

    def link(self) -> Array:
        """Trans(a, 0, 0) Rot(x, alpha): (4, 4)."""
        return standard_dh(0.0, 0.0, self.a, self.alpha)

    def ended(self) -> NormalStep:
        """The same step with as much as possible of its shift and turn at the end, where axes are parallel, before."""
        if self.tilt >= PARALLEL:
            return self
        way = 1.0 if self.alpha == 0.0 else -1.0
        free = self.a == 0.0
        theta = math.remainder(self.theta + way * self.phi, 2.0 * math.pi) if free else self.theta
        return replace(self, theta=theta, d=self.d + way * self.e, e=0.0, phi=0.0 if free else self.phi)

    def rest(self) -> Array:
        """Trans(0, 0, e) Rot(z, phi): (4, 4), what lets the motion of the next joint pass."""
        return turn_and_shift(self.phi, self.e)


def turn_and_shift(phi: float, e: float) -> Array:
    """Trans(0, 0, e) Rot(z, phi): (4, 4)."""
    return standard_dh(phi, e, 0.0, 0.0)


def turn(T: Array) -> Array:
    """The rotation of a transform (4, 4) alone."""
    R = T.copy()
    R[:3, 3] = 0.0
    return R


def normal_step(C: Array, small: float) -> NormalStep:
    """A transform C (4, 4) from the frame of one axis, its z, to that of the next, as a step along their common normal.

    Lengths up to `small` [m] between axes are none: axes that meet, or are one. Of the two directions of the normal
    that with a > 0 is taken, where the axes meet that with the smaller turn. Parallel axes leave d free: it is 0.
    """
    p, z = C[:3, 3], C[:3, 2]
    sine = math.hypot(z[0], z[1])
    if sine < PARALLEL:
        return _parallel_step(C, small, sine)
    theta = math.atan2(z[0], -z[1])  # of z × z'
    a = math.cos(theta) * p[0] + math.sin(theta) * p[1]
    if (a < 0.0 and abs(a) > small) or (abs(a) <= small and abs(theta) > math.pi / 2.0 + 1e-12):
        theta, a = math.atan2(-z[0], z[1]), -a
    ct, st = math.cos(theta), math.sin(theta)
    # In the frame that is turned by theta the next axis is (0, -sin alpha, cos alpha), but for rounding.
    y, across = -st * p[0] + ct * p[1], -st * z[0] + ct * z[1]
    alpha = math.atan2(-across, z[2])
    e = -y / across if across else 0.0
    step = NormalStep(theta, float(p[2] + e * z[2]), 0.0 if abs(a) <= small else float(a), alpha, tilt=sine)
    return _with_rest(step, C, -e)


def _parallel_step(C: Array, small: float, sine: float) -> NormalStep:
    p = C[:3, 3]
    alpha = 0.0 if C[2, 2] > 0.0 else math.pi
    a = math.hypot(p[0], p[1])
    theta = math.atan2(p[1], p[0]) if a > small else 0.0
    step = NormalStep(theta, 0.0, a if a > small else 0.0, alpha, tilt=sine, snapped=sine)
    return _with_rest(step, C, float(p[2]) if alpha == 0.0 else -float(p[2]))


def _with_rest(step: NormalStep, C: Array, e: float) -> NormalStep:
    """A step with what is left of C (4, 4) once it is taken: a shift e along its last axis, and a turn about that."""
    R = standard_dh(step.theta, 0.0, 0.0, step.alpha)[:3, :3].T @ C[:3, :3]
    phi = math.atan2(float(R[1, 0] - R[0, 1]), float(R[0, 0] + R[1, 1]))
    return NormalStep(step.theta, step.d, step.a, step.alpha, e + 0.0, phi, step.tilt, step.snapped)
