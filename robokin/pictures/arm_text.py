"""An arm as a stick figure in text."""

from __future__ import annotations

import unicodedata
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from robokin.arrays import Array, Flags
from robokin.model import Robot
from robokin.pictures.arm import body_frames, lines_of
from robokin.pictures.arm_scene import PLANES, Scene, axis_names, eye_axes
from robokin.pictures.text_pictures import braille, dot_grid, framed

LONGEST_NAME = 14
"""Characters of a tip's name in a picture."""

ROWS = (0, 1, -1, 2, -2)
"""Rows, downwards from a tip's own, in which its name may stand where many tips are in one place."""

BLOB = 1.6
"""Radius of a joint in dots."""


def arm_text(scene: Scene) -> str:
    """The scene's arms in its plane, or of a solid one the upright plane that shows more: lines, dots for joints.

    With the scene's frames the numbers of the rows stand beside their frames, beside a tree's tips always their names.
    """
    robot, scale = scene.arm.robot, 1.0 / scene.units.metres
    frames = [body_frames(robot, posture.q) for posture in scene.postures]
    lines = [line for poses in frames for line in lines_of(scene.arm, poses)]
    if scene.target is not None:
        lines.append(scene.target[None, :3, 3])
    view = scene.view
    if axis_names(view) is None:
        extent = np.ptp(np.concatenate(lines), axis=0)
        view = PLANES[1] if extent[0] >= extent[1] else PLANES[0]
        if not isinstance(robot, Robot):
            # Branches lie beside one another: along the direction in which there is least they cover each other least.
            view = PLANES[int(np.argmin(extent[[0, 1, 2]]))]
    eye = eye_axes(view)[:2]
    names = axis_names(view) or ("right", "up")
    places = [line @ eye.T for line in lines]
    whole = np.concatenate([*places, np.zeros((1, 2)) + places[0][0]])
    low, high = whole.min(axis=0), whole.max(axis=0)
    room = 0.05 * (float(np.max(high - low)) or scene.arm.length)
    inner = [*scene.arm.marks[1:-1]] if scene.frames else []
    marks = inner if isinstance(robot, Robot) else scene.marks()[1:]
    named = [(eye @ (frames[0][mark.body] @ mark.T)[:3, 3], mark.name) for mark in marks]
    low, high = low - room, high + room
    grid, step = dot_grid(low, high)
    if not isinstance(robot, Robot):
        named = [(place, short_name(name)) for place, name in named]
        for _ in range(2):  # names need room at the right, for which the dots come nearer to each other
            ends = [place[0] + 2.0 * step * (len(cells_of(name)) + 3) for place, name in named]
            grid, step = dot_grid(low, np.array([max([high[0], *ends]), high[1]]))
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
    page = named_lines(braille(mask), grid, step, named, (0,) if isinstance(robot, Robot) else ROWS)
    corner = (np.array([grid[0, 0, 0], grid[-1, 0, 1]]) - 0.5 * step) * scale
    labels = f"{names[0]} [{scene.units.length}]", f"{names[1]} [{scene.units.length}]"
    return framed(page, corner, (2 * step * scale, 4 * step * scale), labels)


def short_name(name: str) -> str:
    """A name that leaves room for the picture, its end cut."""
    cells = cells_of(name)
    return name if len(cells) <= LONGEST_NAME else "".join(cells[: LONGEST_NAME - 1]) + "…"


def mark_dots(mask: Flags, grid: Array, step: float, points: Array) -> None:
    """Set the dots of a grid, `step` apart, that points (m, 2) fall on."""
    column = np.round((points[:, 0] - grid[0, 0, 0]) / step).astype(int)
    row = np.round((grid[0, 0, 1] - points[:, 1]) / step).astype(int)
    inside = (column >= 0) & (column < mask.shape[1]) & (row >= 0) & (row < mask.shape[0])
    mask[row[inside], column[inside]] = True


def named_lines(
    lines: list[str], grid: Array, step: float, names: list[tuple[Array, str]], rows: Sequence[int] = (0,)
) -> list[str]:
    """The lines with names a character to the right of their places, one beside the other where they meet.

    rows: those from the place's own on, downwards, in which a name may stand where there is no room.
    """
    page = [list(line) for line in lines]
    taken: set[tuple[int, int]] = set()
    for place, name in names:
        cells = cells_of(name)
        own = int(np.clip((grid[0, 0, 1] - place[1]) / step // 4, 0, len(page) - 1))
        for row in (own + k for k in rows if 0 <= own + k < len(page)):
            column = int((place[0] - grid[0, 0, 0]) / step // 2) + 2
            while any((row, column + k) in taken for k in range(-1, len(cells))):
                column += 1
            if column >= 0 and column + len(cells) <= len(page[row]):
                page[row][column : column + len(cells)] = cells
                taken |= {(row, column + k) for k in range(len(cells))}
                break
    return ["".join(line) for line in page]


def cells_of(name: str) -> list[str]:
    """A name by the columns that it takes: what is behind a wide character is empty."""
    return [cell for c in name for cell in ((c, "") if unicodedata.east_asian_width(c) in "WF" else (c,))]
