"""Inverse kinematics of arms whose joints hang on each other: every solution closes, and none is missing."""

from __future__ import annotations

import numpy as np
import pytest

import robokin
from robokin.inverse.coupled_joints import about_inverse
from robokin.kinematics.velocity import motion_task
from robokin.model import CoupledRobot, JointType
from robokin.model.coupled_robot import drive_of, driven
from robokin.model.graph import Coupling
from robokin.model.robot import Joint, Robot

TURN = 2.0 * np.pi
FREE = (-np.inf, np.inf)


def coupled(robot, couplings, limits=None, motion_limits=None):
    """A robot's table with couplings (joint, other, ratio, own), rows from 1."""
    rows = []
    moving = [row for row in robot.rows if row.moves]
    for i, row in enumerate(moving):
        own = FREE if limits is None else tuple(limits[i])
        motion = FREE if motion_limits is None else tuple(motion_limits[i])
        rows.append(Joint(f"j{i + 1}", row.type, row.theta, row.d, row.a, row.alpha, row.offset, own, row.origin,
                          row.axis, sense=row.sense, motion_limits=motion))  # fmt: skip
    listed = tuple(Coupling(f"j{j}", ((f"j{k}", ratio),), 0.1 * own, own) for j, k, ratio, own in couplings)
    fields = {"name": "coupled", "rows": tuple(rows), "convention": robot.convention, "base": robot.base,
              "tool": robot.tool, "units": robot.units}  # fmt: skip
    return driven(fields, listed)


def random_values(robot, rng, count):
    span = np.where(robot.revolute, np.pi, 0.5)
    box = np.where(np.isfinite(robot.limits), robot.limits, span[:, None] * [-1.0, 1.0])
    return rng.uniform(box[:, 0], box[:, 1], (count, robot.n))


def same(a, b, revolute):
    gap = a - b
    gap = np.where(revolute, gap - TURN * np.round(gap / TURN), gap)
    return np.max(np.abs(gap), axis=-1) < 1e-6


ARMS = {
    "pendant": ("puma560", [(3, 2, -1.0, True)]),
    "wrist": ("puma560", [(5, 4, 1.0, True), (6, 5, -1.0, True), (6, 4, 0.0, True)][:2]),
    "chained": ("ur5e", [(3, 2, 1.0, True), (4, 3, 1.0, True)]),
    "slide": ("stanford", [(3, 2, 0.2, True)]),
}


@pytest.mark.parametrize("name", ARMS)
def test_solutions_are_those_of_the_joints_and_each_closes(name):
    base, couplings = ARMS[name]
    # A turn that moves a slide has limits: without them there is no end of the slide's values.
    limits = [[-np.pi, np.pi]] * 2 + [[-5.0, 5.0]] + [[-np.pi, np.pi]] * 3 if name == "slide" else None
    arm = coupled(robokin.load(base), couplings, limits)
    assert isinstance(arm, CoupledRobot)
    q = random_values(arm, np.random.default_rng(31), 12)
    T = robokin.forward_kinematics(arm, q)
    batch = robokin.solve_ik(arm, T)
    plain = robokin.solve_ik(arm.free_motion, T, limits=False)
    for i, result in enumerate(batch):
        assert len(result) == len(plain[i])
        assert result.complete == plain[i].complete
        found = np.array([solution.q for solution in result])
        assert np.max(np.abs(robokin.forward_kinematics(arm, found) - T[i])) < 1e-8
        assert same(found, q[i], arm.revolute).any()
        v = arm.drive.motions(found)
        for solution in plain[i]:
            assert same(v, solution.q, arm.free_motion.revolute).any()


def test_forward_kinematics_and_jacobian_are_those_of_what_the_variables_move():
    arm = coupled(robokin.load("puma560"), [(3, 2, -1.0, True), (6, 5, 13 / 72, True)])
    q = random_values(arm, np.random.default_rng(32), 5)
    v = q.copy()
    v[:, 2] = q[:, 2] - q[:, 1] + 0.1
    v[:, 5] = q[:, 5] + 13 / 72 * q[:, 4] + 0.1
    np.testing.assert_allclose(
        robokin.forward_kinematics(arm, q), robokin.forward_kinematics(arm.free_motion, v), atol=1e-15
    )
    J = robokin.jacobian(arm, q)
    for k in range(arm.n):
        step = np.zeros(arm.n)
        step[k] = 1e-6
        T0, T1 = robokin.forward_kinematics(arm, q - step), robokin.forward_kinematics(arm, q + step)
        np.testing.assert_allclose((T1[:, :3, 3] - T0[:, :3, 3]) / 2e-6, J[:, :3, k], atol=1e-8)


@pytest.mark.parametrize("ratio", [13 / 72, 0.5, -2.5])
def test_a_ratio_that_is_no_whole_number_gives_every_turn_within_the_limits(ratio):
    limits = np.tile([-1.5 * np.pi, 1.5 * np.pi], (6, 1))
    arm = coupled(robokin.load("puma560"), [(6, 5, ratio, True)], limits)
    q = random_values(arm, np.random.default_rng(33), 6)
    T = robokin.forward_kinematics(arm, q)
    for i, result in enumerate(robokin.solve_ik(arm, T)):
        found = np.array([solution.q for solution in result])
        assert all(arm.within_limits(found))
        assert same(found, q[i], arm.revolute).any()
        # Brute force: every posture of the joints, and every full turn of each joint by up to three.
        expected = []
        for solution in robokin.solve_ik(arm.free_motion, T[i], limits=False):
            for a in range(-3, 4):
                for b in range(-3, 4):
                    v = solution.q.copy()
                    v[4] += TURN * a
                    v[5] += TURN * b
                    u = arm.drive.variables_for(v)
                    rest = u[:4] - TURN * np.round(u[:4] / TURN)
                    u = np.append(rest, u[4:])
                    if arm.within_limits(u):
                        expected.append(u)
        assert all(same(found, u, arm.revolute).any() for u in expected)
        for u in found:
            assert same(np.array(expected), u, arm.revolute).any()


def test_both_boxes_count():
    limits = np.tile([-np.pi, np.pi], (6, 1))
    motion = limits.copy()
    motion[2] = np.radians([-60, 60])
    arm = coupled(robokin.load("puma560"), [(3, 2, -1.0, True)], limits, motion)
    q = random_values(arm, np.random.default_rng(34), 300)
    inside = arm.within_limits(q)
    assert 0 < np.count_nonzero(inside) < 150
    T = robokin.forward_kinematics(arm, q[inside][:12])
    for i, result in enumerate(robokin.solve_ik(arm, T)):
        found = np.array([solution.q for solution in result])
        assert same(found, q[inside][i], arm.revolute).any()
        assert all(np.abs(arm.drive.motions(found)[:, 2]) <= np.radians(60) + 1e-8)
    whole = robokin.solve_ik(arm, T, limits=False)
    assert all(whole.count >= robokin.solve_ik(arm, T).count)


def test_outside_the_limits_the_nearest_is_within():
    limits = np.radians([[-30, 30]] * 6)
    arm = coupled(robokin.load("puma560"), [(3, 2, -1.0, True)], limits)
    T = robokin.forward_kinematics(arm, np.radians([90, 0, 10, 0, 10, 0]))
    result = robokin.solve_ik(arm, T)
    assert not len(result)
    assert result.reason == "outside the joint limits"
    assert result.complete
    assert arm.within_limits(result.nearest.q)


def finger(limits=((-20, 20), (-45, 90), (0, 100), (0, 60)), ratio=2 / 3):
    rows = [
        Joint("abd", JointType.REVOLUTE, alpha=-np.pi / 2, limits=tuple(np.radians(limits[0]))),
        Joint("mcp", JointType.REVOLUTE, a=0.046, limits=tuple(np.radians(limits[1]))),
        Joint("pip", JointType.REVOLUTE, a=0.027, limits=tuple(np.radians(limits[2]))),
        Joint("dip", JointType.REVOLUTE, a=0.018, limits=tuple(np.radians(limits[3]))),
    ]
    return driven({"name": "finger", "rows": tuple(rows)}, (Coupling("dip", (("pip", ratio),)),))


def test_a_finger_reaches_what_it_reaches_and_says_that_there_may_be_more():
    arm = finger()
    # The follower's 60° leave 90° of the 100°.
    np.testing.assert_allclose(np.degrees(arm.limits[2]), [0, 90])
    q = random_values(arm, np.random.default_rng(35), 40)
    T = robokin.forward_kinematics(arm, q)
    batch = robokin.solve_ik(arm, T, task="position")
    assert np.all(batch.count > 0)
    assert not batch.complete
    for i, result in enumerate(batch):
        assert same(np.array([solution.q for solution in result]), q[i], arm.revolute).any()
        assert all(arm.within_limits(solution.q) for solution in result)
        assert not result.complete and result.basis is None


def test_round_and_degenerate_poses_of_a_finger():
    arm = finger()
    q = np.radians([[0, 0, 0], [0, 90, 90], [20, -45, 0], [0, 0, 90], [-20, 45, 45]])
    T = robokin.forward_kinematics(arm, q)
    batch = robokin.solve_ik(arm, T, task="position")
    assert np.all(batch.count > 0)
    far = T.copy()
    far[:, :3, 3] *= 3.0
    for result in robokin.solve_ik(arm, far, task="position"):
        assert not len(result)
        assert not result.complete
        assert result.nearest is not None


def test_helical_rows_turn_and_slide():
    pitch = 0.02 / TURN
    rows = (
        Joint("a", JointType.REVOLUTE, a=0.3),
        Joint("b", JointType.REVOLUTE, a=0.25, alpha=np.pi),
        Joint("screw", JointType.REVOLUTE, d=0.05, offset=0.4, limits=(0.0, 20 * np.pi), pitch=pitch),
    )
    arm = driven({"name": "screw", "rows": rows}, ())
    assert isinstance(arm, CoupledRobot)
    q = np.array([0.2, 0.3, 5.0])
    T = robokin.forward_kinematics(arm, q)
    # d is where it stands at q = 0: d + pitch q below.
    assert T[2, 3] == pytest.approx(-(0.05 + pitch * 5.0), abs=1e-15)
    angle = np.arctan2(T[1, 0], T[0, 0])
    assert np.cos(angle - (0.2 + 0.3 - (5.0 + 0.4))) == pytest.approx(1.0)
    assert same(robokin.solve_ik(arm, T).solutions[0].q, q, np.array([True, True, False]))
    with pytest.raises(robokin.InputError, match="CoupledRobot"):
        Robot("screw", rows)


def test_turns_that_no_list_holds_are_refused():
    limits = np.tile([-400 * np.pi, 400 * np.pi], (6, 1))
    arm = coupled(robokin.load("puma560"), [(6, 5, 13 / 72, True)], limits)
    T = robokin.forward_kinematics(arm, np.full(6, 0.3))
    with pytest.raises(robokin.InputError, match="allow more than 10000 turns"):
        robokin.solve_ik(arm, T)


def test_near_is_at_the_head_and_each_angle_is_turned_next_to_it():
    limits = np.tile([-2.5 * np.pi, 2.5 * np.pi], (6, 1))
    limits[3] = -np.inf, np.inf
    arm = coupled(robokin.load("puma560"), [(3, 2, -1.0, True), (6, 5, 0.5, True)], limits)
    for near in np.random.default_rng(36).uniform(-7.0, 7.0, (6, 6)):
        T = robokin.forward_kinematics(arm, near)
        for counting in (True, False):
            result = robokin.solve_ik(arm, T, counting, near=near)
            np.testing.assert_allclose(result[0].q, near, atol=1e-7)
            moves = [np.max(np.abs(solution.q - near)) for solution in result]
            assert moves == sorted(moves)


def test_joints_to_spare_are_listed_within_the_limits_and_near_is_one_of_them():
    limits = np.radians([[-170, 170], [-120, 120]] * 3 + [[-175, 175]])
    motion = np.tile(FREE, (7, 1))
    motion[3] = np.radians([-70, -55])
    arm = coupled(robokin.load("iiwa14"), [(4, 2, -1.0, True)], limits, motion)
    q = random_values(arm, np.random.default_rng(37), 200)
    q = q[arm.within_limits(q)][:2]
    for i, T in enumerate(robokin.forward_kinematics(arm, q)):
        near = robokin.solve_ik(arm, T, near=q[i])
        np.testing.assert_allclose(near[0].q, q[i], atol=1e-7)
        many = robokin.solve_ik(arm, T, most=24)
        assert len(many) > 16
        found = np.array([solution.q for solution in many])
        assert np.all(arm.within_limits(found))
        assert np.max(np.abs(robokin.forward_kinematics(arm, found) - T)) < 1e-8


@pytest.mark.parametrize("couplings", [[(2, 1, 0.05, True)], [(3, 2, 18.0, True)],
                                       [(2, 1, 0.05, True), (3, 2, 18.0, True)]])  # fmt: skip
@pytest.mark.parametrize("bounded", [False, True])
def test_slides_without_limits_that_turn_with_joints(couplings, bounded):
    rows = (
        Joint("j1", JointType.REVOLUTE, a=0.3),
        Joint("j2", JointType.PRISMATIC),
        Joint("j3", JointType.REVOLUTE, a=0.2),
    )
    limits = [FREE, (-1.0, 1.0) if bounded else FREE, FREE]
    arm = coupled(Robot("three", rows), couplings, limits)
    for q in np.random.default_rng(38).uniform(-0.9, 0.9, (4, 3)):
        T = robokin.forward_kinematics(arm, q)
        for counting in (True, False):
            for turns in (True, False) if counting else (False,):
                result = robokin.solve_ik(arm, T, counting, task="position", turns=turns)
                found = np.array([solution.q for solution in result])
                assert len(found) == 2
                assert np.max(np.abs(robokin.forward_kinematics(arm, found)[:, :3, 3] - T[:3, 3])) < 1e-9
                assert np.all(np.abs(found[:, [0, 2]]) <= np.pi)
                # A turn of the first joint brings another slide: of these there is no end.
                assert result.complete == (couplings[0][0] != 2)


def test_without_limits_a_ratio_has_no_end_of_turns():
    # 13 to 72: after each full turn of the fifth joint's drive the sixth's is elsewhere.
    limits = np.tile([-np.pi, np.pi], (6, 1))
    arm = coupled(robokin.load("puma560"), [(6, 5, 13 / 72, True)], limits)
    T = robokin.forward_kinematics(arm, np.full(6, 0.3))
    assert robokin.solve_ik(arm, T).complete
    free = robokin.solve_ik(arm, T, limits=False)
    assert not free.complete
    assert free.basis is None


def spare(limits=FREE):
    """Two joints of a plane, one of which three variables move through two others."""
    rows = tuple(Joint(f"j{i}", JointType.REVOLUTE, a=0.3, limits=limits) for i in (1, 2))
    coupling = Coupling("j2", (("x", 2.0), ("y", 1.0)))
    fields = {"name": "spare", "rows": rows}
    own = [Joint(name, JointType.REVOLUTE, limits=limits) for name in ("j1", "x", "y")]
    S = np.array([[1.0, 0.0, 0.0], [0.0, 2.0, 1.0]])
    return CoupledRobot(**fields, drive=drive_of(rows, own, S, np.zeros(2), (coupling,)))


def test_of_infinitely_many_postures_some_are_listed_far_from_each_other():
    arm = spare((-1.5, 1.5))
    T = robokin.forward_kinematics(arm, [0.2, 0.3, 0.4])
    found = robokin.solve_ik(arm, T)
    assert len(found) == 16 and not found.complete
    assert found.certificate == "some of infinitely many, far from each other"
    q = np.array([one.q for one in found])
    gaps = np.max(np.abs(q[:, None] - q), axis=2)[~np.eye(16, dtype=bool)]
    assert gaps.min() > 0.05
    assert all(arm.within_limits(q)) and np.allclose(robokin.forward_kinematics(arm, q), T, atol=1e-8)
    assert [len(robokin.solve_ik(arm, T, most=most)) for most in (1, 5)] == [1, 5]
    near = robokin.solve_ik(arm, T, near=[0.2, 0.35, 0.3])
    assert np.max(np.abs(near[0].q - [0.2, 0.35, 0.3])) < 0.03
    moves = [np.max(np.abs(one.q - [0.2, 0.35, 0.3])) for one in near]
    assert moves == sorted(moves)


def test_a_finger_has_no_self_motion_and_all_that_is_found_is_listed():
    arm = finger()
    found = robokin.solve_ik(arm, robokin.forward_kinematics(arm, [0.1, 0.2, 0.3]), task="position")
    assert found.certificate == "fewer freedoms than joints that move: found by search, which proves nothing"


def test_more_variables_than_joints_place_a_point_as_the_joints_do():
    arm = spare()
    assert motion_task(arm).name == "position"
    T = robokin.forward_kinematics(arm, [0.4, 0.3, 0.4])
    assert robokin.follow_line(arm, [0.2, 0.3, 0.4], T, 10).complete
    assert about_inverse(arm)[1].startswith("more variables than joints that they move")
