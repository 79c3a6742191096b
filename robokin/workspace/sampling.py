"""Joint values that fill a robot's joint box, and where they put the tool's origin.

The origin alone is followed, from the tool to the base: p ← C J(q) p. A turn about z costs six operations on a
column of numbers, a twist by a right angle none; that is a quarter of what the whole frame costs.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from robokin.arrays import Array
from robokin.errors import InputError
from robokin.jobs.sequences import RANDOM_BLOCK, Kind, grid_sides, unit_points
from robokin.kernel.chain import Chain, with_joints_at
from robokin.kernel.columns import cos_sin_of_halves
from robokin.kernel.entries import Entry, increased, plus, turned, turned_back
from robokin.kernel.facts import fact
from robokin.workspace.half_spaces import HalfSpaces
from robokin.workspace.space import Space

BLOCK = 4096
"""Configurations followed at once: their columns (32 kB each) stay in the second-level cache."""

TASK = RANDOM_BLOCK
"""Configurations of a task for one core: some ten milliseconds of work, and no random number drawn twice."""


ATTEMPTS = 64
"""Times that configurations outside of what cuts a box are drawn anew; then they are put where one variable after
another has a place, which is within, and no more as likely everywhere."""

ANEW = 1 << 20
"""Sequences of a seed between two attempts."""


def sample_count(space: Space, kind: Kind, samples: int, every: bool = False) -> int:
    """How many configurations a sequence of `samples` has: fewer for a grid, whose sides have whole numbers.

    Raises InputError for less than one, and for a grid where limits of joints that several others move cut the box.
    """
    if samples < 1:
        raise InputError(f"found {samples} samples, expected at least 1")
    if kind != "grid":
        return samples
    if space.gears is not None and len(space.gears.cuts.h):
        raise InputError(
            "sampling: found 'grid', expected 'sobol' or 'random', since limits of joints that several others move cut "
            "corners off the box of values"
        )
    sides = len(_filled(space, every))
    return int(grid_sides(sides, samples) ** sides)


def joint_values(
    space: Space, kind: Kind, seed: int, start: int, count: int, total: int, every: bool = False, scramble: int = 0
) -> Array:
    """Configurations start … start + count - 1 of the `total` of a sequence: (n, count) [rad | m].

    The joints that move the tool's origin have the sequence's first dimensions. The others are left in the middle of
    their range unless `every` asks for all; either way the positions are the same (but for a grid's, which is
    coarser the more dimensions it has). What limits of joints cut off the box of their variables is left out, each
    configuration that falls there being drawn anew. Raises InputError for an unknown kind.
    """
    filled = _filled(space, every)
    u = unit_points(kind, len(filled), seed, start, count, total, scramble)
    q = np.empty((len(space.low), u.shape[1]))
    q[:] = (0.5 * (space.low + space.high))[:, None]
    width = space.high - space.low
    if kind == "grid":
        # Both ends of a whole turn are one place.
        side = grid_sides(len(filled), total)
        width = np.where(space.full, width * (side - 1) / side, width)
    for row, i in zip(u, filled, strict=True):
        np.multiply(row, width[i], out=q[i])
        q[i] += space.low[i]
    if space.gears is None or not len(space.gears.cuts.h):
        return q
    width, cuts, first = width[filled, None], space.gears.cuts, u
    out = np.flatnonzero(~cuts.contains(q))
    for attempt in range(1, ATTEMPTS):
        if not len(out):
            break
        # At random: of two scrambled even sequences points of one number have to do with each other.
        u = unit_points("random", len(filled), seed, start, count, total, scramble + attempt * ANEW)[:, out]
        q[np.array(filled)[:, None], out] = space.low[filled, None] + width * u
        out = out[~cuts.contains(q[:, out])]
    if len(out):
        within = np.full((len(q), len(out)), 0.5)
        within[filled] = first[:, out]
        q[:, out] = cuts.filled(within, space.low, space.high)
    return q


def _filled(space: Space, every: bool) -> list[int]:
    """The joints whose values are spread over their range: those that move the tool's origin first, and all that limits
    link to others."""
    rest = [i for i in range(len(space.low)) if i not in space.moving]
    if not every:
        rest = [i for i in rest if space.gears is not None and space.gears.cuts.linked[i]]
    return [*space.moving, *rest]


def positions(space: Space, q: Array) -> Array:
    """Where the tool's origin is: (3, m) [m], at q: (n, m) [rad | m]."""
    chain = moving_chain(space)
    turning = np.flatnonzero(chain.revolute)
    out = np.empty((3, q.shape[1]))
    for start in range(0, q.shape[1], BLOCK):
        values = q[list(space.moving), start : start + BLOCK]
        if space.gears is not None:
            values = moving_gears(space) @ values
        if np.any(chain.offsets):
            values += chain.offsets[:, None]
        cosines, sines = cos_sin_of_halves(0.5 * values[turning])
        for row, entry in zip(out, _origin(chain, values, cosines, sines), strict=True):
            row[start : start + BLOCK] = entry
    return out


def _origin(chain: Chain, values: Array, cosines: Array, sines: Array) -> list[Entry]:
    """The tool's origin at values (n, m), those of the revolute joints as cosines and sines (their number, m)."""
    point: list[Entry] = [float(part) for part in chain.constants[-1, :3, 3]]
    row = len(cosines)
    for i in range(chain.n - 1, -1, -1):
        x, y, z = point
        if chain.revolute[i]:
            row -= 1
            c, s = cosines[row], sines[row]
            point = [turned_back(c, x, s, y), turned(s, x, c, y), z]
        else:
            point = [x, y, plus(values[i], z)]
        point = [_moved(row.tolist(), point) for row in chain.constants[i, :3]]
    return point


def _moved(weights: list[float], point: list[Entry]) -> Entry:
    """An entry of C p for a row (4,) of C and a point p; what is the same for all is summed up first."""
    total: Entry = weights[3]
    for weight, part in sorted(zip(weights, point, strict=False), key=lambda pair: not isinstance(pair[1], float)):
        total = increased(total, weight, part)
    return total


@fact
def moving_chain(space: Space) -> Chain:
    """The chain of the joints that move the tool's origin; the others are part of its constants."""
    middle = 0.5 * (space.low + space.high)
    if space.gears is not None:
        rows, S = moved_rows(space), space.gears.S
        rest = np.delete(np.arange(len(middle)), list(space.moving))
        still = S[:, rest] @ middle[rest]
        chain = with_joints_at(space.chain, {i: float(still[i]) for i in range(space.chain.n) if i not in rows})
        return replace(chain, offsets=chain.offsets + still[rows])
    # A joint that is held has its value; of any other that does not move the origin none matters.
    middle = np.where(space.held, middle, -space.chain.offsets)
    return with_joints_at(space.chain, {i: float(middle[i]) for i in range(space.chain.n) if i not in space.moving})


def moved_rows(space: Space) -> list[int]:
    """The joints of the chain that the moving variables of a space with gears move."""
    assert space.gears is not None
    moved = np.any(space.gears.S[:, list(space.moving)] != 0.0, axis=1) & space.gears.telling
    return [int(i) for i in np.flatnonzero(moved)]


@fact
def moving_gears(space: Space) -> Array:
    """(m, n) how the moving variables of a space with gears move the joints of its moving chain."""
    assert space.gears is not None
    return space.gears.S[np.ix_(moved_rows(space), list(space.moving))]


@fact
def moving_cuts(space: Space) -> HalfSpaces:
    """What the moving variables of a space with gears must satisfy beside their box, so that others exist that do."""
    assert space.gears is not None
    cuts, moving = space.gears.cuts, list(space.moving)
    for i in np.flatnonzero(space.held).tolist():
        if i not in moving:
            cuts = cuts.at(i, float(0.5 * (space.low[i] + space.high[i])))
    whole = cuts.joined(HalfSpaces.box(space.low, space.high)).shadow(moving)
    own = HalfSpaces(whole.G[:, moving], whole.h)
    return own.cutting(space.low[moving], space.high[moving])
