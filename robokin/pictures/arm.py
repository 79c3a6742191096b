"""An arm as straight pieces: links between its joints, cylinders and boxes for the joints, and its frames.

Body 0 is the world with what stands still, body k what joint k moves; its frame is the joint's own frame after the
motion, with the joint's axis along z. A piece is fixed to one body, or runs from one to the next where a joint slides.
What is here does not depend on the configuration; `body_frames` places it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array
from robokin.kernel.chain import chain_of
from robokin.kernel.frames import joint_motion
from robokin.kinematics.forward import joint_frames
from robokin.model import Robot

NOTHING = 1e-9
"""A step shorter than this part of the arm is no step: tables are written to five digits."""

HEIGHT, RADIUS, LINK = 0.075, 0.032, 0.015
"""Height and radius of a joint's cylinder and the radius of a link, as parts of the arm's length."""

SHARE = 0.5
"""A joint is no longer than this part of what the arm has for each: symbols of many joints would cover the links."""

APART = 1.1
"""Heights of a joint between the middles of two, that both are seen."""

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


@dataclass(frozen=True, eq=False)
class FrameMark:
    """A frame with its name: T (4, 4) [m] in a body."""

    name: str
    body: int
    T: Array


@dataclass(frozen=True, eq=False)
class ArmShape:
    """What a robot looks like.

    length: of the stretched arm [m], which sizes are measured by; lines: for each body the corners (k, 3) [m] of its
    link; marks: base, the rows' frames by number, tool.
    """

    robot: Robot
    length: float
    bars: tuple[Bar, ...]
    lines: tuple[Array, ...]
    marks: tuple[FrameMark, ...]


def default_configuration(robot: Robot) -> tuple[Array, str]:
    """(n,) [rad | m] the configuration that is drawn when none is asked for, and its name if it has one.

    The pose `home` if there is one; else zero where limits allow it, and the middle of a slide's stroke.
    """
    if "home" in robot.poses:
        return robot.poses["home"], "home"
    low, high = robot.limits.T
    middle = 0.5 * (np.where(np.isfinite(low), low, 0.0) + np.where(np.isfinite(high), high, 0.0))
    zero = (low <= 0.0) & (high >= 0.0) & (robot.revolute | np.isinf(low) | np.isinf(high))
    return np.where(zero, 0.0, np.clip(middle, low, high)), ""


def body_frames(robot: Robot, q: Array) -> Array:
    """(n + 1, 4, 4) [m] the frames of the bodies in the world at q: (n,) [rad | m]."""
    chain = chain_of(robot)
    moves = zip(joint_frames(robot, q)[:-1], chain.revolute, q + chain.offsets, strict=True)
    return np.array([np.eye(4), *(start @ joint_motion(bool(turns), value) for start, turns, value in moves)])


def arm_of(robot: Robot) -> ArmShape:
    """The pieces and the frames of a robot."""
    lines, starts, marks = _walk(robot)
    length = sum(float(np.sum(np.linalg.norm(np.diff(line, axis=0), axis=1))) for line in lines)
    strokes = [_stroke(robot, i) for i in range(robot.n)]
    length += sum(max(map(abs, stroke)) for stroke in strokes if stroke)
    length = length or robot.units.metres
    lines = [_corners(line, NOTHING * length) for line in lines]
    height = length * min(HEIGHT, SHARE / max(robot.n, 1))
    scale = height / HEIGHT
    centres = _centres(robot, lines, starts, height)
    bars: list[Bar] = []
    for i, line in enumerate(lines):
        bars += _link(i, line, LINK * scale)
    for i, (start, centre, stroke) in enumerate(zip(starts, centres, strokes, strict=True)):
        bars += _joint(robot, i, start, centre, scale)
        if not robot.revolute[i]:
            bars += _slide(i, start, stroke, scale)
    bars += _base(robot, starts, centres, scale)
    return ArmShape(robot, length, tuple(bars), tuple(lines), tuple(marks))


def plane_of(robot: Robot) -> Array | None:
    """(3,) the direction that all the arm's motion is at right angles to; None where it is not planar."""
    # An arbitrary configuration: what is parallel there but for chance is parallel everywhere.
    frames = joint_frames(robot, np.random.default_rng(20).uniform(-1.0, 1.0, robot.n))[:-1, :3, 2]
    if robot.n < 2 or not robot.revolute.any():
        return None
    normal = frames[robot.revolute][0]
    aligned = np.linalg.norm(np.cross(frames, normal), axis=1) < PARALLEL
    level = np.abs(frames @ normal) < PARALLEL
    return np.asarray(normal) if np.all(np.where(robot.revolute, aligned, level)) else None


def line_of(arm: ArmShape, frames: Array) -> Array:
    """(k, 3) [m] the corners of the whole arm in the world, from its base to its tool; frames: `body_frames`."""
    parts = [line @ frame[:3, :3].T + frame[:3, 3] for line, frame in zip(arm.lines, frames, strict=True)]
    return _corners(np.concatenate(parts), NOTHING * arm.length)


# How it is made -------------------------------------------------------------------------------------------


def _walk(robot: Robot) -> tuple[list[Array], list[Array], list[FrameMark]]:
    """The corners of each body's link, the frame in which each joint starts (in the body before), the frames."""
    T = np.array(robot.base)
    lines, starts = [[T[:3, 3]]], []
    marks = [FrameMark("base", 0, T)]
    for number, (row, joint) in enumerate(zip(robot.rows, robot.graph.joints, strict=True), start=1):
        T = T @ joint.before
        lines[-1].append(T[:3, 3])
        if row.moves:
            starts.append(T)
            T = np.eye(4)
            lines.append([T[:3, 3]])
        if robot.convention == "standard":
            # A link of a table runs along the joint's axis, then across it: its corner is drawn.
            # The frame of a joint whose variable has the other sign has its z axis the other way.
            lines[-1].append(T[:3, 3] + (row.sense if row.moves else 1) * row.d * T[:3, 2])
        T = T @ joint.after
        lines[-1].append(T[:3, 3])
        marks.append(FrameMark(str(number), len(lines) - 1, T))
    T = T @ robot.tool
    lines[-1].append(T[:3, 3])
    marks.append(FrameMark("tool", len(lines) - 1, T))
    return [np.array(line) for line in lines], starts, marks


def _corners(line: Array, least: float) -> Array:
    """A line (k, 3) without the steps that are shorter than `least` [m]."""
    apart = np.linalg.norm(np.diff(line, axis=0), axis=1) > least
    return np.asarray(line[np.concatenate([[True], apart])])


def _stroke(robot: Robot, i: int) -> tuple[float, float] | None:
    """From where to where a joint slides [m], along its axis; None where that is not known, or it turns."""
    joint = robot.joints[i]
    if robot.revolute[i] or not np.all(np.isfinite(joint.limits)):
        return None
    start = joint.sense * joint.offset
    return joint.limits[0] + start, joint.limits[1] + start


def _centres(robot: Robot, lines: list[Array], starts: list[Array], height: float) -> list[float]:
    """How far along its axis [m] the middle of each joint is drawn, such that they do not cover one another.

    Frames of a table may fall together where the axes of joints meet; the joint may then stand anywhere on its axis
    where there is a link.
    """
    frames = joint_frames(robot, default_configuration(robot)[0])[:-1]
    z, places = frames[:, :3, 2], frames[:, :3, 3]
    along = np.zeros(robot.n)
    for i in np.flatnonzero(robot.revolute).tolist():
        ahead = _run(lines[i + 1][:2], np.array([0.0, 0.0, 1.0]))
        behind = _run(lines[i][:-3:-1], starts[i][:3, 2])
        if i == 0 and ahead:
            along[i] = np.copysign(0.5 * height, ahead)
            continue
        choices = [0.0]
        choices += [float(np.copysign(min(abs(run), APART * height), run)) for run in (ahead, behind) if run]
        choices += [-1.2 * height] if i == 0 else []
        others = np.delete(places + along[:, None] * z, i, axis=0)
        apart = [float(np.min(np.linalg.norm(others - places[i] - t * z[i], axis=1), initial=np.inf)) for t in choices]
        free = [t for t, distance in zip(choices, apart, strict=True) if distance >= APART * height * (1.0 - NOTHING)]
        along[i] = free[0] if free else choices[int(np.argmax(apart))]
    return along.tolist()


def _run(line: Array, axis: Array) -> float:
    """How far a line's first step (2, 3) goes along an axis (3,); 0 where it goes elsewhere."""
    if len(line) < 2:
        return 0.0
    step = line[1] - line[0]
    run = float(step @ axis)
    return run if np.linalg.norm(step - run * axis) < PARALLEL * abs(run) else 0.0


def _link(body: int, line: Array, width: float) -> list[Bar]:
    bars = []
    for k in range(len(line) - 1):
        step = (line[k + 1] - line[k]) / np.linalg.norm(line[k + 1] - line[k])
        # Two pieces overlap at their corner, so that it is closed.
        a = line[k] - (width * step if k else 0.0)
        b = line[k + 1] + (width * step if k < len(line) - 2 else 0.0)
        bars.append(Bar("link", (body, body), a, b, perpendicular(step), width))
    return bars


def _joint(robot: Robot, i: int, start: Array, centre: float, scale: float) -> list[Bar]:
    """The cylinder of a joint that turns, the box of one that slides."""
    p, x, z = start[:3, 3], start[:3, 0], start[:3, 2]
    half = 0.5 * HEIGHT * scale * z
    middle = p + centre * z
    turns = bool(robot.revolute[i])
    role, width = ("revolute", RADIUS) if turns else ("prismatic", 0.9 * RADIUS)
    body = Bar(role, (i, i), middle - half, middle + half, x, width * scale, ROUND if turns else SQUARE)
    if i == 0 and centre:
        return [Bar("link", (i, i), p, middle, x, LINK * scale), body]
    return [body]


def _slide(i: int, start: Array, stroke: tuple[float, float] | None, scale: float) -> list[Bar]:
    """What slides out of the box, and the stroke as a thin line with its ends."""
    p, x, z = start[:3, 3], start[:3, 0], start[:3, 2]
    bars = [Bar("slide", (i, i + 1), p, np.zeros(3), x, 0.8 * LINK * scale, SQUARE)]
    if stroke and stroke[1] > stroke[0]:
        # Beside the box, so that neither box nor slide hides it.
        low, high = (p + 1.25 * RADIUS * scale * x + end * z for end in stroke)
        bars.append(Bar("stroke", (i, i), low, high, x, 0.2 * LINK * scale, SQUARE))
        thin = 0.2 * LINK * scale * z
        bars += [Bar("stroke", (i, i), end - thin, end + thin, x, 0.7 * LINK * scale, SQUARE) for end in (low, high)]
    return bars


def _base(robot: Robot, starts: list[Array], centres: list[float], scale: float) -> list[Bar]:
    """The foot: a flat disc below the first joint where its axis is the base's, else at the base's origin."""
    base = np.array(robot.base)
    p, x, z = base[:3, 3], base[:3, 0], base[:3, 2]
    low, side = 0.0, 1.0
    if starts:
        first = starts[0]
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
