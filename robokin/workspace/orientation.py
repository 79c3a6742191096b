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

from dataclasses import replace
from functools import partial
from math import log

import numpy as np

from robokin.arrays import Array
from robokin.errors import InputError
from robokin.inverse.analysis import Task, analysis_of
from robokin.jobs.ordered_map import ordered_map
from robokin.jobs.stages import stage
from robokin.model import CoupledRobot
from robokin.workspace.attitudes import TASKS, Attitudes, Group, attitudes, group_of
from robokin.workspace.critical import Every, worst_beyond
from robokin.workspace.measure import several_measure
from robokin.workspace.membership import finitely_many
from robokin.workspace.place import at_point
from robokin.workspace.pose_descent import searched
from robokin.workspace.region import Region, region_of
from robokin.workspace.size_cells import RISK, checked, split_cells
from robokin.workspace.sizes import Extent, Measure
from robokin.workspace.space import Space
from robokin.workspace.trials import fractions, table, telling_order, tried_by_forms
from robokin.workspace.workspace_result import Dexterity

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

SEARCHED = 192
"""One that has no closed form either is searched for each orientation, which takes as long as some two hundred."""

FEWER = (
    "every orientation is searched for, as this arm has a joint to spare and no closed form: with as many samples "
    "fewer orientations and places are tried than of other arms, and the bounds are wider"
)
"""What is to be known of the sizes of such arms' sets."""


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

    Raises InputError for a voxel that is larger than the set or makes more than MOST_CELLS cells, and where joints
    follow others or hang on each other with joints to spare, and the tool can be turned on the spot.
    """
    expect_turnable(space)
    if not space.dimension:
        return _of_a_point(space, reach, samples, seed)
    group = group_of(space)
    if group in ("finite", "curve") or space.basis is None:
        several = _few(space, reach, samples, seed, cores) if group == "finite" else _almost_all(reach)
        none = Measure(0.0, 0.0, "too few orientations at every place for all of them", 0)
        return Dexterity(group, 0, 0.0, np.zeros((0, 3)), 0.0, np.zeros(0), False, 0.0, reach, several, none)
    scale = np.sqrt(samples / USUAL / (_cost(space, TASKS[group]) if group in TASKS else 1))
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


def notes_of_turns(space: Space, found: Dexterity | None) -> list[str]:
    """What is to be known of how freely an arm's tool can be turned."""
    if found is None or not found.orientations or found.every.exact:
        return []
    return [SPARE, FEWER] if searched(space, "approach" if found.group == "S2" else "pose") else [SPARE]


def expect_turnable(space: Space) -> None:
    """Raise InputError for a robot whose orientations could only be searched for: no size of theirs would be sound."""
    group, robot = group_of(space), space.robot
    if not isinstance(robot, CoupledRobot):
        return
    known = tried_by_forms(space, TASKS[group]) if group in TASKS else robot.drive.invertible
    if not known:
        raise InputError(
            f"dextrous: {robot.coupled}: with which orientations a place is reached could only be searched for, "
            "expected an arm without joints that follow others or to spare"
        )


def _cost(space: Space, task: Task) -> int:
    """How long it takes to find out about one orientation, against an arm with a closed form and no joint to spare."""
    if searched(space, task):
        return SEARCHED
    return REDUNDANT if analysis_of(space.arm, task).redundancy else 1


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
    if space.gears is None and finitely_many(space) and len(space.moving) == space.arm.n:
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
        flags += ordered_map(partial(table, space, grid), blocks, cores)
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
