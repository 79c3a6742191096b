"""A page in one file that needs no network: the mechanism turns with the mouse and moves along its motion.

`window.robokin.move(k)` shows the configuration k of the motion, `window.robokin.pose(link)` is that link's
displacement then: 3 rows of 4 numbers, in the page's length unit.
"""

from __future__ import annotations

import shlex
from typing import Any

import numpy as np

from robokin.arrays import Array
from robokin.pictures.mechanism_scene import PLAYED, MechanismScene
from robokin.pictures.mechanism_shape import PATHS, StraightPiece, link_colours
from robokin.pictures.workspace_page import filled
from robokin.spatial.rotations import quaternion_from_rotation

DIGITS = 5
"""Significant digits of what is only drawn: far finer than a screen."""

TURN = 1e-6
"""What a whole number of a quaternion counts: poses are whole numbers, half as many letters as matrices."""

SHIFT = 2e-6
"""What a whole number of a displacement counts, as a part of the mechanism's size."""

WAY = 1e-4
"""The same of the ways of points, which are only drawn."""

MOST = 360
"""Configurations that a page holds: more are thinned out."""


def mechanism_page(scene: MechanismScene) -> bytes:
    """The scene as an .html file."""
    mechanism, units, trace = scene.mechanism, scene.units, scene.trace
    scale = 1.0 / units.metres
    low, high = scene.bounds()
    size = scene.shape.size * scale
    colours = link_colours(mechanism)
    moving = [link for link in mechanism.links if link != mechanism.ground]
    picked = np.zeros(0, dtype=int)
    if trace is not None:
        picked = np.unique(np.round(np.linspace(0, len(trace.poses) - 1, min(MOST, len(trace.poses)))).astype(int))
    data: dict[str, Any] = {
        "title": mechanism.name,
        "length": units.length,
        "angle": units.angle,
        "links": [[link, colours[link], link == mechanism.ground] for link in mechanism.links],
        "moving": [moving.index(link) if link in moving else -1 for link in mechanism.links],
        "poses": [],
        "labels": [],
        "turning": [],
        "values": [],
        "closed": trace is not None and trace.closed,
        "pieces": [_piece(piece, scale) for piece in scene.shape.pieces],
        "plates": [[plate.body, plate.colour, _short(plate.corners * scale)] for plate in scene.shape.plates],
        "names": [[name, body, _short(place * scale)] for name, body, place in scene.shape.names],
        "grain": [TURN, SHIFT * size, WAY * size],
        "ways": [_counted(way[picked] * scale, WAY * size).reshape(-1).tolist() for way in scene.ways()],
        "paths": [_short(scene.paths[picked, i] * scale) for i in range(scene.paths.shape[1])],
        "size": size,
        "box": _short(np.array([low, high]) * scale),
        "view": list(scene.view),
        "note": scene.note,
        "palette": list(PATHS),
        "seconds": PLAYED,
        "lead": scene.lead(),
        "command": f"robokin dof {scene.words or shlex.quote(mechanism.id)}"
        + (f" --trace {len(picked)} --drive {shlex.quote(trace.driven)}" if trace is not None else ""),
    }
    if trace is not None:
        numbers = [mechanism.links.index(link) for link in moving]
        poses = trace.poses[picked][:, numbers]
        turns = _counted(quaternion_from_rotation(poses[..., :3, :3]), TURN)
        shifts = _counted(poses[..., :3, 3] * scale, SHIFT * size)
        factors = np.where(trace.turning, units.radians, units.metres)
        data |= {
            "poses": np.concatenate([turns, shifts], axis=-1).reshape(len(picked), -1).tolist(),
            "labels": list(trace.labels),
            "turning": trace.turning.tolist(),
            "values": _short(trace.values[picked] / factors),
        }
    return filled("mechanism.html", mechanism.name, data)


def _piece(piece: StraightPiece, scale: float) -> list[Any]:
    ends = [_short(piece.a * scale), _short(piece.b * scale), _short(piece.across)]
    return [piece.colour, *piece.bodies, *ends, *_short(np.array(piece.widths) * scale), piece.sides]


def _counted(values: Array, grain: float) -> Array:
    """Numbers as whole numbers of grains."""
    return np.round(values / grain).astype(np.int64)


def _short(values: Array) -> Any:
    digits = [float(f"{value:.{DIGITS}g}") + 0.0 for value in np.ravel(values).tolist()]
    return np.reshape(digits, np.shape(values)).tolist()
