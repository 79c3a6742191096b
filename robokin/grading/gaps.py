"""How far a joint's axis is from where it should be, in the terms of a table."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array
from robokin.grading.chain_freedom import Axis, Near, across, shortest_turn, turn_about
from robokin.grading.tolerance import Tolerance
from robokin.spatial import transform


@dataclass(frozen=True)
class Gap:
    """How far an axis is from where it should be: twist and turn [rad], distance and offset [m].

    Twist and distance are against the axis before, offset and turn along and about it.
    """

    twist: float
    turn: float
    distance: float
    offset: float

    def worst(self, allowed: Tolerance) -> tuple[str, float]:
        """The name of the greatest error as a part of what is allowed, and that part."""
        parts = {name: getattr(self, name) / max(allowed.angle, 1e-15) for name in ("twist", "turn")}
        parts |= {name: getattr(self, name) / max(allowed.position, 1e-15) for name in ("distance", "offset")}
        name = max(parts, key=lambda key: parts[key])
        return name, parts[name]

    def within(self, allowed: Tolerance) -> bool:
        """Whether all of it is allowed."""
        angles, lengths = (self.twist, self.turn), (self.distance, self.offset)
        return all(map(allowed.allows_angle, angles)) and all(map(allowed.allows_position, lengths))


def gap_of(right: Axis, given: Axis, before: Axis | None, near: Near) -> tuple[Gap, Array]:
    """How far an axis is from where it should be, in a table's terms; and the motion (4, 4) that takes it there."""
    # Measured at the foot of the common normal with the axis before: there the lengths of a table are.
    foot = right.o if before is None else feet(before, right)[1]
    turn, back = 0.0, np.eye(4)
    if before is not None and (arms := _arms(right, given, before, near)) is not None:
        # About the axis before first, which is the joint angle; the rest is then twist and lengths.
        turn = float(np.arctan2(before.u @ np.cross(arms[1], arms[0]), arms[1] @ arms[0]))
        back = turn_about(before, turn)
        given = given.moved(back)
    twist = angle_between(right.u, given.u)
    off = across(foot - given.o, given.u) if right.turning else np.zeros(3)
    R = shortest_turn(given.u, right.u)
    at = foot - off if right.turning else given.o
    back = transform(R, at + off - R @ at) @ back
    distance, offset = float(np.linalg.norm(off)), 0.0
    if before is not None:
        normal = np.cross(before.u, right.u)
        sine = float(np.linalg.norm(normal))
        if sine > near.angle:
            normal /= sine
            distance, offset = abs(float(off @ normal)), abs(float(off @ np.cross(right.u, normal))) / sine
    return Gap(twist, abs(turn), distance, offset), back


FAR_ENOUGH = 10.0
"""Parallel axes at so many times the allowed length tell the angle about the first."""


def _arms(right: Axis, given: Axis, before: Axis, near: Near) -> tuple[Array, Array] | None:
    """The two directions across the axis before whose angle is the joint angle's error; None where there are none."""
    a, b = across(right.u, before.u), across(given.u, before.u)
    if min(np.linalg.norm(a), np.linalg.norm(b)) > near.angle:
        return a, b
    if not (before.turning and right.turning):
        return None
    a, b = across(right.o - before.o, before.u), across(given.o - before.o, before.u)
    return (a, b) if min(np.linalg.norm(a), np.linalg.norm(b)) > FAR_ENOUGH * near.length else None


def angle_between(u: Array, v: Array) -> float:
    """The angle [rad], 0 to π, between two directions (3,)."""
    return float(np.arctan2(np.linalg.norm(np.cross(u, v)), u @ v))


def feet(first: Axis, second: Axis) -> tuple[Array, Array]:
    """The points (3,) of two lines that are nearest to each other; of parallel ones those beside the first's point."""
    u, v, w = first.u, second.u, second.o - first.o
    cross = np.cross(u, v)
    square = float(cross @ cross)
    if square < 1e-16:
        return first.o, second.o - v * (v @ w)
    return first.o + u * (np.cross(w, v) @ cross / square), second.o + v * (np.cross(w, u) @ cross / square)
