"""Gears and belts whose ratio is known, as linear equations between the joints' values.

Statement. Wheels a and b turn by θ_a and θ_b against the link that carries both, about directions that are given or
those of their hinges. With numbers w (for a ratio r: 1 and r, for teeth or radii those) the wheels keep

    w_a θ_a = w_b θ_b,

whatever the carrier does: so it holds for spur, bevel, worm and hypoid gears, chains and belts, fixed or epicyclic. A
wheel's turn is the sum of the values of the hinges that lead from the carrier to it along its axis.

Senses. A ratio has its own sign. Teeth mesh: in the point where the wheels touch both go at one speed, so that the
sign is that of (ν_a · ν_b), ν = axis × (point - wheel's centre); without the point, wheels on parallel axes turn
against one another. A belt turns its pulleys the same way, a crossed one against one another.

Source: R. Willis, Principles of Mechanism, 1841 (wheels are looked at from their carrier); F. Freudenstein, A. T. Yang,
"Kinematics and statics of a coupled epicyclic spur-gear train", Mechanism and Machine Theory 7(2), 1972 (fundamental
circuits of two wheels and their transfer vertex).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robokin.arrays import Array
from robokin.errors import InputError
from robokin.mobility.rolling import Bearing, bearings
from robokin.mobility.screws import Element
from robokin.model import MechanismJoint

PARALLEL = 1e-9
"""Sine of an angle up to which directions are parallel."""

SLIPS = 1e-6
"""Cosine between the speeds of two wheels in the point where they touch, below which neither drives the other along:
those of a worm and its wheel are at right angles."""


def gear_rows(
    joint: MechanismJoint, links: Sequence[str], elements: list[Element], middle: Array, size: float
) -> tuple[Array, tuple[str, ...]]:
    """The equations (m - 1, f) of wheels on m links, and the names of the joints that they couple, its own first.

    Their greatest coefficients are 1; points are measured from `middle` (3,) [m] in units of `size` [m]. Raises
    InputError where no link carries the wheels, or more than one may, or their senses cannot be told.
    """
    first = np.cumsum([0, *(len(element.screws) for element in elements)])
    rows = np.zeros((len(joint.links) - 1, first[-1]))
    names = [joint.name]
    for row, link, number in zip(rows, joint.links[1:], joint.gearing[1:], strict=True):
        pair = carried(joint, (joint.links[0], link), links, elements)
        axes = _directions(joint, pair)
        sense = _sense(joint, pair, axes, middle, size)
        for bearing, axis, factor in zip(pair, axes, (joint.gearing[0], -sense * number), strict=True):
            along = float(bearing.screw[3:] @ axis)
            for element, sign in bearing.way:
                row[first[element]] += factor * along * sign
        names += [elements[number].name for bearing in pair for number, _ in bearing.way]
        row /= np.max(np.abs(row), initial=0.0) or 1.0
    return rows, tuple(dict.fromkeys(names))


def carried(
    joint: MechanismJoint, pair: tuple[str, str], links: Sequence[str], elements: list[Element]
) -> tuple[Bearing, Bearing]:
    """How both wheels turn on the link that carries them."""
    numbers = [links.index(name) for name in pair]
    found = []
    for which, wheel in enumerate(numbers):
        direction = None if joint.axes is None else joint.axes[which]
        found.append([bearing for bearing in bearings(wheel, elements) if _turns(bearing, direction)])
    # Hinges on one axis are one bearing, whichever of them it was found by.
    together = {(a.carrier, a.way, b.way): (a, b) for a in found[0] for b in found[1] if a.carrier == b.carrier}
    shared = [(a, b) for a, b in together.values() if not _same_axis(a, b)]
    what = f"joint {joint.name}: the wheels {pair[0]} and {pair[1]}"
    if joint.carrier:
        shared = [(a, b) for a, b in shared if links[a.carrier] == joint.carrier]
        if not shared:
            raise InputError(f"{what} do not both turn on {joint.carrier}, expected a hinge from it to each of them")
    if not shared:
        about = "" if joint.axes is None else " about the given axes"
        raise InputError(f"{what} do not turn on one link{about}, expected a hinge from one link to each of them")
    least = min(len(a.way) + len(b.way) for a, b in shared)
    shared = [(a, b) for a, b in shared if len(a.way) + len(b.way) == least]
    if len(shared) > 1:
        known = " or ".join(dict.fromkeys(links[a.carrier] for a, _ in shared))
        raise InputError(f"{what} may turn on {known}, expected `carrier: NAME` or `axes` to tell")
    return shared[0]


def _turns(bearing: Bearing, direction: Array | None) -> bool:
    """Whether a bearing is a hinge, along a direction if there is one."""
    w = bearing.screw[3:]
    if not np.linalg.norm(w) > 0.5:
        return False
    return direction is None or bool(np.linalg.norm(np.cross(w, direction)) < PARALLEL)


def _same_axis(a: Bearing, b: Bearing) -> bool:
    return bool(min(np.max(np.abs(a.screw - b.screw)), np.max(np.abs(a.screw + b.screw))) < PARALLEL)


def _directions(joint: MechanismJoint, pair: tuple[Bearing, Bearing]) -> tuple[Array, Array]:
    """The directions about which turns count: those given, the hinges', alike where these are parallel."""
    if joint.axes is not None:
        return joint.axes[0], joint.axes[1]
    a, b = pair[0].screw[3:], pair[1].screw[3:]
    parallel = np.linalg.norm(np.cross(a, b)) < PARALLEL
    return a, (b if not parallel or a @ b > 0.0 else -b)


def _sense(
    joint: MechanismJoint, pair: tuple[Bearing, Bearing], axes: tuple[Array, Array], middle: Array, size: float
) -> float:
    """+1 where both wheels' turns have the sign of the numbers' product, -1 where they have the other."""
    parallel = np.linalg.norm(np.cross(*axes)) < PARALLEL
    if joint.type == "belt" and not parallel:
        raise InputError(
            f"joint {joint.name}: the pulleys {joint.links[0]} and {joint.links[1]} do not turn about parallel axes, "
            "expected a gear with a ratio"
        )
    if not joint.meshes:
        return 1.0
    if joint.at is None:
        if parallel:
            return float(-np.sign(axes[0] @ axes[1]))
        raise InputError(
            f"joint {joint.name}: the axes are not parallel, so that teeth do not tell which way the wheels turn, "
            "expected `at`, where they touch, or a ratio with its sign"
        )
    point = (joint.at - middle) / size
    speeds = []
    for bearing, axis in zip(pair, axes, strict=True):
        w = bearing.screw[3:]
        speed = (bearing.screw[:3] + np.cross(w, point)) * (w @ axis)
        speeds.append(speed / (np.linalg.norm(speed) or 1.0))
    along = float(speeds[0] @ speeds[1])
    if abs(along) < SLIPS:
        raise InputError(
            f"joint {joint.name}: where the wheels touch they go across one another, so that teeth do not tell which "
            "way they turn, expected a ratio with its sign"
        )
    return float(np.sign(along))
