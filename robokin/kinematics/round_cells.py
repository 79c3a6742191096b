"""Cells that are round numbers but for rounding, made so: multiples of 15°, lengths of few decimals in their unit."""

from __future__ import annotations

import math
from dataclasses import replace

from robokin.arrays import Array
from robokin.kinematics.common_normal import NormalStep
from robokin.kinematics.table_cells import NEGLIGIBLE, TableCells
from robokin.model import Robot

SAME = 1e-12
"""How far, in the arm's size, the poses of a table may be from those of the robot that it is made of."""

ROUND_ANGLE = math.pi / 12.0

FEW_DECIMALS = 9
"""Decimals, in the robot's units, up to which a cell can be a round number that arithmetic has blurred."""


def round_angle(value: float) -> float:
    """An angle [rad], a multiple of 15° where it is one but for rounding."""
    part = round(value / ROUND_ANGLE)
    return part * math.pi / 12.0 if abs(value - part * ROUND_ANGLE) <= SAME else value


def rounded_cells(cells: TableCells, robot: Robot, size: float) -> TableCells:
    """The same numbers, those that are round ones but for rounding made so."""

    def length(value: float) -> float:
        return _few_digits(value, robot.units.metres, NEGLIGIBLE * size)

    def angle(value: float) -> float:
        value = round_angle(value)
        return _few_digits(value, robot.units.radians, NEGLIGIBLE) if robot.units.degrees else value

    def rounded(step: NormalStep) -> NormalStep:
        return replace(step, theta=angle(step.theta), d=length(step.d), a=length(step.a), alpha=angle(step.alpha))

    def placed(T: Array) -> Array:
        T = T.copy()
        T[:3, 3] = [length(value) for value in T[:3, 3]]
        return T

    link = (length(cells.link[0]), angle(cells.link[1]))
    steps = tuple(rounded(step) for step in cells.steps)
    return replace(cells, base=placed(cells.base), link=link, steps=steps, tool=placed(cells.tool))


def _few_digits(value: float, unit: float, close: float) -> float:
    """A value as the number of its unit with the fewest decimals that is as close as that, if there is one."""
    for decimals in range(FEW_DECIMALS + 1):
        near = round(value / unit, decimals) * unit
        if abs(near - value) <= close:
            return near + 0.0
    return value
