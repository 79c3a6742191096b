"""Two tables are the same robot exactly when they bring the hand to the same place, but for what is left open."""

from __future__ import annotations

from itertools import chain, combinations

import numpy as np
import pytest
from library_entries import entry, names_of
from sweeps import sweep

import robokin
from robokin.grading.differences import difference_of
from robokin.grading.same_robot import OPEN, compare_tables, match, skeleton_of
from robokin.grading.tolerance import Tolerance, default_tolerance
from robokin.model import Joint, JointType, Robot
from robokin.spatial import invert

from .tables import redrawn, with_cell

ROBOTS = names_of(Robot, 1)
SUBSETS = list(chain.from_iterable(combinations(OPEN, count) for count in range(5)))
NOTHING_OPEN = frozenset()


def seeded(name):
    return np.random.default_rng(sum(map(ord, name)))


def table(types, rng, convention="standard"):
    """A random table with right angles, zeros and anything between in it, as tables have."""

    def cell(values):
        return float(rng.choice([0.0, 0.0, *values]))

    rows = []
    for i, letter in enumerate(types):
        cells = {"a": cell([0.3, -0.2, rng.uniform(-1, 1)]), "alpha": cell([np.pi / 2, -np.pi / 2, rng.uniform(-3, 3)])}
        cells["theta" if letter == "P" else "d"] = cell([0.4, rng.uniform(-1, 1)])
        cells["offset"] = cell([np.pi / 2 if letter == "R" else 0.2])
        rows.append(Joint(f"j{i}", JointType.REVOLUTE if letter == "R" else JointType.PRISMATIC, **cells))
    return Robot("random", tuple(rows), convention)


# The same --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", sweep(ROBOTS[::2], 3))
def test_other_frames_are_the_same_robot(name):
    rng, robot = seeded(name), robokin.load(name)
    allowed = default_tolerance(robot, table=True)
    for free in ((), OPEN, SUBSETS[rng.integers(len(SUBSETS))]):
        other, _, _ = redrawn(robot, rng, allowed.size, free)
        found = match(skeleton_of(robot), skeleton_of(other), allowed, frozenset(free))
        assert found.same, (free, found.joint, found.gap)


@pytest.mark.parametrize("seed", range(30))
def test_random_tables_redrawn_are_the_same_robot(seed):
    rng = np.random.default_rng(seed)
    robot = table(rng.choice(list("RRRP"), rng.integers(1, 8)), rng, str(rng.choice(["standard", "modified"])))
    allowed = default_tolerance(robot, table=True)
    free = SUBSETS[rng.integers(len(SUBSETS))]
    other, _, _ = redrawn(robot, rng, 1.0, free)
    found = compare_tables(robot, other, allowed, frozenset(free))
    assert found.same
    assert found.score == 1.0
    assert set(found.needs) <= set(free)


@pytest.mark.parametrize("name", ["puma560", "ur5", "scara", "stanford", "panda", "planar3r", "cartesian", "scorbot"])
def test_zeros_and_senses_are_found(name):
    """T_a(q) T_b(s (q + c))⁻¹ is one base for all q."""
    rng, robot = seeded(name), robokin.load(name)
    other, _, _ = redrawn(robot, rng, 1.0, ("base", "zero", "sign"))
    allowed = default_tolerance(robot, table=True)
    found = match(skeleton_of(robot), skeleton_of(other), allowed, frozenset(("base", "zero", "sign")))
    q = rng.uniform(-2.0, 2.0, (20, robot.n))
    T_a = robokin.forward_kinematics(robot, q)
    T_b = robokin.forward_kinematics(other, np.array(found.state.signs) * (q + found.zeros))
    bases = T_a @ invert(T_b)
    assert np.allclose(bases, bases[0], atol=1e-8)


def test_each_part_is_needed_where_it_differs():
    rng, robot = np.random.default_rng(6), robokin.load("puma560")
    allowed = default_tolerance(robot, table=True)
    for free in SUBSETS:
        other, _, _ = redrawn(robot, rng, 1.0, free)
        found = compare_tables(robot, other, allowed, NOTHING_OPEN)
        assert found.same == (not free)
        # A sense may come out as zeros of other joints, and the like, but never more parts than were changed.
        assert found.needs is not None
        assert len(found.needs) <= len(free)


def test_the_conventions_of_one_arm_agree():
    """C. Laschi's planar arm in three conventions: standard, modified (the last length in the tool), frames."""
    standard = robokin.load("planar3r")
    a = [row.a for row in standard.rows]
    joints = [Joint(f"j{i}", JointType.REVOLUTE, a=length) for i, length in enumerate([0.0, *a[:2]])]
    tool = np.eye(4)
    tool[0, 3] = a[2]
    modified = Robot("modified", tuple(joints), "modified", tool=tool)
    allowed = default_tolerance(standard, table=True)
    assert compare_tables(standard, modified, allowed, NOTHING_OPEN).same
    assert compare_tables(modified, standard, allowed, NOTHING_OPEN).same


# Different -------------------------------------------------------------------------------------------------

CELLS = ("a", "d", "alpha", "theta", "offset")


def changes(robot, allowed, factor):
    """The robot with each of its cells changed by a factor of what is allowed."""
    for number, row in enumerate(robot.rows):
        own = {JointType.REVOLUTE: "theta", JointType.PRISMATIC: "d", JointType.FIXED: "offset"}[row.type]
        for cell in CELLS:
            if cell == own:
                continue
            angle = cell in ("alpha", "theta") or (cell == "offset" and row.type is JointType.REVOLUTE)
            step = factor * (allowed.angle if angle else allowed.position)
            yield with_cell(robot, number, **{cell: getattr(row, cell) + step}), (number, cell)


TABLES = [name for name in ROBOTS if entry(name).convention != "frames"]


@pytest.mark.parametrize("name", sweep(TABLES[::6], 4))
@pytest.mark.parametrize("factor", sweep([1.05, -40.0], 2))
def test_a_changed_cell_is_not_the_same(name, factor):
    robot = robokin.load(name)
    allowed = default_tolerance(robot, table=True)
    right = skeleton_of(robot)
    for other, place in changes(robot, allowed, factor):
        if name == "raghavan-roth-rprrpr" and abs(factor) < 2.0:
            continue  # between oblique sliding joints no axis moves by more than is allowed
        assert not match(right, skeleton_of(other), allowed, NOTHING_OPEN).same, place


@pytest.mark.parametrize("name", sweep([name for name in TABLES[::6] if "P" not in entry(name).types], 4))
def test_a_cell_changed_by_less_is_the_same(name):
    robot = robokin.load(name)
    allowed = default_tolerance(robot, table=True)
    right = skeleton_of(robot)
    for other, place in changes(robot, allowed, 0.95):
        assert match(right, skeleton_of(other), allowed, NOTHING_OPEN).same, place


@pytest.mark.parametrize("seed", sweep(range(12), 4))
def test_sameness_is_that_of_the_poses(seed):
    """With nothing open: the same exactly when forward kinematics agree, whatever was changed in the table."""
    rng = np.random.default_rng(seed)
    robot = table(rng.choice(list("RRRP"), rng.integers(2, 7)), rng)
    allowed = default_tolerance(robot, table=True)
    q = rng.uniform(-2.0, 2.0, (10, robot.n))
    for other, _ in changes(robot, allowed, 2000.0):
        agree = np.allclose(robokin.forward_kinematics(robot, q), robokin.forward_kinematics(other, q), atol=1e-9)
        drawn, _, _ = redrawn(other, rng, 1.0)
        assert match(skeleton_of(robot), skeleton_of(drawn), allowed, NOTHING_OPEN).same == agree


@pytest.mark.parametrize("seed", sweep(range(8), 4))
def test_lengths_and_twists_tell_robots_apart_whatever_is_open(seed):
    rng = np.random.default_rng(100 + seed)
    rows = [
        Joint(f"j{i}", JointType.REVOLUTE, a=rng.uniform(0.1, 1), d=rng.uniform(0.1, 1), alpha=rng.uniform(0.4, 1.2))
        for i in range(5)
    ]
    robot = Robot("general", tuple(rows))
    allowed = default_tolerance(robot, table=True)
    for number, cell in [(0, "a"), (1, "a"), (1, "d"), (2, "alpha"), (3, "d"), (3, "alpha")]:
        angle = cell == "alpha"
        step = 1.1 * (allowed.angle if angle else allowed.position)
        other = with_cell(robot, number, **{cell: getattr(rows[number], cell) + step})
        drawn, _, _ = redrawn(other, rng, 1.0, OPEN)
        found = compare_tables(robot, drawn, allowed, frozenset(OPEN))
        assert not found.same
        assert found.needs is None
        (first, *_) = found.differences
        said = difference_of(first, allowed)
        # d of row i is the offset along axis i, seen when the axis after it is placed.
        assert said.joint == number + 2
        assert said.what.startswith({"a": "distance", "d": "offset", "alpha": "angle"}[cell])
        assert said.found - said.expected == pytest.approx(step, abs=1e-9)


def test_a_mirrored_arm_is_another_one():
    rng = np.random.default_rng(3)
    rows = [Joint(f"j{i}", JointType.REVOLUTE, a=0.3 + 0.1 * i, d=0.2, alpha=0.7 + 0.1 * i) for i in range(4)]
    robot = Robot("arm", tuple(rows))
    mirrored = Robot("mirror", tuple(Joint(r.name, r.type, a=r.a, d=-r.d, alpha=-r.alpha) for r in rows))
    allowed = default_tolerance(robot, table=True)
    drawn, _, _ = redrawn(mirrored, rng, 1.0)
    assert not compare_tables(robot, drawn, allowed, frozenset(OPEN)).same


@pytest.mark.parametrize("name", sweep(["puma560", "ur5", "scara", "stanford", "planar3r", "iiwa7"], 3))
def test_nothing_allowed_and_much_allowed(name):
    rng, robot = seeded(name), robokin.load(name)
    size = default_tolerance(robot).size
    other, _, _ = redrawn(robot, rng, 0.1, OPEN)
    for allowed in (Tolerance(1e-12, 1e-12, size=size), Tolerance(0.1 * size, 0.2, size=size)):
        assert compare_tables(robot, other, allowed, frozenset(OPEN)).same
    exact = Tolerance(0.0, 0.0, size=size)
    assert compare_tables(robot, robot, exact, NOTHING_OPEN).same
    assert not compare_tables(robot, with_cell(robot, 1, a=robot.rows[1].a + 1e-6), exact, NOTHING_OPEN).same


def test_one_slip_costs_one_joint():
    robot = robokin.load("puma560")
    allowed = default_tolerance(robot, table=True)
    other = with_cell(robot, 1, a=robot.rows[1].a + 0.1)
    assert compare_tables(robot, other, allowed, NOTHING_OPEN).score == pytest.approx(6 / 7)
    assert compare_tables(robot, other, allowed, frozenset(["tool"])).score == pytest.approx(5 / 6)


def test_other_joints_are_another_robot():
    found = compare_tables(
        robokin.load("puma560"), robokin.load("stanford"), default_tolerance(robokin.load("ur5")), NOTHING_OPEN
    )
    assert (found.same, found.match, found.score) == (False, None, 0.0)
