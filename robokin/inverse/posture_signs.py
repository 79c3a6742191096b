"""Signs of an arm's axes that change at its singularities only, and what each side of a part of the arm is called.

The quantities are the factors that `postures` derives; each is a function of the axes, (s,) for s configurations.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array, Flags
from robokin.kernel.code_lines import Term, written
from robokin.kernel.joint_axes import Axes, cross, dot

Quantity = Callable[[Axes], Array]
Point = Callable[[Axes], Array]

UNDECIDED = 1e-6
"""A sine, or an area in the arm's size squared, this small has no sign: a straight elbow is up, a straight wrist
no-flip, whatever the last digits say. At a double root joint values are good to 1e-8 only."""

SIDES = {"elbow": ("up", "down"), "slide": ("forward", "backward"), "det": ("positive", "negative")}
"""What the two sides of a part are called, where it is not right and left."""


@dataclass(frozen=True, eq=False)
class Sign:
    """What a part of the arm is called by the sign of a quantity (s,) of the axes: `yes` where it is not negative."""

    part: str
    yes: str
    no: str
    quantity: Quantity

    def word(self, holds: bool) -> str:
        """The part and its side."""
        return f"{self.part} {self.yes if holds else self.no}"

    def holds(self, axes: Axes) -> Flags:
        """(s,) where the first word is right."""
        return np.asarray(self.quantity(axes) >= -UNDECIDED)


def signed(values: Array, side: Array) -> Array:
    """The values (s,) where a side (s,) is not negative, else the opposite."""
    if values.dtype == object:
        terms = zip(values, side, strict=True)
        return np.array([one * Term(one.lines, f"copysign(1.0, {written(other)})") for one, other in terms])
    return np.where(side >= 0.0, 1.0, -1.0) * values


def side_of(part: str, quantity: Quantity) -> Sign:
    """The sign of a quantity by which a part is up or down, or else right or left."""
    yes, no = SIDES.get(part, ("right", "left"))
    return Sign(part, yes, no, quantity)


def turn_of(part: str, before: int, middle: int, after: int) -> Sign:
    """Whether the middle joint has turned its neighbours' axes to the positive side, sin θ ≥ 0."""
    return Sign(part, "no-flip", "flip", lambda axes: dot(axes.across(before, after), axes.z[:, middle]))


def determinant(axes: Axes) -> Array:
    """(s,) det J of six joints, lengths in the arm's size."""
    linear = np.stack([axes.velocity(i, axes.tip) for i in range(6)], axis=1)
    angular = axes.z * axes.turns[:, None]
    return np.asarray(np.linalg.det(np.concatenate([linear, angular], axis=2)))


def triple_product(i: int, j: int, point: Point) -> Quantity:
    """r · (z_i × z_j), r from where the axes meet to the point."""
    return lambda axes: dot(point(axes) - axes.meeting(i, j), axes.across(i, j))


def lever_area(i: int, j: int, point: Point) -> Quantity:
    """z_i · (r_i × r_j), r from parallel axes to the point."""

    def area(axes: Axes) -> Array:
        w = point(axes)
        return dot(cross(w - axes.foot(i, w), w - axes.foot(j, w)), axes.z[:, i])

    return area


def area_of(i: int, j: int, k: int) -> Quantity:
    """h · ((p_2 - p_1) × (p_3 - p_2)) of three parallel axes, p at the height of the tool."""

    def area(axes: Axes) -> Array:
        p, r, s = (axes.foot(joint, axes.tip) for joint in (i, j, k))
        return dot(cross(r - p, s - r), axes.z[:, i])

    return area


def multiple(factor: float, quantity: Quantity) -> Quantity:
    """factor · quantity."""
    return lambda axes: factor * quantity(axes)


def mirrored(quantity: Quantity, side: Quantity) -> Quantity:
    """The quantity where the side is not negative, else the opposite: up and down change places behind the axis."""
    return lambda axes: signed(quantity(axes), side(axes) + UNDECIDED)
