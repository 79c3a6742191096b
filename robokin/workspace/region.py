"""Boxes of one, two or three coordinates that hold a reachable set, by the symmetry that it has."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import Literal

import numpy as np

from robokin.arrays import Array
from robokin.workspace.sizes import Extent
from robokin.workspace.space import Space

MARGIN = 0.005
"""A region reaches beyond the extent by this part of it: that a bound was found a little short does no harm."""


@dataclass(frozen=True, eq=False)
class Region:
    """A box of d = 1, 2 or 3 coordinates u, the points that they stand for, and how much of the world they are.

    kind: "line", "plane", "box", whose coordinates are lengths along `directions`; "disc" (r) and "section"
    (r, z), where r is the distance from an axis and each point stands for the circle through it. low, high:
    (d,) the box [m]; origin: (3,) the point u = 0 [m]; directions: (3, d) orthonormal.
    """

    kind: Literal["line", "plane", "box", "disc", "section"]
    low: Array
    high: Array
    origin: Array
    directions: Array

    @property
    def radial(self) -> bool:
        """Whether the first coordinate is a distance from an axis of symmetry."""
        return self.kind in ("disc", "section")

    def points(self, u: Array) -> Array:
        """(m, 3) the points [m] of coordinates u: (m, d)."""
        return self.origin + u @ self.directions.T

    def coordinates(self, points: Array) -> Array:
        """(m, d) the coordinates of points (m, 3) [m]: of their shadow, where they are not in the line or plane."""
        offset = points - self.origin
        along = offset @ self.directions
        if self.kind == "disc":
            return np.asarray(np.linalg.norm(offset, axis=1)[:, None])
        if self.kind == "section":
            height = along[:, 1]
            aside = offset - height[:, None] * self.directions[:, 1]
            return np.stack([np.linalg.norm(aside, axis=1), height], axis=1)
        return np.asarray(along)

    def sizes(self, low: Array, high: Array) -> Array:
        """(c,) the length, area or volume of cells with corners low, high: (c, d)."""
        sides = high - low
        if self.radial:
            sides[:, 0] *= np.pi * (high[:, 0] + low[:, 0])
        return np.asarray(np.prod(sides, axis=1))

    def drawn(self, low: Array, high: Array, rng: np.random.Generator) -> Array:
        """(c, d) a point of each cell, uniform in the world: each part of a cell as likely as it is large."""
        part = rng.random(low.shape)
        u = low + part * (high - low)
        if self.radial:
            u[:, 0] = np.sqrt(low[:, 0] ** 2 + part[:, 0] * (high[:, 0] ** 2 - low[:, 0] ** 2))
        return u


def region_of(space: Space, extent: Extent) -> Region:
    """The region that holds the reachable set of a flat or solid space, by its symmetry if it has one.

    Raises ValueError where the set is a curved surface or curve, or a point.
    """
    if space.basis is None or not space.dimension:
        raise ValueError("no box holds this set with its size: it is curved or a point")
    corners = np.array(list(product(*zip(extent.low, extent.high, strict=True))))
    if space.axis is not None and space.dimension > 1:
        return _symmetric(space, extent, corners)
    kinds: dict[int, Literal["line", "plane", "box"]] = {1: "line", 2: "plane", 3: "box"}
    along = (corners - space.centre) @ space.basis
    # The set's points are at `greatest` from the base at most, which bounds them along slanting directions.
    middle = (extent.origin - space.centre) @ space.basis
    low = np.maximum(np.min(along, axis=0), middle - extent.greatest)
    high = np.minimum(np.max(along, axis=0), middle + extent.greatest)
    margin = MARGIN * (high - low)
    return Region(kinds[space.dimension], low - margin, high + margin, space.centre, space.basis)


def _symmetric(space: Space, extent: Extent, corners: Array) -> Region:
    """The half plane of a set that is symmetric about the space's axis, or a flat one's radius."""
    axis = space.axis
    assert axis is not None
    x, z, foot = axis[:3, 0], axis[:3, 2], axis[:3, 3]
    offset = extent.origin - foot
    height = float(offset @ z)
    aside = float(np.linalg.norm(offset - height * z))
    radius = extent.greatest + aside
    # A direction that stands upright on the axis shows the radius itself.
    for i in np.flatnonzero(np.abs(z) < 1e-9):
        radius = min(radius, max(extent.high[i] - foot[i], foot[i] - extent.low[i]))
    radius *= 1.0 + MARGIN
    if space.dimension == 2:
        foot = foot + ((space.centre - foot) @ z) * z
        return Region("disc", np.zeros(1), np.array([radius]), foot, x[:, None].copy())
    heights = (corners - foot) @ z
    low = max(float(heights.min()), height - extent.greatest)
    high = min(float(heights.max()), height + extent.greatest)
    margin = MARGIN * (high - low)
    directions = np.stack([x, z], axis=1)
    return Region("section", np.array([0.0, low - margin]), np.array([radius, high + margin]), foot, directions)
