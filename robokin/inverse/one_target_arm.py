"""What is known of an arm whose poses can be answered one by one, without blocks.

Statement. Put together once what the answer for a pose takes: code, limits, and the closed form as the native kernel
has it.
Derivation. Six turning joints that have a closed form as code (`straight_forms`), or are solved by elimination.
Degenerate case. None for other arms; no handle where there is no native kernel, or no tape.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from robokin.arrays import Array
from robokin.inverse.analysis import Analysis, General, analysis_of
from robokin.inverse.closed_form.form_tape import FormTape, form_tape
from robokin.inverse.closed_form.straight_forms import StraightForm, compiled_form, straight_source
from robokin.inverse.elimination.loop import Loop
from robokin.inverse.elimination.native_elimination import native_elimination
from robokin.kernel.facts import fact
from robokin.kernel.frames import program_to_tool
from robokin.kernel.native_kernel import handle, native
from robokin.kernel.straight_line import StraightResiduals, straight_residuals
from robokin.model import Robot
from robokin.model.robot import LIMIT_TOLERANCE, tolerated
from robokin.spatial.angles import TURN

NO_TAPE = FormTape(np.empty((0, 11)), np.empty(0), np.zeros((1, 6, 2)), 0, 0)
"""What stands for a closed form where there is none, and the native kernel is told the limits alone."""


class Bounds(NamedTuple):
    """A joint's limits as they count: low, high [rad], and whether a full turn may bring an angle into them."""

    joint: int
    low: float
    high: float
    beyond: bool


@dataclass(frozen=True, eq=False)
class OneTargetArm:
    """What is known of an arm of six turning joints.

    whose: gives the robot; form: the code of its closed form, None where elimination solves it; offsets: (6) [rad];
    size [m]; bounds: the limits of joints that have some; turning: joint, low and high of those that may stand a full
    turn on within their limits; kernel: what the native kernel knows the closed form and the limits by, or None;
    elimination: what it knows the elimination by.
    """

    whose: Callable[[], Robot]
    analysis: Analysis
    form: StraightForm | None
    residuals: StraightResiduals
    loop: Loop
    offsets: tuple[float, ...]
    size: float
    bounds: tuple[Bounds, ...]
    turning: tuple[tuple[int, float, float], ...]
    kernel: object | None
    elimination: object | None

    @property
    def robot(self) -> Robot:
        """The robot that is this arm."""
        return self.whose()

    @cached_property
    def _reach(self) -> tuple[float, float, float, float]:
        """Where the first joint is, and how far the arm, stretched out, reaches [m]: as `beyond_chain` has them."""
        constants = self.analysis.chain.constants
        x, y, z = constants[0, :3, 3].tolist()
        return x, y, z, float(np.sum(np.linalg.norm(constants[1:, :3, 3], axis=1))) + 1e-6 * self.analysis.size

    def beyond(self, T: Array) -> bool:
        """Whether a target T (4, 4) [m] is farther away than the arm, stretched out, is long."""
        x, y, z, length = self._reach
        return math.dist((x, y, z), T[:3, 3].tolist()) > length


@fact
def one_target_arm(robot: Robot) -> OneTargetArm | None:
    """What is known of a robot; None for one that blocks are left to solve."""
    if type(robot) is not Robot or robot.n != 6 or not robot.revolute.all():
        return None
    analysis = analysis_of(robot)
    if analysis.six is None or analysis.loop is None or not analysis.complete or analysis.redundancy:
        return None
    chain = analysis.six.chain
    general = isinstance(analysis.solver, General)
    source, residuals = straight_source(analysis.solver), straight_residuals(program_to_tool(chain))
    if residuals is None or analysis.six.virtual or analysis.number is None or not (general or source is not None):
        return None
    bounds, whole = limits_of(robot.limits)
    offsets = tuple(chain.offsets.tolist())
    form = None if source is None else compiled_form(source)
    loop, known, elimination = analysis.loop, None, None
    if source is not None:
        known = kernel_of(analysis, form_tape(source), bounds, whole)
    else:
        eliminated = native_elimination(analysis.solver.first, loop, chain, analysis.number)
        if eliminated is not None:
            known, elimination = kernel_of(analysis, NO_TAPE, bounds, whole), eliminated.known
    return OneTargetArm(
        lambda: robot, analysis, form, residuals, loop, offsets, analysis.size, bounds, whole, known, elimination
    )


def limits_of(limits: Array) -> tuple[tuple[Bounds, ...], tuple[tuple[int, float, float], ...]]:
    """Limits (6, 2) [rad] of turning joints as `OneTargetArm` has them: bounds, turning."""
    low, high = tolerated(limits)
    bounds = tuple(
        Bounds(i, float(low[i]), float(high[i]), bool(low[i] < -np.pi or high[i] > np.pi))
        for i in np.flatnonzero(np.isfinite(limits).any(axis=1)).tolist()
    )
    wide = [(i, *limits[i].tolist()) for i in np.flatnonzero(np.isfinite(limits).all(axis=1)).tolist()]
    whole = tuple(
        (i, low - LIMIT_TOLERANCE, high + LIMIT_TOLERANCE)
        for i, low, high in wide
        if high - low + 4.0 * LIMIT_TOLERANCE >= TURN
    )
    return bounds, whole


def kernel_of(
    analysis: Analysis, tape: FormTape | None, bounds: tuple[Bounds, ...], whole: tuple[tuple[int, float, float], ...]
) -> object | None:
    """What the native kernel knows a closed form by, for the limits of an arm; None where it does not."""
    assert analysis.six is not None
    assert analysis.loop is not None
    chain = handle(analysis.six.chain)
    if (
        native is None
        or chain is None
        or tape is None
        or tape.slots > native.most_slots
        or len(tape.leaves) << tape.levels > native.most_roots
    ):
        return None
    limits = np.zeros((6, 7))
    limits[:, :2] = -np.inf, np.inf
    for one in bounds:
        limits[one.joint, :4] = one.low, one.high, 1.0, one.beyond
    for joint, low, high in whole:
        limits[joint, 4:] = 1.0, low, high
    links: Array = np.stack([analysis.loop.first, analysis.loop.last])
    known: object = native.form(
        chain,
        links,
        np.array([analysis.loop.size, analysis.size]),
        tape.steps,
        tape.constants,
        tape.leaves,
        tape.levels,
        limits,
    )
    return known
