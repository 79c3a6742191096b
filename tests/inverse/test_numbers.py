"""Great and small numbers: no warning, no exception, and the same solutions at every scale."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sweeps import sweep

import robokin
from robokin.errors import InputError
from robokin.inverse.analysis import analysis_of
from robokin.inverse.solve import solve_many
from robokin.inverse.solve_blocks import turned_in_the_open
from robokin.inverse.window import solve_window
from robokin.kinematics.forward import forward_kinematics
from robokin.model import Joint, JointType, Robot
from robokin.spatial import transform

TURN = 2.0 * np.pi


def chain(letters, rng):
    """A chain of R and P joints with right angles mostly, and lengths of which half are zero."""
    rows = []
    for i, letter in enumerate(letters):
        a, d = rng.choice([0.0, 0.0, 0.3, 0.5], 2)
        kind = JointType.REVOLUTE if letter == "R" else JointType.PRISMATIC
        alpha = rng.choice([0.0, 90.0, -90.0, 90.0, 45.0])
        rows.append(Joint(str(i + 1), kind, d=d if letter == "R" else 0.0, a=a, alpha=np.deg2rad(alpha)))
    return Robot(letters, tuple(rows))


SLIDING = ["RPRPRR", "PRRRRP", "PRRRP", "PPRPR", "RP", "PRR"]


@pytest.mark.parametrize("letters", sweep(SLIDING, 3))
def test_far_and_round_targets_of_sliding_arms_give_no_warning(letters):
    rng = np.random.default_rng(len(letters))
    for _ in range(4):
        robot = chain(letters, rng)
        q = np.where(robot.revolute, np.pi / 2 * rng.integers(-2, 3, (6, robot.n)), 0.5 * rng.integers(-2, 3, robot.n))
        q = np.concatenate([q, rng.uniform(-3.0, 3.0, (6, robot.n))])
        T = forward_kinematics(robot, q)
        T[1::2, :3, 3] *= 10.0 ** rng.uniform(-9.0, 9.0, (6, 1))
        for task in ("pose", "approach", "position"):
            if analysis_of(robot, task).complete:
                analysis = analysis_of(robot, task)
                solve_window(analysis, turned_in_the_open(analysis, T), count=False)


def scaled(robot, factor):
    """The robot with all its lengths and its slides' limits times a factor."""

    def moved(T):
        T = T.copy()
        T[:3, 3] *= factor
        return T

    rows = []
    for row in robot.rows:
        slides = row.type is JointType.PRISMATIC
        limits = tuple(limit * factor for limit in row.limits) if slides else row.limits
        offset = row.offset * factor if slides else row.offset
        origin = None if row.origin is None else moved(row.origin)
        rows.append(replace(row, d=row.d * factor, a=row.a * factor, offset=offset, limits=limits, origin=origin))
    return replace(robot, rows=tuple(rows), base=moved(robot.base), tool=moved(robot.tool), poses={})


@pytest.mark.parametrize(
    "name", sweep(["puma560", "ur5e", "xarm6", "scara", "stanford", "cylindrical", "scorbot", "planar2r"], 4)
)
def test_an_arm_of_a_micrometre_and_of_a_thousand_kilometres_has_the_same_solutions(name, rng):
    robot = robokin.load(name)
    low, high = np.where(np.isfinite(robot.limits), robot.limits, [-1.0, 1.0]).T
    q = low + (high - low) * rng.random((6, robot.n))
    T = forward_kinematics(robot, q)
    for limits in (False, True):
        expected = solve_many(robot, T, limits=limits)
        for factor in (1e-6, 1e-3, 1e3, 1e6):
            targets = T.copy()
            targets[:, :3, 3] *= factor
            found = solve_many(scaled(robot, factor), targets, limits=limits)
            assert np.array_equal(found.count, expected.count)
            gap = np.abs(found.q / np.where(robot.revolute, 1.0, factor) - expected.q)
            gap = np.where(robot.revolute, np.minimum(gap % TURN, -gap % TURN), gap)
            assert np.nanmax(gap) < 1e-6


SPHERICAL = (
    Joint("1", JointType.REVOLUTE, alpha=-np.pi / 2),
    Joint("2", JointType.REVOLUTE, alpha=np.pi / 2),
    Joint("3", JointType.PRISMATIC, limits=(0.0, 1e9)),
)
FAR = transform(np.eye(3), np.array([3e6, 4e6, 1.1e6]))


def test_a_slide_without_links_reaches_as_far_as_its_limits_let_it():
    robot = Robot("spherical", SPHERICAL)
    away = np.linalg.norm(FAR[:3, 3])
    result = robokin.solve_ik(robot, FAR, task="position")
    assert [round(float(s.q[2] / away), 12) for s in result.solutions] == [1.0, 1.0]
    every = robokin.solve_ik(robot, FAR, task="position", limits=False)
    assert sorted(round(float(s.q[2] / away), 12) for s in every.solutions) == [-1.0, -1.0, 1.0, 1.0]


def test_the_limit_of_a_long_slide_is_inclusive():
    away = float(np.linalg.norm(FAR[:3, 3]))
    robot = Robot("spherical", (*SPHERICAL[:2], replace(SPHERICAL[2], limits=(0.0, away))))
    assert len(robokin.solve_ik(robot, FAR, task="position").solutions) == 2


def test_the_nearest_of_a_long_slide_comes_as_near_as_it_can():
    result = robokin.solve_ik(Robot("spherical", SPHERICAL), FAR)
    assert not result.solutions
    assert result.nearest.position_error < 1e-3
    robot = Robot("spherical", (*SPHERICAL[:2], replace(SPHERICAL[2], limits=(0.0, 1e6))))
    result = robokin.solve_ik(robot, FAR, task="position")
    assert result.nearest.position_error == pytest.approx(np.linalg.norm(FAR[:3, 3]) - 1e6, rel=1e-9)


@pytest.mark.parametrize("factor", [1e2, 1e4, 1e6])
@pytest.mark.parametrize("letters", ["RPR", "PRR", "PRPR", "PPR"])
def test_slides_far_longer_than_the_links(letters, factor):
    rng = np.random.default_rng(len(letters))
    for _ in range(2):
        robot = chain(letters, rng)
        analysis = analysis_of(robot, "pose")
        if not analysis.complete:
            continue
        q = np.where(robot.revolute, rng.uniform(-3.0, 3.0, (8, robot.n)), factor * rng.uniform(-1.0, 1.0, robot.n))
        found = solve_many(robot, forward_kinematics(robot, q), limits=False)
        gap = np.abs(found.q - q[:, None])
        gap = np.where(robot.revolute, np.minimum(gap % TURN, -gap % TURN), gap / factor)
        nearest = np.min(np.max(np.nan_to_num(gap, nan=9.0), axis=2), axis=1)
        assert np.max(nearest) < 1e-5


@pytest.mark.parametrize("limit", sweep([1e6, 1e12, 1e15, 1e300], 4))
def test_huge_limits_are_no_exception(limit):
    table = [(0.5, 0.0, -90.0), (0.1, 0.4, 0.0), (0.0, 0.05, -90.0), (0.4, 0.0, 90.0), (0.1, 0.1, 30.0)]
    rows = [
        Joint(str(i + 1), JointType.REVOLUTE, d=d, a=a, alpha=np.deg2rad(alpha))
        for i, (d, a, alpha) in enumerate(table)
    ]
    robot = Robot("RRRRRP", (*rows, Joint("6", JointType.PRISMATIC, a=0.1, limits=(-limit, limit))))
    target = transform(np.eye(3), np.array([0.3, 0.2, 0.5]))
    assert len(robokin.solve_ik(robot, target).solutions) == 4
    far = robokin.solve_ik(robot, transform(np.eye(3), np.array([5.0, 6.0, 7.0])))
    assert far.reason
    assert far.nearest.position_error < 1e-9


def test_limits_between_which_there_is_no_number_are_refused():
    for limits in [(np.nan, 1.0), (0.0, np.nan), (np.inf, np.inf), (-np.inf, -np.inf), (np.inf, -np.inf), (1.0, -1.0)]:
        with pytest.raises(InputError, match=r"joint 1 has the limits .*, expected min ≤ max"):
            Joint("1", JointType.PRISMATIC, limits=limits)


def test_limits_beyond_all_numbers_are_none():
    assert Joint("1", JointType.PRISMATIC, limits=(-1e308, 1e308)).unlimited
    assert Joint("1", JointType.PRISMATIC, limits=(0.0, 1e308)).limits == (0.0, np.inf)
    assert Joint("1", JointType.PRISMATIC, limits=(-1e50, 2.0)).limits == (-1e50, 2.0)


@pytest.mark.parametrize("letters", sweep(["RRR", "RRRR", "RRRRRR", "PPP", "PRR", "RPRRR"], 3))
@pytest.mark.parametrize("angles", [(0.0, 0.0), (90.0, -90.0)], ids=["one axis", "right angles"])
def test_an_arm_of_length_zero_gets_an_answer(letters, angles):
    rows = [
        Joint(str(i + 1), JointType.REVOLUTE if letter == "R" else JointType.PRISMATIC, alpha=np.deg2rad(angles[i % 2]))
        for i, letter in enumerate(letters)
    ]
    robot = Robot("zero", tuple(rows))
    T = forward_kinematics(robot, np.full(robot.n, 0.1))
    for target in (T, transform(T[:3, :3], T[:3, 3] + np.array([0.1, 0.2, 0.3]))):
        for task in ("pose", "position"):
            result = robokin.solve_ik(robot, target, task=task)
            assert result.solutions or result.reason
    assert robokin.solve_ik(robot, T).solutions
    assert np.all(np.isfinite(robokin.jacobian(robot, np.zeros(robot.n))))


@pytest.mark.parametrize("value", [0.0, 0.3, -2.0])
def test_a_joint_that_its_limits_hold_at_one_value(value):
    robot = robokin.load("puma560")
    rows = list(robot.rows)
    rows[0] = replace(rows[0], limits=(value, value))
    held = replace(robot, rows=tuple(rows), poses={})
    q = np.array([value, -0.5, 0.4, 0.3, 0.6, -0.2])
    result = robokin.solve_ik(held, forward_kinematics(held, q))
    assert any(np.allclose(solution.q, q, atol=1e-8) for solution in result.solutions)
    assert all(abs(solution.q[0] - value) < 1e-8 for solution in result.solutions)
    other = robokin.solve_ik(held, forward_kinematics(held, q + np.array([0.1, 0.0, 0.0, 0.0, 0.0, 0.0])))
    assert not other.solutions
    assert other.nearest.q[0] == value
