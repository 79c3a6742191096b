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
from robokin.pictures.arm_bars import HEIGHT, LINK, NOTHING, PARALLEL, Bar, base_bars, joint_bars, link_bars, slide_bars
from robokin.pictures.palms import Palm, palms_of
from robokin.pictures.skeleton import ArmSkeleton, FrameMark, skeleton_of
from robokin.spatial import exact

SHARE = 0.5
"""A joint is no longer than this part of what the arm has for each: symbols of many joints would cover the links."""

APART = 1.1
"""Heights of a joint between the middles of two, that both are seen."""

LEAST = 0.25
"""Joints of a short branch are no smaller than this part of the height that they have at most."""

SHORT, WIDE = 0.55, 0.7
"""Length of a frame's axes on what has several branches, as a part of that on an arm of its length: at most, and of a
joint's height as a part of what that is at most."""


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
        bars += link_bars(body, line, LINK * heights[body] / HEIGHT)
    for i, (centre, stroke) in enumerate(zip(centres, strokes, strict=True)):
        scale = heights[i + 1] / HEIGHT
        bars += joint_bars(skeleton, i, centre, scale)
        if skeleton.bodies[i].slides:
            bars += slide_bars(skeleton, i, stroke, scale)
    if len(skeleton.children[0]) < 2:
        bars += base_bars(skeleton, centres, heights[0] / HEIGHT)
    return ArmShape(robot, skeleton, length, tuple(bars), lines, tuple(palms_of(skeleton, length)), tuple(heights))


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
