"""The size of a set that finitely many configurations reach, by the integral over the joints.

With J(q) the derivatives of the position p(q), and N(q) the number of configurations within the limits that share
p(q), the coarea formula (H. Federer, Geometric Measure Theory, 1969, 3.2.3) says

    size of the reachable set = ∫ √det(JᵀJ) / N dq,

for volumes, areas and lengths, curved or flat: every point is counted N times and divided by N. N comes from the
closed forms of inverse kinematics.

The first moving joint only turns (or shifts) the whole arm. √det(JᵀJ) does not depend on it, and it enters N only as
the ranges of it in which the other configurations keep its limits: if configuration k needs a value of it that is δ_k
greater, then at t above the lower limit of its stroke w it is within limits where t + δ_k (to a whole turn, if it
turns) is in [0, w]. So the integral over t is a sum of lengths over counts, and only the others are sampled.

Several independent scramblings of an even sequence (sequence.py) give as many estimates; their scatter bounds the
error of the mean by Student's t.
"""

from __future__ import annotations

from functools import partial
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from robokin.inverse.blocks import BLOCK
from robokin.workspace.closed_form import closed_form_of
from robokin.workspace.parallel import in_order
from robokin.workspace.placing import Placing
from robokin.workspace.result import Measure
from robokin.workspace.sampling import moving_chain
from robokin.workspace.sequence import unit_points
from robokin.workspace.space import TURN, Space

Array = NDArray[np.float64]

SCRAMBLINGS = 8
"""Independent estimates: more would each be less even, fewer would need a greater t."""

STUDENT = 3.4995
"""Student's t for 99 % on both sides and SCRAMBLINGS - 1 degrees of freedom."""

ROUNDING = 1e-12
"""Rounding of a mean, as a part of it."""

OWN = 1e-4
"""A configuration that differs by less in every joint [rad | size] is the sampled one itself: next to a singular one
they come out a little apart."""

ALIKE = 1e-6
"""Tools whose rotations' entries differ by less are turned alike."""


def coarea_measure(space: Space, samples: int, seed: int, cores: int | None = None, several: bool = False) -> Measure:
    """The size of the reachable set, or of its part where at least two orientations are possible.

    `samples` configurations are looked at in all, at least one for each scrambling.
    """
    closed_form_of(space, first_free=True)
    each = max(samples // SCRAMBLINGS, 1) if len(space.moving) > 1 else 1
    sums = np.array(list(in_order(partial(_estimate, space, each, seed, several), range(SCRAMBLINGS), cores)))
    value = float(np.mean(sums))
    error = STUDENT * float(np.std(sums, ddof=1)) / np.sqrt(SCRAMBLINGS)
    method = "integral of the Jacobian's determinant over the number of inverse solutions"
    return Measure(value, float(error) + ROUNDING * value, method, each * SCRAMBLINGS)


def _estimate(space: Space, count: int, seed: int, several: bool, scrambling: int) -> float:
    """One scrambling's estimate."""
    moving = list(space.moving)
    low, stroke = space.low[moving], (space.high - space.low)[moving]
    placing = Placing(moving_chain(space))
    total = 0.0
    for start in range(0, count, BLOCK):
        size = min(BLOCK, count - start)
        q = np.empty((len(moving), size))
        q[0] = low[0] + 0.5 * stroke[0]
        if len(moving) > 1:
            u = unit_points("sobol", len(moving) - 1, seed, start, size, count, scrambling)
            q[1:] = low[1:, None] + stroke[1:, None] * u
        p, J = placing.placed(q)
        gram = np.einsum("icm,jcm->mij", J, J)
        weight = np.sqrt(np.maximum(np.linalg.det(gram), 0.0))
        total += float(np.sum(weight * _share(space, q, p, several)))
    return total / count * float(np.prod(stroke[1:]))


def _share(space: Space, q: Array, p: Array, several: bool) -> Array:
    """∫ 1/N (m,) over the first joint's stroke, for the other joints at q[1:] (d - 1, m); p: (3, m) is where q are.

    With `several` only where another configuration turns the tool otherwise.
    """
    form = closed_form_of(space, first_free=True)
    index, found = form.solutions(np.ascontiguousarray(p.T))
    m, first = q.shape[1], space.moving[0]
    stroke = space.high[first] - space.low[first]
    turn = TURN if form.chain.revolute[0] else np.inf
    apart = found - q.T[index]
    scale = np.where(form.chain.revolute, 1.0, form.size)
    wrapped = np.where(form.chain.revolute, apart - TURN * np.round(apart / TURN), apart)
    other = np.max(np.abs(wrapped) / scale, axis=1) > OWN
    index, shift = index[other], wrapped[other, 0]
    counted = np.ones(len(index), dtype=bool)
    if several and len(index):
        counted = _turned_otherwise(space, q.T[index], found[other])
    # The other configurations of each sample side by side (most, m), NaN where there are fewer.
    place = np.arange(len(index)) - np.searchsorted(index, index)
    most = int(place.max(initial=-1)) + 1
    shifts, differ = np.full((most, m), np.nan), np.zeros((most, m), dtype=bool)
    shifts[place, index], differ[place, index] = shift, counted
    ends = np.concatenate([-shifts, stroke - shifts])
    ends = np.mod(ends, turn) if np.isfinite(turn) else ends
    ends = np.concatenate([np.zeros((1, m)), np.nan_to_num(np.clip(ends, 0.0, stroke)), np.full((1, m), stroke)])
    ends.sort(axis=0)
    share = np.zeros(m)
    for a, b in pairwise(ends):
        there = 0.5 * (a + b) + shifts
        there = np.mod(there, turn) if np.isfinite(turn) else there
        inside = (there >= 0.0) & (there <= stroke)
        part = (b - a) / (1.0 + np.sum(inside, axis=0))
        share += np.where(np.any(inside & differ, axis=0), part, 0.0) if several else part
    return share


def _turned_otherwise(space: Space, own: Array, other: Array) -> NDArray[np.bool_]:
    """(s,) whether configurations of the moving joints `own` and `other` (s, d) turn the tool differently.

    The joints that do not move the tool's origin stand still.
    """
    plan = Placing(moving_chain(space)).plan
    turned = []
    for q in (own, other):
        *_, tool = plan.columns(np.ascontiguousarray(q.T))
        turned.append(np.stack([np.broadcast_to(entry, len(q)) for column in tool[:3] for entry in column]))
    return np.asarray(np.max(np.abs(turned[0] - turned[1]), axis=0) > ALIKE)
