"""Vectors and matrices whose entries are numbers or columns.

A block of m configurations or targets turns only some entries of a transform into arrays (m,); what is the same for
the whole block stays a plain float. Sums and products of entries leave out what a 0 or ±1 spares, so an arm
of right angles costs less than a general one and no arm needs code of its own. Branches (two elbows, two
wrists) are new axes in front, (2, m), (2, 2, m), …, and broadcast.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from robokin.arrays import Array, Index
from robokin.kernel.spared_products import increased as increased
from robokin.kernel.spared_products import minus as minus
from robokin.kernel.spared_products import plus as plus
from robokin.kernel.spared_products import times as times
from robokin.kernel.spared_products import turned as turned
from robokin.kernel.spared_products import turned_back as turned_back
from robokin.kernel.traced_numbers import Traced

Entry = float | Array
Vector = Sequence[Entry]
"""Three entries x, y, z."""
Matrix = Sequence[Vector]
"""Three rows."""

NOTHING = 1e-15
"""A constant entry (cosine, or length in units of the arm's size) below this is rounding of a zero."""


class EntryFrame:
    """A rigid transform: `R` three rows of entries, `t` three entries."""

    def __init__(self, R: Matrix, t: Vector) -> None:
        self.R = R
        self.t = t


def constant(T: Array) -> EntryFrame:
    """A transform (4, 4) that is the same for every target."""
    rows = [[cleaned(value) for value in row] for row in T[:3].tolist()]
    return EntryFrame([row[:3] for row in rows], [row[3] for row in rows])


def columns(T: Array) -> EntryFrame:
    """A block of transforms (m, 4, 4)."""
    M = np.ascontiguousarray(T[:, :3].reshape(-1, 12).T)
    return EntryFrame([[M[4 * i + j] for j in range(3)] for i in range(3)], [M[4 * i + 3] for i in range(3)])


def taken(F: EntryFrame, index: Index) -> EntryFrame:
    """The frames of the targets index: (s,) of a block."""
    return EntryFrame([[_taken(entry, index) for entry in row] for row in F.R], [_taken(entry, index) for entry in F.t])


def _taken(entry: Entry, index: Index) -> Entry:
    return entry if isinstance(entry, float) else entry[index]


def cleaned(value: float) -> float:
    """value, or 0 or ±1 where it is that but for rounding."""
    size = abs(value)
    if size < NOTHING:
        return 0.0
    return math.copysign(1.0, value) if abs(size - 1.0) < NOTHING else value


def dot(u: Vector, v: Vector) -> Entry:
    """u · v, of any common length."""
    total: Entry = 0.0
    for a, b in zip(u, v, strict=True):
        total = plus(total, times(a, b))
    return total


def applied(M: Matrix, v: Vector) -> list[Entry]:
    """M v."""
    return [dot(row, v) for row in M]


def applied_back(M: Matrix, v: Vector) -> list[Entry]:
    """Mᵀ v."""
    return [dot(column, v) for column in zip(*M, strict=True)]


def moved(F: EntryFrame, p: Vector) -> list[Entry]:
    """The point R p + t."""
    return [plus(a, b) for a, b in zip(applied(F.R, p), F.t, strict=True)]


def moved_back(F: EntryFrame, p: Vector) -> list[Entry]:
    """The point Rᵀ(p - t)."""
    return applied_back(F.R, [minus(a, b) for a, b in zip(p, F.t, strict=True)])


def transposed(M: Matrix) -> list[Vector]:
    """Mᵀ."""
    return list(zip(*M, strict=True))


def multiplied(M: Matrix, N: Matrix) -> list[Vector]:
    """M N."""
    across = transposed(N)
    return [[dot(row, column) for column in across] for row in M]


def root(value: Entry) -> Entry:
    """The square root; 0 of what is negative by rounding."""
    if isinstance(value, float):
        positive = max(value, 0.0)
        return positive.root() if isinstance(positive, Traced) else math.sqrt(positive)
    return np.sqrt(np.maximum(value, 0.0))


def quotient(a: Entry, b: Entry) -> Entry:
    """a / b."""
    return times(a, 1.0 / b) if isinstance(b, float) else a / b


def angle(c: Entry, s: Entry) -> Entry:
    """The angle [rad] of a cosine and sine, or of any positive multiple of the two."""
    if isinstance(c, float) and isinstance(s, float):
        return math.atan2(s, c)
    return np.asarray(np.arctan2(s, c))
