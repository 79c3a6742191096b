"""The way of an arm along a path, as pictures show it: rows, the tool's places, what happens on the way."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array
from robokin.inverse.joint_paths import Event, Path, PathTurn

MOST_ROWS, MOST_VALUES = 181, 720
"""Rows that a picture keeps at most, and joint values in them: more are thinned out, so that a page stays small."""

PLAYED = 4.0
"""Seconds in which a path without a duration is played."""


@dataclass(frozen=True, eq=False)
class ArmTrack:
    """Rows of a path, evenly taken from all.

    t (m,): from 0 to 1, or [s] where `timed`; q (m, n) [rad | m]; rates (m, n) [rad/s | m/s] or None; places (m, 3) [m]
    of the tool; seconds: how long one unit of t is played; marks: the row and the words of each event on the way.
    """

    t: Array
    q: Array
    rates: Array | None
    places: Array
    timed: bool
    seconds: float
    marks: tuple[tuple[int, str], ...]


def track_of(path: Path, words: Sequence[str] = ()) -> ArmTrack:
    """The track of a path; words: what is said of each of its events and turns, by default its own words."""
    count = len(path.t)
    kept = np.array(rows_of(count, min(MOST_ROWS, max(MOST_VALUES // path.robot.n, 2))))
    timed = path.duration is not None
    marked: list[Event | PathTurn] = [*path.events, *path.turns]
    told = [*words[: len(marked)], *(one.words for one in marked[len(words) :])]
    rows = [int(np.argmin(np.abs(path.s[kept] - one.fraction))) for one in marked]
    # In the order in which they come, turns before what happens after them.
    marks = sorted(zip(rows, told, marked, strict=True), key=lambda one: (one[0], not isinstance(one[2], PathTurn)))
    return ArmTrack(
        path.t[kept], path.q[kept], None if path.velocity is None else path.velocity[kept], path.T[kept, :3, 3],
        timed, 1.0 if timed else PLAYED, tuple((row, words) for row, words, _ in marks),
    )  # fmt: skip


def rows_of(count: int, most: int) -> list[int]:
    """Up to `most` of `count` rows, evenly, with the first and the last."""
    rows: list[int] = np.unique(np.round(np.linspace(0, count - 1, min(most, count))).astype(int)).tolist()
    return rows
