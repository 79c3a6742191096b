"""Paths in time: joints through points, and lines of the tool, within limits of velocity and acceleration.

Statement. Give a path's rows at even times, with the joints' velocities and accelerations there.
Derivation. Joints through points move as `time_profiles` has it, in closed form. On a line of the tool, at the part
σ(t/T) of the way, the joints' velocity is q' σ'/T and their acceleration (q'' σ'² + q' σ'')/T²; q' solves J q' = x',
the twist of the line, with the least motion, and q'' is its derivative along the line, by a difference between both
sides. What limits ask for is the least T that keeps to them at every row.
Where a joint is to spare its part of both is read off the rows, by differences.
Degenerate case. At a singular configuration of a line q' has no bound: with limits there is no duration then.
Source of the polynomials: B. Siciliano et al., Robotics: Modelling, Planning and Control, 2009, section 4.2.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import cast

import numpy as np
from numpy.typing import ArrayLike

from robokin.arrays import Array
from robokin.errors import InputError
from robokin.expected import expect_choice, expect_finite, expect_flag, expect_number, expect_numbers, expect_whole
from robokin.inverse.closer_looks import UnitRates, demand, looked_at_closely
from robokin.inverse.follow import MOST
from robokin.inverse.followed_curves import follow_curve, rows_from
from robokin.inverse.joint_paths import (
    NEARLY,
    Event,
    Path,
    PathTask,
    PathTurn,
    interpolate_joints,
    line_task,
    singularities,
)
from robokin.inverse.joint_rates import BESIDE, curve_rates, spare_part
from robokin.inverse.time_profiles import BLEND, MotionLimits, Passing, Profile, timed_move
from robokin.inverse.timed_curves import TimedCurve
from robokin.inverse.tool_curves import ToolCurve
from robokin.kinematics.forward import forward_kinematics
from robokin.kinematics.velocity import dexterity, nearly_singular
from robokin.model import CoupledRobot, Robot, expect_robot
from robokin.model.named_values import plain_joint_values

PROFILES = ("cubic", "quintic", "trapezoidal")
PASSINGS = ("stop", "spline", "blend")

LONGEST = 1e9
"""The longest duration [s]: thirty years."""

FASTEST = 1e12
"""The greatest limit of velocity and acceleration [rad/s | m/s, per s²], and its inverse the least."""

LONGER = 8
"""How often a path with rows of a rate is made longer at most: each time rows are at other places."""

EXACT, LITTLE = 1e-9, 1e-3
"""How far beyond limits is rounding, and how far rows of a rate may be in a duration that is asked for."""

LOOKED_AT = 100
"""Steps of a line at least at which limits of velocity and acceleration are held."""


TOGETHER = 1e-7
"""Places [1] of the time that are nearer together are one."""

HALVED = 50
"""Halvings by which the time of a part of a way is found."""


def trajectory(
    robot: Robot,
    points: ArrayLike,
    *,
    duration: float | None = None,
    profile: Profile = "quintic",
    max_velocity: ArrayLike | None = None,
    max_acceleration: ArrayLike | None = None,
    passing: Passing = "stop",
    blend: float = BLEND,
    steps: int = 100,
    rate: float | None = None,
    limits: bool = True,
) -> Path:
    """All joints together through points, in time.

    points: (k, n) [rad | m], k of 2 and more; duration [s]; max_velocity, max_acceleration: (n,) or one for all joints
    [rad | m] in a second and a second squared. Without a duration it is the least that they allow, and a second where
    there are none.
    profile: from point to point, with a stop at each; passing: "spline" goes through the points without a stop (a cubic
    spline, at rest at both ends), "blend" along straight pieces, past the points by parabolas that take the part
    `blend` (to 1) of the shorter piece's time. Rows: steps + 1 at even times, or `rate` [1/s] and the end.
    With `limits` the path ends before a joint leaves them. Raises InputError for other shapes and values, and for a
    duration that is too short for the limits.
    Sources: B. Siciliano et al., Robotics: Modelling, Planning and Control, 2009, section 4.2; J. J. Craig,
    Introduction to Robotics, 3rd edition, section 7.3.
    """
    robot = expect_robot(robot)
    what = f"two rows or more of {robot.n} finite joint values"
    way = expect_finite(plain_joint_values(robot, points, "points"), "points", what)
    if way.ndim != 2 or len(way) < 2 or way.shape[1] != robot.n:
        raise InputError(f"points: found an array of shape {way.shape}, expected {what}")
    if not robot.n:
        raise InputError(f"{robot.name} has no joints, expected a robot that can move")
    chosen = cast(Profile, expect_choice(profile, PROFILES, "profile"))
    past = cast(Passing, expect_choice(passing, PASSINGS, "passing"))
    part = expect_number(blend, "blend", "a part from 0 to 1")
    if not 0.0 < part <= 1.0:
        raise InputError(f"blend: found {part:g}, expected a part of the pieces above 0 and up to 1")
    bounds = motion_limits(robot, max_velocity, max_acceleration)
    curve = timed_move(way, chosen, bounds, _duration(duration), past, part)
    t = row_times(curve.duration, steps, rate)
    count = len(t) - 1
    fraction, event = 1.0, None
    if expect_flag(limits, "limits") and (left := _leaves(robot, curve)) is not None:
        at, joint, value, words = left
        fraction = at / curve.duration
        event = Event("limit", fraction, words, joint, value)
        t = t[t <= at]
        t = t if len(t) else np.zeros(1)
    q, velocity, acceleration = curve.at(t)
    if len(q) and fraction == 1.0:
        q[-1], velocity[-1] = way[-1], 0.0  # to the last digit
    return _with_rows(robot, t, curve.duration, (q, velocity, acceleration), fraction, event, count)


@dataclass(frozen=True, eq=False)
class Timing:
    """How a path takes its time: see `trajectory`. A rate's rows are counted from `since` [s] before its start."""

    limits: MotionLimits
    profile: Profile = "quintic"
    duration: float | None = None
    passing: Passing = "stop"
    blend: float = BLEND
    rate: float | None = None
    since: float = 0.0


def timed_curve(
    robot: Robot, first: Array, curve: ToolCurve, timing: Timing, steps: int, limits: bool, task: PathTask | None
) -> Path:
    """The tool along a curve from where it is at joint values first (n,), in time: see `follow_curve`."""
    chosen = line_task(robot) if task is None else task
    bounded = bool(np.isfinite([timing.limits.velocity, timing.limits.acceleration]).any())
    # Of few rows none may be where a joint is fastest; all of them are among those that are looked at.
    looked_at = steps * math.ceil(LOOKED_AT / steps) if bounded else steps
    tau = row_times(1.0, looked_at, None)
    if bounded and len(curve.places):
        tau = np.union1d(tau, time_of_parts(timing.profile, curve.places))
        tau = tau[np.diff(tau, prepend=-1.0) > TOGETHER]

    def followed(tau: Array) -> tuple[Path, UnitRates]:
        path = follow_curve(robot, first, curve, tau, unit_law(timing.profile, tau)[0], limits, chosen)
        return path, unit_rates(path, curve, timing.profile, chosen)

    def look(tau: Array, q: Array) -> UnitRates:
        s = unit_law(timing.profile, tau)[0]
        rows = rows_from(robot, q, curve, s, chosen)
        # Rates of singular rows are read off rows beside them, which a short look has not.
        told = np.flatnonzero(~nearly_singular(robot, rows, BESIDE, "position" if chosen == "position" else None))
        part = replace(path, t=tau[told], s=s[told], q=rows[told], fraction=1.0)
        return unit_rates(part, curve, timing.profile, chosen)

    path, rates = followed(tau)
    seen = looked_at_closely(rates, timing.limits, timing.profile, look) if bounded else rates
    if timing.rate is not None and timing.duration is not None and bounded:
        least = seen.demand(timing.limits)
        if timing.duration < least * (1.0 - LITTLE):
            raise too_short(timing.duration, least)
        whole = timing.duration
    else:
        whole = duration_within(seen, timing.limits, timing.duration)
    if timing.rate is None and len(tau) == steps + 1:
        return in_time(path, rates, whole)
    duration = timing.duration
    for _ in range(LONGER):
        tau = rows_since(timing, whole, steps) / whole
        tau[-1] = 1.0
        timed = in_time(*followed(tau), whole)
        assert timed.velocity is not None and timed.acceleration is not None
        over = demand(timed.velocity, timed.acceleration, timing.limits)
        if over <= 1.0 + (EXACT if duration is None else LITTLE):
            return timed
        # Rows of a rate are at none of the places that were looked at, and may be faster by a little.
        if duration is not None:
            raise too_short(duration, over * whole)
        whole *= over
    return timed


def too_short(duration: float, least: float) -> InputError:
    """What is said of a duration below the least within the limits [s]."""
    return InputError(f"found a duration of {duration:g} s, expected at least {least:.6g} s within the limits")


def reorientation(robot: Robot, first: Array, last: Array, timing: Timing | None, steps: int) -> Path:
    """Joints from first (n,) to last (n,) [rad | m] in proportion, as the first move of a line, in its timing."""
    if timing is None:
        path = interpolate_joints(robot, first, last, steps, False)
        return _as_turn(path, first, last)
    profile = timing.profile
    curve = timed_move(np.array([first, last]), profile, timing.limits, timing.duration)
    t = rows_since(timing, curve.duration, steps)
    path = _with_rows(robot, t, curve.duration, curve.at(t), 1.0, None, len(t) - 1)
    path.q[-1] = last
    return _as_turn(path, first, last)


def _as_turn(path: Path, first: Array, last: Array) -> Path:
    """A path by joints as a turn from first to last (n,) before a line."""
    steps = len(path) - 1
    return replace(path, reorientation=steps, turns=(PathTurn(0.0, 0, steps, first, last),))


def rows_since(timing: Timing, duration: float, steps: int) -> Array:
    """Times (m,) [s] of a piece's rows from its start to its end, those of a rate counted from the path's start."""
    if timing.rate is None or not timing.since:
        return row_times(duration, steps, timing.rate)
    whole = row_times(timing.since + duration, steps, timing.rate) - timing.since
    return np.append(0.0, whole[whole > duration * 1e-9])


def unit_rates(path: Path, curve: ToolCurve, profile: Profile, task: PathTask) -> UnitRates:
    """How fast joints are at the rows of a path of the tool. Raises InputError where a singular one has no bound."""
    tau = path.t
    q1, q2 = curve_rates(path, curve, task)
    _, s1, s2 = unit_law(profile, tau)
    with np.errstate(invalid="ignore", over="ignore"):
        speed = q1 * s1[:, None]
        push = q2 * s1[:, None] ** 2 + q1 * s2[:, None]
    if len(tau) == 1 and not path.complete:
        speed, push = np.zeros_like(path.q), np.zeros_like(path.q)  # it does not begin
    unbounded = ~np.all(np.isfinite(speed) & np.isfinite(push), axis=1)
    if unbounded.any():
        singular = f"where the path is singular, at {path.s[int(np.argmax(unbounded))]:.6g} of it"
        raise InputError(f"a joint's velocity has no bound {singular}, expected a path beside that")
    # A joint is to spare: what it does from row to row the line does not say, and is read off the rows.
    spare = spare_part(path, task, np.gradient(path.q, tau, axis=0, edge_order=2)) if len(tau) > 2 else None
    if spare is None:
        return UnitRates(tau, path.q, speed, push)
    speed = speed + spare
    return UnitRates(tau, path.q, speed, np.gradient(speed, tau, axis=0, edge_order=2), True)


def duration_within(rates: UnitRates, limits: MotionLimits, duration: float | None) -> float:
    """A duration [s], or the least that limits allow, a second without. Raises InputError for one that is too short."""
    least = rates.demand(limits)
    if duration is not None and duration < least * (1.0 - EXACT):
        raise too_short(duration, least)
    return duration if duration is not None else least if least > 0.0 else 1.0


def in_time(path: Path, rates: UnitRates, whole: float) -> Path:
    """A path whose rows are at parts of the time in a duration [s]."""
    velocity, acceleration = rates.speed / whole, rates.push / whole**2
    return replace(path, t=path.t * whole, duration=whole, velocity=velocity, acceleration=acceleration)


def unit_law(profile: Profile, tau: Array) -> tuple[Array, Array, Array]:
    """σ, σ' and σ'' (m,) at parts tau (m,) of the time."""
    free = MotionLimits(np.full(1, np.inf), np.full(1, np.inf))
    s, velocity, acceleration = timed_move(np.array([[0.0], [1.0]]), profile, free, 1.0).at(tau)
    return s[:, 0], velocity[:, 0], acceleration[:, 0]


def time_of_parts(profile: Profile, s: Array) -> Array:
    """The parts of the time (m,) at which a profile is at parts s (m,) of the way, to rounding."""
    low, high = np.zeros_like(s), np.ones_like(s)
    for _ in range(HALVED):
        middle = 0.5 * (low + high)
        before = unit_law(profile, middle)[0] < s
        low, high = np.where(before, middle, low), np.where(before, high, middle)
    return np.asarray(np.where(s <= 0.0, 0.0, np.where(s >= 1.0, 1.0, high)))


def motion_limits(robot: Robot, velocity: ArrayLike | None, acceleration: ArrayLike | None) -> MotionLimits:
    """Limits (n,), or one for all joints [rad/s | m/s, per s²]; None for none. Raises InputError for none above 0.

    A joint whose limit is infinite has none.
    """
    values = []
    for name, given in (("max_velocity", velocity), ("max_acceleration", acceleration)):
        what = f"a positive number, or {robot.n} of them"
        array = np.full(robot.n, np.inf) if given is None else expect_numbers(given, name, what)
        plain = (array >= 1.0 / FASTEST) & (array <= FASTEST) | np.isposinf(array)
        if array.shape not in ((), (robot.n,)) or not plain.all():
            what += f", from {1.0 / FASTEST:g} to {FASTEST:g} or infinite"
            raise InputError(f"{name}: found {np.array2string(array)}, expected {what}")
        values.append(np.broadcast_to(array, (robot.n,)).copy())
    return MotionLimits(*values)


def _duration(duration: float | None) -> float | None:
    if duration is None:
        return None
    value = expect_number(duration, "duration", "seconds")
    if not 1.0 / LONGEST <= value <= LONGEST:
        raise InputError(f"duration: found {value:g}, expected seconds above 0, from {1.0 / LONGEST:g} to {LONGEST:g}")
    return value


def row_times(duration: float, steps: int, rate: float | None) -> Array:
    """Times (m,) [s] of rows: in even steps, or at a rate [1/s] and at the end. Raises InputError for too many."""
    if rate is None:
        steps = expect_whole(steps, "steps", 1, MOST)
        return duration * (np.arange(steps + 1) / steps)
    frequency = expect_number(rate, "rate", "rows a second")
    if not frequency > 0.0 or duration * frequency > MOST:
        raise InputError(f"rate: found {frequency:g}, expected rows a second above 0, and at most {MOST} rows")
    count = math.floor(duration * frequency * (1.0 + 1e-12)) + 1
    t = np.arange(count) / frequency
    return t if t[-1] >= duration * (1.0 - 1e-9) else np.append(t, duration)


def _leaves(robot: Robot, curve: TimedCurve) -> tuple[float, int | None, float, str] | None:
    """When, by which joint (from 1), and at which value a curve first leaves the limits, and what leaves them."""
    limits = robot.limits
    names = [f"joint {k + 1}" for k in range(robot.n)]
    if isinstance(robot, CoupledRobot):
        offset = robot.drive.motions(np.zeros(robot.n))
        more = curve.coefficients @ robot.drive.S.T
        more[:, 0] += offset
        curve = TimedCurve(curve.times, np.concatenate([curve.coefficients, more], axis=2))
        limits = np.concatenate([limits, robot.drive.limits])
        names += [f"the motion of joint {row.name}" for row in robot.free_motion.joints]
    left = curve.leaves(limits)
    if left is None:
        return None
    at, joint, value = left
    if at == 0.0:
        value = float(curve.at(np.zeros(1))[0][0, joint])
    return at, joint + 1 if joint < robot.n else None, value, f"{names[joint]} leaves its limits"


def _with_rows(
    robot: Robot, t: Array, duration: float, rows: tuple[Array, Array, Array], fraction: float, event: Event | None,
    steps: int,
) -> Path:  # fmt: skip
    """The path of rows q, velocities and accelerations (m, n) at times t (m,)."""
    q, velocity, acceleration = rows
    least, manipulability = dexterity(robot, q, None, NEARLY)
    part = t / duration
    events = singularities(robot, part, q, least, None)
    events += [event] if event is not None else []
    T = forward_kinematics(robot, q)
    return Path(
        t, part, q, T, fraction, tuple(events), manipulability, steps, robot, "joint", duration, velocity,
        acceleration,
    )  # fmt: skip
