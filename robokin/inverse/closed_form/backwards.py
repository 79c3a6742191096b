"""A loop read backwards is a loop.

The inverse of J1 L1 … J6 L6 = I is L6⁻¹ J6⁻¹ L5⁻¹ … J1⁻¹ = I, and with X = diag(1, -1, -1), half a turn
about x, J(q)⁻¹ = J(-q) = X J(q) X. So J6 L5' J5 L4' … J1 L6' = I with L' = X L⁻¹ X and the same joint
values: a solver for "the wrist comes last" is also the one for "the wrist comes first".
"""

from __future__ import annotations

import numpy as np

from robokin.inverse.elimination.loop import Loop
from robokin.kernel.entries import EntryFrame, applied_back, times, transposed
from robokin.spatial import invert

X = (1.0, -1.0, -1.0)
SIGNS = np.outer([*X, 1.0], [*X, 1.0])
"""X M X is M with these signs."""


def backwards(loop: Loop) -> Loop:
    """The loop whose joints 1 … 6 are joints 6 … 1 of the given one."""
    links = invert(loop.links)[::-1] * SIGNS
    return Loop(loop.revolute[::-1], links, loop.first, loop.last, loop.size)


def backwards_closing(closing: EntryFrame) -> EntryFrame:
    """L6' of L6."""
    t = applied_back(closing.R, closing.t)
    columns = transposed(closing.R)
    R = [
        [times(s * s_x, entry) for s_x, entry in zip(X, column, strict=True)]
        for s, column in zip(X, columns, strict=True)
    ]
    return EntryFrame(R, [times(-s, entry) for s, entry in zip(X, t, strict=True)])
