"""A second look at doubtful targets: solutions sought in several other ways, and what then may be said of them.

Statement. For targets at which an arm is singular, or at which its solver may have lost solutions (`window`), find all.
Ways, each from the solver's own algebra or none of it:
- Next door. The solver is asked for poses a trifle away in several directions, where it is regular, and what it finds
  is brought to the target by Newton's steps.
- For an arm of fewer than six joints other added joints: turns about skew axes, with which the loop is that of a
  general arm (`skew`).
- A homotopy from targets close by or complex ones, which accounts for all N solutions of the loop (`homotopy`).
- Where it does not, other splits of the elimination and links that are wrong by a trifle (`elimination`).
What is said. If N distinct regular complex solutions are shown there is no other: counted. If all paths of the homotopy
ended, from two independent starts alike, they are accounted for. Else there may be more.
"""

from __future__ import annotations

from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from robokin.arrays import Array, Flags, Index
from robokin.inverse.analysis import Analysis, General
from robokin.inverse.claims import ACCOUNTED, COUNTED, NOTHING, Claims
from robokin.inverse.elimination.complex_newton import regular
from robokin.inverse.elimination.homotopy import Homotopy
from robokin.inverse.elimination.loop import Candidates, ComplexCandidates, Loop
from robokin.inverse.elimination.loop_newton import closing_at, refine
from robokin.inverse.elimination.monodromy import Known
from robokin.inverse.elimination.neighbours import NEARLY, STEPS, half_turns, next_door, other_ways
from robokin.inverse.elimination.skew import Skew
from robokin.inverse.elimination.splits import REAL, count_solutions
from robokin.inverse.elimination.starts_close_by import CloseBy
from robokin.inverse.numeric.least_squares import descend
from robokin.inverse.self_motion.chosen_members import SelfMotion
from robokin.inverse.self_motion.more_motions import listed_with_more
from robokin.inverse.verify import CLOSES, Found, distinct, merged
from robokin.kernel.chain import Chain
from robokin.kernel.damped_newton import limited
from robokin.kernel.facts import fact
from robokin.kernel.native_kernel import handle, native
from robokin.kernel.residual import distance_and_angle, error_and_jacobian

FINE = 6
"""Steps by singular values thereafter: next to singular poses normal equations lose half of the digits."""

EXACT, LONGEST = 1e-14, 0.1
"""Error [size and rad] at which they end, and the longest of them [rad | size]."""

LEAST = 1e-9
"""Singular values below this part of the greatest are left out of such a step: what the error has of their direction
is rounding."""

STANDS = 1e-2
"""An added joint nearer to zero [rad] in a solution of the loop may stand still, but for a double root's digits."""

AT_REST = 1e-7
"""An added joint nearer to zero [rad] in an exact solution of the loop stands still."""

SLIDES = "; with sliding joints there may be more at such a pose"
"""What is added to an account that does not end in regular solutions alone."""

POSES = 200
"""Random poses among which two are looked for at which all complex solutions are known."""


def look_again(
    analysis: Analysis, T: Array, found: Found, rest: Array, limits: Array, near: Array | None, few: Flags
) -> tuple[Found, Claims]:
    """All solutions q: (s, window) of targets T: (m, 4, 4) of which some are known, and what may be said of them.

    rest: (window,) where a joint that is free is put; limits: (window, 2); near: (window,) the wish for self-motions;
    few: (m,) at which targets a closed form's equations leave finitely many solutions, but for a wrist's self-motions.
    """
    assert analysis.six is not None
    own, other = analysis.own, _others_of(analysis)
    sought = _sought(analysis, other, T, near, few)
    index = np.concatenate([part[0] for part in sought.parts])
    q = np.concatenate([part[1] for part in sought.parts])
    found = merged(found, closing_at_last(own, T, index, q, analysis.size))
    closing = np.bincount(found.index, minlength=len(T))
    found = distinct(found, own.revolute, analysis.size)
    found, motions, unclear, beside = listed_with_more(
        own, analysis.solver, T, found, analysis.size, limits, rest, near, np.flatnonzero(sought.loose)
    )
    found = distinct(found, own.revolute, analysis.size)
    real = np.bincount(found.index, minlength=len(T))
    clear = real + beside == sought.expected
    sliding = not own.revolute.all()
    _withdraw(sought, [i for i in unclear.tolist() if i in motions or not clear[i]], motions, few | (not sliding))
    for i in np.flatnonzero(sought.basis == COUNTED) if other.skews else ():
        number = other.skews[0].number
        sought.words[int(i)] = (
            f"{number} of {number} complex solutions found of the arm with skew axes added, "
            f"{real[i]} real with these standing still"
        )
    claims = Claims(sought.basis, analysis.number, real, sought.words, motions)
    late = np.maximum(real - closing, 0)
    claims.candidates, claims.duplicates = np.bincount(index, minlength=len(T)) + late, closing + late - real
    return found, claims


class _Sought(NamedTuple):
    """Candidates for some targets, and what they prove.

    parts: pairs of targets (s,) and values (s, window); basis: (m,) what is proven of each target; words: of some, why;
    expected: (m,) how many solutions there are, where all N complex ones were told apart, else -1; loose: (m,) whether
    paths ended in singular solutions, and all did.
    """

    parts: list[tuple[Index, Array]]
    basis: NDArray[np.int8]
    words: dict[int, str]
    expected: Index
    loose: Flags


def _sought(analysis: Analysis, other: _Others, T: Array, near: Array | None, few: Flags) -> _Sought:
    """Solutions of targets sought next door, by skew axes, along paths and in other ways, until all are counted."""
    basis, words = np.zeros(len(T), dtype=np.int8), dict[int, str]()
    expected, loose = np.full(len(T), -1), np.zeros(len(T), dtype=bool)
    index, q, whole = next_door(analysis, T)
    parts = [(index, q)]
    basis[whole] = COUNTED
    if near is not None:
        parts.append(wished(analysis, T, near))
    for skew in other.skews:
        index, q, whole, standing = skewed(skew, T, analysis.own.n)
        parts.append((index, q))
        basis[whole], expected[whole] = COUNTED, standing[whole]
    open_ = np.flatnonzero(basis == NOTHING)
    if len(open_):
        ends, closed, words, expected[open_], loose[open_] = followed(other, T[open_], few[open_], analysis.own.n)
        still = (
            np.max(np.abs(half_turns(ends[1], other.chain.revolute)[:, analysis.own.n :]), axis=1, initial=0.0) < STANDS
        )
        parts.append((open_[ends[0][still]], ends[1][still, : analysis.own.n]))
        basis[open_[closed]] = ACCOUNTED
        words = {int(open_[i]): text for i, text in words.items()}
        open_ = open_[~closed]
        if len(open_):
            index, q = other_ways(analysis, T[open_])
            parts.append((open_[index], q))
    return _Sought(parts, basis, words, expected, loose)


def _withdraw(sought: _Sought, unclear: list[int], motions: dict[int, list[SelfMotion]], few: Flags) -> None:
    """Take back what is proven of targets of which solutions may not have been told apart, or sets not all followed.

    few: (m,) whether there cannot be more self-motions than those that paths lead to.
    """
    for i in unclear:
        sought.basis[i] = NOTHING
        sought.words[i] = "next to a singular pose: other solutions may be too near to one listed to be told apart"
    for i, sets in motions.items():
        if any(motion.curve.sheets for motion in sets):
            sought.basis[i] = NOTHING
            sought.words[i] = "a self-motion of more than one dimension: only curves on it were followed"
        elif not few[i]:
            # Of slides a self-motion may have pieces that no path and no neighbouring pose leads to.
            sought.basis[i], sought.words[i] = NOTHING, "self-motions with sliding joints: there may be more of them"


class _Others(NamedTuple):
    """What else can solve an arm: loops with skew axes, for fewer than six joints; a homotopy, and its loop's chain."""

    skews: tuple[Skew, ...]
    homotopy: Homotopy
    loop: Loop
    chain: Chain


@fact
def _others_of(analysis: Analysis) -> _Others:
    """The other ways to solve an arm, made when they are first asked for."""
    assert analysis.six is not None
    assert analysis.loop is not None
    if analysis.six.virtual:
        skews = tuple(Skew(analysis.own, seed) for seed in (40, 41))
        first = skews[0]
        beside = CloseBy(first.loop, first.solver, first.number)
        homotopy = Homotopy(first.loop, partial(known_of_skew, first), beside)
        return _Others(skews, homotopy, first.loop, first.six.chain)
    solver = analysis.solver
    known = partial(known_solutions, analysis.loop, solver, analysis.number)
    beside = CloseBy(analysis.loop, solver.first if isinstance(solver, General) else solver, analysis.number)
    return _Others((), Homotopy(analysis.loop, known, beside), analysis.loop, analysis.six.chain)


def wished(analysis: Analysis, T: Array, near: Array) -> tuple[Index, Array]:
    """The wish `near` (window,) for those of the targets T (m, 4, 4) that it nearly reaches."""
    off, _ = error_and_jacobian(analysis.own, T, np.tile(near, (len(T), 1)), analysis.size)
    index = np.flatnonzero(np.max(np.abs(off), axis=1) < NEARLY)
    return index, np.tile(near, (len(index), 1))


def skewed(skew: Skew, T: Array, own: int) -> tuple[Index, Array, Flags, Index]:
    """Configurations (s, own) at which the added axes nearly stand still, and for which targets none is missing.

    Also how many (m,) there are at which they stand still.
    """
    index, q, whole = skew.solutions(T)
    added = np.max(np.abs(half_turns(q[:, own:], np.ones(6 - own, dtype=bool))), axis=1)
    near = added < STANDS
    return index[near], q[near, :own], whole, np.bincount(index[added < AT_REST], minlength=len(T))


def followed(
    other: _Others, T: Array, few: Flags, own: int
) -> tuple[tuple[Index, Array], Flags, dict[int, str], Index, Flags]:
    """Configurations (s, 6) [rad | m] in which a homotopy's paths end; for which targets all ended; in words.

    Also how many (m,) of them there are at which the joints after the first `own` stand still, -1 where it is not
    known; and where (m,) all ended, some in singular solutions, and paths may miss self-motions. few: (m,) where they
    may not.
    """
    unknown = np.full(len(T), -1)
    if other.homotopy.count is None:
        nowhere = np.empty(0, dtype=np.intp), np.empty((0, 6))
        words = "searched for in several ways; how many complex solutions the arm has could not be told"
        return nowhere, np.zeros(len(T), dtype=bool), dict.fromkeys(range(len(T)), words), unknown, unknown > 0
    account = other.homotopy.account(other.loop.closing(T))
    index = np.concatenate([account.index, account.singular_index])
    values = np.concatenate([account.values, account.singular_values])
    q = values * np.where(other.chain.revolute, 1.0, other.loop.size) - other.chain.offsets
    closed, said = account.closed, {i: account.words(i) for i in range(len(T))}
    if not other.chain.revolute.all():
        # Where slides are singular a self-motion may be one that no path ends on.
        closed = closed & (few | (account.regular == account.count))
        said |= {int(i): said[int(i)] + SLIDES for i in np.flatnonzero(account.closed & ~closed)}
    still = np.max(np.abs(half_turns(account.values[:, own:], other.chain.revolute[own:])), axis=1, initial=0.0)
    number = np.bincount(account.index[still < AT_REST], minlength=len(T))
    expected = np.where(account.regular == account.count, number, unknown)
    return (index, q), closed, said, expected, closed & ~few & (account.singular > 0)


def known_solutions(loop: Loop, solver: Any, number: int | None) -> list[Known]:
    """All solutions of an arm's loop at random poses, as far as its own solver gives them, which has `number` roots."""
    spans = np.where(loop.revolute, np.pi, 1.0)
    closing = closing_at(loop, np.random.default_rng(8).uniform(-spans, spans, (POSES, 6)))
    if isinstance(solver, General):
        return _known_by_elimination(loop, solver.first.all_candidates(closing[:8]), closing, number)
    candidates = solver.candidates(closing)
    values, position, angle = refine(loop, closing, candidates.index, candidates.values, 4)
    whole = np.flatnonzero(np.bincount(candidates.index[(position + angle) < 1e-12], minlength=POSES) == number)
    found = []
    for i in whole:
        mine = values[candidates.index == i].astype(np.complex128)
        if regular(loop, mine, np.zeros(len(mine)), 1e-3).all():
            found.append(Known(closing[i], mine))
    return found


def known_of_skew(skew: Skew) -> list[Known]:
    """The same of a loop with skew axes."""
    spans = np.where(skew.loop.revolute, np.pi, 1.0)
    closing = closing_at(skew.loop, np.random.default_rng(8).uniform(-spans, spans, (8, 6)))
    return _known_by_elimination(skew.loop, skew.solver.all_candidates(closing), closing, skew.number)


def _known_by_elimination(
    loop: Loop, candidates: tuple[Candidates, ComplexCandidates], closing: Array, number: int | None
) -> list[Known]:
    """The targets closing (m, 4, 4) at which an elimination found all."""
    m = 1 + int(max((part.index.max(initial=0) for part in candidates), default=0))
    counted = count_solutions(loop, closing[:m], [(part.index, part.values) for part in candidates], 3)
    found = []
    for i in np.flatnonzero(counted.number == number):
        mine = counted.values[counted.kept & (counted.target == i)]
        paired = mine[np.abs(mine.imag).max(axis=1) > REAL]
        found.append(Known(closing[i], np.concatenate([mine, paired.conj()])))
    return found


def closing_at_last(chain: Chain, T: Array, index: Index, q: Array, size: float) -> Found:
    """Those configurations (s, n) for the targets index (s,) that Newton's steps bring to close."""
    target = T[index]
    q, error = descend(chain, target, q, size, steps=STEPS)
    off = np.max(np.abs(error), axis=1)
    near = off < NEARLY
    index, q, error = index[near], q[near], error[near]
    known = handle(chain)
    if native is None or known is None or chain.n > native.most_moved:
        finely_closed(chain, T[index], q, error, size)
    else:
        q, error = native.finely_closed(known, T[index], q, error, size, FINE, LONGEST, LEAST, EXACT)
    position, angle = distance_and_angle(error)
    closes = (position <= CLOSES) & (angle <= CLOSES)
    return Found(index, q, position * size, angle).pick(closes)


def finely_closed(chain: Chain, T: Array, q: Array, error: Array, size: float) -> None:
    """Steps by singular values from q (s, n) towards T (s, 4, 4), with the errors (s, 6); both are brought on."""
    scale = np.where(chain.revolute, 1.0, size)
    for _ in range(FINE):
        open_ = np.flatnonzero(np.max(np.abs(error), axis=1) > EXACT)
        if not len(open_):
            break
        here, J = error_and_jacobian(chain, T[open_], q[open_], size)
        U, S, Vt = np.linalg.svd(J, full_matrices=False)
        part = np.einsum("sij,si->sj", U, here)
        part = np.where(LEAST * S[:, :1] < S, part / np.where(S > 0.0, S, 1.0), 0.0)
        step = np.einsum("sj,sjk->sk", part, Vt)
        ahead = q[open_] + limited(step, LONGEST) * scale
        there, _ = error_and_jacobian(chain, T[open_], ahead, size)
        better = np.max(np.abs(there), axis=1) < np.max(np.abs(here), axis=1)
        q[open_[better]], error[open_[better]] = ahead[better], there[better]
        error[open_[~better]] = here[~better]
        if not better.any():
            break
