"""True mobility: what a mechanism can do, from its geometry, and why a count may differ.

Statement. Given an assembled linkage, find in how many independent ways it moves.

1. At the given configuration joint speeds must lie in the kernel of the loops' equations: its dimension is the
   *instantaneous* mobility. Singular values tell it; the gap between the least that counts and the greatest that does
   not is part of the answer.
2. If the equations are independent, the configurations near by are a smooth surface of just that dimension.
3. Otherwise the kernel may be larger than usual at this configuration, a singular pose: from it some steps are taken
   along the kernel and closed again; the least kernel met is the *generic* mobility.
4. Even a generic kernel may promise motions that curvature forbids (a shaky structure). At a generic configuration,
   steps of two lengths r are taken along the kernel in many directions and closed; displacements that stay in
   proportion to r as r shrinks are motions, those that shrink like r² are curvature. Their number is the *finite*
   mobility.

Degenerate. The answer is that of the branch on which the description is assembled, near it and not all round. A
mechanism with contacts (gears, cams) is judged by its velocities alone: its contact points wander in a way that the
description does not say.

Sources: J. M. Selig, Geometric Fundamentals of Robotics, 2nd ed., 2005 (twists); C. W. Wampler, J. D. Hauenstein,
A. J. Sommese, "Mechanism mobility and a local dimension test", Mech. Mach. Theory 46(9), 2011 (why 4 is needed); the
sampling in 3 and 4 is ours.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robokin.mobility.linkage import RANK, Linkage, State

Array = NDArray[np.float64]

NEARLY = 4e-3
"""Singular values below this part of the greatest, but not zero, are those of a geometry that is wrong by about as
much: a mechanism that would move if its dimensions were exact. Those of mechanisms with good transmission are
greater than 7e-3."""

WALKS, STEPS = 8, 3
"""Walks away from the given configuration, and their steps."""

STEP_SIZES = (0.3, 0.5, 0.25, 0.1)
"""Steps of a walk [rad | size] that are tried in turn until one closes."""

WALKED_RANK = 1e-5
"""Singular values below this part of the greatest are zero at a configuration that was walked to: where a structure
is shaky everywhere, loops that lack 1e-12 of closing leave it 1e-6 away from the place where it trembles."""

PULL = 10.0 * RANK
"""Singular values below this part of the greatest close no loop on a walk: those of errors that `RANK` takes for none,
which grow a little along the motion, would pull the mechanism back to where it was given."""

ASSEMBLED = 10.0 * RANK
"""A state that lacks no more [size, rad] is assembled: a geometry whose errors `RANK` takes for none leaves some times
as much at the end of a step; an exact one closes to 1e-15."""

RADII = (3e-2, 3e-3)
"""The two lengths of steps [rad | size] by which motion is told from curvature."""

DIRECTIONS = 6
"""Random directions of the kernel tried for each of its dimensions, and both ways."""

KEPT = 0.4
"""A displacement that keeps this part of itself, in proportion to the step, as that shrinks tenfold is a motion;
one of second order keeps a tenth."""

LEAST = 1e-2
"""Singular values of unit displacements below this are no motion at all."""


@dataclass(frozen=True, eq=False)
class Motion:
    """What a linkage can do near its configuration.

    instantaneous, generic, finite: the three mobilities; values: the singular values of the loops' equations at the
    given configuration, as parts of the greatest, descending; rank: how many count; nearly: how many more motions
    there would be if singular values below `NEARLY`, here and some steps on, were zero; state: a generic configuration;
    tangent: (f, finite) the motions' joint speeds there, orthonormal; redundant: equations of the loops that say
    nothing new (of λ a loop).
    """

    instantaneous: int
    generic: int
    finite: int
    values: Array
    rank: int
    nearly: int
    state: State
    tangent: Array
    redundant: int

    @property
    def gap(self) -> tuple[float, float]:
        """The least singular value that counts, and the greatest that does not (0 where there is none)."""
        least = float(self.values[self.rank - 1]) if self.rank else 0.0
        rest = float(self.values[self.rank]) if self.rank < len(self.values) else 0.0
        return least, rest


def motion_of(linkage: Linkage, order: int, seed: int = 0, velocities_only: bool = False) -> Motion:
    """The motion of a linkage in a space of λ = order. `velocities_only` judges by the given configuration alone."""
    start = linkage.reference
    values, kernel = kernel_at(linkage, start)
    instantaneous, rank = kernel.shape[1], linkage.freedoms - kernel.shape[1]
    redundant = order * len(linkage.loops) - rank
    near = int(np.sum(values[:rank] < NEARLY))
    if velocities_only or instantaneous == 0:
        return Motion(instantaneous, instantaneous, instantaneous, values, rank, near, start, kernel, max(redundant, 0))
    rng = np.random.default_rng(seed)
    if redundant == 0:
        # Nothing is special here but what single links do: that is looked at some steps on.
        state = _aside(linkage, start, kernel, rng)
        elsewhere, kernel = kernel_at(linkage, state)
        near = min(near, int(np.sum(elsewhere[:rank] < NEARLY)))
        return Motion(instantaneous, instantaneous, instantaneous, values, rank, near, state, kernel, 0)
    state, kernel = _generic(linkage, start, kernel, rng)
    near = min(near, int(np.sum(kernel_at(linkage, state)[0][:rank] < NEARLY)))
    generic = kernel.shape[1]
    redundant = order * len(linkage.loops) - (linkage.freedoms - generic)
    tangent = kernel if redundant == 0 else _tangent(linkage, state, kernel, rng)
    return Motion(instantaneous, generic, tangent.shape[1], values, rank, near, state, tangent, redundant)


def kernel_at(linkage: Linkage, state: State, rank: float = RANK) -> tuple[Array, Array]:
    """Singular values of the loops' equations as parts of the greatest, and their kernel (f, k): those below `rank`."""
    J = linkage.jacobian(state)
    if not J.size:
        return np.zeros(0), np.eye(linkage.freedoms)
    _, values, Vt = np.linalg.svd(J)
    greatest = float(values[0]) or 1.0
    values = values / greatest
    return values, Vt[int(np.sum(values > rank)) :].T


def _generic(linkage: Linkage, start: State, kernel: Array, rng: np.random.Generator) -> tuple[State, Array]:
    """The configuration with the least kernel of those met on some walks from the start."""
    best = start, kernel
    for _ in range(WALKS):
        state, here = start, kernel
        for _ in range(STEPS):
            after = _step(linkage, state, here, rng)
            if after is None:
                break
            state = after
            here = kernel_at(linkage, state, WALKED_RANK)[1]
            if here.shape[1] < best[1].shape[1] or (best[0] is start and here.shape[1] == best[1].shape[1]):
                best = state, here
    return best


def _aside(linkage: Linkage, start: State, kernel: Array, rng: np.random.Generator) -> State:
    """A configuration some steps from the start, whose kernel is no larger; the start if there is none."""
    state, here = start, kernel
    for _ in range(STEPS):
        after = _step(linkage, state, here, rng)
        if after is None:
            break
        there = kernel_at(linkage, after)[1]
        if there.shape[1] == kernel.shape[1]:
            state, here = after, there
    return state


def _step(linkage: Linkage, state: State, kernel: Array, rng: np.random.Generator) -> State | None:
    """The state after a random step along the kernel, closed again; None where every step comes back."""
    for size in STEP_SIZES:
        direction = kernel @ rng.normal(size=kernel.shape[1])
        dq = direction * (size / np.max(np.abs(direction)))
        after, back, lacking = linkage.closed(linkage.moved(state, dq), rank=PULL)
        if lacking <= ASSEMBLED and np.max(np.abs(dq + back)) > 0.1 * size:
            return after
    return None


def _tangent(linkage: Linkage, state: State, kernel: Array, rng: np.random.Generator) -> Array:
    """The joint speeds (f, k) of motions that are more than a tremble, orthonormal."""
    directions = kernel @ rng.normal(size=(kernel.shape[1], DIRECTIONS * kernel.shape[1]))
    directions /= np.linalg.norm(directions, axis=0)
    spans: list[tuple[Array, Array]] = []
    for radius in RADII:
        moves = []
        for direction in np.concatenate([directions, -directions], axis=1).T:
            _, back, lacking = linkage.closed(linkage.moved(state, radius * direction), rank=PULL)
            move = (radius * direction + back) / radius
            # Newton's steps may leap to another branch: that is no step along this one.
            if lacking <= ASSEMBLED and np.linalg.norm(move) <= 3.0:
                moves.append(move)
        if not moves:
            return kernel[:, :0]
        U, s, _ = np.linalg.svd(np.array(moves).T, full_matrices=False)
        spans.append((U, s / np.sqrt(len(moves))))
    (_, wide), (U, narrow) = spans
    wide = np.pad(wide, (0, max(len(narrow) - len(wide), 0)))[: len(narrow)]
    lasting = (narrow > LEAST) & (narrow >= KEPT * wide)
    return np.asarray(U[:, : min(int(np.sum(lasting)), kernel.shape[1])])
