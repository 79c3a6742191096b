"""The ±360° equivalents of solutions: the same posture with joints a full turn further, within the joint limits.

Statement. A revolute joint at q and at q + 2πk stands the same way. A list of solutions names each posture once; a
controller that must not cross a limit wants every value within the limits.
Derivation. Joint by joint, the k with low ≤ q + 2πk ≤ high are whole numbers in an interval; every choice of one for
each joint is a solution, so their number is the product.
Degenerate case. A joint without a limit on one side has no finite number of equivalents: it is not turned. A solution
at both limits of a joint, which are 360° apart, has two. Limits of many turns have a product that no list can hold:
that is refused, see `MOST_TURNS`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.errors import InputError
from robokin.inverse.analysis import Task
from robokin.inverse.later_fields import changed
from robokin.inverse.solutions import BatchResult, Result
from robokin.inverse.verify import residuals
from robokin.kinematics.forward import forward_kinematics
from robokin.model import Robot
from robokin.model.robot import LIMIT_TOLERANCE
from robokin.spatial.angles import TURN

MOST_TURNS = 10_000
"""Equivalents of one solution that are listed at most: 2⁷ for seven joints of ±360°, and far below what fills a
memory. The bound is on what the limits allow at a generic solution, so that it does not depend on the target."""


def turning(robot: Robot) -> list[int]:
    """The joints, from 0, of which full turns can be listed: revolute, with a limit on either side."""
    finite = np.isfinite(robot.limits).all(axis=1)
    return [int(i) for i in np.flatnonzero(robot.revolute & finite)]


def unlimited(robot: Robot) -> list[int]:
    """The revolute joints, from 0, without a limit on one side or on both: no finite number of turns."""
    finite = np.isfinite(robot.limits).all(axis=1)
    return [int(i) for i in np.flatnonzero(robot.revolute & ~finite)]


def check_turns(robot: Robot, limits: bool) -> None:
    """Raise InputError where full turns cannot be listed: without limits, or with limits of too many turns."""
    if not limits:
        raise InputError(
            "full turns are listed within the joint limits, found that limits do not count; expected one of the two"
        )
    product = turns_of_limits(robot)
    if product > MOST_TURNS:
        raise InputError(
            f"the joint limits of {robot.name} allow some {float(product):.2g} full turns of each solution; "
            f"expected at most {MOST_TURNS}: narrower limits, or a list without full turns"
        )


def turns_of_limits(robot: Robot) -> int:
    """How many equivalents a generic solution has within the limits."""
    widths = [robot.limits[i, 1] - robot.limits[i, 0] for i in turning(robot)]
    return math.prod(max(1, math.ceil(min(width, 1e300) / TURN - LIMIT_TOLERANCE)) for width in widths)


def turn_ranges(robot: Robot, q: Array) -> tuple[Array, Array]:
    """The least and the greatest number of full turns (s, n) that leave each value of q: (s, n) within its limits."""
    least, most = np.zeros(q.shape), np.zeros(q.shape)
    which = turning(robot)
    low, high = (robot.limits[which] + [-LIMIT_TOLERANCE, LIMIT_TOLERANCE]).T
    values = q[:, which]
    # A value outside the limits, which only the nearest configuration has, is its own only equivalent.
    least[:, which] = np.minimum(np.ceil((low - values) / TURN), 0.0)
    most[:, which] = np.maximum(np.floor((high - values) / TURN), 0.0)
    return least, most


def count_equivalents(robot: Robot, q: Array) -> list[int]:
    """How many configurations within the limits each q: (s, n) [rad | m] is equivalent to, itself included."""
    least, most = turn_ranges(robot, q)
    return [math.prod(int(count) for count in row) for row in (most - least + 1.0).tolist()]


def equivalents(robot: Robot, q: Array) -> tuple[Array, Index, Flags]:
    """All equivalents within the limits of configurations q: (s, n) [rad | m].

    Returns them (r, n), those of one after the other by q1, q2, …; of which row of q each is (r,); whether it is that
    row itself (r,).
    """
    least, most = (part.astype(np.intp) for part in turn_ranges(robot, q))
    of = np.arange(len(q))
    turns = np.zeros(q.shape, dtype=np.intp)
    for i in turning(robot):
        counts = (most[:, i] - least[:, i] + 1)[of]
        rows = np.repeat(np.arange(len(of)), counts)
        step = np.arange(len(rows)) - np.repeat(np.cumsum(counts) - counts, counts)
        of, turns = of[rows], turns[rows]
        turns[:, i] = least[of, i] + step
    return q[of] + TURN * turns, of, np.asarray(~turns.any(axis=1))


# Answers ------------------------------------------------------------------------------------------------------


def with_turn_counts(robot: Robot, batch: BatchResult) -> BatchResult:
    """The answers, whose `counts` say under `turns` how many solutions there are with full turns."""

    def single(i: int) -> Result:
        result = batch[i]
        q = np.array([solution.q for solution in result.solutions]).reshape(-1, robot.n)
        return changed(result, counts={**result.counts, "turns": sum(count_equivalents(robot, q))})

    return replace(batch, single=single)


@dataclass(frozen=True, eq=False)
class Turned:
    """The rows of all targets: index: (r,) the target, of: (r,) which of its solutions, q: (r, n), errors: (r,)."""

    index: Index
    of: Index
    own: Flags
    q: Array
    position: Array
    angle: Array


def with_full_turns(
    robot: Robot, batch: BatchResult, T: Array, task: Task, near: Array | None, size: float, most: int | None
) -> BatchResult:
    """The answers for T: (m, 4, 4) with the equivalents within the limits of each solution as solutions.

    Those of a solution follow it, by q1, q2, …; with `near` (n,) all are ordered by the greatest joint move from there
    (lengths in `size` [m]). `most` cuts the list of each target.
    """
    listed = np.arange(batch.q.shape[1]) < batch.count[:, None]
    target, place = np.nonzero(listed)
    q, of, own = equivalents(robot, batch.q[listed])
    position, angle = batch.position_error[listed][of], batch.angle_error[listed][of]
    far = ~own
    position[far], angle[far] = task_errors(robot, q[far], T[target[of[far]]], task)
    rows = Turned(target[of], place[of], own, q, position, angle)
    move = None if near is None else np.max(np.abs(q - near) / np.where(robot.revolute, 1.0, size), axis=1)
    order = np.lexsort((~own, rows.of, rows.index) if move is None else (~own, move, rows.index))
    rank = np.empty(len(order), dtype=np.intp)
    rank[order] = np.arange(len(order)) - np.searchsorted(rows.index[order], rows.index[order])
    all_counts = np.bincount(rows.index, minlength=len(batch))
    kept = order if most is None else order[rank[order] < most]
    return _batch(batch, _picked(rows, kept), all_counts, most)


def task_errors(robot: Robot, q: Array, T: Array, task: Task) -> tuple[Array, Array]:
    """Distances (s,) [m] and angles (s,) [rad] of the poses at q: (s, n) from targets T: (s, 4, 4).

    What the task leaves open is no error: the orientation, or the turn about the tool's z axis.
    """
    reached = forward_kinematics(robot, q)
    position, angle = residuals(T, reached)
    if task == "position":
        return position, np.zeros(len(q))
    if task == "approach":
        chord = np.linalg.norm(T[:, :3, 2] - reached[:, :3, 2], axis=1)
        return position, 2.0 * np.arcsin(np.minimum(chord / 2.0, 1.0))
    return position, angle


def _picked(rows: Turned, which: Index) -> Turned:
    return Turned(
        rows.index[which], rows.of[which], rows.own[which], rows.q[which], rows.position[which], rows.angle[which]
    )


def _batch(batch: BatchResult, rows: Turned, all_counts: Index, most: int | None) -> BatchResult:
    """The arrays of the rows, padded, and what makes single answers of them."""
    count = np.bincount(rows.index, minlength=len(batch))
    width = int(count.max(initial=0))
    first = np.cumsum(count) - count
    place = np.arange(len(rows.index)) - first[rows.index]
    q = np.full((len(batch), width, rows.q.shape[1]), np.nan)
    position, angle = np.full((len(batch), width), np.nan), np.full((len(batch), width), np.nan)
    inside = np.zeros((len(batch), width), dtype=bool)
    q[rows.index, place], position[rows.index, place], angle[rows.index, place] = rows.q, rows.position, rows.angle
    inside[rows.index, place] = batch.within_limits[rows.index, rows.of]

    def single(i: int) -> Result:
        own = slice(first[i], first[i] + count[i])
        return _single(batch[i], _picked(rows, np.arange(len(rows.index))[own]), int(all_counts[i]))

    def branches() -> list[str]:
        names, starts = batch.branches(), np.cumsum(batch.count) - batch.count
        return [names[k] for k in (starts[rows.index] + rows.of).tolist()]

    complete = batch.complete and (most is None or bool(np.all(count == all_counts)))
    return replace(
        batch, q=q, count=count, position_error=position, angle_error=angle, within_limits=inside,
        complete=complete, single=single, branches=branches,
    )  # fmt: skip


def _single(result: Result, rows: Turned, total: int) -> Result:
    """The answer for one target with its rows as solutions."""
    of = rows.of.tolist()
    values = zip(of, rows.q, rows.position.tolist(), rows.angle.tolist(), strict=True)
    solutions = tuple(
        replace(result.solutions[k], q=q, position_error=position, angle_error=angle)
        for k, q, position, angle in values
    )
    counts = {**result.counts, "turns": total, "listed": len(solutions)}
    own = rows.own.tolist()
    families = tuple(replace(family, solution=_place(of, own, family.solution)) for family in result.families)
    whole = len(solutions) == total
    return changed(
        result, solutions=solutions, counts=counts, families=families, complete=result.complete and whole,
        basis=result.basis if whole else None,
        postures=result.postures and whole,
    )  # fmt: skip


def _place(of: Sequence[int], own: Sequence[bool], solution: int) -> int:
    """Where a solution stands among the rows, itself before its equivalents; -1 where it does not."""
    places = [i for i, k in enumerate(of) if k == solution]
    return min(places, key=lambda i: not own[i], default=-1)
