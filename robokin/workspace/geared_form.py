"""Every configuration for a position, where joints hang on each other and every value of theirs has its variables.

The closed forms give the values v of the moving joints, each within a turn; u = S⁻¹ (v + 2π k), k whole, are the
variables, of which those within their box and its cuts count.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.kernel.facts import fact
from robokin.model import CoupledRobot
from robokin.spatial.angles import TURN, circled
from robokin.workspace.half_spaces import HalfSpaces
from robokin.workspace.placing_joints import ClosedForm
from robokin.workspace.sampling import moved_rows, moving_cuts, moving_gears
from robokin.workspace.space import Space

ON_LIMIT = 1e-9
"""By how much [rad | size] a solution may be beyond its limits: the closed forms' rounding."""

MOST = 10_000
"""Turns that are looked at for a solution at most."""


class Unwinding:
    """The variables (n,) that stand for values of as many joints, each of which is known but for whole turns.

    v = S u + still; turns: (n,) which joints turn; box (low, high, full, each (n,)) and cuts: which variables may be;
    unit: (n,) 1 of those that turn, the arm's size of those that slide. Raises InputError for more than MOST turns.
    """

    def __init__(
        self, S: Array, still: Array, turns: Flags, box: tuple[Array, Array, Flags], cuts: HalfSpaces, unit: Array
    ) -> None:
        self.S, self.still, self.turning, self.cuts = S, still, turns, cuts
        (self.low, self.high, self.full), self.room = box, ON_LIMIT * unit[:, None]
        ends = np.stack([S * self.low, S * self.high])
        least, most = ends.min(axis=0).sum(axis=1) + still, ends.max(axis=0).sum(axis=1) + still
        ranges = [
            range(int(np.ceil((a - np.pi) / TURN - 1e-9)), int(np.floor((b + np.pi) / TURN + 1e-9)) + 1)
            if turn
            else (0,)
            for a, b, turn in zip(least.tolist(), most.tolist(), turns.tolist(), strict=True)
        ]
        self.whole = TURN * np.array(list(product(*ranges)), dtype=np.float64).reshape(-1, len(S))

    def __call__(self, index: Index, v: Array) -> tuple[Index, Array]:
        """All that are within limits, (s,) and (s, n), for the values v (k, n) of points `index` (k,), rising."""
        v = circled(v, self.turning)
        low, high, room = self.low[:, None], self.high[:, None], self.room
        which, values = [np.zeros(0, dtype=np.intp)], [np.zeros((0, len(self.low)))]
        for turn in self.whole:
            u = np.linalg.solve(self.S, (v + turn - self.still).T)
            # A whole turn has one end.
            above = np.where(self.full[:, None], u >= high - room, u > high + room)
            inside = np.all((u >= low - room) & ~above, axis=0)
            if len(self.cuts.h):
                inside &= np.all(self.cuts.G @ u <= self.cuts.h[:, None] + ON_LIMIT, axis=0)
            which.append(index[inside])
            values.append(np.clip(u, low, high).T[inside])
        found = np.concatenate(which)
        order = np.argsort(found, kind="stable")
        return found[order], np.concatenate(values)[order]


class GearedForm:
    """All values of the moving variables for a position; exists where `invertible` says so."""

    def __init__(self, space: Space) -> None:
        moving, rows = np.array(space.moving), moved_rows(space)
        assert space.gears is not None
        self.form = ClosedForm(_free(space))
        still = _still(space)
        unit = np.where(space.robot.revolute[moving], 1.0, space.size)
        box = space.low[moving], space.high[moving], space.full[moving]
        self.unwound = Unwinding(
            moving_gears(space), still, space.chain.revolute[rows], box, moving_cuts(space), unit
        )  # fmt: skip

    def solutions(self, points: Array) -> tuple[Index, Array]:
        """Every configuration within the limits: index (s,) into points (m, 3) [m], rising; q (s, k) [rad | m]."""
        return self.unwound(*self.form.solutions(points))

    def counts(self, points: Array) -> Index:
        """(m,) how many configurations within the limits reach each of the points (m, 3) [m]."""
        return np.bincount(self.solutions(points)[0], minlength=len(points))


@fact
def unwinding_of(space: Space) -> Unwinding:
    """The variables of a space with gears, all of them, for values of all joints of its arm."""
    robot = space.robot
    assert space.gears is not None and isinstance(robot, CoupledRobot)
    unit = np.where(robot.revolute, 1.0, space.size)
    box = space.low, space.high, space.full
    return Unwinding(
        space.gears.S, robot.drive.offsets, space.chain.revolute, box, space.gears.cuts, unit
    )  # fmt: skip


def invertible(space: Space) -> bool:
    """Whether each value of the moving joints of a space with gears has one of the moving variables."""
    S = moving_gears(space)
    if S.shape[0] != S.shape[1]:
        return False
    values = np.linalg.svd(S, compute_uv=False)
    return bool(np.all(values > 1e-12 * values[:1]))


@fact
def geared_form_of(space: Space) -> GearedForm:
    """The closed form of a space with gears, made when it is first asked for."""
    return GearedForm(space)


@fact
def one_by_one(space: Space) -> Space:
    """The same set without gears, where each moving variable moves one joint that tells and no other moves that; the
    space itself where that is not so, where cuts leave less than a box, and where there are no gears."""
    if space.gears is None or not space.moving:
        return space
    S = moving_gears(space)
    if S.shape[0] != S.shape[1] or np.any(S - np.diag(np.diag(S))) or len(moving_cuts(space).h):
        return space
    free, rows = _free(space), moved_rows(space)
    moving = list(space.moving)
    still = _still(space)
    ends = np.stack([np.diag(S) * space.low[moving], np.diag(S) * space.high[moving]]) + still
    low, high, full = free.low.copy(), free.high.copy(), free.full.copy()
    low[rows], high[rows] = ends.min(axis=0), ends.max(axis=0)
    full[rows] = space.chain.revolute[rows] & (high[rows] - low[rows] >= TURN * (1.0 - 1e-12))
    # Of more than a turn each place counts once.
    high[full] = low[full] + TURN
    return replace(free, low=low, high=high, full=full, axis=space.axis)


def _still(space: Space) -> Array:
    """(r,) what variables that do not move the tool's origin add to the joints that the others move [rad | m]."""
    assert space.gears is not None
    rest = np.delete(np.arange(len(space.low)), np.array(space.moving))
    return np.asarray(space.gears.S[moved_rows(space)][:, rest] @ (0.5 * (space.low + space.high))[rest])


def _free(space: Space) -> Space:
    """The space of the arm's joints, of which the moving ones move one by one and without limits."""
    robot, rows = space.robot, moved_rows(space)
    assert space.gears is not None and isinstance(robot, CoupledRobot)
    S = space.gears.S
    middle = S @ (0.5 * (space.low + space.high))
    ends = np.stack([S * space.low, S * space.high])
    slides = ~space.chain.revolute
    low, high = middle.copy(), middle.copy()
    full = np.zeros(len(middle), dtype=bool)
    full[rows] = space.chain.revolute[rows]
    low[full], high[full] = -np.pi, np.pi
    free = np.array([i for i in rows if slides[i]], dtype=np.intp)
    low[free], high[free] = ends.min(axis=0).sum(axis=1)[free], ends.max(axis=0).sum(axis=1)[free]
    return replace(
        space, robot=robot.free_motion, low=low, high=high, full=full, moving=tuple(rows), axis=None, gears=None
    )
