"""Straight lines of configurations that keep the pose, exactly: joints with one axis, and slides, that trade motion.

Here x are joint values [rad | size] and lengths are in the arm's size.
"""

from __future__ import annotations

import numpy as np

from robokin.arrays import Array, Flags
from robokin.kernel.chain import Chain


def coaxial_pairs(J: Array) -> Array:
    """(k, n) the directions of length 1 in which two joints with one axis trade their motion, for J (6, n)."""
    n = J.shape[1]
    sign = np.where(J.T @ J > 0.0, -1.0, 1.0)
    off = np.max(np.abs(J[:, :, None] + sign * J[:, None]), axis=0)
    i, j = np.nonzero(np.triu(off <= COAXIAL, 1))
    pairs = np.zeros((len(i), n))
    rows = np.arange(len(i))
    pairs[rows, i], pairs[rows, j] = 1.0, sign[i, j]
    return np.asarray(pairs / np.sqrt(2.0))


def straight_line(J: Array, way: Array) -> Array | None:
    """The direction (n,) along which only joints with one axis, or only slides, trade their motion, if `way` (n,) is
    one; else None.

    Joints i < j with the same axis may turn against each other by any angle: what is between them turns about that
    axis, which joint j keeps. Slides keep each other's directions. So the line x + s way reaches the pose for all s,
    exactly.
    """
    moving = np.flatnonzero(np.abs(way) > 1e-7)
    line = np.zeros(len(way))
    if len(moving) > 1 and not J[3:, moving].any():
        slides = _slides_at_rest(J[:3, moving])
        line[moving] = slides @ (slides.T @ way[moving])
        length = np.linalg.norm(line)
        return line / length if length > 0.5 else None
    if len(moving) != 2:
        return None
    a, b = J[:, moving[0]], J[:, moving[1]]
    sign = 1.0 if float(a @ b) > 0.0 else -1.0
    if float(np.max(np.abs(a - sign * b))) > COAXIAL:
        return None
    line[moving] = np.array([1.0, -sign]) * np.sign(way[moving[0]])
    return line


def _slides_at_rest(directions: Array) -> Array:
    """(k, d) an orthonormal basis of what k slides with directions (3, k) do to each other without moving the tool."""
    values, Vt = np.linalg.svd(directions)[1:]
    return np.asarray(Vt[int(np.sum(values > COAXIAL)) :].T)


def on_the_way_home(chain: Chain, J: Array, x: Array) -> tuple[Array, Flags]:
    """x (s, n) with Jacobians J (s, 6, n) moved along straight lines of slides to what is nearest to their zeros, and
    (s,) which are on such lines."""
    slides = np.flatnonzero(~chain.revolute)
    home, on_lines = np.array(x), np.zeros(len(x), dtype=bool)
    for i in range(len(x)):
        rest = _slides_at_rest(J[i][:3, slides])
        home[i, slides] -= rest @ (rest.T @ x[i, slides])
        on_lines[i] = rest.shape[1] > 0
    return home, on_lines


COAXIAL = 1e-8
"""Two axes whose twists differ by less [size and rad] are one: over a turn they leave an error of a few of it, which
the check of each point refuses where it matters."""
