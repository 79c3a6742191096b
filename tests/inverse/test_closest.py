"""The closest configuration where there is no solution: the position is the nearest of all, then the orientation."""

from __future__ import annotations

import numpy as np
import pytest
from sweeps import sweep

import robokin
from robokin.inverse.analysis import analysis_of
from robokin.inverse.numeric import second_order, turn_in_place
from robokin.inverse.numeric.closest import beyond_reach, nearest_configurations
from robokin.inverse.numeric.closing import closing_nearest
from robokin.inverse.numeric.position_first import SAME_PLACE, DescentEnds, Ways, position_first
from robokin.inverse.numeric.second_order import go_down, slope, solve_definite
from robokin.inverse.numeric.turn_in_place import turned_in_place
from robokin.inverse.solve import solve_many
from robokin.inverse.verify import residuals
from robokin.kernel.residual import error_and_jacobian
from robokin.spatial import nearest_rotation, rotation_angle, rotation_from_axis_angle, transform

ARMS = ["puma560", "ur5e", "planar3r", "scara", "stanford-arte", "scorbot", "kr210-r2700", "crx10ia", "panda", "iiwa14"]
"""Of every family: spherical wrist, three parallel axes, planar, a slide, five joints, elimination, redundant."""

EXACT = 1e-9
"""What a nearest position is accurate to, in the arm's size."""


def turned(rng, p):
    """Poses (m, 4, 4) at p (m, 3) with random orientations."""
    R = nearest_rotation(rng.normal(size=(len(p), 3, 3)))
    return transform(R, p)


def configurations(robot, analysis, count, rng, bounded=True):
    """Random configurations (count, n), within the limits or a turn and the arm's size."""
    reach = np.where(robot.revolute, np.pi, analysis.size)[:, None] * [-1.0, 1.0]
    low, high = (np.where(np.isinf(robot.limits), reach, robot.limits) if bounded else reach).T
    return rng.uniform(low, high, (count, robot.n))


def scattered(robot, analysis, count, rng, bounded=True):
    """Targets (count, 4, 4) near and far from where the arm reaches, with orientations at random."""
    p = robokin.forward_kinematics(robot, configurations(robot, analysis, count, rng, bounded))[:, :3, 3]
    p += analysis.size * rng.choice([0.02, 0.3, 2.0], (count, 1)) * rng.normal(size=(count, 3))
    return turned(rng, p)


def limits_of(robot, bounded):
    return robot.limits if bounded else np.tile([-np.inf, np.inf], (robot.n, 1))


def closest(robot, T, bounded=True):
    limits = limits_of(robot, bounded)
    return nearest_configurations(analysis_of(robot), T, limits, np.clip(0.0, *limits.T), 0)


def columns(T):
    return np.ascontiguousarray(T[:, :3].transpose(2, 1, 0))


# The way down ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["puma560", "stanford", "raghavan-roth-rprrpr", "human-arm"])
def test_slope_and_curvature_are_finite_differences(name, rng):
    robot = robokin.load(name)
    analysis = analysis_of(robot)
    x, w = rng.normal(size=(robot.n, 5)), rng.random(5)
    T = columns(turned(rng, analysis.size * rng.normal(size=(5, 3))))
    here, h = slope(analysis.chain, T, x, analysis.size, w), 1e-6
    for i in range(robot.n):
        step = h * np.eye(robot.n)[:, i : i + 1]
        before, after = (slope(analysis.chain, T, x + way, analysis.size, w) for way in (-step, step))
        assert np.allclose((after.f - before.f) / (2 * h), here.gradient[i], atol=1e-8)
        assert np.allclose((after.gradient - before.gradient) / (2 * h), here.hessian[:, i], atol=1e-8)


def test_definite_matrices_are_solved_and_others_are_named(rng):
    A = rng.normal(size=(50, 6, 6))
    eigenvalues = rng.uniform(0.1, 1.0, (50, 6))
    eigenvalues[::2, rng.integers(6)] *= -1.0
    Q = np.linalg.qr(A)[0]
    A = (Q * eigenvalues[:, None]) @ np.swapaxes(Q, 1, 2)
    b = rng.normal(size=(6, 50))
    x, definite = solve_definite(np.ascontiguousarray(A.transpose(1, 2, 0)), b)
    assert np.array_equal(definite, np.arange(50) % 2 == 1)
    assert np.allclose(np.einsum("sij,js->is", A[definite], x[:, definite]), b[:, definite], atol=1e-10)


# The position ------------------------------------------------------------------------------------------


def test_a_box(rng):
    robot = robokin.load("cartesian")
    T = scattered(robot, analysis_of(robot), 100, rng)
    q, position, _ = closest(robot, T)
    zero, ends = (robokin.forward_kinematics(robot, at)[..., :3, 3] for at in (np.zeros(3), np.eye(3)))
    axes = ends - zero  # orthonormal rows: the nearest point of a box
    expected = np.clip((T[:, :3, 3] - zero) @ axes.T, *robot.limits.T)
    assert np.allclose(q, expected, atol=EXACT)
    assert np.allclose(position, np.linalg.norm(zero + expected @ axes - T[:, :3, 3], axis=1), atol=EXACT)


def test_a_ring(rng):
    robot = robokin.load("planar2r")
    a1, a2 = (row.a for row in robot.rows if row.a)
    T = scattered(robot, analysis_of(robot), 100, rng)
    p = (np.linalg.inv(robot.base) @ T)[:, :3, 3]
    across = np.linalg.norm(p[:, :2], axis=1)
    expected = np.hypot(across - np.clip(across, abs(a1 - a2), a1 + a2), p[:, 2])
    assert np.allclose(closest(robot, T)[1], expected, atol=EXACT)


@pytest.mark.parametrize("beyond", [0.0, 1e-14, 1e-12, 1e-10, 1e-9, 1e-8, 1e-6, 1e-4, 1e-2, 1.0])
def test_a_stretched_arm(beyond, rng):
    """At the edge of the reach the distance has no slope and, exactly there, no curvature either."""
    robot = robokin.load("planar3r")
    analysis = analysis_of(robot)
    angle = rng.uniform(-np.pi, np.pi, 10)
    q = np.stack([angle, 0 * angle, 0 * angle], axis=1)
    T = robokin.forward_kinematics(robot, q)
    T[:, :3, 3] *= 1.0 + beyond
    expected = beyond * analysis.size
    assert np.allclose(closest(robot, T)[1], expected, atol=EXACT * analysis.size)


@pytest.mark.parametrize("bounded", [True, False])
@pytest.mark.parametrize("name", sweep(ARMS, 3))
def test_no_configuration_comes_nearer(name, bounded, rng):
    """Against the best of many descents of the position alone, started anywhere."""
    robot = robokin.load(name)
    analysis, limits, count = analysis_of(robot), limits_of(robot, bounded), 100
    T = scattered(robot, analysis, 12, rng, bounded)
    q, position, angle = closest(robot, T, bounded)
    scale = np.where(robot.revolute, 1.0, analysis.size)[:, None]
    began = np.tile(configurations(robot, analysis, count, rng, bounded), (len(T), 1)).T / scale
    many = np.repeat(columns(T), count, axis=2)
    low_high = limits[:, :1] / scale, limits[:, 1:] / scale
    nothing = np.zeros(began.shape[1])
    ended = go_down(analysis.chain, many, began, analysis.size, low_high, nothing, steps=40, still=1e-9, least=1e-10)
    brute = analysis.size * np.sqrt(2.0 * ended[1]).reshape(len(T), count).min(axis=1)
    assert np.all(position <= brute + EXACT * analysis.size)
    if bounded:
        assert robot.within_limits(q).all()
    found = robokin.forward_kinematics(robot, q)
    assert np.allclose(np.linalg.norm(found[:, :3, 3] - T[:, :3, 3], axis=1), position, atol=1e-12 * analysis.size)
    assert np.allclose([rotation_angle(a[:3, :3], b[:3, :3]) for a, b in zip(T, found, strict=True)], angle, atol=1e-7)


@pytest.mark.parametrize("kernel", ["in use", "python"])
@pytest.mark.parametrize("name", sweep(ARMS, 3))
def test_no_start_nearby_comes_nearer(name, kernel, rng, monkeypatch):
    """Ways with the position first from all around what was found, near it and less near, end nowhere better."""
    if kernel == "python":
        for module in (second_order, turn_in_place):
            monkeypatch.setattr(module, "native", None)
    robot = robokin.load(name)
    analysis, count = analysis_of(robot), 12
    T = scattered(robot, analysis, 8, rng)
    q, position, angle = closest(robot, T)
    scale = np.where(robot.revolute, 1.0, analysis.size)
    low, high = (robot.limits / scale[:, None]).T[..., None]
    around = np.repeat([1e-3, 1e-2, 0.1], count // 3)
    began = (q / scale)[:, None] + around[:, None] * rng.normal(size=(len(T), count, robot.n))
    began = np.ascontiguousarray(np.clip(began.reshape(-1, robot.n).T, low, high))
    many = np.repeat(columns(T), count, axis=2)
    ends = position_first(Ways(analysis.chain, analysis.size, low, high), many, began, (1e-4, 1e-6, 1e-8), 30, 25)
    distance, left = ends.distance.reshape(len(T), count), ends.angle.reshape(len(T), count)
    known = (position / analysis.size)[:, None]
    assert np.all(distance >= known - EXACT)
    assert np.all((distance > known + SAME_PLACE) | (left >= angle[:, None] - 1e-6))


# Then the orientation ----------------------------------------------------------------------------------


def test_of_the_configurations_at_the_position_that_with_the_least_angle(rng):
    robot = robokin.load("anthropomorphic")
    q = configurations(robot, analysis_of(robot), 60, rng)
    T = turned(rng, robokin.forward_kinematics(robot, q)[:, :3, 3])
    _, position, angle = closest(robot, T)
    assert np.max(position) < EXACT
    everything = solve_many(robot, T, task="position")
    least = np.array(
        [
            min(rotation_angle(goal[:3, :3], robokin.forward_kinematics(robot, s.q)[:3, :3]) for s in answer.solutions)
            for goal, answer in zip(T, everything, strict=True)
        ]
    )
    assert np.all(angle >= least - 1e-6)
    assert np.mean(angle <= least + 1e-6) >= 0.95


def test_a_wrist_that_turns_any_way_takes_no_position(rng):
    """The first three joints of a PUMA place the wrist's centre, the tool's origin; the others turn it at will."""
    robot = robokin.load("puma560-craig")
    T = scattered(robot, analysis_of(robot), 40, rng)
    _, position, angle = closest(robot, T)
    assert np.mean(position > 0.01 * analysis_of(robot).size) > 0.3
    assert np.max(angle) < 1e-6


@pytest.mark.parametrize("name", ["scorbot", "thumb"])
def test_five_joints_turn_as_far_as_the_position_lets_them(name, rng):
    """What the position leaves free of the joints has no slope left: the angle's gradient is normal to it."""
    robot = robokin.load(name)
    analysis = analysis_of(robot)
    reached = robokin.forward_kinematics(robot, configurations(robot, analysis, 30, rng, bounded=False))
    T = turned(rng, reached[:, :3, 3])
    q, position, angle = closest(robot, T, bounded=False)
    assert np.max(position) < EXACT * analysis.size
    error, J = error_and_jacobian(analysis.chain, T, q, analysis.size)
    gradient = np.einsum("sij,si->sj", J[:, 3:], error[:, 3:])
    _, values, Vt = np.linalg.svd(J[:, :3])
    regular = (values[:, -1] > 0.05) & (angle < 3.0)
    assert np.mean(regular) > 0.3
    assert np.max(np.abs(np.einsum("skj,sj->sk", Vt[:, 3:], gradient)[regular])) < 1e-3


# The answers -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", sweep(["ur5e", "scorbot", "panda"], 3))
def test_alone_as_in_a_batch(name, rng):
    robot = robokin.load(name)
    T = scattered(robot, analysis_of(robot), 20, rng)
    together = closest(robot, T)
    for i in (0, 7, 19):
        for alone, among in zip(closest(robot, T[i : i + 1]), together, strict=True):
            # Where a minimum is flat joint values have half of the digits.
            np.testing.assert_allclose(alone[0], among[i], rtol=0, atol=1e-7)


@pytest.mark.parametrize("task", sweep(["pose", "approach", "position"], 3))
@pytest.mark.parametrize("limits", [True, False])
def test_a_batch_says_what_the_targets_say_alone(task, limits, rng):
    robot = robokin.load("puma560")
    T = scattered(robot, analysis_of(robot), 12, rng)
    batch = robokin.solve_ik(robot, T, task=task, limits=limits)
    for i in (0, 3, 5, 11):
        alone = robokin.solve_ik(robot, T[i], task=task, limits=limits)
        assert batch.reason(i) == batch[i].reason == alone.reason
        assert (alone.nearest is None) == alone.reachable
        if alone.nearest is not None:
            assert np.array_equal(batch[i].nearest.q, alone.nearest.q)
            assert batch[i].nearest.position_error == alone.nearest.position_error


@pytest.mark.parametrize("name", [*ARMS, "cartesian", "cylindrical", "spherical", "human-arm"])
def test_a_bound_of_the_reach(name, rng):
    robot = robokin.load(name)
    analysis = analysis_of(robot)
    T = robokin.forward_kinematics(robot, configurations(robot, analysis, 1000, rng))
    assert not beyond_reach(analysis, T, robot.limits).any()
    far = T.copy()
    far[:, :3, 3] += 100.0 * analysis.size
    assert beyond_reach(analysis, far, robot.limits).all()
    assert beyond_reach(analysis, far, limits_of(robot, False)).all() == robot.revolute.all()


def test_among_equals_the_one_that_is_near():
    """Beside a SCARA's column elbow left and right are as near to a target too high up."""
    robot = robokin.load("scara")
    T = robokin.forward_kinematics(robot, [0.3, 0.9, 0.1, 0.2])
    T[2, 3] += 10.0
    for near in ([0.3, 0.9, 0.1, 0.2], robokin.solve_ik(robot, T, near=[1.2, -0.9, 0.1, 1.1]).nearest.q):
        nearest = robokin.solve_ik(robot, T, near=near).nearest
        assert np.max(np.abs(np.delete(nearest.q - near, 2))) < 1e-6


# Near limits -------------------------------------------------------------------------------------------


def corners(robot, analysis, count, rng):
    """Configurations (count, n): inside, with some joints at limits, with all of them, in turn."""
    reach = np.where(robot.revolute, np.pi, analysis.size)[:, None] * [-1.0, 1.0]
    low, high = np.where(np.isinf(robot.limits), reach, robot.limits).T
    q = configurations(robot, analysis, count, rng)
    chance = np.array([0.0, 0.5, 1.0])[np.arange(count) % 3]
    return np.where(rng.random(q.shape) < chance[:, None], np.where(rng.random(q.shape) < 0.5, low, high), q)


def assert_no_worse(robot, T, q):
    size = analysis_of(robot).size
    _, position, angle = closest(robot, T)
    known, turned_by = residuals(T, robokin.forward_kinematics(robot, q))
    assert np.all(position <= known + EXACT * size)
    assert np.all((position < known - EXACT * size) | (angle <= turned_by + 1e-7))


@pytest.mark.parametrize(
    ("name", "degrees"),
    [("puma560", [160, -225, -45, 0, -100, -266]), ("gp8", [-170, 145, -70, -190, -135, 360])],
)
def test_turned_by_a_degree_from_a_corner(name, degrees):
    robot = robokin.load(name)
    q = np.radians(degrees)[None]
    T = robokin.forward_kinematics(robot, q)
    T[:, :3, :3] = rotation_from_axis_angle([0.0, 1.0, 0.0], np.radians(1.0)) @ T[:, :3, :3]
    assert_no_worse(robot, T, q)


@pytest.mark.parametrize(
    "name", sweep(["puma560", "gp8", "z1", "xmate-sr3", "lrmate200id", "scorbot", "panda", "yumi-left"], 3)
)
def test_no_worse_than_a_configuration_near_the_target(name, rng):
    """Targets are turned by up to 0.01 rad from the pose of a configuration, so that its position is exact."""
    robot = robokin.load(name)
    q = corners(robot, analysis_of(robot), 30, rng)
    T = robokin.forward_kinematics(robot, q)
    for target in T:
        axis = rng.normal(size=3)
        turn = rotation_from_axis_angle(axis / np.linalg.norm(axis), rng.uniform(0.0, 0.01))
        target[:3, :3] = turn @ target[:3, :3]
    assert_no_worse(robot, T, q)


def test_more_initial_guesses_are_turned_and_put_on_the_limits(rng):
    robot = robokin.load("puma560")
    analysis, limits = analysis_of(robot), robot.limits
    q = corners(robot, analysis, 6, rng)
    T = robokin.forward_kinematics(robot, q)
    index = np.repeat(np.arange(6), 2)
    more = np.repeat(q, 2, axis=0) + np.where(np.arange(12)[:, None] % 2, 2 * np.pi, 1e-3)
    x, position, angle = nearest_configurations(analysis, T, limits, np.zeros(6), 0, (index, more))
    assert robot.within_limits(x).all()
    assert np.max(position) < EXACT
    assert np.max(angle) < 1e-7
    alone = nearest_configurations(analysis, T[3:4], limits, np.zeros(6), 0, (np.zeros(2, dtype=int), more[6:8]))
    assert np.array_equal(alone[0][0], x[3])


# Solutions found by search -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    "name", sweep(["xarm6", "piper-old", "big-yam", "puma560", "scorbot", "stanford-arte", "adept-one"], 4)
)
def test_poses_on_a_grid_are_reached_within_the_limits(name, rng):
    robot = robokin.load(name)
    analysis = analysis_of(robot)
    step = np.where(robot.revolute, np.pi / 6.0, analysis.size / 8.0)
    q = np.round(configurations(robot, analysis, 60, rng) / step) * step
    q = q[robot.within_limits(q)]
    T = robokin.forward_kinematics(robot, q)
    found = closing_nearest(analysis, T, robot.limits, np.clip(0.0, *robot.limits.T), 0)
    assert np.all(np.bincount(found.index, minlength=len(T)) > 0)
    assert robot.within_limits(found.q).all()
    position, angle = residuals(T[found.index], robokin.forward_kinematics(robot, found.q))
    assert np.max(position) <= 1.01e-9 * analysis.size
    assert np.max(angle) <= 1.01e-9


def test_what_is_found_alone_is_found_in_a_batch(rng):
    robot = robokin.load("yam")
    analysis, home = analysis_of(robot), np.clip(0.0, *robot.limits.T)
    T = robokin.forward_kinematics(robot, corners(robot, analysis, 9, rng))
    together = closing_nearest(analysis, T, robot.limits, home, 0)
    for i in (0, 5, 8):
        alone = closing_nearest(analysis, T[i : i + 1], robot.limits, home, 0)
        assert np.array_equal(alone.q, together.q[together.index == i])


def test_an_elbow_s_circle_is_gone_along_to_its_end():
    """Of a stretched seven-joint arm the angle that is left changes by a fifth along the elbow's circle, a radian."""
    robot = robokin.load("gen3")
    q = np.array([-1.443256, -1.58162, 1.640533, -0.004848, 2.461898, 0.797103, 0.89524])
    T = robokin.forward_kinematics(robot, q)[None]
    axis = np.random.default_rng(6).normal(size=3)
    T[0, :3, :3] = rotation_from_axis_angle(axis / np.linalg.norm(axis), 0.004) @ T[0, :3, :3]
    for seed in range(3):
        _, position, angle = nearest_configurations(analysis_of(robot), T, robot.limits, np.zeros(robot.n), seed)
        assert position[0] <= EXACT
        assert angle[0] < 1.06e-3


def test_turning_in_place_keeps_the_position_and_the_limits(rng):
    for name in ("panda", "puma560"):
        robot = robokin.load(name)
        analysis = analysis_of(robot)
        scale = np.where(robot.revolute, 1.0, analysis.size)
        q = configurations(robot, analysis, 40, rng)
        T = robokin.forward_kinematics(robot, q)
        T[:, :3, :3] = turned(rng, T[:, :3, 3])[:, :3, :3]
        low, high = (robot.limits / scale[:, None]).T[..., None]
        angle = residuals(T, robokin.forward_kinematics(robot, q))[1]
        before = DescentEnds((q / scale).T, np.zeros(len(q)), angle)
        after = turned_in_place(Ways(analysis.chain, analysis.size, low, high), columns(T), before)
        position, left = residuals(T, robokin.forward_kinematics(robot, after.x.T * scale))
        assert np.max(position) <= 1e-10 * analysis.size
        assert np.allclose(left, after.angle, atol=1e-7)
        assert np.all(left <= angle + 1e-9)
        assert np.mean(left < angle - 0.1) > 0.5
        assert robot.within_limits(after.x.T * scale).all()
