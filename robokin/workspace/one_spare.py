"""Arms with one joint to spare whose last axes are parallel: whether a point can be reached, without a search.

Statement. By the theorem of faces.py for the first joint i of the arm's plane: a point t that can be reached at all is
reached with some joint at a limit, or with the derivatives by the other joints short of full rank, or, if joint i makes
a whole turn, at any one value of it.
Derivation. Of three joints that move in a plane let i be the first. The derivatives by the last two, c₂ and c₃, are
short of rank where c₂ × c₃ = 0. That product depends on the last joint alone and is A cos q + B sin q + C, or
A q + B where that slides: the last two links are stretched or folded, at two values at most. With a waist before
them, a fourth joint that moves the plane, the determinant is that product times the waist's speed across the
plane, which is zero only for points on a surface about its axis (where the plane would not have to move). So with a
joint held at a limit, or the last one at such a value, or joint i anywhere, there remains an arm with as many
joints as the set has dimensions, of which closed forms give every configuration. Whether one of these arms reaches a
point is the answer, of yes and of no, but for points of that surface and of the plane in which the waist stands at
a limit, which fill nothing: of these only yes is certain.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from robokin.arrays import Array, Flags
from robokin.kernel.chain import Chain
from robokin.kernel.geometric_jacobian import motion
from robokin.kernel.ranks import RANK
from robokin.spatial.angles import TURN
from robokin.workspace.placing_joints import ClosedForm
from robokin.workspace.sampling import moving_chain
from robokin.workspace.space import Space

PARALLEL = 1e-9
"""How far a unit vector may lean from another and be parallel to it."""

NONE = 1e-12
"""A determinant [size²] that is this small at all values is rounding."""

PROBES = 64
"""Configurations at which ranks and the determinant are looked at."""


class OneSpare:
    """The arms with one joint held that together reach what an arm with one joint to spare reaches."""

    def __init__(self, space: Space, holds: list[tuple[int, float]]) -> None:
        self.count = len(space.moving)
        self.held: list[tuple[int, float, ClosedForm]] = []
        for k, value in holds:
            low, high, full = space.low.copy(), space.high.copy(), space.full.copy()
            joint = space.moving[k]
            low[joint] = high[joint] = value
            full[joint] = False
            moving = tuple(i for i in space.moving if i != joint)
            held = replace(space, low=low, high=high, full=full, moving=moving, axis=None)
            self.held.append((k, value, ClosedForm(held)))

    def reached(self, points: Array) -> tuple[Flags, Array]:
        """(m,) whether points (m, 3) [m] are reached, and the values (n, m) [rad | m] by which they are."""
        inside, values = np.zeros(len(points), dtype=bool), np.zeros((self.count, len(points)))
        for k, value, form in self.held:
            left = np.flatnonzero(~inside)
            if not len(left):
                break
            index, q = form.solutions(points[left])
            found = left[index]
            inside[found] = True
            values[:, found] = np.insert(q, k, value, axis=1).T
        return inside, values


def one_spare_of(space: Space) -> OneSpare | None:
    """What tells whether points of a space can be reached, if it is of this kind."""
    n, d = len(space.moving), space.dimension
    if space.gears is not None or n != d + 1 or space.basis is None or d < 2 or not _in_a_plane(space, n - 3):
        return None
    chain, low, high, full = _box(space)
    rng = np.random.default_rng(31)
    q = low[:, None] + (high - low)[:, None] * rng.random((n, PROBES))
    J = motion(chain, q).linear
    J[chain.revolute] /= space.size
    holds = []
    for k in range(n):
        if _rank(np.delete(J, k, axis=0)) < d:
            continue
        if not full[k]:
            holds += [(k, float(low[k])), (k, float(high[k]))]
        elif k == n - 3:
            holds.append((k, float(low[k])))
    singular = _singular(chain, q, space.size)
    if singular is None:
        return None
    for value in singular:
        at = low[-1] + np.mod(value - low[-1], TURN) if chain.revolute[-1] else value
        if low[-1] <= at <= high[-1]:
            holds.insert(0, (n - 1, float(at)))
    return OneSpare(space, holds)


def _box(space: Space) -> tuple[Chain, Array, Array, Flags]:
    moving = list(space.moving)
    return moving_chain(space), space.low[moving], space.high[moving], space.full[moving]


def _rank(J: Array) -> int:
    """The rank that derivatives (k, 3, m) have at most of m configurations."""
    values = np.linalg.svd(J.transpose(2, 0, 1), compute_uv=False)
    return int(np.max(np.sum(values > RANK * values[:, :1], axis=1)))


def _in_a_plane(space: Space, first: int) -> bool:
    """Whether the moving joints from `first` on, of which the last three, turn about parallel axes or slide square to
    them, and whatever comes before moves their plane."""
    chain, low, high, _ = _box(space)
    q = 0.5 * (low + high)[:, None]
    J, Z, _ = motion(chain, q)
    z, turns = Z[first:, :, 0], chain.revolute[first:]
    if not turns.any():
        return False
    normal = z[turns][0]
    lean = np.where(turns, np.linalg.norm(np.cross(z, normal), axis=1), np.abs(z @ normal))
    if np.any(lean > PARALLEL):
        return False
    if not first:
        return True
    # The determinant of the waist's and the last two's derivatives must not vanish everywhere.
    q = low[:, None] + (high - low)[:, None] * np.random.default_rng(29).random((len(low), PROBES))
    J, Z, _ = motion(chain, q)
    axis = Z[first:][turns][0]
    across = np.abs(np.sum(J[0] * axis, axis=0)) / (space.size if chain.revolute[0] else 1.0)
    return bool(np.max(across) > RANK)


def _singular(chain: Chain, q: Array, size: float) -> list[float] | None:
    """The values of the last joint at which its derivative and that of the one before it are parallel; None where
    they always are."""
    turns = bool(chain.revolute[-1])
    at = np.linspace(0.0, TURN, 8, endpoint=False) if turns else np.array([0.0, 1.0]) * size
    q = np.repeat(q[:, :1], len(at), axis=1)
    q[-1] = at
    J, Z, _ = motion(chain, q)
    J[chain.revolute] /= size
    normal = Z[chain.revolute][-1]
    det = np.sum(np.cross(J[-2], J[-1], axis=0) * normal, axis=0)
    if np.max(np.abs(det)) <= NONE:
        return None
    if not turns:
        slope = (det[1] - det[0]) / (at[1] - at[0])
        return [float(-det[0] / slope)] if abs(slope) * size > NONE else []
    A, B, C = 2.0 * np.mean(det * np.cos(at)), 2.0 * np.mean(det * np.sin(at)), np.mean(det)
    amplitude = np.hypot(A, B)
    if amplitude <= NONE or abs(C) > amplitude:
        return []
    middle, half = np.arctan2(B, A), np.arccos(-C / amplitude)
    return [float(middle + half), float(middle - half)]
