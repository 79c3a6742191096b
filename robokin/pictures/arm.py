"""An arm, or a tree of them, as straight pieces: links between joints, cylinders and boxes for the joints, frames.

Body 0 is the world with what stands still, body k what joint k moves; its frame is the joint's own frame after the
motion, with the joint's axis along z. A piece is fixed to one body, or runs from one to the next where a joint slides.
Where several joints leave a body there is a plate between them. What is here does not depend on the configuration;
`body_frames` places it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array
from robokin.kernel.chain import chain_of
from robokin.kernel.facts import fact
from robokin.kernel.frames import joint_motion
from robokin.kinematics.forward import joint_frames
from robokin.model import CoupledRobot, Robot, Tree
from robokin.pictures.skeleton import ArmSkeleton, FrameMark, skeleton_of
from robokin.spatial import exact

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

LEAST = 0.25
"""Joints of a short branch are no smaller than this part of the height that they have at most."""

SHORT, WIDE = 0.55, 0.7
"""Length of a frame's axes on what has several branches, as a part of that on an arm of its length: at most, and of a
joint's height as a part of what that is at most."""

STRAIGHT = 1.1
"""Links no longer than so many times the way from a body's origin to a joint are spokes of a plate."""

FLAT = 0.2
"""Where joints leave a body, those no farther from a plane than this part of their spread have a plate between them."""


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
class Palm:
    """The plate of a body that several joints leave: its corners (k, 3) [m], round its middle."""

    body: int
    corners: Array


@dataclass(frozen=True, eq=False)
class ArmShape:
    """What a robot or a tree looks like.

    length: of the stretched arm, of a tree from its root to the farthest tip [m], which sizes are measured by; lines:
    the corners (k, 3) [m] of links, each on a body, `skeleton.on`; heights: of each body's joint [m]; marks: base, the
    rows' frames, tool or tips.
    """

    robot: Robot | Tree
    skeleton: ArmSkeleton
    length: float
    bars: tuple[Bar, ...]
    lines: tuple[Array, ...]
    palms: tuple[Palm, ...]
    heights: tuple[float, ...]

    @property
    def marks(self) -> tuple[FrameMark, ...]:
        """The frames."""
        return self.skeleton.marks

    @property
    def forked(self) -> bool:
        """Whether it has several branches."""
        return len(self.skeleton.strands) > 1

    def axes(self, body: int) -> float:
        """How long the axes of a frame on a body are, as a part of what they are on an arm of this length.

        Those of a small branch are short, that they do not hide it.
        """
        return min(SHORT, WIDE * self.heights[body] / (HEIGHT * self.length)) if self.forked else 1.0


def default_configuration(robot: Robot | Tree) -> tuple[Array, str]:
    """(n,) [rad | m] the configuration that is drawn when none is asked for, and its name if it has one.

    The pose `home` if there is one; else zero where limits allow it, and the middle of a slide's stroke.
    """
    if "home" in robot.poses:
        return robot.poses["home"], "home"
    low, high = robot.limits.T
    middle = 0.5 * (np.where(np.isfinite(low), low, 0.0) + np.where(np.isfinite(high), high, 0.0))
    zero = (low <= 0.0) & (high >= 0.0) & (robot.revolute | np.isinf(low) | np.isinf(high))
    return np.where(zero, 0.0, np.clip(middle, low, high)), ""


def body_frames(robot: Robot | Tree, q: Array) -> Array:
    """(b + 1, 4, 4) [m] the frames of the bodies in the world at q: (n,) [rad | m]."""
    if not isinstance(robot, Robot) or isinstance(robot, CoupledRobot) or _stands_elsewhere(robot):
        return skeleton_of(robot).frames(q)
    chain = chain_of(robot)
    moves = zip(joint_frames(robot, q)[:-1], chain.revolute, q + chain.offsets, strict=True)
    return np.array([np.eye(4), *(start @ joint_motion(bool(turns), value) for start, turns, value in moves)])


@fact
def _stands_elsewhere(robot: Robot) -> bool:
    """Whether the frames of joints stand elsewhere on their axes than in the table, as calculations want them."""
    table = [exact(C) for C in robot.graph.chain("base", "tool").constants]
    return not np.array_equal(table, chain_of(robot).constants)


def arm_of(robot: Robot | Tree) -> ArmShape:
    """The pieces and the frames of a robot or a tree."""
    skeleton = skeleton_of(robot)
    strokes = [_stroke(skeleton, i) for i in range(len(skeleton.bodies))]
    length = _length(skeleton, strokes) or robot.units.metres
    heights = _heights(skeleton, strokes, length)
    lines = tuple(_corners(line, NOTHING * length) for line in skeleton.lines)
    centres = _centres(robot, skeleton, lines, heights)
    bars: list[Bar] = []
    for body, line in zip(skeleton.on, lines, strict=True):
        bars += _link(body, line, LINK * heights[body] / HEIGHT)
    for i, (centre, stroke) in enumerate(zip(centres, strokes, strict=True)):
        scale = heights[i + 1] / HEIGHT
        bars += _joint(skeleton, i, centre, scale)
        if skeleton.bodies[i].slides:
            bars += _slide(skeleton, i, stroke, scale)
    if len(skeleton.children[0]) < 2:
        bars += _base(skeleton, centres, heights[0] / HEIGHT)
    return ArmShape(robot, skeleton, length, tuple(bars), lines, tuple(_palms(skeleton, length)), tuple(heights))


def plane_of(robot: Robot | Tree) -> Array | None:
    """(3,) the direction that all the arm's motion is at right angles to; None where it is not planar."""
    skeleton = skeleton_of(robot)
    turns = np.array([body.turns for body in skeleton.bodies], dtype=bool)
    if robot.n < 2 or not turns.any():
        return None
    # An arbitrary configuration: what is parallel there but for chance is parallel everywhere.
    axes = skeleton.frames(np.random.default_rng(20).uniform(-1.0, 1.0, robot.n))[1:, :3, 2]
    screws = np.array([body.turns and body.slides for body in skeleton.bodies])
    normal = axes[turns][0]
    aligned = np.linalg.norm(np.cross(axes, normal), axis=1) < PARALLEL
    level = np.abs(axes @ normal) < PARALLEL
    return np.asarray(normal) if np.all(np.where(turns, aligned & ~screws, level)) else None


def lines_of(arm: ArmShape, frames: Array) -> list[Array]:
    """The corners (k, 3) [m] of the links in the world, a line from the root or a fork to each tip; frames:
    `body_frames`. Of a serial arm it is one line, from its base to its tool."""
    found = []
    for strand in arm.skeleton.strands:
        bodies = [frames[arm.skeleton.on[number]] for number in strand]
        parts = [arm.lines[number] @ T[:3, :3].T + T[:3, 3] for number, T in zip(strand, bodies, strict=True)]
        found.append(_corners(np.concatenate(parts), NOTHING * arm.length))
    return found


def line_of(arm: ArmShape, frames: Array) -> Array:
    """(k, 3) [m] the corners of a whole serial arm in the world, from its base to its tool; frames: `body_frames`."""
    return np.concatenate(lines_of(arm, frames))


# How it is made -------------------------------------------------------------------------------------------


def _length(skeleton: ArmSkeleton, strokes: list[tuple[float, float] | None]) -> float:
    """The longest way from the root to the end of a branch [m], all strokes out."""
    before = [0.0]
    for body, stroke in zip(skeleton.bodies, strokes, strict=True):
        before.append(before[body.parent] + body.reach + (max(map(abs, stroke)) if stroke else 0.0))
    return float(np.max(np.array(before) + skeleton.spans))


def _heights(skeleton: ArmSkeleton, strokes: list[tuple[float, float] | None], length: float) -> list[float]:
    """The height [m] of the joint that moves each body: no more than its share of the branch that it is in."""
    runs, children = skeleton.runs(), skeleton.children
    own = dict.fromkeys(runs, 0.0)
    count = dict.fromkeys(runs, 0)
    for body, (run, following) in enumerate(zip(runs, children, strict=True)):
        alone = skeleton.bodies[following[0] - 1].reach if len(following) == 1 else float(skeleton.spans[body])
        stroke = strokes[body - 1] if body else None
        own[run] += alone + (max(map(abs, stroke)) if stroke else 0.0)
        count[run] += body > 0
    deep = [0]
    for joint in skeleton.bodies:
        deep.append(deep[joint.parent] + 1)
    most = length * min(HEIGHT, SHARE / max(*deep, 1))
    share = {run: max(SHARE * (own[run] or length) / max(count[run], 1), LEAST * most) for run in own}
    return [min(most, share[run]) for run in runs]


def _corners(line: Array, least: float) -> Array:
    """A line (k, 3) without the steps that are shorter than `least` [m]."""
    apart = np.linalg.norm(np.diff(line, axis=0), axis=1) > least
    return np.asarray(line[np.concatenate([[True], apart])])


def _stroke(skeleton: ArmSkeleton, i: int) -> tuple[float, float] | None:
    """From where to where a joint slides [m], along its axis; None where that is not known, or it does not."""
    body = skeleton.bodies[i]
    if not body.slides or not np.all(np.isfinite(body.joint.limits)):
        return None
    rate = body.rates[1]
    ends = [rate * (limit + body.joint.zero) for limit in body.joint.limits]
    return min(ends), max(ends)


def _centres(robot: Robot | Tree, skeleton: ArmSkeleton, lines: tuple[Array, ...], heights: list[float]) -> list[float]:
    """How far along its axis [m] the middle of each joint is drawn, such that they do not cover one another.

    Frames of a table may fall together where the axes of joints meet; the joint may then stand anywhere on its axis
    where there is a link.
    """
    bodies = skeleton.bodies
    frames = body_frames(robot, default_configuration(robot)[0])
    places = np.array([(frames[body.parent] @ body.start)[:3, 3] for body in bodies]).reshape(-1, 3)
    z = frames[1:, :3, 2]
    along = np.zeros(len(bodies))
    ahead_of, behind_of = _ends_of_lines(skeleton, lines)
    foot = len(skeleton.children[0]) == 1
    for i in [i for i, body in enumerate(bodies) if body.turns]:
        height = heights[i + 1]
        ahead = _run(ahead_of[i], np.array([0.0, 0.0, 1.0]))
        behind = _run(behind_of[i], bodies[i].start[:3, 2])
        if i == 0 and foot and ahead:
            along[i] = np.copysign(0.5 * height, ahead)
            continue
        choices = [0.0]
        choices += [float(np.copysign(min(abs(run), APART * height), run)) for run in (ahead, behind) if run]
        choices += [-1.2 * height] if i == 0 and foot else []
        others = np.delete(places + along[:, None] * z, i, axis=0)
        apart = [float(np.min(np.linalg.norm(others - places[i] - t * z[i], axis=1), initial=np.inf)) for t in choices]
        free = [t for t, distance in zip(choices, apart, strict=True) if distance >= APART * height * (1.0 - NOTHING)]
        along[i] = free[0] if free else choices[int(np.argmax(apart))]
    return along.tolist()


def _ends_of_lines(skeleton: ArmSkeleton, lines: tuple[Array, ...]) -> tuple[list[Array], list[Array]]:
    """The first step of the links behind each joint, and the last step of those before it, backwards: up to (2, 3)."""
    ahead: list[Array] = [np.zeros((0, 3))] * len(skeleton.bodies)
    behind = list(ahead)
    for strand in skeleton.strands:
        for before, number in zip((None, *strand[:-1]), strand, strict=True):
            body = skeleton.on[number]
            if before is not None:
                ahead[body - 1], behind[body - 1] = lines[number][:2], lines[before][:-3:-1]
    return ahead, behind


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


def _joint(skeleton: ArmSkeleton, i: int, centre: float, scale: float) -> list[Bar]:
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


def _slide(skeleton: ArmSkeleton, i: int, stroke: tuple[float, float] | None, scale: float) -> list[Bar]:
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


def _base(skeleton: ArmSkeleton, centres: list[float], scale: float) -> list[Bar]:
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


def _palms(skeleton: ArmSkeleton, length: float) -> list[Palm]:
    """The plates: between a body's origin and the joints that leave it straight, where a plane holds three of them."""
    palms = []
    for body, following in enumerate(skeleton.children):
        first = skeleton.marks[0].T[:3, 3] if body == 0 else np.zeros(3)
        corners = [first]
        for joint in (skeleton.bodies[number - 1] for number in following):
            place = joint.start[:3, 3]
            apart = min(float(np.linalg.norm(place - other)) for other in corners)
            if apart > NOTHING * length and joint.reach <= STRAIGHT * float(np.linalg.norm(place - first)):
                corners.append(place)
        if len(following) > 1 and (ring := _ring(np.array(corners))) is not None:
            palms.append(Palm(body, ring))
    return palms


def _ring(corners: Array) -> Array | None:
    """Corners (k, 3) round their middle, without one, but the first, that stands out, as a thumb does.

    None where they are in no plane, or in a row.
    """
    if len(corners) > 4 and _spread(corners)[2] > FLAT * _spread(corners)[1]:
        rest = [np.delete(corners, i, axis=0) for i in range(1, len(corners))]
        corners = min(rest, key=lambda part: float(_spread(part)[2]))
    spread = _spread(corners)
    if len(corners) < 3 or spread[1] <= FLAT * spread[0] or spread[2] > FLAT * spread[1]:
        return None
    middle = corners.mean(axis=0)
    axes = np.linalg.svd(corners - middle, full_matrices=False)[2]
    u, v = ((corners - middle) @ axis for axis in axes[:2])
    return np.asarray(corners[np.argsort(np.arctan2(v, u), kind="stable")])


def _spread(corners: Array) -> Array:
    """(3,) how far points (k, 3) [m] spread about their middle, along the directions in which they do so most."""
    return np.sqrt(np.linalg.svd(np.asarray(np.cov(corners.T, bias=True), dtype=np.float64), compute_uv=False))


def ends_of(bar: Bar, frames: Array) -> tuple[Array, Array]:
    """Where a piece begins and ends, (3,), (3,) [m] in the world; frames: `body_frames`."""
    first, last = frames[bar.bodies[0]], frames[bar.bodies[1]]
    return first[:3, :3] @ bar.a + first[:3, 3], last[:3, :3] @ bar.b + last[:3, 3]


def perpendicular(direction: Array) -> Array:
    """A direction (3,) at right angles to another (3,)."""
    aside = np.cross(direction, np.eye(3)[int(np.argmin(np.abs(direction)))])
    return np.asarray(aside / np.linalg.norm(aside))
