"""What the other joints see of one joint: functions of its angle or its length.

For a revolute joint a function is (f0, f1, f2), meaning f0 + f1 cos q + f2 sin q, and a product of two
such, in which cos 2q and sin 2q follow. For a prismatic joint it is a polynomial (f0, f1, …) in q. The two
kinds have the same methods, so that an equation is written once for both.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import cast

import numpy as np

from robokin.arrays import Flags
from robokin.inverse.closed_form.trigonometry import (
    Turn,
    linear_roots,
    quadratic_roots,
    quartic_roots,
    second_degree_roots,
    turned,
    turned_back,
)
from robokin.kernel.entries import Entry, Vector, angle, dot, minus, plus, root, times

Form = Sequence[Entry]
Motion = tuple[Entry, ...]
"""A joint's position: (cos, sin) or (length,)."""

LOOSE = 1e-6
"""Where every coefficient of an equation is below this for a target, the equation is taken to say nothing:
more than rounding (1e-15) and its square root (3e-8) after a double root."""

FAN = np.arange(24) * (np.pi / 12.0)
"""Where to look when an angle is not determined: right angles among them, and near enough to each other
that what later joints can reach is not passed over."""

LENGTHS = np.linspace(-1.0, 1.0, 25)
"""Likewise for a length, in units of the arm's size."""

VANISHES = 1e-12
"""A constant coefficient (in units of the arm's size) below this is 0."""


def combined(weights: Sequence[Entry], forms: Sequence[Form]) -> list[Entry]:
    """The sum of weights times forms, which may be of different lengths."""
    out: list[Entry] = [0.0] * max(len(form) for form in forms)
    for weight, form in zip(weights, forms, strict=True):
        for i, f in enumerate(form):
            out[i] = plus(out[i], times(weight, f))
    return out


class Revolute:
    """J = Rz(q)."""

    fan: Motion = (np.cos(FAN)[:, None], np.sin(FAN)[:, None])
    """Positions (24, 1) for a joint that is not determined."""

    @staticmethod
    def carried(u: Vector) -> list[Form]:
        """J u as three forms."""
        x, y, z = u
        return [[0.0, x, times(-1.0, y)], [0.0, y, x], [z, 0.0, 0.0]]

    @staticmethod
    def square(u: Vector) -> Form:
        """|J u|²."""
        return [dot(u, u), 0.0, 0.0]

    @staticmethod
    def product(f: Form, g: Form) -> Form:
        """f g: (1, cos q, sin q, cos 2q, sin 2q)."""
        cc, ss = times(f[1], g[1]), times(f[2], g[2])
        cs = plus(times(f[1], g[2]), times(f[2], g[1]))
        return [
            plus(times(f[0], g[0]), times(0.5, plus(cc, ss))),
            plus(times(f[0], g[1]), times(f[1], g[0])),
            plus(times(f[0], g[2]), times(f[2], g[0])),
            times(0.5, minus(cc, ss)),
            times(0.5, cs),
        ]

    @staticmethod
    def roots(f: Form) -> tuple[Turn, Flags]:
        """All q with f = 0, on a new first axis, and which are real."""
        if all(vanishes(part) for part in f[3:]):
            return linear_roots(f[1], f[2], times(-1.0, f[0]))
        return second_degree_roots(f)

    @staticmethod
    def at(f: Form, motion: Motion) -> Entry:
        """f, of the first degree, at q."""
        return plus(f[0], plus(times(f[1], motion[0]), times(f[2], motion[1])))

    @staticmethod
    def onward(motion: Motion, p: Vector) -> list[Entry]:
        """J p, a point."""
        return turned(_turn(motion), p)

    @staticmethod
    def back(motion: Motion, p: Vector) -> list[Entry]:
        """J⁻¹ p, a point."""
        return turned_back(_turn(motion), p)

    @staticmethod
    def back_direction(motion: Motion, p: Vector) -> list[Entry]:
        """J⁻¹ p, a direction."""
        return turned_back(_turn(motion), p)

    @staticmethod
    def value(motion: Motion) -> Entry:
        """q [rad]."""
        return angle(*_turn(motion))


class Prismatic:
    """J = Trans(0, 0, q)."""

    fan: Motion = (LENGTHS[:, None],)
    """Positions (25, 1) for a joint that is not determined."""

    @staticmethod
    def carried(u: Vector) -> list[Form]:
        """J u as three forms."""
        return [[u[0], 0.0], [u[1], 0.0], [u[2], 1.0]]

    @staticmethod
    def square(u: Vector) -> Form:
        """|J u|²."""
        return [dot(u, u), times(2.0, u[2]), 1.0]

    @staticmethod
    def product(f: Form, g: Form) -> Form:
        """f g."""
        out: list[Entry] = [0.0] * (len(f) + len(g) - 1)
        for i, a in enumerate(f):
            for j, b in enumerate(g):
                out[i + j] = plus(out[i + j], times(a, b))
        return out

    @staticmethod
    def roots(f: Form) -> tuple[Motion, Flags]:
        """All q with f = 0, on a new first axis, and which are real."""
        coefficients = list(f)
        while len(coefficients) > 2 and vanishes(coefficients[-1]):
            coefficients.pop()
        if len(coefficients) > 3:
            # A cubic times q: its root 0 is one candidate too many.
            coefficients = [*[0.0] * (5 - len(coefficients)), *coefficients]
            q, real = quartic_roots(coefficients[::-1])
        else:
            coefficients += [0.0] * (3 - len(coefficients))
            q, real = quadratic_roots(coefficients[2], coefficients[1], coefficients[0])
        return (q,), real

    @staticmethod
    def at(f: Form, motion: Motion) -> Entry:
        """f at q."""
        value = f[-1]
        for part in reversed(f[:-1]):
            value = plus(times(value, motion[0]), part)
        return value

    @staticmethod
    def onward(motion: Motion, p: Vector) -> list[Entry]:
        """J p, a point."""
        return [p[0], p[1], plus(p[2], motion[0])]

    @staticmethod
    def back(motion: Motion, p: Vector) -> list[Entry]:
        """J⁻¹ p, a point."""
        return [p[0], p[1], minus(p[2], motion[0])]

    @staticmethod
    def back_direction(motion: Motion, p: Vector) -> list[Entry]:
        """J⁻¹ p, a direction."""
        return list(p)

    @staticmethod
    def value(motion: Motion) -> Entry:
        """q [size]."""
        return motion[0]


Kind = type[Revolute] | type[Prismatic]


def kind(revolute: bool) -> Kind:
    """The kind of a joint."""
    return Revolute if revolute else Prismatic


def vanishes(f: Entry) -> bool:
    """Whether a coefficient is 0 for every target."""
    return isinstance(f, float) and abs(f) < VANISHES


def loose(f: Form) -> Flags | None:
    """For which targets f vanishes identically; None when for none."""
    if any(isinstance(part, float) and abs(part) >= LOOSE for part in f):
        return None
    vanishing = np.ones(1, dtype=bool)
    for part in f:
        vanishing = vanishing & np.asarray(np.abs(part) < LOOSE)
    return vanishing if vanishing.any() else None


def parallel_gradient(forms: Sequence[Form]) -> tuple[float, float] | None:
    """The unit vector (n_c, n_s), if all forms of an angle depend on n_c cos q + n_s sin q alone.

    None where they do not for every target, or depend on nothing.
    """
    gradients: list[tuple[float, float]] = []
    longest, length = (0.0, 0.0), 0.0
    for form in forms:
        c, s = form[1], form[2]
        if not (isinstance(c, float) and isinstance(s, float)):
            return None
        gradients.append((c, s))
        size = cast(float, root(c * c + s * s))
        if size > length:
            longest, length = (c, s), size
    if not length > VANISHES:
        return None
    n_c, n_s = longest[0] / length, longest[1] / length
    across = [n_c * s - n_s * c for c, s in gradients]
    return (n_c, n_s) if all(abs(one) < VANISHES for one in across) else None


def _turn(motion: Motion) -> Turn:
    c, s = motion
    return c, s


def seen_turned(h: Vector, alpha: Vector) -> Form:
    """(R_aᵀ h) · α as a function of q_a."""
    return [
        times(h[2], alpha[2]),
        plus(times(h[0], alpha[0]), times(h[1], alpha[1])),
        minus(times(h[1], alpha[0]), times(h[0], alpha[1])),
    ]


def square_across(v: Vector) -> Entry:
    """x² + y² of a vector."""
    return plus(times(v[0], v[0]), times(v[1], v[1]))
