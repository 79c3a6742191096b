"""Whether a point can be reached, and by how many configurations, within the joint limits."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robokin.workspace.closed_form import closed_form_of
from robokin.workspace.descent import descent_of
from robokin.workspace.space import Space

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]


def reachable(space: Space, points: ArrayLike) -> Flags:
    """(m,) whether the tool's origin comes to each of the points (m, 3) [m], with some orientation, within limits.

    A point this side of 1e-7 of the arm's size from the set counts as its own. Where more joints move the origin
    than the set has dimensions a point is sought for from several starts: the answer False is then not proven.
    """
    p = np.asarray(points, dtype=np.float64).reshape(-1, 3)
    if finitely_many(space):
        return np.asarray(solution_count(space, p) > 0)
    if not space.moving:
        return np.asarray(np.linalg.norm(p - space.centre, axis=1) <= 1e-7 * space.size)
    return descent_of(space).reachable(p)


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
        return descent_of(self.space).lacks if self.space.moving and not finitely_many(self.space) else None


def solution_count(space: Space, points: ArrayLike) -> NDArray[np.intp]:
    """(m,) how many configurations of the moving joints, within limits, bring the tool's origin to each point (m, 3).

    Raises ValueError where more joints move the origin than the set has dimensions: there are infinitely many.
    """
    if not finitely_many(space):
        raise ValueError("infinitely many configurations reach a point of this set")
    return closed_form_of(space).counts(np.asarray(points, dtype=np.float64).reshape(-1, 3))


def finitely_many(space: Space) -> bool:
    """Whether only finitely many values of the moving joints reach a point of the set, but for a set of no size."""
    return len(space.moving) == space.dimension > 0
