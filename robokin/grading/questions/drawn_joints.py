"""Joint values that a question gives: few digits, inside the limits, no multiples of a right angle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array, Flags
from robokin.errors import InputError
from robokin.grading.questions.seeded_numbers import SeededNumbers
from robokin.grading.questions.typed_numbers import multiples, round_step, whole_turn
from robokin.kinematics.structure import arm_size
from robokin.model import Robot

STEPS = {"deg": ((5, 0), (1, 0), (5, -1), (1, -1), (1, -2)), "rad": ((1, -1), (5, -2), (1, -2), (1, -3))}
"""Steps of angles, the roundest first; the first is taken that leaves a joint enough values."""

ENOUGH = 8

WIDEST = {"deg": 170.0, "rad": 3.0}
"""Angles are drawn to this on both sides of zero, whatever the limits."""

INSIDE, INSIDE_PART = np.radians(2.617), 0.0137
"""Values are this far inside their limits: an angle [rad], but no more than the part of a joint's range."""


@dataclass(frozen=True)
class JointChoices:
    """The values that each joint of a robot may be given, in its units."""

    values: tuple[tuple[float, ...], ...]

    def draw(self, numbers: SeededNumbers) -> list[float]:
        """One configuration."""
        return [numbers.choice(values) for values in self.values]


def joint_choices(robot: Robot) -> JointChoices:
    """The values for each joint. Raises InputError where one cannot move by what can be typed."""
    units, size = robot.units, arm_size(robot)
    found = []
    for i, (turns, (low, high)) in enumerate(zip(robot.revolute, robot.limits, strict=True), start=1):
        low, high = _drawn_range(bool(turns), float(low), float(high), WIDEST[units.angle] * units.radians, size)
        inside = margin(turns, high - low)
        factor = units.radians if turns else units.metres
        found.append(_values((low + inside) / factor, (high - inside) / factor, turns, units.angle))
        if not found[-1]:
            raise InputError(f"joint {i} of {robot.name} hardly moves, expected limits with room for a question")
    return JointChoices(tuple(found))


def _drawn_range(turns: bool, low: float, high: float, widest: float, size: float) -> tuple[float, float]:
    """Where values are drawn [rad | m]: within the limits, of a slide without one by the arm's size."""
    if turns:
        return max(low, -widest), min(high, widest)
    if np.isinf(low) and np.isinf(high):
        return -size, size
    return (high - size, high) if np.isinf(low) else (low, low + size) if np.isinf(high) else (low, high)


def margin(turns: bool, width: float) -> float:
    """How far [rad | m] inside its limits a value is, and a solution's from them; width: of the range [rad | m]."""
    part = INSIDE_PART * width if np.isfinite(width) else np.inf
    return float(min(INSIDE, part)) if turns else float(part) if np.isfinite(part) else 0.0


def _values(low: float, high: float, turns: bool, angle: str) -> tuple[float, ...]:
    if high <= low:
        return ()
    steps = STEPS[angle] if turns else (round_step((high - low) / 20.0), round_step((high - low) / 200.0))
    best: list[float] = []
    for step in steps:
        every = multiples(step, low, high)
        best = [value for value in every if value and not (turns and angle == "deg" and value % 90.0 == 0.0)]
        if len(best) >= ENOUGH:
            break
    return tuple(best)


def clear_of_limits(robot: Robot, q: Array) -> Flags:
    """(m,) whether solutions q: (m, n) [rad | m] are well inside or well outside the limits, angles by any turns."""
    widths = (robot.limits[:, 1] - robot.limits[:, 0]).tolist()
    inside = np.array([margin(*joint) for joint in zip(robot.revolute.tolist(), widths, strict=True)])
    finite = np.isfinite(robot.limits)
    bounds = np.where(finite, robot.limits, 0.0)
    off = np.abs(whole_turn(q[:, :, None] - bounds, robot.revolute[:, None]))
    return np.asarray(np.all((off > inside[:, None]) | ~finite, axis=(1, 2)))
