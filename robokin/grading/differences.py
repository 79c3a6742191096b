"""A difference of two robots in words: which joint, what of it, found and expected."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robokin.grading.chain_freedom import across
from robokin.grading.gaps import Gap, angle_between, feet
from robokin.grading.same_robot import Match, Skeleton
from robokin.grading.tolerance import Tolerance


@dataclass(frozen=True)
class Difference:
    """What differs at a joint (from 1; None for the tool).

    `what` names it; found and expected are its values [rad or m], or found how much it is off and expected None.
    """

    joint: int | None
    what: str
    angle: bool
    found: float
    expected: float | None


def difference_of(found: Match, allowed: Tolerance) -> Difference:
    """The difference at which a match ended, as a value of the table where it is one.

    Twist, distance and offset are read off the axes of each robot alone; where these agree, what differs is how far
    the axis is from its place.
    """
    i, gap = found.joint, found.gap
    assert i is not None
    assert gap is not None
    if i == len(found.right.axes):
        turned = not allowed.allows_angle(gap.twist) and allowed.allows_position(gap.distance)
        what = "orientation of the tool" if turned else "position of the tool"
        return Difference(None, what, turned, gap.twist if turned else gap.distance, None)
    name, _ = gap.worst(allowed)
    if i == 0:
        turned = name == "twist"
        what = "direction of axis 1 in the world" if turned else "place of axis 1 in the world"
        return Difference(1, what, turned, gap.twist if turned else gap.distance, None)
    values = [_values(skeleton, i) for skeleton in (found.given, found.right)]
    # A joint whose sense is open may be told the other way round.
    values[0] = (_nearer(values[0][0], values[1][0], gap.twist), *values[0][1:])
    for what, k, angle in (
        (f"angle between axes {i} and {i + 1}", 0, True),
        (f"distance between axes {i} and {i + 1}", 1, False),
        (f"offset along axis {i}, from axis {i - 1} to axis {i + 1}", 2, False),
    ):
        if np.isnan(values[0][k]) or np.isnan(values[1][k]):
            continue
        off = abs(values[0][k] - values[1][k])
        if not (allowed.allows_angle(off) if angle else allowed.allows_position(off)):
            return Difference(i + 1, what, angle, values[0][k], values[1][k])
    return _rest(i, name, gap)


def _nearer(found: float, expected: float, off: float) -> float:
    """The angle or its supplement, by how much it is off; NaN where neither is off by that."""
    near = min((found, np.pi - found), key=lambda angle: abs(abs(angle - expected) - off))
    return near if abs(abs(near - expected) - off) < 1e-6 else np.nan


def _rest(i: int, name: str, gap: Gap) -> Difference:
    if name == "turn":
        return Difference(i + 1, f"axis {i + 1} is turned about axis {i} (the zero of joint {i})", True, gap.turn, None)
    if name == "twist":
        return Difference(i + 1, f"axis {i + 1} has another direction", True, gap.twist, None)
    if name == "offset":
        return Difference(i + 1, f"axis {i + 1} stands elsewhere along axis {i}", False, gap.offset, None)
    return Difference(i + 1, f"axis {i + 1} is not where it should be", False, gap.distance, None)


def _values(skeleton: Skeleton, i: int) -> tuple[float, float, float]:
    """Of axes i - 1 and i (from 0): the angle, the distance, the offset along the first; NaN where there is none."""
    before, axis = skeleton.axes[i - 1], skeleton.axes[i]
    twist, distance, offset = angle_between(before.u, axis.u), np.nan, np.nan
    if before.turning and axis.turning:
        first, second = feet(before, axis)
        distance = float(np.linalg.norm(across(second - first, before.u)))
        parallel = np.linalg.norm(np.cross(before.u, axis.u)) < 1e-6
        if i >= 2 and skeleton.axes[i - 2].turning and not parallel:
            behind = skeleton.axes[i - 2]
            if np.linalg.norm(np.cross(behind.u, before.u)) >= 1e-6:
                offset = float(abs((first - feet(behind, before)[1]) @ before.u))
    return twist, distance, offset
