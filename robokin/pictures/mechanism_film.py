"""A mechanism in motion as a .gif: its links, the ways of its joints, the paths of points."""

from __future__ import annotations

import numpy as np

from robokin.errors import InputError
from robokin.number_text import show
from robokin.pictures.arm_scene import eye_axes
from robokin.pictures.film import FilmStage, Shot, film, film_rows
from robokin.pictures.mechanism_scene import PLAYED, MechanismScene, shape_faces
from robokin.pictures.mechanism_shape import PATHS
from robokin.pictures.mechanism_stills import NAMES, looped

WAY = "#8a8f94"
"""Colour of the ways of joints."""


def mechanism_film(scene: MechanismScene) -> bytes:
    """The motion as a .gif. Raises InputError for what does not move, and where matplotlib is missing."""
    trace, units = scene.trace, scene.units
    if trace is None or len(trace.poses) < 2:
        why = scene.note or f"{scene.mechanism.name} has none, expected a mechanism that moves"
        raise InputError(f"a .gif shows a motion: {why}")
    eye, lead = eye_axes(scene.view), scene.lead()
    count = len(trace.poses)
    # A motion that does not come back goes to and fro.
    order = [*range(count)] if trace.closed else [*range(count), *range(count - 2, 0, -1)]
    rows, pause = film_rows(np.linspace(0.0, 1.0, len(order)), PLAYED * (1.0 if trace.closed else 2.0), closed=True)
    ways = [(looped(way, trace.closed), WAY) for way in scene.ways()]

    def shot(row: int) -> Shot:
        k = order[row]
        poses = trace.poses[k]
        names = [((poses[body] @ [*place, 1.0])[:3], name) for name, body, place in scene.shape.names[:NAMES]]
        caption = ""
        if lead >= 0:
            turns = bool(trace.turning[lead])
            value = float(trace.values[k, lead]) / (units.radians if turns else units.metres)
            caption = f"{trace.driven} {show(round(value, 3))} {units.angle if turns else units.length}"
        paths = [(scene.paths[:, i], PATHS[i % len(PATHS)], k) for i in range(scene.paths.shape[1])]
        return Shot(list(shape_faces(scene.shape, poses, eye)), caption, (), names, paths, ways)

    low, high = scene.bounds()
    return film(FilmStage(scene.mechanism.name, (low, high), scene.view, units), rows, pause, shot, closed=True)
