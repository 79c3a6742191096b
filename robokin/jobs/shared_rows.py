"""A function of many rows, shared by threads: for work that lets go of the interpreter's lock."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable

import numpy as np

from robokin.arrays import Array
from robokin.jobs.ordered_map import ordered_map


def by_threads(
    fill: Callable[[Array, Array], None], q: Array, shape: tuple[int, ...], share: int, cores: int | None
) -> Array:
    """What `fill` makes of q (..., n), an array (..., *shape), the same whoever does it.

    fill: takes rows (m, n) and where their answers (m, *shape) belong. share: rows that a thread takes at once; no more
    than these are answered by the thread that asks. cores: threads, as many as there are usable cores for None.
    """
    rows = q.reshape(math.prod(q.shape[:-1]), q.shape[-1])
    out = np.empty((len(rows), *shape))

    def part(start: int) -> None:
        fill(rows[start : start + share], out[start : start + share])

    deque(ordered_map(part, range(0, len(rows), share), cores, workers="threads"), maxlen=0)
    return out.reshape(*q.shape[:-1], *shape)
