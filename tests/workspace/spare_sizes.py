"""Sizes of arms with joints to spare that are known otherwise: by integrals over the orbits of the first joint.

The first joint turns or shifts whatever the others can do. So of all points that differ in nothing but what the first
joint changes, those that are reached are the intervals that the others leave (their values at the same radius, or at
the same distance from the slide), each longer by the first joint's stroke. The others' fibre at a radius is a curve
over the last joint with two branches, elbow up and down; where it begins and ends is found by halving.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from robokin.model import Joint, JointType, Robot

Array = NDArray[np.float64]
TURN = 2.0 * np.pi
RADII, VALUES, HALVINGS = 2000, 400, 45
JUMP, PARTS, REFINED = 0.02, 16, 3
SLACK = 1e-9


class Plane:
    """What a first joint (R, or P along y) and then two R with links reach in a plane; `tip` turns the last link into
    a vector further: its end is at link + tip.

    first: its limits; links (a1, a2, a3), a1 = 0 for a sliding one; limits of the two others.
    """

    def __init__(
        self, slides: bool, first: tuple[float, float], links: Array, limits: Array, tip: complex = 0j
    ) -> None:
        self.slides, self.first, self.links, self.limits = slides, first, links, limits
        self.last = links[2] + tip

    def fibre(self, r: Array, q3: Array, sign: float) -> tuple[NDArray[np.bool_], Array]:
        """Whether the second joint is within its limits, and what the first joint changes, at r and q3 (any shape)."""
        h = self.links[1] + self.last * np.exp(1j * q3)
        a, size = self.links[0], np.abs(h)
        with np.errstate(divide="ignore", invalid="ignore"):
            cosine = r / size if self.slides else (r * r - a * a - size * size) / (2.0 * a * size)
            q2 = sign * np.arccos(cosine) - np.angle(h)
        low, high = self.limits[0]
        inside = np.abs(cosine) <= 1.0
        inside &= np.mod(np.nan_to_num(q2) - low + SLACK, TURN) <= high - low + 2.0 * SLACK
        tip = h * np.exp(1j * np.nan_to_num(q2))
        return inside, tip.imag if self.slides else np.angle(a + tip)

    def values(self, r: Array) -> Array:
        """(m, k) rising values of the third joint for each r (m,): even ones, and those with the second at a limit."""
        low, high = self.limits[1]
        q3 = [np.broadcast_to(np.linspace(low, high, VALUES), (len(r), VALUES))]
        for q2 in self.limits[0]:
            with np.errstate(invalid="ignore"):
                if self.slides:
                    lag, rest = q2, r - self.links[1] * np.cos(q2)
                    angle = np.arccos(rest / np.abs(self.last))
                else:
                    before = self.links[0] * np.exp(-1j * q2) + self.links[1]
                    c, lag = np.abs(self.last), -np.angle(before)
                    angle = np.arccos((r * r - np.abs(before) ** 2 - c * c) / (2.0 * np.abs(before) * c))
            for sign in (1.0, -1.0):
                value = low + np.mod(sign * angle - lag - np.angle(self.last) - low, TURN)
                q3.append(np.where(value <= high, value, low)[:, None])
        return np.sort(np.concatenate(q3, axis=1), axis=1)

    def intervals(self, r: Array) -> tuple[NDArray[np.intp], Array, Array]:
        """Index (k,) into r, and what is reached there from low to high (k,) by the first joint's coordinate."""
        q3 = self.values(r)
        rows, lows, highs = [], [], []
        for sign in (1.0, -1.0):
            inside, value = self.fibre(r[:, None], q3, sign)
            i, j = np.nonzero(inside[:, 1:] != inside[:, :-1])
            good, bad = q3[i, j], q3[i, j + 1]
            good, bad = np.where(inside[i, j], good, bad), np.where(inside[i, j], bad, good)
            for _ in range(HALVINGS):
                middle = 0.5 * (good + bad)
                there = self.fibre(r[i], middle, sign)[0]
                good, bad = np.where(there, middle, good), np.where(there, bad, middle)
            ends = self.fibre(r[i], good, sign)[1]
            # Pieces between neighbouring values, joined wherever both are reached.
            a, b = np.nonzero(inside[:, 1:] & inside[:, :-1])
            pieces = [(a, value[a, b], value[a, b + 1])]
            pieces.append((i, ends, value[i, np.where(inside[i, j], j, j + 1)]))
            for row, one, other in pieces:
                other = one + (other - one if self.slides else np.mod(other - one + np.pi, TURN) - np.pi)
                rows.append(row)
                lows.append(np.minimum(one, other))
                highs.append(np.maximum(one, other))
        return np.concatenate(rows), np.concatenate(lows) + self.first[0], np.concatenate(highs) + self.first[1]

    def radii(self) -> tuple[float, float]:
        """The first joint's invariant lies between these."""
        most = float(np.abs(self.last) + self.links[1] + self.links[0])
        return (-most if self.slides else 0.0), most

    def covered(self, r: Array) -> Array:
        """(m,) how much of the first joint's coordinate is reached at each r."""
        return np.array([float(np.sum(np.diff(own, axis=1))) for own in self.unions(r)])

    def unions(self, r: Array) -> list[Array]:
        """At each r (m,) what is reached: (k, 2) intervals."""
        return _unions(*self.intervals(r), len(r), not self.slides)

    def area(self) -> float:
        """[m²]"""
        return integral(lambda r: self.covered(r) * (1.0 if self.slides else r), *self.radii(), RADII)


def _unions(row: NDArray[np.intp], low: Array, high: Array, count: int, circle: bool) -> list[Array]:
    order = np.argsort(row, kind="stable")
    row, low, high = row[order], low[order], high[order]
    bounds = np.searchsorted(row, np.arange(count + 1))
    return [_union(low[a:b], high[a:b], circle) for a, b in pairwise(bounds)]


def integral(f: Callable[[Array], Array], low: float, high: float, count: int) -> float:
    """∫ f by its values at the middles of even steps, finer and finer about those where it jumps; f is zero beyond."""
    beyond = 2.0 / count * (high - low)
    low, high = low - beyond * (low < 0.0), high + beyond
    at = low + (high - low) * (np.arange(count) + 0.5) / count
    width = np.full(count, (high - low) / count)
    value = f(at)
    for _ in range(REFINED):
        jump = np.abs(np.diff(value)) > JUMP * np.max(np.abs(value))
        split = np.zeros(len(at), dtype=bool)
        split[:-1] |= jump
        split[1:] |= jump
        offsets = (np.arange(PARTS) + 0.5) / PARTS - 0.5
        finer = (at[split, None] + width[split, None] * offsets).ravel()
        at, width, value = (
            np.concatenate([kept[~split], new])
            for kept, new in ((at, finer), (width, np.repeat(width[split] / PARTS, PARTS)), (value, f(finer)))
        )
        order = np.argsort(at)
        at, width, value = at[order], width[order], value[order]
    return float(np.sum(width * value))


def _union(low: Array, high: Array, circle: bool) -> Array:
    """(k, 2) the intervals' union, apart; on a circle within [0, 2π]."""
    if not len(low):
        return np.zeros((0, 2))
    if circle:
        if np.any(high - low >= TURN):
            return np.array([[0.0, TURN]])
        start = np.mod(low, TURN)
        end = start + (high - low)
        over = end > TURN
        low = np.concatenate([start, np.zeros(int(np.sum(over)))])
        high = np.concatenate([np.minimum(end, TURN), end[over] - TURN])
    order = np.argsort(low, kind="stable")
    low, high = low[order], high[order]
    reach = np.maximum.accumulate(high)
    new = np.concatenate([[True], low[1:] > reach[:-1]])
    starts = low[new]
    ends = np.append(reach[:-1][new[1:]], reach[-1])
    return np.stack([starts, ends], axis=1)


def _stroke(rng: np.random.Generator, least: float = 0.35) -> tuple[float, float]:
    if rng.random() < 0.2:
        return -np.pi, np.pi
    middle, width = rng.uniform(-np.pi, np.pi), rng.uniform(least, 5.6)
    return middle - width / 2, middle + width / 2


def _row(a: float, limits: tuple[float, float], alpha: float = 0.0, slides: bool = False, d: float = 0.0) -> Joint:
    if not slides and limits[1] - limits[0] >= TURN - 1e-12:
        limits = (-np.inf, np.inf)
    return Joint("", JointType.PRISMATIC if slides else JointType.REVOLUTE, a=a, alpha=alpha, d=d, limits=limits)


FAMILIES = {
    "planar 3R": 3e-5,
    "PRR": 3e-5,
    "waist and 3R": 3e-5,
    "waist, offset, 3R": 3e-5,
    "spare, closed form": 1e-12,
    "planar 4R": 2e-4,
}
"""Families of arms with a joint to spare or two, and how well their sizes are known, as a part of them."""


def spare_arm(family: str, number: int) -> tuple[Robot, float]:
    """An arm of a family and the size of what it reaches [m² | m³]."""
    kind = list(FAMILIES).index(family)
    rng = np.random.default_rng((len(FAMILIES) * number + kind, 0x517E))
    scale = 10.0 ** rng.integers(-3, 4)
    links = np.append(rng.uniform(0.2, 1.0, 3), 0.0)
    first, second, third = _stroke(rng), _stroke(rng), _stroke(rng)
    limits = np.array([second, third])
    rows: list[Joint]
    if kind == 0:
        size = Plane(False, first, links[:3], limits).area()
        rows, dimension = [_row(links[0], first), _row(links[1], second), _row(links[2], third)], 2
    elif kind == 1:
        first = (0.0, float(rng.uniform(0.1, 1.5)))
        links[0] = 0.0
        size = Plane(True, first, links[:3], limits).area()
        rows, dimension = [_row(0.0, first, np.pi / 2, True), _row(links[1], second), _row(links[2], third)], 2
    elif kind in (2, 3):
        # Waist and plane: without an offset and any stroke, or with an offset and half a turn at most.
        offset = 0.0 if kind == 2 else float(rng.uniform(-0.3, 0.3))
        width = TURN if rng.random() < 0.4 else rng.uniform(0.5, 6.2)
        width = width if kind == 2 else min(width, np.pi)
        waist = (-width / 2, width / 2)
        size, dimension = _turned(Plane(False, first, links[:3], limits), offset, width), 3
        rows = [_row(offset, waist, np.pi / 2, d=0.3)]
        rows += [_row(a, limit) for a, limit in zip(links, (first, second, third), strict=False)]
    elif kind == 4:
        size, rows, dimension = _closed(rng)
    else:
        # A planar arm of four joints: the third one's intervals together.
        fourth = _stroke(rng)
        last = float(rng.uniform(0.2, 0.6))
        size, dimension = _four(first, links, limits, fourth, last), 2
        rows = [_row(links[0], first), _row(links[1], second), _row(links[2], third), _row(last, fourth)]
    moved = [replace(row, a=row.a * scale, d=row.d * scale, limits=_times(row, scale)) for row in rows]
    named = tuple(replace(row, name=str(i + 1)) for i, row in enumerate(moved))
    return Robot(f"{family} {number}", named, id="known"), size * scale**dimension


def _times(row: Joint, scale: float) -> tuple[float, float]:
    return row.limits if row.type is JointType.REVOLUTE else (row.limits[0] * scale, row.limits[1] * scale)


def _turned(plane: Plane, offset: float, width: float) -> float:
    """The volume that a plane set sweeps as it turns by `width` about the line x = 0, its own origin at x = offset."""

    def swept(r: Array) -> Array:
        total = np.zeros(len(r))
        for k, own in enumerate(plane.unions(r)):
            some = _weighed(own, offset, r[k])
            total[k] = r[k] * width * some
            if width > np.pi and len(own):
                # What is there on either side of the line is swept twice, and by a whole turn at most.
                pair = np.concatenate([own, np.pi - own[:, ::-1]])
                twice = some - 0.5 * _weighed(_union(pair[:, 0], pair[:, 1], True), 0.0, r[k])
                total[k] -= r[k] * (2.0 * width - TURN) * twice
        return total

    return integral(swept, *plane.radii(), RADII)


def _weighed(intervals: Array, offset: float, r: float) -> float:
    """∫ |offset + r cos φ| dφ over intervals."""

    def primitive(phi: Array) -> Array:
        # The zeros cut [0, 2π] into pieces; in each the sign is that of its middle.
        cuts = [0.0, TURN]
        if abs(offset) < r:
            zero = float(np.arccos(-offset / r))
            cuts = [0.0, zero, TURN - zero, TURN]
        total = np.zeros_like(phi)
        for a, b in pairwise(cuts):
            sign = np.sign(offset + r * np.cos(0.5 * (a + b)))
            end = np.clip(phi, a, b)
            total += sign * (offset * (end - a) + r * (np.sin(end) - np.sin(a)))
        return total

    return float(np.sum(primitive(intervals[:, 1]) - primitive(intervals[:, 0])))


def _four(
    first: tuple[float, float],
    links: Array,
    limits: Array,
    fourth: tuple[float, float],
    last: float,
    counts: tuple[int, int] = (500, 60),
) -> float:
    """The area of a planar arm of four joints: at each of many values of the last one it is one of three."""
    planes = [Plane(False, first, links[:3], limits, last * np.exp(1j * q4)) for q4 in np.linspace(*fourth, counts[1])]

    def covered(r: Array) -> Array:
        parts = [plane.intervals(r) for plane in planes]
        unions = _unions(*(np.concatenate(column) for column in zip(*parts, strict=True)), len(r), True)
        return r * np.array([float(np.sum(np.diff(own, axis=1))) for own in unions])

    return integral(covered, 0.0, float(np.sum(links[:3]) + last), counts[0])


def _closed(rng: np.random.Generator) -> tuple[float, list[Joint], int]:
    """Arms with a closed form: without limits, or a turning arm on a gantry."""
    free = (-np.pi, np.pi)
    a = np.sort(rng.uniform(0.2, 1.0, 4))[::-1]
    kind = int(rng.integers(4))
    if kind == 0:
        count = int(rng.integers(3, 5))
        most, least = float(np.sum(a[:count])), max(0.0, float(2.0 * a[0] - np.sum(a[:count])))
        return np.pi * (most**2 - least**2), [_row(float(x), free) for x in rng.permutation(a[:count])], 2
    if kind == 1:
        # A waist and three links: a shell.
        most, least = float(np.sum(a[:3])), max(0.0, float(2.0 * a[0] - np.sum(a[:3])))
        rows = [_row(0.0, free, np.pi / 2, d=0.4), *(_row(float(x), free) for x in rng.permutation(a[:3]))]
        return 4.0 / 3.0 * np.pi * (most**3 - least**3), rows, 3
    wide, long = rng.uniform(0.5, 1.5, 2)
    arm = float(rng.uniform(0.1, 0.45)) * float(np.hypot(wide, long))
    area = wide * long + 2.0 * arm * (wide + long) + np.pi * arm**2
    # Slides along z and, after a quarter turn about x, along -y; then about the normal of both.
    slides = [_row(0.0, (0.0, float(wide)), np.pi / 2, True), _row(0.0, (0.0, float(long)), np.pi / 2, True)]
    turn = Joint("", JointType.FIXED, alpha=np.pi / 2, theta=np.pi / 2)
    if kind == 2:
        return area, [*slides, turn, _row(arm, free)], 2
    height = float(rng.uniform(0.2, 1.0))
    # A third slide along the turning axis.
    return area * height, [*slides, turn, _row(0.0, (0.0, height), 0.0, True), _row(arm, free)], 3
