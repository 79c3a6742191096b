"""Newton's steps that close bodies in the plane, joined by hinges and slides, from a place near by.

A state (3 n,) holds for each body its angle [rad] and its origin in the mechanism's size.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robokin.arrays import Array
from robokin.assembly.planar_groups import PlanarJoint, Pose

CLOSED = 1e-11
"""A way that lacks less, in the group's size, is closed."""

STEPS = 40
"""Newton's steps; where two ways fall together each gains one binary digit."""

TOGETHER = 1e-6
"""Ways nearer than this, in turns and sizes, are one; as double, where the equations are singular there."""

SINGULAR = 1e-5
"""Least singular value, as a part of the greatest, below which two ways fall together."""


def pose_of(x: Array, size: float) -> Pose:
    """A body's pose from its part (3,) of a state."""
    u, t = np.array([np.exp(1j * x[0])]), np.array([size * (x[1] + 1j * x[2])])
    return Pose(u, u.conjugate(), t, t.conjugate())


def closed_state(
    x: Array, bodies: Sequence[int], edges: Sequence[PlanarJoint], known: dict[int, Pose], size: float
) -> tuple[Array, bool] | None:
    """The closed state that Newton's steps find, None if there is none; whether the equations are singular there."""
    number = {body: i for i, body in enumerate(bodies)}
    for _ in range(STEPS):
        lack, J = _equations(x, number, edges, known, size)
        step = np.linalg.lstsq(J, -lack, rcond=1e-12)[0]
        longest = float(np.max(np.abs(step)))
        x = x + step * min(1.0, 0.5 / longest if longest else 1.0)
        if longest < 1e-15:
            break
    lack, J = _equations(x, number, edges, known, size)
    if not float(np.max(np.abs(lack))) < CLOSED:
        return None
    values = np.linalg.svd(J, compute_uv=False)
    return x, bool(values[-1] < SINGULAR * values[0])


def _equations(
    x: Array, number: dict[int, int], edges: Sequence[PlanarJoint], known: dict[int, Pose], size: float
) -> tuple[Array, Array]:
    """What the joints lack of closing (2 e,), and how that changes with the state (2 e, 3 n)."""
    lack, J = np.zeros(2 * len(edges)), np.zeros((2 * len(edges), len(x)))
    for row, edge in enumerate(edges):
        points, turns = [], []
        for body, sign in ((edge.a, 1.0), (edge.b, -1.0)):
            if body in number:
                i = 3 * number[body]
                u, t = np.exp(1j * x[i]), x[i + 1] + 1j * x[i + 2]
            else:
                i, u, t = -1, complex(known[body].u[0]), complex(known[body].t[0]) / size
            points.append((t + u * edge.at(body) / size, 1j * u * edge.at(body) / size, i, sign))
            turns.append((u * edge.way(body), i))
        gap = points[0][0] - points[1][0]
        if not edge.slides:
            lack[2 * row : 2 * row + 2] = gap.real, gap.imag
            for _, change, i, sign in points:
                if i >= 0:
                    J[2 * row, i : i + 3] = sign * change.real, sign, 0.0
                    J[2 * row + 1, i : i + 3] = sign * change.imag, 0.0, sign
            continue
        (e, i), (f, k) = turns
        # The directions agree, and the points lie on one line along the first.
        lack[2 * row] = np.angle(f / e)
        lack[2 * row + 1] = (gap * e.conjugate()).imag
        for where, sign in ((i, -1.0), (k, 1.0)):
            if where >= 0:
                J[2 * row, where] = sign
        for _, change, where, sign in points:
            if where >= 0:
                J[2 * row + 1, where] += sign * (change * e.conjugate()).imag
                J[2 * row + 1, where + 1] += sign * (e.conjugate()).imag
                J[2 * row + 1, where + 2] += sign * (1j * e.conjugate()).imag
        if i >= 0:
            J[2 * row + 1, i] += (gap * (1j * e).conjugate()).imag
    return lack, J


def keep_way(found: list[tuple[Array, bool]], closed: tuple[Array, bool] | None) -> None:
    """Add a way that is not known yet."""
    if closed is None:
        return
    for other, _ in found:
        apart = closed[0] - other
        apart[::3] = np.angle(np.exp(1j * apart[::3]))
        # Newton's steps stop farther from a way that is double.
        if np.max(np.abs(apart)) < (1e-4 if closed[1] else TOGETHER):
            return
    found.append(closed)
