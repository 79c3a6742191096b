"""From a mechanism's description to a linkage: universal joints and joints of many links taken apart."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robokin.errors import InputError
from robokin.mobility.linkage import Linkage
from robokin.mobility.screws import Element, elements_of, has_geometry
from robokin.model import Mechanism
from robokin.spatial import transform

Array = NDArray[np.float64]

STRAIGHT = 1e-9
"""Sine of an angle, or distance in the mechanism's size, up to which axes are parallel or meet."""


@dataclass(frozen=True, eq=False)
class Assembly:
    """A linkage and the mechanism that it stands for.

    size: the mechanism's characteristic length [m], the linkage's unit; middle: (3,) [m] the linkage's origin; own:
    (f,) the number, in the mechanism's list, of the joint that each of the linkage's freedoms belongs to.
    """

    mechanism: Mechanism
    linkage: Linkage
    size: float
    middle: Array
    own: NDArray[np.intp]

    def link(self, name: str) -> int:
        """The body of a link."""
        return self.mechanism.links.index(name)

    def placed(self, displacements: Array) -> Array:
        """Displacements (..., 4, 4) of the linkage's bodies as those of points of the world [m]."""
        R = displacements[..., :3, :3]
        return transform(R, self.middle - R @ self.middle + self.size * displacements[..., :3, 3])


def missing_geometry(mechanism: Mechanism) -> tuple[str, ...]:
    """The joints of which too little is known to say how they move."""
    return tuple(joint.name for joint in mechanism.joints if not has_geometry(joint))


def size_of(mechanism: Mechanism) -> float:
    """The characteristic length [m]: the spread of the joints about their middle, or 1."""
    points = np.array([joint.at for joint in mechanism.joints if joint.at is not None]).reshape(-1, 3)
    if not len(points):
        return 1.0
    spread = float(np.max(np.linalg.norm(points - points.mean(axis=0), axis=1)))
    # The mean of equal points is off by rounding: that is no size.
    return spread if spread > 1e-12 * np.max(np.abs(points)) else 1.0


def assembled(mechanism: Mechanism) -> Assembly:
    """The linkage of a mechanism whose joints all have their geometry. Raises InputError."""
    missing = missing_geometry(mechanism)
    if missing:
        raise InputError(
            f"{mechanism.name} has no geometry for joint {', '.join(missing)}, expected it for every joint"
        )
    size = size_of(mechanism)
    middle = _middle(mechanism)
    bodies = len(mechanism.links)
    elements: list[Element] = []
    own: list[int] = []
    for number, joint in enumerate(mechanism.joints):
        a = mechanism.links.index(joint.links[0])
        for name in joint.links[1:]:
            b, before = mechanism.links.index(name), a
            parts = elements_of(joint, middle, size)
            for k, (screws, labels) in enumerate(parts):
                after = b
                if k < len(parts) - 1:
                    after, bodies = bodies, bodies + 1
                elements.append(Element(joint.name, before, after, screws, labels))
                own += [number] * len(screws)
                before = after
    linkage = Linkage(bodies, mechanism.links.index(mechanism.ground), elements)
    return Assembly(mechanism, linkage, size, middle, np.array(own, dtype=np.intp))


def _middle(mechanism: Mechanism) -> Array:
    """The middle of the joints (3,) [m]: twists about it are of one size."""
    points = [joint.at for joint in mechanism.joints if joint.at is not None]
    return np.mean(points, axis=0) if points else np.zeros(3)


def parts_of(mechanism: Mechanism) -> list[tuple[str, ...]]:
    """The groups of links that joints connect, the ground's first."""
    groups: list[set[str]] = [{link} for link in mechanism.links]
    for joint in mechanism.joints:
        touched = [group for group in groups if group & set(joint.links)]
        groups = [group for group in groups if group not in touched]
        groups.append(set().union(*touched))
    ordered = [tuple(link for link in mechanism.links if link in group) for group in groups]
    return sorted(ordered, key=lambda group: (mechanism.ground not in group, mechanism.links.index(group[0])))


def space_fault(mechanism: Mechanism) -> str | None:
    """Why the mechanism does not live in the space that it says, or None: planar hinges must be parallel, …"""
    if mechanism.space == "planar":
        for joint in mechanism.joints:
            if joint.axes is None or joint.type in ("gear", "cam"):
                continue
            out = np.abs(joint.axes[:, 2])
            in_plane = joint.type == "prismatic"
            off = float(np.max(out if in_plane else np.linalg.norm(joint.axes[:, :2], axis=1)))
            if off > STRAIGHT:
                lies = "out of the plane" if in_plane else "not at right angles to the plane"
                return (
                    f"the axis of joint {joint.name} is {lies} by {np.degrees(np.arcsin(min(off, 1.0))):.3g}°: "
                    "the mechanism is not planar, expected space: spatial"
                )
    if mechanism.space == "spherical":
        hinges = [joint for joint in mechanism.joints if joint.type == "revolute" and has_geometry(joint)]
        if len(hinges) < 2:
            return None
        z = np.array([joint.axes[0] for joint in hinges if joint.axes is not None])
        o = np.array([joint.at for joint in hinges if joint.at is not None])
        off = np.eye(3) - z[:, :, None] * z[:, None, :]
        point = np.linalg.lstsq(off.reshape(-1, 3), np.einsum("kij,kj->ki", off, o).ravel(), rcond=1e-9)[0]
        distance = np.linalg.norm(np.einsum("kij,kj->ki", off, point - o), axis=1)
        worst = int(np.argmax(distance))
        if distance[worst] > STRAIGHT * max(size_of(mechanism), 1e-300):
            return (
                f"the axis of joint {hinges[worst].name} misses the point where the others meet by "
                f"{distance[worst]:.3g} m: the mechanism is not spherical, expected space: spatial"
            )
    return None
