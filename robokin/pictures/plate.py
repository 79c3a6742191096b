"""A workspace's plane picture as text: dots where it can be reached, or shades of how freely."""

from __future__ import annotations

import numpy as np

from robokin.arrays import Array, Flags
from robokin.pictures.compose import bounds_in, outline_in, rings_about, sampled
from robokin.pictures.orientation_picture import OrientationMap
from robokin.pictures.outline import Outline
from robokin.pictures.text_pictures import braille, dot_grid, framed, shaded
from robokin.pictures.views import View
from robokin.units import Units
from robokin.workspace.membership import counted
from robokin.workspace.workspace_result import Workspace

CONFIGURATIONS = 1 << 18
"""Configurations whose positions fill the dots: some twenty-five for each."""


def plate(view: View, found: Workspace, units: Units) -> str:
    """The reachable set in a plane as lines of text, with axes in the units."""
    low, high = bounds_in(view)
    grid, step = dot_grid(low, high)
    return _page(braille(_dots(view, found, grid, step)), view, grid, step, (2, 4), units)


def shaded_plate(view: View, found: Workspace, units: Units, cores: int | None = None) -> str | None:
    """How freely the tool can be turned in a plane, from light to dark; None where there is no map."""
    freedom = OrientationMap.of(view, found, cores)
    if freedom is None:
        return None
    low, high = bounds_in(view)
    grid, step = dot_grid(low, high, (1, 2))
    mask = _dots(view, found, grid, step).reshape(-1, 2, grid.shape[1]).any(axis=1)
    middles = 0.5 * (grid[0::2] + grid[1::2])
    fraction = np.where(mask, freedom.at(middles.reshape(-1, 2)).reshape(mask.shape), np.nan)
    return _page(shaded(fraction), view, grid, step, (1, 2), units)


def _page(lines: list[str], view: View, grid: Array, step: float, dots: tuple[int, int], units: Units) -> str:
    scale = 1.0 / units.metres
    corner = (np.array([grid[0, 0, 0], grid[-1, 0, 1]]) - 0.5 * step) * scale
    labels = f"{view.labels[0]} [{units.length}]", f"{view.labels[1]} [{units.length}]"
    return framed(lines, corner, (dots[0] * step * scale, dots[1] * step * scale), labels)


def _dots(view: View, found: Workspace, grid: Array, step: float) -> Flags:
    """(rows, columns) which dots of a grid (rows, columns, 2) [m] are in the set."""
    space, cells = view.space, found.cells
    if cells is not None and (view.radial == cells.region.radial or (not view.radial and found.space.axis is not None)):
        inside = cells.contains(cells.region.coordinates(view.points(grid.reshape(-1, 2))))
        inside &= (grid.reshape(-1, 2)[:, 0] >= 0.0) | (not view.radial)
        return np.asarray(inside.reshape(grid.shape[:2]))
    flat = space.dimension == 3 or (space.dimension == 2 and space.basis is not None)
    if flat and (rings_about(view) or (space.dimension == 3 and not view.radial and not counted(space))):
        return filled(outline_in(view), grid)
    if flat and counted(space):
        return view.contains(grid.reshape(-1, 2)).reshape(grid.shape[:2])
    rows, columns = grid.shape[:2]
    places = view.places(sampled(space, CONFIGURATIONS))
    column = np.round((places[:, 0] - grid[0, 0, 0]) / step).astype(int)
    row = np.round((grid[0, 0, 1] - places[:, 1]) / step).astype(int)
    inside = (column >= 0) & (column < columns) & (row >= 0) & (row < rows)
    mask = np.zeros((rows, columns), dtype=bool)
    mask[row[inside], column[inside]] = True
    # A dot that no sample hit, among many that were.
    for _ in range(2 if flat else 0):
        beside = np.pad(mask, 1)
        if view.radial:
            beside[:, 0] = beside[:, 1]  # the other side of the axis is the same
        around = np.lib.stride_tricks.sliding_window_view(beside, (3, 3))
        mask |= np.sum(around, axis=(2, 3)) >= 5
    return mask


def filled(outline: Outline, grid: Array) -> Flags:
    """(rows, columns) which points of a grid (rows, columns, 2) [m] lie within an outline: an odd number of its
    curves' sides is at their right."""
    x, rows = grid[0, :, 0], grid[:, 0, 1]
    crossings: list[list[float]] = [[] for _ in rows]
    for loop in outline.loops:
        a, b = loop, np.roll(loop, -1, axis=0)
        for i, y in enumerate(rows):
            at = np.flatnonzero((a[:, 1] > y) != (b[:, 1] > y))
            part = (y - a[at, 1]) / (b[at, 1] - a[at, 1])
            crossings[i] += (a[at, 0] + part * (b[at, 0] - a[at, 0])).tolist()
    return np.array([np.searchsorted(np.sort(found), x) % 2 == 1 for found in crossings]).reshape(grid.shape[:2])
