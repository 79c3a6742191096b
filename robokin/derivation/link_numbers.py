"""The link between two joint axes in Denavit and Hartenberg's four numbers, whatever convention a description has.

A constant transform between two joints is Rot(z, β) Trans(0, 0, δ) Trans(a, 0, 0) Rot(x, α) Rot(z, γ) Trans(0, 0, ε):
along the first axis to the common normal, along that, and along the second axis. β and δ belong to the joint before
(θ = q + … + β, d = … + δ), γ and ε to the joint after. A row of a standard table comes out as itself (β = γ = 0 = ε),
signs of a and α included.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array
from robokin.spatial import invert, rotation_transform, transform

Z = np.array([0.0, 0.0, 1.0])

SAME = 1e-9
"""Sines of angles and lengths in metres as parts of the arm's size: below, axes are parallel, or meet. Tables are
good to 1e-12, measured arms no better than 1e-5."""

ROUNDING = 1e-12
"""Multiples of a right angle, and lengths of zero, are that to within rounding (the length in the arm's size)."""


@dataclass(frozen=True)
class Link:
    """The six numbers [rad, m]; the axes are parallel where sin α = 0."""

    beta: float
    delta: float
    a: float
    alpha: float
    gamma: float
    epsilon: float

    @property
    def parallel(self) -> bool:
        """Whether the two axes have one direction, or opposite ones."""
        return abs(math.sin(self.alpha)) < SAME

    @property
    def right_angled(self) -> bool:
        """Whether the two axes are at right angles."""
        return abs(math.cos(self.alpha)) < SAME

    @property
    def sign(self) -> int:
        """The sign of sin α for axes at right angles, of cos α for parallel ones."""
        return int(np.sign(math.sin(self.alpha) if self.right_angled else math.cos(self.alpha)))


def link_of(C: Array, size: float) -> Link:
    """The link of a constant transform C (4, 4) [m]; size: the arm's [m]."""
    x, y = C[:2, 2]
    parallel = math.hypot(x, y) < SAME
    if parallel:
        apart = math.hypot(C[0, 3], C[1, 3]) > ROUNDING * size
        beta = math.atan2(C[1, 3], C[0, 3]) if apart else math.atan2(C[1, 0], C[0, 0])
        beta = _half(beta) if apart else beta
    else:
        beta = _half(math.atan2(x, -y))
    beta = right(beta)
    turned = rotation_transform(Z, -beta) @ C
    alpha = right(math.atan2(-turned[1, 2], turned[2, 2]))
    a, across, height = turned[:3, 3]
    epsilon = 0.0 if parallel else -across / math.sin(alpha)
    rest = rotation_transform([1.0, 0.0, 0.0], -alpha) @ turned
    gamma = right(math.atan2(rest[1, 0], rest[0, 0]))
    numbers = (height - epsilon * math.cos(alpha), a, epsilon)
    delta, a, epsilon = (0.0 if abs(length) < ROUNDING * size else float(length) for length in numbers)
    return Link(beta, delta, a, alpha, gamma, epsilon)


def end_of(C: Array, size: float) -> tuple[Link, Array]:
    """The last link as a row of a table, without γ and ε, and what is left of C (4, 4) after it."""
    link = link_of(C, size)
    row = Link(link.beta, link.delta, link.a, link.alpha, 0.0, 0.0)
    rest = invert(row_transform(row)) @ C
    return row, np.where(np.abs(rest - np.round(rest)) < ROUNDING, np.round(rest), rest) + 0.0


def reach_of(C: Array, size: float) -> Link:
    """The last link of an arm of which only the hand's point counts, C's origin: α = 0."""
    return link_of(transform(np.eye(3), C[:3, 3]), size)


def row_transform(link: Link) -> Array:
    """Rot(z, β) Trans(0, 0, δ) Trans(a, 0, 0) Rot(x, α) as (4, 4)."""
    turn = rotation_transform(Z, link.beta) @ transform(np.eye(3), np.array([link.a, 0.0, link.delta]))
    return turn @ rotation_transform([1.0, 0.0, 0.0], link.alpha)


def right(angle: float) -> float:
    """An angle with rounding about a multiple of a right angle taken out of it."""
    turns = round(angle / (math.pi / 2.0))
    near = turns * (math.pi / 2.0)
    return near if abs(angle - near) < ROUNDING else angle


def _half(angle: float) -> float:
    """The angle, or half a turn off, in (-π/2, π/2]: the sign of a, or of α, tells the rest."""
    angle = right(angle)
    return angle - math.pi * math.ceil(angle / math.pi - 0.5 - ROUNDING)
