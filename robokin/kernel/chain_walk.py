"""The way through a chain, decided once from its numbers: which entries each joint and each constant touches.

Who walks it brings the entries: arrays (`columns`), or terms of which code is made (`code_lines`). Nothing is loaded
here: one configuration needs no arrays.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from robokin.kernel.spared_products import increased, plus, times, turned, turned_back

TYPE_CHECKING = False  # `typing` has the same, and takes a while to load
if TYPE_CHECKING:
    from typing import Any

    from robokin.arrays import Array
    from robokin.kernel.spared_products import Entry

    Column = list[Entry]
    Entries = Sequence[Entry] | Array


@dataclass(frozen=True)
class JointStep:
    """A revolute joint of a program."""

    starts_run: bool  # x and y before it are what the sum of the run's angles turns
    need_x: bool  # whether anything asks for the turned x, y before the run goes on
    need_y: bool


@dataclass(frozen=True)
class ConstantStep:
    """A constant of a program: translation, then the rotation's columns (None: no rotation), then the mark."""

    translation: tuple[float, float, float]
    rotation: tuple[tuple[float, float, float], ...] | None
    mark: bool


def shift_of(rows: Sequence[Sequence[float]], mark: bool) -> ConstantStep:
    """A constant transform, by its first three rows."""
    columns = [tuple(row[j] for row in rows[:3]) for j in range(4)]
    turns = columns[:3] != [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)]
    translation: Any = columns[3]
    rotation: Any = tuple(columns[:3]) if turns else None
    return ConstantStep(translation, rotation, mark)


class ChainWalk:
    """A chain as steps: `n` joints, constants in the n + 1 places between them.

    `shifts` are the constants of each place, those that are marked lead to the frames that `walk` gives, in order.
    """

    def __init__(
        self, shifts: Sequence[Sequence[ConstantStep]], revolute: Sequence[bool], offsets: Sequence[float]
    ) -> None:
        """`revolute`: whether each joint turns; `offsets` of their values [rad | m]."""
        self.n = len(revolute)
        # Angles are halved as they are copied: only the tangents of the halves are ever needed.
        self.scales = [0.5 if turns else 1.0 for turns in revolute]
        self.starts = [o * scale for o, scale in zip(offsets, self.scales, strict=True)] if any(offsets) else None
        self.shifts = [[*segment] for segment in shifts]
        self.marks = sum(shift.mark for segment in self.shifts for shift in segment)
        self.turns: list[JointStep | None] = []
        """One for each joint; None for a prismatic one."""
        self.turning = [i for i, turns in enumerate(revolute) if turns]
        self.sums: list[int] = []
        """Joints whose angle adds to the one before them, since the two axes are parallel."""
        goes_on = False
        for i in range(self.n):
            if not revolute[i]:
                self.turns.append(None)
                goes_on = False
                continue
            starts_run = not goes_on
            if not starts_run:
                self.sums.append(i)
            after = self.shifts[i + 1]
            goes_on = i + 1 < self.n and bool(revolute[i + 1])
            goes_on = goes_on and all(shift.rotation is None and not shift.mark for shift in after)
            need_x = not goes_on or any(shift.translation[0] for shift in after)
            need_y = not goes_on or any(shift.translation[1] for shift in after)
            self.turns.append(JointStep(starts_run, need_x, need_y))

    def walk(
        self, values: Entries, cosines: Entries, sines: Entries
    ) -> Iterator[tuple[Column, Column, Column, Column]]:
        """The columns of each marked frame in turn, by slides' values (n) [m] and by cosines and sines of the turning.

        Those of joints that turn about parallel axes are of the sums of their angles. Entries are arrays, or terms
        of which `straight_line` makes code.
        """
        rows = iter(range(len(self.turning)))

        x: Column = [1.0, 0.0, 0.0]
        y: Column = [0.0, 1.0, 0.0]
        z: Column = [0.0, 0.0, 1.0]
        p: Column = [0.0, 0.0, 0.0]
        run_x, run_y = x, y
        for i, shifts in enumerate(self.shifts):
            if i:
                turn = self.turns[i - 1]
                if turn is None:
                    p = [plus(times(values[i - 1], v), u) for u, v in zip(p, z, strict=True)]
                else:
                    if turn.starts_run:
                        run_x, run_y = x, y
                    row = next(rows)
                    c, s = cosines[row], sines[row]
                    if turn.need_x:
                        x = [turned(c, u, s, v) for u, v in zip(run_x, run_y, strict=True)]
                    if turn.need_y:
                        y = [turned_back(c, v, s, u) for u, v in zip(run_x, run_y, strict=True)]
            for shift in shifts:
                for factor, column in zip(shift.translation, (x, y, z), strict=True):
                    if factor:
                        p = [increased(u, factor, v) for u, v in zip(p, column, strict=True)]
                if shift.rotation is not None:
                    x, y, z = (_mixture(weights, x, y, z) for weights in shift.rotation)
                if shift.mark:
                    yield x, y, z, p


def _mixture(weights: tuple[float, float, float], x: Column, y: Column, z: Column) -> Column:
    """The column a x + b y + c z, skipping what a weight of 0 or ±1 spares."""
    mixed: Column = [0.0, 0.0, 0.0]
    for weight, column in zip(weights, (x, y, z), strict=True):
        if weight:
            mixed = [increased(u, weight, v) for u, v in zip(mixed, column, strict=True)]
    return mixed
