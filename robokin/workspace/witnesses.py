"""What searches deny although the arm reaches it, told by the arm itself.

Wherever forward kinematics puts the tool's origin it can be reached: every sampled configuration is a witness of one
point. Of a great many, half of them with joints at their limits, one is kept in each cell of a lattice, so that they
are spread over the set as evenly as it is known; and the searches are asked for them. Those that they deny become
starts of further searches (`Descent.learn`), and others are asked for, until none is denied. What may then be
denied still, by the upper limit of a Poisson variable, is a part of the size's bound.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from robokin.arrays import Array
from robokin.jobs.ordered_map import ordered_map
from robokin.jobs.sequences import unit_points
from robokin.workspace.descent import descent_of
from robokin.workspace.geared_starts import spread_to_limits
from robokin.workspace.membership import Membership, reachable
from robokin.workspace.region import Region
from robokin.workspace.sampling import moving_cuts, positions
from robokin.workspace.size_cells import RISK, poisson_limit
from robokin.workspace.space import Space

DRAWN = 8
"""Configurations drawn for each cell."""

BEYOND = 0.3
"""Part of its range by which a joint's value may pass each limit, to be put back to it, in every other one."""

ROUNDS = 4
"""Times that witnesses are drawn at most."""


def denied_share(space: Space, region: Region, count: int, seed: int, cores: int | None) -> float:
    """The part of the set that the searches of a space may deny, at most, by `count` witnesses or fewer; the searches
    have then learned from those that they denied."""
    descent = descent_of(space)
    descent.hurry()
    most = 1.0
    for round_ in range(ROUNDS):
        q = _witnesses(space, region, count, seed, round_)
        p = positions(space, q).T
        blocks = np.array_split(p, max(len(p) // Membership.least, 1))
        denied = ~np.concatenate(list(ordered_map(partial(reachable, space), blocks, cores)))
        most = min(poisson_limit(int(np.sum(denied)), RISK) / max(len(p), 1), 1.0)
        if not denied.any():
            break
        descent.learn(q[list(space.moving)][:, denied])
    return most


def _witnesses(space: Space, region: Region, count: int, seed: int, round_: int) -> Array:
    """(n, k) configurations, one for each cell that some reach of a lattice of about `count` cells."""
    moving = list(space.moving)
    drawn = DRAWN * count
    q = np.tile(0.5 * (space.low + space.high)[:, None], (1, drawn))
    if space.gears is not None:
        low, high = space.low[moving], space.high[moving]
        q[moving] = spread_to_limits(moving_cuts(space), low, high, drawn, 1000 + round_, seed)
    else:
        u = unit_points("sobol", len(moving), seed, 0, drawn, drawn, 1000 + round_)
        u[:, ::2] = np.clip((1.0 + 2.0 * BEYOND) * u[:, ::2] - BEYOND, 0.0, 1.0)
        q[moving] = space.low[moving, None] + (space.high - space.low)[moving, None] * u
    place = region.coordinates(positions(space, q).T)
    sides = region.high - region.low
    shape = np.maximum(np.round(sides / float(np.prod(sides) / count) ** (1.0 / len(sides))), 1.0)
    cell = np.clip(np.floor((place - region.low) / sides * shape), 0.0, shape - 1.0).astype(np.intp)
    _, first = np.unique(np.ravel_multi_index(tuple(cell.T), tuple(shape.astype(int))), return_index=True)
    return np.asarray(q[:, first])
