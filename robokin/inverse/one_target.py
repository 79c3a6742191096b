"""The answer for one pose of six turning joints, without blocks.

Statement. Give what the blocks of `solve_many` give for one target, in a tenth of the time: their arrays hold thousands
of targets, and for one the interpreter's share is all.
Derivation. Candidates by straight-line code (`straight_forms`), or by elimination where an arm has no closed form, each
proven by straight-line forward kinematics (`straight_line`); angles, order, limits and counts by the rules of `verify`,
`window` and `target_block`, number by number.
Degenerate case. Whatever is not plain is left to the blocks (None): a candidate that wants a polish, two solutions near
to each other, an odd number of them or none, one a trifle outside the limits, a pose that is not rigid to the last
digits.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import partial
from itertools import pairwise
from operator import itemgetter
from typing import Any

import numpy as np

from robokin.arrays import Array
from robokin.inverse.analysis import Analysis, General, analysis_of
from robokin.inverse.claims import BASES, COUNTED, Claims
from robokin.inverse.closed_form.straight_forms import StraightForm, straight_form
from robokin.inverse.elimination.loop import ComplexCandidates, Loop
from robokin.inverse.elimination.loop_newton import refine
from robokin.inverse.full_turns import turning
from robokin.inverse.self_motion.root_neighbours import NEIGHBOURS
from robokin.inverse.solution_names import listed_names
from robokin.inverse.solutions import Question, Result, named_later
from robokin.inverse.verify import (
    CLOSE,
    CLOSES,
    EXACT_ENOUGH,
    HALF_TURN,
    KEY_CELLS,
    NEWTON_STEPS,
    OFF_CENTRE,
    Found,
)  # fmt: skip
from robokin.inverse.window import ROUNDED, complex_count
from robokin.kernel.facts import fact
from robokin.kernel.frames import program_to_tool
from robokin.kernel.straight_line import StraightResiduals, straight_residuals
from robokin.model import Robot
from robokin.model.robot import LIMIT_TOLERANCE, tolerated
from robokin.spatial.angles import TURN
from robokin.spatial.transforms import FARTHEST

RIGID = 1e-14
"""Error of a rotation that is rounding: of a greater one the nearest rotation is taken."""

BOTTOM = 1e-9
"""How far the last row of a target may be from 0 0 0 1."""

LAST_ROW = (0.0, 0.0, 0.0, 1.0)

FIRST_CELLS, CELLS = (int(cells) for cells in KEY_CELLS[:2])
HALF_FIRST, HALF = 0.5 * (FIRST_CELLS - 1), 0.5 * (CELLS - 1)
FIRST_EDGE, EDGE = HALF_FIRST + OFF_CENTRE, HALF + OFF_CENTRE
"""The cells of the first joint and of each of the next three, half of them, and that moved off the cells' edges."""

W1, W2, W3, W4, W5, W6 = (1.0 + math.modf(k * 0.6180339887498949)[0] for k in range(1, 7))
"""Weights of |q| by which equal configurations are found."""

LEAST = HALF_TURN - math.pi
"""Angles below this count as 180°."""

Told = tuple[int, float, list[float], float, float]
"""The key for the order, the sum that tells configurations apart, joint values, distance and angle."""

Proven = tuple[int, list[Told], ComplexCandidates | None]
"""How many candidates there were; those that close; the complex ones where they are to be counted."""


@dataclass(frozen=True, eq=False)
class _Bounds:
    """A joint's limits as they count: low, high [rad], and whether a full turn may bring an angle into them."""

    joint: int
    low: float
    high: float
    beyond: bool


@dataclass(frozen=True, eq=False)
class OneTargetArm:
    """What is known of an arm of six turning joints.

    form: the code of its closed form, None where elimination solves it; offsets: (6) [rad]; size [m]; bounds: the
    limits of joints that have some; turning: joint, low and high of those that may stand a full turn on within their
    limits.
    """

    robot: Robot
    analysis: Analysis
    form: StraightForm | None
    residuals: StraightResiduals
    loop: Loop
    offsets: tuple[float, ...]
    size: float
    bounds: tuple[_Bounds, ...]
    turning: tuple[tuple[int, float, float], ...]


@fact
def one_target_arm(robot: Robot) -> OneTargetArm | None:
    """What is known of a robot; None for one that blocks are left to solve."""
    if type(robot) is not Robot or robot.n != 6 or not robot.revolute.all():
        return None
    analysis = analysis_of(robot)
    if analysis.six is None or analysis.loop is None or not analysis.complete or analysis.redundancy:
        return None
    chain = analysis.six.chain
    general = isinstance(analysis.solver, General)
    form, residuals = straight_form(analysis.solver), straight_residuals(program_to_tool(chain))
    if residuals is None or analysis.six.virtual or analysis.number is None or not (general or form is not None):
        return None
    low, high = tolerated(robot.limits)
    bounds = tuple(
        _Bounds(i, float(low[i]), float(high[i]), bool(low[i] < -np.pi or high[i] > np.pi))
        for i in np.flatnonzero(np.isfinite(robot.limits).any(axis=1)).tolist()
    )
    wide = [(i, *robot.limits[i].tolist()) for i in turning(robot)]
    whole = tuple(
        (i, low - LIMIT_TOLERANCE, high + LIMIT_TOLERANCE)
        for i, low, high in wide
        if high - low + 4.0 * LIMIT_TOLERANCE >= TURN
    )
    offsets = tuple(chain.offsets.tolist())
    return OneTargetArm(robot, analysis, form, residuals, analysis.loop, offsets, analysis.size, bounds, whole)


@dataclass(eq=False)
class OneAnswer:
    """The solutions for one target, in lists.

    tried: how many candidates there were; every: all solutions, their angles turned into the limits; inside: whether
    each is within them; position, angle: what each lacks [m, rad]; rows: which are listed; within: how many were,
    before the list was cut.
    """

    arm: OneTargetArm
    tried: int
    every: list[list[float]]
    inside: list[bool]
    position: list[float]
    angle: list[float]
    rows: list[int] = field(default_factory=list)
    within: int = 0

    def result(self, question: Question) -> Result:
        """The answer for a question."""
        rows, limits = self.rows, question.limits
        everything = np.array(self.every)
        q = everything[rows]
        names = _Names(self.arm.robot, q, everything)
        solutions = tuple(
            named_later(partial(names.name, k), q[k], self.inside[row], self.position[row], self.angle[row], ())
            for k, row in enumerate(rows)
        )
        count, analysis = len(self.every), self.arm.analysis
        complete = self.within == len(rows)
        counts = {"found": self.tried, "duplicates": 0, "closing": count}
        if limits:
            counts["within_limits"] = self.within
        counts["listed"] = len(rows)
        if limits:
            counts["turns"] = sum(_equivalents(self.arm, self.every[row]) for row in rows)
        claims = Claims(np.full(1, COUNTED, dtype=np.int8), analysis.number, np.array([count]))
        claims.branches = self.arm.form is not None
        return Result(
            solutions, complete, analysis.method, counts=counts, postures=complete,
            basis=BASES[COUNTED] if complete else None, certificate=claims.sentence(0), all_known=True,
            question=question,
        )  # fmt: skip


class _Names:
    """The names of the listed solutions q (k, 6) among all (m, 6), which are found when one is asked for."""

    def __init__(self, robot: Robot, q: Array, every: Array) -> None:
        self.asked: tuple[Robot, Array, Array] = robot, q, every
        self.known: list[str] | None = None

    def name(self, k: int) -> str:
        """The name of solution k."""
        if self.known is None:
            robot, q, every = self.asked
            index = np.zeros(len(every), dtype=np.intp)
            self.known = listed_names(robot, q, index[: len(q)], (every, index))
        return self.known[k]


def plain_pose(T: Any) -> bool:
    """Whether something is a pose (4, 4) [m] as the blocks take it: an array that is rigid to the last digits."""
    if type(T) is not np.ndarray or T.shape != (4, 4) or T.dtype != np.float64:
        return False
    (a, b, c, x), (d, e, f, y), (g, h, i, z), bottom = T.tolist()
    error = max(
        abs(a * a + d * d + g * g - 1.0), abs(b * b + e * e + h * h - 1.0), abs(c * c + f * f + i * i - 1.0),
        abs(a * b + d * e + g * h), abs(b * c + e * f + h * i), abs(c * a + f * d + i * g),
    )  # fmt: skip
    determinant = (d * h - g * e) * c + (g * b - a * h) * f + (a * e - d * b) * i
    # What is no number is not within any bounds.
    near = -FARTHEST <= x <= FARTHEST and -FARTHEST <= y <= FARTHEST and -FARTHEST <= z <= FARTHEST
    last = all(abs(entry - wish) <= BOTTOM for entry, wish in zip(bottom, LAST_ROW, strict=True))
    return bool(error <= RIGID and determinant > 0.0 and near and last)


def solve_one(
    arm: OneTargetArm, T: Array, limits: bool, most: int | None, near: Array | None = None
) -> OneAnswer | None:
    """The answer for a target T (4, 4) [m] and a wish near (6,) [rad], or None where it is left to the blocks."""
    if near is not None and not (limits or arm.robot.within_limits(near)):
        return None
    closing = _closing(arm.loop, T)[None]
    target = T[:3].T.ravel().tolist()
    proven = _by_closed_form(arm, closing, target) if arm.form is not None else _by_elimination(arm, closing, target)
    if proven is None or not proven[1] or len(proven[1]) % 2:
        return None
    tried, found, imaginary = proven
    sums = sorted([total for _, total, _, _, _ in found])
    if any(after - before < CLOSE for before, after in pairwise(sums)):
        return None  # two may be equal, or about to meet
    found.sort(key=itemgetter(0))
    if any(one[0] == other[0] for one, other in pairwise(found)):
        return None
    every = [q for _, _, q, _, _ in found]
    position, angle = [one[3] for one in found], [one[4] for one in found]
    if imaginary is not None:
        listed = Found(np.zeros(len(found), dtype=np.intp), np.array(every), np.array(position), np.array(angle))
        if complex_count(arm.analysis, closing, listed, imaginary)[0] != arm.analysis.number:
            return None
    wish = None if near is None else near.tolist()
    inside = [_into_limits(arm, q, wish) for q in every]
    rows = list(range(len(every)))
    if limits:
        if not all(within or _well_outside(arm, q) for within, q in zip(inside, every, strict=True)):
            return None
        rows = [row for row in rows if inside[row]]
        if not rows:
            return None
    if wish is not None:
        rows.sort(key=[max(abs(a - b) for a, b in zip(q, wish, strict=True)) for q in every].__getitem__)
    answer = OneAnswer(arm, tried, every, inside, position, angle)
    answer.rows, answer.within = rows if most is None else rows[:most], len(rows)
    return answer


def _closing(loop: Loop, T: Array) -> Array:
    """L6 (4, 4) for a target: `Loop.closing` for one."""
    R = T[:3, :3].T
    inverse = np.zeros((4, 4))
    inverse[:3, :3], inverse[3, 3] = R, 1.0
    inverse[:3, 3:] = -(R @ (T[:3, 3:] / loop.size))
    return loop.last @ inverse @ loop.first


def _by_closed_form(arm: OneTargetArm, closing: Array, target: list[float]) -> Proven | None:
    """The configurations of all real roots, or None where one is not exact."""
    assert arm.form is not None
    leaves = arm.form(closing[0, :3].ravel().tolist())
    if leaves is None:
        return None
    size, rows = (
        arm.size,
        [[value - offset for value, offset in zip(leaf, arm.offsets, strict=True)] for leaf in leaves],
    )
    off = arm.residuals(rows, target)
    if not all(position / size <= EXACT_ENOUGH and angle <= EXACT_ENOUGH for position, angle in off):
        return None
    return len(leaves), [_told(q, *error) for q, error in zip(rows, off, strict=True)], None


def _by_elimination(arm: OneTargetArm, closing: Array, target: list[float]) -> Proven | None:
    """The configurations of the eliminations' real roots that close, polished, and the complex roots."""
    candidates, imaginary = arm.analysis.solver.first.all_candidates(closing)
    size, offsets = arm.size, np.array(arm.offsets)
    rows = (candidates.values - offsets).tolist()
    found = []
    off = arm.residuals(rows, target)
    rough = [k for k, (position, angle) in enumerate(off) if not (position / size <= ROUNDED and angle <= ROUNDED)]
    if rough:
        index = np.zeros(len(rough), dtype=np.intp)
        polished, _, _ = refine(arm.loop, closing, index, candidates.values[rough], NEWTON_STEPS)
        if not np.isfinite(polished).all():
            return None
        better = (polished - offsets).tolist()
        for k, q, error in zip(rough, better, arm.residuals(better, target), strict=True):
            rows[k], off[k] = q, error
    for row, (position, angle) in zip(rows, off, strict=True):
        if position <= CLOSES * size and angle <= CLOSES:
            found.append(_told(row, position, angle))
    return len(rows), found, imaginary


def _told(values: list[float], position: float, angle: float) -> Told:
    """A configuration with its angles in (-π, π] as `verify.distinct` has them, its key and its weighted sum."""
    if min(values) >= LEAST and max(values) <= math.pi:
        q = [value + 0.0 for value in values]  # of -0 that is 0
    else:
        q = [_wrapped(value) for value in values]
    a, b, c, d, e, f = q
    key = round(a / math.pi * HALF_FIRST + FIRST_EDGE) * CELLS
    key = (((key + round(b / math.pi * HALF + EDGE)) * CELLS) + round(c / math.pi * HALF + EDGE)) * CELLS
    total = W1 * abs(a) + W2 * abs(b) + W3 * abs(c) + W4 * abs(d) + W5 * abs(e) + W6 * abs(f)
    return key + round(d / math.pi * HALF + EDGE), total / math.pi, q, position, angle


def _wrapped(value: float) -> float:
    if not -math.pi <= value <= math.pi:
        value += round(value * (0.5 / math.pi)) * (-2.0 * math.pi)
    return value + 0.0 if value >= LEAST else value + 2.0 * math.pi


def _into_limits(arm: OneTargetArm, q: list[float], wish: list[float] | None) -> bool:
    """Turn the angles of q by full turns next to the wish, and into the limits where that can be; whether all are."""
    inside = True
    if wish is not None:
        q[:] = [value + TURN * round((near - value) / TURN) for value, near in zip(q, wish, strict=True)]
    for bounds in arm.bounds:
        value = q[bounds.joint]
        fits = bounds.low <= value <= bounds.high
        if not fits and (bounds.beyond or wish is not None):
            least = np.ceil((bounds.low - value) / TURN)
            most = np.floor((bounds.high - value) / TURN)
            if least <= most:
                value += TURN * min(max(0.0, least), most)
                fits = bounds.low <= value <= bounds.high
                q[bounds.joint] = float(value)
        inside = inside and fits
    return inside


def _well_outside(arm: OneTargetArm, q: list[float]) -> bool:
    """Whether some angle is farther outside its limits than what may stand for a solution inside."""
    for bounds in arm.bounds:
        value = q[bounds.joint]
        if not bounds.low <= value <= bounds.high:
            away = min(
                abs(math.remainder(value - end, TURN)) for end in (bounds.low, bounds.high) if abs(end) < math.inf
            )
            if away > 2.0 * NEIGHBOURS:
                return True
    return False


def _equivalents(arm: OneTargetArm, q: list[float]) -> int:
    """How many configurations within the limits q is equivalent to, itself included."""
    count = 1
    for joint, low, high in arm.turning:
        least = min(math.ceil((low - q[joint]) / TURN), 0)
        count *= max(math.floor((high - q[joint]) / TURN), 0) - least + 1
    return count
