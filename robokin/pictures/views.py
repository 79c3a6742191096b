"""Planes through a workspace: which points of the world stand at which place of a picture."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from robokin.arrays import Array, Flags
from robokin.model import CoupledRobot, Robot
from robokin.workspace.membership import drawn_reachable
from robokin.workspace.space import Space, space_of

UPRIGHT = 1e-9
"""A direction whose other components are below this is along an axis of the world."""

AXES = ("x", "y", "z")


@dataclass(frozen=True, eq=False)
class View:
    """A plane of the world: the point at (u, v) is origin + u right + v up, all (3,) [m].

    name: what an answer calls it; space: whose set is looked at; radial: whether u is the distance from the first
    joint's axis, whose points all round it stand at one place.
    """

    name: str
    title: str
    labels: tuple[str, str]
    space: Space
    origin: Array
    right: Array
    up: Array
    radial: bool = False

    def points(self, uv: Array) -> Array:
        """(m, 3) the world's points [m] of places (m, 2) [m]."""
        return self.origin + uv[:, :1] * self.right + uv[:, 1:] * self.up

    def contains(self, uv: Array) -> Flags:
        """(m,) whether the points at places (m, 2) [m] can be reached; none is at a negative distance from an axis."""
        inside = np.zeros(len(uv), dtype=bool)
        there = np.flatnonzero(uv[:, 0] >= 0.0) if self.radial else np.arange(len(uv))
        if len(there):
            inside[there] = drawn_reachable(self.space, self.points(uv[there]))
        return inside

    def places(self, points: Array) -> Array:
        """(m, 2) where points (m, 3) [m] of the world stand, those beside the plane by their shadow on it."""
        offset = points - self.origin
        v = offset @ self.up
        if not self.radial:
            return np.stack([offset @ self.right, v], axis=1)
        return np.stack([np.linalg.norm(offset - v[:, None] * self.up, axis=1), v], axis=1)


def freed(robot: Robot, which: int | None = None) -> Robot:
    """The robot with a revolute joint (from 0), or all of them, free to turn as far as they like.

    Where joints hang on each other that joint moves no other.
    """
    if isinstance(robot, CoupledRobot):
        assert which is not None
        drive = robot.drive
        variables = tuple(
            replace(joint, limits=(-np.inf, np.inf)) if i == which else joint for i, joint in enumerate(robot.joints)
        )
        limits = np.where(drive.S[:, [which]] != 0.0, [-np.inf, np.inf], drive.limits)
        return replace(robot, drive=replace(drive, variables=variables, limits=limits))
    turning = [joint for i, joint in enumerate(robot.joints) if which in (None, i) and robot.revolute[i]]
    rows = tuple(
        replace(row, limits=(-np.inf, np.inf)) if any(row is joint for joint in turning) else row for row in robot.rows
    )
    return replace(robot, rows=rows)


def section_view(space: Space) -> View | None:
    """The half plane that the first joint turns to make the whole set; None where that joint does not turn.

    Where the first joint's limits keep it from a whole turn, the set in the picture is that of all its half planes.
    """
    robot = space.robot
    if space.dimension != 3 or not space.moving or space.moving[0] != 0 or not robot.revolute[0] or not space.leads:
        return None
    turned = space if space.axis is not None else space_of(freed(robot, 0))
    assert turned.axis is not None
    foot, up = turned.axis[:3, 3], turned.axis[:3, 2]
    right = turned.axis[:3, 0]
    title = "section through the first joint's axis"
    if np.hypot(up[0], up[1]) < UPRIGHT:
        origin, up = np.array([foot[0], foot[1], 0.0]), np.array([0.0, 0.0, 1.0])
        return View("section", title, ("r", "z"), turned, origin, right, up, radial=True)
    return View("section", title, ("r", "along axis 1"), turned, foot, right, up, radial=True)


def slice_view(space: Space, axis: str, at: float, shown: str) -> View:
    """The plane x, y or z = at [m], seen along that axis; `shown` is how the title says the value."""
    i = AXES.index(axis)
    across, up = [k for k in range(3) if k != i]
    origin = np.zeros(3)
    origin[i] = at
    return View(
        f"{axis}={shown.partition(' ')[0]}",
        f"slice at {axis} = {shown}",
        (AXES[across], AXES[up]),
        space,
        origin,
        np.eye(3)[across],
        np.eye(3)[up],
    )


def plane_view(space: Space) -> View:
    """The plane that holds a flat set; for any other set its shadow on the plane in which it is widest."""
    if space.dimension == 2 and space.basis is not None:
        normal = np.cross(space.basis[:, 0], space.basis[:, 1])
        k = int(np.argmax(np.abs(normal)))
        across, up = [i for i in range(3) if i != k]
        origin = np.zeros(3)
        if np.max(np.abs(np.delete(normal, k))) < UPRIGHT:
            origin[k] = space.centre[k]
            title = "reachable set" if abs(origin[k]) < UPRIGHT else f"reachable set, seen along {AXES[k]}"
            return View("plane", title, (AXES[across], AXES[up]), space, origin, np.eye(3)[across], np.eye(3)[up])
        return View(
            "plane", "reachable set in its plane", ("u", "v"), space, space.centre, space.basis[:, 0], space.basis[:, 1]
        )
    from robokin.workspace.sampling import joint_values, positions

    p = positions(space, joint_values(space, "sobol", 0, 0, 4096, 4096))
    k = int(np.argmin(np.ptp(p, axis=1)))
    across, up = [i for i in range(3) if i != k]
    title = f"reachable set, seen along {AXES[k]}"
    return View("plane", title, (AXES[across], AXES[up]), space, np.zeros(3), np.eye(3)[across], np.eye(3)[up])
