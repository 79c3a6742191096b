"""The elimination on a given arm: which splits serve, how many complex solutions the arm has, which were found.

Each of the twelve splits of `raghavan_roth` is right, but on an arm whose axes are parallel or meet most of them have
equations that say nothing, and others fail where a joint is at a round angle. Rather than by reasoning about the
geometry, splits are chosen by trying them on poses of the arm itself, round ones among them, and counting.

What is counted. Over the complex numbers an arm has the same number N of solutions at almost every pose, and at no
pose more isolated ones (A. P. Morgan, A. J. Sommese, "Coefficient-parameter polynomial continuation", Applied
Mathematics and Computation 29, 1989). So a pose at which N distinct regular solutions were found, real and complex,
has no other. Where fewer were found something is singular, or the split has lost some: the pose is doubtful.

Where an arm is singular, roots coincide for a reason that no split removes. Links that are wrong by a trifle separate
them; Newton's steps on the true loop then make up for the trifle.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from robokin.arrays import Array, Complex, Flags, Index
from robokin.inverse.elimination.complex_newton import complex_refine, on_the_way_out, regular_and_distinct
from robokin.inverse.elimination.loop import Candidates, Loop
from robokin.inverse.elimination.loop_newton import closing_at, refine
from robokin.inverse.elimination.native_elimination import candidates_at
from robokin.inverse.elimination.raghavan_roth import PERTURBATION, SHIFT, SPLITS, STEEPEST, Elimination
from robokin.kernel.facts import fact

__all__ = [
    "SPLITS",
    "Counted",
    "Elimination",
    "choose_splits",
    "count_solutions",
    "elimination_of",
    "generic_count",
    "rescue_candidates",
]


ORDER = (1, 10, 4, 7, 0, 9, 3, 6, 2, 11, 5, 8)
"""Splits in the order in which they are tried: split 1 serves nine in ten of the arms on sale that have no wrist."""

GENERIC, ROUND = 4, 10
"""Random poses on which a split is tried, and poses whose angles are multiples of 30°, where splits differ."""

WORTH = 0.5
"""A split that finds less than this part of what the best one finds at random poses is no use at any other."""

COUNTING = 3
"""Splits whose solutions together make N."""

REAL = 1e-7
"""Imaginary parts [rad | size] below which a refined solution is real."""

STEPS = 2
"""Newton steps on each of an elimination's solutions, which are good to 1e-9 in 99 % of the cases."""


class Counted(NamedTuple):
    """The number (m,) of distinct regular complex solutions of each target, and the candidates they are among.

    target: (s,) of each candidate; values: (s, 6) complex and refined; kept: (s,) which of them are solutions, regular,
    and each but once.
    """

    number: Index
    target: Index
    values: Complex
    kept: Flags


def count_solutions(loop: Loop, closing: Array, parts: Sequence[tuple[Index, NDArray[Any]]], steps: int) -> Counted:
    """Counts solutions among candidates (index, values), real and complex; of a conjugate pair one counts for both."""
    index = np.concatenate([part[0] for part in parts])
    values = np.concatenate([np.asarray(part[1], dtype=np.complex128) for part in parts])
    values, residual = complex_refine(loop, closing, index, values, steps)
    residual[np.any(np.abs(values.imag[:, loop.revolute]) > STEEPEST, axis=1)] = np.inf
    residual[on_the_way_out(loop, closing, index, values, residual)] = np.inf
    # Of a pair the one with the greater imaginary part in the first joint that has any stands for both.
    side = np.sign(np.where(np.abs(values.imag) > REAL, values.imag, 0.0))
    first = side[np.arange(len(side)), np.argmax(side != 0.0, axis=1)]
    values = np.where(first[:, None] < 0.0, values.conj(), values)
    kept = regular_and_distinct(loop, index, values, residual)
    weight = np.where(first == 0.0, 1, 2) * kept
    return Counted(np.bincount(index, weights=weight, minlength=len(closing)).astype(np.intp), index, values, kept)


def trial_poses(loop: Loop) -> tuple[Array, Array]:
    """Random joint values (GENERIC, 6), and round ones (ROUND, 6): multiples of 30°, or of a quarter of the size."""
    spans = np.where(loop.revolute, np.pi, 1.0)
    rng = np.random.default_rng(7)
    generic = rng.uniform(-spans, spans, (GENERIC, 6))
    grid = np.where(loop.revolute, np.pi / 6.0, 0.25)
    return generic, grid * np.round(rng.uniform(-spans, spans, (ROUND, 6)) / grid)


def choose_splits(loop: Loop, values: Array | None = None) -> list[int]:
    """The splits that find solutions of a loop, best first; none if there are none.

    They are tried on poses of the arm itself, or on those of joint values (k, 6) [rad | size], and the complex
    solutions are counted. Splits of the perturbed loop are tried, too, where no other finds the same number at nearly
    every random pose: what such a split finds is left to rounding.
    """
    generic, round_ = trial_poses(loop)
    generic = generic if values is None else values
    closing = closing_at(loop, np.concatenate([generic, round_]))
    numbers: dict[int, Index] = {}
    for splits in (ORDER, tuple(SPLITS + split for split in ORDER)):
        numbers |= {split: _numbers_of_split(loop, split, closing, len(generic)) for split in splits}
        found = {split: number[: len(generic)] for split, number in numbers.items()}
        most = max(int(number.max()) for number in found.values())
        if most and any(np.sum(number == most) >= len(generic) - 1 for number in found.values()):
            break
    best = max(int(number.sum()) for number in found.values())
    good = [split for split, number in found.items() if 0 < best * WORTH <= number.sum()]
    more = {split: (GENERIC - 1) * int(found[split].sum()) + int(numbers[split].sum()) for split in good}
    return sorted(good, key=lambda split: -more[split])


def _numbers_of_split(loop: Loop, split: int, closing: Array, generic: int) -> Index:
    """How many distinct regular complex solutions a split finds for each of some targets, L6 (m, 4, 4).

    The first `generic` ones are asked for alone where the others cannot be solved.
    """
    numbers = np.zeros(len(closing), dtype=np.intp)
    for some in (closing, closing[:generic]):
        try:
            real, complex_ = elimination_of(loop, split).all_candidates(some)
        except np.linalg.LinAlgError:
            continue
        parts = [(real.index, real.values), (complex_.index, complex_.values)]
        numbers[: len(some)] = count_solutions(loop, some, parts, STEPS + 2 * (split >= SPLITS)).number
        break
    return numbers


def elimination_of(loop: Loop, split: int, shift: float = SHIFT, perturbation: float = PERTURBATION) -> Elimination:
    """The elimination of a loop by one split, made when first asked for. Raises LinAlgError where there is none."""
    return _elimination(loop, split, shift, perturbation)


@fact
def _elimination(loop: Loop, split: int, shift: float, perturbation: float) -> Elimination:
    return Elimination(loop, split, shift, perturbation)


def generic_count(loop: Loop, splits: list[int]) -> int | None:
    """N, the number of complex solutions at a random pose, as some splits find them together.

    None where it is odd, or no two random poses agree on it: the number cannot be told in this way.
    """
    closing = closing_at(loop, trial_poses(loop)[0])
    parts = []
    for split in splits[:COUNTING]:
        try:
            found = elimination_of(loop, split).all_candidates(closing)
        except np.linalg.LinAlgError:
            continue
        parts += [(part.index, part.values) for part in found]
    if not parts:
        return None
    counts = count_solutions(loop, closing, parts, STEPS + 2).number
    most = int(counts.max())
    return most if most and most % 2 == 0 and np.sum(counts == most) > 1 else None


RESCUES = ((0, 2.3, 0.0), (1, SHIFT, 0.0), (0, SHIFT, 1e-6), (0, SHIFT, 1e-4), (1, 2.3, 1e-5), (1, SHIFT, 1e-3))
"""What else is tried for a doubtful pose: the best or the second split, its shift, the links' errors."""

RESCUE_STEPS = 20
"""Newton steps from there: near a double solution each but halves the error."""

RESCUED = 1e-7
"""A candidate that closes no better [size and rad] after these steps leads nowhere."""


def rescue_candidates(loop: Loop, splits: list[int], closing: Array) -> Candidates:
    """Candidates for doubtful poses L6 (m, 4, 4), found in several ways and refined on the true loop.

    Other splits and shifts go round roots at infinity and ones that coincide by chance, perturbed links round ones
    that coincide at the pose for good.
    """
    parts = []
    for which, shift, perturbation in RESCUES:
        split = splits[min(which, len(splits) - 1)]
        if perturbation:
            split = split % SPLITS + SPLITS
        try:
            solver = elimination_of(loop, split, shift, perturbation or PERTURBATION)
            parts.append(candidates_at(solver, loop, closing, complex_too=False)[0])
        except np.linalg.LinAlgError:
            continue
    if not parts:
        return Candidates(np.empty(0, dtype=np.intp), np.empty((0, 6)))
    index = np.concatenate([part.index for part in parts])
    values = np.concatenate([part.values for part in parts])
    values, position, angle = refine(loop, closing, index, values, RESCUE_STEPS)
    closes = (position < RESCUED) & (angle < RESCUED)
    return Candidates(index[closes], values[closes])
