"""How one place can be reached: with which orientations of the tool, and by how many configurations.

Where the tool can be turned about one axis there, the ends of the ranges of its angle are found by bisection between a
grid's angles; of other orientations those of a grid are tried.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from robokin.arrays import Array, Flags
from robokin.brief import Brief
from robokin.errors import InputError
from robokin.inverse.analysis import Task
from robokin.inverse.solve import solve_many
from robokin.jobs.ordered_map import ordered_map
from robokin.kinematics.forward import forward_kinematics
from robokin.spatial import rotation_from_axis_angle, transform
from robokin.workspace.attitudes import ALIKE, TASKS, Attitudes, Group, attitudes, group_of
from robokin.workspace.membership import counted, finitely_many, proven_out, reachable, solution_count
from robokin.workspace.space import Space
from robokin.workspace.trials import at_one_place, reached_beside, reached_by_search, tried_by_forms

TRIED: dict[Group, int] = {"SO(2)": 360, "S2": 1000, "SO(3)": 2000}
"""Orientations at a place that is asked about."""

HALVINGS = 40
"""Times that the end of a range of angles is halved: to rounding."""

BEYOND_END = 1e-2, 1e-4, 1e-6
"""Parts of what is left to the next angle of the grid that are looked at beyond the end of a range."""


@dataclass(frozen=True, eq=False, repr=False)
class WorkspacePlace(Brief):
    """What is known of one place: point (3,) [m], whether it is reachable, the group of the orientations that it
    may have and how many were tried; rotations (k, 3, 3): those of the tool that it can be reached with (of the
    sphere's group only the third column counts; where the group is "finite", one for each solution that differs).
    solutions: the number of configurations, None where there are infinitely many. Of turns about one axis, unless all
    or none can be reached: ranges (k, 2, 3, 3), the first and the last rotation of each range that can, to rounding,
    in the direction of a positive turn about that coordinate axis of the world that is most along it; fraction: the
    part of all that the ranges are, else of those tried. proven: whether a place that is not reachable is proven not to
    be, True where it is. counted: False where the number of configurations, though finite, is not known."""

    point: Array
    reachable: bool
    group: Group
    tried: int
    rotations: Array
    solutions: int | None
    ranges: Array = field(default_factory=lambda: np.zeros((0, 2, 3, 3)))
    fraction: float = float("nan")
    proven: bool = True
    counted: bool = True


def at_point(space: Space, point: ArrayLike, orientations: int | None = None, seed: int = 0) -> WorkspacePlace:
    """Whether point (3,) [m] can be reached, with which of some orientations, and with how many configurations."""
    place = _at_point(space, point, orientations, seed)
    return place if place.reachable else replace(place, proven=bool(proven_out(space, place.point)[0]))


def at_points(space: Space, points: Array, seed: int = 0, cores: int | None = 1) -> Iterator[WorkspacePlace]:
    """`at_point` of points (m, 3) [m], in their order, on so many cores or on a cluster that is lent."""
    return ordered_map(partial(at_point, space, seed=seed), points, cores)


def _at_point(space: Space, point: ArrayLike, orientations: int | None, seed: int) -> WorkspacePlace:
    p = np.asarray(point, dtype=np.float64)
    if p.shape != (3,) or not np.all(np.isfinite(p)):
        raise InputError("a place must be three finite numbers")
    group = group_of(space)
    count = int(solution_count(space, p[None])[0]) if counted(space) else None
    some = bool(reachable(space, p[None])[0])
    count = max(count, 1) if some and count is not None else count
    if group in ("finite", "curve"):
        turned = _turned_ways(space, p) if some else []
        if not some or not space.arm.n:
            count = int(some)
        count = count if group == "finite" or not some else None
        known = counted(space) or not (some and finitely_many(space))
        return WorkspacePlace(p, some, group, 0, _different(turned), count, counted=known)
    if not tried_by_forms(space, TASKS[group]):
        return WorkspacePlace(p, some, group, 0, np.zeros((0, 3, 3)), None if some else 0)
    grid = attitudes(space, group, orientations or TRIED[group], seed)
    flags = at_one_place(space, grid, p) if some else np.zeros(len(grid.rotations), dtype=bool)
    part = float(np.mean(flags))
    place = WorkspacePlace(p, some, group, len(flags), grid.rotations[flags], None if some else 0, fraction=part)
    return _with_ranges(space, grid, flags, place) if group == "SO(2)" and 0.0 < part < 1.0 else place


def _turned_ways(space: Space, p: Array) -> list[Array]:
    """Rotations (3, 3) of the tool that inverse kinematics finds for a place (3,) [m]."""
    if not space.arm.n:
        return [forward_kinematics(space.robot, 0.5 * (space.low + space.high))[:3, :3]]
    arm = space.robot if space.gears is not None else space.arm
    found = solve_many(arm, transform(np.eye(3), p)[None], task="position")[0]
    return [forward_kinematics(arm, s.q)[:3, :3] for s in found.solutions]


def _with_ranges(space: Space, grid: Attitudes, flags: Flags, place: WorkspacePlace) -> WorkspacePlace:
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
