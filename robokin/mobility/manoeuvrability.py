"""Wheeled bases: degree of mobility, of steerability, of manoeuvrability; what motors command; holonomic or not.

Statement. A base on a plane has the twist (v_x, v_y, ω) in its own frame. A standard wheel cannot slip sideways, which
is a row on the twist; fixed wheels give rows C_f, steered ones rows C_s(β); castors, Swedish wheels and balls give
none. Then

    degree of mobility        δ_m = 3 - rank [C_f; C_s(β)],
    degree of steerability    δ_s = rank of the change of β with the centre of rotation: what can be steered freely,
    degree of manoeuvrability δ_M = δ_m + δ_s.

The ranks are those at steering angles that share a centre of rotation, as a steering linkage or a controller keeps
them: at angles taken at random a car could not move at all. The centre lies on the axles of all fixed wheels; where
those leave none, or only a point, nothing is left to steer.

These are what the wheels allow. What the motors command of it is the rank of their rows on the twists that the
constraints leave: `wheel_drives`. Holonomic is a base that can at once be driven in all the directions in which it can
get anywhere: what is controllable equals the dimension of what Lie brackets of its motions, at all steering angles,
span. The lecture's ratio is that of controllable freedoms to all of them (3 in the plane).

Source: G. Campion, G. Bastin, B. d'Andréa-Novel, "Structural properties and classification of kinematic and dynamic
models of wheeled mobile robots", IEEE Trans. Robotics and Automation 12(1), 1996.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array
from robokin.brief import Answer
from robokin.kernel.ranks import WHEEL_RANK
from robokin.mobility.wheel_drives import Commanded, commands_of
from robokin.mobility.wheel_rows import WheelFrame, kernel_of, rank_of, sliding_row
from robokin.model import Wheel, WheeledBase, expect_wheeled

NO_TURN = np.array([[0.0, 0.0, 1.0]])
"""The constraint of wheels that stay parallel: the base does not turn."""

SAMPLES = 12
"""Centres of rotation at which the steered wheels are looked at; their places mean nothing."""


@dataclass(frozen=True, repr=False)
class Manoeuvrability(Answer):
    """δ_m, δ_s and their sum; reachable: the dimension of what the base can get to (3: every place and heading).

    commands: what its motors command of them; note: what is special, or None.
    """

    mobility: int
    steerability: int
    reachable: int
    commands: Commanded
    note: str | None
    base: WheeledBase

    def __repr__(self) -> str:
        """A line: the three degrees, and what the motors command."""
        return (
            f"<{self.base.id or self.base.name}: mobility {self.mobility}, steerability {self.steerability}, "
            f"manoeuvrability {self.manoeuvrability}, controllable {self.controllable}>"
        )

    @property
    def manoeuvrability(self) -> int:
        """δ_M = δ_m + δ_s."""
        return self.mobility + self.steerability

    @property
    def controllable(self) -> int:
        """How many of the δ_m freedoms the motors command."""
        return self.commands.controllable

    @property
    def uncontrolled(self) -> int:
        """How many of the δ_m freedoms no motor commands."""
        return self.mobility - self.commands.controllable

    @property
    def total(self) -> int:
        """The freedoms of a rigid body in the plane."""
        return 3

    @property
    def ratio(self) -> float:
        """Controllable to total freedoms, as the lecture has it."""
        return self.controllable / self.total

    @property
    def holonomic(self) -> bool:
        """Whether the base can at once be driven in every direction in which it can get anywhere."""
        return self.controllable == self.reachable


def manoeuvrability_of(base: WheeledBase) -> Manoeuvrability:
    """What the wheels let a base do, and what its motors command of that. Raises InputTypeError.

    Source: G. Campion, G. Bastin, B. d'Andréa-Novel, Structural properties and classification of kinematic and dynamic
    models of wheeled mobile robots, IEEE Trans. Robotics and Automation 12(1), 1996.
    """
    base = expect_wheeled(base)
    frame = WheelFrame.of(base.wheels)
    rows = [sliding_row(frame, wheel, wheel.angle) for wheel in base.wheels if wheel.type == "fixed"]
    fixed = np.array(rows).reshape(-1, 3)
    steered = [wheel for wheel in base.wheels if wheel.type == "steered"]
    bound = rank_of(fixed)
    shared = np.concatenate([fixed, NO_TURN]) if base.parallel and steered else fixed
    free = kernel_of(shared)
    twists = _twists_of(free, bool(steered))
    situations = []
    for twist in twists:
        C = [fixed, *(sliding_row(frame, wheel, frame.heading(wheel, twist))[None] for wheel in steered)]
        situations.append((twist, kernel_of(np.concatenate(C))))
    mobility = min(N.shape[1] for _, N in situations)
    situations = [(twist, N) for twist, N in situations if N.shape[1] == mobility]
    steerings = [_steering(steered, twist, free, frame) for twist in twists]
    steering = steerings[int(np.argmax([rank_of(rows) for rows in steerings]))]
    steerability = rank_of(steering)
    reachable = _closure(np.concatenate([N for _, N in situations], axis=1))
    note = None
    if mobility == 0:
        note = "the axles of the wheels have no common point: the base cannot move without slipping"
    elif bound >= 2 and abs(twists[0][2]) < WHEEL_RANK:
        note = "the axles of the fixed wheels are parallel and apart: the base can only go straight without slipping"
    elif bound >= 2:
        note = "the axles of the fixed wheels meet in one point: the base can only turn about it"
    elif steerability < len(steered):
        extra = len(steered) - steerability
        note = f"{extra} of the {len(steered)} steered wheels {'has' if extra == 1 else 'have'} to follow the others"
        if not steerability:
            note = "the steered wheels can only stay as they are: the base cannot move when they are turned"
        if base.parallel:
            note = "the steered wheels stay parallel: the base never turns"
    commands = commands_of(base, frame, situations, steering, free)
    return Manoeuvrability(mobility, steerability, reachable, commands, note, base)


def _twists_of(free: Array, steers: bool) -> list[Array]:
    """Twists of those (3, k) that the fixed wheels allow, at which the steered wheels can share the centre."""
    if not free.shape[1]:
        return [np.zeros(3)]
    if not steers:
        return [free[:, 0]]
    rng = np.random.default_rng(4)
    return [free @ rng.normal(size=free.shape[1]) for _ in range(SAMPLES)]


def _steering(steered: list[Wheel], twist: Array, free: Array, frame: WheelFrame) -> Array:
    """How the angles of steered wheels (s, k) change as the twist does within those that are free (3, k)."""
    rows = []
    for wheel in steered:
        x, y = frame.along(wheel, 0.0), frame.along(wheel, 0.5 * np.pi)
        v_x, v_y = float(x @ twist), float(y @ twist)
        rows.append((v_x * y - v_y * x) / max(v_x * v_x + v_y * v_y, WHEEL_RANK))
    return np.array(rows).reshape(-1, 3) @ free


def _closure(twists: Array) -> int:
    """The dimension of the Lie algebra that twists (3, k) of the plane's motions make."""
    while True:
        before = rank_of(twists.T)
        brackets = np.array([_bracket(a, b) for a in twists.T for b in twists.T]).reshape(-1, 3)
        U, values, _ = np.linalg.svd(np.concatenate([twists, brackets.T], axis=1))
        if not len(values):
            return 0
        after = int(np.sum(values > WHEEL_RANK * max(values[0], 1.0)))
        twists = U[:, :after]
        if after == before:
            return after


def _bracket(a: Array, b: Array) -> Array:
    """[a, b] of two twists (v_x, v_y, ω) of the plane."""
    return np.array([b[2] * a[1] - a[2] * b[1], a[2] * b[0] - b[2] * a[0], 0.0])
