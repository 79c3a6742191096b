"""Moves through points in time: cubic, quintic and trapezoidal profiles, splines and blends, within joint limits.

Statement. Joints go through points q_0 … q_k together: each segment begins and ends for all joints at once. Give the
motion over the time, in a wanted duration or in the least one whose velocities and accelerations keep to their limits.
Derivation. Between two points with a stop at each, q = q_0 + σ(t/T) Δq, where σ' and σ'' are at most c_v and c_a: a
joint keeps to its limits if T ≥ c_v |Δq|/v and T² ≥ c_a |Δq|/a. Cubic: 3/2, 6; quintic: 15/8, 10/√3; trapezoidal with
the fraction β of T to speed up and as much to slow down: 1/(1 - β), 1/(β (1 - β)). Without stops: the cubic spline that
is at rest at both ends (its velocity and acceleration are continuous), and straight pieces with parabolic blends, which
pass by the points.
Sources: B. Siciliano et al., Robotics: Modelling, Planning and Control, 2009, section 4.2; J. J. Craig, Introduction to
Robotics, 3rd edition, section 7.3.
Degenerate case. A segment in which nothing moves takes no time.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np

from robokin.arrays import Array
from robokin.errors import InputError
from robokin.inverse.timed_curves import DEGREE, TimedCurve

Profile = Literal["cubic", "quintic", "trapezoidal"]
Passing = Literal["stop", "spline", "blend"]

RAMP = 1.0 / 3.0
"""The part of a trapezoidal move in which it speeds up, where nothing says otherwise: the cruising velocity is then 3/2
of the mean."""

PEAKS = {"cubic": (1.5, 6.0), "quintic": (1.875, 10.0 / math.sqrt(3.0))}
"""The greatest σ' and σ'' of the polynomials."""

SHAPES = {"cubic": (0.0, 0.0, 3.0, -2.0, 0.0, 0.0), "quintic": (0.0, 0.0, 0.0, 10.0, -15.0, 6.0)}
"""σ(τ), by the powers of τ from 0 to 1."""

BLEND = 0.2
"""A blend takes this part of the shorter of its two segments, where nothing says otherwise."""

SLOWINGS, FASTER = 500, 2.0
"""How often pieces between blends are slowed at most, and by how much at once."""

BLENDED = 1e-6
"""How much harder than the limits, relatively, blends are that are then slowed all alike."""

HAIR = 1e-6
"""Points [rad | m] that are nearer together are passed by one blend: blends between them had no time."""

ENOUGH = 1e-9
"""How much shorter, relatively, than the least duration a wanted one may be: rounding."""


@dataclass(frozen=True, eq=False)
class MotionLimits:
    """The greatest velocity and acceleration of each joint: (n,) [rad/s | m/s], [per s²], inf for none."""

    velocity: Array
    acceleration: Array

    @property
    def none(self) -> bool:
        """Whether there are none."""
        return not (np.isfinite(self.velocity).any() or np.isfinite(self.acceleration).any())


def timed_move(
    points: Array,
    profile: Profile,
    limits: MotionLimits,
    duration: float | None,
    passing: Passing = "stop",
    blend: float = BLEND,
) -> TimedCurve:
    """The motion through points (k + 1, n) [rad | m], in a duration [s], or in the least that the limits allow.

    Without limits and duration it takes a second. Raises InputError for a duration that is too short for the limits,
    and where there are limits of which none says how fast a joint that moves may be.
    """
    if passing == "spline":
        curve = _spline(points, limits)
    elif passing == "blend":
        curve = _blends(points, limits, blend)
    else:
        curve = _stops(points, profile, limits)
    if limits.none:
        return curve.slowed((1.0 if duration is None else duration) / curve.duration)
    velocity, acceleration = curve.greatest()
    if duration is None:
        return curve
    if duration < curve.duration * (1.0 - ENOUGH):
        slow = np.maximum(velocity / limits.velocity, np.sqrt(acceleration / limits.acceleration))
        raise InputError(
            f"found a duration of {duration:g} s, expected at least {curve.duration:.6g} s: joint "
            f"{int(np.argmax(slow)) + 1} is at its limit of velocity or acceleration then"
        )
    return curve.slowed(duration / curve.duration)


def _stops(points: Array, profile: Profile, limits: MotionLimits) -> TimedCurve:
    """The motion with a stop at each point, each segment as short as the limits allow."""
    times, pieces = [0.0], []
    for first, last in pairwise(points):
        move = last - first
        if not move.any():
            continue
        length, ramp = _least(np.abs(move), profile, limits)
        for start, end, shape in _shape(profile, ramp):
            powers = length ** -np.arange(DEGREE + 1.0)
            piece = np.outer(np.array(shape) * powers, move)
            piece[0] += first
            pieces.append(piece)
            times.append(times[-1] + (end - start) * length)
    return _curve(times, pieces, points)


def _curve(times: list[float], pieces: list[Array], points: Array) -> TimedCurve:
    """The curve of pieces; of none that which stands still for a second."""
    if not pieces:
        still = np.zeros((1, DEGREE + 1, points.shape[1]))
        still[0, 0] = points[0]
        return TimedCurve(np.array([0.0, 1.0]), still)
    return TimedCurve(np.array(times), np.array(pieces))


def _least(move: Array, profile: Profile, limits: MotionLimits) -> tuple[float, float]:
    """The least duration [s] of a segment in which joints move by (n,), and the ramp of a trapezoidal one.

    Without limits the unit is that of the longest move.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        slow = float(np.max(np.where(move > 0.0, move / limits.velocity, 0.0)))
        hard = float(np.max(np.where(move > 0.0, move / limits.acceleration, 0.0)))
    if slow == 0.0 and hard == 0.0:
        if not limits.none:
            still = int(np.flatnonzero(move)[0]) + 1
            raise InputError(f"joint {still} moves and has no limit, expected one of its velocity or acceleration")
        return float(np.max(move)), RAMP
    if profile != "trapezoidal":
        velocity, acceleration = PEAKS[profile]
        return max(velocity * slow, math.sqrt(acceleration * hard)), 0.0
    if hard == 0.0:
        return slow / (1.0 - RAMP), RAMP
    if slow == 0.0 or slow * slow < hard:
        return 2.0 * math.sqrt(hard), 0.5  # it never reaches the greatest velocity
    speeding = hard / slow
    return slow + speeding, speeding / (slow + speeding)


def _shape(profile: Profile, ramp: float) -> list[tuple[float, float, tuple[float, ...]]]:
    """The pieces of σ: from and to which τ, and its coefficients in the powers of what τ has grown since."""
    if profile != "trapezoidal":
        return [(0.0, 1.0, SHAPES[profile])]
    cruise = 1.0 / (1.0 - ramp)
    speed = cruise / ramp
    up = (0.0, 0.0, 0.5 * speed, 0.0, 0.0, 0.0)
    down = (1.0 - 0.5 * cruise * ramp, cruise, -0.5 * speed, 0.0, 0.0, 0.0)
    even = (0.5 * cruise * ramp, cruise, 0.0, 0.0, 0.0, 0.0)
    middle = [(ramp, 1.0 - ramp, even)] if ramp < 0.5 else []
    return [(0.0, ramp, up), *middle, (1.0 - ramp, 1.0, down)]


def _chords(points: Array, limits: MotionLimits) -> tuple[Array, Array]:
    """The points without those that repeat the one before, and how long each segment takes at the greatest velocity."""
    keep = np.concatenate([[True], np.any(np.diff(points, axis=0) != 0.0, axis=1)])
    points = points[keep]
    moves = np.abs(np.diff(points, axis=0))
    finite = np.where(np.isfinite(limits.velocity), limits.velocity, np.inf)
    lengths = np.max(moves / finite, axis=1, initial=0.0)
    longest = np.max(moves, axis=1, initial=0.0)
    return points, np.where(lengths > 0.0, lengths, longest)


def _spline(points: Array, limits: MotionLimits) -> TimedCurve:
    """The cubic spline through the points that is at rest at both ends, slowed until it keeps to the limits."""
    points, h = _chords(points, limits)
    k, n = len(h), points.shape[1]
    if not k:
        return _curve([0.0], [], points)
    slopes = np.diff(points, axis=0) / h[:, None]
    velocity = np.zeros((k + 1, n))
    if k > 1:
        matrix = np.zeros((k - 1, k - 1))
        matrix[np.arange(k - 1), np.arange(k - 1)] = 2.0 * (h[:-1] + h[1:])
        matrix[np.arange(1, k - 1), np.arange(k - 2)] = h[2:]
        matrix[np.arange(k - 2), np.arange(1, k - 1)] = h[:-2]
        velocity[1:-1] = np.linalg.solve(matrix, 3.0 * (h[1:, None] * slopes[:-1] + h[:-1, None] * slopes[1:]))
    pieces = np.zeros((k, DEGREE + 1, n))
    pieces[:, 0], pieces[:, 1] = points[:-1], velocity[:-1]
    pieces[:, 2] = (3.0 * slopes - 2.0 * velocity[:-1] - velocity[1:]) / h[:, None]
    pieces[:, 3] = (velocity[:-1] + velocity[1:] - 2.0 * slopes) / h[:, None] ** 2
    return _within(TimedCurve(np.concatenate([[0.0], np.cumsum(h)]), pieces), limits)


def _within(curve: TimedCurve, limits: MotionLimits) -> TimedCurve:
    """A curve slowed, or hurried, to the least duration that keeps to the limits."""
    if limits.none:
        return curve
    velocity, acceleration = curve.greatest()
    factor = max(
        float(np.max(velocity / limits.velocity)), math.sqrt(float(np.max(acceleration / limits.acceleration)))
    )
    if factor == 0.0:
        raise InputError("found joints that move and have no limit, expected a limit for each, or a duration alone")
    return curve.slowed(factor)


def _blends(points: Array, limits: MotionLimits, part: float) -> TimedCurve:
    """Straight pieces with parabolic blends about the points between, and at both ends; slowed to keep to the limits.

    A blend takes the same part of the time on both sides of its point, and passes by at an eighth of its duration times
    the change of velocity. Beside a short piece it is short, and turns hard: pieces are slowed one by one until blends
    keep to the limits, or all alike, whichever takes less time.
    """
    points, h = _chords(_apart(points), limits)
    if not len(h):
        return _curve([0.0], [], points)
    moves = np.diff(points, axis=0)
    ways = [_blended(points, h, part)]
    if np.isfinite(limits.acceleration).any():
        ways.append(_blended(points, _slowed_pieces(moves, h, limits, part), part))
    return min((_within(way, limits) for way in ways), key=lambda curve: curve.duration)


def _blend_times(h: Array, part: float) -> Array:
    """The durations (k + 1,) of the blends about pieces that take h (k,)."""
    padded = np.concatenate([[np.inf], h, [np.inf]])
    return np.asarray(part * np.minimum(padded[:-1], padded[1:]))


def _slowed_pieces(moves: Array, h: Array, limits: MotionLimits, part: float) -> Array:
    """The times (k,) of pieces with moves (k, n), h (k,) or more, with which blends nearly keep to the limits."""
    still = np.zeros((1, moves.shape[1]))

    def harder(h: Array) -> Array:
        """(k + 1,) by what blends are harder than the limits."""
        velocity = np.concatenate([still, moves / h[:, None], still])
        return np.asarray(
            np.max(np.abs(np.diff(velocity, axis=0)) / limits.acceleration, axis=1) / _blend_times(h, part)
        )

    # What no velocity limits begins so fast that each blend is too hard.
    bounded = np.max(np.abs(moves) / limits.velocity, axis=1) > 0.0
    hard = harder(h)
    h = np.where(bounded, h, h * math.sqrt(min(1.0, float(np.min(hard, where=hard > 0.0, initial=1.0)))))
    for _ in range(SLOWINGS):
        over = harder(h)
        if np.max(over) <= 1.0 + BLENDED:
            break
        padded = np.concatenate([[np.inf], h, [np.inf]])
        before, after = padded[:-1], padded[1:]
        # A blend's shorter piece takes longer until it is as long as the other, both as soon as they are alike.
        wanted = np.where(over > 1.0, np.minimum(before, after) * np.minimum(np.sqrt(over), FASTER), 0.0)
        h = np.maximum(h, np.maximum(wanted[:-1], wanted[1:]))
    return h


def _blended(points: Array, h: Array, part: float) -> TimedCurve:
    """The curve by points (k + 1, n) whose pieces take h (k,)."""
    blend = _blend_times(h, part)
    # The ends' blends lie within their segments: the straight piece is steeper so that it is in time.
    velocity = np.diff(points, axis=0) / h[:, None]
    h = h.copy()
    h[0] += 0.5 * blend[0]
    h[-1] += 0.5 * blend[-1]
    marks = np.concatenate([[0.0], np.cumsum(h)])
    times, pieces = [0.0], []
    q, v = points[0], np.zeros(points.shape[1])
    for k in range(len(marks)):
        after = velocity[k] if k < len(velocity) else np.zeros_like(v)
        start = 0.0 if k == 0 else marks[k] - (blend[k] if k == len(h) else 0.5 * blend[k])
        if k:  # the straight piece before
            pieces.append(_piece(q, v))
            q = q + v * (start - times[-1])
            times.append(start)
        pieces.append(_piece(q, v, (after - v) / blend[k]))
        q, v = q + 0.5 * (v + after) * blend[k], after
        times.append(start + blend[k])
    return _curve(times, pieces, points)


def _apart(points: Array) -> Array:
    """The points without those between that are a hair from the one before, or from the last."""
    kept = [points[0]]
    for point in points[1:-1]:
        if min(np.max(np.abs(point - kept[-1])), np.max(np.abs(point - points[-1]))) > HAIR:
            kept.append(point)
    return np.array([*kept, points[-1]])


def _piece(q: Array, velocity: Array, acceleration: Array | float = 0.0) -> Array:
    """The coefficients (6, n) of a piece of constant acceleration."""
    piece = np.zeros((DEGREE + 1, len(q)))
    piece[0], piece[1], piece[2] = q, velocity, np.asarray(acceleration) / 2.0
    return piece
