"""The targets of a block that the native kernel answers, which are nearly all where an arm has a closed form.

Statement. Give the solutions of those targets at which nothing is doubtful, in the order and with the numbers of the
blocks, and say which targets are left to these.
Derivation. The kernel follows all roots of the closed form, proves each and looks at limits by the rules of
`one_target`: what it answers is complete, and each of its targets is answered by itself.
Degenerate case. What is not plain is no part of it. None where there is no native kernel, or it does not know the arm.
Of targets that clearly have no solution the proof by a homotopy is found when a single answer is asked for.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.inverse.analysis import Analysis
from robokin.inverse.claims import COUNTED, NOTHING, Claims
from robokin.inverse.numeric.closest import TOGETHER
from robokin.inverse.one_target_arm import one_target_arm
from robokin.inverse.target_block import Request, TargetBlock, in_order
from robokin.inverse.verify import Found
from robokin.kernel.native_kernel import native
from robokin.model import Robot


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


class PlainBlock(TargetBlock):
    """The answers of the native kernel for those targets of a block that it answers.

    plain: (m,) which of the given ones these are; tables: (k, r, 6), (k, r), (k, r), (k, r) what is listed of each, in
    as many rows as the closed form has roots: joint values, distances, angles (NaN where there are fewer solutions),
    and which are within the limits.
    """

    def __init__(self, request: Request, T: Array) -> None:
        """Answer what is plain of targets T (m, 4, 4) [m]; the others are no part of this block."""
        assert native is not None
        self.plain, count, listed, *tables = native.solutions(kernel_form(request), T, request.limits, request.near)
        if not self.plain.all():
            plain = self.plain
            T, count, listed, tables = T[plain], count[plain], listed[plain], [table[plain] for table in tables]
        self.request, self.T, self.tables = request, T, tables
        self._nearest, self._arcs, self.swivel, self._proven = {}, {}, None, dict[int, tuple[TargetBlock, int]]()
        self.claims = Claims(np.full(len(T), COUNTED, dtype=np.int8), request.analysis.number, count, branches=True)
        self.claims.candidates, self.claims.duplicates = count, np.zeros_like(count)
        self.closing, self.within, self.count = count, listed, listed
        if request.near is not None or request.most is not None:
            self.found, self.inside = in_order(request, self.found, self.inside, None)
            self.count = np.bincount(self.found.index, minlength=len(T))
        self.cut = self.within > self.count

    @cached_property
    def found(self) -> Found:  # type: ignore[override]
        """What is listed, target after target."""
        q, position, angle, _ = (table[self._rows] for table in self.tables)
        return Found(np.repeat(np.arange(len(self.T)), self.within), q, position, angle)

    @cached_property
    def inside(self) -> Flags:  # type: ignore[override]
        """Which of these are within the limits."""
        which: Flags = self.tables[3][self._rows]
        return which

    @cached_property
    def _rows(self) -> Flags:
        return np.arange(self.tables[1].shape[1]) < self.within[:, None]

    @cached_property
    def every(self) -> tuple[Array, Index]:  # type: ignore[override]
        """All solutions, within the limits or not, and their targets."""
        assert native is not None
        _, count, _, q, *_ = native.solutions(kernel_form(self.request), self.T, False, self.request.near)
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

    def padded(self, most: int) -> tuple[Array, Array, Array, Flags]:
        """What is listed in tables of `most` rows a target: see `TargetBlock.padded`."""
        if self.request.near is None and self.request.most is None and most <= self.tables[1].shape[1]:
            q, position, angle, inside = (table[:, :most] for table in self.tables)
            return q, position, angle, inside
        return super().padded(most)
