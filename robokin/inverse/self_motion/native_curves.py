"""Curves that were followed as the native kernel looks at them, by the same steps as Python.

The kernel tells which curves run through a configuration (`solution_sets`), and gives the pieces of curves within the
joint limits (`arcs`).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robokin.arrays import Array
from robokin.inverse.self_motion.curve_tracing import Curve
from robokin.inverse.self_motion.track import Tracks
from robokin.inverse.solutions import Arc
from robokin.kernel.chain import Chain
from robokin.kernel.native_kernel import handle, native

MOST_JOINTS = 7
"""Joints of a chain whose curves the kernel looks at."""

ON = 1.0
"""The level of a configuration that a curve passes through in another direction; that of its own is higher."""


def levels_of(curves: Sequence[Curve], chain: Chain, T: Array, x: Array, ways: Array, size: float) -> Array | None:
    """(m,) whether each of m curves at T (m, 4, 4) passes through its x (m, n): 0, `ON`, or 2 where along ways (m, n).

    None without the kernel.
    """
    known = handle(chain)
    if native is None or known is None or chain.n > MOST_JOINTS:
        return None
    number: dict[int, int] = {}
    chosen: list[int] = []
    of = np.empty(len(curves))
    for i, curve in enumerate(curves):
        if id(curve) not in number:
            number[id(curve)] = len(chosen)
            chosen.append(i)
        of[i] = number[id(curve)]
    if not chosen:
        return np.empty(0)
    points = np.concatenate([curves[i].x for i in chosen])
    tangents = np.concatenate([curves[i].tangents for i in chosen])
    counts = np.array([len(curves[i].q) for i in chosen], dtype=np.float64)
    pairs = np.stack([of, np.arange(float(len(curves)))], axis=1)
    levels: Array = native.passes(known, size, T[chosen], points, tangents, counts, x, ways, pairs)
    return levels


def native_pieces(tracks: Tracks) -> list[tuple[int, Arc]] | None:
    """The pieces of curves within the limits as `arcs` has them, with their curves; None without the kernel."""
    known = handle(tracks.chain)
    if native is None or known is None or tracks.chain.n > MOST_JOINTS:
        return None
    counts = (tracks.last + 1).astype(np.float64)
    flags = tracks.turning.astype(np.float64), tracks.bounded.astype(np.float64)
    limits = np.stack([tracks.low, tracks.high, tracks.tolerance, tracks.middle, *flags])
    each = np.concatenate([tracks.closed[:, None], tracks.round, tracks.moving], axis=1, dtype=np.float64)
    asked = tracks.T, tracks.points, tracks.tangents, counts, limits, each
    pieces, x = native.pieces_within(known, tracks.size, *asked)
    ends = np.cumsum(pieces[:, 2]).astype(np.intp)[:-1]
    parts = np.split((x * tracks.scale)[:, : tracks.own], ends) if len(pieces) else []
    whole = pieces[:, 1] > 0.0
    return [
        (k, Arc(part, one))
        for k, part, one in zip(pieces[:, 0].astype(np.intp).tolist(), parts, whole.tolist(), strict=True)
    ]
