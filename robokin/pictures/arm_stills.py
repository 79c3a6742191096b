"""Arms as still pictures by matplotlib: .png, .svg, .pdf."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING, Any

import numpy as np

from robokin.arrays import Array
from robokin.pictures.arm import body_frames, lines_of
from robokin.pictures.arm_faces import COLOURS, TRACE, Face, arm_faces, colour, cross_faces, frame_faces, ordered
from robokin.pictures.arm_scene import Scene, axis_names, eye_axes
from robokin.pictures.workspace_stills import drawing, written
from robokin.units import Units

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


SIDE = 5.6
"""Inches of the drawing's longer side."""

LEFT, RIGHT, HEAD, FOOT = 0.9, 0.35, 0.95, 0.75
"""Inches about the drawing."""

KEY = 3.5
"""Inches for the names of ghosts at the right."""

MARKS = 6
"""Events of a path that are told in words at most."""

SAME = 0.03
"""Names of places nearer to one another than this part of the arm's length stand together."""

LETTER = (6.4, 9.0)
"""Width and height of a letter in points."""

ASIDES = ((7, -12), (7, 6), (-7, -12), (-7, 6), (14, -24), (14, 18))
"""Where letters may stand beside their place, in points."""

INK = "#1c2126"
"""Colour of letters."""


def arm_still(scene: Scene, kind: str) -> bytes:
    """The scene as a file of one of `stills.KINDS`. Raises InputError where matplotlib is missing."""
    with drawing(kind) as figure:
        _draw(figure, scene)
        return written(figure, kind, tight=True)


def _draw(figure: Figure, scene: Scene) -> None:
    low, high = scene.bounds()
    eye = eye_axes(scene.view)
    names = axis_names(scene.view) if scene.flat else None
    keyed = [posture for posture in scene.postures if posture.label]
    key = KEY if keyed or (scene.track is not None and scene.track.marks) else 0.0
    if names:
        shown = ["xyz".index(name) for name in names]
        size = (high - low)[shown]
        # What is thin gets some room.
        wide = np.maximum(size, np.max(size) / 2.5)
        low[shown], high[shown] = low[shown] - 0.5 * (wide - size), high[shown] + 0.5 * (wide - size)
        inches = SIDE * wide / np.max(wide)
    else:
        inches = np.array([SIDE * 1.12, SIDE])
    subtitle = "\n".join(textwrap.wrap(scene.subtitle, int(11.5 * (inches[0] + LEFT + RIGHT + key)))[:3])
    head = HEAD + 0.2 * subtitle.count("\n")
    left = LEFT if names else 0.2
    width, height = float(inches[0]) + left + RIGHT + key, float(inches[1]) + head + (FOOT if names else 0.25)
    figure.set_size_inches(width, height)
    figure.text(0.5, 1.0 - 0.3 / height, scene.title, ha="center", va="center", fontsize=15, fontweight="bold",
                color="#111111")  # fmt: skip
    figure.text(0.5, 1.0 - 0.5 / height, subtitle, ha="center", va="top", fontsize=10.5, color="#444444")
    room = (left / width, (FOOT if names else 0.25) / height, inches[0] / width, inches[1] / height)
    layers = _faces(scene, eye)
    if names:
        axes = figure.add_axes(room)
        _plane(axes, scene, [*layers[0], *layers[1]], eye, names, (low, high))
    else:
        axes = figure.add_axes(room, projection="3d", computed_zorder=False)
        draw_solid(axes, scene.units, scene.view, layers, (low, high))
    _track(axes, scene, eye, bool(names))
    marks = _names(scene)
    # Points of paper in a metre: exact in a plane, near enough in space.
    points = 72.0 * SIDE / float(np.max(np.ptp(_box(low, high) @ eye[:2].T, axis=0)))
    asides = spread_labels([eye[:2] @ place * points for place, _, _ in marks], [text for _, text, _ in marks])
    for (place, text, paint), aside in zip(marks, asides, strict=True):
        at = (eye @ place)[:2] if names else place
        label(axes, at / scene.units.metres, text, paint, aside)
    if key:
        _key(figure, scene, (1.0 - (key - 0.1) / width, 1.0 - head / height), height)


def _box(low: Array, high: Array) -> Array:
    """(8, 3) the corners of a box."""
    return np.array([[(low, high)[i >> k & 1][k] for k in range(3)] for i in range(8)])


def _faces(scene: Scene, eye: Array) -> tuple[list[Face], list[Face]]:
    """Arms from the farthest part to the nearest, and the axes of frames, in front of all: links would hide them."""
    faces: list[Face] = []
    axes: list[Face] = []
    ghosts: list[Face] = []
    length = scene.arm.length
    drawn: set[tuple[object, ...]] = set()
    paints = scene.colours()
    # Solid arms come first: what of a ghost falls together with one is left out.
    for number, posture in sorted(enumerate(scene.postures), key=lambda entry: entry[1].ghost):
        frames = body_frames(scene.arm.robot, posture.q)
        if posture.ghost:
            ghosts += arm_faces(scene.arm, frames, eye, paints[number], drawn)
            continue
        faces += arm_faces(scene.arm, frames, eye, None, drawn, paints[number])
        for mark in scene.marks():
            axes += frame_faces(frames[mark.body] @ mark.T, length * scene.arm.axes(mark.body), eye)
    if scene.target is not None:
        p = scene.target[:3, 3]
        axes += frame_faces(scene.target, 1.25 * length, eye) if scene.turned else cross_faces(p, length, eye)
    # In a plane all is at one depth, and the ghosts are behind.
    arms = [*ordered(ghosts, eye), *ordered(faces, eye)] if scene.flat else ordered([*ghosts, *faces], eye)
    return arms, ordered(axes, eye)


def _track(axes: Any, scene: Scene, eye: Array, flat: bool) -> None:
    """The way of the tool, where it begins, and what happens on it."""
    if scene.track is None:
        return
    places = scene.track.places
    points = (places @ eye.T)[:, :2] if flat else places
    points = points / scene.units.metres
    axes.plot(*points.T, color=TRACE, linewidth=1.8, zorder=6)
    axes.plot(*points[:1].T, "o", color=TRACE, markersize=5, zorder=6)
    for row, _ in scene.track.marks:
        axes.plot(*points[row : row + 1].T, "D", color=COLOURS["mark"], markeredgecolor=INK, markersize=6, zorder=7)


def _plane(
    axes: Axes, scene: Scene, faces: list[Face], eye: Array, names: tuple[str, str], box: tuple[Array, Array]
) -> None:
    from matplotlib.collections import PolyCollection

    scale, unit = 1.0 / scene.units.metres, scene.units.length
    (u, v) = ("xyz".index(name) for name in names)
    axes.set(aspect="equal", xlim=(box[0][u] * scale, box[1][u] * scale), ylim=(box[0][v] * scale, box[1][v] * scale),
             xlabel=f"{names[0]} [{unit}]", ylabel=f"{names[1]} [{unit}]")  # fmt: skip
    axes.grid(visible=True)
    axes.spines[["top", "right"]].set_visible(False)
    corners = [face.corners @ eye[:2].T * scale for face in faces]
    paints = [face.colour for face in faces]
    axes.add_collection(PolyCollection(corners, facecolors=paints, edgecolors=paints, linewidths=0.4, zorder=3))


def draw_solid(
    axes: Any, units: Units, view: tuple[float, float], layers: Sequence[list[Face]], box: tuple[Array, Array]
) -> None:
    """Faces (farthest first) in space, layer upon layer, with axes; view: azimuth and elevation [°] of the eye."""
    from matplotlib.ticker import MaxNLocator
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection  # type: ignore[import-untyped]

    scale, unit = 1.0 / units.metres, units.length
    middle, size = 0.5 * (box[0] + box[1]) * scale, (box[1] - box[0]) * scale
    size = np.maximum(size, 0.3 * np.max(size))
    azimuth, elevation = view
    axes.set_proj_type("ortho")
    axes.set(
        xlim=(middle[0] - size[0] / 2, middle[0] + size[0] / 2),
        ylim=(middle[1] - size[1] / 2, middle[1] + size[1] / 2),
        zlim=(middle[2] - size[2] / 2, middle[2] + size[2] / 2),
        xlabel=f"x [{unit}]", ylabel=f"y [{unit}]", zlabel=f"z [{unit}]",
    )  # fmt: skip
    axes.set_box_aspect(size, zoom=0.92)
    axes.view_init(elev=elevation, azim=azimuth)
    for axis, part in zip((axes.xaxis, axes.yaxis, axes.zaxis), size / np.max(size), strict=True):
        axis.set_pane_color((0.97, 0.975, 0.98, 1.0))
        # The ends of the two axes in front meet: one of them goes without its number.
        prune = "upper" if axis is axes.xaxis else None
        axis.set_major_locator(MaxNLocator(nbins=max(round(6 * part), 2), steps=[1, 2, 5, 10], prune=prune))
    axes.tick_params(labelsize=8, pad=1)
    for zorder, layer in enumerate(layers, start=3):
        paints = [face.colour for face in layer]
        drawn = Poly3DCollection([face.corners * scale for face in layer], facecolors=paints, edgecolors=paints,
                                 linewidths=0.4, zorder=zorder)  # fmt: skip
        axes.add_collection3d(drawn, autolim=False)


def _names(scene: Scene) -> list[tuple[Array, str, str]]:
    """What is written where [m], and its colour: frames, joints are told by them, the target, ghosts by number."""
    length = scene.arm.length
    marks: list[tuple[Array, str, str]] = []
    for posture in scene.postures:
        if posture.ghost:
            continue
        frames = body_frames(scene.arm.robot, posture.q)
        marks += [((frames[mark.body] @ mark.T)[:3, 3], mark.name, INK) for mark in scene.marks()]
    if scene.target is not None:
        marks.append((scene.target[:3, 3], "target", INK))
    marks += _numbers(scene)
    together: list[tuple[Array, list[str], str]] = []
    for place, name, paint in marks:
        near = next((entry for entry in together if np.linalg.norm(entry[0] - place) < SAME * length
                     and entry[2] == paint), None)  # fmt: skip
        if near is None:
            together.append((place, [name], paint))
        elif name not in near[1]:
            near[1].append(name)
    return [(place, ", ".join(names), paint) for place, names, paint in together]


def _numbers(scene: Scene) -> list[tuple[Array, str, str]]:
    """The number of each named arm, where it is farthest from all that are elsewhere."""
    named = [(i, posture) for i, posture in enumerate(scene.postures) if posture.label]
    if len(named) < 2:
        return []
    middles = []
    for _, posture in named:
        lines = lines_of(scene.arm, body_frames(scene.arm.robot, posture.q))
        middles.append(np.concatenate([0.5 * (line[:-1] + line[1:]) for line in lines]))
    count = min(map(len, middles))
    places = np.array([middle[:count] for middle in middles])
    marks = []
    for k, (number, _) in enumerate(named):
        apart = np.linalg.norm(places - places[k], axis=2) / scene.arm.length
        together = apart < SAME
        nearest = np.min(np.where(together, 1.0, apart), axis=0)
        best = int(np.argmax(nearest - together.sum(axis=0)))
        marks.append((places[k, best], _tag(scene, number), "number"))
    return marks


def _tag(scene: Scene, number: int) -> str:
    """The number of a named arm among those."""
    return str(1 + sum(bool(posture.label) for posture in scene.postures[:number]))


def label(axes: Any, at: Array, text: str, paint: str, aside: tuple[int, int]) -> None:
    """Letters on white beside a place, in the plane or in space; aside: where, in points."""
    from mpl_toolkits.mplot3d.proj3d import proj_transform  # type: ignore[import-untyped]

    if len(at) == 3:
        at = np.array(proj_transform(*at, axes.get_proj())[:2])
    # A box and no edge of the letters, so that they stay letters in an .svg.
    look: dict[str, Any] = {"ha": "left" if aside[0] > 0 else "right", "bbox": {
        "boxstyle": "round,pad=0.1", "facecolor": "white", "edgecolor": "none", "alpha": 0.6}}  # fmt: skip
    if paint == "number":
        shape = "circle,pad=0.25" if len(text) < 3 else "round,pad=0.25"
        look = {"ha": "center", "va": "center", "bbox": {"boxstyle": shape, "facecolor": "white",
                "edgecolor": "#8a8f94", "linewidth": 0.7}}  # fmt: skip
        aside = (0, 0)
    axes.annotate(text, at[:2], xytext=aside, textcoords="offset points", fontsize=9, color=INK, zorder=9,
                  fontweight="bold", annotation_clip=False, **look)  # fmt: skip


def spread_labels(places: Sequence[Array], texts: Sequence[str]) -> list[tuple[int, int]]:
    """Where letters stand beside their places (2,) in points, so that they do not cover one another."""
    boxes: list[tuple[float, float, float, float]] = []
    asides = []
    for place, text in zip(places, texts, strict=True):
        wide = LETTER[0] * len(text)
        tried = []
        for aside in ASIDES:
            left = place[0] + aside[0] - (0.0 if aside[0] > 0 else wide)
            bottom = place[1] + aside[1]
            box = (left, bottom, left + wide, bottom + LETTER[1])
            cover = sum(max(min(box[2], other[2]) - max(box[0], other[0]), 0.0)
                        * max(min(box[3], other[3]) - max(box[1], other[1]), 0.0) for other in boxes)  # fmt: skip
            tried.append((cover, box, aside))
        _, box, aside = min(tried, key=lambda entry: entry[0])
        boxes.append(box)
        asides.append(aside)
    return asides


def _key(figure: Figure, scene: Scene, corner: tuple[float, float], height: float) -> None:
    """The names of the arms at the right, each with its colour."""
    top, paints = corner[1], scene.colours()
    for i, posture in enumerate(scene.postures):
        if not posture.label:
            continue
        text = f"{_tag(scene, i)}  {posture.label}"
        lines = textwrap.wrap(text, 46, subsequent_indent="    ", break_on_hyphens=False)
        figure.text(corner[0], top, "■", color=colour(paints[i] or COLOURS["revolute"]), fontsize=12, va="top")
        beside = corner[0] + 0.2 / float(figure.get_figwidth())
        figure.text(beside, top, "\n".join(lines), fontsize=8.8, va="top", color=INK, linespacing=1.35)
        top -= (0.185 * len(lines) + 0.1) / height
    for _, words in scene.track.marks[:MARKS] if scene.track is not None else ():
        lines = textwrap.wrap(words, 46)
        figure.text(corner[0], top, "◆", color=COLOURS["mark"], fontsize=10, va="top")
        beside = corner[0] + 0.2 / float(figure.get_figwidth())
        figure.text(beside, top, "\n".join(lines), fontsize=8.8, va="top", color=INK, linespacing=1.35)
        top -= (0.185 * len(lines) + 0.1) / height
