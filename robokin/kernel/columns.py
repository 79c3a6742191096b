"""The fast way through a chain: a block of frames kept as twelve columns.

A block of m frames is twelve entries (three of each of x, y, z, p), each an array (m,) or a plain
float while it is the same for the whole block. A joint is a dozen fused array operations on them; no
4×4 product is formed. What is known of the robot is decided before the arrays are touched:

- an entry that is 0 or ±1 takes part in no multiplication, so the first joints cost next to nothing;
- a constant rotation whose columns are ± unit vectors (most twists are 0 or ±90°) only renames columns;
- neighbouring parallel axes are turned by the sum of their angles, from the columns before the first of
  them, and only the columns that something asks for are computed;
- sine and cosine both come from one tangent of the half angle, which vectorises better.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array, Flags
from robokin.kernel.entries import Entry, increased, plus, times, turned, turned_back

Column = list[Entry]
Entries = Sequence[Entry] | Array

BLOCK = 4096
"""Frames in a block: its columns (32 kB each) stay in the second-level cache, and the interpreter's
share of the work is spread thin."""


@dataclass(frozen=True, eq=False)
class Constant:
    """A constant transform; `mark` asks for the frame that it leads to."""

    matrix: Array
    mark: bool = False


@dataclass(frozen=True)
class _Turn:
    """A revolute joint of a program."""

    starts_run: bool  # x and y before it are what the sum of the run's angles turns
    need_x: bool  # whether anything asks for the turned x, y before the run goes on
    need_y: bool


@dataclass(frozen=True)
class _Shift:
    """A constant of a program: translation, then the rotation's columns (None: no rotation), then the mark."""

    translation: tuple[float, float, float]
    rotation: tuple[tuple[float, float, float], ...] | None
    mark: bool


class ChainProgram:
    """What to do with a block of joint values, decided once for a chain.

    `segments` holds, for each of the n + 1 places between the joints, the constants to apply in turn;
    the marked ones lead to the frames that `frames` gives, in order.
    """

    def __init__(self, segments: Sequence[Sequence[Constant]], revolute: Flags, offsets: Array) -> None:
        self.n = len(revolute)
        # Angles are halved as they are copied: only the tangents of the halves are ever needed.
        self.factors = np.where(revolute, 0.5, 1.0)[:, None]
        self.offsets = offsets[:, None] * self.factors if np.any(offsets) else None
        self.shifts = [[_shift(constant) for constant in segment] for segment in segments]
        self.marks = sum(shift.mark for segment in self.shifts for shift in segment)
        self.turns: list[_Turn | None] = []
        """One for each joint; None for a prismatic one."""
        self.turning = np.flatnonzero(revolute)
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
            self.turns.append(_Turn(starts_run, need_x, need_y))

    def frames(self, q: Array, out: Array) -> None:
        """Fill out: (m, marks, 4, 4) with the marked frames at q: (m, n) [rad | m]; m at most a block."""
        m = len(q)
        assembled = np.empty((16, m))
        assembled[12:15] = 0.0
        assembled[15] = 1.0
        flat = out.reshape(m, self.marks, 16)
        for marked, frame in enumerate(self.columns(q.T)):
            for j, column in enumerate(frame):
                for r, entry in enumerate(column):
                    assembled[4 * r + j] = entry
            flat[:, marked] = assembled.T

    def columns(self, q: Array) -> Iterator[tuple[Column, Column, Column, Column]]:
        """The columns x, y, z, p of each marked frame in turn, at q: (n, m) [rad | m]; m at most a block."""
        m = q.shape[1]
        values = np.multiply(q, self.factors, out=np.empty((self.n, m)))
        if self.offsets is not None:
            values += self.offsets
        for i in self.sums:
            values[i] += values[i - 1]
        all_turn = len(self.turning) == self.n
        cosines, sines = cos_sin_of_halves(values if all_turn else values[self.turning])
        return self.walk(values, cosines, sines)

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


def cos_sin_of_halves(halves: Array) -> tuple[Array, Array]:
    """Cosine and sine, to within 4e-16, of angles given as their halves (k, m) [rad]; halves is reused.

    With t = tan(angle / 2) and r = 2 / (1 + t²): cos = r - 1, sin = t r. At odd multiples of 180° t is
    huge but finite in floating point, and the two come out as -1 and 0.
    """
    t = np.tan(halves, out=halves)
    r = t * t
    r += 1.0
    np.divide(2.0, r, out=r)
    t *= r
    r -= 1.0
    return r, t


def _shift(constant: Constant) -> _Shift:
    T = constant.matrix
    px, py, pz = (float(value) for value in T[:3, 3])
    columns = tuple((float(u[0]), float(u[1]), float(u[2])) for u in T[:3, :3].T)
    identity = bool(np.array_equal(T[:3, :3], np.eye(3)))
    return _Shift((px, py, pz), None if identity else columns, constant.mark)


def _mixture(weights: tuple[float, float, float], x: Column, y: Column, z: Column) -> Column:
    """The column a x + b y + c z, skipping what a weight of 0 or ±1 spares."""
    mixed: Column = [0.0, 0.0, 0.0]
    for weight, column in zip(weights, (x, y, z), strict=True):
        if weight:
            mixed = [increased(u, weight, v) for u, v in zip(mixed, column, strict=True)]
    return mixed
