"""From a mechanism's description to a linkage: universal joints and joints of many links taken apart."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array, Index
from robokin.errors import InputError
from robokin.mobility.gear_equations import gear_rows
from robokin.mobility.linkage import Linkage
from robokin.mobility.linkage_blocks import spread_of
from robokin.mobility.rolling import contact_rows
from robokin.mobility.screws import Element, elements_of, has_geometry
from robokin.model import Mechanism, MechanismJoint
from robokin.spatial import transform

CONTACTS = ("gear", "cam", "rolling", "belt")
"""Joints of wheels, or at a point that may wander on both links."""

STRAIGHT = 1e-9
"""Sine of an angle, or distance in the mechanism's size, up to which axes are parallel or meet."""


@dataclass(frozen=True, eq=False)
class Assembly:
    """A linkage and the mechanism that it stands for.

    size: the mechanism's characteristic length [m], the linkage's unit; middle: (3,) [m] the linkage's origin; own:
    (f,) the number, in the mechanism's list, of the joint that each of the linkage's freedoms belongs to; tied: for
    each of the linkage's rows the joints that it couples, by name, the one that makes it first.
    """

    mechanism: Mechanism
    linkage: Linkage
    size: float
    middle: Array
    own: Index
    tied: tuple[tuple[str, ...], ...] = ()

    @property
    def wandering(self) -> tuple[str, ...]:
        """The contacts whose points wander on their links: they are known at the given configuration only."""
        rows = {names[0] for names in self.tied}
        return tuple(j.name for j in self.mechanism.joints if j.type in CONTACTS and j.name not in rows)

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
    """The characteristic length [m]: the spread of the joints about their middle; of screws in one point the greatest
    pitch [m/rad]; or 1."""
    points = np.array([joint.at for joint in mechanism.joints if joint.at is not None]).reshape(-1, 3)
    pitches = [abs(joint.pitch) for joint in mechanism.joints if joint.type == "helical"]
    return spread_of(points, max(pitches, default=0.0))


def assembled(mechanism: Mechanism) -> Assembly:
    """The linkage of a mechanism whose joints all have their geometry. Raises InputError."""
    missing = missing_geometry(mechanism)
    if missing:
        raise InputError(
            f"{mechanism.name} has no geometry for joint {', '.join(missing)}, expected it for every joint"
        )
    size = size_of(mechanism)
    middle = _middle(mechanism)
    rows: dict[str, tuple[Array, tuple[str, ...]]] = {}
    contacts = [joint for joint in mechanism.joints if joint.type in CONTACTS]
    if contacts:
        _, elements, _ = _elements(mechanism, {joint.name for joint in contacts}, middle, size)
        for joint in contacts:
            if joint.gearing:
                rows[joint.name] = gear_rows(joint, mechanism.links, elements, middle, size)
                continue
            a, b = (mechanism.links.index(link) for link in joint.links[:2])
            found = contact_rows(joint, (a, b), elements, middle, size) if len(joint.links) == 2 else None
            if found is not None:
                rows[joint.name] = found
        # Contacts that stay joints have freedoms of their own, which no row is about.
    bodies, elements, own = _elements(mechanism, set(rows), middle, size)
    if rows:
        rows = {name: (_spread(found[0], elements, contacts), found[1]) for name, found in rows.items()}
    stacked = np.concatenate([part for part, _ in rows.values()]) if rows else None
    tied = tuple(names for part, names in rows.values() for _ in part)
    linkage = Linkage(bodies, mechanism.graph.root, elements, stacked)
    return Assembly(mechanism, linkage, size, middle, np.array(own, dtype=np.intp), tied)


def _elements(
    mechanism: Mechanism, without: set[str], middle: Array, size: float
) -> tuple[int, list[Element], list[int]]:
    """The number of bodies, the elementary joints but for those of some joints, and whose each freedom is."""
    bodies = len(mechanism.links)
    elements: list[Element] = []
    own: list[int] = []
    for pair in mechanism.graph.joints:
        if pair.name in without:
            continue
        joint, before = mechanism.joints[pair.row], pair.parent
        parts = elements_of(joint, middle, size)
        at = None if joint.at is None else (joint.at - middle) / size
        for k, (screws, labels) in enumerate(parts):
            after = pair.child
            if k < len(parts) - 1:
                after, bodies = bodies, bodies + 1
            elements.append(Element(joint.name, before, after, screws, labels, at))
            own += [pair.row] * len(screws)
            before = after
    return bodies, elements, own


def _spread(rows: Array, elements: list[Element], contacts: list[MechanismJoint]) -> Array:
    """Equations (m, f) between the freedoms of all joints but contacts, with places for the contacts' freedoms."""
    names = {joint.name for joint in contacts}
    keep = np.concatenate([np.full(len(e.screws), e.name not in names) for e in elements])
    spread = np.zeros((len(rows), len(keep)))
    spread[:, keep] = rows
    return spread


def _middle(mechanism: Mechanism) -> Array:
    """The middle of the joints (3,) [m]: twists about it are of one size."""
    points = [joint.at for joint in mechanism.joints if joint.at is not None]
    return np.mean(points, axis=0) if points else np.zeros(3)


def space_fault(mechanism: Mechanism) -> str | None:
    """Why the mechanism does not live in the space that it says, or None: planar hinges must be parallel, …"""
    if mechanism.space == "planar":
        for joint in mechanism.joints:
            if joint.axes is None or joint.type in ("gear", "cam", "belt"):
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
        o = o - np.mean(o, axis=0)  # far from the origin its own rounding would be that of the distances
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
