"""A mechanism as straight pieces: links between their joints, a symbol for each joint, discs for wheels.

Body k is the mechanism's link k, displaced from where the description has it; a piece is fixed to one body, or runs
from one to another where a joint slides. Joints that lie in one place are drawn apart along their axes, and those of a
mechanism whose axes all meet in a point stand on a sphere about it, where the links are arcs.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from robokin.arrays import Array
from robokin.mobility.gear_wheels import GearWheel, belt_lines, wheels_of
from robokin.model import Mechanism, MechanismJoint
from robokin.pictures.arm_bars import ROUND, SQUARE, perpendicular

LINKS = ("#c8551b", "#3a7ab0", "#3f7f4f", "#8a5a9e", "#b08a1e", "#4f8f9e", "#9e4f5f", "#5f5f9e")
"""Colours of links, told apart by the colour-blind too when few."""

PATHS = ("#d0021b", "#1f77b4", "#2ca02c", "#9467bd", "#8c564b")
"""Colours of the ways of points, on pages, in stills and in films."""

GROUND = "#6d757d"
"""Colour of what stands still."""

JOINTS = {
    "revolute": "#2b628f", "prismatic": "#d98a5f", "cylindrical": "#7a5fa8", "helical": "#4f8a5f",
    "universal": "#2b628f",
    "spherical": "#1f7d7d", "planar": "#a08a3a", "rolling": "#2b628f", "cam": "#444444", "gear": "#444444",
}  # fmt: skip
"""Colours of joints by kind."""

SPOKE = "#aab2b9"
"""Colour of the axes of joints that meet in a point."""

LEAST, SHARE = 0.035, 0.21
"""Height of a joint's symbol as a part of the mechanism: `SHARE` by the root of their number, and the least."""

FLAT = 0.02
"""Joints of a link no farther from a plane than this part of the mechanism are the corners of a plate."""

TOGETHER = 0.4
"""Joints nearer than this part of their height stand in one place, and are drawn apart."""

ARC = np.radians(9.0)
"""The turn from one piece of an arc to the next."""

SPHERE = 6
"""Slices of a ball."""


@dataclass(frozen=True, eq=False)
class StraightPiece:
    """A straight piece from a (3,) to b (3,) [m] as assembled, on the bodies of its ends.

    across (3,): a direction that a square piece is turned to; widths: the radius, or half the side, at both ends [m].
    """

    colour: str
    bodies: tuple[int, int]
    a: Array
    b: Array
    across: Array
    widths: tuple[float, float]
    sides: int = ROUND


@dataclass(frozen=True, eq=False)
class Plate:
    """A flat link of more than two joints: its corners (k, 3) [m] as assembled."""

    colour: str
    body: int
    corners: Array


@dataclass(frozen=True, eq=False)
class Shape:
    """What a mechanism looks like: pieces, plates, and names (text, body, place (3,) [m]); size [m] of the whole;
    places: (j, 3) [m] where its joints are drawn."""

    mechanism: Mechanism
    pieces: tuple[StraightPiece, ...]
    plates: tuple[Plate, ...]
    names: tuple[tuple[str, int, Array], ...]
    size: float
    places: Array


def shape_of(mechanism: Mechanism) -> Shape:
    """The shape of a mechanism some of whose joints have their place."""
    places = _given_places(mechanism)
    size = float(np.max(np.ptp(places, axis=0), initial=0.0))
    wheels = wheels_of(mechanism)
    size = max([size, *(2.0 * wheel.radius for wheel in wheels)])
    round_point = size < 1e-9 * max(float(np.max(np.abs(places), initial=0.0)), 1.0) or mechanism.space == "spherical"
    size = size or mechanism.units.metres
    centre = None
    if round_point:
        centre = places.mean(axis=0)
        axes = [joint.axes[0] if joint.axes is not None else np.zeros(3) for joint in mechanism.joints]
        size = max(size, 1.2 * mechanism.units.metres)
        places = centre + 0.5 * size * np.array(axes)
    height = size * max(LEAST, SHARE / np.sqrt(max(len(mechanism.joints), 4)))
    if centre is None:
        places = _apart(mechanism, places, height)
    else:
        height *= 0.6
    depth = _layers(mechanism, height)
    colours = link_colours(mechanism)
    pieces: list[StraightPiece] = []
    plates: list[Plate] = []
    for body, link in enumerate(mechanism.links):
        here = [i for i, joint in enumerate(mechanism.joints) if link in joint.links and not _wheel_only(joint)]
        corners = _distinct(places[here] + depth[body], 1e-6 * size)
        bars, plate = _link(corners, body, colours[link], 0.16 * height, None if centre is None else centre, size)
        pieces += bars
        plates += plate
    names = []
    for i, joint in enumerate(mechanism.joints):
        if _wheel_only(joint):
            continue
        bodies = [mechanism.links.index(link) for link in joint.links]
        for other in bodies[1:]:
            pieces += _symbol(joint, (bodies[0], other), places[i], height, depth, colours, mechanism)
        names.append((joint.name, bodies[0], places[i] + depth[bodies[0]]))
        if centre is not None:  # the axis, from where all meet
            pieces += _bars(np.array([centre, places[i]]), bodies[0], SPOKE, 0.03 * height)
    for wheel in wheels:
        pieces += _wheel(wheel, mechanism.links.index(wheel.link), colours[wheel.link], height, depth)
    for joint in mechanism.joints:
        mine = [wheel for wheel in wheels if wheel.joint == joint.name]
        if joint.type == "belt" and mine:
            body = mechanism.links.index(mine[0].carrier)
            for line in belt_lines(mine):
                pieces += _bars(line + depth.max(axis=0), body, JOINTS["gear"], 0.05 * height)
    return Shape(mechanism, tuple(pieces), tuple(plates), tuple(names), size, places)


def _wheel(wheel: GearWheel, body: int, colour: str, height: float, depth: Array) -> list[StraightPiece]:
    """A disc, with a spoke that shows how it turns; a hoop where the other wheel is inside."""
    at, half = wheel.centre + depth[body], 0.12 * height * wheel.axis
    across = perpendicular(wheel.axis)
    turns = np.linspace(0.0, 2.0 * np.pi, 49)[:, None]
    circle = at + wheel.radius * (np.cos(turns) * across + np.sin(turns) * np.cross(wheel.axis, across))
    if wheel.ring:
        return _bars(circle, body, colour, 0.12 * height)
    disc = StraightPiece(colour, (body, body), at - half, at + half, across, (wheel.radius, wheel.radius), 48)
    return [disc, *_bars(np.array([at, circle[0]]) + 1.2 * half, body, SPOKE, 0.06 * height)]


def _wheel_only(joint: MechanismJoint) -> bool:
    """Whether a joint is nothing but the touch of two wheels, which are drawn instead."""
    return bool(joint.gearing) or joint.type in ("belt", "gear", "rolling")


def link_colours(mechanism: Mechanism) -> dict[str, str]:
    """A colour for each link."""
    moving = [link for link in mechanism.links if link != mechanism.ground]
    return {link: LINKS[i % len(LINKS)] for i, link in enumerate(moving)} | {mechanism.ground: GROUND}


def _given_places(mechanism: Mechanism) -> Array:
    """(j, 3) [m] where the joints are; one without a place, such as a slide, in the middle of its links' others."""
    known = {i: joint.at for i, joint in enumerate(mechanism.joints) if joint.at is not None}
    whole = np.mean(list(known.values()), axis=0) if known else np.zeros(3)
    places = []
    for i, joint in enumerate(mechanism.joints):
        near = [at for k, at in known.items() if set(joint.links) & set(mechanism.joints[k].links)]
        places.append(known[i] if i in known else np.mean(near, axis=0) if near else whole)
    return np.array(places).reshape(-1, 3)


def _apart(mechanism: Mechanism, places: Array, height: float) -> Array:
    """Places with joints that fall together moved along their axes, where they have one."""
    drawn = places.copy()
    planar = mechanism.space == "planar"
    for i, joint in enumerate(mechanism.joints):
        if planar or joint.axes is None or joint.type not in ("revolute", "cylindrical", "helical"):
            continue
        others = np.delete(drawn, i, axis=0)
        shared = [bool(set(joint.links) & set(o.links)) for k, o in enumerate(mechanism.joints) if k != i]
        others = others[shared]
        for t in (0.0, 1.5, -1.5, 3.0, -3.0):
            place = places[i] + t * height * joint.axes[0]
            if np.min(np.linalg.norm(others - place, axis=1), initial=np.inf) > TOGETHER * height:
                drawn[i] = place
                break
    return drawn


def _layers(mechanism: Mechanism, height: float) -> Array:
    """(links, 3) [m] how far each link of a planar mechanism is drawn above the plane: they lie over one another."""
    depth = np.zeros((len(mechanism.links), 3))
    if mechanism.space == "planar":
        order = [mechanism.ground, *(link for link in mechanism.links if link != mechanism.ground)]
        for level, link in enumerate(order):
            depth[mechanism.links.index(link), 2] = 0.36 * height * min(level, 12)
    return depth


def _distinct(points: Array, least: float) -> Array:
    kept: list[Array] = []
    for point in points:
        if all(np.linalg.norm(point - other) > least for other in kept):
            kept.append(point)
    return np.array(kept).reshape(-1, 3)


def _link(
    corners: Array, body: int, colour: str, width: float, centre: Array | None, size: float
) -> tuple[list[StraightPiece], list[Plate]]:
    """A bar or an arc between two joints, a plate with a rim between more, a star where they lie in no plane."""
    if len(corners) < 2:
        return [], []
    if centre is not None:
        ways = [_arc(corners[i - 1], corners[i], centre) for i in range(0 if len(corners) > 2 else 1, len(corners))]
        return [bar for way in ways for bar in _bars(way, body, colour, width)], []
    if len(corners) == 2:
        return _bars(corners, body, colour, width), []
    middle = corners.mean(axis=0)
    _, spread, axes = np.linalg.svd(corners - middle, full_matrices=False)
    if len(spread) > 2 and spread[2] > FLAT * size:
        return [bar for corner in corners for bar in _bars(np.array([middle, corner]), body, colour, width)], []
    if spread[1] < FLAT * size:  # in a row
        along = np.argsort((corners - middle) @ axes[0], kind="stable")
        return _bars(corners[along], body, colour, width), []
    u, v = (corners - middle) @ axes[0], (corners - middle) @ axes[1]
    ring = corners[np.argsort(np.arctan2(v, u), kind="stable")]
    return _bars(np.concatenate([ring, ring[:1]]), body, colour, width), [Plate(colour, body, ring)]


def _arc(a: Array, b: Array, centre: Array) -> Array:
    """Points (k, 3) along the great circle from a to b about a centre."""
    u, v = a - centre, b - centre
    radius = float(np.linalg.norm(u)) or 1.0
    n = np.cross(u, v)
    if np.linalg.norm(n) < 1e-9 * radius**2:
        return np.array([a, b])
    angle = float(np.arctan2(np.linalg.norm(n), u @ v))
    side = np.cross(n / np.linalg.norm(n), u)
    turns = np.linspace(0.0, angle, max(int(np.ceil(angle / ARC)), 1) + 1)[:, None]
    return np.asarray(centre + np.cos(turns) * u + np.sin(turns) * side)


def _bars(line: Array, body: int, colour: str, width: float) -> list[StraightPiece]:
    bars = []
    for a, b in pairwise(line):
        step = (b - a) / np.linalg.norm(b - a)
        bars.append(StraightPiece(colour, (body, body), a, b, perpendicular(step), (width, width), 12))
    return bars


def _symbol(
    joint: MechanismJoint, bodies: tuple[int, int], place: Array, h: float, depth: Array, colours: dict[str, str],
    mechanism: Mechanism,
) -> list[StraightPiece]:  # fmt: skip
    """The symbol of a joint between two bodies, on the first."""
    a, b = bodies
    kind, paint = joint.type, JOINTS.get(joint.type, "#444444")
    axes = joint.axes if joint.axes is not None else np.array([[0.0, 0.0, 1.0]])
    # A pin of a planar mechanism goes through both of its links.
    middle = place + 0.5 * (depth[a] + depth[b])
    tall = 0.5 * abs(float(depth[a, 2] - depth[b, 2])) + (0.5 if mechanism.space != "planar" else 0.28) * h

    def bar(
        half: Array, width: float, sides: int = ROUND, across: Array | None = None, paint: str = paint
    ) -> StraightPiece:
        side = perpendicular(half) if across is None else across
        return StraightPiece(paint, (a, a), middle - half, middle + half, side, (width, width), sides)

    if kind in ("revolute", "rolling"):
        return [bar(tall * axes[0], 0.3 * h)]
    if kind == "helical":
        return [bar(0.6 * h * axes[0], 0.3 * h), bar(0.9 * h * axes[0], 0.12 * h)]
    if kind in ("prismatic", "cylindrical"):
        box = kind == "prismatic"
        across = np.array([0.0, 0.0, 1.0]) if mechanism.space == "planar" else perpendicular(axes[0])
        pieces = [bar(0.65 * h * axes[0], 0.27 * h, SQUARE if box else ROUND, across)]
        slide = StraightPiece(colours[mechanism.links[b]], (a, b), middle, middle, across, (0.15 * h, 0.15 * h),
                      SQUARE if box else ROUND)  # fmt: skip
        if mechanism.ground in joint.links and box:
            ground = mechanism.links.index(mechanism.ground)
            reach = 2.5 * h * axes[0]
            pieces.append(
                StraightPiece(
                    GROUND, (ground, ground), middle - reach, middle + reach, across, (0.1 * h, 0.1 * h), SQUARE
                )
            )
        return [*pieces, slide]
    if kind == "universal":
        return [bar(0.5 * h * axis, 0.2 * h) for axis in axes]
    if kind == "spherical":
        return _ball(paint, a, middle, 0.36 * h)
    if kind == "planar":
        return [bar(0.08 * h * axes[0], 0.6 * h, SQUARE)]
    if kind in ("gear", "cam"):
        return _ball(paint, a, middle, 0.2 * h)
    return []


def _ball(paint: str, body: int, middle: Array, radius: float) -> list[StraightPiece]:
    """A ball of slices whose ends are as wide as the ball is there."""
    heights = -np.cos(np.linspace(0.0, np.pi, SPHERE + 1))
    widths = radius * np.sqrt(np.clip(1.0 - heights**2, 0.0, 1.0))
    z, x = np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])
    return [
        StraightPiece(
            paint, (body, body), middle + radius * low * z, middle + radius * high * z, x, (float(wa), float(wb)), 16
        )
        for low, high, wa, wb in zip(heights[:-1], heights[1:], widths[:-1], widths[1:], strict=True)
    ]
