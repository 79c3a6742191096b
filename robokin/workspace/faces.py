"""Where a search should begin that another could not end: on the faces and edges of the joint box.

Statement. Let F(t) be the configurations within the limits that put the tool's origin at t, and i any joint. If F(t) is
not empty, it holds one at which some joint stands at a limit, or one at which the derivatives of the position by the
other joints have not the full rank; or joint i makes a whole turn and F(t) has one at every value of it.
Derivation. F(t) is closed and its joints are bounded, or turn in a circle, so that q_i has an extreme on it, unless
F(t) goes all the way round; and at an extreme that no limit makes the gradient of q_i is a combination of those of
the position (F. John, "Extremum problems with inequalities as subsidiary conditions", 1948).

So if a point can be reached at all, there is nearly always a solution on a face of the joint box, and by the same
argument for that face as an arm of its own on an edge of it. A table of configurations for each face (each edge, each
corner between two limits) gives a start on it that is near the point: starts that lie on all sides of every barrier.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations, product

import numpy as np

from robokin.arrays import Array, Flags
from robokin.kernel.chain import Chain
from robokin.workspace.starts import Starts

FACE, EDGE = 4096, 1024
"""Configurations in the table of a face, where one joint is held, and of an edge, where two are."""

SECTIONS = 4, 2
"""Values at which a joint that makes a whole turn is held for the first and for the second: it has no faces."""

MANY = 7
"""From more moving joints on only the faces of joints with limits have tables, and the sections of one without: the
more joints, the less is one of them in the way, and the longer the tables take."""


def faces_of(chain: Chain, low: Array, high: Array, full: Flags) -> list[Starts]:
    """Tables of starts with one joint held; low, high, full (n,) the joint box [rad | m]."""
    chosen = np.arange(len(low))
    if len(low) > MANY:
        limited = np.flatnonzero(~full)
        chosen = limited if len(limited) else chosen[-1:]
    holds = [((int(i), value),) for i in chosen for value in held_values(low, high, full, int(i), SECTIONS[0])]
    return _tables(chain, (low, high), holds, FACE)


def edges_of(chain: Chain, low: Array, high: Array, full: Flags) -> list[Starts]:
    """Tables of starts with two joints held; none for an arm of many joints."""
    n = len(low)
    if n > MANY:
        return []
    each = [[(i, v) for v in held_values(low, high, full, i, SECTIONS[1])] for i in range(n)]
    pairs = [pair for i, j in combinations(range(n), 2) for pair in product(each[i], each[j])]
    return _tables(chain, (low, high), pairs, EDGE)


def held_values(low: Array, high: Array, full: Flags, i: int, sections: int) -> list[float]:
    """The values at which joint i is held."""
    if full[i]:
        return [float(low[i] + (high[i] - low[i]) * (k + 0.5) / sections) for k in range(sections)]
    return [float(low[i]), float(high[i])]


def _tables(
    chain: Chain, box: tuple[Array, Array], holds: Sequence[Sequence[tuple[int, float]]], kept: int
) -> list[Starts]:
    tables = []
    for hold in holds:
        low, high = box[0].copy(), box[1].copy()
        for i, value in hold:
            low[i] = high[i] = value
        tables.append(Starts(chain, low, high, kept=kept))
    return tables
