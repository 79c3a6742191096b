"""Which arms stand in a picture, solid or as ghosts, with which target, and from where they are seen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array
from robokin.model import Robot, Tree
from robokin.pictures.arm import ArmShape, arm_of, body_frames, default_configuration, lines_of, plane_of
from robokin.pictures.arm_bars import ends_of
from robokin.pictures.arm_faces import BETWEEN, COLOURS, POSTURES
from robokin.pictures.arm_track import ArmTrack, rows_of
from robokin.pictures.skeleton import FrameMark
from robokin.units import Units

SLANTING = (-58.0, 22.0)
"""Azimuth and elevation [°] of the eye that a solid arm is seen from: x to the right, y away."""

LYING, STANDING = (-62.0, 52.0), (28.0, 16.0)
"""The same for several branches that lie beside one another, as a hand's fingers, and for a body seen from the front,
x pointing to the eye."""

THIN = 0.4
"""Branches lie or stand beside one another where they are thinner than this part of their extent."""

PLANES = {0: (0.0, 0.0), 1: (-90.0, 0.0), 2: (-90.0, 90.0)}
"""Azimuth and elevation [°] of the eye that sees the plane across an axis x, y, z of the world upright."""

MARGIN = 0.03
"""Room about what is drawn, as a part of its longest side."""

SEEN = 25
"""Rows of a path at which the room that the arm takes is looked at."""

ALONG = 1e-9
"""A direction is an axis of the world when its other components are below this."""


@dataclass(frozen=True, eq=False)
class Posture:
    """The arm at q (n,) [rad | m], with what the picture calls it; a ghost is drawn pale."""

    q: Array
    label: str = ""
    ghost: bool = False


@dataclass(frozen=True, eq=False)
class Scene:
    """A picture of an arm, or of a tree.

    target (4, 4) [m]: the pose that was asked for, `turned` whether its orientation was; frames: whether all are
    drawn, or base and tips alone; view: azimuth and elevation [°] of the eye, `flat` whether axes are drawn as in the
    plane; name: what a shell calls the robot; note: what the user should know; track: a path that is followed; words:
    the robot and its options as a command line has them, by default the name.
    """

    title: str
    subtitle: str
    units: Units
    arm: ArmShape
    postures: Sequence[Posture]
    target: Array | None
    frames: bool
    view: tuple[float, float]
    flat: bool
    turned: bool = True
    name: str = ""
    note: str = ""
    track: ArmTrack | None = None
    words: str = ""

    def colours(self) -> list[str | None]:
        """The colour of each posture, the same in all pictures; None for an arm that stands alone, in all its colours.

        Each of several arms that have a name has its own; ghosts without a name share one.
        """
        several = sum(bool(posture.label) for posture in self.postures) > 1
        found: list[str | None] = []
        number = 0
        for posture in self.postures:
            if posture.label and several:
                found.append(POSTURES[number % len(POSTURES)])
                number += 1
            elif posture.ghost:
                found.append(COLOURS["revolute"] if posture.label else BETWEEN)
            else:
                found.append(None)
        return found

    def bounds(self) -> tuple[Array, Array]:
        """Corners (3,), (3,) [m] of a box about all that is drawn."""
        room = 0.13 * self.arm.length
        points = []
        for posture in self.postures:
            frames = body_frames(self.arm.robot, posture.q)
            for bar in self.arm.bars:
                ends = np.array(ends_of(bar, frames))
                points += [ends - bar.width, ends + bar.width]
            if not posture.ghost:
                # The axes of the frames reach beyond what they stand on.
                for mark in self.marks():
                    T, reach = frames[mark.body] @ mark.T, room * self.arm.axes(mark.body)
                    points.append(T[:3, 3] + reach * np.vstack([np.zeros(3), T[:3, :3].T]))
        if self.track is not None:
            # The whole arm on its way, by some rows.
            for k in rows_of(len(self.track.t), SEEN):
                frames = body_frames(self.arm.robot, self.track.q[k])
                points += [np.array(ends_of(bar, frames)) + s * bar.width for bar in self.arm.bars for s in (-1.0, 1.0)]
            points.append(self.track.places)
        if self.target is not None:
            points.append(self.target[:3, 3] + room * np.vstack([np.zeros(3), self.target[:3, :3].T]))
        low, high = np.min(np.concatenate(points), axis=0), np.max(np.concatenate(points), axis=0)
        margin = MARGIN * float(np.max(high - low))
        return low - margin, high + margin

    def marks(self) -> list[FrameMark]:
        """The frames that are drawn."""
        return [mark for mark in self.arm.marks if self.frames or mark.end]


def usual_view(robot: Robot | Tree) -> tuple[tuple[float, float], bool]:
    """From where an arm is seen when nobody says, and whether that is straight onto its plane."""
    normal = plane_of(robot)
    if normal is not None:
        axis = int(np.argmax(np.abs(normal)))
        if np.max(np.abs(np.delete(normal, axis))) < ALONG:
            return PLANES[axis], True
    arm = arm_of(robot)
    if arm.forked:
        frames = body_frames(robot, default_configuration(robot)[0])
        extent = np.ptp(np.concatenate(lines_of(arm, frames)), axis=0)
        thinnest = int(np.argmin(extent))
        if extent[thinnest] < THIN * np.max(extent):
            return (STANDING, SLANTING, LYING)[thinnest], False
    return SLANTING, False


def eye_axes(view: tuple[float, float]) -> Array:
    """(3, 3) rows: right, up and towards the eye, for an eye at azimuth and elevation [°]."""
    azimuth, elevation = np.radians(view)
    (ca, sa), (ce, se) = ((np.cos(angle), np.sin(angle)) for angle in (azimuth, elevation))
    return np.array([[-sa, ca, 0.0], [-se * ca, -se * sa, ce], [ce * ca, ce * sa, se]])


def axis_names(view: tuple[float, float]) -> tuple[str, str] | None:
    """The axes of the world that point right and up from a view; None where others do."""
    names = []
    for row in eye_axes(view)[:2]:
        axis = int(np.argmax(np.abs(row)))
        if np.max(np.abs(np.delete(row, axis))) > ALONG or row[axis] < 0.0:
            return None
        names.append("xyz"[axis])
    return names[0], names[1]
