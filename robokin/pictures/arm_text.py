"""An arm as a stick figure in text."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from robokin.arrays import Array, Flags
from robokin.pictures.arm import body_frames, line_of
from robokin.pictures.arm_scene import PLANES, Scene, axis_names, eye_axes
from robokin.pictures.text_pictures import braille, dot_grid, framed

BLOB = 1.6
"""Radius of a joint in dots."""


def arm_text(scene: Scene) -> str:
    """The scene's arms in its plane, or of a solid one the upright plane that shows more: lines, dots for joints.

    With the scene's frames the numbers of the rows stand beside their frames.
    """
    robot, scale = scene.arm.robot, 1.0 / scene.units.metres
    frames = [body_frames(robot, posture.q) for posture in scene.postures]
    lines = [line_of(scene.arm, poses) for poses in frames]
    if scene.target is not None:
        lines.append(scene.target[None, :3, 3])
    view = scene.view
    if axis_names(view) is None:
        extent = np.ptp(np.concatenate(lines), axis=0)
        view = PLANES[1] if extent[0] >= extent[1] else PLANES[0]
    eye = eye_axes(view)[:2]
    names = axis_names(view) or ("right", "up")
    places = [line @ eye.T for line in lines]
    whole = np.concatenate([*places, np.zeros((1, 2)) + places[0][0]])
    low, high = whole.min(axis=0), whole.max(axis=0)
    room = 0.05 * (float(np.max(high - low)) or scene.arm.length)
    grid, step = dot_grid(low - room, high + room)
    mask = np.zeros(grid.shape[:2], dtype=bool)
    for line in places:
        for a, b in pairwise(line):
            count = int(np.ceil(np.linalg.norm(b - a) / (0.5 * step))) + 1
            mark_dots(mask, grid, step, a + (b - a) * np.linspace(0.0, 1.0, count)[:, None])
    turn = np.linspace(0.0, 2.0 * np.pi, 24)
    ring = BLOB * step * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    for poses in frames:
        for pose in poses[1:]:
            mark_dots(mask, grid, step, eye @ pose[:3, 3] + ring)
    page = braille(mask)
    if scene.frames:
        named = [(eye @ (frames[0][mark.body] @ mark.T)[:3, 3], mark.name) for mark in scene.arm.marks[1:-1]]
        page = named_lines(page, grid, step, named)
    corner = (np.array([grid[0, 0, 0], grid[-1, 0, 1]]) - 0.5 * step) * scale
    labels = f"{names[0]} [{scene.units.length}]", f"{names[1]} [{scene.units.length}]"
    return framed(page, corner, (2 * step * scale, 4 * step * scale), labels)


def mark_dots(mask: Flags, grid: Array, step: float, points: Array) -> None:
    """Set the dots of a grid, `step` apart, that points (m, 2) fall on."""
    column = np.round((points[:, 0] - grid[0, 0, 0]) / step).astype(int)
    row = np.round((grid[0, 0, 1] - points[:, 1]) / step).astype(int)
    inside = (column >= 0) & (column < mask.shape[1]) & (row >= 0) & (row < mask.shape[0])
    mask[row[inside], column[inside]] = True


def named_lines(lines: list[str], grid: Array, step: float, names: list[tuple[Array, str]]) -> list[str]:
    """The lines with names a character to the right of their places, one beside the other where they meet."""
    page = [list(line) for line in lines]
    taken: set[tuple[int, int]] = set()
    for place, name in names:
        row = int(np.clip((grid[0, 0, 1] - place[1]) / step // 4, 0, len(page) - 1))
        column = int((place[0] - grid[0, 0, 0]) / step // 2) + 2
        while any((row, column + k) in taken for k in range(-1, len(name))):
            column += 1
        if column >= 0 and column + len(name) <= len(page[row]):
            page[row][column : column + len(name)] = name
            taken |= {(row, column + k) for k in range(len(name))}
    return ["".join(line) for line in page]
