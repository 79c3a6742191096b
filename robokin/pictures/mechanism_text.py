"""A mechanism as a stick figure in text."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from robokin.pictures.arm_scene import axis_names, eye_axes
from robokin.pictures.arm_text import BLOB, mark_dots, named_lines
from robokin.pictures.mechanism_scene import MechanismScene
from robokin.pictures.text_pictures import braille, dot_grid, framed

NAMES = 16
"""Joints that are named at most: the letters of more would cover the figure."""


def mechanism_text(scene: MechanismScene) -> str:
    """The links as lines, the joints as dots with their names, as the eye sees them."""
    eye = eye_axes(scene.view)[:2]
    names = axis_names(scene.view) or ("right", "up")
    scale = 1.0 / scene.units.metres
    lines = [np.array([piece.a, piece.b]) @ eye.T for piece in scene.shape.pieces if piece.sides == 12]
    wheels = [piece for piece in scene.shape.pieces if piece.sides == 48]
    turn = np.linspace(0.0, 2.0 * np.pi, 180)[:, None]
    for piece in wheels:
        z = (piece.b - piece.a) / np.linalg.norm(piece.b - piece.a)
        ring = np.cos(turn) * piece.across + np.sin(turn) * np.cross(z, piece.across)
        lines.append((0.5 * (piece.a + piece.b) + piece.widths[0] * ring) @ eye.T)
    places = np.array([place for _, _, place in scene.shape.names]).reshape(-1, 3) @ eye.T
    whole = np.concatenate([*lines, places])
    low, high = whole.min(axis=0), whole.max(axis=0)
    room = 0.05 * (float(np.max(high - low)) or scene.shape.size)
    grid, step = dot_grid(low - room, high + room)
    mask = np.zeros(grid.shape[:2], dtype=bool)
    for line in lines:
        for a, b in pairwise(line):
            count = int(np.ceil(np.linalg.norm(b - a) / (0.5 * step))) + 1
            mark_dots(mask, grid, step, a + (b - a) * np.linspace(0.0, 1.0, count)[:, None])
    turn = np.linspace(0.0, 2.0 * np.pi, 24)
    blob = BLOB * step * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    for place in places:
        mark_dots(mask, grid, step, place + blob)
    named = [(place, name) for place, (name, _, _) in zip(places, scene.shape.names, strict=True)][:NAMES]
    page = named_lines(braille(mask), grid, step, named)
    corner = (np.array([grid[0, 0, 0], grid[-1, 0, 1]]) - 0.5 * step) * scale
    labels = f"{names[0]} [{scene.units.length}]", f"{names[1]} [{scene.units.length}]"
    return framed(page, corner, (2 * step * scale, 4 * step * scale), labels)
