"""How freely the tool can be turned, place by place: three sets and their sizes.

- The reachable set: places with some orientation.
- The lecture's dextrous set: places with more than one. Where the joints can turn the tool on the spot (the group
  is not "finite") that is almost every reachable place: by Sard's theorem the configurations that reach a place form
  a surface of positive dimension, but for places that fill nothing, and the orientation changes along it. Else
  it is where two solutions differ.
- The standard dextrous set: places with every orientation (J. J. Craig, Introduction to Robotics), tried on a grid.

A grid misses orientations between its points, so that those which fail first are sought next to the boundary
(critical.py): first about the grid's own that fail, then again where the set ends now. How fast what they take off
the set shrinks tells what a third search would. Another, finer grid
proves what is within the boundary, and what it alone takes off is counted as a doubt of the same size.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import partial
from math import log

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robokin.errors import InputError
from robokin.inverse.analysis import Task, analysis_of
from robokin.inverse.solve import solve_many
from robokin.kinematics.forward import forward_kinematics
from robokin.spatial import rotation_from_axis_angle, transform
from robokin.workspace.attitudes import ALIKE, Attitudes, Group, attitudes, group_of
from robokin.workspace.cells import RISK, checked, split_cells
from robokin.workspace.critical import Every, worst_beyond
from robokin.workspace.measure import several_measure
from robokin.workspace.membership import finitely_many, proven_out, reachable, solution_count
from robokin.workspace.parallel import in_order
from robokin.workspace.region import Region, region_of
from robokin.workspace.result import Dexterity, Extent, Measure
from robokin.workspace.space import Space
from robokin.workspace.stages import stage
from robokin.workspace.trials import at_one_place, fractions, reached_beside, reached_by_search, table, telling_order

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

USUAL = 131072
"""Samples that the numbers below are for: places and orientations both grow with the root of the samples."""

PLACES = {1: 1024, 2: 5000, 3: 8000}
"""Places looked at for the boundary, by the coordinates of a region."""

WORST = {1: 64, 2: 400, 3: 1500}
"""Of them places at most where the orientations that fail first are sought, by the same coordinates."""

CERTAIN = 0.0018
"""What the test of the inner and outer places may have missed by chance, as a part of the set's size."""

MOST_TESTS = 20000
"""Places of that test at most, where the set is small."""

ORIENTATIONS: dict[Group, int] = {"SO(2)": 180, "S2": 300, "SO(3)": 600}
"""Orientations at each place."""

TRIED: dict[Group, int] = {"SO(2)": 360, "S2": 1000, "SO(3)": 2000}
"""Orientations at a place that is asked about."""

HALVINGS = 40
"""Times that the end of a range of angles is halved: to rounding."""

BEYOND_END = 1e-2, 1e-4, 1e-6
"""Parts of what is left to the next angle of the grid that are looked at beyond the end of a range."""

COARSE = 2
"""The map's grid, and the one that finds the boundary, have one orientation in so many."""

ABOUT = (1.3, 0.4)
"""How far about an orientation that fails the worst is sought, in the grid's spacing: at first and once more."""

SHRINKING = 0.5
"""What further searches may take off is so large a part of what the last did, or as much of it as that was of the one
before."""

MAP_CELLS = 800
"""Cells of the map where their side is not given."""

MOST_CELLS = 1_000_000
"""Cells of the map at most: further ones would take hours."""

SPARE = "orientations of an arm with joints to spare that are called impossible were not found by search (not proven)"
"""What is to be known of maps and sets of orientations that more joints reach than are needed."""

REDUNDANT = 48
"""An arm with joints to spare is solved for some fifty values of them: for so many times fewer queries."""


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
    if not space.dimension:
        return _of_a_point(space, reach, samples, seed)
    group = group_of(space)
    if group in ("finite", "curve") or space.basis is None:
        several = _few(space, reach, samples, seed, cores) if group == "finite" else _almost_all(reach)
        none = Measure(0.0, 0.0, "too few orientations at every place for all of them", 0)
        return Dexterity(group, 0, 0.0, np.zeros((0, 3)), 0.0, np.zeros(0), False, 0.0, reach, several, none)
    redundant = analysis_of(space.arm, "approach" if group == "S2" else "pose").redundancy > 0
    scale = np.sqrt(samples / USUAL / (REDUNDANT if redundant else 1))
    # More places tell the set's size better; more orientations only that none between them was overlooked.
    count = max(int(ORIENTATIONS[group] * min(scale, np.sqrt(scale))), 16 * COARSE)
    fine, coarse = attitudes(space, group, count, seed), attitudes(space, group, count // COARSE, seed)
    region = region_of(space, extent)
    low, high, side = _map_cells(region, voxel)
    stage("map of the orientations")
    middle = region.points(0.5 * (low + high))
    fraction = fractions(space, coarse, middle, cores)
    there = fraction > 0.0
    held = float(np.sum(region.sizes(low, high)[there]))
    mean = min(float(region.sizes(low, high) @ fraction) / reach.value, 1.0) if reach.value else 0.0
    all_of_them = _every_measure(
        space, region, (fine, coarse), middle[there], fraction[there], held, (scale, seed, cores)
    )
    # It is a part of what can be reached, whose size is often known better.
    all_of_them = replace(all_of_them, value=min(all_of_them.value, reach.value))
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


def _of_a_point(space: Space, reach: Measure, samples: int, seed: int) -> Dexterity:
    """The orientations at the only place that the tool's origin comes to."""
    group = group_of(space)
    count = max(int(ORIENTATIONS.get(group, 0) * np.sqrt(samples / USUAL)), 16 * COARSE)
    place = at_point(space, space.centre, count, seed)
    part = place.fraction if place.tried else 0.0
    tried = attitudes(space, group, count, seed).spacing if place.tried else 0.0
    points, fraction = space.centre[None], np.array([part])
    return Dexterity(group, place.tried, tried, points, 0.0, fraction, False, part, reach, reach, reach, place.tried)


def _few(space: Space, reach: Measure, samples: int, seed: int, cores: int | None) -> Measure:
    """The size of the lecture's set where a place leaves finitely many orientations."""
    if not space.arm.revolute.any():
        return Measure(0.0, 0.0, "sliding joints alone never turn the tool", 0)
    if finitely_many(space) and len(space.moving) == space.arm.n:
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
    stage("orientations that fail first")
    # The map's places that are nearest to having all say which orientations fail first.
    near = np.argsort(-fraction, kind="stable")[np.sum(fraction == 1.0) // 2 :][:100]
    blocks = [points[part] for part in np.array_split(near, 16) if len(part)]
    oracles = []
    for grid in (fine, coarse):
        flags = [np.zeros((0, len(grid.rotations)), dtype=bool)]
        flags += in_order(partial(table, space, grid), blocks, cores)
        oracles.append(Every(space, grid, telling_order(np.concatenate(flags), seed)))
    proof, oracle = oracles
    d = len(region.low)
    budget = max(int(PLACES[d] * scale), 256)
    stage("set with every orientation, search 1 of 3")
    cells = split_cells(oracle, region, budget, budget, seed, cores)
    change, spent = [], 0
    for search, radius in enumerate(ABOUT, start=2):
        stage(f"set with every orientation, search {search} of {1 + len(ABOUT)}")
        beyond = region.points(cells.beyond)
        most = max(int(WORST[d] * min(scale**2, 1.0)), 16)
        worst = worst_beyond(oracle, beyond, radius * coarse.spacing, most, cores)
        oracle, proof, before = replace(oracle, worst=worst), replace(proof, worst=worst), cells
        cells, spent = split_cells(oracle, region, budget, budget, seed, cores), spent + cells.spent
        change.append(abs(cells.size - before.size))
    whole = float(np.sum(region.sizes(region.low[None], region.high[None])))
    guess = max(cells.size, 0.02 * held)
    # With more samples this part of the bound shrinks faster than the others, of which it is the greatest.
    more = max(scale, scale**1.5)
    tests = int(min(-log(RISK) * whole / (CERTAIN / more * guess), MOST_TESTS * more))
    stage("its test with a finer grid")
    test = checked(proof, cells, tests, seed, cores)
    measure = test.measure
    # What the finer grid alone takes off is as much as a yet finer one might.
    overlooked = float(np.sum(test.share[oracle(test.refuted)]))
    return Measure(
        measure.value,
        measure.error + change[-1] * min(max(SHRINKING, change[-1] / max(change[0], 1e-300)), 1.0) + overlooked,
        f"every one of {len(fine.rotations)} orientations and of those that fail first, {measure.method}",
        measure.evaluations + spent,
        analysis_of(space.arm, fine.task).redundancy == 0,
    )


@dataclass(frozen=True, eq=False)
class Place:
    """What is known of one place: point (3,) [m], whether it is reachable, the group of the orientations that it
    may have and how many were tried; rotations (k, 3, 3): those of the tool that it can be reached with (of the
    sphere's group only the third column counts; where the group is "finite", one for each solution that differs).
    solutions: the number of configurations, None where there are infinitely many. Of turns about one axis, unless all
    or none can be reached: ranges (k, 2, 3, 3), the first and the last rotation of each range that can, to rounding,
    in the direction of a positive turn about that coordinate axis of the world that is most along it; fraction: the
    part of all that the ranges are, else of those tried. proven: whether a place that is not reachable is proven not to
    be, True where it is."""

    point: Array
    reachable: bool
    group: Group
    tried: int
    rotations: Array
    solutions: int | None
    ranges: Array = field(default_factory=lambda: np.zeros((0, 2, 3, 3)))
    fraction: float = float("nan")
    proven: bool = True


def at_point(space: Space, point: ArrayLike, orientations: int | None = None, seed: int = 0) -> Place:
    """Whether point (3,) [m] can be reached, with which of some orientations, and with how many configurations."""
    place = _at_point(space, point, orientations, seed)
    return place if place.reachable else replace(place, proven=bool(proven_out(space, place.point)[0]))


def _at_point(space: Space, point: ArrayLike, orientations: int | None, seed: int) -> Place:
    p = np.asarray(point, dtype=np.float64)
    if p.shape != (3,) or not np.all(np.isfinite(p)):
        raise InputError("a place must be three finite numbers")
    group = group_of(space)
    count = int(solution_count(space, p[None])[0]) if finitely_many(space) else None
    some = bool(reachable(space, p[None])[0])
    count = max(count, 1) if some and count is not None else count
    if group in ("finite", "curve"):
        turned = _turned_ways(space, p) if some else []
        if not some or not space.arm.n:
            count = int(some)
        return Place(p, some, group, 0, _different(turned), count if group == "finite" or not some else None)
    grid = attitudes(space, group, orientations or TRIED[group], seed)
    flags = at_one_place(space, grid, p) if some else np.zeros(len(grid.rotations), dtype=bool)
    part = float(np.mean(flags))
    place = Place(p, some, group, len(flags), grid.rotations[flags], None if some else 0, fraction=part)
    return _with_ranges(space, grid, flags, place) if group == "SO(2)" and 0.0 < part < 1.0 else place


def _turned_ways(space: Space, p: Array) -> list[Array]:
    """Rotations (3, 3) of the tool that inverse kinematics finds for a place (3,) [m]."""
    if not space.arm.n:
        return [forward_kinematics(space.robot, 0.5 * (space.low + space.high))[:3, :3]]
    found = solve_many(space.arm, transform(np.eye(3), p)[None], task="position")[0]
    return [forward_kinematics(space.arm, s.q)[:3, :3] for s in found.solutions]


def _with_ranges(space: Space, grid: Attitudes, flags: Flags, place: Place) -> Place:
    """The place with the ranges of angles that some of a grid's, `flags` (k,), lie in."""
    assert grid.axis is not None
    axis = grid.axis * np.sign(grid.axis[np.argmax(np.abs(grid.axis))])
    step = grid.spacing * float(axis @ grid.axis)
    # Between an angle that can be reached and the next one that cannot, in either direction.
    last = np.flatnonzero(flags & ~np.roll(flags, -1))
    first = np.flatnonzero(flags & ~np.roll(flags, 1))
    start = grid.rotations[np.concatenate([first, last])]
    toward = np.concatenate([np.full(len(first), -step), np.full(len(last), step)])
    low = _ends(space, grid.task, place.point, start, axis, toward)
    ends = rotation_from_axis_angle(axis, low * toward) @ start
    beyond = low * grid.spacing
    # The range that begins with first[i] ends with the next of last, around the circle.
    after = np.searchsorted(last, first) % len(last)
    count = (last[after] - first) % len(flags)
    spans = count * grid.spacing + beyond[: len(first)] + beyond[len(first) :][after]
    pairs = np.stack([ends[: len(first)], ends[len(first) :][after]], axis=1)
    return replace(place, ranges=pairs if step > 0.0 else pairs[:, ::-1], fraction=float(np.sum(spans)) / (2.0 * np.pi))


def _ends(space: Space, task: Task, point: Array, start: Array, axis: Array, toward: Array) -> Array:
    """(k,) the part of the way `toward` (k,) [rad] about an axis from rotations `start` (k, 3, 3) that can be reached
    at a point (3,) [m]; the whole of it cannot."""
    points = np.tile(point, (len(start), 1))

    def turned(part: Array) -> Array:
        return np.asarray(rotation_from_axis_angle(axis, part * toward) @ start)

    low, (_, q) = np.zeros(len(start)), reached_by_search(space, task, points, start)
    for beyond in BEYOND_END:
        high = np.ones(len(start))
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            there, found = reached_beside(space, task, points, turned(middle), q)
            low, high = np.where(there, middle, low), np.where(there, high, middle)
            q = np.where(there[:, None], found, q)
        # It may go on with a spare joint elsewhere.
        further = low + beyond * (1.0 - low)
        there, found = reached_by_search(space, task, points, turned(further))
        if not there.any():
            break
        low, q = np.where(there, further, low), np.where(there[:, None], found, q)
    return low


def _different(rotations: list[Array]) -> Array:
    """(k, 3, 3) those that differ from all before them."""
    kept: list[Array] = []
    for R in rotations:
        if all(np.linalg.norm(R - other) > ALIKE for other in kept):
            kept.append(R)
    return np.array(kept).reshape(-1, 3, 3)
