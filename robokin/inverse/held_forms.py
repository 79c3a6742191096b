"""What is known of an arm with joints held, for one value after another.

Statement. Who sweeps an arm's redundancy holds a joint at hundreds of values, and asks little at each: have the arm of
the others known in a fraction of the time that an analysis takes, with the same solver and the same numbers.
Derivation. The code of a closed form is made from the numbers of the arm, of which only some hang on the held value.
It is made once with traced numbers, which note how its constants come about; for another value they are worked out
anew, and the code, the tape, the limits and what is said of the solver stay. Where there is no closed form the
elimination keeps its splits, and the number of complex solutions is looked at.
Degenerate case. At a value where the arm is another one (axes that meet or are parallel there, an entry that is 0 or 1
there and nowhere else) a comparison of the trace comes out otherwise, and the arm is analysed as any other.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, cast

import numpy as np

from robokin.arrays import Array, Flags
from robokin.inverse.analysis import (
    CLOSED_FORMS,
    Analysis,
    General,
    analyse,
    moves_in_all_directions,
    trial_closing,
    window_chain,
)
from robokin.inverse.closed_form.form_tape import FormTape, form_tape
from robokin.inverse.closed_form.loop_axes import SingularEverywhereError
from robokin.inverse.closed_form.spherical_wrist import SphericalTriple, meeting_triples
from robokin.inverse.closed_form.straight_forms import StraightForm, form_maker, straight_source
from robokin.inverse.elimination.loop import Loop, loop_of
from robokin.inverse.elimination.loop_newton import closing_at
from robokin.inverse.elimination.native_elimination import native_elimination
from robokin.inverse.elimination.padding import Padded
from robokin.inverse.elimination.splits import generic_count
from robokin.inverse.one_target_arm import NO_TAPE, OneTargetArm, kernel_of, limits_of
from robokin.jobs.arbitrary_numbers import arbitrary
from robokin.kernel.chain import FAR, Chain, chain_of, chain_size, with_joints_at
from robokin.kernel.entries import EntryFrame
from robokin.kernel.facts import fact
from robokin.kernel.frames import pose, program_to_tool
from robokin.kernel.straight_line import StraightResiduals, straight_residuals
from robokin.kernel.traced_numbers import NAME, NumberTrace
from robokin.model import Robot
from robokin.spatial.angles import TURN

SAMPLES = (0.7318, -1.1934, 2.2871)
"""Values [rad] at which the code is made and looked at: unlike right angles, no arm's favourites."""

MOST_CODES = 8
"""Codes that are kept for the same joints; values at which another one would be needed are analysed as any arm."""

PROOFS, TRIALS = 3, 4
"""At how many values, and at how many poses of each, a code is compared with the solver before it is taken as it is."""

ALIKE = 1e-7
"""Joint values [rad] that differ by less are the same root: at the trial poses roots are far from each other."""

_Known = tuple[Analysis, StraightForm | None, FormTape | None, object | None]
"""An analysis; its closed form as code and as a tape, or the native kernel's elimination."""

ROUND = 1e-3
"""Cosines and sines that are nearer to 0 or ±1 may belong to an arm that other eliminations serve better."""

NUMBERS = ("A", "B", "C", "D", "P", "Q", "near", "far")
"""What of a solver its code is made from."""


@fact
def held_forms(robot: Robot, joints: tuple[int, ...]) -> HeldForms | None:
    """What is known of a robot with joints (from 0) held at any values; None where each has to be analysed."""
    if type(robot) is not Robot or robot.n - len(joints) != 6 or not robot.revolute.all():
        return None
    known = [analyse(_sample(robot, joints, shift)) for shift in range(len(SAMPLES))]
    first = known[0]
    if not isinstance(first.solver, (SphericalTriple, General)) or any(_told(one) != _told(first) for one in known):
        return None
    residuals = straight_residuals(program_to_tool(chain_of(robot)))
    if residuals is None or not first.complete or first.redundancy or first.number is None:
        return None
    return HeldForms(robot, joints, known, residuals)


def _sample(robot: Robot, joints: tuple[int, ...], shift: int) -> Chain:
    values = {joint: SAMPLES[(shift + k) % len(SAMPLES)] for k, joint in enumerate(joints)}
    return _chain_at(robot, values)


def _chain_at(robot: Robot, values: Mapping[int, float]) -> Chain:
    """The chain of the joints that are not held at values [rad]."""
    whole = chain_of(robot)
    chain = with_joints_at(whole, values)
    if 0 in values:
        base = whole.constants[0, :3, :3] @ whole.start + whole.constants[0, :3, 3]
        start = chain.constants[0, :3, :3].T @ (base - chain.constants[0, :3, 3])
    else:
        start = whole.start
    return replace(chain, start=start)


def _told(one: Analysis) -> tuple[Any, ...]:
    """What an analysis says in words, and of what degree it is."""
    first = one.solver.first if isinstance(one.solver, SphericalTriple) else one.number
    return one.method, one.sentence, one.complete, first


def _nearly_round(loop: Loop) -> Flags:
    """Which entries (5, 3, 3) of a loop's rotations are nearly 0 or ±1."""
    R = np.abs(loop.links[:, :3, :3])
    return (R < ROUND) | (R > 1.0 - ROUND)


class HeldForms:
    """How an arm is solved whatever the values of its held joints, by some values for which it is known.

    varied: which numbers of a closed form hang on the values; codes: what was made so far, one for each way through the
    comparisons that was met.
    """

    def __init__(
        self, robot: Robot, joints: tuple[int, ...], known: Sequence[Analysis], residuals: StraightResiduals
    ) -> None:
        self.robot, self.joints, self.known = robot, joints, known[0]
        self.whole_residuals = residuals
        self.codes: list[_Code] = []
        self.varied: list[bool] = []
        if isinstance(self.known.solver, SphericalTriple):
            numbers = zip(*(_numbers(one.solver) for one in known), strict=True)
            self.varied = [any(abs(number) not in (0.0, 1.0) for number in column) for column in numbers]
        free = [i for i in range(robot.n) if i not in joints]
        self.bounds, self.turning = limits_of(robot.limits[free])

    def arm(self, values: Sequence[float], whose: Callable[[], Robot]) -> OneTargetArm | None:
        """What is known of the arm that is left with the joints at some values [rad]; None at special ones."""
        chain = _chain_at(self.robot, dict(zip(self.joints, values, strict=True)))
        size = chain_size(chain)
        if float(np.sqrt(np.square(chain.constants[1:, :3, 3]).sum(axis=1)).sum()) > FAR * size:
            return None
        if not moves_in_all_directions(chain, size):
            return None
        six = Padded(window_chain(chain, self.known.window), 0)
        loop = loop_of(six.chain, None if chain.start.any() else size)
        analysis = replace(self.known, chain=chain, size=size, solved=chain, six=six, loop=loop)
        if isinstance(self.known.solver, General):
            known = self._eliminated(analysis, loop)
        else:
            known = self._formed(analysis, loop)
        if known is None:
            return None
        analysis, form, tape, elimination = known
        return OneTargetArm(
            whose, analysis, form, self._residuals(values), loop, tuple(chain.offsets.tolist()), size, self.bounds,
            self.turning, kernel_of(analysis, tape, self.bounds, self.turning), elimination,
        )  # fmt: skip

    def _formed(self, analysis: Analysis, loop: Loop) -> _Known | None:
        """What is known by a closed form."""
        solver = self._solver(loop)
        found = None if solver is None else self._coded(solver, loop)
        if found is None:
            return None
        code, constants = found
        analysis = replace(analysis, solver=solver, number=code.number)
        return analysis, code.form(constants), code.tape_of(constants), None

    def _eliminated(self, analysis: Analysis, loop: Loop) -> _Known | None:
        """What is known by elimination with the same splits, if it finds as many complex solutions.

        There are never more than at other values, so that where N are found these are all.
        """
        assert self.known.loop is not None
        if not np.array_equal(_nearly_round(loop), _nearly_round(self.known.loop)):
            return None  # other splits may serve better
        if any(form.find(loop) is not None for form in CLOSED_FORMS):
            return None
        solver = General(loop, self.known.solver.splits)
        analysis = replace(analysis, solver=solver)
        assert analysis.six is not None
        try:
            native = native_elimination(solver.first, loop, analysis.six.chain, analysis.number)
            if native is None:
                whole = generic_count(loop, solver.splits) == analysis.number
            else:
                q = np.pi * arbitrary(7, TRIALS, 6) - analysis.six.chain.offsets
                whole = bool(np.count_nonzero(native.many(pose(analysis.six.chain, q))[-1]) > TRIALS // 2)
        except np.linalg.LinAlgError:
            return None
        if not whole:
            return None
        return analysis, None, None if native is None else NO_TAPE, None if native is None else native.known

    def _solver(self, loop: Loop) -> SphericalTriple | None:
        """The solver of a loop, if it is of the same axes as the one that is known."""
        meeting = meeting_triples(loop)
        first = self.known.solver.first
        # With the triple at an end of the loop the equations are of a lower degree than with one in the middle.
        if meeting == [first] or (first in meeting and {first, *meeting} <= {first, 1, 2} and first in (0, 3)):
            try:
                return SphericalTriple(loop, first)
            except SingularEverywhereError:
                return None
        solver = SphericalTriple.find(loop) if first in meeting else None
        return solver if solver is not None and solver.first == first else None

    def _coded(self, solver: SphericalTriple, loop: Loop) -> tuple[_Code, tuple[float, ...]] | None:
        """The code of a solver, and the numbers that its names stand for."""
        for code in self.codes:
            constants = code.constants(solver)
            if constants is not None:
                # What came about by other means than the trace knows would show.
                if code.proofs < PROOFS:
                    if not code.serves(solver, loop, constants):
                        self.codes = [one for one in self.codes if one is not code]
                        return None
                    code.proofs += 1
                return code, constants
        if len(self.codes) >= MOST_CODES:
            return None
        made = _Code.traced(solver, self.varied, solver.candidates(trial_closing(loop)).leaves)
        constants = None if made is None else made.constants(solver)
        if made is None or constants is None or not made.serves(solver, loop, constants):
            return None
        self.codes.append(made)
        return made, constants

    def _residuals(self, values: Sequence[float]) -> StraightResiduals:
        """How far configurations of the other joints are from a target."""
        held = sorted(zip(self.joints, values, strict=True))

        def residuals(rows: list[list[float]], target: list[float]) -> list[tuple[float, float]]:
            whole = [row.copy() for row in rows]
            for row in whole:
                for joint, value in held:
                    row.insert(joint, value)
            return self.whole_residuals(whole, target)

        return residuals


class _Code:
    """The code of a solver's closed form with names for the numbers that vary.

    varied, fixed: which of the solver's numbers do, and what the others are; number: how many roots it has; source,
    names: the code and its names; calculated: their numbers from those of a solver; proofs: how often it was compared
    with a solver; maker, tape: the code as a function of the numbers, and as a tape.
    """

    def __init__(
        self,
        varied: Sequence[bool],
        fixed: list[float],
        number: int | None,
        source: str,
        calculated: Callable[[Sequence[float]], tuple[float, ...] | None],
    ) -> None:
        self.varied, self.fixed, self.number = varied, fixed, number
        self.source, self.calculated, self.proofs = source, calculated, 0
        self.names = _names(source)
        self.maker = form_maker(source, self.names)
        self.tape = form_tape(source)
        places = {name: k for k, name in enumerate(self.names)}
        self.places = [] if self.tape is None else [(k, places[name]) for k, name in self.tape.names]

    @classmethod
    def traced(cls, solver: SphericalTriple, varied: Sequence[bool], number: int | None) -> _Code | None:
        """The code of a solver; None where there is none."""
        trace, numbers, which = NumberTrace(), _numbers(solver), iter(varied)

        def taken(number: float) -> float:
            return trace.given(number) if next(which) else number

        one = _rebuilt(solver, taken)
        one.prepare()
        source = straight_source(one)
        if source is None:
            return None
        fixed = [number for number, varies in zip(numbers, varied, strict=True) if not varies]
        return cls(varied, fixed, number, source, trace.function(_names(source)))

    def constants(self, solver: SphericalTriple) -> tuple[float, ...] | None:
        """The numbers that the names stand for; None for a solver of which the code is another."""
        given: list[float] = []
        fixed: list[float] = []
        for number, varies in zip(_numbers(solver), self.varied, strict=True):
            (given if varies else fixed).append(number)
        try:
            return self.calculated(given) if fixed == self.fixed else None
        except (ValueError, ZeroDivisionError):
            return None

    def serves(self, solver: SphericalTriple, loop: Loop, constants: tuple[float, ...]) -> bool:
        """Whether the code gives what a solver gives, at some poses."""
        closing = closing_at(loop, np.pi * arbitrary(7, TRIALS, 6))
        form, wanted = self.form(constants), solver.candidates(closing)
        served = 0
        for k in range(TRIALS):
            leaves = form(closing[k, :3].ravel().tolist())
            if leaves is None:
                continue  # a pose that is left to the arrays
            off = np.array(leaves).reshape(-1, 1, 6) - wanted.values[wanted.index == k]
            off = np.abs(np.remainder(off + np.pi, TURN) - np.pi).max(axis=2)
            if off.shape[0] != off.shape[1] or (off.min(axis=0, initial=1.0) > ALIKE).any():
                return False
            served += 1
        return served > 0

    def form(self, constants: tuple[float, ...]) -> Any:
        """The code as a function of the target."""
        return self.maker(*constants)

    def tape_of(self, constants: tuple[float, ...]) -> FormTape | None:
        """The code as a tape."""
        if self.tape is None:
            return None
        numbers: Array = self.tape.constants.copy()
        for k, place in self.places:
            numbers[k] = constants[place]
        return replace(self.tape, constants=numbers)


def _names(source: str) -> list[str]:
    return list(dict.fromkeys(NAME.findall(source)))


def _numbers(solver: SphericalTriple) -> list[float]:
    """All that a solver's code is made from, in one order."""
    numbers: list[float] = []
    for frame in (solver.A, solver.B, solver.C, solver.D):
        if frame is not None:
            for row in frame.R:
                numbers += cast(Sequence[float], row)
            numbers += cast(Sequence[float], frame.t)
    for rotation in (solver.P, solver.Q):
        for row in rotation:
            numbers += cast(Sequence[float], row)
    return [*numbers, solver.near, solver.far]


def _rebuilt(thing: Any, taken: Callable[[float], float]) -> Any:
    """A thing with other numbers in it."""
    if isinstance(thing, float):
        return taken(thing)
    if isinstance(thing, (list, tuple)):
        return type(thing)([_rebuilt(part, taken) for part in thing])
    if isinstance(thing, EntryFrame):
        return EntryFrame(_rebuilt(thing.R, taken), _rebuilt(thing.t, taken))
    if isinstance(thing, SphericalTriple):
        one = copy.copy(thing)
        for name in NUMBERS:
            setattr(one, name, _rebuilt(getattr(thing, name), taken))
        return one
    return thing
