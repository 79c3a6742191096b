"""Whether a point can be reached, and by how many configurations, within the joint limits."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from robokin.arrays import Array, Flags, Index
from robokin.workspace.descent import REACHED, descent_of
from robokin.workspace.geared_form import geared_form_of, invertible, one_by_one
from robokin.workspace.placing_joints import closed_form_of
from robokin.workspace.sampling import moving_chain, moving_gears
from robokin.workspace.space import Space

BESIDE = 1e-6
"""How far beside a place, in parts of the arm's size, it is asked for again."""


def reachable(space: Space, points: ArrayLike) -> Flags:
    """(m,) whether the tool's origin comes to each of the points (m, 3) [m], with some orientation, within limits.

    A point this side of 1e-7 of the arm's size from the set counts as its own. Where more joints move the origin
    than the set has dimensions a point is sought for from many starts: the answer False is then not proven, unless
    `decided` says so. What the closed forms of the others do not give is sought, too: next to a singular
    configuration they may lose it.
    """
    p, space = np.asarray(points, dtype=np.float64).reshape(-1, 3), one_by_one(space)
    if not space.moving:
        return np.asarray(np.linalg.norm(p - space.centre, axis=1) <= 1e-7 * space.size)
    if not counted(space):
        return descent_of(space).reachable(p)
    there = np.asarray(solution_count(space, p) > 0)
    there[~there] = descent_of(space).reachable(p[~there])
    return there


def drawn_reachable(space: Space, points: ArrayLike) -> Flags:
    """(m,) `reachable` as a picture needs it: where closed forms give all configurations, they alone are asked.

    Next to a singular configuration they may lose one; so a place that they deny is asked for on both sides, too.
    Searches for all that is just outside of a boundary would take twenty times as long.
    """
    p = np.asarray(points, dtype=np.float64).reshape(-1, 3)
    if not counted(space):
        return reachable(space, p)
    there = np.asarray(solution_count(space, p) > 0)
    for direction in np.eye(3) if space.basis is None else space.basis.T:
        out, step = np.flatnonzero(~there), BESIDE * space.size * direction
        there[out] = (solution_count(space, p[out] + step) > 0) & (solution_count(space, p[out] - step) > 0)
    return there


def decided(space: Space) -> bool:
    """Whether `reachable` says no only of what cannot be reached, but for points that fill nothing."""
    space = one_by_one(space)
    return not space.moving or counted(space) or descent_of(space).exact is not None


def proven_out(space: Space, points: ArrayLike) -> Flags:
    """(m,) of points (m, 3) [m] that are not reached whether that is proven: by closed forms, or since they lie out of
    the set's plane or farther away than the arm is long."""
    p = np.asarray(points, dtype=np.float64).reshape(-1, 3)
    if decided(space):
        return np.ones(len(p), dtype=bool)
    chain, moving = moving_chain(space), list(space.moving)
    low, high = space.low[moving], space.high[moving]
    if space.gears is not None:
        ends = np.stack([moving_gears(space) * low, moving_gears(space) * high])
        low, high = ends.min(axis=0).sum(axis=1), ends.max(axis=0).sum(axis=1)
    ways = np.maximum(np.abs(low + chain.offsets), np.abs(high + chain.offsets))
    length = float(np.sum(np.linalg.norm(chain.constants[1:, :3, 3], axis=1)) + np.sum(ways[~chain.revolute]))
    out = np.linalg.norm(p - chain.constants[0, :3, 3], axis=1) > (1.0 + REACHED) * length
    if space.basis is not None:
        off = p - space.centre
        out |= np.linalg.norm(off - off @ space.basis @ space.basis.T, axis=1) > REACHED * space.size
    return np.asarray(out)


@dataclass(frozen=True)
class Membership:
    """`reachable` of one space, to be asked again and again.

    least: points that it should be asked for at a time, where there are so many: its searches run side by side.
    """

    space: Space
    least: int = 1024

    def __call__(self, points: Array) -> Flags:
        """(m,) whether each of the points (m, 3) [m] is reached."""
        return reachable(self.space, points)

    @property
    def lacks(self) -> Callable[[Array], Array] | None:
        """How points (m, 3) [m] lie from the set, (m, 3): what its searches found, where it makes any."""
        space = one_by_one(self.space)
        return descent_of(space).lacks if space.moving and not counted(space) else None


def solution_count(space: Space, points: ArrayLike) -> Index:
    """(m,) how many configurations of the moving joints, within limits, bring the tool's origin to each point (m, 3).

    Raises ValueError where more joints move the origin than the set has dimensions: there are infinitely many; and
    where joints follow others, so that no closed form gives them.
    """
    if not finitely_many(space):
        raise ValueError("infinitely many configurations reach a point of this set")
    if not counted(space):
        raise ValueError("no closed form counts the configurations of joints that follow others")
    space = one_by_one(space)
    if space.gears is not None:
        return geared_form_of(space).counts(np.asarray(points, dtype=np.float64).reshape(-1, 3))
    return closed_form_of(space).counts(np.asarray(points, dtype=np.float64).reshape(-1, 3))


def finitely_many(space: Space) -> bool:
    """Whether only finitely many values of the moving joints reach a point of the set, but for a set of no size."""
    return len(space.moving) == space.dimension > 0


def counted(space: Space) -> bool:
    """Whether these are finitely many and closed forms give them all: not where joints follow others."""
    return finitely_many(space) and (space.gears is None or invertible(space))
