"""Next to singular poses: solutions that nearly meet, self-motions that nearly are, what may be said of the list."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from inverse.arms import OFFSET_WRIST, SPHERICAL_WRIST, configurations, random_chain
from inverse.judge import faults, listed
from inverse.loops import RIGHT, parallel_loop, spherical_loop
from inverse.truth import Scale, least_singular_value, search
from sweeps import sweep

import robokin
from robokin.inverse import target_block
from robokin.inverse.analysis import analysis_of, trial_closing
from robokin.inverse.claims import unclaimed
from robokin.inverse.closed_form.spherical_wrist import SphericalTriple
from robokin.inverse.closed_form.three_parallel_axes import ThreeParallel
from robokin.inverse.elimination.homotopy import Homotopy
from robokin.inverse.elimination.loop import loop_of
from robokin.inverse.elimination.monodromy import two_starts
from robokin.inverse.self_motion.tangent_cone import null_spaces
from robokin.inverse.verify import Found, distinct, nothing
from robokin.kernel.chain import chain_of, chain_size
from robokin.kernel.residual import error_and_jacobian
from robokin.model import Joint, JointType, Robot

SCARAS = ("scara", "adept-one", "tp80")


def in_si(robot, q):
    """Joint values from degrees and millimetres."""
    return np.where(robot.revolute, np.radians(q), np.asarray(q) / 1000.0)


def answered(robot, q):
    """The answer to the pose of q: (n,) [rad | m], and the laws that it breaks."""
    T = robokin.forward_kinematics(robot, q)
    result = robokin.solve_ik(robot, T)
    return result, faults(robot, Scale(robot), q, T, result)


@pytest.mark.parametrize(
    ("name", "q"),
    sweep([
        ("crx10ia-lp", [-179.9999497903, 135.0000113712, -269.9999592868, 9.95356e-06, 180.0, 224.999951469]),
        ("crx3ia", [-90.000030359, -180.0, 90.0000309494, 179.9999502569, 90.0000450105, -179.9999688021]),
        ("epson-g6-651s", [89.9999703078, 5.36084e-05, 89.9992580009, -180.0000238943]),
        ("i4-650h", [89.9999926624, -5.383e-05, 0.000621971, 90.0000133246]),
        ("j2n6s200", [180.0000157999, 179.9999686488, 179.99995383, 2.93009e-05, -5.11627e-06, 4.65088e-05]),
        ("j2s6s300", [90.0000179549, 180.0000055598, 179.9999567229, 180.0000219808, 269.9999763492, 90.000012055]),
        ("rx160l", [-45.0000054829, -89.9999467501, -5.48196e-05, -45.0000431558, -89.9999657572, 44.9999752078]),
        ("stanford", [180.0000390029, 7.64963e-06, 787.399909392, -44.999993249, -89.9999966657, -5.34148e-05]),
    ], 4),
)  # fmt: skip
def test_two_roots_that_joint_values_hardly_tell_apart_are_listed_once(name, q):
    """They are 1.5e-6 apart, and the pose midway is off by 1e-13."""
    robot = robokin.load(name)
    _, broken = answered(robot, in_si(robot, q))
    assert broken == []


@pytest.mark.parametrize(
    ("name", "q"),
    sweep([
        ("crx20ia-l", [-90.000019602, 1.56636e-05, 89.9999980853, -90.0000468192, -3.77675e-05, 90.0000377606]),
        ("hc10", [-90.0000381726, -180.0, 4.87852e-05, -45.0000022374, 179.999987828, -179.9999469354]),
        ("irb1600", [-179.9999481469, -6.05401e-07, -90.0000098636, 90.000023869, -4.72607e-05, 1.53845e-06]),
    ], 3),
)  # fmt: skip
def test_what_leaves_the_pose_by_rounding_only_is_a_self_motion(name, q):
    """Along a curve of two rad the error is below 1e-12: members of it were listed as solutions that stand alone."""
    robot = robokin.load(name)
    result, broken = answered(robot, in_si(robot, q))
    assert broken == []
    assert result.families


@pytest.mark.parametrize("name", SCARAS)
def test_a_straight_scara_has_one_solution_and_that_is_said(name, rng):
    robot = robokin.load(name)
    q = configurations(robot, Scale(robot), rng, 2, "grid 30")
    q[:, 1] = 0.0
    for one in q:
        result, broken = answered(robot, one)
        assert broken == []
        assert len(result.solutions) == 1
        assert result.complete, result.certificate


@pytest.mark.parametrize("name", ["stanford", "stanford-arte"])
def test_a_slide_beside_a_straight_wrist_leaves_nothing_open(name, rng):
    """The wrist's self-motions are all there are where the levers of the other axes are long."""
    robot = robokin.load(name)
    for one in configurations(robot, Scale(robot), rng, 8, "grid 45"):
        result, broken = answered(robot, one)
        assert broken == []
        short = any(len(family.joints) > 2 for family in result.families)
        assert result.complete or short, result.certificate


def test_an_axis_through_the_wrist_is_no_reason_to_call_a_list_complete():
    """The first joint of a spherical arm is free where the wrist stands on its axis: not only the wrist's turns are."""
    rows = [
        Joint("q1", JointType.REVOLUTE, d=0.4, alpha=-RIGHT),
        Joint("q2", JointType.REVOLUTE, alpha=RIGHT),
        Joint("q3", JointType.PRISMATIC, limits=(0.1, 1.0)),
        Joint("q4", JointType.REVOLUTE, alpha=-RIGHT),
        Joint("q5", JointType.REVOLUTE, alpha=RIGHT),
        Joint("q6", JointType.REVOLUTE, d=0.1),
    ]
    robot = Robot("spherical arm", tuple(rows))
    analysis = analysis_of(robot)
    for second, fifth, few in ((0.4, 0.7, True), (0.4, 0.0, True), (0.0, 0.7, False)):
        T = robokin.forward_kinematics(robot, [0.3, second, 0.5, 0.3, fifth, 0.2])
        marks = analysis.solver.candidates(analysis.loop.closing(T[None]))
        assert marks.few.tolist() == [few]
        assert marks.near.tolist() == [fifth == 0.0 or not few]


@pytest.mark.parametrize("off", [1e-5, 3e-6, 1e-6])
@pytest.mark.parametrize("name", sweep(["lrmate200ic", "puma560", "tx2-90", "xarm6"], 4))
def test_a_wrist_that_is_nearly_straight_is_counted(name, off):
    """Newton's steps in complex numbers tell the ends of paths apart that are nearly singular."""
    robot = robokin.load(name)
    q = np.radians([40.0, -50.0, 60.0, 30.0, 0.0, 20.0])
    q[4] += off
    if name == "xarm6":
        q = np.radians([20.0, -30.0, -60.0, 0.0, 60.0, 10.0]) + off * np.array([0.3, -0.2, 0.5, 0.4, -0.1, 0.2])
    result, broken = answered(robot, q)
    assert broken == []
    assert result.complete, result.certificate


def test_the_ends_of_paths_at_a_double_root_are_not_told_apart():
    robot = robokin.load("puma560")
    loop = loop_of(chain_of(robot))
    homotopy = Homotopy(loop)
    q = np.tile([0.3, 0.5, 0.0, 0.4, 0.9, 0.2], (2, 1))

    def side(elbow):
        return np.sign(np.linalg.det(robokin.jacobian(robot, [*q[0, :2], elbow, *q[0, 3:]])))

    low, high = -1.5238, -1.5240  # between them the elbow is straight
    assert side(low) != side(high)
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if side(middle) == side(low) else (low, middle)
    q[:, 2] = low
    q[1, 2] += 3e-5
    account = homotopy.account(loop.closing(robokin.forward_kinematics(robot, q)))
    assert account.regular[0] < account.count
    assert account.singular[0]
    assert account.regular[1] == account.count


@pytest.mark.parametrize("k", range(4))
def test_chains_next_to_round_poses(k):
    """What is called complete there lacks nothing that Newton's method finds."""
    rng = np.random.default_rng([77, k])
    robot = random_chain(rng)
    scale = Scale(robot)
    for q in configurations(robot, scale, rng, 2, ("round + 1e-06", "round + 1e-09")[k % 2]):
        T = robokin.forward_kinematics(robot, q)
        result = robokin.solve_ik(robot, T)
        known = search(robot, scale, T, rng, guesses=100)[0] if result.complete else ()
        broken = faults(robot, scale, q, T, result, known)
        assert [law for law in broken if law != "on no family" or result.complete] == []


# How many solutions a closed form's equations have ----------------------------------------------------------------


def number_of(loop):
    """N by another way: tours of complex targets."""
    found = two_starts(loop)
    return None if found is None else found[0].values.shape[1]


@pytest.mark.parametrize("name", sweep(["stanford", "z1", "scorbot-er4u"], 3))
def test_a_closed_form_has_no_fewer_branches_than_there_are_solutions(name):
    analysis = analysis_of(robokin.load(name))
    number = number_of(analysis.loop)
    assert number is not None
    assert analysis.number >= number


@pytest.mark.parametrize(
    ("form", "make", "types"),
    sweep(
        [
            (SphericalTriple, spherical_loop, "RPR"),
            (SphericalTriple, spherical_loop, "PRR"),
            (ThreeParallel, parallel_loop, "RRP"),
        ],
        3,
    ),
)
def test_random_loops_with_closed_forms_have_no_more_solutions_than_branches(form, make, types, rng):
    loop = make(rng, 1, types, True)
    number = number_of(loop)
    assert number is None or form.find(loop).candidates(trial_closing(loop)).leaves >= number


def test_the_poses_here_are_what_they_are_meant_to_be():
    robot = robokin.load("lrmate200ic")
    q = np.radians([40.0, -50.0, 60.0, 30.0, 0.0, 20.0])
    q[4] += 1e-6
    least = least_singular_value(robot, Scale(robot), q)
    assert 1e-8 < least < 1e-6
    assert len(listed(robot, robokin.solve_ik(robot, robokin.forward_kinematics(robot, q), limits=False))) >= 2


# Limits -----------------------------------------------------------------------------------------------------------


def with_limits(robot, limits):
    """The robot with other limits: (n, 2) [rad | m]."""
    rows = tuple(replace(row, limits=tuple(ends)) for row, ends in zip(robot.rows, limits.tolist(), strict=True))
    return Robot(robot.name, rows, convention=robot.convention)


def limits_around(robot, q, rng):
    """Limits that q: (n,) is just within: equal ones, some an ulp apart, one-sided ones, none, and more than a turn."""
    out = np.empty((robot.n, 2))
    for k, value in enumerate(q):
        turn, ulp = 2 * np.pi if robot.revolute[k] else 1.0, np.spacing(abs(value))
        ways = (
            (value, value + 0.7),
            (value - 0.7, value),
            (value, value),
            (value - ulp, value + ulp),
            (value, np.inf),
            (-np.inf, value),
            (value - 2 * turn, value + 0.3),
            (-np.inf, np.inf),
        )
        out[k] = ways[rng.integers(len(ways))]
    return out


@pytest.mark.parametrize("kind", ["grid 90", "round + 1e-08", "round + 1e-07", "round + 1e-06"])
@pytest.mark.parametrize("name", sweep(["kr5-scara-r350", "cobra-s800", "xmate-cr7", "irb140"], 4))
def test_limits_that_a_configuration_is_just_within(name, kind):
    """What stands for two roots that nearly meet may be outside the limits where one of the two is inside."""
    base = robokin.load(name)
    rng = np.random.default_rng([5, len(name), len(kind)])
    for q in configurations(base, Scale(base), rng, 2, kind):
        robot = with_limits(base, limits_around(base, q, rng))
        _, broken = answered(robot, q)
        assert broken == [], (np.degrees(q).tolist(), robot.limits.tolist())


def test_a_self_motion_whose_members_count_twice_is_within_exact_limits():
    """The arm is stretched and its wrist straight: Newton's steps alone leave half of the digits."""
    base = robokin.load("tx2-60")
    q = np.radians([0.0, 0.0, 0.0, -270.0, 0.0, 90.0])
    limits = np.stack([q, q], axis=1)
    limits[3, 1] += 1.6
    limits[5, 0] -= 2.0
    result, broken = answered(with_limits(base, limits), q)
    assert broken == []
    assert result.solutions[0].free == (4, 6)
    assert np.max(np.abs(result.solutions[0].q[:3])) < 1e-12


@pytest.mark.parametrize("name", ["ur5e", "big-yam", "cobra-s600", "crx10ia", "scorbot"])
def test_without_limits_the_wish_itself_is_first_however_often_its_joints_are_turned(name):
    robot = robokin.load(name)
    rng = np.random.default_rng(8)
    for kind in ("random", "grid 45", "round + 1e-09"):
        q = configurations(robot, Scale(robot), rng, 1, kind)[0]
        q = q + 2 * np.pi * rng.integers(-2, 3, robot.n) * robot.revolute
        result = robokin.solve_ik(robot, robokin.forward_kinematics(robot, q), limits=False, near=q)
        assert np.max(np.abs(result.solutions[0].q - q)) < 1e-6
        assert result.solutions[0].within_limits == bool(robot.within_limits(result.solutions[0].q))


@pytest.mark.slow
def test_a_self_motion_is_not_given_up_for_roots_beside_it():
    """With a stretched arm and a straight wrist the pose is hardly off at what is beside the self-motion."""
    robot, rng = SPHERICAL_WRIST, np.random.default_rng(6)
    q = np.radians([[-90, 90, 180, 90, 180, 180], [90, 90, 180, 90, -180, -180]])
    others = np.radians(rng.integers(-4, 5, (6, 6)) * 45.0)
    others[:, [2, 4]] = np.radians([180.0, 180.0])
    for values in np.concatenate([q, others]):
        result, broken = answered(robot, values)
        assert broken == []
        assert (4, 6) in [family.joints for family in result.families]


@pytest.mark.parametrize("q", [[-90, 180, 180, 0, -90, 0], [30, 180, 180, 0, -90, 60]])
def test_a_self_motion_that_comes_back_from_one_limit_as_it_goes_beyond_another(q):
    """One point of it is within the limits, 0.005 rad from a longer piece."""
    robot = OFFSET_WRIST
    result, broken = answered(robot, np.radians(q))
    assert broken == []
    points = [arc.q for family in result.families for arc in family.arcs if len(arc.q) == 1]
    assert any(np.allclose(point[0], np.radians(q), rtol=0, atol=1e-8) for point in points)


def test_what_a_search_finds_of_a_double_root_is_listed_once(monkeypatch):
    robot = robokin.load("ur5e")
    q = np.radians([20.0, -70.0, 0.0, 40.0, 50.0, 10.0])
    T, chain = robokin.forward_kinematics(robot, q), analysis_of(robot).chain
    v = null_spaces(error_and_jacobian(chain, T[None], q[None], chain_size(chain))[1][0])[0][0]

    def search(analysis, T, *rest):
        both = Found(np.zeros(2, dtype=np.intp), np.stack([q + 4e-6 * v, q - 5e-6 * v]), np.zeros(2), np.zeros(2))
        error, _ = error_and_jacobian(analysis.chain, np.repeat(T, 2, axis=0), both.q, analysis.size)
        return replace(both, position=np.linalg.norm(error[:, :3], axis=1), angle=np.linalg.norm(error[:, 3:], axis=1))

    monkeypatch.setattr(target_block, "solve_block", lambda analysis, T, *rest: (nothing(6), unclaimed(len(T))))
    monkeypatch.setattr(target_block, "closing_nearest", search)
    (solution,) = robokin.solve_ik(robot, T).solutions
    assert np.max(np.abs(solution.q - q)) < 1e-10


def test_a_closed_form_whose_lost_roots_are_beside_a_short_lever_is_looked_at_again():
    """Three roots meet, which takes five digits of them, and the elbow does not reach: with q4 = 0 four axes are
    parallel and turn as a four-bar linkage."""
    robot = random_chain(np.random.default_rng([561, 82]))
    q = configurations(robot, Scale(robot), np.random.default_rng(3), 2, "q4 = 0")
    first = [94.92727861749901, -125.95761559948428, -38.60742138213164, 0.0, -171.78747244697522, 70.34079013161018]
    for values in np.concatenate([np.radians([first]), q]):
        result, broken = answered(robot, values)
        assert broken == []
        assert result.families


WITHIN = [
    # Numbers of random chains (seed 560), and configurations [deg | mm] beside or at limits at which roots are so near
    # to each other that joint values hardly tell them apart: of the chains' joints some are within, some outside.
    (143, [89.99994874354839, 459.99996127192395, 424.9996714513121,
           -179.99994551396736, -89.99996596864852, 44.99998070233786]),
    (163, [150.0, 120.0, 266.6666666666667, 0.0, 0.0, 420.0]),
    (252, [950.0, -120.0, 0.0, 0.0, 120.0, 90.0]),
    (264, [680.0, -150.0, -180.0, 340.0]),
]  # fmt: skip


@pytest.mark.parametrize(("number", "values"), sweep(WITHIN, 2))
def test_a_root_within_the_limits_is_not_given_up_for_one_outside(number, values):
    robot = random_chain(np.random.default_rng([560, number]))
    q = np.where(robot.revolute, np.radians(values), np.array(values) / 1000.0)
    T = robokin.forward_kinematics(robot, q)
    for result in (robokin.solve_ik(robot, T), robokin.solve_ik(robot, T[None])[0]):
        assert result.solutions
        assert all(solution.within_limits for solution in result.solutions)


LEFT_TO_ROUNDING = Robot(
    "a chain on which no split of the true loop finds the same number twice",
    (
        Joint("q1", JointType.REVOLUTE, d=0.27, a=0.32, alpha=np.radians(-10.573684785170268)),
        Joint("q2", JointType.PRISMATIC, a=0.09, alpha=np.pi, limits=(0.0, 0.49)),
        Joint("q3", JointType.REVOLUTE, a=0.29, alpha=np.pi),
        Joint("q4", JointType.REVOLUTE, alpha=RIGHT),
        Joint("q5", JointType.PRISMATIC, a=-0.46, alpha=np.pi, limits=(0.0, 0.68)),
        Joint("q6", JointType.REVOLUTE, a=-0.32, alpha=np.pi),
    ),
)


def test_splits_that_find_another_number_at_every_pose_do_not_count():
    """Between them they found two of the four complex solutions, and answers of two were called complete."""
    robot = LEFT_TO_ROUNDING
    assert analysis_of(robot).number == 4
    rng, scale = np.random.default_rng(680), Scale(robot)
    for kind in ("random", "grid 90", "q4 = 0", "round + 1e-09"):
        for q in configurations(robot, scale, rng, 5, kind):
            result, broken = answered(robot, q)
            # Of a chain that is singular at most round poses a singular configuration may be missed, and it is said.
            assert not broken or (broken == ["on no family"] and not result.complete)


@pytest.mark.parametrize("q", [[30, 30, 90, -30, 90, -60], [90, 90, 90, 90, 90, -180]])
@pytest.mark.parametrize("off", [0.0, 1e-14, 1e-13, 1e-12])
def test_a_straight_wrist_on_a_stretched_arm_keeps_its_self_motion(q, off):
    """At a root that counts many times a curve leads away that is not seen from where Newton's steps end beside it."""
    robot = robokin.load("motomini")
    q = np.radians(q) + off * np.random.default_rng(1).uniform(-1.0, 1.0, 6)
    result, broken = answered(robot, q)
    assert not broken
    assert len(result.families) == 1


def test_a_self_motion_that_touches_a_corner_of_nearly_full_turns_has_a_piece_of_one_point():
    """Three joints meet their limits at once, and those of a joint are so near to a full turn that it may have two."""
    robot = robokin.load("mycobot-280")
    low, high = robot.limits.T
    q = np.array([high[0], high[1], low[2], RIGHT, -RIGHT, high[5]])
    result, broken = answered(robot, q)
    assert not broken
    assert any(len(arc.q) == 1 for family in result.families for arc in family.arcs)


def test_what_has_not_settled_counts_for_nothing(rng):
    """Where four solutions meet, four places that Newton's steps left 1e-5 apart were counted as all there are."""
    robot = random_chain(np.random.default_rng([560, 455]))
    q = np.array([np.pi, np.pi / 2, 0.38, 0.0, -np.pi / 2, -np.pi / 2])
    T = np.tile(robokin.forward_kinematics(robot, q), (60, 1, 1))
    T[:, :3] += 2e-16 * rng.normal(size=(60, 3, 4))
    for result in robokin.solve_ik(robot, T):
        assert not result.complete
        assert any(np.max(np.abs(solution.q - q)) < 1e-4 for solution in result.solutions)


def test_solutions_that_nearly_meet_come_in_one_order_whatever_order_they_are_found_in(rng):
    """Their first four joints are the same to a few hundredths of a degree."""
    robot = robokin.load("ur7e")
    q = np.radians([201.283, 261.887, 165.849, 354.990, 67.443, -153.293])
    near = q + 6e-6 * rng.normal(size=(7, 6))
    index, off = np.repeat([0, 1], [7, 4]), np.zeros(11)
    all_q = np.concatenate([near, near[:3], near[:1] + 1.0])  # the second target has fewer, and one elsewhere
    expected = distinct(Found(index, all_q, off, off), robot.revolute, 1.0)
    assert len(expected) == 11
    for _ in range(5):
        shuffled = Found(index, all_q, off, off).pick(rng.permutation(11))
        assert np.array_equal(distinct(shuffled, robot.revolute, 1.0).q, expected.q)
