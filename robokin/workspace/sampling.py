"""Joint values that fill a robot's joint box, and where they put the tool's origin.

The origin alone is followed, from the tool to the base: p ← C J(q) p. A turn about z costs six operations on a
column of numbers, a twist by a right angle none; that is a quarter of what the whole frame costs.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import numpy as np

from robokin.arrays import Array
from robokin.errors import InputError
from robokin.jobs.ordered_map import ordered_map
from robokin.jobs.sequences import RANDOM_BLOCK, Kind, grid_sides, unit_points
from robokin.kernel.chain import Chain, with_joints_at
from robokin.kernel.columns import cos_sin_of_halves
from robokin.kernel.entries import Entry, increased, plus, turned, turned_back
from robokin.kernel.facts import fact
from robokin.workspace.space import Space

BLOCK = 4096
"""Configurations followed at once: their columns (32 kB each) stay in the second-level cache."""

TASK = RANDOM_BLOCK
"""Configurations of a task for one core: some ten milliseconds of work, and no random number drawn twice."""


@dataclass(frozen=True, eq=False)
class Sample:
    """Configurations start … start + m - 1 of a sequence: q (n, m) [rad | m]; the tool's origin p (3, m) [m]."""

    start: int
    q: Array
    p: Array


def sample_count(space: Space, kind: Kind, samples: int, every: bool = False) -> int:
    """How many configurations a sequence of `samples` has: fewer for a grid, whose sides have whole numbers.

    Raises InputError for less than one.
    """
    if samples < 1:
        raise InputError(f"found {samples} samples, expected at least 1")
    if kind != "grid":
        return samples
    sides = _dimensions(space, every)
    return int(grid_sides(sides, samples) ** sides)


def joint_values(
    space: Space, kind: Kind, seed: int, start: int, count: int, total: int, every: bool = False, scramble: int = 0
) -> Array:
    """Configurations start … start + count - 1 of the `total` of a sequence: (n, count) [rad | m].

    The joints that move the tool's origin have the sequence's first dimensions. The others are left in the middle of
    their range unless `every` asks for all; either way the positions are the same (but for a grid's, which is
    coarser the more dimensions it has). Raises InputError for an unknown kind.
    """
    order = [*space.moving, *(i for i in range(len(space.low)) if i not in space.moving)]
    filled = order[: _dimensions(space, every)]
    u = unit_points(kind, len(filled), seed, start, count, total, scramble)
    q = np.empty((len(space.low), u.shape[1]))
    q[order] = (0.5 * (space.low + space.high))[order, None]
    width = space.high - space.low
    if kind == "grid":
        # Both ends of a whole turn are one place.
        side = grid_sides(len(filled), total)
        width = np.where(space.full, width * (side - 1) / side, width)
    for row, i in zip(u, filled, strict=True):
        np.multiply(row, width[i], out=q[i])
        q[i] += space.low[i]
    return q


def _dimensions(space: Space, every: bool) -> int:
    return len(space.low) if every else len(space.moving)


def sample_blocks(
    space: Space,
    kind: Kind = "sobol",
    seed: int = 0,
    samples: int = 1 << 17,
    cores: int | None = 1,
    every: bool = False,
    start: int = 0,
) -> Iterator[Sample]:
    """Configurations `start` … of a sequence and their positions, in blocks, on several cores but in order.

    A block's ends are multiples of TASK, so that it does not depend on where the sequence was entered. Raises
    InputError for less than one sample and an unknown kind.
    """
    total = sample_count(space, kind, samples, every)
    edges = [start, *range((start // TASK + 1) * TASK, total, TASK), total]
    tasks = ((first, last - first) for first, last in pairwise(edges) if last > first)
    return ordered_map(partial(_sample, space, kind, seed, samples, every), tasks, cores)


def _sample(space: Space, kind: Kind, seed: int, samples: int, every: bool, task: tuple[int, int]) -> Sample:
    q = joint_values(space, kind, seed, *task, samples, every)
    return Sample(task[0], q, positions(space, q))


def positions(space: Space, q: Array) -> Array:
    """Where the tool's origin is: (3, m) [m], at q: (n, m) [rad | m]."""
    chain = moving_chain(space)
    turning = np.flatnonzero(chain.revolute)
    out = np.empty((3, q.shape[1]))
    for start in range(0, q.shape[1], BLOCK):
        values = q[list(space.moving), start : start + BLOCK]
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
    # A joint that is held has its value; of any other that does not move the origin none matters.
    middle = np.where(space.held, 0.5 * (space.low + space.high), -space.chain.offsets)
    return with_joints_at(space.chain, {i: float(middle[i]) for i in range(space.chain.n) if i not in space.moving})
