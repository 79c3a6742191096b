"""Curves of configurations that reach one pose, as points in order.

Statement. Given configurations and the directions of the curves that leave them, follow the curves.
Derivation. Where two joints have one axis, or only joints slide, the curve is a straight line, known exactly
(`straight_motions.straight_line`).
All others are followed step by step (`fronts`).
Degenerate case. Lines of sliding joints never close: they end at bounds.

Here x are joint values [rad | size] and lengths are in the arm's size.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from robokin.arrays import Array, Flags
from robokin.inverse.self_motion.fronts import TRIAL_STEPS, Fronts, reach_of
from robokin.inverse.self_motion.pose_correction import CLOSES, errors, scale_of
from robokin.inverse.self_motion.straight_motions import straight_line
from robokin.kernel.chain import Chain

BESIDE = 0.05
"""How far from the polyline a point of the curve can be [rad | size]; a chord of LONGEST is off by 0.01."""

APART, FEWEST, MOST = 0.3, 61, 2001
"""Distance of points on a straight line of slides [size], and how many there are at least and at most."""

MOVES = 1e-6
"""A joint that keeps its value to this [rad | size] along a curve stands still."""


@dataclass(frozen=True, eq=False)
class Curve:
    """A self-motion as points in order.

    q: (k, n) [rad | m], each reaching the pose, angles not cut at full turns; tangents: (k, n) in x, of length 1;
    closed: whether it was followed until it closed, the last point then being the first but for full turns; ended:
    why it is not closed ("bound" for a sliding joint or a given bound, "lost" where it could not be followed);
    dimension: of the set it is in; sheets: for a set of two dimensions or more the curves that were followed in it,
    of which this is the first; second: (k,) the second least singular values of the Jacobian at the points, where they
    are known, zero for a null space counted as one.
    """

    q: Array
    tangents: Array
    scale: Array
    closed: bool
    ended: str = ""
    dimension: int = 1
    sheets: tuple[Curve, ...] = ()
    second: Array | None = None

    @cached_property
    def x(self) -> Array:
        """(k, n) the points in x [rad | size]."""
        return np.asarray(self.q / self.scale)

    @property
    def joints(self) -> tuple[int, ...]:
        """The joints that move, from 1."""
        moving = np.max([np.ptp(curve.x, axis=0) for curve in (self.sheets or (self,))], axis=0) > MOVES
        return tuple((np.flatnonzero(moving) + 1).tolist())


def trace_many(
    chain: Chain,
    T: Array,
    x: Array,
    ways: Array,
    size: float,
    locked: Flags | None = None,
    limits: Array | None = None,
    trial: Flags | None = None,
) -> list[Curve | None]:
    """The curves through x (s, n) at poses T (s, 4, 4) along ways (s, n), with joints locked (s, n) or none.

    x: [rad | size]; limits: (own, 2) [rad | m], which slides are followed to if they are far; trial: (s,) for which it
    is not known whether a curve leads away from x: where none does there is None.
    """
    s, n = x.shape
    locked = np.zeros((s, n), dtype=bool) if locked is None else locked
    _, J = errors(chain, T, x, size)
    lines = [straight_line(J[i], ways[i]) for i in range(s)]
    curves: list[Curve | None] = [None] * s
    for i, line in enumerate(lines):
        if line is not None:
            curves[i] = _line(chain, T[i], x[i], line, size, limits)
    rest = np.array([i for i, curve in enumerate(curves) if curve is None], dtype=np.intp)
    if len(rest):
        fronts = Fronts(chain, T[rest], x[rest], ways[rest], size, locked[rest], limits)
        fronts.run(np.zeros(len(rest), dtype=bool) if trial is None else trial[rest])
        for place, i in enumerate(rest):
            curves[i] = None if fronts.stays[place] else _followed(fronts, place)
    return curves


def leads_away(chain: Chain, T: Array, x: Array, ways: Array, size: float, locked: Flags | None = None) -> Flags:
    """(s,) whether curves of configurations that reach T (s, 4, 4) lead from x (s, n) along ways (s, n).

    With joints locked (s, n) or none.

    A single step is no proof: where four solutions merge, its error is of the third order and may be below rounding.
    """
    fronts = Fronts(chain, T, x, ways, size, np.zeros(x.shape, dtype=bool) if locked is None else locked, None)
    fronts.advances(TRIAL_STEPS)
    return fronts.away()


def _line(chain: Chain, T: Array, x: Array, line: Array, size: float, limits: Array | None) -> Curve | None:
    """The straight line through x (n,) along `line` (n,); None where it does not reach the pose after all."""
    moving = np.flatnonzero(line)
    turns = bool(chain.revolute[moving].all())
    scale = scale_of(chain, size)
    if turns:
        s = np.linspace(-np.pi, np.pi, 61)
    else:
        reach = reach_of(chain, x, size, limits)
        with np.errstate(divide="ignore"):
            ends = np.stack([(-reach - x)[moving], (reach - x)[moving]]) / line[moving]
        first, last = float(np.max(np.min(ends, axis=0))), float(np.min(np.max(ends, axis=0)))
        count = int(np.clip((last - first) / APART, FEWEST, MOST))
        s = np.unique(np.append(np.linspace(first, last, count), 0.0))
    points = x + s[:, None] * line
    e, _ = errors(chain, np.broadcast_to(T, (len(s), 4, 4)), points, size)
    if float(np.max(np.abs(e))) > 10.0 * CLOSES:
        return None
    tangents = np.tile(line / np.linalg.norm(line), (len(s), 1))
    return Curve(points * scale, tangents, scale, turns, "" if turns else "bound")


def _followed(fronts: Fronts, i: int) -> Curve:
    """Curve i of the fronts."""
    points, tangents, second = fronts.points(i)
    closed = bool(fronts.closed[i])
    ended = "" if closed else max(fronts.ended[i], fronts.ended[i + fronts.s])
    return Curve(points * fronts.scale, tangents, fronts.scale, closed, ended, second=second)
