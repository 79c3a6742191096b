"""Where the search for the nearest configuration begins.

Statement. Choose for each target some tens of configurations within the limits, among which there is one in the
basin of the nearest one.
Derivation. A descent ends in the minimum that it starts above. The nearest configuration of a target that cannot be
had lies as often on the faces, edges and corners of the box of joint limits as inside it, and descents from inside
the box slide past those that are small. So configurations are drawn in the box, and others on its faces: each joint
with one chance in two at one of its limits. Of each of as many parts of the joint space that which comes nearest to
the target is taken, from both kinds, and the nearest of the corners.
Degenerate case. A joint without limits is drawn within a turn or an arm's size; it has no corners.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import product

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.kernel.chain import Chain
from robokin.kernel.frames import pose

DRAWN = 2048
"""Configurations drawn in the box, and as many on its faces."""

PARTS = 32
"""Parts of the joint space, of each of which one is taken; a power of two."""

CORNERS = 8
"""The nearest corners that are taken."""

GUESSES = 2 * PARTS + CORNERS
"""Initial guesses for a target."""

BOUNDED = 8
"""Joints of which all corners are formed, 256; of an arm with more limits as many corners are drawn."""

LONG = 100.0
"""A slide's way [size] above which values spread evenly over it would hardly ever be near the links."""

KEPT = 8
"""How often what was drawn is kept for the next target: some megabyte each."""

TURN = 1e-2
"""Weight of 1 - cos θ against ½|p - t|² [size²] by which configurations are compared."""


@dataclass(frozen=True, eq=False)
class Guesses:
    """Configurations to choose from: q (k, n) [rad | m] and their poses (k, 4, 4).

    parts: the first 2 * PARTS * DRAWN / PARTS rows are in 2 * PARTS groups of equal size; the rest are corners.
    """

    q: Array
    poses: Array

    @cached_property
    def entries(self) -> Array:
        """(3, 4, k) the poses' entries."""
        return np.ascontiguousarray(self.poses[:, :3].transpose(1, 2, 0))

    def nearest(self, T: Array, size: float) -> Array:
        """(m, 2 PARTS + CORNERS, n) the guesses for targets T: (m, 4, 4) [m]."""
        away = np.zeros((len(T), len(self.poses)))
        for row in range(3):
            for column in range(4):
                weight = 1.0 / size**2 if column == 3 else TURN / 2.0
                away += weight * np.square(self.entries[row, column] - T[:, None, row, column])
        drawn, each = 2 * DRAWN, DRAWN // PARTS
        best = np.argmin(away[:, :drawn].reshape(len(T), 2 * PARTS, each), axis=2) + each * np.arange(2 * PARTS)
        corners = drawn + np.argsort(away[:, drawn:], axis=1, kind="stable")[:, :CORNERS]
        chosen: Array = self.q[np.concatenate([best, corners], axis=1)]
        return chosen

    def nearest_first(self, T: Array, size: float, count: int) -> Index:
        """(m, count) which of the guesses of all parts and corners are nearest to targets T (m, 4, 4) [m], nearest
        first; count: at most GUESSES."""
        weight = np.concatenate([np.full(9, np.sqrt(TURN / 2.0)), np.full(3, 1.0 / size)])
        own, wished = (weight[:, None] * X[:, :3].transpose(2, 1, 0).reshape(12, -1) for X in (self.poses, T))
        # Less the target's own square, which does not change the order; each target's sums are its own.
        away = np.sum(own * own, axis=0) - 2.0 * np.einsum("km,kg->mg", wished, own)
        drawn, each = 2 * DRAWN, DRAWN // PARTS
        best = np.argmin(away[:, :drawn].reshape(len(T), 2 * PARTS, each), axis=2) + each * np.arange(2 * PARTS)
        corners = drawn + np.argsort(away[:, drawn:], axis=1, kind="stable")[:, :CORNERS]
        chosen = np.concatenate([best, corners], axis=1)
        order = np.argsort(np.take_along_axis(away, chosen, axis=1), axis=1, kind="stable")[:, :count]
        return np.asarray(np.take_along_axis(chosen, order, axis=1))


def guesses(chain: Chain, limits: Array, size: float, seed: int) -> Guesses:
    """What to choose from within limits (n, 2) [rad | m]."""
    return _drawn(chain, np.ascontiguousarray(limits, dtype=np.float64).tobytes(), size, seed)


@lru_cache(maxsize=KEPT)
def _drawn(chain: Chain, limits_of: bytes, size: float, seed: int) -> Guesses:
    limits = np.frombuffer(limits_of).reshape(-1, 2)
    rng = np.random.default_rng(seed)
    reach = np.where(chain.revolute, np.pi, size)
    ends = np.where(np.isinf(limits), reach[:, None] * [-1.0, 1.0], limits)
    bounded = np.isfinite(limits)
    scale = np.where(chain.revolute, 1.0, size)
    inside = between(chain.revolute, ends, size, rng.random((DRAWN, chain.n)))
    faces = between(chain.revolute, ends, size, rng.random((DRAWN, chain.n)))
    side = rng.integers(0, 2, (DRAWN, chain.n))
    at_limit = (rng.random((DRAWN, chain.n)) < 0.5) & bounded[np.arange(chain.n), side]
    faces = np.where(at_limit, ends[np.arange(chain.n), side], faces)
    q = np.concatenate([inside[parts(inside / scale)], faces[parts(faces / scale)], _corners(ends, bounded, rng)])
    return Guesses(q, pose(chain, q))


def between(turns: Flags, ends: Array, size: float, u: Array) -> Array:
    """Configurations (k, n) [rad | m] at parts u (k, n) of the way between ends (n, 2).

    turns: (n,) whether each joint turns. A slide whose way is LONG against the arm has values of every order of
    magnitude.
    """
    low, high = ends.T
    q: Array = low + (high - low) * u
    for i in np.flatnonzero(~turns & (high - low > LONG * size)):
        home = np.clip(0.0, low[i], high[i])
        first, last = np.arcsinh((low[i] - home) / size), np.arcsinh((high[i] - home) / size)
        q[:, i] = np.clip(home + size * np.sinh(first + (last - first) * u[:, i]), low[i], high[i])
    return q


def _corners(ends: Array, bounded: Flags, rng: np.random.Generator) -> Array:
    """Corners (k, n) of the box ends (n, 2), all of them or drawn; joints without two limits are at zero."""
    n = len(ends)
    sides = np.flatnonzero(bounded.all(axis=1) & (ends[:, 1] > ends[:, 0]))
    if len(sides) <= BOUNDED:
        choice = np.array(list(product((0, 1), repeat=len(sides))), dtype=np.intp).reshape(2 ** len(sides), len(sides))
    else:
        choice = rng.integers(0, 2, (2**BOUNDED, len(sides)))
    q = np.tile(np.where(ends[:, 0] == ends[:, 1], ends[:, 0], np.clip(0.0, *ends.T)), (len(choice), 1))
    q[:, sides] = ends[sides, choice]
    # As many as are taken, whatever the arm: the last ones repeat.
    assert q.shape[1] == n
    return np.concatenate([q, np.tile(q[-1:], (max(CORNERS - len(q), 0), 1))])


def parts(x: Array) -> Index:
    """The order of configurations (DRAWN, n) that puts those of each of PARTS parts of the joint space together.

    The parts come from halving at the median, joint after joint (J. L. Bentley's k-d tree, Commun. ACM 18(9),
    1975).
    """
    cells, joint = [np.arange(len(x))], 0
    while len(cells) < PARTS:
        ordered = [cell[np.argsort(x[cell, joint % x.shape[1]], kind="stable")] for cell in cells]
        cells = [half for cell in ordered for half in (cell[: len(cell) // 2], cell[len(cell) // 2 :])]
        joint += 1
    return np.concatenate(cells)
