"""Corners between lines and arcs that the tool rounds."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

import robokin
from robokin.errors import InputError
from robokin.inverse.path_goals import Goal, Manner
from robokin.inverse.paths_to_poses import path_through
from robokin.inverse.rounded_curves import CornerRounding, RoundedCurve, rounded
from robokin.inverse.tool_curves import CircularArc, Line, SlerpedTurn
from robokin.inverse.trajectories import Timing, motion_limits, time_of_parts, unit_law
from robokin.spatial.rotations import axis_angle_from_rotation, rotation_from_axis_angle

UR = robokin.load("ur5e")
PLANAR = robokin.load("planar2r")

# P. Corke, Robotics Toolbox for Python, tests/test_trajectory.py, test_mstraj: mstraj(via, dt=1, tacc=1,
# tsegment=[2, 1, 3, 4], q0=[4, 1]); its rows by the time from (4, 1), which it leaves after the first segment.
VIA = np.array([[4.0, 1.0], [4.0, 4.0], [5.0, 2.0], [2.0, 5.0]])
SEGMENTS = np.array([1.0, 3.0, 4.0])
OF_ITS_TESTS = {2.0: (4.3333, 3.3333), 3.0: (4.6667, 2.6667), 5.0: (4.25, 2.75), 6.0: (3.5, 3.5), 7.0: (2.75, 4.25)}

# The same with dt=0.1, run with roboticstoolbox-python 1.5.0: q, qd and qdd on the blend about (5, 2), which is at 4 s.
OF_MSTRAJ = {
    3.6: ((4.8656375, 2.2680125), (0.303, -0.627), (-0.585, 0.765)),
    3.8: ((4.908470833333334, 2.165845833333333), (0.09933333333333247, -0.36066666666666614), (-1.365, 1.785)),
    4.0: ((4.8984375, 2.1328125), (-0.20833333333333454, 0.041666666666667296), (-1.625, 2.125)),
    4.3: ((4.7672, 2.2352), (-0.6373333333333342, 0.6026666666666675), (-1.04, 1.36)),
    4.5: ((4.625, 2.375), (-0.75, 0.75), (0.0, 0.0)),
}


def places(points):
    """Poses at places in a plane, none turned."""
    poses = np.tile(np.eye(4), (len(points), 1, 1))
    poses[:, :2, 3] = points
    return poses


def lines(poses):
    return [Line(a, b) for a, b in pairwise(poses)]


def random_curves(rng, count):
    """Lines and arcs from pose to pose, one after the other."""
    angles, axes = rng.uniform(0.0, 2.5, count + 1), rng.normal(size=(count + 1, 3))
    poses = np.tile(np.eye(4), (count + 1, 1, 1))
    poses[:, :3, :3] = rotation_from_axis_angle(axes / np.linalg.norm(axes, axis=1, keepdims=True), angles)
    poses[:, :3, 3] = rng.uniform(-1.0, 1.0, (count + 1, 3))
    return [
        CircularArc(a, rng.uniform(-1.0, 1.0, 3), b) if rng.random() < 0.4 else Line(a, b) for a, b in pairwise(poses)
    ]


def test_a_right_angle_is_passed_at_three_sixteenths_of_the_diagonal():
    """From the statement: at the middle 3/16 τ |v₂ - v₁|, here τ = 0.2 and |v₂ - v₁| = √2."""
    curve = rounded(lines(places([[0, 0], [1, 0], [1, 1]])), CornerRounding(1.0, 0.2), 1.0)
    (blend,) = curve.blends()
    assert blend.distance == pytest.approx(3 / 16 * 0.2 * np.sqrt(2), abs=1e-12)
    assert (blend.point, blend.angle) == (1, 0.0) and blend.fraction == pytest.approx(0.5, abs=1e-9)
    assert (blend.begins, blend.ends) == pytest.approx((0.4, 0.6))
    np.testing.assert_allclose(curve.at(np.array([0.4, 0.6]))[:, :2, 3], [[0.8, 0], [1, 0.2]], atol=1e-12)


def test_blends_of_mstraj():
    halves = np.array([0.5, 0.5])
    curve = RoundedCurve(lines(places(VIA)), SEGMENTS, halves, [1, 2, 3])
    t = np.array([*OF_ITS_TESTS])
    np.testing.assert_allclose(curve.at(t / 8.0)[:, :2, 3], [*OF_ITS_TESTS.values()], atol=5e-5)
    s = np.array([*OF_MSTRAJ]) / 8.0
    q, velocity, acceleration = np.array([*OF_MSTRAJ.values()]).swapaxes(0, 1)
    np.testing.assert_allclose(curve.at(s)[:, :2, 3], q, atol=1e-12)
    np.testing.assert_allclose(curve.twist(s)[:, :2] / 8.0, velocity, atol=1e-12)
    h = 1e-6
    bends = (curve.twist(s + h) - curve.twist(s - h))[:, :2] / (2 * h) / 64.0
    np.testing.assert_allclose(bends, acceleration, atol=2e-5)
    assert curve.blends()[1].distance <= np.linalg.norm([0.1015625, 0.1328125])


@pytest.mark.parametrize("seed", range(6))
def test_a_rounded_curve_is_smooth_and_on_its_pieces_elsewhere(seed):
    rng = np.random.default_rng(seed)
    curves = random_curves(rng, 4)
    curve = rounded(curves, CornerRounding(float(rng.uniform(0.1, 1.0))), 0.7)
    h, s = 1e-6, np.linspace(0.002, 0.998, 2001)
    ahead, behind = curve.at(s + h), curve.at(s - h)
    twist = curve.twist(s)
    np.testing.assert_allclose((ahead - behind)[:, :3, 3] / (2 * h), twist[:, :3], atol=2e-5)
    axis, angle = axis_angle_from_rotation(ahead[:, :3, :3] @ np.swapaxes(behind[:, :3, :3], 1, 2))
    np.testing.assert_allclose(axis * angle[:, None] / (2 * h), twist[:, 3:], atol=2e-5)
    # Neither velocity nor acceleration jumps: what differs beside each end of a blend vanishes with the step.
    marks = np.ravel([(one.begins, one.ends) for one in curve.blends()])
    for step in (1e-4, 1e-5):
        assert np.abs(curve.twist(marks + step) - curve.twist(marks - step)).max() < 5e3 * step
        bends = [(curve.twist(marks + side + step) - curve.twist(marks + side - step)) / (2 * step)
                 for side in (-2 * step, 2 * step)]  # fmt: skip
        assert np.abs(bends[1] - bends[0]).max() < 2e6 * step
    for k, piece in enumerate(curves):
        (begin, end) = curve.marks[k : k + 2] / curve.whole
        out = [one.begins if one.point == k + 1 else one.ends for one in curve.blends() if one.point in (k, k + 1)]
        low, high = (begin, out[0]) if k == 0 else (out[0], end) if k == len(curves) - 1 else (out[0], out[1])
        for part in np.linspace(low, high, 5):
            T = curve.at(np.array([part]))
            np.testing.assert_allclose(T, piece.at(np.array([(part - begin) / (end - begin)])), atol=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_how_far_a_point_is_missed(seed):
    rng = np.random.default_rng(seed)
    curve = rounded(random_curves(rng, 3), CornerRounding(0.8), 0.4)
    for k, one in enumerate(curve.blends()):
        T = curve.at(np.linspace(one.begins, one.ends, 20001))
        gaps = np.linalg.norm(T[:, :3, 3] - curve.corners[k][:3, 3], axis=1)
        assert gaps.min() == pytest.approx(one.distance, abs=1e-7)
        turned = axis_angle_from_rotation(curve.corners[k][:3, :3].T @ T[int(np.argmin(gaps)), :3, :3])[1]
        assert turned == pytest.approx(one.angle, abs=1e-2)


def test_points_in_a_row_are_no_corner():
    curve = rounded(lines(places([[0, 0], [1, 0], [3, 0]])), CornerRounding(1.0, 0.5), 1.0)
    s = np.linspace(0, 1, 101)
    np.testing.assert_allclose(curve.at(s)[:, 0, 3], 3 * s, atol=1e-12)
    assert curve.blends()[0].distance == pytest.approx(0.0, abs=1e-9)


def test_points_that_repeat_are_one():
    poses = places([[0, 0], [0, 0], [1, 0], [1, 0], [1, 1], [1, 1]])
    curve = rounded(lines(poses), CornerRounding(1.0, 0.2), 1.0)
    (blend,) = curve.blends()
    assert blend.point == 2 and curve.whole == pytest.approx(2.0)
    still = rounded(lines(poses[:2]), CornerRounding(1.0, 0.2), 1.0)
    np.testing.assert_array_equal(still.at(np.linspace(0, 1, 3)), np.tile(np.eye(4), (3, 1, 1)))


@pytest.mark.parametrize(
    ("points", "radius", "said"),
    [([[0, 0], [1, 0], [1, 1]], 1.5, "between the start and point 1, which are 1 m apart; expected at most 1 m"),
     ([[0, 0], [1, 0], [1, 0.5], [0, 0.5]], 0.3,
      "between point 1 and point 2, which are 0.5 m apart; expected at most 0.25 m")],
)  # fmt: skip
def test_a_radius_that_does_not_fit(points, radius, said):
    with pytest.raises(InputError, match=said):
        rounded(lines(places(points)), CornerRounding(1.0, radius), 1.0)
    most = float(said.rsplit("most ", 1)[1].split()[0])
    assert len(rounded(lines(places(points)), CornerRounding(1.0, most), 1.0).blends()) == len(points) - 2


def test_a_turn_alone_has_no_radius():
    poses = np.tile(np.eye(4), (3, 1, 1))
    poses[:, :3, :3] = rotation_from_axis_angle(np.tile([0.0, 0.0, 1.0], (3, 1)), np.array([0.0, 1.0, 0.2]))
    with pytest.raises(InputError, match="only turns before and after point 1"):
        rounded(lines(poses), CornerRounding(1.0, 0.1), 1.0)
    (blend,) = rounded(lines(poses), CornerRounding(1.0), 1.0).blends()
    assert blend.distance == 0.0 and blend.angle > 0.01


@pytest.mark.parametrize("profile", ["cubic", "quintic", "trapezoidal"])
def test_limits_hold_on_blends_also_between_rows(profile):
    """Looked at by differences of configurations at places that the path does not have."""
    start = np.array([0.3, -1.2, 1.4, -0.5, 1.2, 0.1])
    T = robokin.forward_kinematics(UR, start)
    goals = []
    for x, y, z in ((0.1, 0.05, 0.0), (0.1, 0.05, 0.2), (0.2, 0.15, 0.2)):
        pose = T.copy()
        pose[:3, 3] += (x, y, z)
        goals.append(Goal(T=pose))
    limits = motion_limits(UR, 1.0, 4.0)
    manner = Manner("line", timing=Timing(limits, profile), rounding=CornerRounding(1.0, 0.02))
    path = path_through(UR, start, goals, 2, manner)
    assert path.complete and len(path) == 7 and len(path.blends) == 2 and path.velocity is not None
    fine = path_through(UR, start, goals, 4001, Manner("line", timing=Timing(motion_limits(UR, None, None), profile,
                        duration=path.duration), rounding=CornerRounding(1.0, 0.02)))  # fmt: skip
    step = fine.t[1]
    speed = np.abs(np.diff(fine.q, axis=0)).max() / step
    push = np.abs(np.diff(fine.q, 2, axis=0)).max() / step**2
    assert speed <= 1.0 * 1.002 and push <= 4.0 * 1.01
    assert max(speed / 1.0, push / 4.0) > 0.97  # and one of them is met
    assert np.abs(fine.velocity).max() == pytest.approx(speed, rel=1e-3)
    assert np.abs(fine.acceleration).max() == pytest.approx(push, rel=2e-2)
    assert not fine.velocity[[0, -1]].any() or np.abs(fine.velocity[[0, -1]]).max() < 1e-9


@pytest.mark.parametrize("profile", ["cubic", "quintic", "trapezoidal"])
def test_the_time_of_a_part(profile):
    s = np.linspace(0, 1, 57)
    np.testing.assert_allclose(unit_law(profile, time_of_parts(profile, s))[0], s, atol=1e-12)


def test_half_a_turn_goes_one_way_whatever_rounding_says():
    rng = np.random.default_rng(5)
    for _ in range(50):
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        axis *= np.sign(axis[0])
        for angle in (np.pi - 1e-11, np.pi, np.pi + 1e-11):
            last = np.eye(4)
            last[:3, :3] = rotation_from_axis_angle(axis[None], np.array([angle]))[0]
            turn = SlerpedTurn(np.eye(4), last)
            assert turn.half_turn
            np.testing.assert_allclose(turn.spin(), np.pi * axis, atol=1e-6)
            np.testing.assert_allclose(turn.rotation(np.ones(1))[0], last[:3, :3], atol=1e-12)


def test_a_blend_wants_a_point_between():
    with pytest.raises(InputError, match="no point between"):
        path_through(
            PLANAR, np.array([0.5, 0.9]), [Goal(np.array([0.8, 0.7]))], 9, Manner("line", rounding=CornerRounding(1))
        )
