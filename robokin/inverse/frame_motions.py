"""A frame that moves from one pose to another: along a straight line, or by a screw motion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array
from robokin.errors import InputError
from robokin.inverse.tool_curves import HALF_TURN, Line
from robokin.spatial.screw_motions import ScrewMotion, screw_between

FARTHEST = 1e100
"""Metres."""

ALONG = ("line", "screw")
"""How a frame moves: its origin straight while it turns about one fixed direction, or as a screw."""


@dataclass(frozen=True, eq=False)
class FrameMotion:
    """The way of a frame.

    along: one of ALONG; t (m,): the part of the way, from 0 to 1 in even steps; T (m, 4, 4) [m]; screw: the screw
    motion between the same two frames, whichever way is taken.
    """

    along: str
    t: Array
    T: Array
    screw: ScrewMotion

    @property
    def notes(self) -> tuple[str, ...]:
        """Sentences on what is a choice."""
        if self.screw.angle > np.pi - HALF_TURN:
            return ("it turns by half a turn, which is as short the other way round",)
        return ()


def frame_motion(first: Array, last: Array, along: str = "line", steps: int = 10) -> FrameMotion:
    """The way from one frame to another (4, 4) [m] in even steps; both ends are kept to the last digit.

    Raises InputError for frames that are too far away: squares of what is larger are no numbers.
    """
    if not max(np.max(np.abs(first)), np.max(np.abs(last))) < FARTHEST:
        raise InputError("a frame is too far away for a number, expected less")
    screw = screw_between(first, last)
    t = np.linspace(0.0, 1.0, steps + 1)
    T = screw.at(t) if along == "screw" else Line(first, last).at(t)
    T[0], T[-1] = first, last
    return FrameMotion(along, t, T, screw)
