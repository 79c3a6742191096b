"""How large a reachable set is: its length, area or volume, with a bound of the error.

- Where as many joints move the tool's origin as the set has dimensions: the integral over the joints (coarea.py); also
  where each hangs on a variable of its own, by any ratio.
- Of curves and surfaces that variables reach which move several joints, and of lines: geared_size.py.
- Else, where more do or variables move several joints, membership of points decides (descent.py), in cells that are
  split at the boundary (cells.py). A set that is symmetric about the first axis is measured in its section. One that is
  not, only since the first joint has limits, is made so by freeing it, and what that adds is taken off again:

  Let the first joint turn from a to b, and let S be the section of the set with that joint free. A point of S that
  some configuration reaches when the first joint is at q1 is reached as it turns by t, if a - q1 <= t <= b - q1: of
  its circle the arc b - a is certain. Whether a point of the remaining arc is reached is for membership to decide, at
  points drawn from S and from that arc alone.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

from robokin.arrays import Array, Flags
from robokin.jobs.ordered_map import ordered_map
from robokin.model import CoupledRobot, Robot
from robokin.spatial.angles import TURN
from robokin.workspace.coarea import coarea_measure
from robokin.workspace.descent import descent_of
from robokin.workspace.geared_form import one_by_one
from robokin.workspace.geared_size import curved_measure, line_measure
from robokin.workspace.membership import Membership, decided, finitely_many, reachable
from robokin.workspace.region import Region, region_of
from robokin.workspace.sampling import moving_chain
from robokin.workspace.size_cells import RISK, Cells, cells_of, points_in, poisson_limit
from robokin.workspace.sizes import Extent, Measure
from robokin.workspace.space import Space
from robokin.workspace.witnesses import denied_share

DRAWINGS = 8
"""Independent drawings of those points, whose differences tell the error."""

RARE = 30
"""Points fewer than which tell more by their number than by how it differs from drawing to drawing."""

STUDENT = 3.4995
"""Student's t for 99 % on both sides and DRAWINGS - 1 degrees of freedom."""

ARC_SHARE = 4
"""One in so many of the points that may be looked at goes to the remaining arcs."""

UPRIGHT = 1e-9
"""How far a unit vector may lean from a coordinate axis and still be taken for it."""


BUDGET = {1: 8, 2: 10, 3: 5}
"""Membership is asked for one point in so many samples, by the region's coordinates: it takes some tens of steps, a
position takes one; and a boundary that is a surface needs more points than one that is a curve."""

MANY = 5
"""Joints from which on a step costs so much more that fewer points are asked for."""

HALF = np.pi
"""A first joint with less of a turn is not freed: too little of what it then sweeps would be its own."""

WITNESSES, LEAST_WITNESSES = 3, 8192
"""For one in so many samples, and so many at least, a point is sought that the arm is known to reach: the searches must
deny none."""

REDUNDANT = "points called out of reach were not found by search (not proven unreachable)"
"""What is to be known of sets that more joints reach than they have dimensions, unless closed forms decide."""


def measure(
    space: Space, extent: Extent, samples: int, seed: int, cores: int | None = None
) -> tuple[Measure, Cells | None]:
    """The size of the reachable set; `samples` bounds the configurations or points that are looked at. Where points
    were, with the cells that show it: of a set that only the first joint's limits keep from being symmetric about its
    axis those of the set without these limits.

    The same for a seed on any number of cores. Raises ValueError for a curved set that more joints reach
    than it has dimensions (`measurable` tells).
    """
    if not space.moving:
        return Measure(0.0, 0.0, "no joint moves the tool's origin", 0), None
    space = one_by_one(space)
    if space.gears is not None and space.dimension == 1 and space.basis is not None:
        return line_measure(space, seed), None
    if space.gears is not None and space.basis is None and finitely_many(space):
        return curved_measure(space, samples, seed), None
    if finitely_many(space) and space.gears is None:
        return coarea_measure(space, samples, seed, cores), None
    if not measurable(space):
        raise ValueError("the size of a curved set that too many joints reach")
    share = samples / max(1.0, len(space.moving) / MANY) ** 1.5
    if space.axis is None and _symmetric_if_free(space):
        found, cells = _by_freeing(space, extent, max(int(share / BUDGET[2]), 1), seed, cores)
    else:
        region = region_of(space, extent)
        denied = _denied(space, region, share, seed, cores)
        found, cells = cells_of(Membership(space), region, max(int(share / BUDGET[len(region.low)]), 1), seed, cores)
        found = replace(found, error=found.error + denied * found.value)
    return replace(found, exact=decided(space)), cells


def _denied(space: Space, region: Region, share: float, seed: int, cores: int | None) -> float:
    """The part of a set that may be denied by its searches, which have learned all that they can from the arm's own
    positions; nothing where closed forms decide."""
    return (
        0.0
        if decided(space)
        else denied_share(space, region, max(int(share / WITNESSES), LEAST_WITNESSES), seed, cores)
    )


def measurable(space: Space) -> bool:
    """Whether `measure` knows a way: for all but curved sets that more joints reach than they have dimensions."""
    return finitely_many(space) or not space.moving or space.basis is not None


def several_measure(space: Space, samples: int, seed: int, cores: int | None = None) -> Measure:
    """The size of the part of the reachable set in which at least two orientations are possible.

    For arms whose position leaves only finitely many; raises ValueError for others.
    """
    if not finitely_many(space) or len(space.moving) < space.arm.n:
        raise ValueError("the position leaves infinitely many orientations")
    return coarea_measure(space, samples, seed, cores, several=True)


def structural_length(robot: Robot) -> float:
    """Σ (|a| + |d|) over the links, the tool's length, and the strokes of the sliding joints [m].

    The length of a robot that is described by frames instead of a table is that of its transforms' translations.
    The sum is the length sum of J. J. Craig, Introduction to Robotics: Mechanics and Control. Infinite where a
    sliding joint has no limits; of one that others move the stroke is what their limits leave it.
    """
    total = float(np.linalg.norm(robot.tool[:3, 3]))
    for row in robot.rows:
        total += abs(row.a) + abs(row.d) + (0.0 if row.origin is None else float(np.linalg.norm(row.origin[:3, 3])))
    arm = robot.bounded_motion if isinstance(robot, CoupledRobot) else robot
    slides = ~arm.revolute
    return total + float(np.sum(arm.limits[slides, 1] - arm.limits[slides, 0]))


def _symmetric_if_free(space: Space) -> bool:
    """Whether the set would be symmetric about the first axis if the first joint, which turns far, had no limits."""
    first = space.moving[0]
    turns = space.leads and first == 0 and space.robot.revolute[first] and space.dimension > 1
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


def _by_freeing(space: Space, extent: Extent, samples: int, seed: int, cores: int | None) -> tuple[Measure, Cells]:
    free, wide = _freed(space, extent)
    region = region_of(free, wide)
    denied = [_denied(one, region, 0.5 * BUDGET[2] * samples, seed, cores) for one in (free, space)]
    count = max(samples // (ARC_SHARE * DRAWINGS), 1)
    part = max(samples - count * DRAWINGS, 1)
    symmetric, cells = cells_of(Membership(free), region, part, seed, cores)
    stroke = float(space.high[space.moving[0]] - space.low[space.moving[0]])
    arcs = _arcs(space, free, cells, count, seed, cores)
    certain = stroke / TURN
    value = certain * symmetric.value + arcs[0]
    error = certain * symmetric.error + arcs[1]
    # Of what lies in cells thought to be empty the remaining arcs have not been looked at.
    error += (1.0 - certain) * abs(symmetric.value - cells.size)
    error += certain * denied[0] * symmetric.value + denied[1] * float(np.mean(arcs))
    method = f"{symmetric.method}; the first joint's limits by points on the arcs that they may cut off"
    return Measure(value, error, method, symmetric.evaluations + count * DRAWINGS), cells


def _arcs(space: Space, free: Space, cells: Cells, count: int, seed: int, cores: int | None) -> tuple[float, float]:
    """What is reached of the arcs that are not certain, and its error's bound, from DRAWINGS times `count` points."""
    some = cells.fraction > 0.0
    low, high = cells.low[some], cells.high[some]
    if not len(low):
        return 0.0, 0.0
    rng = np.random.default_rng((seed, 0xA2C5))
    points = [cells.region.points(points_in(cells.region, low, high, count, rng)[0]) for _ in range(DRAWINGS)]
    drawn = np.column_stack([np.concatenate(points), rng.random(count * DRAWINGS)])
    blocks = np.array_split(drawn, max(len(drawn) // Membership.least, 1))
    hits = np.concatenate(list(ordered_map(partial(_beyond, space, free), blocks, cores)))
    first = space.moving[0]
    remaining = 1.0 - float(space.high[first] - space.low[first]) / TURN
    whole = float(np.sum(cells.region.sizes(low, high)))
    shares = np.mean(hits.reshape(DRAWINGS, count), axis=1)
    off = STUDENT * float(np.std(shares, ddof=1)) / float(np.sqrt(DRAWINGS))
    # Where few points say one thing and all others the other, drawings may agree by chance.
    rare = int(min(np.sum(hits), np.sum(~hits)))
    if rare < RARE:
        off = max(off, (poisson_limit(rare, RISK) - rare) / len(hits))
    return whole * remaining * float(np.mean(shares)), whole * remaining * off


def _beyond(space: Space, free: Space, drawn: Array) -> Flags:
    """(m,) whether points are reached once they are turned about the first axis onto the arc that is not certain, each
    by a part of it; drawn: (m, 4), the points of the free space's section [m] and these parts."""
    first = space.moving[0]
    inside, q = descent_of(free).reached(drawn[:, :3])
    points, along = drawn[inside, :3], drawn[inside, 3]
    remaining = TURN - float(space.high[first] - space.low[first])
    turn = space.high[first] + along * remaining - q[0, inside]
    foot, z = moving_chain(space).constants[0][:3, 3], moving_chain(space).constants[0][:3, 2]
    inside[inside] = reachable(space, _turned(points - foot, z, turn) + foot)
    return inside


def _turned(v: Array, axis: Array, angle: Array) -> Array:
    """Vectors v (m, 3) turned about an axis by angles (m,): Rodrigues' formula."""
    c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
    return c * v + s * np.cross(axis, v) + (1.0 - c) * (v @ axis)[:, None] * axis
