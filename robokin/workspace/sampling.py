"""Joint values that fill a robot's joint box, and where they put the tool's origin.

The origin alone is followed, from the tool to the base: p ← C J(q) p. A turn about z costs six operations on a
column of numbers, a twist by a right angle none; that is a quarter of what the whole frame costs.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from weakref import WeakKeyDictionary

import numpy as np

from robokin.arrays import Array
from robokin.errors import InputError
from robokin.jobs.ordered_map import in_order
from robokin.jobs.sequences import RANDOM_BLOCK, Kind, grid_sides, unit_points
from robokin.kernel.chain import Chain
from robokin.kernel.columns import cos_sin_of_halves
from robokin.spatial import exact, rotation_transform, translation_transform
from robokin.workspace.space import Space

Entry = Array | float

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
    return in_order(partial(_sample, space, kind, seed, samples, every), tasks, cores)


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
            point = [_mixed(((1.0, c, x), (-1.0, s, y))), _mixed(((1.0, s, x), (1.0, c, y))), z]
        else:
            point = [x, y, values[i] + z]
        C = chain.constants[i]
        point = [
            _mixed(((float(C[k, 0]), 1.0, point[0]), (float(C[k, 1]), 1.0, point[1]), (float(C[k, 2]), 1.0, point[2])),
                   float(C[k, 3]))
            for k in range(3)
        ]  # fmt: skip
    return point


def _mixed(terms: tuple[tuple[float, Entry, Entry], ...], constant: float = 0.0) -> Entry:
    """The sum of number · entry · entry, sparing what factors of 0 and ±1 spare; arrays passed in stay as they are."""
    total: Entry | None = None
    for number, a, b in terms:
        if isinstance(a, float) and isinstance(b, float):
            constant += number * a * b
            continue
        if isinstance(a, float):
            number, a = number * a, b
        elif isinstance(b, float):
            number *= b
        else:
            a = a * b
        if number == 0.0:
            continue
        if total is None:
            total = a if number == 1.0 else number * a
        elif number == 1.0:
            total = total + a
        elif number == -1.0:
            total = total - a
        else:
            total = total + number * a
    if total is None:
        return constant
    return total + constant if constant else total


_chains: WeakKeyDictionary[Space, Chain] = WeakKeyDictionary()


def moving_chain(space: Space) -> Chain:
    """The chain of the joints that move the tool's origin; the others are part of its constants. Kept."""
    chain = _chains.get(space)
    if chain is None:
        constants = [space.chain.constants[0]]
        for i, C in enumerate(space.chain.constants[1:]):
            if i in space.moving:
                constants.append(C)
            else:
                # A joint that is held has its value; of any other that does not move the origin none matters.
                middle = 0.5 * (space.low[i] + space.high[i]) + space.chain.offsets[i]
                z = [0.0, 0.0, 1.0]
                turns = space.chain.revolute[i]
                at = rotation_transform(z, middle) if turns else translation_transform(middle * np.array(z))
                constants[-1] = exact(constants[-1] @ (at if space.held[i] else np.eye(4)) @ C)
        kept = list(space.moving)
        chain = _chains[space] = Chain(np.stack(constants), space.chain.revolute[kept], space.chain.offsets[kept])
    return chain
