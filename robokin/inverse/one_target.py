"""The answer for one pose of six turning joints, without blocks.

Statement. Give what the blocks of `solve_many` give for one target, in a tenth of the time: their arrays hold thousands
of targets, and for one the interpreter's share is all.
Derivation. Candidates by straight-line code (`straight_forms`), or by elimination where an arm has no closed form, each
proven by straight-line forward kinematics (`straight_line`); angles, order, limits and counts by the rules of `verify`,
`window` and `target_block`, number by number.
Degenerate case. Whatever is not plain is left to the blocks (None): a candidate that wants a polish, equal solutions,
an odd number of them or none, one right beside the limits, a singular one where two are near to each other or one is a
trifle outside the limits, a pose that is not rigid to the last digits.
"""

from __future__ import annotations

import math
from itertools import combinations, pairwise
from operator import itemgetter
from typing import Any

import numpy as np

from robokin.arrays import Array
from robokin.inverse.elimination.complex_newton import SURE
from robokin.inverse.elimination.loop import Loop
from robokin.inverse.elimination.one_elimination import all_solutions
from robokin.inverse.one_answer import OneAnswer
from robokin.inverse.one_target_arm import OneTargetArm
from robokin.inverse.self_motion.onto_limits import BESIDE
from robokin.inverse.self_motion.root_neighbours import NEIGHBOURS
from robokin.inverse.verify import (
    CLOSE,
    CLOSES,
    EXACT_ENOUGH,
    HALF_TURN,
    KEY_CELLS,
    OFF_CENTRE,
    SAME,
)  # fmt: skip
from robokin.inverse.window import SINGULAR, TOLD_APART, nearly_singular
from robokin.kernel.native_kernel import native
from robokin.spatial.angles import TURN
from robokin.spatial.rigid_poses import CLEAN, LAST_ROW
from robokin.spatial.transforms import FARTHEST

BOTTOM = [0.0, 0.0, 0.0, 1.0]

FIRST_CELLS, CELLS = (int(cells) for cells in KEY_CELLS[:2])
HALF_FIRST, HALF = 0.5 * (FIRST_CELLS - 1), 0.5 * (CELLS - 1)
FIRST_EDGE, EDGE = HALF_FIRST + OFF_CENTRE, HALF + OFF_CENTRE
"""The cells of the first joint and of each of the next three, half of them, and that moved off the cells' edges."""

W1, W2, W3, W4, W5, W6 = (1.0 + math.modf(k * 0.6180339887498949)[0] for k in range(1, 7))
"""Weights of |q| by which equal configurations are found."""

PI = math.pi

LEAST = HALF_TURN - PI
"""Angles below this count as 180°."""

Told = tuple[int, float, list[float], float, float]
"""The key for the order, the sum that tells configurations apart, joint values, distance and angle."""

Proven = tuple[int, list[Told]]
"""How many candidates there were; those that are solutions."""

KernelSolution = tuple[Array, Array, int, int, float]
"""The table of an answer, its target, how many candidates there were, how many are within the limits, and how many
configurations those are equivalent to: see `OneAnswer`."""


def plain_pose(T: Any) -> bool:
    """Whether something is a pose (4, 4) [m] as the blocks take it: an array that is rigid to the last digits."""
    if type(T) is not np.ndarray or T.shape != (4, 4) or T.dtype != np.float64:
        return False
    if native is not None:
        rigid: bool = native.rigid(T)
        return rigid
    (a, b, c, x), (d, e, f, y), (g, h, i, z), bottom = T.tolist()
    error = max(
        abs(a * a + d * d + g * g - 1.0), abs(b * b + e * e + h * h - 1.0), abs(c * c + f * f + i * i - 1.0),
        abs(a * b + d * e + g * h), abs(b * c + e * f + h * i), abs(c * a + f * d + i * g),
    )  # fmt: skip
    determinant = (d * h - g * e) * c + (g * b - a * h) * f + (a * e - d * b) * i
    # What is no number is not within any bounds.
    near = -FARTHEST <= x <= FARTHEST and -FARTHEST <= y <= FARTHEST and -FARTHEST <= z <= FARTHEST
    last = bottom == BOTTOM or all(abs(entry - wish) <= LAST_ROW for entry, wish in zip(bottom, BOTTOM, strict=True))
    return bool(error <= CLEAN and determinant > 0.0 and near and last)


def solve_one(
    arm: OneTargetArm, T: Array, limits: bool, most: int | None, near: Array | None = None
) -> OneAnswer | None:
    """The answer for a target T (4, 4) [m] and a wish near (6,) [rad], or None where it is left to the blocks."""
    if near is not None and not (limits or arm.robot.within_limits(near)):
        return None
    if native is not None and arm.kernel is not None:
        known = native.solution(arm.kernel, T, limits, near, arm.elimination)
        if known is None:
            return None
        return kernel_answer(arm, known, limits, most, near)
    closing = _closing(arm.loop, T)[None]
    target = T[:3].T.ravel().tolist()
    proven = _by_closed_form(arm, closing, target) if arm.form is not None else _by_elimination(arm, closing, target)
    if proven is None or not proven[1] or len(proven[1]) % 2:
        return None
    tried, found = proven
    found.sort(key=itemgetter(0))
    if any(one[0] == other[0] for one, other in pairwise(found)):
        return None
    sums = sorted([total for _, total, _, _, _ in found])
    # Two may be equal, or about to meet.
    doubt = any(after - before < CLOSE for before, after in pairwise(sums))
    if doubt and any(_same(one[2], other[2]) for one, other in combinations(found, 2)):
        return None
    every = [q for _, _, q, _, _ in found]
    position, angle = [one[3] for one in found], [one[4] for one in found]
    wish = None if near is None else near.tolist()
    inside = [_into_limits(arm, q, wish) for q in every]
    if limits and not all(inside):
        for q in [q for q, fits in zip(every, inside, strict=True) if not fits]:
            if not _outside(arm, q, 2.0 * NEIGHBOURS):
                # It may stand for one inside: of an arm that is not singular there only where it is beside the limit.
                if not _outside(arm, q, 2.0 * BESIDE):
                    return None
                doubt = True
    if doubt and _singular(arm, every, position, angle):
        return None
    flat = [number for q, *rest in zip(every, position, angle, inside, strict=True) for number in (*q, *rest)]
    table = np.array(flat, dtype=np.float64).reshape(-1, 9)
    return OneAnswer(arm, np.array(T), tried, table, limits, most, near, sum(inside), None)


def kernel_answer(
    arm: OneTargetArm, known: KernelSolution, limits: bool, most: int | None, near: Array | None
) -> OneAnswer:
    """The answer that the native kernel's `solution` is, for the limits and the wish that it was asked with."""
    table, T, tried, inside, turns = known
    return OneAnswer(arm, T, tried, table, limits, most, near, inside, int(turns))


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
    return len(leaves), [_told(q, *error) for q, error in zip(rows, off, strict=True)]


def _by_elimination(arm: OneTargetArm, closing: Array, target: list[float]) -> Proven | None:
    """The configurations of the elimination's real roots, or None where not all N complex solutions are among them."""
    assert arm.analysis.number is not None
    found = all_solutions(arm.analysis.solver.first, arm.loop, closing, arm.analysis.number)
    if found is None:
        return None
    rows = (found[1] - arm.offsets).tolist()
    off = arm.residuals(rows, target)
    if not all(position <= CLOSES * arm.size and angle <= CLOSES for position, angle in off):
        return None
    return found[0], [_told(q, *error) for q, error in zip(rows, off, strict=True)]


def _told(values: list[float], position: float, angle: float) -> Told:
    """A configuration with its angles in (-π, π] as `verify.distinct` has them, its key and its weighted sum."""
    q = [value + 0.0 if LEAST <= value <= PI else _wrapped(value) for value in values]  # of -0 that is 0
    a, b, c, d, e, f = q
    key = round(a / PI * HALF_FIRST + FIRST_EDGE) * CELLS
    key = (((key + round(b / PI * HALF + EDGE)) * CELLS) + round(c / PI * HALF + EDGE)) * CELLS
    total = W1 * abs(a) + W2 * abs(b) + W3 * abs(c) + W4 * abs(d) + W5 * abs(e) + W6 * abs(f)
    return key + round(d / PI * HALF + EDGE), total / PI, q, position, angle


def _wrapped(value: float) -> float:
    if not -math.pi <= value <= math.pi:
        value += round(value * (0.5 / math.pi)) * (-2.0 * math.pi)
    return value + 0.0 if value >= LEAST else value + 2.0 * math.pi


def _into_limits(arm: OneTargetArm, q: list[float], wish: list[float] | None) -> bool:
    """Turn the angles of q by full turns next to the wish, and into the limits where that can be; whether all are."""
    inside = True
    if wish is not None:
        q[:] = [value + TURN * round((near - value) / TURN) for value, near in zip(q, wish, strict=True)]
    for joint, low, high, beyond in arm.bounds:
        value = q[joint]
        if low <= value <= high:
            continue
        fits = False
        if beyond or wish is not None:
            least, most = np.ceil((low - value) / TURN), np.floor((high - value) / TURN)
            if least <= most:
                value += TURN * min(max(0.0, least), most)
                fits = low <= value <= high
                q[joint] = float(value)
        inside = inside and fits
    return bool(inside)  # of numbers of numpy it is one of its own


def _outside(arm: OneTargetArm, q: list[float], least: float) -> bool:
    """Whether some angle of q is farther outside its limits than `least` [rad], full turns not counted."""
    for joint, low, high, _ in arm.bounds:
        value = q[joint]
        # An end that is infinite is none to be near to.
        if not low <= value <= high and not (
            (abs(low) < math.inf and abs(math.remainder(value - low, TURN)) <= least)
            or (abs(high) < math.inf and abs(math.remainder(value - high, TURN)) <= least)
        ):
            return True
    return False


def _same(one: list[float], other: list[float]) -> bool:
    """Whether two configurations may be one."""
    return all(abs(math.remainder(a - b, TURN)) <= 10.0 * SAME for a, b in zip(one, other, strict=True))


def _singular(arm: OneTargetArm, every: list[list[float]], position: list[float], angle: list[float]) -> bool:
    """Whether the arm may be singular at one of some solutions, as the blocks have it."""
    analysis = arm.analysis
    assert analysis.six is not None
    off = np.maximum(np.array(position) / arm.size, angle)
    least = TOLD_APART if arm.form is not None and len(every) == analysis.number else SINGULAR
    below = np.maximum(least, np.sqrt(off / SURE))
    return bool(nearly_singular(analysis.six.chain, np.array(every), arm.size, below).any())
