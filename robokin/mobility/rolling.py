"""Gears and friction wheels as linear equations between the joints' values.

Statement. Two wheels a and b touch in a point p with the common normal n. Along n they move alike, and in every
direction n of the plane if they roll on one another:

    n · v_a(p) = n · v_b(p).

If both turn (or slide, as a rack does) on one carrier, the pitch point stays where it is on the carrier and the ratio
of their speeds stays what it is, as the law of gearing has it. So in the joints' values q, measured from the carrier,

    (n · ν_a(p)) q_a - (n · ν_b(p)) q_b = 0,    ν(p) = v + w × p of a joint's unit twist,

all along the motion if the wheels are round, and no loop is needed for the contact.

Degenerate. Wheels without a common carrier touch in a point that wanders: their contact stays a joint of two freedoms,
known at the given configuration only.

Source: R. Willis, Principles of Mechanism, 1841 (wheels are looked at from their carrier).
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array
from robokin.mobility.screws import Element
from robokin.model import MechanismJoint

COAXIAL = 1e-9
"""Unit twists that differ by less [size, rad] are of one axis."""

STANDS = 1e-12
"""A speed of the contact along its normal, for a unit of the joint's, below which nothing drives it: rounding."""


@dataclass(frozen=True, eq=False)
class Bearing:
    """How a wheel turns or slides on a carrier: one unit twist (6,), the elements on the way with their signs."""

    carrier: int
    screw: Array
    way: tuple[tuple[int, float], ...]


def contact_rows(
    joint: MechanismJoint, links: tuple[int, int], elements: list[Element], middle: Array, size: float
) -> tuple[Array, tuple[str, ...]] | None:
    """The equations (m, f) of a contact between two links whose wheels share a carrier, or None for another contact.

    Their greatest coefficients are 1 or 0. Second, the names of the joints that they couple, the contact's own first.
    elements: in the order of the freedoms; points are measured from `middle` (3,) [m] in units of `size` [m].
    """
    if joint.type not in ("gear", "rolling") or joint.at is None or joint.axes is None:
        return None
    found = _on_carrier(links, elements)
    if found is None:
        return None
    point = (joint.at - middle) / size
    # Rolling forbids that the wheels part in any direction of the plane.
    normals = joint.axes[:1] if joint.type == "gear" else np.eye(3)[:2]
    counts = [len(element.screws) for element in elements]
    first = np.cumsum([0, *counts])
    rows = np.zeros((len(normals), first[-1]))
    for bearing, sign in zip(found, (1.0, -1.0), strict=True):
        speeds = sign * normals @ (bearing.screw[:3] + np.cross(bearing.screw[3:], point))
        for number, along in bearing.way:
            rows[:, first[number]] += along * speeds
    sizes = np.max(np.abs(rows), axis=1, initial=0.0)
    rows = np.where(sizes[:, None] > STANDS, rows, 0.0) / np.where(sizes > STANDS, sizes, 1.0)[:, None]
    coupled = [elements[number].name for bearing in found for number, _ in bearing.way]
    return rows, tuple(dict.fromkeys([joint.name, *coupled]))


def _on_carrier(links: tuple[int, int], elements: list[Element]) -> tuple[Bearing, Bearing] | None:
    """How both wheels of a contact are borne on one carrier; that with the shortest ways if there are several."""
    first, second = (_bearings(link, elements) for link in links)
    shared = [(a, b) for link, a in first.items() if (b := second.get(link)) is not None]
    return min(shared, key=lambda pair: len(pair[0].way) + len(pair[1].way), default=None)


def _bearings(wheel: int, elements: list[Element]) -> dict[int, Bearing]:
    """The links against which a wheel only turns about one axis, or only slides along one direction."""
    found: dict[int, Bearing] = {}
    for bearing in bearings(wheel, elements):
        if bearing.carrier not in found or len(bearing.way) < len(found[bearing.carrier].way):
            found[bearing.carrier] = bearing
    return found


def bearings(wheel: int, elements: list[Element]) -> list[Bearing]:
    """All ways in which a wheel turns about one axis, or slides along one direction, against another link."""
    found: list[Bearing] = []
    axes = [e.screws[0] for e in elements if len(e.screws) == 1 and wheel in (e.a, e.b) and not _advances(e.screws[0])]
    for screw in axes:
        ways: dict[int, tuple[tuple[int, float], ...]] = {wheel: ()}
        waiting = deque([wheel])
        while waiting:
            here = waiting.popleft()
            for number, element in enumerate(elements):
                if here not in (element.a, element.b) or (sign := _along(element, screw)) is None:
                    continue
                there = element.b if here == element.a else element.a
                if there not in ways:
                    # From the carrier to the wheel a joint counts as it is written.
                    sign = sign if here == element.b else -sign
                    ways[there] = ways[here] if not sign else (*ways[here], (number, sign))
                    waiting.append(there)
        found += [Bearing(link, screw, way) for link, way in ways.items() if way]
    return found


def _advances(screw: Array) -> bool:
    """Whether a unit twist is a screw with a pitch: neither a turn nor a slide."""
    return bool(abs(screw[:3] @ screw[3:]) > COAXIAL)


def _along(element: Element, screw: Array) -> float | None:
    """+1 or -1 where an element moves along a unit twist, 0 where it is fixed, None where it moves otherwise."""
    if not len(element.screws):
        return 0.0
    if len(element.screws) > 1:
        return None
    for sign in (1.0, -1.0):
        if np.max(np.abs(element.screws[0] - sign * screw)) < COAXIAL:
            return sign
    return None
