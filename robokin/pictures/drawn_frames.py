"""A frame that moves to another one as a picture: a page that plays it, a film, a still."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from robokin.arrays import Array
from robokin.errors import InputError
from robokin.inverse.frame_motions import FrameMotion, frame_motion
from robokin.number_text import show
from robokin.pictures.arm_faces import AXIS, COLOURS, TRACE, Face, frame_faces, ordered
from robokin.pictures.arm_scene import SLANTING, eye_axes
from robokin.pictures.drawn_arm import FARTHEST
from robokin.units import Units

if TYPE_CHECKING:
    from collections.abc import Sequence

ROWS = 60
"""Steps that are played, whatever number of rows is written."""

PLAYED = 4.0
"""Seconds in which the way is played."""

ARROW = 0.3
"""Length of the arrows of a frame, as a part of the picture's size."""

GHOSTS = 5
"""Frames that a still shows along the way, with both ends."""

FAR = 6.0
"""The base is drawn where it is no farther away than this many times what the motion takes."""

NEAREST = 1e-9
"""Metres between places that are one in a picture."""

SCREW = "#8a5a9e"
"""Colour of the screw's axis."""

ENDS = (0.7, 1.0)
"""Parts of the arrows' length for frames that stand still, and for the one that moves."""


@dataclass(frozen=True, eq=False)
class FrameScene:
    """Rows T (m, 4, 4) [m] of a way, the frames that stand still with their names, the screw's axis (2, 3) [m] or None,
    the size [m] that arrows are measured by, and a box (3,), (3,) [m] about everything."""

    title: str
    subtitle: str
    units: Units
    T: Array
    still: Sequence[tuple[str, Array]]
    axis: Array | None
    size: float
    box: tuple[Array, Array]


def frames_picture(motion: FrameMotion, names: tuple[str, str], units: Units, kind: str) -> bytes:
    """The way of a frame as a file: html, gif, png, svg or pdf; names: the two frames' expressions.

    Raises InputError for frames that are too far away for a picture, and without matplotlib for all but pages.
    """
    if np.max(np.abs(motion.T[:, :3, 3])) > FARTHEST:
        raise InputError("the frames are too far away for a picture, expected less")
    scene = _scene(motion, names, units)
    if kind == "html":
        return _page(scene)
    return _film(scene) if kind == "gif" else _still(scene, kind)


def _scene(motion: FrameMotion, names: tuple[str, str], units: Units) -> FrameScene:
    screw = motion.screw
    T = frame_motion(screw.first, screw.last, motion.along, ROWS).T
    places = T[:, :3, 3]
    extent = float(np.max(np.ptp(places, axis=0)))
    away = float(np.linalg.norm(places[0]))
    base = away <= FAR * max(extent, units.metres) or away <= NEAREST
    shown = np.vstack([places, np.zeros(3)]) if base else places
    size = float(np.max(np.ptp(shown, axis=0)))
    size = size if size > NEAREST else units.metres
    still = [("from", screw.first), ("to", screw.last)]
    if base and np.max(np.abs(screw.first - np.eye(4))) > 1e-12 and np.max(np.abs(screw.last - np.eye(4))) > 1e-12:
        still.insert(0, ("base", np.eye(4)))
    frames = np.concatenate([T, [frame for _, frame in still]])
    tips = frames[:, None, :3, 3] + ARROW * size * np.swapaxes(frames[:, :3, :3], 1, 2)
    points = np.concatenate([tips.reshape(-1, 3), shown])
    axis = None
    if motion.along == "screw" and screw.point is not None and screw.axis is not None:
        # The line beside the way, where it is not far from it.
        along = (places - screw.point) @ screw.axis
        foot = screw.point + np.array([along.min() - 0.3 * size, along.max() + 0.3 * size])[:, None] * screw.axis
        if float(np.min(np.linalg.norm(foot - places[0], axis=1))) < FAR * size:
            axis = foot
            points = np.concatenate([points, foot])
    low, high = points.min(axis=0), points.max(axis=0)
    room = 0.04 * float(np.max(high - low))
    how = {"line": "straight, about one fixed direction", "screw": "by a screw motion"}[motion.along]
    titles = [name.strip() or "identity" for name in names]
    return FrameScene(
        f"{titles[0]} to {titles[1]}", how, units, T, still, axis, size, (low - room, high + room)
    )  # fmt: skip


def _page(scene: FrameScene) -> bytes:
    from robokin.pictures.arm_page import short_numbers
    from robokin.pictures.workspace_page import filled

    scale = 1.0 / scene.units.metres
    rows = scene.T.copy()
    rows[:, :3, 3] *= scale
    still = [[name, short_numbers(_scaled(frame, scale), 12)] for name, frame in scene.still]
    data: dict[str, Any] = {
        "title": scene.title,
        "note": "",
        "subtitle": scene.subtitle,
        "length": scene.units.length,
        "angle": scene.units.angle,
        "radians": scene.units.radians,
        "rows": short_numbers(rows.reshape(-1, 16), 12),
        "still": still,
        "axis": None if scene.axis is None else short_numbers(scene.axis * scale),
        "size": scene.size * scale,
        "arrow": ARROW / AXIS,
        "ends": list(ENDS),
        "box": short_numbers(np.array(scene.box) * scale),
        "view": list(SLANTING),
        "seconds": PLAYED,
        "colours": COLOURS,
        "trace": TRACE,
        "screw": SCREW,
    }
    return filled("frame.html", scene.title, data)


def _scaled(T: Array, scale: float) -> Array:
    T = T.copy()
    T[:3, 3] *= scale
    return T.ravel()


def _arrows(scene: FrameScene, T: Array, eye: Array, part: float) -> list[Face]:
    return list(frame_faces(T, part * ARROW / AXIS * scene.size, eye))


def _film(scene: FrameScene) -> bytes:
    from robokin.pictures.film import FilmStage, Shot, film, film_rows

    eye = eye_axes(SLANTING)
    times = np.linspace(0.0, 1.0, len(scene.T))
    rows, pause = film_rows(times, PLAYED)
    fixed = [face for _, frame in scene.still for face in _arrows(scene, frame, eye, ENDS[0])]
    names = [(frame[:3, 3], name) for name, frame in scene.still]
    lines = [] if scene.axis is None else [(scene.axis, SCREW)]

    def shot(row: int) -> Shot:
        moving = _arrows(scene, scene.T[row], eye, ENDS[1])
        caption = f"{scene.subtitle}   t = {show(round(float(times[row]), 3))}"
        return Shot([*fixed, *moving], caption, (), names, [(scene.T[:, :3, 3], TRACE, row)], lines)

    return film(FilmStage(scene.title, scene.box, SLANTING, scene.units), rows, pause, shot)


def _still(scene: FrameScene, kind: str) -> bytes:
    from robokin.pictures.arm_stills import INK, draw_solid, label, spread_labels
    from robokin.pictures.workspace_stills import drawing, written

    eye, scale, side = eye_axes(SLANTING), 1.0 / scene.units.metres, 5.6
    with drawing(kind) as figure:
        figure.set_size_inches(1.12 * side + 0.6, side + 1.0)
        figure.text(0.5, 0.955, scene.title, ha="center", va="center", fontsize=13, fontweight="bold", color="#111111")
        figure.text(0.5, 0.915, scene.subtitle, ha="center", va="center", fontsize=10, color="#444444")
        axes: Any = figure.add_axes((0.03, 0.03, 0.92, 0.85), projection="3d", computed_zorder=False)
        between = np.round(np.linspace(0, len(scene.T) - 1, GHOSTS)).astype(int)[1:-1]
        faces = [face for row in between for face in _arrows(scene, scene.T[row], eye, 0.5 * ENDS[0])]
        faces += [face for _, frame in scene.still for face in _arrows(scene, frame, eye, ENDS[1])]
        draw_solid(axes, scene.units, SLANTING, [ordered(faces, eye)], scene.box)
        axes.plot(*(scene.T[:, :3, 3] * scale).T, color=TRACE, linewidth=1.8, zorder=2)
        if scene.axis is not None:
            axes.plot(*(scene.axis * scale).T, color=SCREW, linewidth=1.2, linestyle=(0, (6, 3)), zorder=2)
        points = 72.0 * side / float(np.max(np.ptp(np.array(scene.box) @ eye[:2].T, axis=0)))
        names = [name for name, _ in scene.still]
        places = [frame[:3, 3] for _, frame in scene.still]
        asides = spread_labels([eye[:2] @ place * points for place in places], names)
        for place, name, aside in zip(places, names, asides, strict=True):
            label(axes, place * scale, name, INK, aside)
        return written(figure, kind, tight=True)
