"""A picture of a mechanism before anything is drawn: its shape, its motion, the eye."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array
from robokin.mobility.trace import Trace
from robokin.model import Mechanism
from robokin.pictures.arm_faces import Face, colour, prism_faces
from robokin.pictures.arm_scene import PLANES, SLANTING
from robokin.pictures.mechanism_shape import Shape, shape_of
from robokin.units import Units

PLAYED = 5.0
"""Seconds in which a motion is played."""

MARGIN = 0.03
"""Room about what is drawn, as a part of its longest side."""

PALE = 0.6
"""How pale plates are, which lie behind their rims."""


@dataclass(frozen=True, eq=False)
class MechanismScene:
    """A mechanism's shape and motion.

    trace: configurations along its motion, or None; paths: (m, points, 3) [m] those of points that are followed;
    view: azimuth and elevation [°] of the eye; note: what the user should know; words: the mechanism and its options as
    a command line has them, by default the name.
    """

    mechanism: Mechanism
    shape: Shape
    units: Units
    trace: Trace | None
    paths: Array
    view: tuple[float, float]
    note: str = ""
    words: str = ""

    def lead(self) -> int:
        """The number of the joint value that leads the motion; -1 where there is none, or the joint has several."""
        if self.trace is None or self.trace.driven not in self.trace.labels:
            return -1
        return self.trace.labels.index(self.trace.driven)

    def ways(self) -> list[Array]:
        """The ways (m, 3) [m] of joints that move, those of links that do not stand still."""
        if self.trace is None:
            return []
        ways = []
        for joint, place in zip(self.mechanism.joints, self.shape.places, strict=True):
            if self.mechanism.ground in joint.links or joint.gearing or joint.type == "prismatic":
                continue
            T = self.trace.poses[:, self.trace.links.index(joint.links[0])]
            ways.append(T[:, :3, :3] @ place + T[:, :3, 3])
        return ways

    def bounds(self) -> tuple[Array, Array]:
        """Corners (3,), (3,) [m] of a box about the mechanism as assembled and the ways of its joints."""
        points = [np.array([p.a, p.b]) + s * max(p.widths) for p in self.shape.pieces for s in (-1.0, 1.0)]
        points += [plate.corners for plate in self.shape.plates]
        points += [*self.ways(), *(self.paths[:, i] for i in range(self.paths.shape[1]))]
        low, high = np.min(np.concatenate(points), axis=0), np.max(np.concatenate(points), axis=0)
        margin = MARGIN * float(np.max(high - low))
        return low - margin, high + margin


def mechanism_scene(
    mechanism: Mechanism, trace: Trace | None, paths: Array | None, units: Units,
    view: tuple[float, float] | None = None, note: str = "",
) -> MechanismScene:  # fmt: skip
    """The scene of a mechanism; a planar one is seen from above unless a view is given."""
    usual = PLANES[2] if mechanism.space == "planar" else SLANTING
    m = 0 if trace is None else len(trace.poses)
    empty = np.zeros((m, 0, 3))
    return MechanismScene(
        mechanism, shape_of(mechanism), units, trace, empty if paths is None else paths, view or usual, note
    )


def shape_faces(shape: Shape, poses: Array, eye: Array) -> Iterator[Face]:
    """The faces that an eye sees of a shape whose links are displaced by poses (n, 4, 4) [m]."""

    def placed(body: int, p: Array) -> Array:
        return np.asarray(p @ poses[body, :3, :3].T + poses[body, :3, 3])

    for plate in shape.plates:
        corners = placed(plate.body, plate.corners)
        middle = corners.mean(axis=0)
        paint = colour(plate.colour, PALE)
        for k in range(len(corners)):
            yield Face(np.array([middle, corners[k - 1], corners[k]]), paint)
    for piece in shape.pieces:
        a, b = placed(piece.bodies[0], piece.a), placed(piece.bodies[1], piece.b)
        across = poses[piece.bodies[0], :3, :3] @ piece.across
        yield from prism_faces(a, b, across, piece.widths, piece.sides, eye, colour(piece.colour))
