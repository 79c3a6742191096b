"""Where in a picture how many of the orientations can be reached."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product
from typing import cast

import numpy as np

from robokin.arrays import Array, Whole
from robokin.pictures.compose import bounds_in
from robokin.pictures.picture import GridTable, OrientationDegrees, parts
from robokin.pictures.views import View
from robokin.workspace.attitudes import Group, attitudes
from robokin.workspace.pose_descent import searched
from robokin.workspace.trials import fractions
from robokin.workspace.workspace_result import Workspace

SQUARES = 120
"""Squares along the longer side of a picture at most: where a map is finer, more would not be seen."""


PLACES = 40
"""Squares along the longer side of a plane where orientations are tried for the picture alone."""

SEARCHED_PLACES = 24
"""The same where every orientation is searched for, which takes some milliseconds."""

FEWER = 2
"""One in so many of a map's orientations is tried there: colours need no more than 300."""

LEAST = 32
"""Orientations at least."""

MOST_RINGS = 40
"""Rings of cells that a map is widened by at most."""

SPACE_RINGS = 2
"""Rings of cells about a map in space: the set's boundary cuts cells in two."""


@dataclass(frozen=True, eq=False)
class OrientationMap:
    """A map of orientations as a picture needs it: a table over the coordinates that the map was made in.

    A map of a set that is symmetric about an axis knows only the distance from the axis and, of a solid, the height.
    """

    view: View
    axis: Array | None
    flat: bool
    first: Array
    cell: float
    table: Array

    @classmethod
    def of(cls, view: View, found: Workspace, cores: int | None = None) -> OrientationMap | None:
        """The map of a workspace as a plane shows it; None where there is none.

        A solid without symmetry has a coarse map: orientations are tried again all over the plane.
        """
        space, dexterity = found.space, found.dexterity
        if dexterity is None or not len(dexterity.points):
            return None
        if space.dimension == 3 and not dexterity.section:
            return cls._tried(view, found, cores)
        axis = space.axis if dexterity.section else None
        empty = cls(view, axis, space.dimension == 2, np.zeros(0), dexterity.cell, np.zeros(0))
        # Half a square's diagonal beyond the map's own cells.
        rings = min(int(np.ceil(0.75 * _square(view, dexterity.cell) / dexterity.cell)) + 1, MOST_RINGS)
        return empty._filled(empty.coordinates(dexterity.points), dexterity.fraction, rings)

    @classmethod
    def _tried(cls, view: View, found: Workspace, cores: int | None) -> OrientationMap | None:
        """The map of a plane itself."""
        space, dexterity = found.space, found.dexterity
        assert dexterity is not None
        low, high = bounds_in(view)
        group = cast(Group, dexterity.group)
        tried = attitudes(space, group, max(dexterity.orientations // FEWER, LEAST), found.seed)
        cell = float(np.max(high - low)) / (SEARCHED_PLACES if searched(space, tried.task) else PLACES)
        places = _middles(low, high, cell)
        places = places[view.contains(places)]
        if not len(places):
            return None
        fraction = fractions(space, tried, view.points(places), cores)
        return cls(view, None, True, np.zeros(0), cell, np.zeros(0))._filled(places, fraction, 2)

    def _filled(self, coordinates: Array, fraction: Array, rings: int) -> OrientationMap:
        first = coordinates.min(axis=0)
        index = np.round((coordinates - first) / self.cell).astype(int) + rings
        return replace(self, first=first - rings * self.cell, table=_widened(index, fraction, rings))

    def coordinates(self, points: Array) -> Array:
        """(m, d) the map's coordinates [m] of points (m, 3) [m] of the world."""
        if self.axis is not None:
            offset = points - self.axis[:3, 3]
            height = offset @ self.axis[:3, 2]
            distance = np.linalg.norm(offset - height[:, None] * self.axis[:3, 2], axis=1)
            return distance[:, None] if self.flat else np.stack([distance, height], axis=1)
        return self.view.places(points)

    def at(self, places: Array) -> Array:
        """(m,) the fraction at places (m, 2) [m] of the picture, NaN where the map has nothing near."""
        index = np.round((self.coordinates(self.view.points(places)) - self.first) / self.cell).astype(int)
        inside = np.all((index >= 0) & (index < self.table.shape), axis=1)
        found = np.full(len(places), np.nan)
        found[inside] = self.table[tuple(index[inside].T)]
        return found


def _widened(index: Whole, fraction: Array, rings: int) -> Array:
    """A table of the fractions at their indices (c, d), their mean where several fall together, with rings about them
    that go on with the neighbours' mean: an outline cuts squares in two, and not all middles are in the set."""
    shape = tuple(index.max(axis=0) + 1 + rings)
    total, count = np.zeros(shape), np.zeros(shape)
    np.add.at(total, tuple(index.T), fraction)
    np.add.at(count, tuple(index.T), 1.0)
    for _ in range(rings):
        known = count > 0.0
        mean = np.divide(total, count, out=np.zeros(shape), where=known)
        around = [
            (slice(max(step, 0), size + min(step, 0)), slice(max(-step, 0), size + min(-step, 0)))
            for size in shape
            for step in (-1, 0, 1)
        ]
        axes = [around[3 * i : 3 * i + 3] for i in range(len(shape))]
        near, number = np.zeros(shape), np.zeros(shape)
        for pairs in product(*axes):
            to, of = tuple(pair[0] for pair in pairs), tuple(pair[1] for pair in pairs)
            near[to] += mean[of]
            number[to] += known[of]
        total, count = np.where(known, total, near), np.where(known, count, number)
    return np.divide(total, count, out=np.full(shape, np.nan), where=count > 0.0)


def _square(view: View, cell: float) -> float:
    """The side [m] of a picture's squares, for a map's cells of side `cell`."""
    low, high = bounds_in(view)
    return max(cell, float(np.max(high - low)) / SQUARES)


def _middles(low: Array, high: Array, cell: float) -> Array:
    """(m, 2) middles of squares that fill a box."""
    x, y = (np.arange(low[i] + 0.5 * cell, high[i] + 0.5 * cell, cell) for i in range(2))
    return np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)


def degrees_in(view: View, found: Workspace, meaning: str, cores: int | None = None) -> OrientationDegrees | None:
    """The map of a workspace as squares of a plane."""
    freedom = OrientationMap.of(view, found, cores)
    if freedom is None:
        return None
    low, high = bounds_in(view)
    cell = _square(view, freedom.cell)
    places = _middles(low, high, cell)
    fraction = freedom.at(places)
    there = np.isfinite(fraction)
    return OrientationDegrees(places[there], fraction[there], cell, meaning) if np.any(there) else None


def map_in_space(found: Workspace) -> GridTable | None:
    """The map of a solid without symmetry in space, as coarse as it was made; None where there is none."""
    dexterity = found.dexterity
    if dexterity is None or found.space.dimension != 3 or dexterity.section or not len(dexterity.points):
        return None
    first = dexterity.points.min(axis=0)
    index = np.round((dexterity.points - first) / dexterity.cell).astype(int) + SPACE_RINGS
    table = _widened(index, dexterity.fraction, SPACE_RINGS)
    step = np.full(3, dexterity.cell)
    return GridTable("xyz", first - SPACE_RINGS * step, step, parts(table))
