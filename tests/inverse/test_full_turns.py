"""Full turns: every equivalent within the limits, each once, and no more."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

import robokin
from robokin.errors import InputError
from robokin.formats.read import read_text
from robokin.inverse.full_turns import MOST_TURNS, count_equivalents, equivalents, turns_of_limits, with_full_turns
from robokin.inverse.solutions import BatchResult, Family, Result, Solution

UR5E = np.radians([20.0, -70.0, 100.0, -60.0, 50.0, 10.0])
"""A generic configuration of the UR5e, whose elbow has ±180° and whose other joints ±360°: 2⁵ equivalents."""


def planar(limits, second="[-90, 90]"):
    return read_text(
        "robokin: 1\nname: Arm\nunits: {length: m, angle: deg}\njoints:\n"
        f"  - {{type: R, a: 1, limits: {limits}}}\n  - {{type: R, a: 0.5, limits: {second}}}\n"
    )


def brute_force(robot, q):
    """Every choice of -9 … 9 turns of each revolute joint that is within the limits."""
    ways = [
        [value for k in range(-9, 10) if low - 1e-9 <= (value := q[i] + 2.0 * math.pi * k) <= high + 1e-9]
        if robot.revolute[i] and math.isfinite(low) and math.isfinite(high)
        else [q[i]]
        for i, (low, high) in enumerate(robot.limits.tolist())
    ]
    return np.array(list(itertools.product(*ways)))


@pytest.mark.parametrize(
    ("limits", "q", "values"),
    [
        ("[-360, 360]", 30.0, [-330, 30]),
        ("[-360, 360]", 0.0, [-360, 0, 360]),
        ("[-360, 360]", 360.0, [-360, 0, 360]),
        ("[-180, 180]", 180.0, [-180, 180]),
        ("[-180, 180]", 90.0, [90]),
        ("[-170, 170]", 170.0, [170]),
        ("[-720, 720]", -45.0, [-405, -45, 315, 675]),
        ("[100, 900]", 100.0, [100, 460, 820]),
    ],
)
def test_the_values_of_one_joint(limits, q, values):
    robot = planar(limits)
    row = np.radians([[q, 30.0]])
    found, of, own = equivalents(robot, row)
    assert np.allclose(np.degrees(found[:, 0]), values)
    assert np.allclose(found[:, 1], row[0, 1])
    assert of.tolist() == [0] * len(values)
    assert own.tolist() == [value == q for value in values]
    assert count_equivalents(robot, row) == [len(values)]


def test_all_choices_and_no_more(rng):
    robot = robokin.load("ur5e")
    q = robot.limits[:, 0] + np.ptp(robot.limits, axis=1) * rng.random((20, 6))
    q[0, :3] = 0.0
    found, of, own = equivalents(robot, q)
    for k, row in enumerate(q):
        expected = brute_force(robot, row)
        mine = found[of == k]
        assert mine.shape == expected.shape
        assert np.allclose(mine[np.lexsort(mine.T[::-1])], expected[np.lexsort(expected.T[::-1])])
        assert np.array_equal(mine[own[of == k]], [row])
    assert count_equivalents(robot, q) == [len(brute_force(robot, row)) for row in q]


def test_joints_without_two_limits_and_sliding_ones_are_not_turned():
    robot = read_text(
        "robokin: 1\nname: Arm\nunits: {length: m, angle: rad}\njoints:\n"
        "  - {type: R, a: 1}\n  - {type: P, alpha: 90, limits: [-9, 9]}\n  - {type: R, a: 1, limits: [-7, 7]}\n"
    )
    found, _, _ = equivalents(robot, np.array([[0.1, 0.2, 3.0]]))
    assert np.allclose(found, [[0.1, 0.2, 3.0 - 2 * math.pi], [0.1, 0.2, 3.0]])


def test_solutions_and_their_equivalents():
    robot = robokin.load("ur5e")
    T = robokin.forward_kinematics(robot, UR5E)
    plain = robokin.solve_ik(robot, T)
    turned = robokin.solve_ik(robot, T, turns=True)
    assert plain.counts["turns"] == turned.counts["turns"] == len(turned.solutions) == 32 * len(plain.solutions)
    assert turned.counts["listed"] == len(turned.solutions)
    assert turned.complete == plain.complete
    for k, base in enumerate(plain.solutions):
        own, *rest = turned.solutions[32 * k : 32 * (k + 1)]
        assert np.array_equal(own.q, base.q)
        assert [tuple(s.q) for s in rest] == sorted(tuple(s.q) for s in rest)
        for solution in (own, *rest):
            assert (solution.branch, solution.within_limits, solution.free) == (base.branch, True, base.free)
            assert robot.within_limits(solution.q)
            assert np.allclose(robokin.forward_kinematics(robot, solution.q), T, rtol=0, atol=1e-9)
            assert solution.position_error < 1e-9
            assert solution.angle_error < 1e-9
    assert len({tuple(np.round(s.q, 6)) for s in turned.solutions}) == len(turned.solutions)


def test_near_orders_all_by_the_move_and_most_cuts():
    robot = robokin.load("ur5e")
    T = robokin.forward_kinematics(robot, UR5E)
    near = UR5E + np.radians([-355.0, 0.0, 0.0, 340.0, 0.0, 10.0])
    every = robokin.solve_ik(robot, T, near=near, turns=True)
    moves = [float(np.max(np.abs(s.q - near))) for s in every.solutions]
    assert moves == sorted(moves)
    assert moves[0] == pytest.approx(np.radians(20.0))
    few = robokin.solve_ik(robot, T, near=near, turns=True, most=7)
    assert [s.q.tolist() for s in few.solutions] == [s.q.tolist() for s in every.solutions[:7]]
    assert (few.complete, few.postures, few.basis, few.all_known) == (False, False, None, True)
    assert (few.counts["turns"], few.counts["listed"]) == (len(every.solutions), 7)
    unordered = robokin.solve_ik(robot, T, turns=True)
    cut = robokin.solve_ik(robot, T, turns=True, most=40)
    assert [s.q.tolist() for s in cut.solutions] == [s.q.tolist() for s in unordered.solutions[:40]]


def test_single_and_batch_say_the_same(rng):
    robot = robokin.load("puma560")
    q = robot.limits[:, 0] + np.ptp(robot.limits, axis=1) * rng.random((6, 6))
    T = robokin.forward_kinematics(robot, q)
    T[2, :3, 3] = [5.0, 0.0, 0.0]
    batch = robokin.solve_ik(robot, T, turns=True)
    names = iter(batch.branches())
    for i, count in enumerate(batch.count.tolist()):
        single = robokin.solve_ik(robot, T[i], turns=True)
        assert len(single.solutions) == len(batch[i].solutions) == count
        assert np.allclose(batch.q[i, :count], np.array([s.q for s in single.solutions]).reshape(-1, 6), atol=1e-9)
        assert np.isnan(batch.q[i, count:]).all()
        assert [s.branch for s in single.solutions] == [next(names) for _ in range(count)]
        assert batch.within_limits[i].tolist() == [True] * count + [False] * (batch.q.shape[1] - count)
    assert batch.reason(2) == "out of reach"
    assert batch[2].nearest is not None
    assert (batch[2].counts["turns"], batch.count[2]) == (0, 0)


@pytest.mark.parametrize(
    ("task", "name"), [("approach", "scorbot"), ("position", "anthropomorphic"), ("position", "puma560")]
)
def test_open_tasks(task, name):
    robot = robokin.load(name)
    T = robokin.forward_kinematics(robot, np.clip(0.4, *robot.limits.T))
    plain, turned = (robokin.solve_ik(robot, T, task=task, turns=turns) for turns in (False, True))
    assert len(turned.solutions) == plain.counts["turns"] >= len(plain.solutions) > 0
    for solution in turned.solutions:
        reached = robokin.forward_kinematics(robot, solution.q)
        assert np.allclose(reached[:3, 3], T[:3, 3], atol=1e-9)
        assert solution.position_error < 1e-9
        assert solution.angle_error < 1e-9


def test_of_a_redundant_arm_the_listed_ones_are_turned():
    robot = robokin.load("ur5e")
    T = robokin.forward_kinematics(robot, UR5E)
    result = robokin.solve_ik(robot, T, task="position", turns=True, most=3)
    assert len(result.solutions) == 3
    assert not result.complete


def test_without_limits_there_is_no_count_and_nothing_to_list():
    robot = robokin.load("ur5e")
    T = robokin.forward_kinematics(robot, UR5E)
    assert "turns" not in robokin.solve_ik(robot, T, limits=False).counts
    with pytest.raises(InputError, match="limits do not count"):
        robokin.solve_ik(robot, T, limits=False, turns=True)


def test_an_absurd_number_is_refused_but_counted():
    robot = planar("[-1e9, 1e9]", "[-3600, 3600]")
    T = robokin.forward_kinematics(robot, [0.3, 0.4])
    assert turns_of_limits(robot) > MOST_TURNS
    with pytest.raises(InputError, match=r"1\.1e\+08 full turns.*expected at most 10000"):
        robokin.solve_ik(robot, T, task="position", turns=True)
    assert robokin.solve_ik(robot, T, task="position").counts["turns"] > 10**8


def test_many_turns_still_close():
    """Far from zero a value has fewer digits: the errors are those of the turned configuration, not of its base."""
    robot = planar("[-1e6, 1e6]")
    T = robokin.forward_kinematics(robot, [0.3, 0.4])
    batch = robokin.solve_ik(robot, T[None], task="position", turns=True)
    q, off = batch.q[0, : batch.count[0]], batch.position_error[0, : batch.count[0]]
    assert batch.count[0] > 5000
    assert np.allclose(off, np.linalg.norm(robokin.forward_kinematics(robot, q)[:, :3, 3] - T[:3, 3], axis=1))
    assert 0.0 < off.max() < 1e-9


def test_a_self_motion_keeps_the_solution_that_stands_for_it():
    robot = robokin.load("ur5e")
    rows = np.stack([UR5E, UR5E + 0.1])
    solutions = tuple(Solution(q, "", True, 0.0, 0.0) for q in rows)
    family = Family((4, 6), 1, True, (), 1)
    result = Result(solutions, True, "elimination", families=(family,), counts={"listed": 2})
    zeros = np.zeros((1, 2))
    batch = BatchResult(
        rows[None], np.array([2]), zeros, zeros, zeros == 0.0, True, "elimination", lambda i: result,
        lambda: ["a", "b"], lambda i: None,
    )  # fmt: skip
    T = robokin.forward_kinematics(robot, UR5E)[None]
    for near in (None, UR5E + np.radians([-360.0, 0.0, 0.0, 0.0, 0.0, 0.0]) + 0.1):
        turned = with_full_turns(robot, batch, T, "pose", near, 1.0, None)
        assert turned.branches().count("b") == 32
        whole = turned[0]
        (moved,) = whole.families
        assert np.array_equal(whole.solutions[moved.solution].q, rows[1])
        assert (whole.complete, whole.counts["turns"]) == (True, 64)
    # Where the one that stands for it is cut away, none does.
    (cut,) = with_full_turns(robot, batch, T, "pose", None, 1.0, 5)[0].families
    assert (cut.joints, cut.solution) == ((4, 6), -1)
