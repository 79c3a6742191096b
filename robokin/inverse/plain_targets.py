"""The targets of a block that the native kernel answers, which are nearly all where an arm has a closed form.

Statement. Give the solutions of those targets at which nothing is doubtful, in the order and with the numbers of the
blocks, and say which targets are left to these.
Derivation. The kernel follows all roots of the closed form, proves each and looks at limits by the rules of
`one_target`: what it answers is complete, and each of its targets is answered by itself.
Degenerate case. What is not plain is no part of it. None where there is no native kernel, or it does not know the arm.
Of targets that clearly have no solution the proof by a homotopy is found when a single answer is asked for.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property, partial

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.inverse.analysis import Analysis, General
from robokin.inverse.batch_tables import BatchTables, NativeKind
from robokin.inverse.claims import COUNTED, NOTHING, Claims
from robokin.inverse.numeric.closest import TOGETHER
from robokin.inverse.one_target_arm import one_target_arm
from robokin.inverse.target_block import Request, TargetBlock
from robokin.inverse.verify import Found
from robokin.kernel.native_kernel import native
from robokin.model import Robot

QUICK_SHARE, SLOW_SHARE = 4000, 250
"""Targets that a thread takes at once of a closed form, and of an elimination: some milliseconds."""


def kernel_form(request: Request) -> object | None:
    """What the native kernel knows the closed form of a request's arm by; None where blocks are to answer."""
    robot, near = request.robot, request.near
    if native is None or request.method == "numeric" or request.analysis.open:
        return None
    arm = one_target_arm(robot)
    if arm is None or arm.analysis is not request.analysis:
        return None
    return arm.kernel if near is None or request.limits or robot.within_limits(near) else None


def quick_within(robot: Robot, analysis: Analysis, T: Array) -> tuple[Flags, Flags, Array] | None:
    """What the native kernel's closed form of an arm answers at once of targets T (m, 4, 4) [m]; None without one.

    (m,) which it answers, (m,) which of those are reached within the limits, and (m, n) [rad] the last such solution of
    each, any number for others.
    """
    arm = None if native is None or analysis.open or analysis.redundancy else one_target_arm(robot)
    if native is None or arm is None or arm.kernel is None or arm.form is None or arm.analysis is not analysis:
        return None
    plain, _, listed, q, *_ = native.solutions(arm.kernel, T, True, None)
    return plain, plain & (listed > 0), q[np.arange(len(T)), np.maximum(listed - 1, 0)]


def plain_kind(request: Request) -> NativeKind:
    """How the native kernel answers a request for an arm that it knows (`kernel_form`)."""
    assert native is not None
    arm = one_target_arm(request.robot)
    assert arm is not None
    rows = native.roots(arm.kernel, arm.elimination)
    pattern = request.pattern if request.pattern is None or len(request.pattern) <= native.most_joints else None
    fill, block = partial(_fill, request, pattern), partial(PlainBlock, request, pattern)
    quick = arm.elimination is None
    share, n = QUICK_SHARE if quick else SLOW_SHARE, 6 if pattern is None else len(pattern)
    return NativeKind(rows, n, share, fill, block, proven=True, quick=quick, pattern=pattern)


def _fill(request: Request, pattern: Array | None, T: Array, tables: BatchTables) -> None:
    """Put what is plain of targets T (m, 4, 4) [m] into their tables."""
    assert native is not None
    arm = one_target_arm(request.robot)
    assert arm is not None
    near = None if request.near is None else np.ascontiguousarray(request.near)
    native.solutions(arm.kernel, T, request.limits, near, arm.elimination, request.most, tables, pattern)


class PlainBlock(TargetBlock):
    """The answers of the native kernel for targets that it answers, from their tables.

    tables: what is listed of each target, in rows of joint values, distances, angles, and which are within the limits.
    """

    def __init__(self, request: Request, pattern: Array | None, T: Array, tables: BatchTables) -> None:
        """The answers for targets T (m, 4, 4) [m], which all are plain.

        pattern: of joints that are held in the tables their values, NaN for the others, or None.
        """
        if pattern is not None:
            tables = tables._replace(q=tables.q[..., np.isnan(pattern)])
        self.request, self.T, self.tables = request, T, tables
        self.closing, self.within, self.count = tables.closing, tables.within, tables.listed
        self._nearest, self._arcs, self.swivel, self._proven = {}, {}, None, dict[int, tuple[TargetBlock, int]]()
        branches = not isinstance(request.analysis.solver, General)
        basis = np.full(len(T), COUNTED, dtype=np.int8)
        self.claims = Claims(basis, request.analysis.number, self.closing, branches=branches)
        self.claims.candidates, self.claims.duplicates = tables.tried, np.zeros_like(tables.tried)
        self.cut = self.within > self.count

    @cached_property
    def found(self) -> Found:  # type: ignore[override]
        """What is listed, target after target."""
        q, position, angle = (table[self._rows] for table in (self.tables.q, self.tables.position, self.tables.angle))
        return Found(np.repeat(np.arange(len(self.T)), self.count), q, position, angle)

    @cached_property
    def inside(self) -> Flags:  # type: ignore[override]
        """Which of these are within the limits."""
        return self.tables.inside[self._rows]

    @cached_property
    def _rows(self) -> Flags:
        return np.arange(self.tables.q.shape[1]) < self.count[:, None]

    @cached_property
    def every(self) -> tuple[Array, Index]:  # type: ignore[override]
        """All solutions, within the limits or not, and their targets."""
        every = replace(self.request, limits=False, most=None, pattern=None)
        _, _, count, _, _, q, *_ = plain_kind(every).filled(self.T, 1)
        return q[np.arange(q.shape[1]) < count[:, None]], np.repeat(np.arange(len(count)), count)

    def answered_by(self, i: int) -> tuple[TargetBlock, int]:
        """The block that tells all of target i, and its number in that: another where more has to be found."""
        if self.closing[i] or self.beyond[i]:
            return self, i
        if i not in self._proven:
            none = (self.closing == 0) & ~self.beyond
            rows = i + np.flatnonzero(none[i:])[: min(TOGETHER, 1 + len(self._proven))]
            block = TargetBlock(self.request, self.T[rows])
            # All branches are followed and complex, whatever else may have failed to prove it.
            for k in np.flatnonzero(block.claims.basis == NOTHING).tolist():
                block.claims.words.pop(k, None)
                block.claims.basis[k], block.claims.N = COUNTED, self.claims.N
            self._proven |= {row: (block, k) for k, row in enumerate(rows.tolist())}
        return self._proven[i]
