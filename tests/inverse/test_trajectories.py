"""Paths in time: known values, and the laws: velocities are derivatives, limits hold and one is met, points are
passed."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import robokin
from robokin.errors import InputError
from robokin.inverse.followed_curves import follow_curve
from robokin.inverse.joined_paths import joined
from robokin.inverse.path_goals import Goal, Manner
from robokin.inverse.paths_to_poses import path_through
from robokin.inverse.time_profiles import MotionLimits, timed_move
from robokin.inverse.timed_curves import TimedCurve
from robokin.inverse.tool_curves import CircularArc
from robokin.inverse.trajectories import Timing, motion_limits, row_times, trajectory, unit_law
from robokin.kinematics.velocity import dexterity, nearly_singular

FREE = MotionLimits(np.full(3, np.inf), np.full(3, np.inf))
PROFILES = ("cubic", "quintic", "trapezoidal")
PASSINGS = ("stop", "spline", "blend")
PUMA = robokin.load("puma560")
UR = robokin.load("ur5e")
PLANAR = robokin.load("planar2r")


def one(profile, duration, first, last, t):
    free = MotionLimits(np.full(1, np.inf), np.full(1, np.inf))
    curve = timed_move(np.array([[first], [last]]), profile, free, duration)
    return [part[:, 0] for part in curve.at(np.asarray(t, dtype=float))]


def test_craigs_cubic():
    """J. J. Craig, Introduction to Robotics, 3rd ed., example 7.1: 15° to 75° in 3 s, θ = 15 + 20 t² - 4.44 t³."""
    t = np.linspace(0.0, 3.0, 7)
    q, velocity, acceleration = one("cubic", 3.0, 15.0, 75.0, t)
    np.testing.assert_allclose(q, 15.0 + 20.0 * t**2 - 40.0 / 9.0 * t**3, atol=1e-12)
    np.testing.assert_allclose(velocity, 40.0 * t - 40.0 / 3.0 * t**2, atol=1e-12)
    np.testing.assert_allclose(acceleration, 40.0 - 80.0 / 3.0 * t, atol=1e-12)


def test_the_quintic_of_jtraj():
    """P. Corke, Robotics Toolbox, jtraj: q = A t⁵ + B t⁴ + C t³ + F with A = 6 Δ, B = -15 Δ, C = 10 Δ."""
    t = np.linspace(0.0, 1.0, 11)
    q, velocity, acceleration = one("quintic", 1.0, 1.0, 2.0, t)
    np.testing.assert_allclose(q, 1.0 + 6 * t**5 - 15 * t**4 + 10 * t**3, atol=1e-14)
    np.testing.assert_allclose(velocity, 30 * t**4 - 60 * t**3 + 30 * t**2, atol=1e-13)
    np.testing.assert_allclose(acceleration, 120 * t**3 - 180 * t**2 + 60 * t, atol=1e-12)
    # Its tests say: halfway at half the time with 1.875 times the mean velocity, and no acceleration there.
    assert (q[5], velocity[5], abs(acceleration[5]) < 1e-12) == (1.5, 1.875, True)


def test_the_trapezoid_of_the_toolbox():
    """P. Corke, Robotics Toolbox, trapezoidal(0, 1, t): without a velocity it cruises at 1.5 times the mean one."""
    t = np.linspace(0.0, 1.0, 13)
    q, velocity, acceleration = one("trapezoidal", 1.0, 0.0, 1.0, t)
    V, blend = 1.5, 1.0 / 3.0
    a = V / blend
    expected = np.where(
        t <= blend, a / 2 * t**2, np.where(t <= 1 - blend, (1 - V) / 2 + V * t, 1 - a / 2 * (1 - t) ** 2)
    )
    np.testing.assert_allclose(q, expected, atol=1e-14)
    assert velocity[6] == pytest.approx(1.5) and acceleration[0] == pytest.approx(4.5)


def test_a_trapezoid_at_its_limits():
    """B. Siciliano et al., 2009, section 4.2.1: with velocity v and acceleration a it takes Δ/v + v/a, or 2 √(Δ/a)."""
    limits = MotionLimits(np.array([2.0]), np.array([4.0]))
    assert timed_move(np.array([[0.0], [5.0]]), "trapezoidal", limits, None).duration == pytest.approx(5 / 2 + 2 / 4)
    assert timed_move(np.array([[0.0], [0.25]]), "trapezoidal", limits, None).duration == pytest.approx(
        2 * math.sqrt(0.25 / 4)
    )
    assert timed_move(np.array([[0.0], [1.0]]), "trapezoidal", limits, None).duration == pytest.approx(1.0)


def test_a_spline_is_the_one_of_three_points():
    """At rest at both ends, two pieces of one second: the velocity between is 3 (q2 - q0) / 4."""
    curve = timed_move(
        np.array([[0.0], [1.0], [2.0]]), "quintic", MotionLimits(*np.full((2, 1), np.inf)), 2.0, "spline"
    )
    q, velocity, acceleration = curve.at(np.array([0.0, 1.0, 2.0]))
    assert q[:, 0] == pytest.approx([0, 1, 2]) and velocity[:, 0] == pytest.approx([0, 1.5, 0])
    before, after = curve.at(np.array([1.0 - 1e-9]))[2], acceleration[1]
    assert before[0] == pytest.approx(after, abs=1e-7)


@pytest.mark.parametrize("passing", PASSINGS)
@pytest.mark.parametrize("profile", PROFILES)
@pytest.mark.parametrize("seed", range(12))
def test_the_laws_of_a_move(profile, passing, seed):
    rng = np.random.default_rng(seed)
    points = rng.uniform(-2, 2, (rng.integers(2, 7), 3))
    if seed % 3 == 0:
        points = np.round(points)  # joints that stand still, points that repeat
    limits = MotionLimits(rng.uniform(0.5, 3, 3), rng.uniform(0.5, 9, 3))
    if np.array_equal(points.min(axis=0), points.max(axis=0)):
        points[-1] += 1.0
    curve = timed_move(points, profile, limits, None, passing)
    t = np.linspace(0.0, curve.duration, 20_001)
    q, velocity, acceleration = curve.at(t)
    np.testing.assert_allclose(q[[0, -1]], points[[0, -1]], atol=1e-9)
    assert np.abs(velocity[[0, -1]]).max() < 1e-9
    # Limits hold, and one is met: it is the least duration.
    fastest, hardest = curve.greatest()
    assert (np.abs(velocity) <= limits.velocity * (1 + 1e-9)).all() and (np.abs(velocity) <= fastest * (1 + 1e-9)).all()
    assert (np.abs(acceleration) <= limits.acceleration * (1 + 1e-9)).all()
    assert max((fastest / limits.velocity).max(), (hardest / limits.acceleration).max()) == pytest.approx(1.0)
    # Velocities are the derivatives of values.
    step = t[1]
    np.testing.assert_allclose((q[2:] - q[:-2]) / (2 * step), velocity[1:-1], atol=3 * step * limits.acceleration.max())
    if passing != "blend":
        for point in points:
            assert np.abs(q - point).max(axis=1).min() < 2 * step * limits.velocity.max()
    # Twice the time: half the velocity, a quarter of the acceleration.
    slow = timed_move(points, profile, limits, 2 * curve.duration, passing)
    np.testing.assert_allclose(slow.greatest()[0] * 2, fastest, rtol=1e-9)
    np.testing.assert_allclose(slow.greatest()[1] * 4, hardest, rtol=1e-9)
    with pytest.raises(InputError, match="expected at least"):
        timed_move(points, profile, limits, curve.duration * 0.99, passing)


@pytest.mark.parametrize("seed", range(60))
def test_where_limits_are_left(seed):
    rng = np.random.default_rng(seed)
    points = rng.uniform(-1, 1, (rng.integers(2, 6), 3))
    limits = np.stack([rng.uniform(-1.2, -0.8, 3), rng.uniform(0.8, 1.2, 3)], axis=1)
    if seed % 5 == 0:
        limits[0] = points[:, 0].min(), points[:, 0].max()
    curve = timed_move(points, PROFILES[seed % 3], FREE, 3.0, PASSINGS[seed // 3 % 3])
    t = np.linspace(0.0, 3.0, 30_001)
    q = curve.at(t)[0]
    outside = ((q < limits[:, 0] - 1e-9) | (q > limits[:, 1] + 1e-9)).any(axis=1)
    left = curve.leaves(limits)
    assert outside.any() == (left is not None)
    if left is not None:
        assert abs(t[outside.argmax()] - left[0]) < 2e-4
        if left[0] > 0.0:
            assert curve.at(np.array([left[0]]))[0][0, left[1]] == pytest.approx(left[2], abs=1e-3)


def test_a_curve_evaluates_its_own_pieces():
    c = np.zeros((2, 6, 1))
    c[0, :, 0], c[1, :, 0] = (1, 2, 3, 4, 5, 6), (7, 0, 0, 0, 0, 1)
    q, velocity, acceleration = TimedCurve(np.array([0.0, 1.0, 3.0]), c).at(np.array([0.5, 1.0, 3.0]))
    powers = 0.5 ** np.arange(6)
    assert q[:, 0] == pytest.approx([powers @ c[0, :, 0], 7.0, 7.0 + 32.0])
    assert velocity[:, 0] == pytest.approx([(powers[:5] * np.arange(1, 6)) @ c[0, 1:, 0], 0.0, 80.0])
    assert acceleration[2, 0] == pytest.approx(20 * 8.0)


# Paths of robots.


def test_a_trajectory_has_rows_in_seconds():
    path = trajectory(PUMA, [np.zeros(6), np.full(6, 0.3), np.full(6, -0.2)], max_velocity=0.5, steps=50)
    assert path.complete and len(path) == 51 and path.t[-1] == pytest.approx(path.duration)
    assert np.abs(path.velocity).max() <= 0.5 + 1e-12
    np.testing.assert_array_equal(path.q[-1], np.full(6, -0.2))
    np.testing.assert_allclose(path.T, robokin.forward_kinematics(PUMA, path.q))


def test_a_rate_gives_even_rows_and_the_end():
    path = trajectory(PLANAR, [[0, 0], [1, 1]], duration=1.0, rate=8.0)
    np.testing.assert_allclose(path.t, np.arange(9) / 8)
    path = trajectory(PLANAR, [[0, 0], [1, 1]], duration=1.05, rate=10.0)
    np.testing.assert_allclose(path.t, [*np.arange(11) / 10, 1.05])


def test_a_path_in_time_is_the_old_path_at_its_times():
    plain = robokin.interpolate_joints(PUMA, np.zeros(6), np.full(6, 0.4), 20)
    timed = trajectory(PUMA, [np.zeros(6), np.full(6, 0.4)], duration=3.0, steps=20)
    np.testing.assert_allclose(timed.q, plain.q, atol=1e-14)
    np.testing.assert_allclose(timed.t, 3.0 * plain.t)


def test_limits_end_a_trajectory():
    far = np.zeros(6)
    far[1] = 3.0  # the shoulder's limit is 45°
    path = trajectory(PUMA, [np.zeros(6), far], duration=2.0)
    assert not path.complete and path.events[-1].kind == "limit" and path.events[-1].joint == 2
    assert path.events[-1].value == pytest.approx(math.radians(45)) and PUMA.within_limits(path.q).all()
    assert trajectory(PUMA, [np.zeros(6), far], duration=2.0, limits=False).complete


@pytest.mark.parametrize(
    ("robot", "start", "end"),
    [("ur5e", [0.3, -1.2, 1.4, -0.5, 1.2, 0.1], [0.6, -1.0, 1.1, -0.2, 1.0, 0.4]),
     ("planar2r", [0.5, 0.9], [1.3, 0.4]), ("scara", [0.1, 0.8, 0.05, 0.2], [0.5, 0.6, 0.1, -0.3]),
     ("iiwa14", [0.2, 0.6, 0.1, -1.2, 0.3, 0.7, 0.2], [0.4, 0.7, 0.0, -1.0, 0.2, 0.8, 0.1])],
)  # fmt: skip
@pytest.mark.parametrize("profile", PROFILES)
def test_velocities_of_a_line_are_derivatives_and_its_twist_is_straight(robot, start, end, profile):
    robot = robokin.load(robot)
    T = robokin.forward_kinematics(robot, end)
    timing = Timing(motion_limits(robot, 0.4, None), profile)
    path = path_through(robot, np.array(start), [Goal(T=T)], 400, Manner("line", timing=timing))
    assert path.complete and path.kind == "line"
    # It is met where a joint is fastest, which may lie between two rows.
    assert 0.4 * (1 - 2e-3) < np.abs(path.velocity).max() <= 0.4 * (1 + 1e-9)
    step = path.t[1] - path.t[0]
    middle = (path.q[2:] - path.q[:-2]) / (2 * step)
    loose = 0.02 if robot.n == 7 else 2e-4  # a redundant arm moves by least motion from row to row
    smooth = slice(None) if profile != "trapezoidal" else slice(2, 100)
    np.testing.assert_allclose(middle[smooth], path.velocity[1:-1][smooth], atol=loose * np.abs(path.velocity).max())
    if robot.n < 7:
        bends = (path.velocity[2:] - path.velocity[:-2]) / (2 * step)
        atol = 2e-3 * np.abs(path.acceleration).max()
        np.testing.assert_allclose(bends[smooth], path.acceleration[1:-1][smooth], atol=atol)
    J = robokin.jacobian(robot, path.q)
    twist = np.einsum("mij,mj->mi", J, path.velocity)[:, :3]
    way = T[:3, 3] - path.T[0, :3, 3]
    along = unit_law(profile, path.t / path.duration)[1] / path.duration
    np.testing.assert_allclose(twist, along[:, None] * way, atol=1e-6 * np.abs(way).max() / path.duration)


def test_a_line_passes_its_points_with_a_stop_at_each():
    start, mid, end = [0.5, 0.9], [0.8, 0.7], [1.3, 0.4]
    timing = Timing(motion_limits(PLANAR, None, None), "cubic", 4.0)
    path = path_through(
        PLANAR, np.array(start), [Goal(np.array(mid)), Goal(np.array(end))], 50, Manner("line", timing=timing)
    )
    assert path.complete and len(path) == 101 and path.duration == 4.0
    np.testing.assert_allclose(path.q[[0, 50, 100]], [start, mid, end], atol=1e-9)
    assert np.abs(path.velocity[[0, 50, 100]]).max() < 1e-9 and (np.diff(path.t) > 0).all()
    assert path.s[[0, 50, 100]] == pytest.approx([0, 0.5, 1])


@pytest.mark.parametrize("rate", [None, 40.0])
def test_a_duration_is_of_the_whole_line(rate):
    goals = [Goal(np.array([0.8, 0.7])), Goal(np.array([1.3, 0.4]))]
    start, bounds = np.array([0.5, 0.9]), motion_limits(PLANAR, 0.5, None)
    least = path_through(PLANAR, start, goals, 50, Manner("line", timing=Timing(bounds, rate=rate)))
    slow = path_through(PLANAR, start, goals, 50, Manner("line", timing=Timing(bounds, duration=4.0, rate=rate)))
    assert slow.complete and slow.t[-1] == pytest.approx(4.0) and slow.duration == pytest.approx(4.0)
    assert np.abs(slow.velocity).max() <= 0.5 * least.duration / 4.0 * 1.001  # all pieces are slower by the same factor
    with pytest.raises(InputError, match=f"expected at least {least.duration:.6g} s within the limits"):
        path_through(
            PLANAR, start, goals, 50, Manner("line", timing=Timing(bounds, duration=0.99 * least.duration, rate=rate))
        )


@pytest.mark.parametrize(("duration", "rate"), [(4.0, 10.0), (4.0, 7.3), (None, 31.0), (2.0, 0.1), (2.0, 100.0)])
def test_rows_of_a_rate_are_even_past_the_points_between(duration, rate):
    goals = [Goal(np.array(q)) for q in ([0.8, 0.7], [1.3, 0.4], [1.2, 0.9])]
    timing = Timing(motion_limits(PLANAR, 0.5 if duration is None else None, None), duration=duration, rate=rate)
    path = path_through(PLANAR, np.array([0.5, 0.9]), goals, 50, Manner("line", timing=timing))
    np.testing.assert_allclose(path.t, row_times(path.duration, 1, rate), atol=1e-9)
    assert path.complete and path.steps == len(path) - 1
    fine = replace(timing, rate=None)
    whole = path_through(PLANAR, np.array([0.5, 0.9]), goals, 2000, Manner("line", timing=fine))
    for k in range(2):
        between = np.interp(path.t, whole.t, whole.q[:, k])
        np.testing.assert_allclose(path.q[:, k], between, atol=1e-5 if duration is not None else 1e-3)


@pytest.mark.parametrize("end", [None, [0.35, 0.7, 0.17, -1.22, 0.35, 0.87, 0.52]])
def test_joints_to_spare_come_to_rest_with_the_tool(end):
    arm = robokin.load("iiwa14")
    start = np.radians([0, 30, 0, -60, 0, 60, 0])
    goal = Goal(T=robokin.transform("Trans(0.5, 0.3, 0.5) RPY(0, 3, 0)")) if end is None else Goal(np.array(end))
    path = path_through(arm, start, [goal], 200, Manner("line", timing=Timing(motion_limits(arm, 1.0, None))))
    assert path.complete and np.abs(path.velocity[[0, -1]]).max() < 1e-4
    # What leaves the tool where it is is no part of the motion, but for what steps of a finite length make.
    J = robokin.jacobian(arm, path.q)
    spare = path.velocity - np.einsum("mij,mjk,mk->mi", np.linalg.pinv(J), J, path.velocity)
    assert np.abs(spare).max() < 1e-3


def test_a_line_that_ends_before_its_points():
    timing = Timing(motion_limits(PLANAR, None, None))
    goals = [Goal(np.array([0.8, 0.7])), Goal(T=robokin.transform("Trans(9, 0, 0)")), Goal(np.array([0.1, 0.7]))]
    path = path_through(PLANAR, np.array([0.5, 0.9]), goals, 40, Manner("line", timing=timing))
    assert not path.complete and 1 / 3 < path.fraction < 2 / 3
    assert path.events[-1].fraction == pytest.approx(path.fraction)
    timed = path_through(PLANAR, np.array([0.5, 0.9]), goals, 40, Manner("line", timing=replace(timing, duration=6.0)))
    assert timed.duration == 6.0 and 2.0 < timed.t[-1] < 4.0 and timed.fraction == pytest.approx(path.fraction)


def test_an_arc_is_on_its_circle():
    first, last = (
        robokin.forward_kinematics(UR, q) for q in ([0.3, -1.2, 1.4, -0.5, 1.2, 0.1], [0.6, -1.0, 1.1, -0.2, 1.0, 0.4])
    )
    via = 0.5 * (first + last)[:3, 3] + [0, 0, 0.08]
    arc = CircularArc(first, via, last)
    s = np.linspace(0, 1, 201)
    p = arc.at(s)[:, :3, 3]
    np.testing.assert_allclose(p[[0, -1]], [first[:3, 3], last[:3, 3]], atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(p - arc.centre, axis=1), np.linalg.norm(via - arc.centre), atol=1e-12)
    assert np.linalg.norm(p - via, axis=1).min() < 1e-3
    np.testing.assert_allclose(arc.at(s)[-1, :3, :3], last[:3, :3], atol=1e-12)
    h = 1e-6
    difference = (arc.at(s + h)[:, :3, 3] - arc.at(s - h)[:, :3, 3]) / (2 * h)
    np.testing.assert_allclose(difference, arc.twist(s)[:, :3], atol=1e-8)
    path = follow_curve(UR, np.array([0.3, -1.2, 1.4, -0.5, 1.2, 0.1]), arc, s, s, True, "pose")
    assert path.complete
    np.testing.assert_allclose(path.T, arc.at(s), atol=1e-8)


@pytest.mark.parametrize("via", [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.5, 0.5, 0.0]])
def test_three_places_on_a_line_are_no_arc(via):
    with pytest.raises(InputError, match="on a line"):
        CircularArc(np.eye(4), np.array(via), robokin.transform("Trans(1, 1, 0)"))


def test_a_whole_circle_is_two_arcs():
    with pytest.raises(InputError, match="ends where it begins, expected another end: a whole circle is two arcs"):
        CircularArc(np.eye(4), np.array([1.0, 0.0, 0.0]), np.eye(4))


@pytest.mark.parametrize("steps", [1, 2, 7])
def test_limits_of_a_line_hardly_depend_on_how_few_rows_are_asked_for(steps):
    """Limits hold at a hundred places and at every row, which may be one where a joint is a little faster still."""
    goals = [Goal(T=robokin.transform("Trans(-0.9, 0.1, 0)"))]
    timing = Timing(motion_limits(PLANAR, 1.0, None))
    start, manner = np.array([0.5, 0.7]), Manner("line", timing=timing)
    few, many = (path_through(PLANAR, start, goals, k, manner) for k in (steps, 100))
    assert few.complete and len(few) == steps + 1 and few.duration == pytest.approx(many.duration, rel=5e-3)
    assert few.duration >= many.duration * (1 - 1e-9) and np.abs(few.velocity).max() <= 1.0 + 1e-9


def test_a_line_that_does_not_begin_stands_still():
    finger = robokin.load("allegro-index")
    goals = [Goal(T=robokin.transform("Trans(0.02, 0.03, 0.12)"))]
    timing = Timing(motion_limits(finger, None, None), duration=1.0)
    path = path_through(finger, np.radians([0, 10, 20, 30]), goals, 20, Manner("line", timing=timing))
    assert not path.complete and len(path) == 1 and not path.velocity.any()


def test_a_singular_line_has_no_duration_within_limits():
    """A stretched arm cannot begin to move inwards at a finite velocity of its elbow."""
    timing = Timing(motion_limits(PLANAR, 1.0, 1.0), "cubic")
    with pytest.raises(InputError, match="no bound where the path is singular"):
        path_through(PLANAR, np.zeros(2), [Goal(T=robokin.transform("Trans(0.5, 0, 0)"))], 50,
                     Manner("line", timing=timing))  # fmt: skip


def test_joined_paths_of_one():
    path = robokin.interpolate_joints(PLANAR, [0, 0], [1, 1], 4)
    assert joined([path]) is path
    both = joined([path, robokin.interpolate_joints(PLANAR, [1, 1], [2, 0], 4)])
    assert len(both) == 9 and both.t[-1] == 1.0 and both.duration is None and both.velocity is None


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"points": [[0, 0]]}, "expected two rows or more"),
        ({"points": [[0, 0, 0], [1, 1, 1]]}, "expected two rows or more of 2"),
        ({"points": [[0, 0], [1, math.nan]]}, "finite"),
        ({"profile": "septic"}, "profile"),
        ({"passing": "jump"}, "passing"),
        ({"duration": 0.0}, "duration: found 0, expected seconds above 0"),
        ({"duration": -1.0}, "duration"),
        ({"max_velocity": 0.0}, "max_velocity"),
        ({"max_velocity": [1.0, 2.0, 3.0]}, "max_velocity"),
        ({"max_velocity": math.nan}, "max_velocity"),
        ({"max_velocity": [math.inf, 1.0], "points": [[0, 0], [1, 0]]}, "joint 1 moves and has no limit"),
        ({"blend": 0.0, "passing": "blend"}, "blend"),
        ({"blend": 1.5}, "blend"),
        ({"rate": 0.0}, "rate"),
        ({"rate": 1e12}, "rate"),
        ({"steps": 0}, "steps"),
    ],
)
def test_wrong_arguments_are_told(options, said):
    points = options.pop("points", [[0, 0], [1, 1]])
    with pytest.raises(InputError, match=said):
        trajectory(PLANAR, points, **options)


@pytest.mark.parametrize("passing", PASSINGS)
def test_points_that_do_not_move(passing):
    path = trajectory(PLANAR, [[0.3, 0.4]] * 3, passing=passing, max_velocity=1.0, steps=4)
    assert path.duration == 1.0 and np.array_equal(path.q, [[0.3, 0.4]] * 5) and not path.velocity.any()


@pytest.mark.parametrize("rate", [None, 37.0])
@pytest.mark.parametrize("steps", [7, 60])
def test_limits_hold_at_every_row_of_a_line(steps, rate):
    start = np.radians([40, 60, 0])
    robot = robokin.load("planar3r")
    T = robokin.forward_kinematics(robot, np.radians([120, 100, -60]))
    bounds = motion_limits(robot, 1.0, 2.0)
    path = path_through(robot, start, [Goal(T=T)], steps, Manner("line", timing=Timing(bounds, rate=rate)))
    assert path.complete
    assert np.abs(path.velocity).max() <= 1.0 + 1e-8 and np.abs(path.acceleration).max() <= 2.0 + 1e-8


@pytest.mark.parametrize(
    ("name", "start", "end"),
    [
        ("puma560", [0.3, -0.5, 0.9, 0.4, 0.004, 0.2], [0.1, -0.2, 0.6, 0.5, -0.12, 0.4]),
        ("ur5e", [0.3, -1.2, 1.4, -0.5, 0.01, 0.1], [0.6, -0.9, 1.1, -0.4, -0.35, 0.3]),
        ("planar2r", [0.2, 0.05], [1.4, 0.3]),
        ("scara", [0.2, 0.04, 0.1, 0.0], [1.4, 0.9, 0.05, 1.0]),
    ],
)
@pytest.mark.parametrize("profile", ["quintic", "trapezoidal"])
def test_limits_of_a_line_hold_between_its_rows_beside_singularities(name, start, end, profile):
    """Looked at by rows at fifteen times as many places, of the same path with the duration that was found."""
    robot = robokin.load(name)
    goals, start = [Goal(T=robokin.forward_kinematics(robot, np.array(end)))], np.array(start)
    bounds, free = motion_limits(robot, 1.0, 4.0), motion_limits(robot, None, None)
    path = path_through(robot, start, goals, 100, Manner("line", False, timing=Timing(bounds, profile)))
    fine = Timing(free, profile, duration=path.duration)
    path = path_through(robot, start, goals, 1501, Manner("line", False, timing=fine))
    assert path.complete
    greatest = max(np.abs(path.velocity).max(), np.sqrt(np.abs(path.acceleration).max() / 4.0))
    assert 0.99 < greatest < 1.001


def test_points_a_hair_apart_are_passed_by_one_blend():
    """The ends are kept to the last digit, whichever of two points a blend passes."""
    way = np.array([[0.0, 0.0], [0.7, 0.3], [0.2, 0.9]])
    hair = np.array([[0.0, 0.0], [1e-9, 0.0], [0.7, 0.3], [0.7, 0.3 + 1e-9], [0.2, 0.9 - 1e-9], [0.2, 0.9]])
    plain, twice = (trajectory(PLANAR, q, passing="blend", max_velocity=1.0, max_acceleration=4.0) for q in (way, hair))
    assert twice.duration == pytest.approx(plain.duration, rel=1e-6)
    np.testing.assert_allclose(twice.q, plain.q, atol=1e-6)
    np.testing.assert_array_equal(twice.q[[0, -1]], way[[0, -1]])


def test_pieces_between_points_that_are_close_are_slowed_alone():
    """Two points 1e-4 rad apart need a slow piece, and no slow path: a stop at both would take 1.4 s."""
    way = np.radians([[0.0, 10.0], [30.0, 20.0], [30.006, 20.0], [60.0, 50.0]])
    bounds = {"max_velocity": np.radians(90.0), "max_acceleration": np.radians(300.0)}
    path = trajectory(PLANAR, way, passing="blend", blend=0.3, steps=2000, **bounds)
    assert path.duration < 2.0
    assert np.min(np.max(np.abs(path.q - way[1]), axis=1)) < np.radians(0.01)


@pytest.mark.parametrize("limited", ["both", "acceleration", "some"])
def test_blends_keep_to_limits_however_far_points_are_apart(limited, rng):
    for _ in range(10):
        k, n = rng.integers(2, 9), rng.integers(1, 6)
        way = np.cumsum(rng.normal(size=(k, n)) * 10.0 ** rng.uniform(-5, 0, (k, 1)), axis=0)
        velocity, acceleration = rng.uniform(0.5, 3.0, n), rng.uniform(1.0, 10.0, n)
        if limited != "both":
            velocity[: n if limited == "acceleration" else n // 2] = np.inf
        limits = MotionLimits(velocity, acceleration)
        curve = timed_move(way, "trapezoidal", limits, None, "blend", rng.uniform(0.05, 1.0))
        fast, hard = curve.greatest()
        assert np.all(fast <= velocity * (1.0 + 1e-9)) and np.all(hard <= acceleration * (1.0 + 1e-9))
        assert max(np.max(fast / velocity), np.max(hard / acceleration)) == pytest.approx(1.0)
        np.testing.assert_allclose(curve.at(np.array([0.0, curve.duration]))[0], way[[0, -1]], atol=1e-12)


@pytest.mark.parametrize("name", ["ur5e", "puma560", "scara", "planar2r", "planar3r", "panda"])
@pytest.mark.parametrize("task", [None, "position"])
def test_nearly_singular_is_what_dexterity_says(name, task):
    robot = robokin.load(name)
    rng = np.random.default_rng(1)
    quarters = rng.integers(-2, 3, (150, robot.n)) * np.pi / 2
    q = quarters + rng.normal(size=quarters.shape) * 10.0 ** rng.uniform(-8, 0, (150, 1))
    for below in (1e-5, 1e-2):
        expected = dexterity(robot, q, task)[0] < below
        np.testing.assert_array_equal(nearly_singular(robot, q, below, task), expected)
