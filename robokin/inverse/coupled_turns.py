"""Full turns of joints that hang on each other: which values of the variables stand for one posture.

Statement. Given the variables u of a posture of a robot with v = S u + o, S square and regular, find all u, or those
within limits, at which each joint stands the same way.
Derivation. A full turn of a joint that turns leaves the posture: v + 2π k, k whole, has u + 2π S⁻¹ k. Where S⁻¹ is
whole these are full turns of the variables; where it is not (a ratio of 13 to 72) they are other configurations of the
drives. The k of which u is in a box lie in intervals, which S makes of the box. Joints that are not connected by S do
not know of each other: their choices are combined.
Degenerate case. A slide that turns with a joint without limits has no end of values: it is bounded by where the joints
that turn may bring it, and that there are more is said. Limits that allow thousands of choices are refused.
"""

from __future__ import annotations

import itertools
import math

import numpy as np

from robokin.arrays import Array, Flags, Index, combined
from robokin.errors import InputError
from robokin.inverse.solutions import Arc
from robokin.inverse.verify import within_limits, wrapped
from robokin.kernel.facts import fact
from robokin.model import CoupledRobot
from robokin.model.robot import tolerated, within
from robokin.spatial.angles import TURN, circled

MOST = 10_000
"""Configurations of the drives that are looked at for one of the joints: limits that allow more are refused."""

SAME = 1e-6
"""Variables that differ by less in everything [rad | size] are one configuration."""


@fact
def _groups(robot: CoupledRobot) -> list[tuple[Index, Index]]:
    """Rows and variables that S connects, with nothing between the groups."""
    n = robot.n
    linked = np.abs(robot.drive.S) > 0.0
    linked = linked | (np.abs(robot.drive.inverse.T) > 0.0)
    groups: list[tuple[Index, Index]] = []
    open_ = set(range(n))
    while open_:
        variables = {min(open_)}
        rows: set[int] = set()
        while True:
            more_rows = set(np.flatnonzero(linked[:, sorted(variables)].any(axis=1)).tolist())
            more = set(np.flatnonzero(linked[sorted(more_rows)].any(axis=0)).tolist())
            if more == variables and more_rows == rows:
                break
            variables, rows = more | variables, more_rows
        open_ -= variables
        groups.append((np.array(sorted(rows), dtype=np.intp), np.array(sorted(variables), dtype=np.intp)))
    return groups


@fact
def _one_for_each(robot: CoupledRobot) -> bool:
    """Whether full turns of the joints are full turns of the variables: a posture is one configuration of these."""
    turned = robot.drive.inverse[:, robot.free_motion.revolute]
    return bool(np.all(turned[robot.revolute] % 1.0 == 0.0) and not turned[~robot.revolute].any())


def configurations(
    robot: CoupledRobot, u: Array, limits: bool, turns: bool, near: Array | None = None
) -> tuple[list[Array], bool]:
    """The variables (n,) [rad | m] that stand for the same posture as u (n,), one of those that are full turns apart.

    With `limits` those within these; with `turns` all of them, else of full turns of the variables the one nearest to
    `near` (n,), or to zero. Also whether there are more of them without end.
    """
    if not turns and _one_for_each(robot):
        q, inside = within_limits(wrapped(u[None], robot.revolute), robot.revolute, robot.limits, near)
        if not inside[0]:  # no turn of a variable is within its limits
            return ([] if limits else [q[0]]), False
        if robot.within_limits(q[0]):
            return [q[0]], False
    choices, endless = [], False
    for rows, variables in _groups(robot):
        wish = np.zeros(len(variables)) if near is None else near[variables]
        found, more = _of_group(robot, rows, variables, u, limits, turns, wish)
        endless |= more
        choices.append((variables, found))
    _check_number(robot, math.prod(len(found) for _, found in choices))
    out = []
    for combination in itertools.product(*(found for _, found in choices)):
        q = np.empty(robot.n)
        for (variables, _), part in zip(choices, combination, strict=True):
            q[variables] = part
        out.append(q)
    return out, endless


def _of_group(
    robot: CoupledRobot, rows: Index, variables: Index, u: Array, limits: bool, turns: bool, near: Array
) -> tuple[list[Array], bool]:
    """The same for the variables of one group: their values (k,), of equal ones that next to `near` (k,)."""
    drive = robot.drive
    step = TURN * drive.inverse[np.ix_(variables, rows)] * robot.free_motion.revolute[rows]
    turning = robot.revolute[variables]
    box = robot.limits[variables]
    finite: Flags = np.all(np.isfinite(box), axis=1)
    start = u[variables]
    whole = drive.inverse[np.ix_(variables, rows)]
    whole = whole[:, robot.free_motion.revolute[rows]]
    ratios = bool(np.any(np.abs(whole - np.round(whole)) > 1e-12))
    slides = ~robot.free_motion.revolute[rows]
    S = drive.S[np.ix_(rows, variables)]
    searched = _searched_box(box, turning, limits, near)
    least, most = _ranges(S, step, start, _bounded(S, slides, turning, start[None], searched))
    q = start + _whole_numbers(robot, least, most) @ step.T
    o, own = drive.offsets[rows], drive.limits[rows]
    low, high = tolerated(searched)
    q = q[np.all((q >= low) & (q <= high), axis=1)]
    if limits:
        q = q[within(own, combined(q, S.T) + o)]
    if not len(q):
        return [], False
    rest = np.max(np.abs(q - near), axis=1)
    outside = ~_inside(box, own, q, combined(q, S.T) + o)
    keep = np.lexsort((rest, outside))
    chosen: list[Array] = []
    for i in keep.tolist():
        same = turning if not turns else np.zeros(len(turning), dtype=bool)
        if not any(_equal(q[i], other, same) for other in chosen):
            chosen.append(q[i])
    return chosen, ratios and not (limits and bool(np.all(finite | ~turning)))


def _inside(box: Array, own: Array, q: Array, v: Array) -> Flags:
    """(s,) whether variables q (s, k) are within box (k, 2), and joints' values v (s, r) within own (r, 2)."""
    return np.asarray(within(box, q)) & np.asarray(within(own, v))


def _equal(a: Array, b: Array, turning: Flags) -> bool:
    """Whether two values (k,) are the same, of angles but for full turns."""
    return bool(np.max(np.abs(circled(a - b, turning)), initial=0.0) < SAME)


def _searched_box(box: Array, turning: Flags, limits: bool, near: Array) -> Array:
    """Between which values (k, 2) the variables are looked for: their limits, of angles without any half a turn.

    Where limits do not count, an angle is anywhere within half a turn of `near` (k,) or its limits.
    """
    half = near[:, None] + [-np.pi, np.pi]
    free = np.tile([-np.inf, np.inf], (len(box), 1))
    if limits:
        bounded = np.any(np.isfinite(box), axis=1, keepdims=True)
        around = np.where(bounded, _one_turn(box, near), half)
        return np.where(turning[:, None], around, box)
    wide = np.stack(
        [np.where(np.isfinite(box[:, 0]), np.minimum(box[:, 0], half[:, 0]), half[:, 0]),
         np.where(np.isfinite(box[:, 1]), np.maximum(box[:, 1], half[:, 1]), half[:, 1])], axis=1
    )  # fmt: skip
    return np.where(turning[:, None], wide, free)


def _bounded(S: Array, slides: Flags, turning: Flags, points: Array, box: Array) -> Array:
    """The box (k, 2) with an end for what slides without limits: where full turns from points (s, k) may bring it.

    slides: (r,) rows of S that do not turn. They stay where they are, and so the variables that slide follow those that
    turn, which are bounded.
    """
    if np.all(np.isfinite(box)):
        return box
    rate = -np.linalg.solve(S[np.ix_(slides, ~turning)], S[np.ix_(slides, turning)])
    least, most = points.min(axis=0), points.max(axis=0)
    ends = np.stack([rate * (box[turning, 0] - most[turning]), rate * (box[turning, 1] - least[turning])])
    low, high = least[~turning] + ends.min(axis=0).sum(axis=1), most[~turning] + ends.max(axis=0).sum(axis=1)
    out = box.copy()
    out[~turning, 0], out[~turning, 1] = np.maximum(box[~turning, 0], low), np.minimum(box[~turning, 1], high)
    return out


def _one_turn(box: Array, near: Array) -> Array:
    """Limits (k, 2) of which a missing one is half a turn beyond `near` (k,), and a turn or more from the other."""
    low = np.where(np.isfinite(box[:, 0]), box[:, 0], np.minimum(near - np.pi, box[:, 1] - TURN))
    high = np.where(np.isfinite(box[:, 1]), box[:, 1], np.maximum(near + np.pi, box[:, 0] + TURN))
    return np.stack([low, high], axis=1)


def _ranges(S: Array, step: Array, start: Array, box: Array) -> tuple[Index, Index]:
    """The least and the greatest whole numbers of turns (r,) of each row that leave the variables in a box (k, 2)."""
    # v - v0 = S (u - u0) = 2π k of the rows that turn: of u in a box each is in an interval.
    with np.errstate(invalid="ignore"):
        ends = np.stack([S * (box[:, 0] - start), S * (box[:, 1] - start)])
    ends = np.where(S == 0.0, 0.0, ends)
    low, high = ends.min(axis=0).sum(axis=1), ends.max(axis=0).sum(axis=1)
    turns = np.any(step != 0.0, axis=0)
    low, high = np.where(turns, low, 0.0) / TURN, np.where(turns, high, 0.0) / TURN
    # Something to spare for rounding: what is outside is left out afterwards.
    return np.ceil(low - 1e-6).astype(np.intp), np.floor(high + 1e-6).astype(np.intp)


def pieces(robot: CoupledRobot, arc: Arc, limits: bool) -> list[Arc]:
    """What a piece of a self-motion of the joints (k, n) [rad | m] is in the variables, with `limits` within these."""
    u = robot.drive.variables_for(arc.q)
    if not limits:
        middle = 0.5 * (np.min(u, axis=0) + np.max(u, axis=0))
        return [Arc(u - np.where(robot.revolute, TURN * np.round(middle / TURN), 0.0), arc.whole)]
    out = []
    for shift in _shifts(robot, u):
        inside = np.asarray(robot.within_limits(u + shift))
        if inside.any():
            out += _runs(u + shift, inside, arc.whole)
    return out


def _shifts(robot: CoupledRobot, u: Array) -> list[Array]:
    """The full turns (n,), in the variables, by which points of a curve (k, n) may come within the limits."""
    drive, near = robot.drive, np.zeros(robot.n)
    shifts = [near]
    for rows, variables in _groups(robot):
        S = drive.S[np.ix_(rows, variables)]
        step = TURN * drive.inverse[np.ix_(variables, rows)] * robot.free_motion.revolute[rows]
        box = _searched_box(robot.limits[variables], robot.revolute[variables], True, near[variables])
        points = u[:, variables]
        box = _bounded(S, ~robot.free_motion.revolute[rows], robot.revolute[variables], points, box)
        # Between which turns those of all points are: the ends of what S makes of the curve.
        turned = points @ S.T
        ends = [
            _ranges(S, step, end @ drive.inverse[np.ix_(variables, rows)].T, box)
            for end in (turned.max(axis=0), turned.min(axis=0))
        ]
        grid = _whole_numbers(robot, ends[0][0], ends[1][1]) @ step.T
        own = drive.limits[rows]
        moved = []
        for turn in grid:
            q = points + turn
            if _inside(robot.limits[variables], own, q, combined(q, S.T) + drive.offsets[rows]).any():
                whole = np.zeros(robot.n)
                whole[variables] = turn
                moved.append(whole)
        shifts = [one + other for one in shifts for other in moved]
    return shifts


def _whole_numbers(robot: CoupledRobot, least: Index, most: Index) -> Array:
    """All rows of whole numbers (r,) between two. Raises InputError where they are too many."""
    _check_number(robot, float(np.prod((most - least + 1).astype(np.float64))))
    ranges = (range(a, b + 1) for a, b in zip(least.tolist(), most.tolist(), strict=True))
    return np.array(list(itertools.product(*ranges))).reshape(-1, len(least))


def _runs(u: Array, inside: Flags, whole: bool) -> list[Arc]:
    """The pieces of a curve (k, n) whose points are inside, each of them two or more points."""
    if inside.all():
        return [Arc(u, whole)]
    if whole and inside[0]:  # the curve closes: a piece may run over where it begins
        first = int(np.flatnonzero(~inside)[0])
        ahead = u[1 : first + 1] + (u[-1] - u[0])
        u, inside = np.concatenate([u[first:], ahead]), np.concatenate([inside[first:], inside[1 : first + 1]])
    edges = np.flatnonzero(np.diff(np.concatenate([[0], inside.astype(np.int8), [0]])))
    return [Arc(u[a:b]) for a, b in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True) if b - a > 1]


def _check_number(robot: CoupledRobot, number: float) -> None:
    """Raise InputError for more choices than are looked at."""
    if number > MOST:
        raise InputError(
            f"the limits of {robot.name} allow more than {MOST} turns of its drives, expected narrower ones"
        )
