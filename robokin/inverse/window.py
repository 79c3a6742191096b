"""The window's joints solved for a block of targets by the arm's own solver, and which targets are doubtful.

Statement. For targets T of a window of at most six joints (`analysis`) find all configurations, proven by forward
kinematics, and say for each target whether the algebra vouches for the list.
What vouches. An elimination gives all complex solutions: if as many distinct regular ones are found as the arm has at
a random pose, none is missing (`elimination`). A closed form follows all roots of its equations. It may lose one where
two roots meet, where an axis is nearly free to turn, or where an equation says nothing: the arm is singular there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.inverse.analysis import Analysis, General
from robokin.inverse.elimination.complex_newton import complex_refine, on_the_way_out, regular, regular_and_distinct
from robokin.inverse.elimination.loop import ComplexCandidates
from robokin.inverse.elimination.loop_newton import determinants
from robokin.inverse.elimination.native_elimination import candidates_at, native_elimination
from robokin.inverse.elimination.splits import REAL
from robokin.inverse.numeric.least_squares import descend
from robokin.inverse.verify import CLOSES, VIRTUAL, Found, closing_distances, distinct, merged, verified
from robokin.kernel.chain import Chain
from robokin.kernel.ranks import RANK
from robokin.kernel.residual import TargetPoses, error_and_jacobian

SINGULAR = 5e-6
"""Least singular value of the Jacobian (lengths in sizes) of a closed form's solution below which others may be lost:
a root that is good to 1e-15 and its neighbour are then some 1e-5 apart, and equations neglect 1e-9."""

TOLD_APART = 1e-6
"""The same of solutions that are as many as the equations have roots: none is missing if they are told apart. Two that
are `root_neighbours.NEXT` together or nearer, and one but for its MIDWAY, are below 8e-7."""

ROUNDED = 1e-14
"""Residual above which an elimination's solution is polished: it then does not depend on the poses beside it."""

CLEARLY_REGULAR = 1e-4
"""|det S| (lengths in sizes) above which the least singular value is above 1e-6: the others are some three at most."""

ROUGH = 1e-12
"""Residual of a complex solution that is left as the elimination gives it; half of them are."""

GRAZING = 1e-5
"""A virtual joint below this may be zero but for rounding (at a double root half of the digits are lost); the
arm's own joints are then polished alone and judged by their own residual."""


@dataclass(eq=False)
class Doubt:
    """Targets (m,) of which some solution may be missing for `certain`, or only if the arm is near-singular there.

    candidates: (m,) how many were tried; few: (m,) of a closed form, what `Candidates.few` says of them.
    """

    certain: Flags
    possible: Flags
    candidates: Index
    few: Flags | None = None


def solve_window(analysis: Analysis, T: Array, count: bool = True) -> tuple[Found, Doubt]:
    """Solutions of the window for its own targets; q: (s, window). Without `count` nothing is vouched for."""
    six, solver = analysis.six, analysis.solver
    assert six is not None
    if isinstance(solver, General):
        found, doubt = _eliminated(analysis, T, count)
    else:
        found, doubt = _by_closed_form(analysis, T)
    if six.virtual:
        found = _own_joints(analysis, T, found)
    return found, doubt


def _by_closed_form(analysis: Analysis, T: Array) -> tuple[Found, Doubt]:
    """`solve_window` of all six joints of a closed form."""
    six, loop, solver = analysis.six, analysis.loop, analysis.solver
    assert six is not None
    assert loop is not None
    closing = loop.closing(T)
    candidates = solver.candidates(closing)
    found = verified(loop, six.chain, TargetPoses(six.chain, T), closing, candidates)
    assert candidates.loose is not None
    assert candidates.near is not None
    tried = np.bincount(candidates.index, minlength=len(T))
    # A short lever decides how a joint stands: rounding of it may put what is beyond out of reach.
    unsure = candidates.near if candidates.few is None else candidates.near & ~candidates.few
    lost = unsure & (tried < (candidates.leaves or 0))
    few = np.zeros(len(T), dtype=bool) if candidates.few is None else candidates.few
    return found, Doubt(candidates.loose | lost, candidates.near, tried, few)


def _eliminated(analysis: Analysis, T: Array, count: bool) -> tuple[Found, Doubt]:
    """`solve_window` of all six joints by elimination: in the native kernel, and by Python what that does not prove."""
    assert analysis.six is not None
    assert analysis.loop is not None
    known = native_elimination(analysis.solver.first, analysis.loop, analysis.six.chain, analysis.number)
    if known is None:
        return _by_elimination(analysis, T, count)
    index, q, position, angle, tried, whole = known.many(T)
    found, doubt = Found(index, q, position, angle), Doubt(~whole, np.zeros(len(T), dtype=bool), tried)
    rest = np.flatnonzero(~whole)
    if count or not len(rest):
        # What is not proven is looked at again.
        return found, doubt
    more, again = _by_elimination(analysis, T[rest], count)
    doubt.certain[rest], doubt.candidates[rest] = again.certain, again.candidates
    both = merged(found.pick(whole[index]), Found(rest[more.index], more.q, more.position, more.angle))
    return both.pick(np.argsort(both.index, kind="stable")), doubt


def _by_elimination(analysis: Analysis, T: Array, count: bool) -> tuple[Found, Doubt]:
    """The same in Python."""
    six, loop, solver = analysis.six, analysis.loop, analysis.solver
    assert six is not None
    assert loop is not None
    closing = loop.closing(T)
    candidates, imaginary = candidates_at(solver.first, loop, closing, complex_too=count)
    found = verified(loop, six.chain, TargetPoses(six.chain, T), closing, candidates, ROUNDED)
    found = distinct(found, six.chain.revolute, loop.size)
    tried = np.bincount(candidates.index, minlength=len(T))
    doubt = Doubt(np.ones(len(T), dtype=bool), np.zeros(len(T), dtype=bool), tried)
    if count:
        doubt.certain = complex_count(analysis, closing, found, imaginary) != analysis.number
    return found, doubt


def complex_count(analysis: Analysis, closing: Array, found: Found, imaginary: ComplexCandidates) -> Index:
    """The distinct regular complex solutions (m,) of the loop among those found and the complex candidates."""
    six, loop = analysis.six, analysis.loop
    assert six is not None
    assert loop is not None
    values = (found.q + six.chain.offsets) / np.where(six.chain.revolute, 1.0, loop.size)
    # The real ones are distinct and close; a determinant this great has no small singular value.
    sound = determinants(loop, values) > CLEARLY_REGULAR
    # Where several meet they are left as far apart as they have not settled: nothing vouches for these.
    residual = np.maximum(found.position / loop.size, found.angle)
    sound[~sound] = regular(loop, values[~sound], residual[~sound])
    count = np.bincount(found.index[sound], minlength=len(closing))
    index, complex_values = imaginary.index, imaginary.values
    complex_values, residual = complex_refine(loop, closing, index, complex_values, 0)
    rough = np.flatnonzero(residual > ROUGH)
    if len(rough):
        complex_values[rough], residual[rough] = complex_refine(loop, closing, index[rough], complex_values[rough], 3)
    residual[np.abs(complex_values.imag).max(axis=1, initial=0.0) <= REAL] = np.inf
    residual[on_the_way_out(loop, closing, index, complex_values, residual)] = np.inf
    kept = regular_and_distinct(loop, index, complex_values, residual)
    return np.asarray(count + 2 * np.bincount(index[kept], minlength=len(closing)))


def _own_joints(analysis: Analysis, T: Array, found: Found) -> Found:
    """Those whose virtual joints stand still, with the window's own joints only."""
    assert analysis.six is not None
    assert analysis.loop is not None
    chain = analysis.six.chain
    own = chain.n - analysis.six.virtual
    scale = np.where(chain.revolute[own:], 1.0, analysis.loop.size)
    virtual = found.q[:, own:] / scale
    virtual = np.where(chain.revolute[own:], virtual - 2 * np.pi * np.round(virtual / (2 * np.pi)), virtual)
    size = np.max(np.abs(virtual), axis=1)
    still = size <= GRAZING
    family = np.zeros(len(found), dtype=bool)
    if not analysis.redundancy:
        family = _on_self_motions(analysis, T, found, still)
    found = found.pick(still | family)
    own_chain = analysis.own
    q, position, angle = found.q[:, :own], found.position.copy(), found.angle.copy()
    if not len(q):
        return Found(found.index, q, position, angle)
    # As many as a target alone would take: what it comes to is not to depend on the others.
    rough = np.bincount(found.index, size[still | family] > VIRTUAL, len(T)) > 0
    distant = np.bincount(found.index, family[still | family], len(T)) > 0
    steps = np.where(distant, 25, np.where(rough, 8, 2))[found.index]
    error = np.empty((len(q), 6))
    for count in np.unique(steps).tolist():
        mine = np.flatnonzero(steps == count)
        q[mine], error[mine] = descend(own_chain, T[found.index[mine]], q[mine], analysis.size, steps=count)
    position = np.linalg.norm(error[:, :3], axis=1) * analysis.size
    angle = np.linalg.norm(error[:, 3:], axis=1)
    closes = (position <= closing_distances(own_chain, q, analysis.size)) & (angle <= CLOSES)
    return Found(found.index, q, position, angle).pick(closes)


def _on_self_motions(analysis: Analysis, T: Array, found: Found, still: Flags) -> Flags:
    """(s,) which configurations are on self-motions of the six joints, for targets without any that stand `still`.

    Such a curve may lead to where the virtual joints stand still: its members are starts for the arm's own.
    """
    assert analysis.six is not None
    answered = np.bincount(found.index[still], minlength=len(T)) > 0
    family = ~answered[found.index]
    chosen = np.flatnonzero(family)
    if len(chosen):
        _, J = error_and_jacobian(analysis.six.chain, T[found.index[chosen]], found.q[chosen], analysis.size)
        family[chosen] = np.linalg.svd(J, compute_uv=False)[:, -1] <= RANK
    return family


def least_singular_values(chain: Chain, q: Array, size: float) -> Array:
    """The least singular value (s,) of the Jacobian, lengths in sizes, at q (s, n) [rad | m]."""
    if not len(q):
        return np.empty(0)
    _, J = error_and_jacobian(chain, np.broadcast_to(np.eye(4), (len(q), 4, 4)), q, size)
    return np.asarray(np.linalg.svd(J, compute_uv=False)[:, -1])


def nearly_singular(chain: Chain, q: Array, size: float, below: Array) -> Flags:
    """(s,) whether the least singular value of the Jacobian at q (s, n) [rad | m], lengths in sizes, is below (s,).

    The product of the other singular values is at most (|J|² / 5)^(5/2), so that for six joints the
    determinant answers for most.
    """
    _, J = error_and_jacobian(chain, np.broadcast_to(np.eye(4), (len(q), 4, 4)), q, size)
    open_ = np.ones(len(q), dtype=bool)
    if chain.n == 6:
        open_ = np.abs(np.linalg.det(J)) <= below * (np.einsum("sij,sij->s", J, J) / 5.0) ** 2.5
    near = np.zeros(len(q), dtype=bool)
    near[open_] = np.linalg.svd(J[open_], compute_uv=False)[:, -1] < below[open_]
    return near


def beyond_chain(chain: Chain, T: Array, size: float) -> Flags:
    """Which targets T (m, 4, 4) [m] are farther off than a chain of turning joints, stretched out, is long."""
    if not chain.revolute.all():
        return np.zeros(len(T), dtype=bool)
    length = np.sum(np.linalg.norm(chain.constants[1:, :3, 3], axis=1))
    away = np.linalg.norm(T[:, :3, 3] - chain.constants[0, :3, 3], axis=1)
    return np.asarray(away > length + 1e-6 * size)
