"""Wheeled bases: degree of mobility, of steerability, of manoeuvrability; holonomic or not.

Statement. A base on a plane has the twist (v_x, v_y, ω) in its own frame. A standard wheel at (x, y) that rolls in the
direction φ cannot slip sideways,

    -sin φ (v_x - ω y) + cos φ (v_y + ω x) = 0;

fixed wheels give rows C_f, steered ones rows C_s(β); castor and Swedish wheels give none. Then

    degree of mobility        δ_m = 3 - rank [C_f; C_s(β)],
    degree of steerability    δ_s = rank of the change of β with the centre of rotation: what can be steered freely,
    degree of manoeuvrability δ_M = δ_m + δ_s.

The ranks are those at steering angles that share a centre of rotation, as a steering linkage or a controller keeps
them: at angles taken at random a car could not move at all. The centre lies on the axles of all fixed wheels; where
those leave none, or only a point, nothing is left to steer.

Holonomic is a base that can at once move in all the directions in which it can get anywhere: δ_m equals the dimension
of what Lie brackets of its motions, at all steering angles, span. The lecture's ratio is that of controllable freedoms
(here δ_m) to all of them (3 in the plane).

Source: G. Campion, G. Bastin, B. d'Andréa-Novel, "Structural properties and classification of kinematic and dynamic
models of wheeled mobile robots", IEEE Trans. Robotics and Automation 12(1), 1996.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robokin.model import Wheel, WheeledBase

Array = NDArray[np.float64]

RANK = 1e-9
"""Singular values below this part of the greatest are zero: tables of wheels are exact or given to three digits."""

NO_TURN = np.array([[0.0, 0.0, 1.0]])
"""The constraint of wheels that stay parallel: the base does not turn."""

SAMPLES = 12
"""Centres of rotation at which the steered wheels are looked at; their places mean nothing."""


@dataclass(frozen=True)
class Manoeuvrability:
    """δ_m, δ_s and their sum; reachable: the dimension of what the base can get to (3: every place and heading).

    note: what is special, or None.
    """

    mobility: int
    steerability: int
    reachable: int
    note: str | None

    @property
    def manoeuvrability(self) -> int:
        """δ_M = δ_m + δ_s."""
        return self.mobility + self.steerability

    @property
    def total(self) -> int:
        """The freedoms of a rigid body in the plane."""
        return 3

    @property
    def ratio(self) -> float:
        """Controllable to total freedoms, as the lecture has it."""
        return self.mobility / self.total

    @property
    def holonomic(self) -> bool:
        """Whether the base can at once move in every direction in which it can get anywhere."""
        return self.mobility == self.reachable


def manoeuvrability_of(base: WheeledBase) -> Manoeuvrability:
    """What the wheels let a base do."""
    size = max(float(np.hypot(wheel.x, wheel.y)) for wheel in base.wheels) or 1.0
    fixed = np.array([_row(wheel, wheel.angle, size) for wheel in base.wheels if wheel.type == "fixed"]).reshape(-1, 3)
    steered = [wheel for wheel in base.wheels if wheel.type == "steered"]
    bound = _rank(fixed)
    shared = np.concatenate([fixed, NO_TURN]) if base.parallel and steered else fixed
    free = _kernel(shared)
    twists = _twists_of(free, bool(steered))
    mobility = 3
    moves = []
    for twist in twists:
        rows = [fixed, *(_row(wheel, _heading(wheel, twist, size), size)[None] for wheel in steered)]
        C = np.concatenate(rows)
        mobility = min(mobility, 3 - _rank(C))
        moves.append(_kernel(C))
    steerability = max((_rank(_steering(steered, twist, free, size)) for twist in twists), default=0)
    reachable = _closure(np.concatenate(moves, axis=1))
    note = None
    if mobility == 0:
        note = "the axles of the wheels have no common point: the base cannot move without slipping"
    elif bound >= 2 and abs(twists[0][2]) < RANK:
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
    return Manoeuvrability(mobility, steerability, reachable, note)


def _row(wheel: Wheel, angle: float, size: float) -> Array:
    """The wheel's constraint on (v_x, v_y, ω), lengths in `size`."""
    s, c = np.sin(angle), np.cos(angle)
    return np.array([-s, c, (s * wheel.y + c * wheel.x) / size])


def _heading(wheel: Wheel, twist: Array, size: float) -> float:
    """The angle at which a steered wheel rolls along when the base moves with a twist (v_x, v_y, ω size)."""
    v_x = twist[0] - twist[2] * wheel.y / size
    v_y = twist[1] + twist[2] * wheel.x / size
    return float(np.arctan2(v_y, v_x)) if np.hypot(v_x, v_y) > RANK else wheel.angle


def _twists_of(free: Array, steers: bool) -> list[Array]:
    """Twists of those (3, k) that the fixed wheels allow, at which the steered wheels can share the centre."""
    if not free.shape[1]:
        return [np.zeros(3)]
    if not steers:
        return [free[:, 0]]
    rng = np.random.default_rng(4)
    return [free @ rng.normal(size=free.shape[1]) for _ in range(SAMPLES)]


def _steering(steered: list[Wheel], twist: Array, free: Array, size: float) -> Array:
    """How the angles of steered wheels (s, k) change as the twist does within those that are free (3, k)."""
    rows = []
    for wheel in steered:
        x, y = np.array([1.0, 0.0, -wheel.y / size]), np.array([0.0, 1.0, wheel.x / size])
        v_x, v_y = x @ twist, y @ twist
        rows.append((v_x * y - v_y * x) / max(v_x * v_x + v_y * v_y, RANK))
    return np.array(rows).reshape(-1, 3) @ free


def _rank(C: Array) -> int:
    if not len(C):
        return 0
    values = np.linalg.svd(C, compute_uv=False)
    return int(np.sum(values > RANK * max(values[0], RANK)))


def _kernel(C: Array) -> Array:
    """The twists (3, k) that the constraints (r, 3) allow."""
    if not len(C):
        return np.eye(3)
    _, _, Vt = np.linalg.svd(C)
    return np.asarray(Vt[_rank(C) :].T)


def _closure(twists: Array) -> int:
    """The dimension of the Lie algebra that twists (3, k) of the plane's motions make."""
    while True:
        before = _rank(twists.T)
        brackets = np.array([_bracket(a, b) for a in twists.T for b in twists.T]).reshape(-1, 3)
        U, values, _ = np.linalg.svd(np.concatenate([twists, brackets.T], axis=1))
        if not len(values):
            return 0
        after = int(np.sum(values > RANK * max(values[0], RANK)))
        twists = U[:, :after]
        if after == before:
            return after


def _bracket(a: Array, b: Array) -> Array:
    """[a, b] of two twists (v_x, v_y, ω) of the plane."""
    return np.array([b[2] * a[1] - a[2] * b[1], a[2] * b[0] - b[2] * a[0], 0.0])
