"""Twists of joints, and rigid motions as their exponentials.

A twist is (v, w): the velocity of the point that is at the origin, and the angular velocity, in the world's axes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array
from robokin.model import MechanismJoint
from robokin.spatial import transform

SMALL = 1e-4
"""An angle [rad] below which sin and cos quotients are taken from their series, good to 1e-17 there."""


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


def moved_screws(g: Array, screws: Array) -> Array:
    """Ad(g) S: twists (f, 6) carried along by displacements g (f, 4, 4)."""
    R, t = g[:, :3, :3], g[:, :3, 3]
    v = np.einsum("fij,fj->fi", R, screws[:, :3])
    w = np.einsum("fij,fj->fi", R, screws[:, 3:])
    return np.concatenate([v + np.cross(t, w), w], axis=1)


def exponential(twists: Array) -> Array:
    """The rigid motions (m, 4, 4) of unit time at twists (m, 6)."""
    v, w = twists[:, :3], twists[:, 3:]
    angle = np.linalg.norm(w, axis=1)[:, None]
    small = angle < SMALL
    safe = np.where(small, 1.0, angle)
    square = angle * angle
    a = np.where(small, 1.0 - square / 6.0, np.sin(safe) / safe)
    # Half angles: 1 - cos would lose half of its digits where the angle is small.
    b = np.where(small, 0.5 - square / 24.0, 2.0 * (np.sin(0.5 * safe) / safe) ** 2)
    c = np.where(small, 1.0 / 6.0 - square / 120.0, (safe - np.sin(safe)) / safe**3)
    W = skew(w)
    WW = W @ W
    R = np.eye(3) + a[:, :, None] * W + b[:, :, None] * WW
    V = np.eye(3) + b[:, :, None] * W + c[:, :, None] * WW
    return transform(R, np.einsum("mij,mj->mi", V, v))


def logarithm(T: Array) -> Array:
    """The twists (m, 6) of unit time that lead to rigid motions T (m, 4, 4), turned by less than 180°."""
    R, t = T[:, :3, :3], T[:, :3, 3]
    w = 0.5 * np.stack([R[:, 2, 1] - R[:, 1, 2], R[:, 0, 2] - R[:, 2, 0], R[:, 1, 0] - R[:, 0, 1]], axis=1)
    sine = np.linalg.norm(w, axis=1)[:, None]
    cosine = 0.5 * (np.trace(R, axis1=1, axis2=2)[:, None] - 1.0)
    angle = np.arctan2(sine, cosine)
    small = angle < SMALL
    w = w * np.where(small, 1.0 + angle * angle / 6.0, angle / np.where(small, 1.0, sine))
    half = 0.5 * np.where(small, 1.0, angle)
    k = np.where(
        small, 1.0 / 12.0 + angle * angle / 720.0, (1.0 - half / np.tan(half)) / np.where(small, 1.0, angle) ** 2
    )
    W = skew(w)
    V = np.eye(3) - 0.5 * W + k[:, :, None] * (W @ W)
    return np.concatenate([np.einsum("mij,mj->mi", V, t), w], axis=1)


def skew(w: Array) -> Array:
    """The matrices (..., 3, 3) of the cross product with vectors (..., 3)."""
    W = np.zeros((*w.shape[:-1], 3, 3))
    W[..., 0, 1], W[..., 0, 2], W[..., 1, 2] = -w[..., 2], w[..., 1], -w[..., 0]
    W[..., 1, 0], W[..., 2, 0], W[..., 2, 1] = w[..., 2], -w[..., 1], w[..., 0]
    return W
