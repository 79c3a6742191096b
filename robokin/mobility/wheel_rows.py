"""What a wheel forbids a base, and what its motors command: rows on the base's twist.

A twist is (v_x, v_y, ω) in the base's frame, about a middle point of the wheels, lengths in a size of the base. A
point (x, y) of the base goes at (v_x - ω y, v_y + ω x). Rows, for a wheel that rolls in the direction φ:

    across    -sin φ (v_x - ω y) + cos φ (v_y + ω x)     0 for fixed and steered wheels: they do not slip sideways
    along      cos φ (v_x - ω y) + sin φ (v_y + ω x)     the speed of rolling, r φ̇, of a wheel that a motor rolls

A Swedish wheel's rollers let it slip in their own direction, so that only the speed across that one follows from its
motor; a driven ball (a ball between rollers, one of them driven) goes at the motor's speed along φ and rolls freely
across. A castor's wheel stands behind its swivel by the offset d: its roll commands the swivel's speed along φ, and a
motor at the swivel the speed of the wheel's point across it, which is d times the swivel's turning.

Sources: G. Campion, G. Bastin, B. d'Andréa-Novel, "Structural properties and classification of kinematic and dynamic
models of wheeled mobile robots", IEEE Trans. Robotics and Automation 12(1), 1996, section II, for the constraints; M.
West, H. Asada, "Design of ball wheel mechanisms for omnidirectional vehicles with full mobility and invariant
kinematics", J. Mechanical Design 119(2), 1997, for balls.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array
from robokin.kernel.ranks import WHEEL_RANK
from robokin.model import Wheel


@dataclass(frozen=True, eq=False)
class WheelFrame:
    """Where twists are taken, (x, y) [m], and the length [m] that is one: so ranks depend on neither place nor size."""

    x: float
    y: float
    size: float

    @classmethod
    def of(cls, wheels: Sequence[Wheel]) -> WheelFrame:
        """The middle of the wheels and the greatest distance from it."""
        places = np.array([(wheel.x, wheel.y) for wheel in wheels])
        x, y = places.mean(axis=0)
        spread = float(np.max(np.hypot(*(places - (x, y)).T)))
        # The mean of equal places is off by rounding: that is no size.
        return cls(float(x), float(y), spread if spread > 1e-12 * np.max(np.abs(places)) else 1.0)

    def place(self, wheel: Wheel) -> tuple[float, float]:
        """A wheel's place in this frame, in its size."""
        return (wheel.x - self.x) / self.size, (wheel.y - self.y) / self.size

    def along(self, wheel: Wheel, angle: float) -> Array:
        """(3,) the row of the speed in a direction."""
        (x, y), c, s = self.place(wheel), np.cos(angle), np.sin(angle)
        return np.array([c, s, s * x - c * y])

    def heading(self, wheel: Wheel, twist: Array) -> float:
        """The direction in which a wheel's point goes when the base moves with a twist (3,); its own at rest."""
        x, y = self.place(wheel)
        v_x, v_y = twist[0] - twist[2] * y, twist[1] + twist[2] * x
        return float(np.arctan2(v_y, v_x)) if np.hypot(v_x, v_y) > WHEEL_RANK else wheel.angle


def sliding_row(frame: WheelFrame, wheel: Wheel, angle: float) -> Array:
    """(3,) what a fixed or steered wheel that rolls in a direction forbids: speed across it."""
    return frame.along(wheel, angle + 0.5 * np.pi)


def command_rows(frame: WheelFrame, wheel: Wheel, angle: float) -> list[Array]:
    """Rows (3,) of the speeds that a wheel's motors command, at the direction in which it stands."""
    if wheel.type == "swedish":
        # Across the rollers, where they cannot slip.
        return [frame.along(wheel, wheel.angle + wheel.roller - 0.5 * np.pi)] if wheel.driven else []
    rows = [frame.along(wheel, angle)] if wheel.driven else []
    if wheel.type == "castor" and wheel.turned:
        behind = frame.along(wheel, angle + 0.5 * np.pi)
        behind[2] -= wheel.offset / frame.size
        rows.append(behind)
    return rows


def rank_of(rows: Array) -> int:
    """How many of the rows (r, k) are independent."""
    if not rows.size:
        return 0
    values = np.linalg.svd(rows, compute_uv=False)
    return int(np.sum(values > WHEEL_RANK * max(values[0], 1.0)))


def kernel_of(rows: Array) -> Array:
    """The twists (3, k) that rows (r, 3) are zero for."""
    if not len(rows):
        return np.eye(3)
    _, _, Vt = np.linalg.svd(rows)
    return np.asarray(Vt[rank_of(rows) :].T)
