"""What the motors of a wheeled base command of its freedoms.

Let N (3, δ_m) span the twists that the constraints leave and D hold the rows of what the motors at wheels and castors
command. The commanded speeds D ξ determine the twist ξ in N up to the kernel of D N. So

    controllable    rank of D N, of the δ_m freedoms;
    uncontrolled    δ_m less that: freedoms in which the base drifts, rolls or is pushed as it likes;
    conditions      rows of D less that rank: the motors' speeds must fit together in so many ways, or wheels slip;
    steering        rank of the change of the motor-turned wheels' angles, of the δ_s freedoms of steering.

The rank is that at castor angles taken at random, as they are in almost all of the motion; `least` is the least of
those when castors have trailed behind a motion, straight ones among them, where driven castors stand parallel.

Source: G. Campion, G. Bastin, B. d'Andréa-Novel, IEEE Trans. Robotics and Automation 12(1), 1996, section V: motors
suffice if the rows of their wheels have full rank on the space that the constraints leave.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array
from robokin.mobility.wheel_rows import WheelFrame, command_rows, rank_of
from robokin.model import Wheel, WheeledBase

STRAIGHT = 8
"""Directions of straight motion behind which castors are let trail: their places mean nothing."""


@dataclass(frozen=True)
class Commanded:
    """controllable: of the degree of mobility; least: where castors trail; steering: of the degree of steerability;
    speeds: how many are commanded; conditions: how many conditions they must satisfy; note: what is special, or None.
    """

    controllable: int
    least: int
    steering: int
    speeds: int
    conditions: int
    note: str | None


def commands_of(
    base: WheeledBase, frame: WheelFrame, situations: Sequence[tuple[Array, Array]], steering: Array, free: Array
) -> Commanded:
    """What the motors command.

    situations: twists (3,) for which the steered wheels stand and the twists (3, k) that the constraints then leave;
    steering: (s, k) how the angles of the steered wheels change; free: (3, k) what the fixed wheels leave.
    """
    rng = np.random.default_rng(7)
    driven = [wheel for wheel in base.wheels if wheel.driven or (wheel.turned and wheel.type == "castor")]
    random = {
        wheel.name: float(angle) for wheel, angle in zip(base.wheels, rng.uniform(-3, 3, len(base.wheels)), strict=True)
    }
    ranks, trailing, speeds = [0], [], 0
    for twist, N in situations:
        rows = _rows(frame, driven, twist, random)
        speeds = len(rows)
        ranks.append(rank_of(rows @ N))
        for ahead in (twist, *_straight(free)):
            behind = {wheel.name: frame.heading(wheel, ahead) for wheel in base.wheels}
            if rank_of(np.column_stack([N, ahead])) == N.shape[1]:
                trailing.append(rank_of(_rows(frame, driven, twist, behind) @ N))
    controllable = max(ranks)
    least = min([controllable, *trailing]) if any(wheel.type == "castor" for wheel in driven) else controllable
    steered = [wheel for wheel in base.wheels if wheel.type == "steered"]
    turned = [
        i for i, wheel in enumerate(steered) if wheel.turned or (base.parallel and any(w.turned for w in steered))
    ]
    commanded = rank_of(steering[turned]) if len(steering) and turned else 0
    mobility = min((N.shape[1] for _, N in situations), default=0)
    conditions = speeds - controllable
    note = _note(base, mobility, controllable, least, conditions, rank_of(steering) - commanded)
    return Commanded(controllable, least, commanded, speeds, conditions, note)


def _rows(frame: WheelFrame, driven: Sequence[Wheel], twist: Array, castors: dict[str, float]) -> Array:
    """(r, 3) the rows of all motors: steered wheels stand for a twist, castors at given angles."""
    rows: list[Array] = []
    for wheel in driven:
        angle = wheel.angle
        if wheel.type == "castor":
            angle = castors[wheel.name]
        elif wheel.type == "steered":
            angle = frame.heading(wheel, twist)
        rows += command_rows(frame, wheel, angle)
    return np.array(rows).reshape(-1, 3)


def _straight(free: Array) -> list[Array]:
    """Twists without a turn (3,) among those that are free (3, k)."""
    ways = [np.array([np.cos(t), np.sin(t), 0.0]) for t in np.pi * np.arange(STRAIGHT) / STRAIGHT]
    return [way for way in ways if rank_of(np.column_stack([free, way])) == free.shape[1]]


def _note(
    base: WheeledBase, mobility: int, controllable: int, least: int, conditions: int, unsteered: int
) -> str | None:
    """What is special about the motors, in words."""
    parts = []
    if not controllable and mobility:
        parts.append(
            "no wheel is driven" if not any(w.driven for w in base.wheels) else "the driven wheels do not move it"
        )
    elif controllable < mobility:
        left = mobility - controllable
        parts.append(f"{left} freedom{'s' if left > 1 else ''} that no motor commands")
    if unsteered:
        parts.append(f"{unsteered} freedom{'s' if unsteered > 1 else ''} of steering that no motor commands")
    if conditions and mobility:
        parts.append(
            f"the motors' speeds must fit together in {conditions} way{'s' if conditions > 1 else ''}, or wheels slip"
        )
    if least < controllable:
        parts.append(f"only {least} where the driven castors stand in line, as after going straight")
    return "; ".join(parts) or None
