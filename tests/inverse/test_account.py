"""What is called complete where roots meet, at limits, at infinity and where self-motions cross: none is missing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from inverse import arms, judge, truth
from sweeps import sweep

import robokin
from robokin.inverse.analysis import analysis_of
from robokin.inverse.elimination.complex_newton import on_the_way_out
from robokin.inverse.elimination.monodromy import two_starts
from robokin.inverse.elimination.skew import Skew

# Rows (d [m], a [m], alpha [°]).
FOURFOLD = arms.table(
    [(0, -0.13, 90), (0, 0.19, 0), (-0.04, -0.28, -90), (0.29, -0.14, 180), (0, 0, 90), (0, -0.24, 180)]
)
FAR_OUT = arms.table([(0, 0, 90), (0, -0.43, 90), (0, 0, -90), (0, 0.16, -90), (0, 0, 90), (0, 0.3, 180)])
KITE = arms.table([(0, 0.28, 90), (0, 0, 90), (0, 0.41, 180), (-0.28, -0.41, 0), (0, -0.41, -90), (0.28, -0.28, -90)])

CROSSED = arms.table([(0, 0, -90), (0, 0, 90), (0, -0.34, -90), (0, 0, -90), (0.46, 0, 90), (0.13, -0.31, 0)])
NOT_REAL = arms.table(
    [
        (0.24, 0.28, -125.795),
        (-0.42, 0.08, -48.355),
        (0, 0.29, 174.15),
        (0, 0.36, 0),
        (0.43, -0.04, 0),
        (0.13, -0.46, 128.67),
    ]
)
ALONE = arms.table(
    [(0.3, 0.3, 70.35), (0, 0.3, -82.62), (0, 0.2, 82.62), (0, -0.3, 180), (0, -0.2, 0), (0, -0.2, -135.38)]
)

# Where q3 is 0 axes 2, 4, 5 and 6 are parallel: a self-motion, whose curve paths follow into the complex next to it.
NEXT_TO_FOUR_PARALLEL = (
    (
        [
            (-0.12, 0, -122.28857446365217),
            (0, 0.25, 90),
            (0.03, 0, 90),
            (-0.39, 0.02, 180),
            (-0.29, 0.06, 0),
            (-0.08, 0, 180),
        ],
        [29.999998487718965, -29.999952493509348, -4.1214123e-06, -60.00005539869249, 29.999960856008016, 90.000045775],
    ),
    (
        [(0, 0, -90), (-0.39, 0.03, 90), (-0.3, 0.12, 90), (0, 0.26, 0), (0, 0.15, 0), (0, -0.19, 180)],
        [-119.99999886632, -149.99999992774, 6.14813e-06, -119.99999984, 1.0915e-08, 5.20023e-07],
    ),
)

SCARAS = ("cobra-s600", "kr5-scara-r350")


def limited(robot, limits):
    """The robot with other limits (n, 2) [rad | m]."""
    return replace(
        robot, rows=tuple(replace(row, limits=tuple(own)) for row, own in zip(robot.rows, limits, strict=True))
    )


@pytest.mark.parametrize("side", sweep([0, 1], 2))
def test_a_root_of_four_solutions_at_a_limit(side):
    # Rounding puts a root that counts four times some 1e-6 rad beside where it is, which may be beyond the limit.
    q = np.radians([-90.0, -90.0, 90.0, -90.0, -90.0, 180.0])
    limits = np.tile([-np.pi, np.pi], (6, 1))
    limits[1, side], limits[2, 1 - side] = q[1], q[2]
    arm = limited(FOURFOLD, limits)
    scale = truth.Scale(arm)
    T = np.repeat(robokin.forward_kinematics(arm, q)[None], 16, axis=0)
    T[1:] = judge.shaken(T[1:], np.random.default_rng(5))
    for pose, result in zip(T, robokin.solve_ik(arm, T), strict=True):
        assert judge.faults(arm, scale, q, pose, result) == []


def test_what_is_on_its_way_to_infinity_is_not_counted():
    # Eight of sixteen solutions are at infinity here, where residuals get as small as one likes.
    q = np.radians([90.0, -90.0, 0.0, 0.0, 180.0, 90.0])
    scale = truth.Scale(FAR_OUT)
    T = robokin.forward_kinematics(FAR_OUT, q)
    result = robokin.solve_ik(FAR_OUT, T)
    assert result.basis != "counted"
    assert judge.faults(FAR_OUT, scale, q, T, result) == []
    loop = analysis_of(FAR_OUT).loop
    way = np.array([[-1.5454 + 7.7977j, -2.1814, np.pi + 0.5926j, 3.7023, 3.1162 - 8.23j, 3.1415 + 1e-4j]])
    assert on_the_way_out(loop, loop.closing(T[None]), np.zeros(1, dtype=np.intp), way, np.array([1e-11])).all()


@pytest.mark.parametrize("limits", [True, False])
def test_self_motions_that_cross_are_all_given(limits):
    # The sides of a four-bar linkage are equal in pairs: folded onto each other two of them turn as one.
    q = np.radians([180.0, 0.0, -90.0, 0.0, 0.0, 90.0])
    bounds = np.radians([[-180, 180], [-150, 150], [-150, 150], [-180, 180], [-150, 150], [-90, 120]])
    arm = limited(KITE, bounds)
    scale = truth.Scale(arm)
    T = robokin.forward_kinematics(arm, q)
    result = robokin.solve_ik(arm, T, limits=limits)
    assert sorted(family.joints for family in result.families) == [(1, 3, 4, 5), (3, 5)]
    known, _ = truth.search(arm, scale, T, np.random.default_rng(0), guesses=200)
    assert judge.faults(arm, scale, q, T, result, known, limits) == []


@pytest.mark.parametrize("q", [(180, 0, -90, 90, 90, 0), (-135, -180, 180, 90, -90, -90)])
def test_a_self_motion_that_meets_others_only_where_they_cross(q):
    scale = truth.Scale(CROSSED)
    T = arms.pose_of(CROSSED, q)
    result = robokin.solve_ik(CROSSED, T)
    assert sorted(family.joints for family in result.families) == [(1, 3), (1, 3), (2, 5), (2, 5)]
    known, _ = truth.search(CROSSED, scale, T, np.random.default_rng(0), guesses=100)
    assert judge.faults(CROSSED, scale, np.radians(q), T, result, known) == []


@pytest.mark.slow
def test_a_self_motion_on_which_no_path_ends_where_it_is_real():
    # With joints 2 and 3 at zero joints 1, 4, 5 and 6 are parallel; all paths to their curve end at complex values.
    q = np.radians([-5.82, 0.0, 0.0, 100.27, -100.72, 59.02])
    scale = truth.Scale(NOT_REAL)
    T = robokin.forward_kinematics(NOT_REAL, q)
    result = robokin.solve_ik(NOT_REAL, T)
    known, _ = truth.search(NOT_REAL, scale, T, np.random.default_rng(0), guesses=100)
    assert [family.joints for family in result.families] == [(1, 4, 5, 6), (1, 4, 5, 6)]
    assert judge.faults(NOT_REAL, scale, q, T, result, known) == []


def test_two_members_of_a_self_motion_that_seemed_to_stand_alone():
    q = np.radians([-4.36, -90.0, 0.0, 90.0, 90.0, 180.0])
    scale = truth.Scale(ALONE)
    T = robokin.forward_kinematics(ALONE, q)
    result = robokin.solve_ik(ALONE, T)
    known, _ = truth.search(ALONE, scale, T, np.random.default_rng(0), guesses=100)
    assert [family.joints for family in result.families] == [(2, 4, 5, 6), (2, 4, 5, 6)]
    assert judge.faults(ALONE, scale, q, T, result, known) == []


@pytest.mark.parametrize("name", sweep(SCARAS, 2))
def test_the_counts_of_loops_with_skew_axes_agree(name):
    own = analysis_of(robokin.load(name)).own
    loops = [Skew(own, seed) for seed in (40, 41)]
    start = two_starts(loops[0].loop)
    assert [skew.number for skew in loops] == [4, 4]
    assert start is not None
    assert start[0].values.shape[1] == 4


@pytest.mark.parametrize("seed", sweep(range(4), 4))
def test_singular_configurations_of_random_chains_at_limits(seed):
    rng = np.random.default_rng([31, seed])
    while (robot := arms.random_chain(rng)).n < 5:
        pass
    scale = truth.Scale(robot)
    q = arms.on_grid(robot, scale, rng, 60, 90)
    for one in q[truth.least_singular_value(robot, scale, q) < 1e-9][:2]:
        low, high = one - rng.uniform(0.3, 1.0, robot.n), one + rng.uniform(0.3, 1.0, robot.n)
        at = rng.integers(3, size=robot.n)
        arm = limited(robot, np.stack([np.where(at == 0, one, low), np.where(at == 1, one, high)], axis=1))
        T = np.repeat(robokin.forward_kinematics(arm, one)[None], 3, axis=0)
        T[1:] = judge.shaken(T[1:], rng)
        for pose, result in zip(T, robokin.solve_ik(arm, T), strict=True):
            assert not {"falsely complete", "unanswered"} & set(judge.faults(arm, scale, one, pose, result))


@pytest.mark.parametrize("seed", sweep(range(4), 4))
def test_both_circuits_of_four_bar_linkages(seed):
    """Joints 1, 2, 4 and 5 are parallel where joint 3 is at zero: the pose leaves a four-bar linkage its motion."""
    rng = np.random.default_rng([32, seed])
    twist = np.array([0.0, 70.0, -70.0, 0.0, 80.0, 0.0])
    lengths = np.round(rng.uniform(0.1, 0.5, (6, 2)), 2)
    arm = arms.table([(d, a, alpha) for (d, a), alpha in zip(lengths, twist, strict=True)])
    scale = truth.Scale(arm)
    q = rng.uniform(-np.pi, np.pi, 6)
    q[2] = 0.0
    T = robokin.forward_kinematics(arm, q)
    result = robokin.solve_ik(arm, T)
    known, _ = truth.search(arm, scale, T, rng, guesses=100)
    assert result.complete
    assert result.families
    assert judge.faults(arm, scale, q, T, result, known) == []


@pytest.mark.parametrize("k", range(len(NEXT_TO_FOUR_PARALLEL)))
def test_paths_that_follow_a_self_motion_close_by_are_not_at_infinity(k):
    rows, degrees = NEXT_TO_FOUR_PARALLEL[k]
    arm, rng = arms.table(rows), np.random.default_rng(246)
    q = np.radians(degrees) + 1e-12 * rng.standard_normal((4, 6))
    q[0] = np.radians(degrees)
    T = robokin.forward_kinematics(arm, q)
    for i, result in enumerate(robokin.solve_ik(arm, T)):
        assert "unanswered" not in judge.faults(arm, truth.Scale(arm), q[i], T[i], result, ())
        assert not result.complete
