"""How large a reachable set is: its length, area or volume, with a bound of the error.

- Where as many joints move the tool's origin as the set has dimensions: the integral over the joints (coarea.py).
- Where more do, membership of points decides (descent.py), in cells that are split at the boundary (cells.py). A
  set that is symmetric about the first axis is measured in its section. One that is not, only since the first joint
  has limits, is made so by freeing it, and what that adds is taken off again:

  Let the first joint turn from a to b, and let S be the section of the set with that joint free. A point of S that
  some configuration reaches when the first joint is at q1 is reached as it turns by t, if a - q1 <= t <= b - q1: of
  its circle the arc b - a is certain. Whether a point of the remaining arc is reached is for membership to decide, at
  points drawn from S and from that arc alone.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from robokin.model import Robot
from robokin.workspace.cells import cells_of
from robokin.workspace.coarea import SCRAMBLINGS, STUDENT, coarea_measure
from robokin.workspace.descent import descent_of
from robokin.workspace.membership import Membership, finitely_many, reachable
from robokin.workspace.parallel import in_order
from robokin.workspace.region import Region, region_of
from robokin.workspace.result import Extent, Measure
from robokin.workspace.sampling import moving_chain
from robokin.workspace.sequence import unit_points
from robokin.workspace.space import TURN, Space

Array = NDArray[np.float64]

ARC_SHARE = 4
"""One in so many of the points that may be looked at goes to the remaining arcs."""

EDGE = 0.65
"""The part of the points that finds the boundary of a section, and what lies within it."""

UPRIGHT = 1e-9
"""How far a unit vector may lean from a coordinate axis and still be taken for it."""


BUDGET = 4
"""Membership is asked for one point in so many samples: it takes some tens of steps, a position takes one."""

MANY = 6
"""Joints from which on a step costs so much more that fewer points are asked for."""

HALF = np.pi
"""A first joint with less of a turn is not freed: too little of what it then sweeps would be its own."""

REDUNDANT = "that a point is out of reach is what searches from several starts say; it is not proven"
"""What is to be known of sets that more joints reach than they have dimensions."""


def measure(space: Space, extent: Extent, samples: int, seed: int, cores: int | None = None) -> Measure:
    """The size of the reachable set; `samples` bounds the configurations or points that are looked at.

    The same for a seed on any number of cores. Raises ValueError for a curved set that more joints reach
    than it has dimensions (`measurable` tells).
    """
    if not space.moving:
        return Measure(0.0, 0.0, "no joint moves the tool's origin", 0)
    if finitely_many(space):
        return coarea_measure(space, samples, seed, cores)
    if not measurable(space):
        raise ValueError("the size of a curved set that too many joints reach")
    descent_of(space)
    budget = max(int(samples / (BUDGET * max(1.0, len(space.moving) / MANY) ** 2)), 1)
    if space.axis is None and _symmetric_if_free(space):
        found = _by_freeing(space, extent, budget, seed, cores)
    else:
        found = _in_cells(space, region_of(space, extent), budget, seed, cores)
    # What the searches miss of the set is in no bound.
    return replace(found, exact=False)


def measurable(space: Space) -> bool:
    """Whether `measure` knows a way: for all but curved sets that more joints reach than they have dimensions."""
    return finitely_many(space) or not space.moving or space.basis is not None


def several_measure(space: Space, samples: int, seed: int, cores: int | None = None) -> Measure:
    """The size of the part of the reachable set in which at least two orientations are possible.

    For arms whose position leaves only finitely many; raises ValueError for others.
    """
    if not finitely_many(space) or len(space.moving) < space.robot.n:
        raise ValueError("the position leaves infinitely many orientations")
    return coarea_measure(space, samples, seed, cores, several=True)


def structural_length(robot: Robot) -> float:
    """Σ (|a| + |d|) over the links, the tool's length, and the strokes of the sliding joints [m].

    The length of a robot that is described by frames instead of a table is that of its transforms' translations.
    The sum is the length sum of J. J. Craig, Introduction to Robotics: Mechanics and Control. Infinite where a
    sliding joint has no limits.
    """
    total = float(np.linalg.norm(robot.tool[:3, 3]))
    for row in robot.rows:
        total += abs(row.a) + abs(row.d) + (0.0 if row.origin is None else float(np.linalg.norm(row.origin[:3, 3])))
    slides = ~robot.revolute
    return total + float(np.sum(robot.limits[slides, 1] - robot.limits[slides, 0]))


def _in_cells(space: Space, region: Region, budget: int, seed: int, cores: int | None) -> Measure:
    """The size of a reachable set by membership of `budget` points of a region."""
    inside = Membership(space)
    if len(region.low) == 3:
        return cells_of(inside, region, budget, seed, cores)[0]
    # The boundary of a section is a curve, which a few points tell: most go to the test of all other cells.
    edge = max(int(EDGE * budget), 1)
    return cells_of(inside, region, edge, seed, cores, tests=max(budget - edge, 1))[0]


def _symmetric_if_free(space: Space) -> bool:
    """Whether the set would be symmetric about the first axis if the first joint, which turns far, had no limits."""
    first = space.moving[0]
    turns = first == 0 and space.robot.revolute[first] and space.dimension > 1
    return bool(turns and space.high[first] - space.low[first] >= HALF)


def _freed(space: Space, extent: Extent) -> tuple[Space, Extent]:
    """The space with a first joint that makes a whole turn, and an extent that holds its set."""
    first = space.moving[0]
    low, high, full = space.low.copy(), space.high.copy(), space.full.copy()
    middle = 0.5 * (low[first] + high[first])
    low[first], high[first], full[first] = middle - np.pi, middle + np.pi, True
    axis = np.array(moving_chain(space).constants[0])
    z, foot = axis[:3, 2], axis[:3, 3]
    aside = extent.origin - foot
    reach = extent.greatest + float(np.linalg.norm(aside - (aside @ z) * z))
    along = np.abs(z) > 1.0 - UPRIGHT
    wide = replace(
        extent,
        low=np.where(along, extent.low, foot - reach),
        high=np.where(along, extent.high, foot + reach),
    )
    return replace(space, low=low, high=high, full=full, axis=axis), wide


def _by_freeing(space: Space, extent: Extent, samples: int, seed: int, cores: int | None) -> Measure:
    free, wide = _freed(space, extent)
    descent_of(free)
    region = region_of(free, wide)
    count = max(samples // (ARC_SHARE * SCRAMBLINGS), 1)
    part = max(samples - count * SCRAMBLINGS, 1)
    symmetric = _in_cells(free, region, part, seed, cores)
    stroke = float(space.high[space.moving[0]] - space.low[space.moving[0]])
    estimate = partial(_arcs, space, free, region, count, seed)
    arcs = np.array(list(in_order(estimate, range(SCRAMBLINGS), cores)))
    certain = stroke / TURN
    value = certain * symmetric.value + float(np.mean(arcs))
    error = certain * symmetric.error + STUDENT * float(np.std(arcs, ddof=1)) / float(np.sqrt(SCRAMBLINGS))
    method = f"{symmetric.method}; the first joint's limits by points on the arcs that they may cut off"
    return Measure(value, error, method, symmetric.evaluations + count * SCRAMBLINGS)


def _arcs(space: Space, free: Space, region: Region, count: int, seed: int, scrambling: int) -> float:
    """One scrambling's estimate of what is reached of the arcs that are not certain."""
    first = space.moving[0]
    remaining = TURN - float(space.high[first] - space.low[first])
    u = unit_points("sobol", len(region.low) + 1, seed, 0, count, count, scrambling)
    coordinates = region.low[:, None] + (region.high - region.low)[:, None] * u[:-1]
    # As many points at each distance from the axis as the circle there is long.
    coordinates[0] = np.sqrt(region.low[0] ** 2 + u[0] * (region.high[0] ** 2 - region.low[0] ** 2))
    points = region.points(coordinates.T)
    inside, q = descent_of(free).reached(points)
    points, q, along = points[inside], q[:, inside], u[-1, inside]
    turn = space.high[first] + along * remaining - q[0]
    foot, z = moving_chain(space).constants[0][:3, 3], moving_chain(space).constants[0][:3, 2]
    turned = _turned(points - foot, z, turn) + foot
    hits = np.count_nonzero(reachable(space, turned))
    whole = float(region.sizes(region.low[None], region.high[None])[0])
    return whole * remaining / TURN * hits / count


def _turned(v: Array, axis: Array, angle: Array) -> Array:
    """Vectors v (m, 3) turned about an axis by angles (m,): Rodrigues' formula."""
    c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
    return c * v + s * np.cross(axis, v) + (1.0 - c) * (v @ axis)[:, None] * axis
