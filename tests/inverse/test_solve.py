"""Every solution closes, and none is missing: two claims, tested apart."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from conftest import data
from library_entries import names_of
from sweeps import sweep

import robokin
from robokin.errors import InputError
from robokin.inverse.analysis import analysis_of
from robokin.inverse.solve import solve_many
from robokin.kernel.joint_axes import nearest_point
from robokin.model import Joint, JointType, Robot
from robokin.spatial import rotation_angle, rotation_from_rpy, transform

RIGHT = np.pi / 2
TURN = 2 * np.pi


def arms(least, most):
    return names_of(Robot, least, most)


def gaps(robot, found, q):
    """(m, k, n) how far solutions are from joint values (m, n), whole turns aside; NaN where there is none."""
    gap = np.abs(found - q[:, None])
    return np.where(robot.revolute, np.minimum(gap % TURN, TURN - gap % TURN), gap)


def holds(robot, found, q, tolerance=1e-6):
    """(m,) whether joint values (m, n) are among the solutions (m, k, n)."""
    if not found.shape[1]:
        return np.zeros(len(q), dtype=bool)
    gap = np.max(np.nan_to_num(gaps(robot, found, q), nan=9.0), axis=2)
    return np.min(gap, axis=1) < tolerance


def random_values(robot, rng, count):
    size = analysis_of(robot).size
    return np.where(
        robot.revolute, rng.uniform(-3.1, 3.1, (count, robot.n)), rng.uniform(-size, size, (count, robot.n))
    )


def assert_closes(robot, result, T):
    """Each listed solution brings the tool to its target, measured here and not by the solver."""
    listed = ~np.isnan(result.q[..., 0])
    assert np.array_equal(listed.sum(axis=1), result.count)
    poses = robokin.forward_kinematics(robot, result.q[listed])
    targets = np.repeat(T, result.count, axis=0)
    size = analysis_of(robot).size
    assert np.max(np.linalg.norm(poses[:, :3, 3] - targets[:, :3, 3], axis=1), initial=0.0) <= 1.1e-9 * size
    assert np.max(rotation_angle(targets[:, :3, :3], poses[:, :3, :3]), initial=0.0) <= 1.1e-9


@pytest.mark.parametrize("name", sweep(arms(1, 6), 5))
def test_every_arm_of_the_library_with_at_most_six_joints(name, rng):
    robot = robokin.load(name)
    analysis = analysis_of(robot)
    assert analysis.complete
    q = random_values(robot, rng, 60)
    T = robokin.forward_kinematics(robot, q)
    result = solve_many(robot, T, limits=False)
    assert_closes(robot, result, T)
    assert holds(robot, result.q, q).all()
    if robot.n == 6:
        assert not (result.count % 2).any()


def random_arm(rng, n, sliding, special):
    kinds = ["revolute"] * n
    for i in rng.choice(n, sliding, replace=False):
        kinds[i] = "prismatic"
    rows = []
    for i, kind in enumerate(kinds):
        a, d = rng.uniform(-1, 1, 2) * (rng.random(2) < (0.5 if special else 1.0))
        alpha = rng.choice([0.0, RIGHT, -RIGHT, rng.uniform(-3, 3)]) if special else rng.uniform(-3, 3)
        theta = 0.0 if kind == "revolute" else rng.choice([0.0, RIGHT, 1.0])
        d = 0.0 if kind == "prismatic" else d
        rows.append(Joint(str(i), JointType(kind), theta=theta, d=d, a=a, alpha=alpha))
    return Robot("random arm", tuple(rows))


@pytest.mark.parametrize("sliding", sweep([0, 1, 2, 3], 4))
@pytest.mark.parametrize("special", sweep([False, True], 2))
@pytest.mark.parametrize("n", [3, 4, 5, 6])
def test_random_arms(n, sliding, special):
    """376 arms in all; those whose joints depend on each other everywhere have no isolated solutions."""
    rng = np.random.default_rng(1000 * n + 10 * sliding + special)
    poses = hits = odd = arms = 0
    for _ in range(20 if n == 6 else 9):
        robot = random_arm(rng, n, min(sliding, n), special)
        analysis = analysis_of(robot)
        if not analysis.complete:
            continue
        arms += 1
        q = random_values(robot, rng, 15)
        T = robokin.forward_kinematics(robot, q)
        result = solve_many(robot, T, limits=False)
        assert_closes(robot, result, T)
        poses += len(q)
        hits += int(holds(robot, result.q, q, 1e-5).sum())
        odd += int((result.count % 2).sum()) if n == 6 else 0
    assert arms >= 2
    assert hits == poses
    assert odd == 0


@pytest.mark.parametrize("entry", data("six_r_examples.json"), ids=lambda entry: entry["id"])
def test_published_examples_have_their_solutions(entry):
    robot = robokin.load(entry["id"])
    metres = robot.units.metres
    T = np.array(entry["pose"])
    T = transform(np.linalg.svd(T[:3, :3])[0] @ np.linalg.svd(T[:3, :3])[2], T[:3, 3] * metres)
    result = robokin.solve_ik(robot, T, limits=False)
    assert len(result.solutions) == entry["count"]
    assert result.complete
    factors = np.where(robot.revolute, np.pi / 180, metres)
    expected = np.array(entry["solutions"]) * factors
    found = np.array([solution.q for solution in result.solutions])
    # The tables print five decimals of a degree at best, the poses six digits.
    tolerance = 2e-2 if entry["id"] == "raghavan-roth-rprrpr" else 1e-4
    assert holds(robot, np.repeat(found[None], len(expected), axis=0), expected, tolerance).all()


# Singular poses ----------------------------------------------------------------------------------------


def generated(robot, q):
    """Shares of poses with an answer, and with the generating values among them up to their self-motion."""
    T = robokin.forward_kinematics(robot, q)
    result = solve_many(robot, T, limits=False)
    assert_closes(robot, result, T)
    hit = holds(robot, result.q, q, 1e-4)  # a double solution has half of the digits
    for i in np.flatnonzero(~hit):
        for solution in result[i].solutions:
            held = [k for k in range(robot.n) if k + 1 not in solution.free]
            gap = gaps(robot, solution.q[None, None], q[i : i + 1])[0, 0]
            hit[i] |= bool(solution.free) and np.max(gap[held], initial=0.0) < 1e-4
    return np.mean(result.count > 0), np.mean(hit)


@pytest.mark.parametrize("name", sweep(["puma560", "ur5e"], 2))
@pytest.mark.parametrize("q5", sweep([0.0, np.pi, 1e-9, 1e-7, 1e-5, 1e-3], 4))
def test_wrist_singularities(name, q5, rng):
    q = rng.uniform(-3, 3, (40, 6))
    q[:, 4] = q5
    answered, hit = generated(robokin.load(name), q)
    assert answered == 1.0
    assert hit >= 0.99


# The PUMA's elbow is straight where the wrist centre, at (a3, d4) from it, lines up with the upper arm.
ELBOWS = {"puma560": np.arctan2(433.07, -20.32) + np.array([0.0, np.pi]), "ur5e": np.array([0.0, np.pi])}


@pytest.mark.parametrize("name", sweep(["puma560", "ur5e"], 2))
def test_elbow_singularities(name, rng):
    robot = robokin.load(name)
    for value in ELBOWS[name]:
        q = rng.uniform(-3, 3, (40, 6))
        q[:, 2] = value
        assert np.max(np.linalg.svd(robokin.jacobian(robot, q), compute_uv=False)[:, -1]) < 1e-9
        answered, hit = generated(robot, q)
        assert answered == 1.0
        assert hit >= 0.99


@pytest.mark.parametrize("name", sweep(["puma560", "ur5e"], 2))
def test_joint_values_that_are_multiples_of_90_degrees(name, rng):
    answered, hit = generated(robokin.load(name), rng.integers(-1, 3, (60, 6)) * RIGHT)
    assert answered == 1.0
    assert hit >= 0.99


def test_a_self_motion_is_named():
    robot = robokin.load("puma560")
    T = robokin.forward_kinematics(robot, [0.3, -0.5, 0.7, 0.4, 0.0, 0.2])
    free = {solution.free for solution in robokin.solve_ik(robot, T, limits=False).solutions}
    assert free == {(), (4, 6)}


# The boundary, nearly special geometry, limits ----------------------------------------------------------


@pytest.mark.slow
def test_the_boundary_of_the_reach():
    robot = robokin.load("planar2r")
    reach = robot.parameters["a1"] + robot.parameters["a2"]
    for factor, expected in ((1 - 1e-9, True), (1 + 1e-6, False)):
        T = transform(np.eye(3), [reach * factor * robot.units.metres, 0, 0])
        result = robokin.solve_ik(robot, T, limits=False, task="position")
        assert result.reachable is expected
        if not expected:
            assert result.reason == "out of reach"
            assert result.nearest.position_error == pytest.approx(1e-6 * reach * robot.units.metres, rel=1e-3)


@pytest.mark.parametrize("name", ["puma560", "ur5e"])
@pytest.mark.parametrize("off", sweep([1e-8, 1e-12, 1e-10, 1e-9, 1e-6, 1e-4, 1e-2], 7))
def test_calibrated_arms(name, off, rng):
    """Arms whose axes nearly meet or are nearly parallel, as calibration finds them."""
    rows = tuple(
        replace(row, a=row.a + off * rng.normal(), d=row.d + off * rng.normal(), alpha=row.alpha + off * rng.normal())
        for row in robokin.load(name).rows
    )
    robot = Robot("calibrated", rows)
    q = rng.uniform(-3, 3, (40, 6))
    T = robokin.forward_kinematics(robot, q)
    result = solve_many(robot, T, limits=False)
    assert_closes(robot, result, T)
    assert holds(robot, result.q, q).all()


@pytest.mark.parametrize(("name", "count"), [("puma560", 2000), ("panda", 60), ("iiwa14", 30), ("human-arm", 20)])
def test_what_is_attainable_within_the_limits_is_answered_within_them(name, count, rng):
    robot = robokin.load(name)
    reach = np.where(np.isinf(robot.limits), [-np.pi, np.pi], robot.limits)
    q = rng.uniform(*reach.T, (count, robot.n))
    T = robokin.forward_kinematics(robot, q)
    result = solve_many(robot, T)
    assert_closes(robot, result, T)
    assert np.mean(result.count > 0) >= 0.999
    listed = ~np.isnan(result.q[..., 0])
    assert robot.within_limits(result.q[listed]).all()
    assert result.within_limits[listed].all()


def test_a_whole_turn_is_tried_for_the_limits():
    robot = robokin.load("puma560")
    q = np.radians([10.0, -200.0, 30.0, 10.0, 20.0, 250.0])
    result = robokin.solve_ik(robot, robokin.forward_kinematics(robot, q))
    found = np.array([[solution.q for solution in result.solutions]])
    assert holds(robot, found, q[None]).all()
    assert robot.within_limits(found).all()
    # 160° is what the solver finds for joint 2; only -200° is within -225° .. 45°.
    assert np.min(found[..., 1]) == pytest.approx(np.radians(-200.0))


def test_outside_the_limits_is_said():
    robot = robokin.load("thumb")
    T = robokin.forward_kinematics(robot, np.radians([-40.0, 10.0, 20.0, 10.0, 10.0]))
    result = robokin.solve_ik(robot, T)
    assert not result.reachable
    assert result.reason == "outside the joint limits"
    assert result.nearest.within_limits
    free = robokin.solve_ik(robot, T, limits=False)
    assert free.reachable
    assert not any(solution.within_limits for solution in free.solutions)


# Fewer and more than six joints -------------------------------------------------------------------------


def test_an_orientation_that_the_arm_cannot_have():
    robot = robokin.load("scorbot")
    q = np.radians([20.0, -60.0, 80.0, -30.0, 40.0])
    T = robokin.forward_kinematics(robot, q)
    T[:3, :3] = T[:3, :3] @ rotation_from_rpy([0.3, 0.0, 0.0])
    result = robokin.solve_ik(robot, T, limits=False)
    assert not result.reachable
    assert result.reason.startswith("orientation not attainable")
    nearest = result.nearest
    assert nearest.position_error < 1e-6
    assert 0.01 < nearest.angle_error < 0.31
    found = robokin.forward_kinematics(robot, nearest.q)
    assert np.linalg.norm(found[:3, 3] - T[:3, 3]) == pytest.approx(nearest.position_error, abs=1e-9)
    assert rotation_angle(T[:3, :3], found[:3, :3]) == pytest.approx(nearest.angle_error, abs=1e-9)


def test_position_alone_and_approach(rng):
    arm = robokin.load("anthropomorphic")
    q = rng.uniform(-1, 1, 3)
    T = robokin.forward_kinematics(arm, q)
    T[:3, :3] = np.eye(3)
    result = robokin.solve_ik(arm, T, limits=False, task="position")
    assert len(result.solutions) == 4  # C. Laschi, W. Lucia: shoulder right or left, elbow up or down
    names = {solution.branch for solution in result.solutions}
    assert names == {f"shoulder {a}, elbow {b}" for a in ("right", "left") for b in ("up", "down")}
    puma = robokin.load("puma560")
    T = robokin.forward_kinematics(puma, rng.uniform(-1, 1, 6))
    approached = robokin.solve_ik(puma, T, limits=False, task="approach").solutions
    assert len(approached) >= 4
    for solution in approached:
        found = robokin.forward_kinematics(puma, solution.q)
        assert np.allclose(found[:3, 2:], T[:3, 2:], atol=1e-8)


def test_a_redundant_arm_gives_spread_solutions_within_its_limits(rng):
    robot = robokin.load("panda")
    q = rng.uniform(*robot.limits.T)
    result = robokin.solve_ik(robot, robokin.forward_kinematics(robot, q), most=8)
    assert len(result.solutions) == 8
    assert not result.complete
    q = np.array([solution.q for solution in result.solutions])
    assert np.max(np.ptp(q, axis=0)) > 0.5
    assert robot.within_limits(q).all()


# The answer's form ----------------------------------------------------------------------------------------


def test_a_batch_is_its_singles(rng):
    robot = robokin.load("ur5e")
    T = robokin.forward_kinematics(robot, rng.uniform(-3, 3, (7, 6)))
    batch = robokin.solve_ik(robot, T, limits=False)
    assert batch.q.shape == (7, batch.count.max(), 6)
    for i, target in enumerate(T):
        single = robokin.solve_ik(robot, target, limits=False)
        assert len(single.solutions) == batch.count[i] == len(batch[i].solutions)
        for k, solution in enumerate(single.solutions):
            assert np.allclose(solution.q, batch.q[i, k], atol=1e-9)
            assert np.array_equal(batch[i].solutions[k].q, batch.q[i, k])
    assert np.isnan(batch.q[np.arange(batch.q.shape[1]) >= batch.count[:, None]]).all()


def test_near_orders_by_the_greatest_joint_move(rng):
    robot = robokin.load("puma560")
    q = rng.uniform(-1, 1, 6)
    result = robokin.solve_ik(robot, robokin.forward_kinematics(robot, q), limits=False, near=q + 0.01)
    moves = [np.max(np.abs(solution.q - q - 0.01)) for solution in result.solutions]
    assert np.allclose(result.solutions[0].q, q, atol=1e-9)
    assert moves == sorted(moves)


def test_the_same_question_has_the_same_answer(rng):
    robot = robokin.load("panda")
    T = robokin.forward_kinematics(robot, rng.uniform(*robot.limits.T))
    first, second = robokin.solve_ik(robot, T), robokin.solve_ik(robot, T)
    assert [solution.q.tolist() for solution in first.solutions] == [
        solution.q.tolist() for solution in second.solutions
    ]


def test_the_numeric_method_finds_some_of_the_solutions(rng):
    robot = robokin.load("puma560")
    q = rng.uniform(-1, 1, 6)
    T = robokin.forward_kinematics(robot, q)
    result = robokin.solve_ik(robot, T, method="numeric", limits=False)
    assert not result.complete
    assert result.method == "numeric"
    every = robokin.solve_ik(robot, T, limits=False)
    found = np.array([solution.q for solution in result.solutions])
    assert 1 <= len(found) <= 8
    for values in found:
        assert holds(robot, np.array([[solution.q for solution in every.solutions]]), values[None], 1e-5).all()


def test_wrong_questions():
    robot = robokin.load("puma560")
    sheared = np.eye(4)
    sheared[0, 1] = 0.1
    with pytest.raises(InputError, match=r"off by 0\.1"):
        robokin.solve_ik(robot, sheared)
    with pytest.raises(InputError, match="off by 2"):
        robokin.solve_ik(robot, np.diag([1.0, 1.0, -1.0, 1.0]))
    with pytest.raises(InputError, match="not finite"):
        robokin.solve_ik(robot, np.full((4, 4), np.nan))
    with pytest.raises(InputError, match="expected 6"):
        robokin.solve_ik(robot, np.eye(4), near=[0, 0])
    with pytest.raises(InputError, match=r"\(4, 4\)"):
        robokin.solve_ik(robot, np.eye(3))
    with pytest.raises(InputError, match="no joints"):
        robokin.solve_ik(robokin.load("assembly"), np.eye(4))


@pytest.mark.parametrize("name", ["puma560", "viperx300s", "widowx250s", "irb120"])
def test_every_solution_of_an_arm_with_a_wrist_has_a_name_of_its_own(name):
    robot = robokin.load(name)
    q = np.random.default_rng(12).uniform(-2.5, 2.5, (40, robot.n))
    q = np.where(robot.revolute, q, np.abs(q))
    for result in robokin.solve_ik(robot, robokin.forward_kinematics(robot, q), limits=False):
        names = [solution.branch for solution in result.solutions]
        assert len(set(names)) == len(names)


def test_the_point_where_two_axes_meet_is_found_from_any_points_on_them():
    rng = np.random.default_rng(3)
    meet, z0, z1 = rng.normal(size=(3, 20, 3))
    o0, o1 = meet + rng.normal(size=(20, 1)) * z0, meet + rng.normal(size=(20, 1)) * z1
    assert np.abs(nearest_point(z0, o0, z1, o1) - meet).max() < 1e-12
