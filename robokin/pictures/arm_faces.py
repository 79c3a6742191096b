"""Pieces to the flat faces that an eye sees of them, coloured and shaded."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array
from robokin.pictures.arm import ArmShape
from robokin.pictures.arm_bars import LINK, SQUARE, ends_of, perpendicular

COLOURS = {
    "link": "#a9bac9", "slide": "#e5b48f", "revolute": "#2b628f", "prismatic": "#c8551b", "stroke": "#b98a6a",
    "base": "#6d757d", "palm": "#d3dde6", "x": "#cf2f2f", "y": "#2a8f3c", "z": "#2f55cf", "mark": "#e0a100",
}  # fmt: skip
"""Colours of the pieces, of a frame's axes, and of what happens on a path."""

CROSS = "#222222"
"""Colour of a place that was asked for."""

POSTURES = (
    "#c8551b", "#3f7f4f", "#8a5a9e", "#b08a1e", "#4f8f9e", "#a8455d", "#5f5f9e", "#6e6a3a",
    "#e58a3c", "#1f9e74", "#c46bb5", "#7a5230", "#2f7fd0", "#d94f4f", "#9aa33a", "#454f5b",
)  # fmt: skip
"""Colours of several arms, one for each, on pages, in stills and in their keys: told apart by the colour-blind too when
few. There are as many as solutions are drawn."""

BETWEEN = "#7d8fa0"
"""Colour of ghosts without a name, along a path."""

TRACE = "#d0021b"
"""Colour of the way of a tool, or of an origin."""

PALE = (0.45, 0.65)
"""How pale the joints and the links of a ghost are."""

LIGHT = np.array([-0.42, 0.62, 0.66])
"""Where the light comes from: right, up, towards the eye."""

DARK = 0.66
"""Brightness of what the light does not reach."""

PIECE = 2.0
"""Widths of a piece's parts: what is short is put in the right order by its middle's distance."""

PARTS = 24
"""Parts of a piece at most."""

PALE_PALM = 0.8
"""How pale the plate of a ghost is."""

BEHIND = 3.5
"""Radii of its links that a plate is taken to be behind them: as far as their pieces may reach."""

MOST_PIECES = 10
"""Pieces along a plate's longest spoke at most."""

SAME = 1e-3
"""Pieces of two arms whose ends are nearer than this part of the arm's length are one piece to the eye."""

INSIDE = 0.98
"""The part of a joint's radius within which nothing of what it hides comes to light."""

AXIS, SHAFT = 0.11, 0.0042
"""Length and radius of the arrows of a frame, as parts of the arm's length."""


@dataclass(frozen=True, eq=False)
class Face:
    """A flat face: its corners (k, 3) [m] and its colour (3,) in 0 … 1."""

    corners: Array
    colour: Array


def colour(name: str, pale: float = 0.0) -> Array:
    """(3,) in 0 … 1 the red, green and blue of `#rrggbb`, mixed with white."""
    rgb = np.array([int(name[i : i + 2], 16) for i in (1, 3, 5)]) / 255.0
    return np.asarray(rgb + (1.0 - rgb) * pale)


def arm_faces(
    arm: ArmShape,
    frames: Array,
    eye: Array,
    ghost: str | None = None,
    drawn: set[tuple[object, ...]] | None = None,
    own: str | None = None,
) -> Iterator[Face]:
    """The faces of an arm in the world; frames: `body_frames`; eye: `eye_axes`; ghost: the one colour of a ghost; own:
    that of a solid arm's joints where it is one of several.

    drawn: what arms before have drawn; a ghost's piece that falls together with one of those is left out.
    """
    placed = [(bar, *ends_of(bar, frames)) for bar in arm.bars]
    joints = [
        (a, (b - a) / np.linalg.norm(b - a), float(np.linalg.norm(b - a)), (INSIDE * bar.width) ** 2)
        for bar, a, b in placed
        if bar.role in ("revolute", "prismatic")
    ]
    for bar, a, b in placed:
        if ghost is not None and bar.role in ("stroke", "base"):
            continue
        ends = np.round(np.array([a, b]) / (SAME * arm.length)).astype(int).tolist()
        key = (bar.role, *map(tuple, sorted(ends)))
        if drawn is not None:
            if ghost is not None and key in drawn:
                continue
            drawn.add(key)
        joint = bar.role in ("revolute", "prismatic")
        solid = own if own is not None and joint else COLOURS[bar.role]
        paint = colour(solid) if ghost is None else colour(ghost, PALE[bar.role == "link"])
        across = frames[bar.bodies[0], :3, :3] @ bar.across
        faces = prism_faces(a, b, across, (bar.width, bar.width), bar.sides, eye, paint)
        if joint or bar.role == "base":
            yield from faces
        else:
            yield from (face for face in faces if not _inside(face.corners.mean(axis=0), joints))
    for palm in arm.palms:
        corners = palm.corners @ frames[palm.body, :3, :3].T + frames[palm.body, :3, 3]
        key = ("palm", *np.round(corners.ravel() / (SAME * arm.length)).astype(int).tolist())
        if ghost is None or drawn is None or key not in drawn:
            paint = colour(COLOURS["palm"]) if ghost is None else colour(ghost, PALE_PALM)
            yield from _palm_faces(corners, eye, paint, LINK * arm.length)
        if drawn is not None:
            drawn.add(key)


def _palm_faces(corners: Array, eye: Array, paint: Array, width: float) -> Iterator[Face]:
    """A plate (k, 3) [m] in small triangles, behind the links of that radius [m] that lie in it."""
    # Farther from an eye that is infinitely far away nothing changes its place.
    corners = corners - BEHIND * width * eye[2]
    middle = corners.mean(axis=0)
    normal = np.sum(np.cross(np.roll(corners, 1, axis=0) - middle, corners - middle), axis=0)
    normal = normal / np.linalg.norm(normal)
    shade = _shaded(paint, eye @ (normal if normal @ eye[2] > 0.0 else -normal))
    spokes = np.linalg.norm(corners - middle, axis=1)
    count = min(max(int(np.ceil(np.max(spokes) / (PIECE * width))), 1), MOST_PIECES)
    for a, b in zip(np.roll(corners, 1, axis=0), corners, strict=True):
        u, v = (a - middle) / count, (b - middle) / count
        for i in range(count):
            for j in range(count - i):
                p = middle + i * u + j * v
                yield Face(np.array([p, p + u, p + v]), shade)
                if i + j < count - 1:
                    yield Face(np.array([p + u, p + u + v, p + v]), shade)


def _inside(point: Array, joints: Sequence[tuple[Array, Array, float, float]]) -> bool:
    """Whether a point (3,) [m] is within a joint: what is there cannot be seen, but its order would be in doubt.

    joints: of each where it begins, its direction, its length and the square of the radius that counts.
    """
    for a, d, long, square in joints:
        aside = point - a
        along = float(aside @ d)
        if 0.0 < along < long and float(aside @ aside) - along * along < square:
            return True
    return False


def frame_faces(T: Array, length: float, eye: Array) -> Iterator[Face]:
    """The three arrows of a frame T (4, 4) [m] on an arm of some length [m]: x red, y green, z blue."""
    for k, name in enumerate("xyz"):
        axis, aside, paint = T[:3, k], T[:3, (k + 1) % 3], colour(COLOURS[name])
        neck, tip = (T[:3, 3] + part * AXIS * length * axis for part in (0.78, 1.0))
        yield from prism_faces(T[:3, 3], neck, aside, (SHAFT * length, SHAFT * length), 8, eye, paint)
        yield from prism_faces(neck, tip, aside, (2.8 * SHAFT * length, 0.0), 10, eye, paint)


def cross_faces(p: Array, length: float, eye: Array) -> Iterator[Face]:
    """Three short bars that cross at a place p (3,) [m] that was asked for with any orientation."""
    for k, axis in enumerate(np.eye(3)):
        a, b = (p + end * 0.5 * AXIS * length * axis for end in (-1.0, 1.0))
        yield from prism_faces(a, b, np.roll(np.eye(3)[k], 1), (SHAFT * length, SHAFT * length), 8, eye, colour(CROSS))


def prism_faces(
    a: Array, b: Array, across: Array, widths: tuple[float, float], sides: int, eye: Array, paint: Array
) -> Iterator[Face]:
    """The faces of a prism or a pyramid from a to b that the eye sees."""
    long = float(np.linalg.norm(b - a))
    if long < 1e-3 * max(widths):
        return
    d = (b - a) / long
    u = across - (across @ d) * d
    u = u / np.linalg.norm(u) if np.linalg.norm(u) > 1e-6 else perpendicular(d)
    turn = 2.0 * np.pi * (np.arange(sides + 1) + 0.5) / sides
    ring = np.cos(turn)[:, None] * u + np.sin(turn)[:, None] * np.cross(d, u)
    # Half the side of a square is the distance of its sides, not of its corners.
    reach = np.array(widths) * (np.sqrt(2.0) if sides == SQUARE else 1.0)
    parts = min(max(int(np.ceil(long / (PIECE * max(widths)))), 1), PARTS)
    at = np.linspace(0.0, 1.0, parts + 1)
    rings = (a + (b - a) * at[:, None])[:, None] + (reach[0] + (reach[1] - reach[0]) * at)[:, None, None] * ring
    normals = ring[:-1] + ring[1:]
    normals = normals / np.linalg.norm(normals, axis=1)[:, None] + (reach[0] - reach[1]) / long * d
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    for k in np.flatnonzero(normals @ eye[2] > 0.0).tolist():
        shade = _shaded(paint, eye @ normals[k])
        for i in range(parts):
            yield Face(np.array([rings[i, k], rings[i, k + 1], rings[i + 1, k + 1], rings[i + 1, k]]), shade)
    for end, normal in ((rings[0], -d), (rings[-1], d)):
        if normal @ eye[2] > 0.0:
            yield Face(end[:-1], _shaded(paint, eye @ normal))


def _shaded(paint: Array, normal: Array) -> Array:
    light = max(float(normal @ LIGHT), 0.0) / float(np.linalg.norm(LIGHT))
    return np.asarray(np.clip(paint * (DARK + (1.08 - DARK) * light), 0.0, 1.0))


def ordered(faces: Sequence[Face], eye: Array) -> list[Face]:
    """Faces from the farthest to the nearest."""
    depth = [float(np.mean(face.corners @ eye[2])) for face in faces]
    return [faces[i] for i in np.argsort(depth, kind="stable")]
