"""Curves that a tool follows: straight lines and circular arcs, with the rotation about one fixed axis.

Statement. Give the pose of the tool at the part s of a way, and its twist dx/ds there.
Derivation. A line: the position is linear in s, the rotation turns about the axis of R_0ᵀ R_1 (slerp), of half a turn
about that whose first element that is not zero is positive. An arc: the
circle through three places, from the first by the second to the third; the rotation as on a line.
Degenerate case. Three places on a line, or two in one, are on no circle.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np

from robokin.arrays import Array
from robokin.errors import InputError
from robokin.spatial import axis_angle_from_rotation, rotation_from_axis_angle, transform

STRAIGHT = 1e-6
"""The sine of the corner of three places below which they are on a line."""


HALF_TURN = 1e-9
"""An angle this near to half a turn [rad] is one: either way round is as short."""

UNSIGNED = 1e-6
"""Elements of its axis below this are zeros: they do not tell which way round is taken."""


class ToolCurve(Protocol):
    """What a tool follows."""

    def at(self, s: Array) -> Array:
        """Poses (m, 4, 4) [m] at s (m,) from 0 to 1."""

    def twist(self, s: Array) -> Array:
        """Twists (m, 6) by s, linear before angular, in the world's axes [m, rad]."""

    @property
    def places(self) -> Array:
        """(m,) parts of the way at which limits of velocity and acceleration are held beside even ones."""


class SlerpedTurn:
    """Rotations from the first pose's to the last one's about a fixed axis, by the fraction s of the way."""

    def __init__(self, first: Array, last: Array) -> None:
        self.first = first
        axis, angle = axis_angle_from_rotation(first[:3, :3].T @ last[:3, :3])
        self.axis, self.angle = axis, float(angle)
        if self.half_turn and axis[np.argmax(np.abs(axis) > UNSIGNED)] < 0.0:
            # Rounding must not toss which way round it turns.
            self.axis, self.angle = -axis, 2.0 * np.pi - self.angle

    places = np.empty(0)
    """One piece as the other is looked at in even steps."""

    @property
    def half_turn(self) -> bool:
        """Whether it is as short the other way round: then the first element of the axis is positive."""
        return self.angle > np.pi - HALF_TURN

    def rotation(self, s: Array) -> Array:
        """(m, 3, 3) at s (m,)."""
        axes = np.broadcast_to(self.axis, (len(s), 3))
        return np.asarray(self.first[:3, :3] @ rotation_from_axis_angle(axes, s * self.angle))

    def spin(self) -> Array:
        """The angular part (3,) of the twist [rad]."""
        return np.asarray(self.first[:3, :3] @ self.axis * self.angle)


class Line(SlerpedTurn):
    """The poses between two, by the fraction s of the way."""

    def __init__(self, first: Array, last: Array) -> None:
        super().__init__(first, last)
        self.p = last[:3, 3] - first[:3, 3]
        self.distance = float(np.linalg.norm(self.p))

    def at(self, s: Array) -> Array:
        """(m, 4, 4) at s (m,)."""
        return transform(self.rotation(s), self.first[:3, 3] + s[:, None] * self.p)

    def twist(self, s: Array) -> Array:
        """(m, 6) at s (m,)."""
        return np.broadcast_to(np.concatenate([self.p, self.spin()]), (len(s), 6))


class CircularArc(SlerpedTurn):
    """The poses on the circle from one by a place `via` (3,) [m] to another. Raises InputError where there is none."""

    def __init__(self, first: Array, via: Array, last: Array) -> None:
        super().__init__(first, last)
        a, b, c = first[:3, 3], via, last[:3, 3]
        u, v = b - a, c - a
        normal = np.cross(u, v)
        size = float(np.linalg.norm(normal))
        if np.linalg.norm(v) <= STRAIGHT * np.linalg.norm(u) and np.any(u):
            raise InputError("the arc ends where it begins, expected another end: a whole circle is two arcs")
        if size <= STRAIGHT * float(np.linalg.norm(u) * np.linalg.norm(v)) or not np.any(u) or not np.any(c - b):
            raise InputError("the three places of the arc are on a line, expected places on a circle")
        self.normal = normal / size
        self.centre = a + (np.dot(v, v) * np.cross(normal, u) - np.dot(u, u) * np.cross(normal, v)) / (
            2.0 * size * size
        )
        self.radius = a - self.centre
        side = np.cross(self.normal, self.radius)
        out = c - self.centre
        # In the sense of the normal the circle goes from the first place by the second to the third.
        self.sweep = float(np.arctan2(out @ side, out @ self.radius)) % (2.0 * np.pi)
        self.distance = self.sweep * float(np.linalg.norm(self.radius))

    def at(self, s: Array) -> Array:
        """(m, 4, 4) at s (m,)."""
        return transform(self.rotation(s), self.centre + self._spokes(s))

    def twist(self, s: Array) -> Array:
        """(m, 6) at s (m,)."""
        linear = self.sweep * np.cross(self.normal, self._spokes(s))
        return np.concatenate([linear, np.broadcast_to(self.spin(), (len(s), 3))], axis=1)

    def _spokes(self, s: Array) -> Array:
        angles = (s * self.sweep)[:, None]
        return np.asarray(np.cos(angles) * self.radius + np.sin(angles) * np.cross(self.normal, self.radius))
