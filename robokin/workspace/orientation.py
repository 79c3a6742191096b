"""How freely the tool can be turned, place by place: three sets and their sizes.

- The reachable set: places with some orientation.
- The lecture's dextrous set: places with more than one. Where the joints can turn the tool on the spot (the group
  is not "finite") that is almost every reachable place: by Sard's theorem the configurations that reach a place form
  a surface of positive dimension, but for places that fill nothing, and the orientation changes along it. Else
  it is where two solutions differ.
- The standard dextrous set: places with every orientation (J. J. Craig, Introduction to Robotics), tried on a grid.

A grid misses orientations between its points, so that its set is too large. How much so is seen from a grid with
an eighth of the points: what the two sets differ by, d, is 63 times what is still missing where that falls with the
square of the number of orientations (turns about one axis), 7 times where it falls with the number (directions)
and 1.8 times where with its root (a wrist's limits that cut off a corner). So 0.27 d is taken off, and as much is
the bound. It is the coarse grid that finds the set's boundary; the fine one proves what is within it and is compared
with the coarse one at places near it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from math import log

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robokin.errors import InputError
from robokin.inverse.analysis import analysis_of
from robokin.inverse.solve import solve_many
from robokin.kinematics.forward import forward_kinematics
from robokin.spatial import transform
from robokin.workspace.attitudes import ALIKE, Attitudes, Group, attitudes, group_of
from robokin.workspace.cells import RISK, Cells, Oracle, answers, cells_of, points_in, poisson_limit
from robokin.workspace.measure import several_measure
from robokin.workspace.membership import finitely_many, reachable, solution_count
from robokin.workspace.parallel import in_order
from robokin.workspace.region import Region, region_of
from robokin.workspace.result import Dexterity, Extent, Measure
from robokin.workspace.space import Space
from robokin.workspace.trials import every, fractions, table, telling_order

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

USUAL = 131072
"""Samples that the numbers below are for: places and orientations both grow with the root of the samples."""

PLACES: dict[Group, int] = {"SO(2)": 16384, "S2": 32768, "SO(3)": 32768}
"""Places looked at with the coarse grid."""

CERTAIN = 0.0018
"""What the test of the inner and outer places may have missed by chance, as a part of the set's size."""

MOST_TESTS = 20000
"""Places of that test at most, where the set is small."""

ORIENTATIONS: dict[Group, int] = {"SO(2)": 360, "S2": 1000, "SO(3)": 2000}
"""Orientations at each place."""

COARSE = 8
"""The map's grid, and the one that finds the boundary, have one orientation in so many."""

MISSING = 0.27
"""Half of the greatest part of the two grids' difference that may still be missing: 0.5 / (8^½ - 1)."""

MAP_CELLS = 800
"""Cells of the map where their side is not given."""

MOST_CELLS = 1_000_000
"""Cells of the map at most: further ones would take hours."""

REDUNDANT = 48
"""An arm with joints to spare is solved for some fifty values of them: for so many times fewer queries."""

DOUBTED = 3000
"""Places between the two grids' sets at which their difference is counted."""


def dexterity(
    space: Space,
    extent: Extent,
    reach: Measure,
    samples: int = USUAL,
    seed: int = 0,
    voxel: float | None = None,
    cores: int | None = None,
) -> Dexterity:
    """How freely the tool of an arm can be turned; reach: the size of its reachable set, voxel: the cells' side [m].

    Raises InputError for a voxel that is larger than the set or makes more than MOST_CELLS cells.
    """
    group = group_of(space) if space.dimension else "finite"
    if group in ("finite", "curve") or space.basis is None:
        several = _few(space, reach, samples, seed, cores) if group == "finite" else _almost_all(reach)
        none = Measure(0.0, 0.0, "too few orientations at every place for all of them", 0)
        return Dexterity(group, 0, 0.0, np.zeros((0, 3)), 0.0, np.zeros(0), False, 0.0, reach, several, none)
    redundant = analysis_of(space.robot, "approach" if group == "S2" else "pose").redundancy > 0
    scale = np.sqrt(samples / USUAL / (REDUNDANT if redundant else 1))
    count = max(int(ORIENTATIONS[group] * scale), 8 * COARSE)
    fine, coarse = attitudes(space, group, count, seed), attitudes(space, group, count // COARSE, seed)
    region = region_of(space, extent)
    low, high, side = _map_cells(region, voxel)
    middle = region.points(0.5 * (low + high))
    fraction = fractions(space, coarse, middle, cores)
    there = fraction > 0.0
    held = float(np.sum(region.sizes(low, high)[there]))
    mean = min(float(region.sizes(low, high) @ fraction) / reach.value, 1.0) if reach.value else 0.0
    all_of_them = _every_measure(
        space, region, (fine, coarse), middle[there], fraction[there], held, (scale, seed, cores)
    )
    return Dexterity(
        group,
        count,
        fine.spacing,
        middle[there],
        side,
        fraction[there],
        region.radial,
        mean,
        reach,
        _almost_all(reach),
        all_of_them,
        len(coarse.rotations),
    )


def _few(space: Space, reach: Measure, samples: int, seed: int, cores: int | None) -> Measure:
    """The size of the lecture's set where a place leaves finitely many orientations."""
    if not space.robot.revolute.any():
        return Measure(0.0, 0.0, "sliding joints alone never turn the tool", 0)
    if finitely_many(space) and len(space.moving) == space.robot.n:
        return several_measure(space, samples, seed, cores)
    # Joints to spare that cannot turn the tool on the spot: what may be is all that is known.
    half = 0.5 * (reach.value + reach.error)
    return Measure(half, half, "unknown: between nothing and the reachable set", 0, exact=False)


def _almost_all(reach: Measure) -> Measure:
    method = "the reachable set: at almost every place of it the tool can be turned on the spot"
    return Measure(reach.value, reach.error, method, reach.evaluations, reach.exact)


def _map_cells(region: Region, voxel: float | None) -> tuple[Array, Array, float]:
    """Corners (c, d) of the map's cells in a region, and their side [m]."""
    sides = region.high - region.low
    d = len(sides)
    side = float(np.prod(sides) / MAP_CELLS) ** (1.0 / d) if voxel is None else voxel
    if not 0.0 < side <= float(np.max(sides)):
        raise InputError(f"found a voxel of {side:g} m, expected one between 0 and {np.max(sides):.3g} m")
    shape = np.ceil(sides / side)
    if float(np.prod(shape)) > MOST_CELLS:
        least = float(np.prod(sides) / MOST_CELLS) ** (1.0 / d)
        raise InputError(
            f"a voxel of {side:g} m makes {np.prod(shape):.3g} cells, expected one of {least:.2g} m or more"
        )
    index = np.stack(np.meshgrid(*(np.arange(k) for k in shape), indexing="ij"), axis=-1).reshape(-1, d)
    low = region.low + index * side
    return low, np.minimum(low + side, region.high), side


def _every_measure(
    space: Space,
    region: Region,
    grids: tuple[Attitudes, Attitudes],
    points: Array,
    fraction: Array,
    held: float,
    plan: tuple[float, int, int | None],
) -> Measure:
    """The size of the set with every orientation; points, fraction: the map of cells with some and held their size
    altogether, plan: scale, seed, cores."""
    scale, seed, cores = plan
    fine, coarse = grids
    # The map's places that are nearest to having all say which orientations fail first.
    near = np.argsort(-fraction, kind="stable")[np.sum(fraction == 1.0) // 2 :][:100]
    blocks = [points[part] for part in np.array_split(near, 16) if len(part)]
    oracles = []
    for grid in (fine, coarse):
        flags = [np.zeros((0, len(grid.rotations)), dtype=bool)]
        flags += in_order(partial(table, space, grid), blocks, cores)
        oracles.append(partial(every, space, grid, telling_order(np.concatenate(flags), seed)))
    all_fine, all_coarse = oracles
    budget = max(int(PLACES[fine.group] * scale), 256)
    whole = float(np.sum(region.sizes(region.low[None], region.high[None])))
    guess = max(float(np.mean(fraction == 1.0)) if len(fraction) else 0.0, 0.02) * held
    # With more samples this part of the bound shrinks faster than the others, of which it is the greatest.
    more = max(scale, scale**1.5)
    tests = int(min(-log(RISK) * whole / (CERTAIN / more * guess), MOST_TESTS * more))
    measure, cells = cells_of(all_coarse, region, budget, seed, cores, all_fine, tests)
    open_, beyond, doubt = _grid_difference(cells, all_fine, all_coarse, int(DOUBTED * scale), (seed, cores))
    most = max(measure.value - open_, 0.0)
    least = max(most - 2.0 * MISSING * (open_ + beyond), 0.0)
    exact = analysis_of(space.robot, fine.task).redundancy == 0
    return Measure(
        0.5 * (most + least),
        0.5 * (most - least) + measure.error + (1.0 + MISSING) * doubt,
        f"every one of {len(fine.rotations)} orientations, " + measure.method,
        measure.evaluations,
        exact,
    )


def _grid_difference(
    cells: Cells, fine: Oracle, coarse: Oracle, count: int, plan: tuple[int, int | None]
) -> tuple[float, float, float]:
    """How much larger the coarse grid's set is than the fine one's, in unsettled cells and in settled ones, where
    that is corrected already, and the bound of the former's error; plan: seed, cores."""
    seed, cores = plan
    region, open_ = cells.region, ~cells.settled
    beyond = max(-cells.missed, 0.0)
    if not open_.any():
        return 0.0, beyond, 0.0
    low, high = cells.low[open_], cells.high[open_]
    # Cells that are next to nothing need no more places than leave a doubt of a few tenths of what is CERTAIN.
    size = float(np.sum(region.sizes(low, high)))
    held = float(region.sizes(cells.low, cells.high) @ cells.fraction)
    count = max(min(count, int(40.0 * size / (CERTAIN * max(held, size * 1e-3)))), 100)
    u, _ = points_in(region, low, high, count, np.random.default_rng((seed, 0xD1FF)))
    by_coarse, by_fine = (answers(oracle, region, cores, u) for oracle in (coarse, fine))
    more, less = int(np.sum(by_coarse & ~by_fine)), int(np.sum(by_fine & ~by_coarse))
    part = size / count
    doubt = poisson_limit(more + less, RISK) - (more + less)
    return max((more - less) * part, 0.0), beyond, doubt * part


@dataclass(frozen=True, eq=False)
class Place:
    """What is known of one place: point (3,) [m], whether it is reachable, the group of the orientations that it
    may have and how many were tried; rotations (k, 3, 3): those of the tool that it can be reached with (of the
    sphere's group only the third column counts; where the group is "finite", one for each solution that differs).
    solutions: the number of configurations, None where there are infinitely many."""

    point: Array
    reachable: bool
    group: Group
    tried: int
    rotations: Array
    solutions: int | None


def at_point(space: Space, point: ArrayLike, orientations: int | None = None, seed: int = 0) -> Place:
    """Whether point (3,) [m] can be reached, with which of some orientations, and with how many configurations."""
    p = np.asarray(point, dtype=np.float64)
    if p.shape != (3,) or not np.all(np.isfinite(p)):
        raise InputError("a place must be three finite numbers")
    group = group_of(space) if space.dimension else "finite"
    count = int(solution_count(space, p[None])[0]) if len(space.moving) == space.dimension else None
    some = count > 0 if count is not None else bool(reachable(space, p[None])[0])
    if group in ("finite", "curve"):
        found = solve_many(space.robot, transform(np.eye(3), p)[None], task="position")[0] if some else None
        turned = [forward_kinematics(space.robot, s.q)[:3, :3] for s in found.solutions] if found else []
        return Place(p, some, group, 0, _different(turned), count if group == "finite" or not some else None)
    grid = attitudes(space, group, orientations or ORIENTATIONS[group], seed)
    flags = table(space, grid, p[None])[0] if some else np.zeros(len(grid.rotations), dtype=bool)
    return Place(p, some, group, len(flags), grid.rotations[flags], None if some else 0)


def _different(rotations: list[Array]) -> Array:
    """(k, 3, 3) those that differ from all before them."""
    kept: list[Array] = []
    for R in rotations:
        if all(np.linalg.norm(R - other) > ALIKE for other in kept):
            kept.append(R)
    return np.array(kept).reshape(-1, 3, 3)
