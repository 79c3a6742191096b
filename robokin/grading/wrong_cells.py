"""The cells of a table that are wrong, where these are all that keeps it from being the right robot."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from robokin.arrays import Array
from robokin.grading.same_robot import match, skeleton_of
from robokin.grading.tolerance import Tolerance
from robokin.kinematics.forward import forward_kinematics, row_frames
from robokin.model import CoupledRobot, Joint, Robot
from robokin.spatial import invert

COLUMNS = ("theta", "d", "a", "alpha", "offset")

MOST = 3
"""Cells that are named; of a table with more of them wrong its axes say more."""


@dataclass(frozen=True)
class Cell:
    """A wrong cell: its row (from 1), its column, its value and the right one [rad | m], `angle` saying which."""

    row: int
    column: str
    angle: bool
    found: float
    expected: float


def wrong_cells(right: Robot, given: Robot, allowed: Tolerance, free: frozenset[str]) -> tuple[Cell, ...]:
    """The fewest cells that, put right, make a table the right robot up to what is left open; none where many would.

    First those that differ from the right table as it is written. Where the table is drawn with frames of its own, and
    nothing is left open, the row that the rest of the table leaves room for: what its matrix must be follows from the
    right pose, and the cells from the matrix.
    """
    if "frames" in (right.convention, given.convention):
        return ()
    cells = _beside(right, given, allowed)
    for one in cells:
        if _same(right, _put_right(given, (one,)), allowed, free):
            return (one,)
    if cells and len(cells) <= MOST and _same(right, _put_right(given, cells), allowed, free):
        return cells
    coupled = isinstance(right, CoupledRobot) or isinstance(given, CoupledRobot)
    return () if free or coupled else _of_one_row(right, given, allowed)


def _beside(right: Robot, given: Robot, allowed: Tolerance) -> tuple[Cell, ...]:
    """The cells that differ from those of the right table, where the two have rows of the same kinds."""
    kinds = [[row.type for row in robot.rows] for robot in (right, given)]
    if right.convention != given.convention or kinds[0] != kinds[1]:
        return ()
    found = []
    for i, (a, b) in enumerate(zip(right.rows, given.rows, strict=True), start=1):
        found += _differences(i, b, {name: getattr(a, name) for name in COLUMNS}, allowed)
    return tuple(found)


def _differences(i: int, row: Joint, right: dict[str, float], allowed: Tolerance) -> list[Cell]:
    """The cells of row i (from 1) that are not what they should be."""
    found = []
    for name, value in right.items():
        angle = name in ("theta", "alpha") or (name == "offset" and row.type.letter == "R")
        own = getattr(row, name)
        off = abs(own - value)
        off = abs((off + np.pi) % (2.0 * np.pi) - np.pi) if angle else off
        if not (allowed.allows_angle(off) if angle else allowed.allows_position(off)):
            found.append(Cell(i, name, angle, own, value))
    return found


def _put_right(robot: Robot, cells: tuple[Cell, ...]) -> Robot:
    """The robot with some cells as they should be."""
    rows = list(robot.rows)
    for cell in cells:
        change: dict[str, Any] = {cell.column: cell.expected}
        rows[cell.row - 1] = replace(rows[cell.row - 1], **change)
    return replace(robot, rows=tuple(rows))


def _same(right: Robot, given: Robot, allowed: Tolerance, free: frozenset[str]) -> bool:
    return match(skeleton_of(right), skeleton_of(given), allowed, free).same


def _of_one_row(right: Robot, given: Robot, allowed: Tolerance) -> tuple[Cell, ...]:
    """The cells of the one row that, put right, make the table the right robot; of several rows the one with fewest."""
    q = np.zeros(right.n)
    target = forward_kinematics(right, q)
    frames = np.concatenate([given.base[None], row_frames(given, q)])
    end = forward_kinematics(given, q)
    best: tuple[Cell, ...] = ()
    for i, row in enumerate(given.rows):
        # T = before · A · after: what A must be, all else being as it is.
        A = invert(frames[i]) @ target @ invert(invert(frames[i + 1]) @ end)
        theta, d, a, alpha, rest = _row_of(A, given.convention)
        if rest > allowed.angle + allowed.position / allowed.size:
            continue
        letter = row.type.letter
        values = {"theta": theta, "d": d, "a": a, "alpha": alpha}
        if letter != "F":
            values["offset"] = values.pop("theta" if letter == "R" else "d")
        cells = tuple(_differences(i + 1, row, values, allowed))
        better = cells and len(cells) <= MOST - 1 and (not best or len(cells) < len(best))
        if better and _same(right, _put_right(given, cells), allowed, frozenset()):
            best = cells
    return best


def _row_of(A: Array, convention: str) -> tuple[float, float, float, float, float]:
    """theta, d, a, alpha of a row with the matrix A (4, 4), and what it is off from being one [rad and m]."""
    R, p = A[:3, :3], A[:3, 3]
    if convention == "standard":
        theta, alpha = np.arctan2(R[1, 0], R[0, 0]), np.arctan2(R[2, 1], R[2, 2])
        along = np.array([np.cos(theta), np.sin(theta)])
        a, d = along @ p[:2], p[2]
        rest = abs(R[2, 0]) + abs(along[0] * p[1] - along[1] * p[0])
    else:
        theta, alpha = np.arctan2(-R[0, 1], R[0, 0]), np.arctan2(-R[1, 2], R[2, 2])
        a, d = p[0], p[2] * np.cos(alpha) - p[1] * np.sin(alpha)
        rest = abs(R[0, 2]) + abs(p[1] * np.cos(alpha) + p[2] * np.sin(alpha))
    return float(theta), float(d), float(a), float(alpha), float(rest)
