"""Where several branches of configurations meet: each is sought, followed to the pose, and measured.

Statement. Given reduced constraints g(x) = 0 that do not vanish all about x = 0, of a kernel of two dimensions or more,
find the branches of their zeros that pass through 0, and the dimension of each.

1. *Sought* on a sphere as large as can be solved, and *followed* to the pose, as smaller spheres have zeros near by
   (`zeros`). Where there are several branches they are sought again from other directions, until nothing is added.
2. *Measured* at a point of each: there the constraints vanish all about in as many dimensions (`measured`).
3. Points of one branch are put *together*: curves that leave the pose in one direction and its opposite, surfaces with
   one tangent plane at the pose, which is theirs all about it, and cones, whose planes turn from point to point.

Where nothing is found, nothing leads away from the pose. What this rests on is the number of directions: on a
circle (two dimensions) none is left out, on spheres a thin branch may be. The rest are calculations at points, no
proofs.

Sources: C. W. Wampler, J. D. Hauenstein, A. J. Sommese, "Mechanism mobility and a local dimension test", Mech. Mach.
Theory 46(9), 2011 (the local dimension at a point); A. Müller, "Local kinematic analysis
of closed-loop linkages", J. Mech. Robotics 8(4), 2016 (several smooth motions and cusps through one pose).
"""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations, pairwise
from typing import NamedTuple

import numpy as np

from robokin.arrays import Array
from robokin.mobility.measured import DOUBLE, Branch, loose_kernel, measured
from robokin.mobility.reduced import Reduced
from robokin.mobility.repeated import repeated
from robokin.mobility.zeros import (
    DIFFERENT,
    FOLLOWED,
    NARROWEST,
    WIDEST,
    apart,
    followed,
    sought,
    spread,
    zeros_on_sphere,
)

SAME = 0.1
"""Directions, or planes of directions, that differ by less at the least sphere are of one branch."""

ALONG = np.array([0.5, 1.1, 2.0])
"""How far along a surface [rad] its plane is looked at again, as a cone may hardly turn for a part of the way."""

ONCE = 1e-4
"""Points of multiple curves [rad | size] that are measured not farther apart are one."""

MEASURED = 8
"""Points of each kind that are measured where the branch is multiple, which takes long; else half of those followed."""


SEVERAL = 3
"""Branches from which on others may have been missed, of a kernel of more dimensions than a circle's."""

IDLE, TURNS = 2, 12
"""Turns that add nothing before the search ends, and turns at most."""

CURVED = 0.1
"""Part of the points of a dimension that are not even from which on the others are not either: of a cone that is narrow
in one direction most hardly turn."""

NARROWER = (0.7, 0.5)
"""Parts of the sphere on which is sought again where zeros were lost on the way to the pose: of a double branch that
may be for its rounding alone."""

UNMEASURED = (
    "configurations seem to lead away from this pose along which constraints vanish too often for their dimension "
    "to be measured"
)
"""Why there may be more than the branches that are known."""


class Measured(NamedTuple):
    """A point of a branch: a basis (k, dimension) of the branch's directions where it is nearest to the pose, and
    whether these are the same all about there, as of a curve or a smooth surface, and not those of a cone."""

    branch: Branch
    plane: Array
    even: bool

    @property
    def multiple(self) -> bool:
        """Whether the constraints vanish more than once along the branch."""
        return self.branch.kernel > self.branch.dimension


def branches_of(reduced: Reduced, reached: Array) -> tuple[list[Branch], str | None]:
    """The branches through the pose, the greatest first, and why there is more than is known (undecided), or None.

    reached: (N,) how far the regular equations could be solved in some directions. No branch: nothing leads away.
    """
    radius = float(min(np.median(reached[reached > 0.0]), WIDEST)) if np.any(reached > 0.0) else 0.0
    if radius < 8.0 * NARROWEST:
        return [], "the loops cannot be closed again far enough from this pose"
    found: list[Measured] = []
    decided, lost = _sought_for(reduced, radius, 0, found)
    idle, turn = 0, 1
    while decided and idle < IDLE and turn < TURNS:
        several = reduced.k > 2 and len(_merged(reduced, found)) >= SEVERAL
        if not several and not (lost and turn <= len(NARROWER)):
            break
        before, part = len(found), 1.0 if several else NARROWER[turn - 1]
        decided, lost = _sought_for(reduced, part * radius, turn, found)
        idle, turn = (idle + 1 if len(found) == before else 0), turn + 1
    return _merged(reduced, found), None if decided else UNMEASURED


def _sought_for(reduced: Reduced, radius: float, turn: int, found: list[Measured]) -> tuple[bool, bool]:
    """Add points of branches to those that were found, each with a basis of its directions at the pose; whether the
    dimensions at all that lead to the pose could be told, and whether any elsewhere were lost on the way to it. After
    the first turn only of branches that are not known."""
    x, y = sought(reduced, radius, turn, [point.plane for point in found])
    through = followed(reduced, x, y, radius) if len(x) else None
    if through is None:
        return True, len(x) > 0
    sphere = x
    missed: list[int] = []
    wide, q, x, y = through
    for alike in _to_measure(reduced, wide, q):
        for count, i in enumerate(alike):
            if count >= MEASURED and any(point.multiple for point in found):
                break  # multiple branches take long
            if _known(x[i], [point.plane for point in found if point.multiple]):
                continue
            if turn and _on(x[i], found):
                continue
            branch = measured(reduced, q[i], 0.25 * radius)
            if branch is None:
                missed.append(i)
            else:
                found.append(_point(reduced, branch, x[i], y[i]))
    lost = len(sphere) > len(x) and not all(_on(each, found) for each in sphere)
    return not _missing(reduced, found, missed, q, x, y, 0.25 * radius), lost


def _on(x: Array, found: list[Measured]) -> bool:
    """Whether the direction of a point x (k,) is one of those of branches that were found."""
    d = x / np.linalg.norm(x)
    return any(np.linalg.norm(d - point.plane @ (point.plane.T @ d)) <= SAME for point in found)


def _missing(
    reduced: Reduced, found: list[Measured], missed: list[int], q: Array, x: Array, y: Array, radius: float
) -> bool:
    """Whether some points whose dimension could not be told are of no branch that was measured; those of branches where
    the constraints vanish many times over are told now, and added to what was found."""
    tried = 0
    for i in missed:
        # A point where branches meet cannot be measured; it is of those that were measured beside it.
        if _on(x[i], found):
            continue
        tried += 1
        values = Reduced(reduced.chart, q[i]).values
        branch = repeated(reduced.chart, q[i], loose_kernel(reduced, values), radius) if tried <= MEASURED else None
        if branch is None:
            return True
        found.append(_point(reduced, branch, x[i], y[i]))
    return False


def _known(x: Array, planes: list[Array]) -> bool:
    """Whether a point x (k,) is in the surface of two points that were measured: bases (k, dimension) of planes."""
    d = x / np.linalg.norm(x)
    near = [plane for plane in planes if plane.shape[1] > 1 and np.linalg.norm(d - plane @ (plane.T @ d)) < 0.5 * SAME]
    return any(np.linalg.norm(a @ a.T - b @ b.T, 2) < SAME for a, b in combinations(near, 2))


def isolation(reduced: Reduced, reached: Array) -> int | None:
    """The order of the constraints where a pose of a kernel of several dimensions is isolated: of how they grow in the
    direction in which they grow least. None where rounding hides it, or it is no whole number."""
    radius = float(min(np.median(reached[reached > 0.0]), WIDEST))
    around = spread(reduced.k)
    best, least = around, np.inf
    sizes: list[float] = []
    while radius > NARROWEST and len(sizes) < 6:
        d = best
        for width in (0.0, 0.3, 0.1, 0.03, 0.01, 0.003, 0.001):
            tried = d if width == 0.0 else d + width * around
            tried = tried / np.linalg.norm(tried, axis=1)[:, None]
            found = reduced.at(radius * tried)
            size = np.linalg.norm(found.g, axis=1)
            if width == 0.0 or np.min(size) < least:
                least = float(np.min(size))
                d = tried[int(np.argmin(size))][None]
        if not np.isfinite(least) or least < 1e3 * float(reduced.tolerance(radius)):
            break
        sizes.append(least)
        best, radius = d, 0.5 * radius
    orders = [float(np.log2(a / b)) for a, b in pairwise(sizes)][-2:]
    # One alone may be that of a direction in which they grow more slowly elsewhere.
    if len(orders) < 2 or round(orders[0]) != round(orders[1]) or abs(orders[1] - round(orders[1])) > 0.2:
        return None
    return max(2, round(orders[1]))


def _to_measure(reduced: Reduced, x: Array, q: Array) -> list[list[int]]:
    """Numbers of points to measure: of each size of the kernel, some that are far apart."""
    values = np.linalg.svd(reduced.chart.both(q)[1], compute_uv=False) / reduced.greatest
    below = np.max(np.where(values > DOUBLE, 0.0, values), axis=1)
    # Of a simple branch whose constraints are small, and of a multiple one, singular values are of different sizes.
    kinds = np.sum(values > DOUBLE, axis=1) + 0.01 * np.floor(0.5 * np.log10(np.maximum(below, 1e-18)))
    chosen = []
    for kind in np.unique(kinds):
        (own,) = np.nonzero(kinds == kind)
        picked = apart(x[own], DIFFERENT * float(np.linalg.norm(x[0])), FOLLOWED // 2)
        chosen.append([int(i) for i in own[picked]])
    return chosen


def _merged(reduced: Reduced, found: list[Measured]) -> list[Branch]:
    """Points of one branch together: one of each branch, the greatest dimension first."""
    merged: list[Branch] = []
    kinds = {(point.branch.dimension, point.branch.kernel) for point in found}
    for dimension, kernel in sorted(kinds, key=lambda kind: (-kind[0], kind[1])):
        alike = [point for point in found if (point.branch.dimension, point.branch.kernel) == (dimension, kernel)]
        bent = [point for point in alike if not point.even]
        if len(bent) > CURVED * len(alike):
            groups = _bent(alike)
        else:
            groups = _groups([point for point in alike if point.even], SAME) + _bent(bent)
        for members in groups:
            # A curve leaves the pose both ways: two half branches are one, four that touch are two.
            # A multiple zero that is not sharp may have been found twice.
            places = np.array([point.branch.q for point in members])
            once = ONCE if kernel > dimension else 0.0
            halves = len(apart(places, once, len(members))) if dimension == 1 else 1
            merged += [replace(p.branch, start=reduced.V0 @ p.plane) for p in members[: (halves + 1) // 2]]
    return merged


def _bent(alike: list[Measured]) -> list[list[Measured]]:
    """Points of surfaces that are not even, or multiple, by surface."""
    groups = _groups(alike, SAME)
    if len(groups) < 2:
        return groups
    # On a cone the planes turn from point to point, so there are about as many as points, or as they are told.
    scattered = len(groups) >= max(4, len(alike) // 3) or len(_groups(alike, 0.3 * SAME)) > len(groups)
    return groups[:1] if scattered else groups


def _groups(found: list[Measured], same: float) -> list[list[Measured]]:
    """Points whose planes are the same."""
    groups: list[list[Measured]] = []
    for point in found:
        for group in groups:
            if _differ(point.plane, group[0].plane) < same:
                group.append(point)
                break
        else:
            groups.append([point])
    return groups


def _differ(one: Array, other: Array) -> float:
    """The sine of the greatest angle between two planes, bases (k, d) of which are given."""
    return float(np.linalg.norm(one @ one.T - other @ other.T, 2))


def _point(reduced: Reduced, branch: Branch, x: Array, y: Array) -> Measured:
    """A branch that was measured, as it is at the pose, near which it has the point x (k,), y (r,)."""
    plane = _plane(reduced, branch, x, y)
    even = branch.dimension == 1 or (branch.kernel == branch.dimension and _even(reduced, branch, plane, x, y))
    return Measured(branch, plane, even)


def _even(reduced: Reduced, branch: Branch, plane: Array, x: Array, y: Array) -> bool:
    """Whether a surface has the same plane (k, d) beside its point x (k,), y (r,), all round it."""
    radius = float(np.linalg.norm(x))
    d = x / radius
    ways = np.linalg.svd(plane - np.outer(d, d @ plane), full_matrices=False)[0][:, : branch.dimension - 1].T
    turns = np.concatenate([ALONG, -ALONG])[:, None, None]
    ahead = radius * (np.cos(turns) * d + np.sin(turns) * ways).reshape(-1, reduced.k)
    begin = np.tile(y, (len(ahead), 1))
    there, y_, size = zeros_on_sphere(reduced, ahead, begin, radius, np.zeros(len(ahead), dtype=bool), 20)
    if np.max(size) > 10.0 * float(reduced.tolerance(radius)):
        return False
    return all(_differ(_plane(reduced, branch, a, b), plane) < SAME for a, b in zip(there, y_, strict=True))


def _plane(reduced: Reduced, branch: Branch, x: Array, y: Array) -> Array:
    """An orthonormal basis (k, dimension) of the directions of a branch nearest to the pose, at x (k,), y (r,)."""
    if branch.dimension == 1:
        return np.asarray(x[:, None] / np.linalg.norm(x))
    _, values, Vt = np.linalg.svd(reduced.equations(x[None], y[None])[2][0])
    values = np.concatenate([values, np.zeros(reduced.k - len(values))])
    rank = reduced.k - branch.dimension
    if rank and values[rank - 1] > 1e3 * values[rank]:
        return np.asarray(Vt[rank:].T)
    return np.asarray(np.linalg.qr(reduced.V0.T @ branch.tangent)[0])  # a multiple branch has no such directions there
