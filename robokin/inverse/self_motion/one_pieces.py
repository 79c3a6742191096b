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
from typing import NamedTuple

import numpy as np

from robokin.arrays import Array
from robokin.inverse.self_motion.swivel_curves import entries_at
from robokin.inverse.self_motion.swivel_pieces import (
    ALIKE,
    MEETS,
    SURE,
    TURN,
    VAGUE,
    SwivelBounds,
    meetings,
    turned_away,
)

_VAGUE = np.array([VAGUE])


class Piece(NamedTuple):
    """An interval of ψ [rad] of a curve, and whether it is all of it: the numbers of `SwivelPieces`."""

    code: int
    first: float
    last: float
    whole: float


class Looked(NamedTuple):
    """A curve at its places of ψ: whether it is within the limits between each and the next, and there; where a joint
    stops there; where it is beyond a limit by so little that it may be rounding, between and there."""

    within: list[bool]
    at: list[bool]
    stops: list[bool]
    vague: list[bool]
    vague_at: list[bool]


@dataclass(frozen=True, eq=False)
class OneBounds:
    """Limits of an arm as one pose takes them: half, stops of `SwivelBounds` as (3, 2, 1, 1)."""

    bounds: SwivelBounds

    @cached_property
    def half(self) -> Array:
        """How far each turn may be from its middle [rad]."""
        return self.bounds.half[:, 0, 0]

    @cached_property
    def stops(self) -> Array:
        """Which joints have limits a full turn apart."""
        return self.bounds.stops[:, 0, 0]

    def pieces(self, q4: Sequence[float], entries: Array) -> list[Piece] | None:
        """The pieces of curves with real elbows q4 (2) [rad], not straight; None where there is doubt.

        entries: (2, 2, 5, 3) as `SwivelCurves` has them.
        """
        psi, touched = meetings(entries[None], self.bounds, _VAGUE)
        elbows, places, midway = [], [], []
        for e, (row, touches) in enumerate(zip(psi[0].tolist(), touched[0].tolist(), strict=True)):
            away = q4[e] - self.bounds.elbow[0]
            room = self.bounds.elbow[1] - abs(away - TURN * round(away / TURN))
            if room >= -SURE:
                if touches:
                    return None
                some, amid = _apart(row)
                elbows.append((e, len(some)))
                places.append(some)
                midway.append(amid)
            elif room > -VAGUE:
                return None
        found: list[Piece] = []
        if not elbows:
            return found
        looked = self._looked(entries, elbows, np.array([x for one in (*places, *midway) for x in one]))
        for (e, _), some, own in zip(elbows, places, looked, strict=True):
            for pair, one in enumerate(own):
                if not _along(4 * e + pair, some, one, found):
                    return None
        return found

    def _looked(self, entries: Array, elbows: list[tuple[int, int]], psi: Array) -> list[list[Looked]]:
        """What is known of the curves of some elbows, with so many places each, at ψ: places, then midway ones."""
        elbow = np.repeat([e for e, _ in elbows] * 2, [count for _, count in elbows] * 2)
        away = turned_away(entries_at(entries.transpose(3, 2, 1, 0).take(elbow, axis=3), psi), self.bounds)
        least = np.minimum.reduce(self.half - away, axis=0)
        margin = np.minimum(least[0][:, None], least[1]).reshape(4, -1)
        sure = margin >= -SURE
        vague = (margin > -VAGUE) > sure
        inside, count = sure.tolist(), len(psi) // 2
        doubtful = vague.tolist() if vague.any() else [[False] * len(psi)] * 4
        stop = [[False] * count] * 4
        if self.bounds.stopping:
            meets = np.logical_or.reduce((away[..., :count] >= np.pi - MEETS) & self.stops, axis=0)
            stop = (meets[0][:, None] | meets[1]).reshape(4, -1).tolist()
        looked, start = [], 0
        for _, many in elbows:
            at, amid = slice(start, start + many), slice(count + start, count + start + many)
            looked.append(
                [Looked(inside[k][amid], inside[k][at], stop[k][at], doubtful[k][amid], doubtful[k][at]) for k in range(4)]
            )
            start += many
        return looked


def _apart(row: list[float]) -> tuple[list[float], list[float]]:
    """The places of ψ in order, and what is midway from each to the next, without those that have no inside."""
    places, midway = [], []
    for here, there in zip(row, [*row[1:], row[0] + TURN], strict=True):
        gap = there - here
        if gap >= ALIKE:
            places.append(here)
            midway.append(here + 0.5 * gap)
    return places, midway


def _along(code: int, places: list[float], looked: Looked, found: list[Piece]) -> bool:
    """Put the pieces of a curve to those that were found; no where there is doubt."""
    within, at, stops, vague, vague_at = looked
    if True in vague:
        return False
    if not (True in within or True in at or True in vague_at):
        return True
    begins, ends, pieces = [], [], []
    before, whole = within[-1], True
    for k, inside in enumerate(within):
        if inside != before:
            (begins if inside else ends).append(k)
        elif vague_at[k]:
            return False
        elif inside and stops[k]:
            begins.append(k)
            ends.append(k)
            whole = False
        elif at[k] and not inside:
            # On a limit is within it, also in a single point.
            pieces.append(Piece(code, places[k], places[k], 0.0))
        whole = whole and inside
        before = inside
    later = bool(begins) and ends[0] <= begins[0]
    for rank, k in enumerate(begins):
        # A run that goes on beyond π ends where the first end of its curve is.
        first, last = places[k], places[ends[(rank + later) % len(ends)]]
        pieces.append(Piece(code, first, last + TURN if last <= first else last, 0.0))
    if whole:
        pieces.append(Piece(code, -math.pi, math.pi, 1.0))
    pieces.sort(key=lambda piece: piece.first)
    end = -math.inf
    for _, first, last, all_round in pieces:
        length = last - first
        left_out = TURN - length
        if 0.0 < length < VAGUE or (not all_round and ALIKE < left_out < VAGUE) or 0.0 != first - end < VAGUE:
            return False
        end = last
    found += pieces
    return True
