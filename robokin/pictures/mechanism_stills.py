"""Mechanisms in space as still pictures by matplotlib: .png, .svg, .pdf."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING, Any

import numpy as np

from robokin.arrays import Array
from robokin.pictures.arm_faces import ordered
from robokin.pictures.arm_scene import eye_axes
from robokin.pictures.arm_stills import INK, draw_solid, label, spread_labels
from robokin.pictures.mechanism_scene import MechanismScene, shape_faces
from robokin.pictures.mechanism_shape import PATHS
from robokin.pictures.workspace_stills import FREE, drawing, written

if TYPE_CHECKING:
    from matplotlib.figure import Figure


SIDE = 5.6
"""Inches of the drawing's longer side."""

NAMES = 24
"""Joints that are named at most: the letters of more would cover the picture."""


def mechanism_still(scene: MechanismScene, kind: str) -> bytes:
    """The mechanism as assembled, as a file of one of `stills.KINDS`; the ways of its joints are drawn faintly, paths
    of points boldly. Raises InputError where matplotlib is missing."""
    with drawing(kind) as figure:
        _draw(figure, scene)
        return written(figure, kind, tight=True)


def _draw(figure: Figure, scene: MechanismScene) -> None:
    low, high = scene.bounds()
    eye = eye_axes(scene.view)
    inches = np.array([SIDE * 1.12, SIDE])
    width, height = float(inches[0]) + 0.55, float(inches[1]) + 0.9
    figure.set_size_inches(width, height)
    title = "\n".join(textwrap.wrap(scene.mechanism.name, 52)[:2])
    figure.text(0.5, 1.0 - 0.3 / height, title, ha="center", va="center", fontsize=15, fontweight="bold",
                color="#111111")  # fmt: skip
    if scene.note:
        figure.text(0.5, 1.0 - 0.62 / height, scene.note, ha="center", va="center", fontsize=10, color="#444444")
    room = (0.2 / width, 0.2 / height, inches[0] / width, inches[1] / height)
    axes: Any = figure.add_axes(room, projection="3d", computed_zorder=False)
    still = np.tile(np.eye(4), (len(scene.mechanism.links), 1, 1))
    faces = ordered(list(shape_faces(scene.shape, still, eye)), eye)
    draw_solid(axes, scene.units, scene.view, [faces], (low, high))
    scale = 1.0 / scene.units.metres
    closed = scene.trace is not None and scene.trace.closed
    for way in scene.ways():
        axes.plot(*looped(way * scale, closed).T, color=FREE, linewidth=0.8, linestyle=(0, (4, 2.5)), zorder=2)
    for i in range(scene.paths.shape[1]):
        paint = PATHS[i % len(PATHS)]
        axes.plot(*looped(scene.paths[:, i] * scale, closed).T, color=paint, linewidth=1.8, zorder=5, label=f"P{i + 1}")
    if scene.paths.shape[1]:
        axes.legend(loc="upper right", frameon=False, fontsize=8.5)
    marks = [(place, name) for name, _, place in scene.shape.names][:NAMES]
    points = 72.0 * SIDE / float(np.max(np.ptp(np.array([low, high]) @ eye[:2].T, axis=0)) or 1.0)
    asides = spread_labels([eye[:2] @ place * points for place, _ in marks], [name for _, name in marks])
    for (place, name), aside in zip(marks, asides, strict=True):
        label(axes, place * scale, name, INK, aside)


def looped(path: Array, closed: bool) -> Array:
    """A way (m, 3), of a closed motion with its beginning at the end."""
    return np.concatenate([path, path[:1]]) if closed else path
