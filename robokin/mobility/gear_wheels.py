"""Where the wheels of gears and belts are, and how large: for pictures."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from robokin.arrays import Array
from robokin.errors import InputError
from robokin.mobility.assembly import assembled, missing_geometry
from robokin.mobility.gear_equations import PARALLEL, carried
from robokin.mobility.rolling import Bearing
from robokin.model import Mechanism, MechanismJoint

PULLEYS = 0.3
"""Radius of a belt's largest pulley, as a part of the distance of its axes, where no radii are given."""


@dataclass(frozen=True, eq=False)
class GearWheel:
    """A wheel of a joint on a link that turns on a carrier: its centre (3,) [m], its axis (3,), its radius [m], at the
    given configuration; ring: whether the other wheel is inside it; side: 1, or -1 for a pulley on a belt's back."""

    joint: str
    link: str
    carrier: str
    centre: Array
    axis: Array
    radius: float
    ring: bool = False
    side: int = 1


def wheels_of(mechanism: Mechanism) -> list[GearWheel]:
    """The wheels that a description says enough of to draw them; none where it is wrong."""
    if missing_geometry(mechanism) or not any(joint.type in ("gear", "belt", "rolling") for joint in mechanism.joints):
        return []
    try:
        assembly = assembled(mechanism)
    except InputError:
        return []
    wheels: list[GearWheel] = []
    tied = {names[0] for names in assembly.tied}
    for joint in mechanism.joints:
        for link in joint.links[1:] if joint.name in tied else ():
            turning = joint if joint.gearing else replace(joint, axes=None)
            try:
                pair = carried(turning, (joint.links[0], link), mechanism.links, assembly.linkage.elements)
            except InputError:
                continue  # a rack, which turns on nothing
            wheels += _pair(joint, link, mechanism.links[pair[0].carrier], pair, assembly.middle, assembly.size)
    known: dict[tuple[str, str, float], GearWheel] = {}
    for wheel in wheels:  # a belt's first pulley comes with each of the others
        known.setdefault((wheel.joint, wheel.link, round(wheel.radius / assembly.size, 9)), wheel)
    return list(known.values())


def belt_lines(wheels: list[GearWheel]) -> list[Array]:
    """The straight parts (2, 3) [m] of a belt about pulleys of one direction, from each to the next about them."""
    z = wheels[0].axis
    x = np.cross(z, np.eye(3)[int(np.argmin(np.abs(z)))])
    x /= np.linalg.norm(x)
    y = np.cross(z, x)
    centres = np.array([[wheel.centre @ x, wheel.centre @ y] for wheel in wheels])
    offset = centres - centres.mean(axis=0)
    order = np.argsort(np.arctan2(offset[:, 1], offset[:, 0]), kind="stable")
    lines = []
    for i, k in zip(order, np.roll(order, -1), strict=True):
        a, b = wheels[i], wheels[k]
        d = centres[k] - centres[i]
        distance = float(np.linalg.norm(d))
        # The pulleys are left of the belt as it goes, by their radii; those on its back are right of it.
        part = (b.side * b.radius - a.side * a.radius) / (distance or 1.0)
        if abs(part) >= 1.0:
            continue  # one pulley inside the other
        d /= distance
        left = part * d + np.sqrt(1.0 - part * part) * np.array([-d[1], d[0]])
        away = left[0] * x + left[1] * y
        lines.append(np.array([wheel.centre - wheel.side * wheel.radius * away for wheel in (a, b)]))
    return lines


def _pair(
    joint: MechanismJoint, link: str, carrier: str, pair: tuple[Bearing, Bearing], middle: Array, size: float
) -> list[GearWheel]:
    axes = (pair[0].screw[3:], pair[1].screw[3:])
    places = [np.cross(bearing.screw[3:], bearing.screw[:3]) * size + middle for bearing in pair]
    k = joint.links.index(link)
    signed = [joint.gearing[0], joint.gearing[k]] if joint.gearing else [1.0, 1.0]
    numbers = np.abs(signed)
    rings, sides = [False, False], [1, 1]
    parallel = np.linalg.norm(np.cross(axes[0], axes[1])) < PARALLEL
    if joint.at is not None:
        feet = [p + ((joint.at - p) @ z) * z for p, z in zip(places, axes, strict=True)]
        radii = [float(np.linalg.norm(joint.at - foot)) for foot in feet]
        places = feet
        if parallel and (joint.at - feet[0]) @ (joint.at - feet[1]) > 0.0:
            rings[int(radii[1] > radii[0])] = True
    elif parallel:
        apart = places[1] - places[0]
        apart = apart - (apart @ axes[0]) * axes[0]
        distance = float(np.linalg.norm(apart))
        if joint.type == "belt":
            radii = (PULLEYS * distance * numbers / np.max(numbers)).tolist()
            if signed[0] != 1.0 and not joint.meshes and np.sum(numbers) < distance:
                radii = numbers.tolist()
            sides = [int(np.sign(number)) for number in signed]
        else:
            alike = signed[0] * signed[1] > 0.0 and not joint.meshes
            if alike:
                rings[int(numbers[1] > numbers[0])] = True
            whole = abs(numbers[0] - numbers[1]) if alike else float(np.sum(numbers))
            radii = (distance * numbers / (whole or 1.0)).tolist()
    else:
        return []
    names = (joint.links[0], link)
    return [
        GearWheel(joint.name, name, carrier, *entry)
        for name, *entry in zip(names, places, axes, radii, rings, sides, strict=True)
    ]
