"""Where solutions form a continuum: which are listed, what is said to be free, and what stands for a family."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from sweeps import sweep

import robokin
from robokin.inverse.self_motion.spread import well_spread
from robokin.inverse.solve import solve_many
from robokin.model import Joint, JointType, Robot
from robokin.spatial import transform

TURN = 2 * np.pi
RIGHT = np.pi / 2

REDUNDANT = [
    ("panda", "pose"),
    ("iiwa14", "pose"),
    ("human-arm", "pose"),
    ("human-body", "pose"),
    ("panda", "approach"),
    ("puma560", "position"),
    ("ur5e", "position"),
    ("planar3r", "position"),
]

IDLE = [
    ("scorbot", "approach", 5),
    ("puma560", "approach", 6),
    ("ur5e", "approach", 6),
    ("stanford", "approach", 6),
    ("scara", "approach", 4),
    ("scara", "position", 4),
    ("spherical-wrist", "approach", 3),
]


def values(robot, rng, count):
    low, high = np.where(np.isinf(robot.limits), [-2.0, 2.0], robot.limits).T
    return rng.uniform(low, high, (count, robot.n))


def distances(robot, a, b):
    """(k, l) the greatest joint difference of (k, n) and (l, n), on the circle; lengths in metres."""
    gap = np.abs(a[:, None] - b[None]) % np.where(robot.revolute, TURN, np.inf)
    return np.max(np.where(robot.revolute, np.minimum(gap, TURN - gap), gap), axis=2)


def least(D):
    return float(np.min(D[np.triu_indices(len(D), 1)], initial=np.inf))


def listed(robot, T, **arguments):
    return np.array([solution.q for solution in robokin.solve_ik(robot, T, **arguments).solutions])


# The choice ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("most", [2, 3, 5])
def test_the_choice_is_at_least_half_as_well_spread_as_the_best(most, rng):
    revolute = np.array([True, True, False])
    for _ in range(15):
        x = rng.uniform(-np.pi, np.pi, (10, 3))
        chosen = well_spread(np.zeros(10, dtype=int), x, revolute, rng.random(10), np.ones(10, dtype=bool), most)
        gap = np.abs(x[:, None] - x[None])
        D = np.max(np.where(revolute, np.minimum(gap, TURN - gap), gap), axis=2)
        best = max(least(D[np.ix_(some, some)]) for some in combinations(range(10), most))
        assert least(D[np.ix_(chosen, chosen)]) >= 0.5 * best - 1e-6


def test_many_targets_are_chosen_from_as_each_alone(rng):
    index = np.sort(rng.integers(0, 300, 5000))
    x, move, inside = rng.uniform(-3, 3, (5000, 4)), rng.random(5000), rng.random(5000) < 0.3
    revolute = np.array([True, False, True, True])
    together = well_spread(index, x, revolute, move, inside, 6)
    alone = [
        rows[well_spread(np.zeros(len(rows), dtype=int), x[rows], revolute, move[rows], inside[rows], 6)]
        for rows in (np.flatnonzero(index == i) for i in np.unique(index))
    ]
    assert np.array_equal(together, np.concatenate(alone))
    for rows, whole in zip(alone, (np.flatnonzero(index == i) for i in np.unique(index)), strict=True):
        assert len(set(rows.tolist())) == len(rows) == min(6, len(whole))
        # Within the limits first, and the first of all the one of the least move.
        assert not np.any(np.diff(inside[rows].astype(int)) > 0)
        assert inside[rows].sum() == min(6, inside[whole].sum())
        best = whole[inside[whole]] if inside[whole].any() else whole
        assert rows[0] == best[np.argmin(move[best])]


@pytest.mark.parametrize(("name", "task"), sweep(REDUNDANT, 4))
def test_what_is_listed_of_infinitely_many_is_well_spread(name, task, rng):
    robot = robokin.load(name)
    for q in values(robot, rng, 3):
        T = robokin.forward_kinematics(robot, q)
        every = listed(robot, T, task=task, most=10**6)
        few = listed(robot, T, task=task)
        assert len(few) == min(16, len(every))
        assert np.array_equal(few, every[: len(few)])  # fewer are the first of more
        assert np.array_equal(listed(robot, T, task=task, most=3), few[:3])
        if robot.revolute.all():
            # What is not listed is nearer to something listed than those are to each other.
            closest = np.min(distances(robot, every, few), axis=1)
            assert np.max(closest) <= least(distances(robot, few, few)) + 1e-6
            chance = [rng.choice(len(every), len(few), replace=False) for _ in range(20)]
            random = [least(distances(robot, every[rows], every[rows])) for rows in chance]
            assert least(distances(robot, few, few)) >= np.max(random) - 1e-6


@pytest.mark.parametrize(("name", "task"), sweep(REDUNDANT, 3))
def test_the_nearest_comes_first(name, task, rng):
    robot = robokin.load(name)
    q = values(robot, rng, 1)[0]
    near = q + rng.uniform(-0.05, 0.05, robot.n)
    T = robokin.forward_kinematics(robot, q)
    every = listed(robot, T, task=task, near=near, most=10**6)
    few = listed(robot, T, task=task, near=near)
    moves = np.max(np.abs(few - near), axis=1)
    assert np.array_equal(moves, np.sort(moves)) or not robot.revolute.all()
    assert np.array_equal(few[0], every[0])
    assert np.array_equal(listed(robot, T, task=task, near=near, most=1)[0], few[0])


# Free joints --------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "task"), [("panda", "pose"), ("iiwa14", "pose"), ("human-arm", "pose")])
def test_the_joints_of_a_self_motion_are_those_that_others_can_make_up_for(name, task, rng):
    robot = robokin.load(name)
    T = robokin.forward_kinematics(robot, values(robot, rng, 1)[0])
    for solution in robokin.solve_ik(robot, T, task=task).solutions:
        J = robokin.jacobian(robot, solution.q)
        free = [
            i + 1
            for i in range(robot.n)
            if np.linalg.matrix_rank(np.delete(J, i, axis=1), 1e-6) == np.linalg.matrix_rank(J, 1e-6)
        ]
        assert list(solution.free) == free


def attains(robot, q, T, task):
    found = robokin.forward_kinematics(robot, q)
    rows = {"approach": (slice(0, 3), slice(2, 4)), "position": (slice(0, 3), slice(3, 4))}[task]
    return np.allclose(found[rows], T[rows], rtol=0, atol=1e-7)


@pytest.mark.parametrize(("name", "task", "joint"), IDLE)
@pytest.mark.parametrize("numeric", sweep([False, True], 2))
def test_a_joint_that_only_moves_what_is_left_open_is_held(name, task, joint, numeric, rng):
    robot = robokin.load(name)
    rest = [i for i in range(robot.n) if i != joint - 1]
    method = "numeric" if numeric else "auto"
    for q in values(robot, rng, 1 if numeric else 5):
        T = robokin.forward_kinematics(robot, q)
        result = robokin.solve_ik(robot, T, task=task, method=method)
        found = np.array([solution.q for solution in result.solutions])
        assert (result.complete, result.postures) == (False, not numeric)
        assert {solution.free for solution in result.solutions} == {(joint,)}
        assert np.all(found[:, joint - 1] == 0.0)
        # Each posture once, the one that made the target among them, and the joint is free indeed.
        assert least(distances(robot, found, found)) > 1e-5
        if not numeric:
            gap = distances(robot, np.where(np.arange(robot.n) == joint - 1, 0.0, q)[None], found)
            assert np.min(gap) < 1e-6
        for values_of_one in found:
            turned = values_of_one.copy()
            turned[joint - 1] = rng.uniform(-3, 3)
            assert attains(robot, turned, T, task)
        near = q + rng.uniform(-0.2, 0.2, robot.n)
        held = listed(robot, T, task=task, near=near, method=method, limits=False)
        turns = (held[:, joint - 1] - near[joint - 1]) / TURN
        assert np.allclose(turns, np.round(turns), rtol=0, atol=1e-12)
        alike = listed(robot, T, task=task, method=method, limits=False)
        if not numeric:
            D = distances(robot, held * np.isin(np.arange(robot.n), rest), alike * np.isin(np.arange(robot.n), rest))
            assert D.shape[0] == D.shape[1]
            assert np.max(np.min(D, axis=1)) < 1e-6


def test_that_none_is_listed_is_complete():
    result = robokin.solve_ik(robokin.load("puma560"), transform(np.eye(3), [3.0, 0, 0]), task="approach")
    assert (result.reachable, result.complete, result.reason) == (False, True, "out of reach")


def test_a_free_joint_without_zero_among_its_limits_is_held_amid_them(rng):
    rows = [Joint("1", JointType.REVOLUTE, a=1.0), Joint("2", JointType.REVOLUTE, a=0.7)]
    robot = Robot("arm", (*rows, Joint("3", JointType.REVOLUTE, limits=(0.5, 1.5))))
    T = robokin.forward_kinematics(robot, [0.3, 0.4, 1.0])
    for task in ("position", "approach"):
        found = listed(robot, T, task=task)
        assert len(found) == 2
        assert np.all(found[:, 2] == 1.0)
        assert np.all(listed(robot, T, task=task, near=[0, 0, 9.0])[:, 2] == 1.5)


def test_an_arm_all_of_whose_joints_are_free_has_one_posture():
    turns = [Joint(str(i), JointType.REVOLUTE, alpha=alpha) for i, alpha in enumerate((RIGHT, -RIGHT, 0.0))]
    for joints, task in ((turns, "position"), (turns[2:], "approach"), (turns[2:] * 2, "approach")):
        arm = Robot("turner", tuple(joints))
        (solution,) = robokin.solve_ik(arm, np.eye(4), task=task).solutions
        assert solution.free == tuple(range(1, arm.n + 1))
        assert not solution.q.any()


# Self-motions of singular poses ---------------------------------------------------------------------------


def with_a_wrist(rng, first, tilt, opposed):
    """Six revolute joints, first to first + 2 of which meet, the outer two at the same tilt to the middle one."""
    rows = []
    for i in range(6):
        a, d = rng.uniform(0.2, 1.0, 2)
        alpha = rng.uniform(0.5, 2.5)
        if i in (first, first + 1):
            a, alpha = 0.0, tilt if i == first or not opposed else np.pi - tilt
        if i == first + 1:
            d = 0.0
        rows.append(Joint(str(i), JointType.REVOLUTE, a=a, d=d, alpha=alpha))
    return Robot("wrist", tuple(rows))


def assert_nearest_on_line(robot, q, middle, near, target):
    """No other member of a straight wrist's self-motion is nearer, by the greatest joint move."""
    along = np.tile(q, (2001, 1))
    s = np.linspace(-np.pi, np.pi, 2001)
    along[:, middle - 1] += s
    along[:, middle + 1] -= s
    if np.max(np.abs(robokin.forward_kinematics(robot, along) - target)) > 1e-6:
        along[:, middle + 1] += 2 * s
    np.testing.assert_allclose(
        robokin.forward_kinematics(robot, along), np.broadcast_to(target, (2001, 4, 4)), atol=1e-7
    )
    assert distances(robot, q[None], near[None])[0, 0] <= np.min(distances(robot, along, near[None])) + 1e-9


def assert_one_stands_for_a_family(robot, q, middle, held=0.0, exact=1e-12, **arguments):
    """Each family of joints middle - 1 and middle + 1, from 0, once: exactly where it is, and no other touched."""
    T = robokin.forward_kinematics(robot, q)
    result = solve_many(robot, T, limits=False, **arguments)
    others = [i for i in range(robot.n) if not middle - 1 <= i <= middle + 1]
    hits = 0
    for i, target in enumerate(T):
        solutions = result[i].solutions
        found = np.array([solution.q for solution in solutions])
        assert np.allclose(robokin.forward_kinematics(robot, found), target, rtol=0, atol=1e-8)
        assert least(distances(robot, found, found)) > 1e-6
        families = [solution.q for solution in solutions if {middle, middle + 2} <= set(solution.free)]
        for values_of_one in families:
            assert abs(np.sin(values_of_one[middle] - q[i, middle])) < exact
            if "near" in arguments:
                assert_nearest_on_line(robot, values_of_one, middle, arguments["near"], target)
            elif exact < 1e-9:
                assert abs(np.sin((values_of_one[middle - 1] - held) / 2)) < 1e-12
        kept = [np.r_[np.sin(x[others]), np.cos(x[others]), np.sin(x[middle])] for x in families]
        assert all(np.max(np.abs(a - b)) > 1e-5 for a, b in combinations(kept, 2))
        own = np.r_[np.sin(q[i, others]), np.cos(q[i, others]), np.sin(q[i, middle])]
        hits += any(np.max(np.abs(own - x)) < 1e-4 for x in kept)
    assert hits >= 0.99 * len(q)


@pytest.mark.parametrize("name", sweep(["puma560", "stanford", "irb140"], 3))
@pytest.mark.parametrize("middle", [0.0, np.pi])
def test_one_stands_for_the_family_of_a_wrist(name, middle, rng):
    robot = robokin.load(name)
    q = values(robot, rng, 20)
    q[:, 4] = middle
    assert_one_stands_for_a_family(robot, q, 4)
    near = values(robot, rng, 1)[0]
    assert_one_stands_for_a_family(robot, q, 4, near=near)


def test_one_stands_for_the_family_of_a_wrist_on_a_straight_elbow(rng):
    q = rng.uniform(-3, 3, (20, 6))
    q[:, 2], q[:, 4] = np.arctan2(433.07, -20.32), 0.0
    # The elbow is a double root, which has half of the digits, and a set of those is not made exact.
    assert_one_stands_for_a_family(robokin.load("puma560"), q, 4, exact=1e-7)


@pytest.mark.parametrize("first", sweep([0, 1, 2, 3], 2))
@pytest.mark.parametrize("opposed", sweep([False, True], 2))
def test_one_stands_for_the_family_of_any_wrist(first, opposed, rng):
    robot = with_a_wrist(rng, first, 1.1, opposed)
    q = rng.uniform(-3, 3, (12, 6))
    q[:, first + 1] = 0.0 if opposed else np.pi
    assert_one_stands_for_a_family(robot, q, first + 1)


@pytest.mark.parametrize("name", sweep(["puma560", "stanford", "irb140"], 3))
def test_the_one_keeps_to_the_limits(name, rng):
    robot = robokin.load(name)
    q = values(robot, rng, 40)
    q[:, 4] = 0.0
    q[:, 5] = np.clip(np.where(rng.random(40) < 0.5, -9.0, 9.0), *robot.limits[5])
    T = robokin.forward_kinematics(robot, q)
    result = solve_many(robot, T)
    for i in range(len(q)):
        assert any({4, 6} <= set(solution.free) for solution in result[i].solutions)


def test_an_arm_of_five_joints_that_looks_straight_down(rng):
    """There the six joints of its solver, one of them virtual, have a self-motion that the arm has not."""
    robot = robokin.load("scorbot")
    q = rng.uniform(-1.5, 1.5, (40, 5))
    q[:, 4] = np.where(rng.random(40) < 0.5, q[:, 0] + rng.integers(-1, 2, 40) * RIGHT, q[:, 4])
    tilt = robokin.forward_kinematics(robot, [0.0, 0.0, 0.0, 0.0, 0.0])[:3, 2]
    down = np.arctan2(-tilt[2], tilt[0])
    for sign in (1.0, -1.0):
        q[:, 3] = sign * (RIGHT - down) - q[:, 1] - q[:, 2]
        T = robokin.forward_kinematics(robot, q)
        if not np.allclose(T[:, 2, 2], -1.0):
            continue
        result = solve_many(robot, T, limits=False)
        for i in range(len(q)):
            found = np.array([solution.q for solution in result[i].solutions])
            assert np.min(distances(robot, q[i : i + 1], found)) < 1e-6
        return
    pytest.fail("the hand never looked down")
