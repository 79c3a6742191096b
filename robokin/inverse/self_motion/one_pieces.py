"""The pieces of one pose's self-motions within the joint limits: what `swivel_pieces` gives, by lists.

Statement. Give the intervals of ψ in which all joints are within their limits.
Derivation. Where joints meet their limits, and how far they are from these there and midway, is calculated as for many
poses, for both elbows in one table; what follows is told by walking along each curve.
Degenerate case. Where the steps of many poses would doubt, there is no answer.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from operator import itemgetter
from typing import NamedTuple

import numpy as np

from robokin.arrays import Array, Flags
from robokin.inverse.self_motion.swivel_curves import TURN
from robokin.inverse.self_motion.swivel_pieces import (
    ALIKE,
    MEETS,
    SURE,
    VAGUE,
    SwivelBounds,
    meetings,
    turned_away,
)
from robokin.inverse.self_motion.swivel_turns import entries_at

AS_VAGUE = np.array([VAGUE])
"""`VAGUE` of one pose, whose elbow is not straight."""


Piece = tuple[int, float, float, float]
"""An interval of ψ [rad]: curve, first and last, and 1 where it is all of the curve, as `SwivelPieces` has them."""


class Looked(NamedTuple):
    """A curve at its places of ψ, as bits: whether it is within the limits between each and the next, and there; where
    it is beyond a limit by so little that it may be rounding, between and there; where a joint stops there."""

    within: int
    at: int
    vague: int
    vague_at: int
    stops: int


@dataclass(frozen=True, eq=False)
class OneBounds:
    """Limits of an arm as one pose takes them: half, stops of `SwivelBounds` as (3, 2, 1, 1)."""

    bounds: SwivelBounds

    @cached_property
    def half(self) -> Array:
        """How far each turn may be from its middle [rad]."""
        return np.asarray(self.bounds.half[:, 0, 0])

    @cached_property
    def stops(self) -> Flags:
        """Which joints have limits a full turn apart."""
        return np.asarray(self.bounds.stops[:, 0, 0])

    def pieces(self, q4: Sequence[float], entries: Array) -> list[Piece] | None:
        """The pieces of curves with real elbows q4 (2) [rad], not straight; None where there is doubt.

        entries: (2, 2, 5, 3) as `SwivelCurves` has them.
        """
        psi, touched = meetings(entries[None], self.bounds, AS_VAGUE)
        elbows: list[tuple[int, list[float]]] = []
        midway: list[float] = []
        for e, (row, touches) in enumerate(zip(psi[0].tolist(), touched[0].tolist(), strict=True)):
            away = q4[e] - self.bounds.elbow[0]
            room = self.bounds.elbow[1] - abs(away - TURN * round(away / TURN))
            if room >= -SURE:
                if touches:
                    return None
                places, amid = _apart(row)
                elbows.append((e, places))
                midway += amid
            elif room > -VAGUE:
                return None
        found: list[Piece] = []
        if not elbows:
            return found
        rows = self._looked(entries, elbows, midway)
        start, count = 0, len(midway)
        for e, places in elbows:
            many = (1 << len(places)) - 1
            for pair, (sure, vague, stop) in enumerate(rows):
                between = count + start
                shifted = sure >> between, sure >> start, vague >> between, vague >> start, stop >> start
                looked = Looked(*(bits & many for bits in shifted))
                if not _along(4 * e + pair, places, looked, found):
                    return None
            start += len(places)
        return found

    def _looked(
        self, entries: Array, elbows: list[tuple[int, list[float]]], midway: list[float]
    ) -> list[tuple[int, ...]]:
        """For each pair of signs of shoulder and wrist, as bits of the elbows' places one after the other, then of
        those midway: which are within the limits, which are beyond by so little that it may be rounding, where a
        joint stops."""
        elbow = np.repeat([e for e, _ in elbows] * 2, [len(places) for _, places in elbows] * 2)
        psi = np.array([*(one for _, places in elbows for one in places), *midway])
        away = turned_away(entries_at(entries.transpose(3, 2, 1, 0).take(elbow, axis=3), psi), self.bounds)
        least = np.minimum.reduce(self.half - away, axis=0)
        margin = np.minimum(least[0][:, None], least[1])
        sure = margin >= -SURE
        bits = [_bits(sure), _bits((margin > -VAGUE) > sure), (0, 0, 0, 0)]
        if self.bounds.stopping:
            meets = np.logical_or.reduce((away >= np.pi - MEETS) & self.stops, axis=0)
            bits[2] = _bits(meets[0][:, None] | meets[1])
        return [*zip(*bits, strict=True)]


def _bits(flags: Flags) -> tuple[int, ...]:
    """Flags (2, 2, K) as four numbers, the first of each as its lowest bit."""
    packed = np.packbits(flags.reshape(4, -1), axis=1, bitorder="little")
    row, width = packed.tobytes(), packed.shape[1]
    return tuple(int.from_bytes(row[k : k + width], "little") for k in range(0, 4 * width, width))


def _apart(row: list[float]) -> tuple[list[float], list[float]]:
    """The places of ψ in order, and what is midway from each to the next, without those that have no inside."""
    places, midway = [], []
    here = row[0]
    for there in (*row[1:], here + TURN):
        gap = there - here
        if gap >= ALIKE:
            places.append(here)
            midway.append(here + 0.5 * gap)
        here = there
    return places, midway


def _along(code: int, places: list[float], looked: Looked, found: list[Piece]) -> bool:
    """Put the pieces of a curve to those that were found; no where there is doubt."""
    within, at, vague, vague_at, stops = looked
    count = len(places)
    everywhere = (1 << count) - 1
    before = (within << 1 | within >> (count - 1)) & everywhere
    outside = everywhere & ~(within | before)
    if vague or vague_at & (outside | (within & before)):
        return False
    stops &= within & before
    points = at & outside
    if not within and not points:
        return True
    begins, ends = _places(within & ~before | stops), _places(before & ~within | stops)
    later = bool(begins) and ends[0] <= begins[0]
    # On a limit is within it, also in a single point.
    pieces = [(code, places[k], places[k], 0.0) for k in _places(points)]
    for k, end in zip(begins, [*ends[later:], *ends[:later]], strict=True):
        # A run that goes on beyond π ends where the first end of its curve is.
        first, last = places[k], places[end]
        pieces.append((code, first, last + TURN if last <= first else last, 0.0))
    if within == everywhere and not stops:
        pieces.append((code, -math.pi, math.pi, 1.0))
    if points:
        pieces.sort(key=itemgetter(1))
    before_it = -math.inf
    for _, first, last, whole in pieces:
        length = last - first
        left_out = TURN - length
        if 0.0 < length < VAGUE or (not whole and ALIKE < left_out < VAGUE) or 0.0 != first - before_it < VAGUE:
            return False
        before_it = last
    found += pieces
    return True


def _places(bits: int) -> list[int]:
    """Which bits are set, in order."""
    found = []
    while bits:
        low = bits & -bits
        found.append(low.bit_length() - 1)
        bits ^= low
    return found
