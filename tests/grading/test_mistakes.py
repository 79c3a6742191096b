"""Known mistakes are named where they are made, and nowhere else."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sweeps import sweep

import robokin
from robokin.grading.answer_mistakes import joints_mistake, pose_mistake
from robokin.grading.answers.answered_poses import pose_from
from robokin.grading.configuration_marks import reached
from robokin.grading.marking import Subject
from robokin.grading.pose_difference import PASS, pose_errors, pose_status, pose_value
from robokin.grading.same_robot import OPEN, compare_tables
from robokin.grading.table_mistakes import table_mistake
from robokin.grading.tolerance import default_tolerance
from robokin.grading.wrong_cells import wrong_cells
from robokin.units import METRES

from .tables import redrawn

NAMES = ["puma560", "anthropomorphic", "scara", "planar3r", "stanford", "ur5", "m1013", "cylindrical"]
NOTHING_OPEN = frozenset()


def configuration(robot, rng):
    return np.where(robot.revolute, rng.uniform(-2.5, 2.5, robot.n), rng.uniform(0.1, 0.4, robot.n))


def said_pose(robot, T):
    """The numbers of a pose in the robot's units: x, y, z, roll, pitch, yaw."""
    value = pose_value(T, "pose", robot.units)
    return np.array([*value["position"], *value["rpy"]])


def subject_of(robot, units=None, allowed=None):
    return Subject(robot, units or robot.units, allowed or default_tolerance(robot))


def of_pose(robot, q, values, kind="rpy"):
    return pose_mistake(subject_of(robot), q, pose_from(values, kind, robot, robot.units))


@pytest.mark.parametrize("name", NAMES)
def test_poses(name, rng):
    robot = robokin.load(name)
    q = configuration(robot, rng)
    T = robokin.forward_kinematics(robot, q)
    right, units = said_pose(robot, T), robot.units
    other = next(unit for unit in ("mm", "m") if unit != units.length)
    lengths = np.where(np.arange(6) < 3, METRES[units.length] / METRES[other], 1.0)
    angles = np.where(np.arange(6) < 3, 1.0, np.pi / 180.0 if units.degrees else 180.0 / np.pi)
    assert of_pose(robot, q, right * lengths).name == "length unit"
    assert of_pose(robot, q, (right * lengths)[:3], "position").name == "length unit"
    if np.max(np.abs(right[3:])) * units.radians > 0.1:
        assert of_pose(robot, q, right * angles).name == "angle unit"
        assert of_pose(robot, q, right * angles * lengths).name == "length and angle unit"
    turned = T.copy()
    turned[:3, :3] = T[:3, :3].T
    if pose_errors(T, turned)[1] > 0.1:
        assert of_pose(robot, q, said_pose(robot, turned)).name == "inverse rotation"
    if abs(right[3] - right[5]) * units.radians > 0.1 and abs(right[3]) * units.radians > 0.1:
        swapped = right[[0, 1, 2, 5, 4, 3]]
        if pose_errors(T, pose_from(swapped, "rpy", robot, units).T)[1] > 0.1:
            assert of_pose(robot, q, swapped).name == "roll and yaw"


def test_the_order_of_a_quaternion(rng):
    robot = robokin.load("puma560")
    q = configuration(robot, rng)
    T = robokin.forward_kinematics(robot, q)
    w, x, y, z = robokin_quaternion(T)
    p = T[:3, 3] / robot.units.metres
    assert of_pose(robot, q, np.array([*p, x, y, z, w]), "quaternion").name == "order of the quaternion"


def robokin_quaternion(T):
    from robokin.spatial import quaternion_from_rotation

    return quaternion_from_rotation(T[:3, :3])


def test_what_the_question_may_be_taken_for(rng):
    robot = robokin.load("puma560-craig")
    q = configuration(robot, rng)
    T = robokin.forward_kinematics(replace(robot, convention="standard"), q)
    assert of_pose(robot, q, said_pose(robot, T)).name == "convention"
    robot = robokin.load("puma560")
    T = robokin.forward_kinematics(robot, -q)
    assert of_pose(robot, q, said_pose(robot, T)).name == "sign"


@pytest.mark.parametrize("name", NAMES)
def test_joint_values(name, rng):
    robot = robokin.load(name)
    q = configuration(robot, rng)
    T = robokin.forward_kinematics(robot, q)
    arguments = (T, "pose", False)
    turning = robot.revolute
    factor = 180.0 / np.pi if robot.units.degrees else np.pi / 180.0
    assert joints_mistake(subject_of(robot), np.where(turning, q / factor, q), *arguments).name == "angle unit"
    assert joints_mistake(subject_of(robot), np.where(turning, -q, q), *arguments).name == "sign"
    one = np.arange(robot.n) == int(np.argmax(turning))
    assert joints_mistake(subject_of(robot), q + one * np.pi / 2.0, *arguments).name == "zero"
    if not turning.all():
        other = 1000.0 if robot.units.length == "m" else 0.001
        if np.max(np.abs(q[~turning])) > 0.1:
            assert joints_mistake(subject_of(robot), np.where(turning, q, q * other), *arguments).name == "length unit"


# Tables ----------------------------------------------------------------------------------------------------


def of_table(right, given, free=NOTHING_OPEN):
    allowed = default_tolerance(right, table=True)
    assert not compare_tables(right, given, allowed, free).same
    return table_mistake(right, given, allowed, free)


def with_factors(robot, lengths, angles):
    rows = [
        replace(
            row, a=row.a * lengths, d=row.d * lengths, alpha=row.alpha * angles, theta=row.theta * angles,
            offset=row.offset * (angles if row.type.letter == "R" else lengths),
        )
        for row in robot.rows
    ]  # fmt: skip
    return replace(robot, rows=tuple(rows))


@pytest.mark.parametrize("name", ["puma560", "anthropomorphic", "stanford", "ur5", "m1013", "puma560-craig"])
def test_tables(name):
    robot = robokin.load(name)
    other = "modified" if robot.convention == "standard" else "standard"
    assert of_table(robot, replace(robot, convention=other)).name == "convention"
    # The numbers of the right table, under the units of another one.
    factor = 1000.0 if robot.units.length == "m" else 0.001
    assert of_table(robot, with_factors(robot, factor, 1.0)).name == "length unit"
    angle = np.pi / 180.0 if robot.units.degrees else 180.0 / np.pi
    assert of_table(robot, with_factors(robot, 1.0, angle)).name == "angle unit"
    assert of_table(robot, with_factors(robot, factor, angle)).name == "length and angle unit"


@pytest.mark.parametrize("name", sweep(["anthropomorphic", "puma560-craig", "stanford"], 3))
def test_one_wrong_cell_is_named(name, rng):
    robot = robokin.load(name)
    allowed = default_tolerance(robot, table=True)
    for i, row in enumerate(robot.rows):
        for column in ("a", "alpha", "offset"):
            angle = column != "a"
            value = getattr(row, column) + (np.pi / 2.0 if angle else 0.1)
            given = replace(robot, rows=(*robot.rows[:i], replace(row, **{column: value}), *robot.rows[i + 1 :]))
            if compare_tables(robot, given, allowed, NOTHING_OPEN).same:
                continue
            (cell,) = wrong_cells(robot, given, allowed, NOTHING_OPEN)
            assert (cell.row, cell.column) == (i + 1, column)
            assert cell.expected == pytest.approx(getattr(row, column))


def test_a_wrong_cell_is_found_in_a_table_with_frames_of_its_own():
    """The two tables of one arm: the cell is what the student's own table needs there."""
    right = robokin.load("anthropomorphic")
    own = replace(right, rows=tuple(replace(row, alpha=-row.alpha, a=-row.a, offset=row.offset) for row in right.rows))
    allowed = default_tolerance(right, table=True)
    # Rows turned by 180° about z have their lengths and twists the other way round.
    rows = [replace(row, offset=row.offset + (np.pi if i == 0 else 0.0)) for i, row in enumerate(own.rows)]
    tool = own.tool @ np.diag([-1.0, -1.0, 1.0, 1.0])
    own = replace(own, rows=tuple(rows), tool=tool)
    if not compare_tables(right, own, allowed, NOTHING_OPEN).same:
        pytest.skip("not the same arm drawn otherwise")
    row = own.rows[1]
    given = replace(own, rows=(own.rows[0], replace(row, a=row.a + 0.1), own.rows[2]))
    (cell,) = wrong_cells(right, given, allowed, NOTHING_OPEN)
    assert (cell.row, cell.column, cell.expected) == (2, "a", pytest.approx(row.a))


# No false accusations --------------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_random_wrong_answer_has_hardly_ever_a_known_mistake():
    """One in a hundred at most; and what is named is a coincidence of round angles."""
    rng = np.random.default_rng(11)
    named = count = 0
    robots = [robokin.load(name) for name in NAMES]
    for k in range(200):
        robot = robots[k % len(robots)]
        allowed, units = default_tolerance(robot), robot.units
        q, other = configuration(robot, rng), configuration(robot, rng)
        T = robokin.forward_kinematics(robot, q)
        values = said_pose(robot, robokin.forward_kinematics(robot, other))
        if k % 2:
            values = said_pose(robot, T) + rng.normal(size=6) * np.abs(values) * (rng.random(6) < 0.4)
        answer = pose_from(values, "rpy", robot, units)
        if pose_status(*pose_errors(T, answer.T), allowed, T) != PASS:
            count += 1
            named += pose_mistake(subject_of(robot, units, allowed), q, answer) is not None
        if not reached(robot, other, T, allowed, "pose", False).right:
            count += 1
            named += joints_mistake(subject_of(robot, units, allowed), other, T, "pose", False) is not None
    assert count > 300
    assert named <= count / 100


@pytest.mark.slow
def test_a_random_wrong_table_has_hardly_ever_a_known_mistake():
    rng = np.random.default_rng(12)
    named = count = 0
    names = ["anthropomorphic", "scara", "planar3r", "cylindrical"]
    for k in range(80):
        robot = robokin.load(names[k % len(names)])
        allowed = default_tolerance(robot, table=True)
        rows = list(robot.rows)
        for _ in range(rng.integers(1, 4)):
            i = int(rng.integers(len(rows)))
            column = str(rng.choice(["a", "alpha", "offset"]))
            value = float(rng.choice([0.0, np.pi / 2.0, -np.pi / 2.0, 0.3, 0.01]))
            rows[i] = replace(rows[i], **{column: value if column != "a" else 0.1 * value})
        given = replace(robot, rows=tuple(rows))
        free = frozenset(name for name in OPEN if rng.random() < 0.3)
        if not compare_tables(robot, given, allowed, free).same:
            count += 1
            named += table_mistake(robot, given, allowed, free) is not None
    assert count > 40
    assert named <= 1


def test_a_right_answer_is_right_and_its_table_too(rng):
    for name in NAMES:
        robot = robokin.load(name)
        other, _, _ = redrawn(robot, rng, 1.0)
        assert compare_tables(robot, other, default_tolerance(robot, table=True), NOTHING_OPEN).same
