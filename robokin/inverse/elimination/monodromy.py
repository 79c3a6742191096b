"""All complex solutions of a loop at a target in general position, found from a single one.

Statement. Find the generic number N of complex solutions of a loop, and complex targets at which all N are known.
Derivation. The pairs of joint values and the target that they reach are given by the joint values alone and form one
connected piece. So any joint values lead to some solution at any target, and leading the solutions of one target
around closed tours of targets permutes them, by which all are reached from any one. Two searches that begin with joint
values of their own must find as many, and each the solutions that the other's lead to.
Degenerate case. An arm that is singular everywhere has no isolated solutions. Where solutions are permuted in blocks,
as where a wrist turns over, one tour in two may add nothing: several are made, and joint values led there from
elsewhere.
Reference. A. Sommese, C. Wampler, "The numerical solution of systems of polynomials arising in engineering and
science" (2005), section 15.4.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from robokin.arrays import Array, Complex
from robokin.inverse.elimination.complex_newton import (
    distinct,
    regular,
)
from robokin.inverse.elimination.homotopy_paths import Points, points_at, points_of, track
from robokin.inverse.elimination.loop import Loop

SEEDS = 240
"""Random joint values that are led to the target at a time. They begin anywhere, so that no part of the solutions is
out of their reach. Where a wrist's axes miss each other by a trifle half of the solutions have large imaginary parts,
and one seed in a hundred leads to one of these."""

TOURS = 3
"""Triangles of targets that known solutions are led around at a time, which leads from frequent solutions to rare ones.
A set to which these and the seeds together add nothing is taken for whole, if all but a few of them arrive."""

LOST = 0.02
"""Part of the tours' paths that may be lost in that round: more, and solutions may be out of their reach."""

ROUNDS = 12
"""Times after which a set that still grows is given up."""

ATTEMPTS = 6
"""Targets that are tried for another start: a path is lost on the way to one in some hundred."""

WIDE = 0.5
"""Imaginary parts [rad | size] of the joint values that random complex targets are made of: far from real targets, at
whose neighbours solutions meet, and not so far that values are large."""

SLIDE = 1.0
"""The real parts [size] for joints that slide."""

PHASE = 1.5
"""Arguments [rad] of the quaternions' lengths. The more ways differ, the fewer solutions are rarely met."""


@dataclass(frozen=True, eq=False)
class Start:
    """A complex target, one point, and its N solutions values (6, N) [rad | size]."""

    point: Points
    values: Complex


class Known(NamedTuple):
    """All N solutions, values (N, 6) [rad | size], at a target's L6: closing (4, 4)."""

    closing: Array
    values: Complex


def started(loop: Loop, known: list[Known]) -> tuple[Start, Start] | None:
    """Two starts from all solutions at two targets; None where they are not as many, or a path is lost."""
    if len(known) < 2 or known[0].values.shape != known[1].values.shape:
        return None
    starts = []
    for k, (closing, values) in enumerate(known[:2]):
        here = Start(points_of(closing[None]), np.ascontiguousarray(values.T))
        start = another_start(loop, here, seed=50 + k)
        if start is None:
            return None
        starts.append(start)
    return starts[0], starts[1]


def two_starts(loop: Loop) -> tuple[Start, Start] | None:
    """Two starts found independently of each other that have the same number of solutions and lead to each other's.

    None where there are none, and where the arm is singular everywhere.
    """
    rng = np.random.default_rng(17)
    seeds = random_values(loop, rng, 2)
    if not regular(loop, seeds.T, np.zeros(2)).all():
        return None
    first, second = (explored(loop, points_at(loop, q), q, rng) for q in (seeds[:, :1], seeds[:, 1:]))
    for _ in range(ATTEMPTS):
        if first is None or second is None:
            return None
        carried, _ = _carried(loop, first, second.point)
        known = second.values.shape[1]
        joint = _set(loop, np.concatenate([second.values, carried], axis=1))
        if joint.shape[1] == known == first.values.shape[1]:
            return first, second
        if joint.shape[1] > known:
            second = explored(loop, second.point, joint, rng)
        else:
            # The first set is the smaller, or a path was lost: what the second knows enlarges the first.
            back, _ = _carried(loop, second, first.point)
            first = explored(loop, first.point, _set(loop, np.concatenate([first.values, back], axis=1)), rng)
    return None


def explored(loop: Loop, point: Points, values: Complex, rng: np.random.Generator) -> Start | None:
    """All solutions at a complex target, of which some (6, k) are known; None if they do not come to an end."""
    for _ in range(ROUNDS):
        k = values.shape[1]
        seeded, toured = _from_elsewhere(loop, point, rng), _toured(loop, point, values, rng)
        values = _set(loop, np.concatenate([values, seeded, toured], axis=1))
        if values.shape[1] == k and toured.shape[1] >= (1.0 - LOST) * TOURS * k:
            return Start(point, values)
    return None


def _from_elsewhere(loop: Loop, point: Points, rng: np.random.Generator) -> Complex:
    """The solutions (6, k) at a point that random joint values become, led there from the targets that they reach."""
    seeds = random_values(loop, rng, SEEDS)
    ends = track(loop, _turned(points_at(loop, seeds), rng), point.pick(np.zeros(SEEDS, dtype=np.intp)), seeds)
    return ends.values[:, ends.u == 0.0]


def _toured(loop: Loop, point: Points, values: Complex, rng: np.random.Generator) -> Complex:
    """The solutions (6, k) at a point that those known become, led around triangles of targets."""
    k = values.shape[1]
    which = np.repeat(np.arange(TOURS), k)
    stops = [_turned(points_at(loop, random_values(loop, rng, TOURS)), rng).pick(which) for _ in range(2)]
    home = point.pick(np.zeros(TOURS * k, dtype=np.intp))
    values, arrived = np.tile(values, (1, TOURS)), np.ones(TOURS * k, dtype=bool)
    for a, b in ((home, stops[0]), (stops[0], stops[1]), (stops[1], home)):
        ends = track(loop, a, b, values)
        arrived &= ends.u == 0.0
        values = np.where(ends.u == 0.0, ends.values, values)
    return values[:, arrived]


def _turned(points: Points, rng: np.random.Generator) -> Points:
    """Points of the same targets with quaternions of other, complex lengths, to which other ways lead."""
    return Points(points.r * np.exp(1j * rng.uniform(-PHASE, PHASE, points.r.shape[1])), points.p)


def another_start(loop: Loop, start: Start, seed: int) -> Start | None:
    """A start at another target, with all solutions that the given one has; None if paths are always lost."""
    rng = np.random.default_rng(seed)
    for _ in range(ATTEMPTS):
        point = points_at(loop, random_values(loop, rng, 1))
        values, arrived = _carried(loop, start, point)
        if arrived and values.shape[1] == start.values.shape[1]:
            return Start(point, values)
    return None


def random_values(loop: Loop, rng: np.random.Generator, count: int) -> Complex:
    """Random complex joint values (6, count) [rad | size]."""
    real = rng.uniform(-1.0, 1.0, (6, count)) * np.where(loop.revolute, np.pi, SLIDE)[:, None]
    return np.asarray(real + 1j * rng.uniform(-WIDE, WIDE, (6, count)))


def _carried(loop: Loop, start: Start, point: Points) -> tuple[Complex, bool]:
    """The solutions (6, k) at a point that those of a start become, and whether none was lost."""
    every = np.zeros(start.values.shape[1], dtype=np.intp)
    ends = track(loop, start.point.pick(every), point.pick(every), start.values)
    arrived = ends.u == 0.0
    return _set(loop, ends.values[:, arrived]), bool(arrived.all())


def _set(loop: Loop, values: Complex) -> Complex:
    """Values (6, k) without repetitions."""
    return values[:, distinct(loop, np.zeros(values.shape[1], dtype=np.intp), values.T)]
