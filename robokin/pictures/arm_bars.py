"""The straight pieces that an arm is drawn of: links, cylinders and boxes for the joints, what slides, the foot."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array
from robokin.pictures.skeleton import ArmSkeleton

NOTHING = 1e-9
"""A step shorter than this part of the arm is no step: tables are written to five digits."""

HEIGHT, RADIUS, LINK = 0.075, 0.032, 0.015
"""Height and radius of a joint's cylinder and the radius of a link, as parts of the arm's length."""

ROUND, SQUARE = 24, 4
"""Sides of a round piece and of a square one."""

PARALLEL = 1e-6
"""Sine of the angle below which two axes are parallel."""


@dataclass(frozen=True, eq=False)
class Bar:
    """A straight piece from a (3,) to b (3,) [m], each in the frame of its body.

    role: link, slide, revolute, prismatic, stroke or base; across (3,) a direction in the first body that a square
    piece is turned to; width: the radius, or half the side [m]; sides: ROUND or SQUARE.
    """

    role: str
    bodies: tuple[int, int]
    a: Array
    b: Array
    across: Array
    width: float
    sides: int = ROUND


def link_bars(body: int, line: Array, width: float) -> list[Bar]:
    """The pieces of a body's links, whose corners are a line (k, 3) [m]; width: [m]."""
    bars = []
    for k in range(len(line) - 1):
        step = (line[k + 1] - line[k]) / np.linalg.norm(line[k + 1] - line[k])
        # Two pieces overlap at their corner, so that it is closed.
        a = line[k] - (width * step if k else 0.0)
        b = line[k + 1] + (width * step if k < len(line) - 2 else 0.0)
        bars.append(Bar("link", (body, body), a, b, perpendicular(step), width))
    return bars


def joint_bars(skeleton: ArmSkeleton, i: int, centre: float, scale: float) -> list[Bar]:
    """The cylinder of a joint that turns, the box of one that slides."""
    body, parent = skeleton.bodies[i], skeleton.bodies[i].parent
    p, x, z = body.start[:3, 3], body.start[:3, 0], body.start[:3, 2]
    half = 0.5 * HEIGHT * scale * z
    middle = p + centre * z
    role, width = ("revolute", RADIUS) if body.turns else ("prismatic", 0.9 * RADIUS)
    sides = ROUND if body.turns else SQUARE
    symbol = Bar(role, (parent, parent), middle - half, middle + half, x, width * scale, sides)
    if i == 0 and centre and len(skeleton.children[0]) == 1:
        return [Bar("link", (parent, parent), p, middle, x, LINK * scale), symbol]
    return [symbol]


def slide_bars(skeleton: ArmSkeleton, i: int, stroke: tuple[float, float] | None, scale: float) -> list[Bar]:
    """What slides out of the box, and the stroke as a thin line with its ends."""
    start, parent = skeleton.bodies[i].start, skeleton.bodies[i].parent
    p, x, z = start[:3, 3], start[:3, 0], start[:3, 2]
    bars = [Bar("slide", (parent, i + 1), p, np.zeros(3), x, 0.8 * LINK * scale, SQUARE)]
    if stroke and stroke[1] > stroke[0]:
        # Beside the box, so that neither box nor slide hides it.
        ends = [p + 1.25 * RADIUS * scale * x + end * z for end in stroke]
        bars.append(Bar("stroke", (parent, parent), ends[0], ends[1], x, 0.2 * LINK * scale, SQUARE))
        thin = 0.2 * LINK * scale * z
        stops = [(end - thin, end + thin) for end in ends]
        bars += [Bar("stroke", (parent, parent), a, b, x, 0.7 * LINK * scale, SQUARE) for a, b in stops]
    return bars


def base_bars(skeleton: ArmSkeleton, centres: list[float], scale: float) -> list[Bar]:
    """The foot: a flat disc below the first joint where its axis is the base's, else at the base's origin."""
    base = skeleton.marks[0].T
    p, x, z = base[:3, 3], base[:3, 0], base[:3, 2]
    low, side = 0.0, 1.0
    if skeleton.bodies:
        first = skeleton.bodies[0].start
        offset = first[:3, 3] - p
        upright = np.linalg.norm(np.cross(first[:3, 2], z)) < PARALLEL
        if upright and np.linalg.norm(offset - (offset @ z) * z) < NOTHING + PARALLEL * scale:
            run, own = float(offset @ z), float(centres[0] * (first[:3, 2] @ z))
            # An arm whose base has z pointing down goes the other way.
            side = -1.0 if run < -NOTHING or (run < NOTHING and -HEIGHT * scale < own < 0.0) else 1.0
            low = min(0.0, side * (run + own) - 0.5 * HEIGHT * scale)
        else:
            low = -RADIUS * scale
    a, b = (p + side * (low - thick * scale) * z for thick in (0.014, 0.0))
    return [Bar("base", (0, 0), a, b, x, 2.1 * RADIUS * scale)]


def ends_of(bar: Bar, frames: Array) -> tuple[Array, Array]:
    """Where a piece begins and ends, (3,), (3,) [m] in the world; frames: `body_frames`."""
    first, last = frames[bar.bodies[0]], frames[bar.bodies[1]]
    return first[:3, :3] @ bar.a + first[:3, 3], last[:3, :3] @ bar.b + last[:3, 3]


def perpendicular(direction: Array) -> Array:
    """A direction (3,) at right angles to another (3,)."""
    aside = np.cross(direction, np.eye(3)[int(np.argmin(np.abs(direction)))])
    return np.asarray(aside / np.linalg.norm(aside))
