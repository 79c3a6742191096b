"""Targets of arms with a spherical shoulder and wrist that the native kernel answers, one and many.

Statement. Give the solutions that are listed of a target, and its self-motions as intervals of the swivel angle, as
`TargetBlock` gives them with `known_motions`, in a fiftieth of the time.
Derivation. The kernel follows the same steps (`native_swivel`); objects are made of its numbers for those that ask.
Degenerate case. What the steps doubt, and targets with nothing within the limits, are left to the blocks. So is a wish,
a list without regard to limits, and one of more than `MOST_LISTED`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache, cached_property, partial
from typing import Any

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.inverse.analysis import Analysis, analysis_of
from robokin.inverse.batch_tables import BatchTables, NativeKind
from robokin.inverse.claims import Claims
from robokin.inverse.full_turns import count_equivalents, turning
from robokin.inverse.known_motions import ALL_MOTIONS, MOVING, turns_on
from robokin.inverse.numeric.nearest import free_at
from robokin.inverse.self_motion.native_swivel import MOST_LISTED, native_swivel
from robokin.inverse.self_motion.one_swivel import Answer, OneSwivel, one_swivel
from robokin.inverse.self_motion.swivel_arcs import swivel_arcs
from robokin.inverse.self_motion.swivel_arm import SwivelArm, swivel_arm
from robokin.inverse.self_motion.swivel_curves import swivel_curves
from robokin.inverse.self_motion.swivel_pieces import SwivelPieces
from robokin.inverse.solution_names import branch_names
from robokin.inverse.solutions import Family, Question, Result, arc_later, named_later
from robokin.inverse.target_block import MOST, Request, TargetBlock
from robokin.inverse.verify import Found
from robokin.kernel.facts import fact
from robokin.kernel.native_kernel import native
from robokin.model import Robot
from robokin.model.robot import LIMIT_TOLERANCE
from robokin.spatial.angles import TURN


@dataclass(frozen=True, eq=False)
class OneSwivelArm:
    """A robot with what the native kernel knows it by, and what does without it.

    wide: whether intervals may not tell how a joint turns on; turned: whether full turns may be within the limits.
    """

    robot: Robot
    analysis: Analysis
    arm: SwivelArm
    kernel: object | None
    alone: OneSwivel
    wide: bool
    turned: bool

    def answer(self, T: Array, most: int) -> Answer | None:
        """The kernel's numbers for a target T (4, 4) [m]; None where blocks are to answer."""
        if native is None or self.kernel is None:
            return self.alone.solution(T, most)
        found: Answer | None = native.swivel_solution(self.kernel, T, most)
        return found


@fact
def one_swivel_arm(robot: Robot) -> OneSwivelArm | None:
    """What is known of a robot; None for one that blocks are left to solve."""
    if type(robot) is not Robot or robot.n != 7:
        return None
    analysis = analysis_of(robot)
    arm = None if analysis.open or analysis.redundancy != 1 or analysis.idle else swivel_arm(analysis.chain)
    if arm is None or analysis.solver is None:
        return None
    request = Request(robot, analysis, True, None, "auto", None, 0)
    limits = request.own_limits
    if not np.array_equal(limits, robot.limits):
        return None
    kernel, alone = native_swivel(arm, limits, request.middle), one_swivel(arm, limits, request.middle)
    turned = any(np.ptp(limits[i]) + 4.0 * LIMIT_TOLERANCE >= TURN for i in turning(robot))
    return OneSwivelArm(robot, analysis, arm, kernel, alone, turns_on(limits), turned)


def swivel_request(request: Request) -> OneSwivelArm | None:
    """What the kernel knows the arm of a request by; None where blocks are to answer."""
    if request.method == "numeric" or not request.limits or request.near is not None:
        return None
    if request.most is not None and request.most > MOST_LISTED:
        return None
    known = one_swivel_arm(request.robot)
    return None if known is None or known.kernel is None or known.analysis is not request.analysis else known


SHARE = 100
"""Targets that a thread takes at once: some milliseconds."""


def swivel_kind(request: Request) -> NativeKind:
    """How the native kernel answers a request for an arm that it knows (`swivel_request`)."""
    most = MOST if request.most is None else request.most
    return NativeKind(most, 7, SHARE, partial(_fill, request), partial(SwivelBlock, request), proven=False, quick=False)


def _fill(request: Request, T: Array, tables: BatchTables) -> None:
    """Put what is plain of targets T (m, 4, 4) [m] into their tables."""
    known = swivel_request(request)
    assert native is not None
    assert known is not None
    native.swivel_solutions(known.kernel, T, tables.q.shape[1], tables)


class SwivelBlock(TargetBlock):
    """The answers of the native kernel for targets that it answers, from their tables.

    tables: what is listed of each, in rows of joint values, distances and angles.
    """

    def __init__(self, request: Request, T: Array, tables: BatchTables) -> None:
        """The answers for targets T (m, 4, 4) [m], which all are plain."""
        self.request, self.T, self.tables, self.swivel = request, T, tables, None
        self.closing, self.within, self.count = tables.closing, tables.within, tables.listed
        self._nearest, self._arcs = {}, {}
        none = np.zeros(len(T), dtype=np.intp)
        self.claims = Claims(none.astype(np.int8), None, none, otherwise=ALL_MOTIONS)
        self.cut = self.within > self.count

    @cached_property
    def found(self) -> Found:  # type: ignore[override]
        """What is listed, target after target."""
        rows = np.arange(self.tables.q.shape[1]) < self.count[:, None]
        q, position, angle = (table[rows] for table in (self.tables.q, self.tables.position, self.tables.angle))
        return Found(np.repeat(np.arange(len(self.T)), self.count), q, position, angle)

    @cached_property
    def inside(self) -> Flags:  # type: ignore[override]
        """Which of these are within the limits: all."""
        return np.ones(len(self.found), dtype=bool)

    @cached_property
    def every(self) -> tuple[Array, Index]:  # type: ignore[override]
        """All solutions that were put on the self-motions, and their targets."""
        return TargetBlock(self.request, self.T).every

    def in_closed_form(self, i: int) -> bool:
        """Whether the self-motions of target i are known as intervals of the swivel angle: yes."""
        return True

    def families(self, i: int) -> tuple[Family, ...] | None:
        """The self-motions of target i; None where intervals of the swivel angle do not tell."""
        known = swivel_request(self.request)
        assert known is not None
        found = known.answer(self.T[i], self.tables.q.shape[1])
        assert found is not None
        table, pieces, moving, *_ = found
        return swivel_families(known, self.T[i], table, pieces, moving)


@dataclass(eq=False, slots=True)
class SwivelSolution:
    """The solutions for one target T (4, 4) [m].

    table: (k, 10) a row for each that is listed: joint values [rad], what it lacks of the target [m, rad], the number
    of its curve; pieces: (p, 4) curve, first and last ψ, whether it is all of the curve; moving: (8,) the joints, as
    bits, that move along each; closing, within: how many were put on the self-motions and close, and are within limits.
    """

    known: OneSwivelArm
    T: Array
    table: Array
    pieces: Array
    moving: Sequence[int]
    closing: int
    within: int

    def result(self, question: Question) -> Result | None:
        """The answer for a question; None where intervals of the swivel angle do not tell."""
        families = swivel_families(self.known, self.T, self.table, self.pieces, self.moving)
        if families is None:
            return None
        q, robot = self.table[:, :7].copy(), self.known.robot
        names = cache(partial(branch_names, robot, q, np.zeros(len(q), dtype=np.intp)))
        free = cache(partial(free_at, self.known.analysis, q))
        table = self.table.copy()
        table[:, 9] = 1.0  # all are within the limits
        solutions = named_later(partial(_at, names), table, 7, partial(_at, free))
        counts = {"closing": self.closing, "within_limits": self.within, "listed": len(q)}
        counts["turns"] = sum(count_equivalents(robot, q)) if self.known.turned else len(q)
        return Result(
            solutions, False, self.known.analysis.method, counts=counts, certificate=ALL_MOTIONS, families=families,
            question=question, families_complete=True,
        )  # fmt: skip


def _at(find: Callable[[], list[Any]], k: int) -> Any:
    return find()[k]


def solve_swivel(known: OneSwivelArm, T: Array, most: int | None) -> SwivelSolution | None:
    """The answer for a rigid target T (4, 4) [m] within the limits, or None where it is left to the blocks."""
    if most is not None and most > MOST_LISTED:
        return None
    T = np.array(T)
    found = known.answer(T, MOST if most is None else most)
    return None if found is None else SwivelSolution(known, T, *found)


def swivel_families(
    known: OneSwivelArm, T: Array, table: Array, pieces: Array, moving: Sequence[int]
) -> tuple[Family, ...] | None:
    """The self-motions of a target T (4, 4) [m] by the kernel's numbers, as `known_families` has them.

    None where a joint turns on beyond its limits in a way that intervals of the swivel angle do not tell.
    """
    arcs = cache(partial(_arcs, known, T, pieces))
    if known.wide and not arcs()[1]:
        return None
    rows = pieces.tolist()
    own: dict[float, list[int]] = {}
    for k, row in enumerate(rows):
        own.setdefault(row[0], []).append(k)
    listed = table[:, 9].tolist()
    first = {code: k for k, code in reversed([*enumerate(listed)])}
    families = []
    for code in sorted(own, key=lambda code: first.get(code, len(listed))):
        parts = [arc_later(partial(_one, arcs, k), rows[k][3] != 0.0, (rows[k][1], rows[k][2])) for k in own[code]]
        families.append(Family(MOVING[moving[int(code)]], 1, True, tuple(parts), first.get(code, -1)))
    return tuple(families)


def _one(arcs: Callable[[], tuple[list[Array], bool]], k: int) -> Array:
    return arcs()[0][k]


def _arcs(known: OneSwivelArm, T: Array, pieces: Array) -> tuple[list[Array], bool]:
    """The configurations along pieces (p, 4), and whether full turns bring all into the limits."""
    count = len(pieces)
    row, code = np.zeros(count, dtype=np.intp), pieces[:, 0].astype(np.intp)
    some = SwivelPieces(row, code, pieces[:, 1], pieces[:, 2], pieces[:, 3] != 0.0, np.zeros(1, dtype=bool))
    found, fits = swivel_arcs(swivel_curves(known.arm, T[None]), some, np.arange(count), known.robot.limits)
    return found, bool(fits.all())
