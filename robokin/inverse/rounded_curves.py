"""Lines and arcs of the tool one after the other without a stop, the corners between them rounded.

Statement. Follow curves that meet at points; near each point leave the one and join the next with continuous velocity
and acceleration, and say by how much the point is missed.
Derivation. On each curve the tool goes at one speed. Within τ on both sides of a point it leaves the last curve by
p₁(-2τ g(1 - u)) and joins the next by p₂(2τ g(u)), u from 0 to 1, both measured from the point, with g = u³ - u⁴/2:
g' grows from 0 to 1 with no slope at its ends, and g'(u) + g'(1 - u) = 1. The position is p₁ + p₂ - p, the rotation
R₁ Rᵀ R₂ with R that of the point. Between two lines this is the one quintic with their velocities and no acceleration
at its ends; its middle is 3/16 τ |v₂ - v₁| from the point. A piece is as long as √(distance² + (size · angle)²).
Sources: R. H. Taylor, Planning and Execution of Straight Line Manipulator Trajectories, IBM J. Res. Dev. 23, 1979
(the composition, with parabolas); P. Corke, Robotics, Vision and Control, 2011, section 3.1.3 (the quintic).
Degenerate case. A point that repeats the one before is none.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.errors import InputError
from robokin.inverse.tool_curves import CircularArc, Line, SlerpedTurn, ToolCurve
from robokin.spatial.rotations import axis_angle_from_rotation

LOOKED_AT = 33
"""Places of a blend, and as many of each piece, at which limits of velocity and acceleration are held."""

GRID = 513
"""Places of a blend of which the nearest to its point is taken; then it is searched for between their neighbours."""

NARROWED = 60
"""Steps of that search, each to 2/3."""

STILL = 1e-12
"""Distances [size] and angles [rad] below this are none."""

FITS = 1e-9
"""How far, relatively, blends may overlap: rounding."""


@dataclass(frozen=True)
class CornerRounding:
    """How corners are rounded: from a distance of `radius` [m] to a point on, or from `part`/2 of the shorter piece."""

    part: float
    radius: float | None = None


@dataclass(frozen=True)
class PathBlend:
    """A point that a path passes by.

    point: which one, from 1; fraction: of the path (s) where it is passed; begins, ends: where the blend does;
    distance: how far from the point the tool is where it is nearest [m]; angle: between the orientations there [rad],
    0 where the position alone is followed.
    """

    point: int
    fraction: float
    begins: float
    ends: float
    distance: float
    angle: float


_Part = tuple[Index, int, tuple[Array, Array], tuple[Array, Array] | None]


class RoundedCurve:
    """Curves (k of them) one after the other, by the fraction s of the way.

    spans: (k,) how long each is; halves: (k - 1,) how far before and after each point between a blend is, in the same;
    points: (k,) the number of the point to which each leads.
    """

    def __init__(
        self, curves: Sequence[Line | CircularArc], spans: Array, halves: Array, points: Sequence[int]
    ) -> None:
        self.curves, self.spans, self.halves, self.points = curves, spans, halves, points
        self.marks = np.concatenate([[0.0], np.cumsum(spans)])
        self.whole = float(self.marks[-1])
        self.corners = [curve.at(np.zeros(1))[0] for curve in curves[1:]]

    @property
    def places(self) -> Array:
        """(m,) parts of the way where limits of velocity and acceleration are to be looked at."""
        ends = [(mark - tau, mark + tau) for mark, tau in zip(self.marks[1:-1], self.halves, strict=True)]
        ends += [(a, b) for a, b in zip(self.marks[:-1], self.marks[1:], strict=True)]
        return np.concatenate([np.linspace(a, b, LOOKED_AT) for a, b in ends]) / self.whole

    def at(self, s: Array) -> Array:
        """(m, 4, 4) at s (m,)."""
        out = np.empty((len(s), 4, 4))
        for rows, piece, first, last in self._parts(s):
            T = self.curves[piece].at(first[0])
            if last is not None:
                corner, after = self.corners[piece], self.curves[piece + 1].at(last[0])
                T[:, :3, 3] += after[:, :3, 3] - corner[:3, 3]
                T[:, :3, :3] = T[:, :3, :3] @ corner[:3, :3].T @ after[:, :3, :3]
            out[rows] = T
        return out

    def twist(self, s: Array) -> Array:
        """(m, 6) at s (m,)."""
        out = np.empty((len(s), 6))
        for rows, piece, first, last in self._parts(s):
            v = self.curves[piece].twist(first[0]) * first[1][:, None]
            if last is not None:
                after = self.curves[piece + 1].twist(last[0]) * last[1][:, None]
                v[:, :3] += after[:, :3]
                turned = self.curves[piece].at(first[0])[:, :3, :3] @ self.corners[piece][:3, :3].T
                v[:, 3:] += np.einsum("mij,mj->mi", turned, after[:, 3:])
            out[rows] = v
        return out

    def blends(self) -> tuple[PathBlend, ...]:
        """Each point that is passed by."""
        return tuple(self._blend(k) for k in range(len(self.halves)))

    def _blend(self, k: int) -> PathBlend:
        corner, mark, tau = self.corners[k], self.marks[k + 1], self.halves[k]

        def away(x: Array) -> Array:
            gap = np.linalg.norm(self.at(x / self.whole)[:, :3, 3] - corner[:3, 3], axis=1)
            # Of a turn alone the middle of the blend is as near as any.
            return np.asarray(gap + 1e-9 * np.abs(x - mark))

        x = np.linspace(mark - tau, mark + tau, GRID)
        i = int(np.argmin(away(x)))
        low, high = x[max(i - 1, 0)], x[min(i + 1, GRID - 1)]
        for _ in range(NARROWED):
            inner = np.array([low + (high - low) / 3.0, high - (high - low) / 3.0])
            below, above = away(inner)
            low, high = (low, inner[1]) if below <= above else (inner[0], high)
        nearest = x[i] if away(x[i : i + 1])[0] <= away(np.array([low]))[0] else low
        T = self.at(np.array([nearest / self.whole]))[0]
        angle = float(axis_angle_from_rotation(corner[:3, :3].T @ T[:3, :3])[1])
        distance = float(np.linalg.norm(T[:3, 3] - corner[:3, 3]))
        begins, ends = (mark - tau) / self.whole, (mark + tau) / self.whole
        return PathBlend(self.points[k], nearest / self.whole, begins, ends, distance, angle)

    def _parts(self, s: Array) -> list[_Part]:
        """Which rows are on which piece: where on it, how fast it goes on it, and the same of the next in a blend."""
        x = s * self.whole
        piece = np.clip(np.searchsorted(self.marks, x, side="right") - 1, 0, len(self.spans) - 1)
        parts: list[_Part] = []
        blending: Flags = np.zeros(len(s), dtype=bool)
        for k, tau in enumerate(self.halves):
            rows = np.flatnonzero(np.abs(x - self.marks[k + 1]) < tau)
            if not len(rows):
                continue
            blending[rows] = True
            u = (x[rows] - self.marks[k + 1] + tau) / (2.0 * tau)
            before, after = self.whole / self.spans[k], self.whole / self.spans[k + 1]
            left = 1.0 - 2.0 * tau * _grown(1.0 - u) / self.spans[k], before * _slope(1.0 - u)
            joined = 2.0 * tau * _grown(u) / self.spans[k + 1], after * _slope(u)
            parts.append((rows, k, left, joined))
        for k, span in enumerate(self.spans):
            rows = np.flatnonzero((piece == k) & ~blending)
            if len(rows):
                speed = np.full(len(rows), self.whole / span)
                parts.append((rows, k, ((x[rows] - self.marks[k]) / span, speed), None))
        return parts


def choices(curve: ToolCurve, point: int) -> tuple[str, ...]:
    """Sentences on what is a choice of a curve to a point, counted from 1, or of several curves to points."""
    pieces = list(zip(curve.points, curve.curves, strict=True)) if isinstance(curve, RoundedCurve) else [(point, curve)]
    words = "the tool turns by half a turn, which is as short the other way round"
    return tuple(f"to point {k} {words}" for k, one in pieces if isinstance(one, SlerpedTurn) and one.half_turn)


def rounded(curves: Sequence[Line | CircularArc], rounding: CornerRounding, size: float) -> ToolCurve:
    """Curves one after the other, their corners rounded; size [m] is what a turn by a radian counts as.

    Raises InputError where a radius does not fit, or where the tool only turns.
    """
    names = ["the start", *(f"point {k + 1}" for k in range(len(curves)))]
    kept = [k for k, one in enumerate(curves) if one.distance > STILL * size or one.angle > STILL]
    if len(kept) < 2:
        return curves[kept[0] if kept else 0]
    ways = np.array([curves[k].distance for k in kept])
    spans = np.hypot(ways, size * np.array([curves[k].angle for k in kept]))
    if rounding.radius is None:
        halves = 0.5 * rounding.part * np.minimum(spans[:-1], spans[1:])
    else:
        speeds = ways / spans
        faster = np.maximum(speeds[:-1], speeds[1:])
        if not faster.all():
            k = kept[int(np.argmin(faster)) + 1]
            raise InputError(
                f"the tool only turns before and after {names[k]}, where a blend has no radius; expected a blend that "
                "is a part of the pieces"
            )
        halves = rounding.radius / faster
    used = np.concatenate([[0.0], halves]) + np.concatenate([halves, [0.0]])
    over = used / spans
    tight = int(np.argmax(over))
    if over[tight] > 1.0 + FITS:
        assert rounding.radius is not None
        k = kept[tight]
        apart = f"{ways[tight]:.6g} m apart" + (" and turn" if curves[k].angle else "")
        most = np.floor(rounding.radius / over[tight] * 1e9) / 1e9
        raise InputError(
            f"a blend radius of {rounding.radius:.6g} m does not fit between {names[k]} and {names[k + 1]}, which are "
            f"{apart}; expected at most {most:.6g} m"
        )
    return RoundedCurve([curves[k] for k in kept], spans, halves, [k + 1 for k in kept])


def _grown(u: Array) -> Array:
    return np.asarray(u**3 * (1.0 - 0.5 * u))


def _slope(u: Array) -> Array:
    return np.asarray(u * u * (3.0 - 2.0 * u))
