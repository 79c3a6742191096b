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
from typing import TYPE_CHECKING

import numpy as np

from robokin.arrays import Array, Flags
from robokin.kernel.chain_walk import ChainWalk, shift_of

if TYPE_CHECKING:
    from robokin.kernel.chain_walk import Column

PADDING = 8

BLOCK = 4096
"""Frames in a block: its columns (32 kB each) stay in the second-level cache, and the interpreter's
share of the work is spread thin."""


@dataclass(frozen=True, eq=False)
class Constant:
    """A constant transform; `mark` asks for the frame that it leads to."""

    matrix: Array
    mark: bool = False


class ChainProgram(ChainWalk):
    """What to do with a block of joint values, decided once for a chain.

    `segments` holds, for each of the n + 1 places between the joints, the constants to apply in turn;
    the marked ones lead to the frames that `frames` gives, in order.
    """

    def __init__(self, segments: Sequence[Sequence[Constant]], revolute: Flags, offsets: Array) -> None:
        walked = [[shift_of(constant.matrix.tolist(), constant.mark) for constant in segment] for segment in segments]
        super().__init__(walked, revolute.tolist(), offsets.tolist())
        self.factors = np.array(self.scales)[:, None]
        self.offsets = None if self.starts is None else np.array(self.starts)[:, None]
        self.rows = np.array(self.turning, dtype=np.intp)

    def frames(self, q: Array, out: Array) -> None:
        """Fill out: (m, marks, 4, 4) with the marked frames at q: (m, n) [rad | m]; m at most a block."""
        m = len(q)
        # A few columns more: rows a power of two apart would share their places in the cache.
        assembled = np.empty((16, m + PADDING))[:, :m]
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
        cosines, sines = cos_sin_of_halves(values if all_turn else values[self.rows])
        return self.walk(values, cosines, sines)


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
