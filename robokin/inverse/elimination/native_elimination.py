"""All solutions of a loop of six turning joints by the native kernel, one target at a time.

Statement. Give what `window` gives by elimination, Newton's steps, proof and count, for targets each by itself.
Derivation. The formulas are those of `raghavan_roth`, `pencil`, `loop_newton` and `complex_newton`; the eigenvalues
come from a QR of its own. Where fewer than N distinct regular complex solutions are known poses next door are asked, as
`neighbours` does, and what they lead to is counted by the same rules.
Degenerate case. Where N are still not known nothing is said: such a target is left to Python's code.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robokin.arrays import Array, Flags, Index
from robokin.inverse.elimination.loop import Candidates, ComplexCandidates, Loop, native_loop
from robokin.inverse.elimination.raghavan_roth import SPLITS, Elimination
from robokin.kernel.chain import Chain
from robokin.kernel.facts import fact
from robokin.kernel.native_kernel import handle, native
from robokin.spatial import rotation_from_rpy, transform

BESIDE = 6
"""Poses next door that are asked where solutions are missing."""

TWIST = 1e-3
"""How far away they are [size and rad]: far enough that roots are told apart, near enough for Newton's steps."""

ROOM = 8
"""Poses next door that the native kernel has room for."""


class NativeElimination:
    """An elimination that the native kernel works out, for a chain of six turning joints with N complex solutions."""

    def __init__(self, known: object, number: int) -> None:
        self.known, self.number = known, number

    def many(self, T: Array) -> tuple[Index, Array, Array, Array, Index, Flags]:
        """What is found for targets T (m, 4, 4) [m], rigid motions.

        Of each solution its target (s,), q (s, 6) [rad], and what it lacks (s,) [m], (s,) [rad], by target; of each
        target how many candidates there were (m,), and whether all N complex solutions are known (m,).
        """
        assert native is not None
        counts, rows = native.eliminated(self.known, T)
        tried, number, count, _ = counts.astype(np.intp).T
        index = np.repeat(np.arange(len(T)), count)
        columns = np.ascontiguousarray(rows.T)
        return index, columns[:6].T, columns[6], columns[7], tried, number == self.number


def native_elimination(solver: Elimination, loop: Loop, chain: Chain, number: int | None) -> NativeElimination | None:
    """The native kernel's elimination for a chain and its loop; None where Python does it.

    number: N, how many complex solutions the loop has at a random pose.
    """
    if native is None or number is None or solver.split >= SPLITS or not loop.revolute.all():
        return None
    return _native_elimination(solver, loop, chain, number)


@fact
def _native_elimination(solver: Elimination, loop: Loop, chain: Chain, number: int) -> NativeElimination | None:
    assert native is not None
    arm = handle(chain)
    if arm is None:
        return None
    return NativeElimination(native.elimination(arm, _numbers(solver, loop, number)), number)


def candidates_at(
    solver: Elimination, loop: Loop, closing: Array, complex_too: bool = True
) -> tuple[Candidates, ComplexCandidates]:
    """`solver.all_candidates` for L6 (m, 4, 4) of its loop, by the native kernel where all joints turn.

    Targets at which its pencil is degenerate, of which it says nothing, are Python's.
    """
    known = _for_candidates(solver, loop) if native is not None and loop.revolute.all() else None
    if native is None or known is None:
        return solver.all_candidates(closing, complex_too)
    counts, real, pairs = native.candidates(known, closing)
    of_real, of_pair = (np.repeat(np.arange(len(closing)), count) for count in counts.astype(np.intp).T)
    found = Candidates(of_real, real), ComplexCandidates(of_pair, pairs.view(np.complex128))
    rest = np.flatnonzero(np.sum(counts, axis=1) == 0.0)
    if len(rest):
        more = solver.all_candidates(closing[rest])
        found = Candidates(*_with(found[0], more[0], rest)), ComplexCandidates(*_with(found[1], more[1], rest))
    return found if complex_too else (found[0], ComplexCandidates(of_pair[:0], np.empty((0, 6), dtype=complex)))


def _with(
    found: Candidates | ComplexCandidates, more: Candidates | ComplexCandidates, rest: Index
) -> tuple[Index, NDArray[Any]]:
    """The targets and values of candidates and of more ones, for the targets rest, by target."""
    index = np.append(found.index, rest[more.index])
    order = np.argsort(index, kind="stable")
    return index[order], np.concatenate([found.values, more.values])[order]


@fact
def _for_candidates(solver: Elimination, loop: Loop) -> object:
    assert native is not None
    return native.elimination(native_loop(loop), _numbers(solver, loop, 0))


def _numbers(solver: Elimination, loop: Loop, number: int) -> Array:
    """What the native kernel is told of an elimination, in one row: see `elimination` there."""
    target, links = solver.links()
    degrees = solver.degrees
    free, paired = (0, 0) if degrees is None else (degrees.free, degrees.paired)
    beside = poses_beside(BESIDE)
    away = np.concatenate([beside, np.tile(np.eye(4), (ROOM - BESIDE, 1, 1))])
    whole = [*solver.joints, solver.backwards, target, free, paired, number, BESIDE]
    motions = np.concatenate([links, away, loop.first[None], loop.last[None], loop.links])
    return np.concatenate([whole, [loop.size, solver.shift, solver.imaginary], motions[:, :3].ravel()])


@cache
def poses_beside(count: int) -> Array:
    """Motions (count, 4, 4) by a trifle, in any direction."""
    rng = np.random.default_rng(3)
    return transform(rotation_from_rpy(TWIST * rng.normal(size=(count, 3))), TWIST * rng.normal(size=(count, 3)))
