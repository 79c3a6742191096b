"""Solutions of a target from those of poses next door, and whether that is all of them.

Statement. For targets at which an arm is singular, or at which its solver may have lost solutions, find some, and say
of which targets all are found.
Derivation. A trifle away, in any direction, the solver is regular; what it finds there is brought to the target by
Newton's steps. If that makes as many distinct regular solutions as the arm has, complex ones counted too, there is no
other (`elimination`), and nothing else need be tried. Where nothing vouches for them other splits of the elimination
and links that are wrong by a trifle are asked as well.
Degenerate case. At a target at which solutions meet, or form a self-motion, fewer are regular: it stays open.
"""

from __future__ import annotations

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.inverse.analysis import Analysis, General
from robokin.inverse.elimination.complex_newton import distinct as each_once
from robokin.inverse.elimination.loop import Candidates, ComplexCandidates
from robokin.inverse.elimination.loop_newton import determinants, refine
from robokin.inverse.elimination.native_elimination import candidates_at, poses_beside
from robokin.inverse.elimination.splits import REAL, count_solutions, rescue_candidates
from robokin.inverse.verify import SAME
from robokin.inverse.window import CLEARLY_REGULAR

TWISTS = 6
"""Poses next door that the solver is asked for."""

COUNTED_AT = 2
"""At how many of these poses the solutions are counted, the complex ones too."""

COUNTING_STEPS = 5
"""Newton steps from there for those that are counted."""

CLEAR = 1e-12
"""Residual [size and rad] of a regular solution that is known as well as another one that equals it."""

DRIFT = 0.05
"""An added joint that is farther from zero [rad | size] at a pose next door is not about to stand still."""

STEPS = 15
"""Newton steps from next door."""

NEARLY = 1e-5
"""What closes no better [size and rad] after Newton's steps leads nowhere."""


def next_door(analysis: Analysis, T: Array) -> tuple[Index, Array, Flags]:
    """Configurations (s, window) near solutions of T (m, 4, 4), from the solutions at poses a trifle away.

    Also for which targets (m,) the complex ones among them are as many distinct regular solutions as the arm has.
    """
    six, loop, solver = analysis.six, analysis.loop, analysis.solver
    assert six is not None
    assert loop is not None
    closing = loop.closing(T)
    many = (poses_beside(TWISTS)[:, None] @ closing[None]).reshape(-1, 4, 4)
    whole = np.zeros(len(T), dtype=bool)
    if isinstance(solver, General):
        real, imaginary = candidates_at(solver.first, loop, many, complex_too=not six.virtual)
        parts = [Candidates(real.index % len(T), real.values)]
        if not six.virtual:
            whole, known = _counted(analysis, closing, real, imaginary)
            parts = [known, Candidates(*_of_targets(parts[0], ~whole))]
    else:
        found = solver.candidates(many)
        parts = [Candidates(found.index % len(T), found.values)]
    return *_brought_home(analysis, closing, parts), whole


def other_ways(analysis: Analysis, T: Array) -> tuple[Index, Array]:
    """Configurations (s, window) near solutions of T (m, 4, 4) that other eliminations and wrong links lead to."""
    if not isinstance(analysis.solver, General):
        return np.empty(0, dtype=np.intp), np.empty((0, analysis.own.n))
    assert analysis.loop is not None
    closing = analysis.loop.closing(T)
    return _brought_home(analysis, closing, [rescue_candidates(analysis.loop, analysis.solver.splits, closing)])


def _brought_home(analysis: Analysis, closing: Array, parts: list[Candidates]) -> tuple[Index, Array]:
    """Candidates for L6 (m, 4, 4) as configurations (s, window), after Newton's steps unless joints were added."""
    six, loop = analysis.six, analysis.loop
    assert six is not None
    assert loop is not None
    index = np.concatenate([part.index for part in parts])
    values = np.concatenate([part.values for part in parts])
    scale = np.where(six.chain.revolute, 1.0, loop.size)
    own = six.chain.n - six.virtual
    if six.virtual:
        near = np.max(np.abs(half_turns(values[:, own:], six.chain.revolute[own:])), axis=1) < DRIFT
        index, values = index[near], values[near]
    else:
        values, position, angle = refine(loop, closing, index, values, STEPS)
        off = position + angle
        near = off < NEARLY
        # Most are the same regular solutions, again and again.
        clear = np.flatnonzero((off < CLEAR) & (determinants(loop, values) > CLEARLY_REGULAR))
        near[clear] = each_once(loop, index[clear], values[clear], SAME)
        index, values = index[near], values[near]
    return index, (values * scale - six.chain.offsets)[:, :own]


def _of_targets(candidates: Candidates, chosen: Flags) -> tuple[Index, Array]:
    """The candidates of chosen targets (m,)."""
    mine = chosen[candidates.index]
    return candidates.index[mine], candidates.values[mine]


def _counted(
    analysis: Analysis, closing: Array, real: Candidates, imaginary: ComplexCandidates
) -> tuple[Flags, Candidates]:
    """For which targets (m,) the solutions of poses next door become all N, and the real ones of these.

    closing: (m, 4, 4); the candidates are those of the poses next door, all targets' first ones in front.
    """
    assert analysis.loop is not None
    m = len(closing)
    parts = [(part.index[chosen] % m, part.values[chosen]) for part in (real, imaginary)
             for chosen in [part.index < COUNTED_AT * m]]  # fmt: skip
    counted = count_solutions(analysis.loop, closing, parts, COUNTING_STEPS)
    whole = counted.number == analysis.number
    mine = counted.kept & whole[counted.target] & (np.abs(counted.values.imag).max(axis=1, initial=0.0) < REAL)
    return whole, Candidates(counted.target[mine], counted.values[mine].real)


def half_turns(values: Array, turning: Flags) -> Array:
    """Joint values (s, k) with angles in [-π, π]."""
    return np.asarray(np.where(turning, values - 2.0 * np.pi * np.round(values / (2.0 * np.pi)), values))
