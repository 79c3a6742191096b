"""Redundant arms: every pose within the limits is answered, as often as asked for, and a search is called a search."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from inverse.arms import with_limits
from inverse.judge import on_arc
from inverse.truth import Scale
from sweeps import sweep

import robokin
from robokin.inverse.analysis import analysis_of
from robokin.inverse.numeric.closing import closing_nearest
from robokin.inverse.self_motion.bounded_task import BoundedTask
from robokin.inverse.self_motion.limit_contacts import contacts
from robokin.inverse.self_motion.pieces_within import rays, spread_over, stepped_on
from robokin.inverse.self_motion.redundant import NOT_FOUND, UNPROVEN
from robokin.inverse.verify import CLOSES, SAME, Found, residuals
from robokin.kernel.residual import error_and_jacobian

ARMS = ["panda", "fr3", "iiwa14", "gen72", "r1pro-left", "openarm-left", "human-arm"]
"""Arms of seven joints and more with closed forms of six."""


def within(robot, count, rng):
    """Configurations (count, n) within the limits: inside, with some joints at limits, with all, in turn."""
    reach = np.where(robot.revolute, np.pi, analysis_of(robot).size)[:, None] * [-1.0, 1.0]
    low, high = np.where(np.isinf(robot.limits), reach, robot.limits).T
    q = rng.uniform(low, high, (count, robot.n))
    chance = np.array([0.0, 0.5, 1.0])[np.arange(count) % 3]
    at_limit = np.where(rng.random(q.shape) < 0.5, low, high)
    return np.where(rng.random(q.shape) < chance[:, None], at_limit, q)


def check(robot, T, index, q):
    position, angle = residuals(T[index], robokin.forward_kinematics(robot, q))
    assert np.max(position) <= CLOSES * analysis_of(robot).size + 1e-15
    assert np.max(angle) <= CLOSES + 1e-15
    assert robot.within_limits(q).all()


@pytest.mark.parametrize("name", sweep(ARMS, 4))
def test_every_pose_within_the_limits_is_answered(name, rng):
    robot = robokin.load(name)
    T = robokin.forward_kinematics(robot, within(robot, 60, rng))
    result = robokin.solve_ik(robot, T)
    assert np.all(result.count > 0)
    index, place = np.nonzero(~np.isnan(result.q[:, :, 0]))
    check(robot, T, index, result.q[index, place])


def test_all_joints_at_a_limit():
    robot = robokin.load("gen72")
    low, high = robot.limits.T
    q = np.where(np.array([1, -1, 1, -1, 1, 1, 1]) > 0, high, low)
    assert robokin.solve_ik(robot, robokin.forward_kinematics(robot, q)).reachable


@pytest.mark.parametrize("name", ["yumi-right", "gen3"])
def test_arms_without_a_closed_form_are_searched(name, rng):
    robot = robokin.load(name)
    T = robokin.forward_kinematics(robot, within(robot, 45, rng))
    found = closing_nearest(analysis_of(robot), T, robot.limits, np.clip(0.0, *robot.limits.T), 0)
    assert np.all(np.bincount(found.index, minlength=len(T)) > 0)
    check(robot, T, found.index, found.q)


SINGLE = [
    ("yumi-left", [2.9408797896104453, -2.504547476611863, -2.9408797896104453, 1.3962634015954636, 5.061454830783556,
                   2.4085543677521746, -1.110482937708714]),
    ("yumi-left", [2.9408797896104453, -2.504547476611863, -2.9408797896104453, 1.3962634015954636, 5.061454830783556,
                   -1.53588974175501, 1.7782067542265114]),
]  # fmt: skip
"""All joints but one at limits: the solution is a single point of its self-motion, which no search came upon."""


@pytest.mark.parametrize(("name", "q"), sweep(SINGLE, 2))
def test_single_points_of_self_motions(name, q):
    robot = robokin.load(name)
    T = robokin.forward_kinematics(robot, np.array(q))
    answer = robokin.solve_ik(robot, T)
    assert answer.reachable
    check(robot, T[None], np.zeros(len(answer.solutions), dtype=np.intp), np.array([s.q for s in answer.solutions]))


def apart(robot, solutions):
    """The least distance between two solutions (k, n) [rad | size], whole turns aside."""
    gap = np.abs(solutions[:, None] - solutions)
    gap = np.where(robot.revolute, np.minimum(gap % (2 * np.pi), -gap % (2 * np.pi)), gap / analysis_of(robot).size)
    return np.min(np.max(gap, axis=2) + 9.0 * np.eye(len(solutions)))


def test_as_many_as_asked_for_where_joints_are_far_from_their_limits(rng):
    """Such a configuration has a piece of its self-motion beside it."""
    robot = robokin.load("iiwa14")
    low, high = robot.limits.T
    q = rng.uniform(0.8 * low, 0.8 * high, (10, robot.n))
    T = robokin.forward_kinematics(robot, q)
    result = robokin.solve_ik(robot, T, most=128)
    assert np.all(result.count == 128)
    for target, solutions in zip(T, result.q, strict=True):
        check(robot, target[None], np.zeros(128, dtype=np.intp), solutions)
        assert apart(robot, solutions) > SAME


SHORT = [
    ("gen3", [np.pi, -2.24, np.pi, 2.57, np.pi, -1.4091105599619826, np.pi]),
    ("gen3", [np.pi, 2.24, np.pi, -2.57, np.pi, 1.4197362293375573, np.pi]),
    ("fr3", [-2.30195, -1.5133, 2.4937, -0.4461, 2.47464, 0.85287, 2.6895]),
    ("fr3", [2.3093, 1.5133, -2.4937, -0.44777, 2.48, 0.8521, 2.6895]),
]
"""Configurations with most joints at limits: pieces of 0.001 to 0.05 rad are within these, in the last one not the
piece that the configuration is on, which is a point. Those of the FR3 are at NARROW."""
NARROW = [(-2.3093, 2.3093), (-1.5133, 1.5133), (-2.4937, 2.4937), (-2.7478, -0.4461), (-2.48, 2.48), (0.8521, 4.2094),
          (-2.6895, 2.6895)]  # fmt: skip
"""Joint limits of the FR3 in an older file of its maker."""


@pytest.mark.parametrize(("name", "q"), sweep(SHORT, 2))
def test_as_many_as_asked_for_on_short_pieces(name, q):
    robot = robokin.load(name)
    if name == "fr3":
        robot = with_limits(robot, NARROW)
    T = robokin.forward_kinematics(robot, np.array(q))
    for most in (16, 128):
        found = np.array([solution.q for solution in robokin.solve_ik(robot, T, most=most).solutions])
        assert len(found) == most
        check(robot, T[None], np.zeros(most, dtype=np.intp), found)
        assert apart(robot, found) > SAME


@pytest.mark.parametrize(
    ("name", "task"),
    sweep([("human-arm", "pose"), ("human-body", "pose"), ("puma560", "position"), ("xarm6", "position"),
     ("panda", "approach"), ("planar3r", "position")], 3),
)  # fmt: skip
def test_as_many_as_asked_for_of_whatever_dimension(name, task, rng):
    """With more joints to spare, or less asked for, there are as many as one likes beside a configuration inside."""
    robot = robokin.load(name)
    low, high = np.where(np.isinf(robot.limits), np.pi * np.array([-1.0, 1.0]), robot.limits).T
    q = low + (high - low) * rng.uniform(0.05, 0.95, (6, robot.n))
    T = robokin.forward_kinematics(robot, q)
    result = robokin.solve_ik(robot, T, most=128, task=task)
    assert np.all(result.count == 128)
    for target, solutions in zip(T, result.q, strict=True):
        off = robokin.forward_kinematics(robot, solutions) - target
        assert np.max(np.abs(off[:, :3, 3])) <= 2e-9 * analysis_of(robot).size
        assert task == "position" or np.max(np.abs(off[:, :3, 2])) <= 2e-9
        assert task != "pose" or np.max(np.abs(off)) <= 2e-9 * max(analysis_of(robot).size, 1.0)
        assert robot.within_limits(solutions).all()
        assert apart(robot, solutions) > SAME


@pytest.mark.slow
def test_fewer_are_the_first_of_more(rng):
    robot = robokin.load("panda")
    T = robokin.forward_kinematics(robot, within(robot, 24, rng))
    many = robokin.solve_ik(robot, T, most=64)
    for most in (1, 16, 40):
        few = robokin.solve_ik(robot, T, most=most)
        assert np.array_equal(few.count, np.minimum(many.count, most))
        for i, count in enumerate(few.count.tolist()):
            assert np.allclose(few.q[i, :count], many.q[i, :count], rtol=0, atol=1e-12)


def test_pieces_end_where_a_joint_meets_its_limit(rng):
    robot = robokin.load("panda")
    analysis = analysis_of(robot)
    q = within(robot, 18, rng)[::3]
    T = robokin.forward_kinematics(robot, q)
    task = BoundedTask(analysis, T, robot.limits, np.zeros(7))
    start = Found(np.arange(len(q)), q, np.zeros(len(q)), np.zeros(len(q)))
    pieces = rays(task, start, 1, 0)
    found = stepped_on(task, pieces)
    check(robot, T, found.index, found.q)
    _, J = error_and_jacobian(analysis.chain, T, q, analysis.size)
    null = np.linalg.svd(J)[2][:, -1]
    seeds = np.array([np.flatnonzero(np.all(pieces.x == row, axis=1))[0] for row in q])
    assert np.allclose(np.abs(np.sum(pieces.ahead[seeds] * null, axis=1)), 1.0)
    for i in range(len(q)):
        x = pieces.x[pieces.target == i]
        margin = np.min(np.minimum(x - robot.limits[:, 0], robot.limits[:, 1] - x), axis=1)
        gap = np.abs(x[0] - x[-1])
        whole = np.max(np.minimum(gap, 2 * np.pi - gap)) < 0.5
        assert whole or max(margin[0], margin[-1]) < 0.01
    more = spread_over(task, pieces, 50)
    assert np.all(np.bincount(more.index) == 50)
    check(robot, T, more.index, more.q)


def test_contacts_are_found_from_solutions_outside_the_limits():
    """The other corner of a configuration with all joints at limits, from one solution far outside these."""
    robot = robokin.load("fr3")
    analysis = analysis_of(robot)
    q = robot.limits[np.arange(7), [1, 1, 0, 0, 1, 0, 1]]
    T = robokin.forward_kinematics(robot, q)[None]
    start = Found(np.zeros(1, dtype=np.intp), q[None], np.zeros(1), np.zeros(1))
    free = BoundedTask(analysis, T, np.tile([-np.inf, np.inf], (7, 1)), np.zeros(7))
    away = stepped_on(free, rays(free, start, 1, 0))
    far = away.pick(np.array([int(np.argmax(np.max(np.abs(away.q - q), axis=1)))]))
    assert not robot.within_limits(far.q).any()
    found = contacts(BoundedTask(analysis, T, robot.limits, np.zeros(7)), far)
    check(robot, T, found.index, found.q)
    assert np.min(np.max(np.abs(found.q - q), axis=1)) < 1e-6


@pytest.mark.parametrize(("place", "reason"), [([0.1, 0.0, -0.2], UNPROVEN), ([0.0, 0.0, -0.3], NOT_FOUND)])
def test_a_search_proves_nothing(place, reason):
    """Below its base a Panda finds no solution within its limits; whether there is any outside is known for the first.

    Three metres away is farther than the arm is long, which is a proof.
    """
    robot = robokin.load("panda")
    T = np.eye(4)
    T[:3, 3] = place
    answer = robokin.solve_ik(robot, T)
    assert not answer.reachable
    assert not answer.complete
    assert answer.reason == reason
    assert "not proven unreachable" in reason
    assert robokin.solve_ik(robot, np.stack([T, T])).reason(1) == reason
    T[:3, 3] = [3.0, 0.0, 0.0]
    assert robokin.solve_ik(robot, T).reason == "out of reach"


ON_INTERVALS = [
    ("panda", [2.8973, 1.7628, -2.8973, -0.0698, -2.8973, 3.7525, 2.8973]),  # a curve on which q7 moves by 0.13
    ("panda", [-1.5708, 0.0, 1.5708, -2.0944, 2.61799, 2.61799, -1.0472]),  # q1 and q3 on one axis, where curves cross
    ("panda", [-2.8973, 1.5708, -0.5236, -0.0698, -2.8973, 3.66519, -2.8973]),
    ("iiwa14", [np.pi / 6, 0.0, np.pi / 3, -np.pi / 2, np.pi / 4, np.pi / 3, -np.pi / 6]),
]
"""Configurations on self-motions that none of the sixteen listed solutions is on."""


@pytest.mark.parametrize(("name", "q"), sweep(ON_INTERVALS, 4))
def test_intervals_hold_what_is_known_and_end_on_limits(name, q):
    robot, q = robokin.load(name), np.array(q)
    T = robokin.forward_kinematics(robot, q)
    answer = robokin.solve_ik(robot, T)
    arcs = [arc for family in answer.families for arc in family.arcs]
    scale = Scale(robot)
    assert any(on_arc(robot, scale, q, arc.q) for arc in arcs)
    assert not answer.complete
    for arc in arcs:
        check(robot, T[None], np.zeros(len(arc.q), dtype=np.intp), arc.q)
        margins = np.min(np.minimum(arc.q - robot.limits[:, 0], robot.limits[:, 1] - arc.q), axis=1)
        assert arc.whole or np.max(np.abs(margins[[0, -1]])) <= 1e-9


@pytest.mark.parametrize("name", sweep(["panda", "gen3", "fr3"], 3))
def test_arms_with_narrow_limits_are_answered(name, rng):
    robot = robokin.load(name)
    low, high = np.where(np.isinf(robot.limits), np.pi * np.array([-1.0, 1.0]), robot.limits).T
    for k in range(4):
        width = (high - low) * 10.0 ** rng.uniform(-4.0, -0.3, robot.n)
        middle = rng.uniform(low, high)
        limits = np.stack([np.maximum(middle - width, low), np.minimum(middle + width, high)], axis=1)
        parts = iter(limits.tolist())
        rows = tuple(replace(row, limits=tuple(next(parts))) if row.moves else row for row in robot.rows)
        part = replace(robot, name=f"narrow {k}", rows=rows, poses={})
        T = robokin.forward_kinematics(part, within(part, 6, rng))
        assert np.all(robokin.solve_ik(part, T).count > 0)
