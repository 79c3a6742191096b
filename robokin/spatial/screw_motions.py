"""The screw motion that takes one frame to another.

Statement. Of all motions from a frame A to a frame B one turns about a fixed line and slides along it, both evenly
(Mozzi and Chasles).
Derivation. B A⁻¹ turns by an angle about a direction a. What A's origin moves, d, has the part h along a; the rest d'
is the chord of an arc about the line, whose foot lies at (d' + cot(angle / 2) a × d') / 2 from A's origin.
Degenerate case. Without a turn the line is infinitely far away: the motion is a translation along d. By half a turn
either end of the direction serves.
Source: R. M. Murray, Z. Li and S. S. Sastry, A Mathematical Introduction to Robotic Manipulation, 1994, section 2.3.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array
from robokin.spatial import axis_angle_from_rotation, rotation_from_axis_angle, transform

NO_TURN = 1e-10
"""An angle [rad] below which there is no turn: of a smaller one rounding would place the axis."""


@dataclass(frozen=True, eq=False)
class ScrewMotion:
    """A turn about a line and a slide along it, from the frame `first` to the frame `last` (4, 4) [m].

    axis (3,): the line's direction, None where nothing moves; point (3,) [m]: its place nearest to the origin, None
    for a translation; angle [rad] from 0 to half a turn; slide [m] along the axis.
    """

    first: Array
    last: Array
    axis: Array | None
    point: Array | None
    angle: float
    slide: float

    @property
    def pitch(self) -> float | None:
        """The slide for each radian [m]; None for a translation."""
        return self.slide / self.angle if self.angle else None

    def at(self, s: Array) -> Array:
        """Poses (m, 4, 4) [m] at the parts s (m,) of the motion, from 0 to 1."""
        axis = np.array([0.0, 0.0, 1.0]) if self.axis is None else self.axis
        R = rotation_from_axis_angle(np.broadcast_to(axis, (len(s), 3)), s * self.angle) @ self.first[:3, :3]
        d = self.last[:3, 3] - self.first[:3, 3]
        along = self.slide * axis
        # By half angles: the line may be far away, and differences of its distance would lose the digits.
        half, part = 0.5 * self.angle, 0.5 * self.angle * s
        sine = np.sin(part) / np.sin(half) if self.angle else s
        chord, aside = sine * np.cos(part - half), sine * np.sin(part - half)
        across = d - along
        p = self.first[:3, 3] + np.outer(s, along) + np.outer(chord, across) + np.outer(aside, np.cross(axis, across))
        return transform(R, p)


def screw_between(first: Array, last: Array) -> ScrewMotion:
    """The screw motion from one frame to another: (4, 4) [m]."""
    axis, turn = axis_angle_from_rotation(last[:3, :3] @ first[:3, :3].T)
    angle, d = float(turn), last[:3, 3] - first[:3, 3]
    if angle < NO_TURN:
        distance = float(np.linalg.norm(d))
        return ScrewMotion(first, last, d / distance if distance else None, None, 0.0, distance)
    slide = float(axis @ d)
    across = d - slide * axis
    point = first[:3, 3] + 0.5 * (across + np.cross(axis, across) / np.tan(0.5 * angle))
    return ScrewMotion(first, last, axis, point - (point @ axis) * axis + 0.0, angle, slide)
