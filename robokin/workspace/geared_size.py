"""The size of sets that no region holds with their size, or that are lines, where joints hang on each other.

A line's part that is reached is between two extremes, since the values are of one piece, and so is what they reach.

Curves and surfaces have ∫ √det(JᵀJ) du, counted once for every configuration that leads to a place. Whether places have
several is looked at: at configurations drawn in proportion to √det(JᵀJ) Newton's steps lead from many starts to others
with the same place. Where none has any, by the limit of a Poisson variable so many may have one. Where some have, each
counts for one over their number.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from robokin.arrays import Array
from robokin.spatial.angles import circled
from robokin.workspace.descent import REACHED
from robokin.workspace.geared_extremes import geared_best
from robokin.workspace.geared_slopes import GearedSlopes
from robokin.workspace.geared_starts import PlacedStarts
from robokin.workspace.goals import Goals
from robokin.workspace.sampling import joint_values, moving_cuts
from robokin.workspace.size_cells import RISK, poisson_limit
from robokin.workspace.sizes import Measure
from robokin.workspace.space import Space
from robokin.workspace.strata import stratified
from robokin.workspace.two_joints import integrated

SAMPLES = 1 << 14
"""Configurations that extremes are sought from."""

ROUNDING = 1e-9
"""Of a line's length, as a part of the arm's size: what extremes are found to."""

DRAWN, NEAR, FAR = 1000, 12, 6
"""Configurations at which others with the same place are sought, and from how many starts near it and anywhere."""

KEPT = 1 << 14
"""Configurations that these starts are chosen from."""

STEPS, MU = 40, 1e-3
"""Newton steps to each, and their damping."""

OWN = 1e-4
"""A configuration that differs by less in every variable [rad | size] is the drawn one itself."""

NORMAL = 2.6
"""Standard deviations of a mean of many for 99 % on both sides."""

PARTS = 64
"""Parts of a range that its integral begins with."""


def line_measure(space: Space, seed: int) -> Measure:
    """The length of the part of a line that is reached."""
    assert space.basis is not None
    along = space.basis[:, 0]
    goals = Goals(np.stack([along, -along]), np.zeros(2), np.zeros(3))
    q = geared_best(space, goals, SAMPLES, seed)
    least, greatest = GearedSlopes(space).place(q.T).T @ along
    method = "from one end of the line to the other: what one piece of values reaches is one piece"
    return Measure(float(greatest - least), ROUNDING * space.size, method, 2 * SAMPLES, exact=False)


def curved_measure(space: Space, samples: int, seed: int) -> Measure:
    """The length or area of a curve or surface that as many variables reach as it has dimensions."""
    moving = list(space.moving)
    low, high = space.low[moving], space.high[moving]
    weight = partial(_weight, space)
    if len(moving) == 1:
        edges = np.linspace(low[0], high[0], PARTS + 1)
        value, error, spent = integrated(lambda u: weight(u[None]), edges, max(samples, 1 << 12))
    else:
        cuts = moving_cuts(space)
        whole = stratified(
            lambda u: weight(u) * cuts.contains(u), low, high, max(samples, 1 << 10), seed, np.zeros((2, 0))
        )
        value, error, spent = whole.value, whole.error, whole.evaluations
    drawn = _drawn(space, weight, seed)
    if not drawn.shape[1]:
        return Measure(0.0, error, "no variable moves the tool's origin", spent, exact=False)
    counts = 1.0 + _others(space, drawn)
    share, m = 1.0 / counts, len(counts)
    off = NORMAL * float(np.std(share)) / float(np.sqrt(m))
    several = int(np.sum(counts > 1.0))
    rare = min(several, m - several)
    off = max(off, 0.5 * (poisson_limit(rare, RISK) - rare) / m)
    mean = float(np.mean(share))
    method = "integral of the Jacobian's determinant; places reached twice were sought at points at random"
    return Measure(value * mean, error + value * off, method, spent + m, exact=False)


def _weight(space: Space, u: Array) -> Array:
    """(m,) the length or area that a unit of the moving variables makes at u (n, m)."""
    slopes = GearedSlopes(space)
    J = slopes.by_variables(u)
    if len(u) == 1:
        return np.asarray(np.linalg.norm(J[0], axis=0))
    return np.asarray(np.linalg.norm(np.cross(J[0], J[1], axis=0), axis=0))


def _drawn(space: Space, weight: partial[Array], seed: int) -> Array:
    """(n, k) configurations within the limits, as many in each part as it makes of the set; about DRAWN."""
    tries = joint_values(space, "random", seed, 0, 32 * DRAWN, 32 * DRAWN, scramble=0xD7)[list(space.moving)]
    w = weight(tries)
    if not np.max(w) > 0.0:
        return tries[:, :0]
    chance = np.random.default_rng((seed, 0xD7A3)).random(len(w)) * np.max(w)
    return np.asarray(tries[:, chance < w][:, :DRAWN])


def _others(space: Space, drawn: Array) -> Array:
    """(m,) how many other configurations were found at the places of those drawn (n, m)."""
    slopes, moving = GearedSlopes(space), list(space.moving)
    low, high, full = space.low[moving, None], space.high[moving, None], space.full[moving, None]
    kept = joint_values(space, "sobol", 0, 0, KEPT, KEPT)[moving]
    table = PlacedStarts(slopes.place, np.eye(3), space.dimension, kept)
    points = slopes.place(drawn)
    starts = table.near(points, NEAR, FAR)
    many, n, m = starts.shape
    q = np.asarray(starts.transpose(1, 0, 2).reshape(n, many * m))
    t = np.tile(points, (1, many))
    box = np.where(full, -np.inf, low), np.where(full, np.inf, high)
    for _ in range(STEPS):
        far, *parts = slopes.model(t, q)
        dq, _ = slopes.step(q, box, far, np.full(len(far), MU), parts)
        q = np.clip(q + dq, *box)
    far = slopes.model(t, q)[0].reshape(many, m)
    ends = q.reshape(n, many, m)

    def apart(a: Array, b: Array) -> Array:
        return np.asarray(np.max(np.abs(circled(a - b, full)) / slopes.scale, axis=0) > OWN)

    found = np.zeros(m)
    new = far <= REACHED**2
    for i in range(many):
        new[i] &= apart(ends[:, i], drawn)
        for j in range(i):
            new[i] &= ~new[j] | apart(ends[:, i], ends[:, j])
        found += new[i]
    return found
