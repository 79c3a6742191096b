"""Joints of mechanisms as twists, one for each freedom, in the world's axes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array
from robokin.model import MechanismJoint


@dataclass(frozen=True, eq=False)
class Element:
    """A joint between two bodies whose motions are a subgroup.

    name: of the mechanism's joint; a, b: the bodies; screws: (f, 6) a basis of its twists at the reference,
    lengths in the mechanism's size; labels: what each freedom is, for tables: `turn`, `slide`; at: (3,) where it is,
    or None.
    """

    name: str
    a: int
    b: int
    screws: Array
    labels: tuple[str, ...]
    at: Array | None = None


def turn(at: Array, axis: Array) -> Array:
    """The twist (6,) of a turn about an axis (3,) through a point (3,)."""
    return np.concatenate([np.cross(at, axis), axis])


def slide(axis: Array) -> Array:
    """The twist (6,) of a slide along an axis (3,)."""
    return np.concatenate([axis, np.zeros(3)])


def across(axis: Array) -> tuple[Array, Array]:
    """Two unit directions (3,) at right angles to an axis (3,) and to each other."""
    least = np.eye(3)[np.argmin(np.abs(axis))]
    first = np.cross(axis, least)
    first /= np.linalg.norm(first)
    return first, np.cross(axis, first)


def has_geometry(joint: MechanismJoint) -> bool:
    """Whether enough is known of a joint to say how it moves."""
    kind, at, axes = joint.type, joint.at, joint.axes
    if kind == "fixed" or joint.gearing:
        return True  # of wheels whose ratio is known the hinges say the rest
    if kind == "belt":
        return False
    if kind == "prismatic":
        return axes is not None
    if kind == "spherical":
        return at is not None
    if kind in ("gear", "cam"):
        # The contact's common normal lies in the plane; the plane's own normal says nothing.
        return at is not None and axes is not None and bool(abs(axes[0, 2]) < 0.5)
    if kind == "planar":
        return axes is not None
    if kind == "custom":
        return joint.freedoms == 0
    return at is not None and axes is not None


def elements_of(joint: MechanismJoint, middle: Array, size: float) -> list[tuple[Array, tuple[str, ...]]]:
    """The subgroup joints (screws, labels) that a joint is made of, one after the other.

    Points are measured from `middle` (3,) [m] in units of `size` [m].
    """
    at = np.zeros(3) if joint.at is None else (joint.at - middle) / size
    axes = np.zeros((0, 3)) if joint.axes is None else joint.axes
    kind = joint.type
    if kind in ("fixed", "custom"):
        return [(np.zeros((0, 6)), ())]
    if kind in ("revolute", "rolling"):
        return [(turn(at, axes[0])[None], ("turn",))]
    if kind == "prismatic":
        return [(slide(axes[0])[None], ("slide",))]
    if kind == "helical":
        screw = turn(at, axes[0])
        screw[:3] += joint.pitch / size * axes[0]
        return [(screw[None], ("turn",))]
    if kind == "cylindrical":
        return [(np.stack([turn(at, axes[0]), slide(axes[0])]), ("turn", "slide"))]
    if kind == "universal":
        return [(turn(at, axis)[None], ("turn",)) for axis in axes]
    if kind == "spherical":
        return [(np.stack([turn(at, axis) for axis in np.eye(3)]), ("turn x", "turn y", "turn z"))]
    if kind == "planar":
        first, second = across(axes[0])
        screws = np.stack([slide(first), slide(second), turn(at, axes[0])])
        return [(screws, ("slide", "slide 2", "turn"))]
    # A contact in the plane: turning about the point, and sliding across the common normal.
    tangent = np.cross([0.0, 0.0, 1.0], axes[0])
    return [(np.stack([turn(at, np.array([0.0, 0.0, 1.0])), slide(tangent)]), ("turn", "slide"))]
