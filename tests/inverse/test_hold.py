"""Joints held: the rest is an arm of its own, every solution of it is found, and it is put back into the whole."""

from __future__ import annotations

import copy
import gc
import pickle
import weakref
from collections import OrderedDict

import numpy as np
import pytest
from sweeps import sweep

import robokin
from robokin.errors import InputError
from robokin.inverse import hold
from robokin.inverse.hold import KEPT, held_arm, with_held_joints
from robokin.inverse.solutions import Arc, BatchResult, Family, Result, Solution
from robokin.inverse.verify import wrapped

ROBOTS = ["panda", "iiwa14", "puma560", "stanford", "scara", "scara-frames", "puma560-craig", "planar3r"]
"""Revolute and prismatic joints, in each convention; puma560-craig and panda have modified tables."""


def drawn(robot, rng, count):
    """Random configurations (count, n) within the limits, or a turn and a metre."""
    reach = np.where(robot.revolute, np.pi, 1.0)
    low = np.maximum(robot.limits[:, 0], -reach)
    high = np.minimum(robot.limits[:, 1], reach)
    return low + (high - low) * rng.random((count, robot.n))


@pytest.mark.parametrize("name", ROBOTS)
def test_the_part_moves_as_the_whole_does(name, rng):
    robot = robokin.load(name)
    for q in drawn(robot, rng, 6):
        count = int(rng.integers(1, robot.n))
        hold = {int(i): float(q[i]) for i in rng.permutation(robot.n)[:count]}
        arm = held_arm(robot, hold)
        T = robokin.forward_kinematics(robot, q)
        assert np.allclose(robokin.forward_kinematics(arm.part, arm.own(q)), T, rtol=0, atol=1e-12)
        assert np.array_equal(arm.whole(arm.own(q)), q)
        assert np.array_equal(arm.part.limits, robot.limits[arm.free])


@pytest.mark.parametrize(
    ("name", "joint"), sweep([("panda", 2), ("panda", 6), ("iiwa14", 2), ("puma560", 0), ("scara", 2)], 3)
)
def test_every_branch_at_the_held_value(name, joint, rng):
    robot = robokin.load(name)
    for q in drawn(robot, rng, 8):
        T = robokin.forward_kinematics(robot, q)
        result = robokin.solve_ik(robot, T, hold={joint: q[joint]})
        found = np.array([solution.q for solution in result.solutions])
        assert np.all(found[:, joint] == q[joint])
        assert np.min(np.max(np.abs(wrapped(found - q, robot.revolute)), axis=1)) < 1e-6
        for solution in result.solutions:
            assert np.allclose(robokin.forward_kinematics(robot, solution.q), T, rtol=0, atol=1e-8)
            assert robot.within_limits(solution.q) == solution.within_limits is True


def test_a_redundant_arm_has_all_of_them_where_its_wrist_and_shoulder_are_spherical(rng):
    """A 7R arm of two spherical joints and an elbow between has 2 · 2 · 2 postures at a value of its third joint
    (M. Shimizu et al., Analytical inverse kinematic computation for 7-DOF redundant manipulators with joint limits,
    IEEE T-RO 24(5), 2008: by the arm angle); those of its shoulder are fixed by q3, up to q2's sign."""
    robot = robokin.load("iiwa14")
    counts = []
    for q in drawn(robot, rng, 8):
        T = robokin.forward_kinematics(robot, q)
        result = robokin.solve_ik(robot, T, limits=False, hold={2: q[2]})
        assert result.complete
        assert all(solution.free == () for solution in result.solutions)
        counts.append(len(result.solutions))
    assert set(counts) <= {4, 8}
    assert 8 in counts


@pytest.mark.slow
def test_names_and_numbers_are_the_whole_robot_s():
    robot = robokin.load("puma560")
    q = np.radians([10.0, -30.0, 120.0, 20.0, 40.0, 50.0])
    T = robokin.forward_kinematics(robot, q)
    everything = {solution.branch: solution for solution in robokin.solve_ik(robot, T).solutions}
    held = robokin.solve_ik(robot, T, hold={0: q[0]})
    assert held.solutions
    for solution in held.solutions:
        assert np.allclose(everything[solution.branch].q, solution.q, atol=1e-7)
    # With q1 held the wrist's self-motion is that of q4 and q6 as before, not of the part's own joints 3 and 5.
    straight = np.radians([10.0, -30.0, 120.0, 20.0, 0.0, 50.0])
    T = robokin.forward_kinematics(robot, straight)
    free = {solution.free for solution in robokin.solve_ik(robot, T, hold={0: straight[0]}).solutions}
    assert (4, 6) in free


def test_single_and_batch_say_the_same(rng):
    robot = robokin.load("panda")
    q = drawn(robot, rng, 5)
    q[:, 2] = 0.3
    T = robokin.forward_kinematics(robot, q)
    T[3, :3, 3] = [3.0, 0.0, 0.0]
    batch = robokin.solve_ik(robot, T, hold={2: 0.3})
    assert batch.q.shape == (5, batch.count.max(), 7)
    assert np.array_equal(np.isnan(batch.q[..., 2]), np.isnan(batch.q[..., 0]))
    names = iter(batch.branches())
    for i, count in enumerate(batch.count.tolist()):
        single = robokin.solve_ik(robot, T[i], hold={2: 0.3})
        assert [s.branch for s in single.solutions] == [next(names) for _ in range(count)]
        assert len(single.solutions) == count
        for k, solution in enumerate(single.solutions):
            assert np.allclose(batch.q[i, k], solution.q, atol=1e-9)
            assert batch.within_limits[i, k]
    none = batch[3]
    assert (none.solutions, none.reason) == ((), "out of reach")
    assert none.nearest.q[2] == 0.3
    off = np.linalg.norm(robokin.forward_kinematics(robot, none.nearest.q)[:3, 3] - T[3, :3, 3])
    assert off == pytest.approx(none.nearest.position_error, rel=1e-9)


def test_near_orders_what_is_left(rng):
    robot = robokin.load("iiwa14")
    q = drawn(robot, rng, 1)[0]
    T = robokin.forward_kinematics(robot, q)
    result = robokin.solve_ik(robot, T, near=q, hold={2: q[2]})
    moves = [np.max(np.abs(solution.q - q)) for solution in result.solutions]
    assert moves[0] < 1e-6
    assert moves == sorted(moves)


def test_a_held_value_outside_the_limits():
    robot = robokin.load("puma560")
    low, high = np.degrees(robot.limits[3])
    T = robokin.forward_kinematics(robot, np.radians([10.0, -30.0, 120.0, high + 10.0, 40.0, 50.0]))
    value = np.radians(high + 10.0)
    with pytest.raises(InputError, match=r"q4 is held at 3\.1.* outside its limits; expected .* limits=False"):
        robokin.solve_ik(robot, T, hold={3: value})
    result = robokin.solve_ik(robot, T, limits=False, hold={3: value})
    assert result.solutions
    assert not any(solution.within_limits for solution in result.solutions)
    assert not robokin.solve_ik(robot, T[None], limits=False, hold={3: value}).within_limits.any()
    assert robokin.solve_ik(robot, T, hold={3: robot.limits[3, 1]}).nearest is not None  # inclusive
    assert low < 0.0


@pytest.mark.parametrize(
    ("hold", "words"),
    [
        ({7: 0.0}, "joint 7, expected 0 to 6"),
        ({-1: 0.0}, "joint -1, expected 0 to 6"),
        ({"q3": 0.0}, "joint 'q3'"),
        ({True: 0.0}, "joint True"),
        ({2: np.nan}, "finite"),
        ({2: True}, "finite"),
        ({2: "1.0"}, "finite"),
        ({2: "a"}, "finite"),
        ({2: None}, "finite"),
        (dict.fromkeys(range(7), 0.0), "all 7 joints"),
    ],
)
def test_what_cannot_be_held(hold, words):
    robot = robokin.load("panda")
    T = robokin.forward_kinematics(robot, np.full(7, 0.3))
    with pytest.raises(InputError, match=words):
        robokin.solve_ik(robot, T, limits=False, hold=hold)


@pytest.mark.parametrize("slip", [{True: 0.3}, {1.0: 0.3}, {np.float64(1.0): 0.3}, {1: 0.3 + 0j}], ids=str)
def test_what_equals_a_joint_that_was_held_is_looked_at(slip):
    robot = robokin.load("iiwa14")
    T = robokin.forward_kinematics(robot, np.full(7, 0.3))
    for _ in range(3):
        assert robokin.solve_ik(robot, T, hold={1: 0.3}).solutions
    with pytest.raises(InputError, match="hold"):
        robokin.solve_ik(robot, T, hold=slip)


@pytest.mark.parametrize("joint", [2, 6])
def test_an_answer_is_that_of_what_was_held_when_it_was_asked(joint):
    robot = robokin.load("panda")
    T = robokin.forward_kinematics(robot, [0.3, 0.3, 0.3, -1.5, 0.3, 1.5, 0.3])
    known = robokin.solve_ik(robot, T, hold={joint: 0.3}, near=np.zeros(7))  # not the way of plain calls
    for value in (0.3, np.float64(0.3), 0.3):
        asked, pose = {joint: value}, T.copy()
        answer = robokin.solve_ik(robot, pose, hold=asked)
        asked[joint], pose[:] = 0.9, 0.0
        assert answer.question.hold == {joint: 0.3}
        assert np.array_equal(answer.question.T, T)
        assert {tuple(one.q) for one in answer} == {tuple(one.q) for one in known}
        assert all(one.q[joint] == 0.3 for one in answer)


def test_near_is_checked_against_the_whole_robot():
    robot = robokin.load("panda")
    T = robokin.forward_kinematics(robot, np.full(7, 0.3))
    with pytest.raises(InputError, match=r"near: found an array of shape \(6,\), expected 7 values"):
        robokin.solve_ik(robot, T, near=np.zeros(6), hold={2: 0.3})


def test_a_held_value_that_lines_two_axes_up(rng):
    """With q6 = 0 the axes of q5 and q7 lie on one line: a self-motion of the part, and no warning from its names."""
    robot = robokin.load("iiwa14")
    q = drawn(robot, rng, 1)[0]
    q[5] = 0.0
    result = robokin.solve_ik(robot, robokin.forward_kinematics(robot, q), hold={5: 0.0})
    assert result.solutions
    assert {5, 7} <= {joint for solution in result.solutions for joint in solution.free}
    assert not result.complete or result.families


def test_nothing_held_is_the_whole_robot():
    robot = robokin.load("puma560")
    T = robokin.forward_kinematics(robot, np.radians([10.0, -30.0, 120.0, 20.0, 40.0, 50.0]))
    plain, empty = robokin.solve_ik(robot, T), robokin.solve_ik(robot, T, hold={})
    assert all(np.array_equal(a.q, b.q) for a, b in zip(plain.solutions, empty.solutions, strict=True))


def test_held_arms_are_kept_but_not_for_ever():
    robot = robokin.load("panda")
    first = held_arm(robot, {2: 0.5})
    assert held_arm(robot, {2: np.float64(0.5)}) is first
    gone = weakref.ref(first.part)
    for k in range(KEPT):
        held_arm(robot, {2: 0.01 * k})
    del first
    gc.collect()
    assert gone() is None


class LetGo(OrderedDict):
    """Arms that another thread lets go of as soon as one is found."""

    def get(self, key, default=None):
        found = super().get(key, default)
        self.clear()
        return found


def test_an_arm_that_is_let_go_of_meanwhile_is_given_all_the_same(monkeypatch):
    robot = robokin.load("panda")
    kept = LetGo()
    monkeypatch.setattr(hold, "_held_arms", lambda robot: kept)
    first = held_arm(robot, {2: 0.5})
    assert held_arm(robot, {2: 0.5}) is first
    assert held_arm(robot, {2: 0.5}).part.n == 6


@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy, lambda arm: pickle.loads(pickle.dumps(arm))])
def test_held_arms_are_copied_and_pickled_whatever_is_known_of_them(copied):
    robot = robokin.load("panda")
    for value in (0.1, 0.2, 0.3):
        arm = held_arm(robot, {2: value})
        T = robokin.forward_kinematics(robot, [0.1, 0.2, value, -1.5, 0.1, 1.5, 0.2])
        assert robokin.solve_ik(robot, T, hold={2: value})
        again = copied(arm)
        assert np.array_equal(again.part.limits, arm.part.limits)
        assert np.array_equal(again.whole(np.arange(6.0)), arm.whole(np.arange(6.0)))


def test_the_order_of_what_is_held_does_not_matter():
    robot = robokin.load("panda")
    assert held_arm(robot, {2: 0.1, 4: 0.2}) is held_arm(robot, {4: 0.2, 2: 0.1})


def test_self_motions_are_given_in_the_whole_robot_s_joints():
    robot = robokin.load("panda")
    arm = held_arm(robot, {2: 0.3})
    q = np.array([[0.1, 0.2, -2.0, 0.4, 0.0, 0.5], [0.1, 0.2, -2.0, 0.7, 0.0, 0.2]])
    solution = Solution(q[0], "", True, 0.0, 0.0, (4, 6))
    family = Family((4, 6), 1, True, (Arc(q),), 0)
    result = Result((solution,), True, "elimination", families=(family,), basis="accounted", certificate="all")
    one = np.zeros((1, 1))
    batch = BatchResult(
        q[None, :1], np.array([1]), one, one, one == 0.0, True, "elimination", lambda i: result, lambda: [""],
        lambda i: None,
    )  # fmt: skip
    whole = with_held_joints(robot, arm, batch)[0]
    assert whole.solutions[0].free == (5, 7)
    assert whole.families[0].joints == (5, 7)
    (arc,) = whole.families[0].arcs
    assert np.array_equal(arc.q, [[0.1, 0.2, 0.3, -2.0, 0.4, 0.0, 0.5], [0.1, 0.2, 0.3, -2.0, 0.7, 0.0, 0.2]])
    assert (whole.complete, whole.basis, whole.certificate) == (True, "accounted", "all")
