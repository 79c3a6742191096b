"""From the joint values of all branches to the list of candidates."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from robokin.arrays import Array, Flags, Index
from robokin.inverse.closed_form.joint_functions import Motion
from robokin.inverse.closed_form.trigonometry import Turn
from robokin.inverse.elimination.loop import Candidates
from robokin.kernel.entries import (
    Entry,
    plus,
    times,
)

Scalar = TypeVar("Scalar", bound=np.generic)


def in_front(values: NDArray[Scalar], branches: Array | Flags) -> NDArray[Scalar]:
    """Values (2, …) with the first axis in front of all of branches' axes, also where the rest is common to some."""
    missing = branches.ndim + 1 - values.ndim
    return values.reshape(values.shape[0], *(1,) * max(missing, 0), *values.shape[1:])


def turn_in_front(turn: Turn, branches: Flags) -> Turn:
    """Cosine and sine with the first axis in front of all of branches' axes."""
    return in_front(np.asarray(turn[0]), branches), in_front(np.asarray(turn[1]), branches)


def chosen_positions(positions: Sequence[Motion], chosen: Flags) -> tuple[list[Motion], Index]:
    """The joints' positions (s,) on the chosen branches, and the place (s,) of each one's target in the block."""
    shape = np.broadcast_shapes(chosen.shape, *(np.shape(part) for position in positions for part in position))
    chosen = np.broadcast_to(chosen, shape)
    taken: list[Motion] = [tuple(np.broadcast_to(part, shape)[chosen] for part in position) for position in positions]
    return taken, np.nonzero(chosen)[-1].astype(np.intp, copy=False)


def gathered(index: Index, values: Mapping[int, Entry], real: Flags) -> Candidates:
    """The candidates for the targets index: (m,); values: joint → (…, m), broadcasting; real: (…, m) likewise.

    The values lie joint by joint in memory, (s, 6) being a view: what follows works on columns.
    """
    shape = np.broadcast_shapes(index.shape, real.shape, *(np.shape(value) for value in values.values()))
    table = np.empty((6, *shape))
    for joint, value in values.items():
        table[joint] = value
    table = table.reshape(6, math.prod(shape))
    index = np.broadcast_to(index, shape).reshape(-1)
    keep = np.broadcast_to(real, shape).reshape(-1)
    if not keep.all():
        kept = np.flatnonzero(keep)
        table, index = table.take(kept, axis=1), index.take(kept)
    return Candidates(index, table.T, leaves=math.prod(shape[:-1]))


def joined(first: Candidates, second: Candidates) -> Candidates:
    """The candidates of both; the second's are more for targets of the first."""
    values = np.concatenate([first.values.T, second.values.T], axis=1).T
    return Candidates(np.concatenate([first.index, second.index]), values, leaves=first.leaves)


LEVER = 1e-4
"""A lever [size], or a sine, below which the joint that it belongs to is nearly free. Whether the arm is near-singular
there is then looked at closely."""


class Marks:
    """Which of m targets have an axis that is nearly free (`near`), or an equation that says nothing (`loose`).

    wrist: those where a spherical triple's first and last axis are nearly one, so that these two may turn against each
    other; where nothing else is marked there are no more self-motions than that one on each branch.
    """

    def __init__(self, m: int) -> None:
        self.near = np.zeros(m, dtype=bool)
        self.loose = np.zeros(m, dtype=bool)
        self.wrist = np.zeros(m, dtype=bool)

    def short(self, x: Entry, y: Entry, index: Index, wrist: bool = False) -> None:
        """Mark the targets index (k,) where a lever (x, y) (…, k) is short on some branch."""
        square = np.asarray(plus(times(x, x), times(y, y)))
        if square.ndim == 0:
            return  # of the arm, not of a target
        # The least is found in half the time that comparing all takes; what is no number is none.
        if not square.min(initial=np.inf) >= LEVER**2:
            short = square < LEVER**2
            marked = self.wrist if wrist else self.near
            marked[index] |= short.reshape(-1, short.shape[-1]).any(axis=0)

    def on(self, found: Candidates, determined: bool = False) -> Candidates:
        """The candidates with the marks; determined: whether each joint whose value may be free is marked."""
        near = self.near | self.wrist
        few = ~(self.near | self.loose) if determined else None
        return Candidates(found.index, found.values, found.leaves, near, self.loose, few)
