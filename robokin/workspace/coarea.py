"""The size of a set that finitely many configurations reach, by the integral over the joints.

With J(q) the derivatives of the position p(q), and N(q) the number of configurations within the limits that share
p(q), the coarea formula (H. Federer, Geometric Measure Theory, 1969, 3.2.3) says

    size of the reachable set = ∫ √det(JᵀJ) / N dq,

for volumes, areas and lengths, curved or flat: every point is counted N times and divided by N. N comes from the
closed forms of inverse kinematics.

The first moving joint only turns (or shifts) the whole arm. √det(JᵀJ) does not depend on it, and it enters N only as
the ranges of it in which the other configurations keep its limits: if configuration k needs a value of it that is δ_k
greater, then at t above the lower limit of its stroke w it is within limits where t + δ_k (to a whole turn, if it
turns) is in [0, w]. So the integral over t is a sum of lengths over counts, and only the others are integrated over:
none for one joint, one for two (two_joints.py), and two for three (strata.py). There 1/N jumps where another
configuration comes to a limit of the second or third joint. Where that is, those places know that are on a limit
themselves: their other configurations lie on these curves.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from itertools import pairwise

import numpy as np

from robokin.arrays import Array, Flags
from robokin.jobs.ordered_map import ordered_map
from robokin.kernel.frames import pose
from robokin.kernel.geometric_jacobian import motion
from robokin.spatial.angles import TURN, circled
from robokin.workspace.placing_joints import closed_form_of
from robokin.workspace.sampling import moving_chain
from robokin.workspace.sizes import Measure
from robokin.workspace.space import PROBES, Space
from robokin.workspace.strata import stratified
from robokin.workspace.two_joints import two_joint_measure

ROUNDING = 1e-12
"""Rounding of an integral, as a part of it."""

OWN = 1e-4
"""A configuration that differs by less in every joint [rad | size] is the sampled one itself: next to a singular one
they come out a little apart."""

AS_ONE = 4e-9
"""What OWN does to an integral, as a part of it: the determinant grows in proportion to the distance from where it
vanishes, so that half of what is within OWN / 2 of there counts for some OWN² / 8."""

UPRIGHT = 1e-9
"""How far a joint may be from sliding at right angles to what the others do."""

ALIKE = 1e-6
"""Tools whose rotations' entries differ by less are turned alike."""

EDGES = 16
"""One in so many of the values is looked at on the limits, to know where 1/N jumps."""

BLOCK = 2048
"""Configurations at a time."""

FEW = 4
"""Blocks from which on several cores work at them: to start them takes as long as some of these."""


def coarea_measure(space: Space, samples: int, seed: int, cores: int | None = None, several: bool = False) -> Measure:
    """The size of the reachable set, or of its part where at least two orientations are possible.

    `samples` configurations are looked at in all, or the few that are needed at least.
    """
    if len(space.moving) == 1:
        return _one_joint(space, several)
    if len(space.moving) == 2:
        return two_joint_measure(space, samples, several)
    if not space.robot.revolute[list(space.moving)].any():
        return _slides(space, several)
    across = _slide_across(space)
    if across is not None:
        rest = without(space, across)
        stroke = float(space.high[across] - space.low[across])
        flat = two_joint_measure(rest, samples, several)
        return replace(
            flat, value=stroke * flat.value, error=stroke * flat.error, method=f"{flat.method}, times a stroke"
        )
    closed_form_of(space, first_free=True)
    low, high = space.low[list(space.moving)], space.high[list(space.moving)]
    each = max(samples // (4 * EDGES), 1)
    marks, spacing = _marks(space, each, seed)
    left = max(samples - 4 * each, 1)
    found = stratified(partial(_values, space, several, cores), low[1:], high[1:], left, seed, marks)
    # A part in which another configuration counts, and which no point on the limits shows, is about as narrow as what
    # is between them, both ways: half of what is there at most.
    unseen = 0.5 * spacing**2 * float(np.prod(high[1:] - low[1:])) * found.greatest
    error = found.error + unseen + (ROUNDING + AS_ONE) * found.value
    method = "integral of the Jacobian's determinant over the number of inverse solutions"
    return Measure(found.value, error, method, found.evaluations + 4 * each)


def _one_joint(space: Space, several: bool) -> Measure:
    """The length of an arc or of a line."""
    method = "the only joint's stroke times the length that a unit of it makes"
    (i,) = space.moving
    J = motion(moving_chain(space), np.array([[0.5 * (space.low[i] + space.high[i])]])).linear
    value = 0.0 if several else float(np.linalg.norm(J) * (space.high[i] - space.low[i]))
    return Measure(value, ROUNDING * value, method, 1)


def _slides(space: Space, several: bool) -> Measure:
    """The volume of the box that three slides make, upright or slanting, each place of it once."""
    moving = list(space.moving)
    J = motion(moving_chain(space), 0.5 * (space.low + space.high)[moving, None]).linear
    value = 0.0 if several else float(abs(np.linalg.det(J[:, :, 0])) * np.prod((space.high - space.low)[moving]))
    return Measure(value, ROUNDING * value, "the strokes times the volume of the slides' directions", 1)


def _slide_across(space: Space) -> int | None:
    """A joint that slides at right angles to all that the others do: the set is theirs times its stroke."""
    moving = list(space.moving)
    rng = np.random.default_rng(7)
    q = space.low[moving, None] + (space.high - space.low)[moving, None] * rng.random((len(moving), PROBES))
    J = motion(moving_chain(space), q).linear
    for k, i in enumerate(moving):
        if space.robot.revolute[i] or np.max(np.ptp(J[k], axis=1)) > UPRIGHT:
            continue
        along = np.abs(np.einsum("icm,cm->im", np.delete(J, k, axis=0), J[k]))
        if np.max(along) <= UPRIGHT * np.max(np.linalg.norm(J, axis=1)):
            return i
    return None


def without(space: Space, joint: int) -> Space:
    """The space with a joint held in the middle of its range, whose set has a dimension less."""
    low, high = space.low.copy(), space.high.copy()
    low[joint] = high[joint] = 0.5 * (low[joint] + high[joint])
    moving = tuple(i for i in space.moving if i != joint)
    return replace(space, low=low, high=high, moving=moving, dimension=space.dimension - 1)


def _marks(space: Space, each: int, seed: int) -> tuple[Array, float]:
    """Values (2, k) of the second and third joint at which another configuration is at a limit of these joints: from
    `each` places on each of the four limits. And what part of a limit is between two of them."""
    moving = list(space.moving)
    low, high, full = space.low[moving], space.high[moving], space.full[moving]
    rng = np.random.default_rng((seed, 0xED6E))
    sides = []
    for k in (1, 2):
        for end in () if full[k] else (low[k], high[k]):
            q = np.empty((3, each))
            other = 3 - k
            q[0], q[k] = 0.5 * (low[0] + high[0]), end
            q[other] = low[other] + (high[other] - low[other]) * (np.arange(each) + rng.random(each)) / each
            sides.append(q)
    if not sides:
        return np.zeros((2, 0)), 0.0
    q = np.concatenate(sides, axis=1)
    p = motion(moving_chain(space), q).tool[3]
    _, found = closed_form_of(space, first_free=True).solutions(np.ascontiguousarray(p.T))
    return np.asarray(np.clip(found[:, 1:].T, low[1:, None], high[1:, None])), 1.0 / each


def _values(space: Space, several: bool, cores: int | None, q: Array) -> Array:
    """(m,) the integrand at values (2, m) of the second and third joint."""
    blocks = [q[:, start : start + BLOCK] for start in range(0, q.shape[1], BLOCK)]
    work = partial(_block, space, several)
    return np.concatenate(list(ordered_map(work, blocks, cores if len(blocks) >= FEW else 1)))


def _block(space: Space, several: bool, rest: Array) -> Array:
    first = space.moving[0]
    middle = np.full((1, rest.shape[1]), 0.5 * (space.low[first] + space.high[first]))
    q = np.concatenate([middle, rest])
    J, _, tool = motion(moving_chain(space), q)
    p = tool[3]
    weight = np.abs(np.linalg.det(J.transpose(2, 0, 1)))
    return np.asarray(weight * _share(space, q, p, several))


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
    wrapped = circled(apart, form.chain.revolute)
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


def _turned_otherwise(space: Space, own: Array, other: Array) -> Flags:
    """(s,) whether configurations of the moving joints `own` and `other` (s, d) turn the tool differently.

    The joints that do not move the tool's origin stand still.
    """
    chain = moving_chain(space)
    turned = pose(chain, own)[:, :3, :3] - pose(chain, other)[:, :3, :3]
    return np.asarray(np.max(np.abs(turned), axis=(1, 2)) > ALIKE)
