"""Names of solutions: unique among the solutions of a pose, continuous, and of the arm rather than of its table."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sweeps import sweep

import robokin
from robokin.formats import library_names, load_any
from robokin.inverse.analysis import analysis_of
from robokin.inverse.solution_names import branch_names
from robokin.inverse.solve import solve_ik, solve_many
from robokin.inverse.verify import wrapped
from robokin.kernel.chain import chain_of
from robokin.kinematics.forward import joint_frames
from robokin.kinematics.structure import structure_of
from robokin.model import Joint, JointType, Robot
from robokin.spatial import rotation_from_rpy, transform

RIGHT = np.pi / 2
ARMS = [entry.id for entry in map(load_any, library_names()) if isinstance(entry, Robot) and 1 <= entry.n <= 6]
PUMA = {
    "shoulder right, elbow up, wrist no-flip", "shoulder right, elbow up, wrist flip",
    "shoulder right, elbow down, wrist no-flip", "shoulder right, elbow down, wrist flip",
    "shoulder left, elbow up, wrist no-flip", "shoulder left, elbow up, wrist flip",
    "shoulder left, elbow down, wrist no-flip", "shoulder left, elbow down, wrist flip",
}  # fmt: skip


def arm(table, convention="standard", **more):
    """A robot of rows (type, d, a, alpha) or (type, d, a, alpha, theta or offset)."""
    rows = []
    for kind, d, a, alpha, *theta in table:
        turns = kind == "R"
        start = theta[0] if theta else 0.0
        rows.append(
            Joint(
                f"joint {len(rows) + 1}", JointType.REVOLUTE if turns else JointType.PRISMATIC, d=d, a=a, alpha=alpha,
                theta=0.0 if turns else start, offset=start if turns else 0.0,
            )
        )  # fmt: skip
    return Robot("arm", tuple(rows), convention=convention, **more)


def random_values(robot, rng, count):
    scale = np.where(robot.revolute, np.pi, analysis_of(robot).size)
    return rng.uniform(-1.0, 1.0, (count, robot.n)) * scale


def names_at(robot, q, **more):
    """For each configuration q (m, n): the names of all solutions of its pose, and its own, or None."""
    found = solve_many(robot, robokin.forward_kinematics(robot, q), limits=False, **more)
    every = iter(found.branches())
    answers = []
    for i, count in enumerate(found.count.tolist()):
        names = [next(every) for _ in range(count)]
        gap = np.max(np.abs(wrapped(found.q[i, :count] - q[i], robot.revolute)), axis=1)
        answers.append((names, names[int(np.argmin(gap))] if count and np.min(gap) < 1e-5 else None))
    return answers


@pytest.mark.parametrize("name", sweep(ARMS, 5))
def test_no_two_solutions_of_a_pose_have_one_name(name, rng):
    robot = robokin.load(name)
    for names, own in names_at(robot, random_values(robot, rng, 20)):
        assert own is not None
        assert len(set(names)) == len(names), names


@pytest.mark.parametrize(
    "name", ["puma560", "irb1600", "stanford", "ur5", "yam", "piper-old", "scara", "scorbot", "planar3r"]
)
def test_a_name_stays_as_the_arm_moves_a_little(name, rng):
    robot = robokin.load(name)
    q = random_values(robot, rng, 60)
    step = 1e-5 * rng.normal(size=q.shape)
    for (_, here), (_, there) in zip(names_at(robot, q), names_at(robot, q + step), strict=True):
        assert here == there


def test_a_name_stays_on_a_way_without_singularities(rng):
    # The wrist passes above the shoulder, which stands 150 mm before the first axis: nothing is singular there.
    robot = robokin.load("irb1600")
    q = np.linspace([0.3, -0.7, 0.0, 0.4, 0.7, 0.2], [0.3, -1.0, 0.0, 0.4, 0.7, 0.2], 30)
    ahead = joint_frames(robot, q)[:, 4, :2, 3] @ [np.cos(0.3), np.sin(0.3)]
    assert ahead[0] > 0.15 > ahead[-1] > 0.0
    assert {own for _, own in names_at(robot, q)} == {"shoulder right, elbow up, wrist no-flip"}


@pytest.mark.parametrize("name", ["puma560", "puma560-craig", "irb120", "fanuc", "ur5", "ur10e", "yam", "cr5"])
def test_eight_solutions_have_the_eight_names(name, rng):
    robot = robokin.load(name)
    eight = [names for names, _ in names_at(robot, random_values(robot, rng, 60)) if len(names) == 8]
    assert eight
    assert all(set(names) == PUMA for names in eight)


def test_stanford_with_its_slide_on_either_side(rng):
    robot = robokin.load("stanford")
    for names, own in names_at(robot, random_values(robot, rng, 40)):
        assert len(set(names)) == len(names)
        assert own is not None
    q = np.array([[0.5, 0.7, 0.4, 0.3, 0.9, 0.2], [0.5, 0.7, -0.4, 0.3, 0.9, 0.2]])
    assert branch_names(robot, q) == [
        "shoulder right, slide forward, wrist no-flip", "shoulder right, slide backward, wrist no-flip",
    ]  # fmt: skip


def test_scara_has_one_elbow_in_every_quadrant():
    robot = robokin.load("scara")
    for turn in np.linspace(-np.pi, np.pi, 9):
        assert branch_names(robot, np.array([[turn, 0.8, 0.1, 0.3]])) == ["elbow down"]
        assert branch_names(robot, np.array([[turn, -0.8, 0.1, 0.3]])) == ["elbow up"]


@pytest.mark.parametrize(
    "name", ["anthropomorphic", "spherical", "cylindrical", "planar2r", "scara", "spherical-wrist"]
)
def test_positions_alone(name, rng):
    robot = robokin.load(name)
    for names, own in names_at(robot, random_values(robot, rng, 20), task="position"):
        if robot.n == 3 and name != "spherical-wrist":
            assert own is not None
        assert len(set(names)) == len(names), names


def modified(robot):
    """A standard table in the modified convention, which has a and alpha in the row of the joint that they precede."""
    rows, a, alpha = [], 0.0, 0.0
    for row in robot.rows:
        rows.append(replace(row, a=a, alpha=alpha, texts=()))
        a, alpha = row.a, row.alpha
    tool = transform(rotation_from_rpy([alpha, 0.0, 0.0]), np.array([a, 0.0, 0.0])) @ robot.tool
    return replace(robot, rows=tuple(rows), convention="modified", tool=tool)


@pytest.mark.parametrize("name", ["puma560", "ur5", "stanford", "irb1600", "scara", "scorbot", "hc10", "crx10ia"])
def test_both_conventions_give_the_same_names(name, rng):
    robot = robokin.load(name)
    assert robot.convention == "standard"
    other = modified(robot)
    q = random_values(robot, rng, 20)
    T = robokin.forward_kinematics(robot, q)
    assert np.allclose(T, robokin.forward_kinematics(other, q), rtol=0, atol=1e-12)
    one, two = solve_many(robot, T, limits=False), solve_many(other, T, limits=False)
    assert np.array_equal(one.count, two.count)
    assert one.branches() == two.branches()
    assert analysis_of(robot).size == pytest.approx(analysis_of(other).size, rel=1e-12)


def calibrated():
    """The UR5 but for 3 mm: axes 2, 3 and 4 at 5e-5 and 4e-4 rad, whose common normals are hundreds of metres off.

    Manufacturers give such tables: d2, d3 and d4 are what a fit made of them.
    """
    robot = robokin.load("ur5")
    rows = list(robot.rows)
    d2, d3, d4 = 574.24, -507.36, -66.77
    alpha2 = -4.8e-5
    alpha3 = -alpha2 * (d3 + d4) / d4
    # Near the arm axis 3 lies aside of x by y2, and axis 4 by y3: the links are as long as they were, and turned.
    y2, y3 = -alpha2 * d3, -alpha3 * d4
    a2, a3 = -np.sqrt(0.425**2 - y2**2), -np.sqrt(0.39225**2 - y3**2)
    turn2, turn3 = np.arctan2(-y2, -a2), np.arctan2(-y3, -a3)
    rows[1] = replace(rows[1], d=d2, alpha=alpha2, a=a2, offset=-turn2)
    rows[2] = replace(rows[2], d=d3, alpha=alpha3, a=a3, offset=turn2 - turn3)
    rows[3] = replace(rows[3], d=d4, offset=turn3)
    return replace(robot, rows=tuple(rows), poses={})


@pytest.mark.slow
def test_a_calibrated_arm_has_the_names_of_the_arm_that_it_is(rng):
    nominal, robot = robokin.load("ur5"), calibrated()
    q = random_values(nominal, rng, 40)
    T = robokin.forward_kinematics(nominal, q)
    assert np.max(np.abs(robokin.forward_kinematics(robot, q) - T)) < 4e-3
    for (names, own), (expected, own_expected) in zip(names_at(robot, q), names_at(nominal, q), strict=True):
        assert own == own_expected
        assert sorted(names) == sorted(expected)


def test_a_number_is_the_same_with_and_without_limits(rng):
    robot = robokin.load("xarm6")
    for T in robokin.forward_kinematics(robot, random_values(robot, rng, 15)):
        every = solve_ik(robot, T, limits=False).solutions
        for solution in solve_ik(robot, T).solutions:
            gaps = [np.max(np.abs(wrapped((one.q - solution.q)[None], robot.revolute))) for one in every]
            assert every[int(np.argmin(gaps))].branch == solution.branch
        first = solve_ik(robot, T, limits=False, most=2).solutions
        assert [solution.branch for solution in first] == [solution.branch for solution in every[:2]]


@pytest.mark.parametrize("name", sweep(["iiwa14", "panda", "gen3", "xarm7", "j2s7s300"], 5))
def test_seven_joints_at_one_held_value(name, rng):
    robot = robokin.load(name)
    window = analysis_of(robot).window
    held = [i for i in range(robot.n) if not window.first <= i < window.last]
    for T in robokin.forward_kinematics(robot, random_values(robot, rng, 3)):
        named = [(*np.round(s.q[held], 6), s.branch) for s in solve_ik(robot, T, limits=False, most=200).solutions]
        assert named
        assert len(set(named)) == len(named)


def test_axes_that_coincide_are_no_wrist():
    # Axes 5 and 6 are one line, so the last three axes meet in a point without being a wrist.
    table = [("R", 0.6, 0.0, RIGHT), ("R", 0.0, 0.432, 0.0), ("R", 0.0, 0.0, -RIGHT), ("R", 0.432, 0.0, RIGHT),
             ("R", 0.0, 0.0, 0.0), ("R", 0.4, 0.0, 0.0)]  # fmt: skip
    robot = arm(table)
    assert structure_of(robot).wrist == "not spherical: axes 4, 5, 6 do not meet in one point"


@pytest.mark.parametrize("task", ["pose", "position", "approach"])
@pytest.mark.parametrize("name", ["anthropomorphic", "spherical", "cylindrical", "cartesian", "planar3r", "scara"])
def test_no_method_claims_a_wrist_that_the_arm_has_not(name, task):
    assert "wrist" not in analysis_of(robokin.load(name), task).method
    assert "wrist" not in analysis_of(robokin.load(name), task).sentence


def test_no_configuration_has_no_name():
    assert branch_names(robokin.load("puma560"), np.zeros((0, 6))) == []
    assert branch_names(robokin.load("cartesian"), np.zeros((1, 3))) == [""]


@pytest.mark.parametrize("part", [0.003, 0.03])
def test_arms_that_are_nearly_special(part, rng):
    # A wrist that is out by a little has more than eight solutions at some poses: numbers tell apart what signs do not.
    robot = robokin.load("puma560")
    rows = list(robot.rows)
    rows[4] = replace(rows[4], a=part * analysis_of(robot).size)
    other = replace(robot, rows=tuple(rows))
    for names, own in names_at(other, random_values(robot, rng, 20)):
        assert own is not None
        assert len(set(names)) == len(names)


def test_the_frames_of_a_table_are_moved_to_the_arm():
    chain = chain_of(calibrated())
    assert np.max(np.abs(chain.constants[:, :3, 3])) < 0.5
