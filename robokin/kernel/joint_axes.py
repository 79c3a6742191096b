"""The axes of an arm's joints as lines in space, at many configurations at once, and where they meet.

Nothing here depends on where on its axis a joint's frame stands.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from robokin.arrays import Array
from robokin.kernel.chain import Chain
from robokin.kernel.code_lines import Term
from robokin.kernel.frames import frames

NEARLY = 0.01
"""Sine of an angle, or a distance in the arm's size, below which axes count as parallel or as meeting: calibration
changes tables by less, and arms that are designed with an offset have a greater one."""


TINY = float(np.finfo(np.float64).tiny)


class Axes:
    """The axes of a chain's joints at configurations q: (s, n) [rad | m], lengths in the arm's size.

    z, o: (s, n, 3) directions and points on them; x: (s, n, 3) the x axes of the frames that joints start from;
    tip: (s, 3) the tool's origin; turns: (n,) bool.
    """

    def __init__(self, chain: Chain, q: Array, size: float) -> None:
        F = frames(chain, q)
        self.z, self.o = F[:, :-1, :3, 2], F[:, :-1, :3, 3] / size
        self.x = F[:, :-1, :3, 0]
        self.tip = F[:, -1, :3, 3] / size
        self.turns = chain.revolute
        self._meetings: dict[tuple[int, int], Array] = {}

    @classmethod
    def of_terms(cls, chain: Chain, z: list[list[Term]], o: list[list[Term]], tip: list[Term]) -> Axes:
        """Axes (1, n, 3) whose numbers are terms of code, in the arm's size."""
        axes = object.__new__(cls)
        axes.z, axes.o, axes.tip = (np.array([part], dtype=object) for part in (z, o, tip))
        axes.turns, axes._meetings = chain.revolute, {}
        return axes

    def across(self, i: int, j: int) -> Array:
        """z_i × z_j: (s, 3)."""
        return cross(self.z[:, i], self.z[:, j])

    def velocity(self, i: int, w: Array) -> Array:
        """(s, 3) the velocity that joint i gives to points w: (s, 3)."""
        return cross(self.z[:, i], w - self.o[:, i]) if self.turns[i] else self.z[:, i]

    def foot(self, i: int, w: Array) -> Array:
        """(s, 3) the point of axis i nearest to w: (s, 3)."""
        return np.asarray(self.o[:, i] + dot(w - self.o[:, i], self.z[:, i])[:, None] * self.z[:, i])

    def nearest(self, i: int, j: int) -> Array:
        """(s, 3) the point of axis j nearest to axis i, which is not parallel to it."""
        return nearest_point(self.z[:, i], self.o[:, i], self.z[:, j], self.o[:, j])

    def meeting(self, i: int, j: int) -> Array:
        """(s, 3) where axes i and j meet: midway where they do so nearly. Kept, as several signs ask for it."""
        if (i, j) not in self._meetings:
            self._meetings[i, j] = 0.5 * (self.nearest(i, j) + self.nearest(j, i))
        return self._meetings[i, j]

    def parallel(self, *joints: int) -> bool:
        """Whether the axes have nearly one direction, those of slides included."""
        return all(np.max(np.linalg.norm(self.across(joints[0], j), axis=1)) < NEARLY for j in joints)

    def meet(self, i: int, j: int) -> bool:
        """Whether the axes of two revolute joints nearly meet in a point."""
        if not self.turns[i] or not self.turns[j] or self.parallel(i, j):
            return False
        return bool(np.max(np.linalg.norm(self.nearest(i, j) - self.nearest(j, i), axis=1)) < NEARLY)

    def concurrent(self, i: int, j: int, k: int) -> bool:
        """Whether the axes of three revolute joints in a row nearly meet in one point."""
        if not (self.meet(i, j) and self.meet(j, k)):
            return False
        return bool(np.max(np.linalg.norm(self.meeting(i, j) - self.meeting(j, k), axis=1)) < NEARLY)


def nearest_point(z0: Array, o0: Array, z1: Array, o1: Array) -> Array:
    """The points (..., 3) of second lines nearest to first ones, which are not parallel to them.

    z: (..., 3) directions, o: (..., 3) points on the lines.
    """
    normal = cross(z0, z1)
    along = dot(cross(o1 - o0, z0), normal) / at_least(dot(normal, normal), TINY)
    return np.asarray(o1 + along[..., None] * z1)


def cross(a: Array, b: Array) -> Array:
    """Products (..., 3) of vectors (..., 3): a sixth of the time that numpy's takes for a handful."""
    x, y, z = a[..., 0], a[..., 1], a[..., 2]
    u, v, w = b[..., 0], b[..., 1], b[..., 2]
    out = np.empty(np.broadcast_shapes(a.shape, b.shape), dtype=a.dtype)  # terms of code are objects
    out[..., 0] = y * w - z * v
    out[..., 1] = z * u - x * w
    out[..., 2] = x * v - y * u
    return out


def at_least(values: Array, least: float) -> Array:
    """The values, or what they are to be at least."""
    if values.dtype == object:
        terms: list[Any] = values.ravel().tolist()
        return np.array([Term(one.lines, f"max({one.name}, {least!r})") for one in terms]).reshape(values.shape)
    return np.maximum(values, least)


def dot(a: Array, b: Array) -> Array:
    """Products (...) of vectors (..., 3)."""
    return np.asarray(np.einsum("...i,...i->...", a, b))
