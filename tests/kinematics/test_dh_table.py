"""Another convention is another way to say the same robot: every pose stays, however the axes lie."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sweeps import sweep

import robokin
from robokin.errors import InputError, InputTypeError
from robokin.formats import read_text
from robokin.kinematics.common_normal import normal_step
from robokin.model import Joint, JointType, Robot
from robokin.spatial import rotation_from_rpy, rotation_transform, transform, translation_transform
from robokin.spatial.dh import standard_dh
from robokin.units import Units

from .placed_axes import ROBOTS, SAME, WAYS, deviation, kept, placed_chain, step_between

CONVENTIONS = ("standard", "modified", "frames")
BATCH = 50


@pytest.mark.parametrize("seed", sweep(range(1000 // BATCH), 7))
def test_random_chains_of_every_kind_go_round(seed):
    rng = np.random.default_rng(seed)
    for _ in range(BATCH):
        robot = placed_chain(rng)
        for convention, other in (("standard", "modified"), ("modified", "standard")):
            table = robokin.to_convention(robot, convention)
            kept(robot, table)
            frames = robokin.to_convention(table, "frames")
            there = robokin.to_convention(table, other)
            for made in (table, frames, robokin.to_convention(frames, convention), there,
                         robokin.to_convention(there, convention)):  # fmt: skip
                assert deviation(robot, made) <= SAME
            assert table.convention == convention
            assert all(row.a >= 0.0 for row in table.rows)


@pytest.mark.parametrize("name", sweep(ROBOTS, 6))
def test_every_robot_of_the_library_goes_round(name):
    robot = robokin.load(name)
    for first in CONVENTIONS:
        made = robokin.to_convention(robot, first)
        kept(robot, made)
        assert made.notes == robot.notes
        for second in CONVENTIONS:
            back = robokin.to_convention(made, second)
            assert back.convention == second
            assert deviation(robot, back) <= SAME


@pytest.mark.parametrize("way", WAYS)
def test_a_step_along_the_common_normal_is_the_step(way):
    rng = np.random.default_rng(3)
    for _ in range(100):
        C = step_between(rng, way)
        step = normal_step(C, 1e-13)
        made = standard_dh(step.theta, step.d, step.a, step.alpha) @ standard_dh(step.phi, step.e, 0.0, 0.0)
        assert np.max(np.abs(made - C)) < 1e-13 * (1.0 + step.feet)
        assert step.a >= 0.0
        if way in ("parallel", "antiparallel", "coincident", "turned round"):
            assert (step.d, step.alpha) == (0.0, np.pi if way in ("antiparallel", "turned round") else 0.0)
        if way in ("coincident", "turned round"):
            assert (step.theta, step.a) == (0.0, 0.0)
        if step.a == 0.0:
            assert abs(step.theta) <= np.pi / 2 + 1e-12


def cells(robot):
    units = robot.units
    turns = [row.type is JointType.REVOLUTE for row in robot.rows]
    return [
        [(row.offset if turn else row.theta) / units.radians, (row.d if turn else row.offset) / units.metres,
         row.a / units.metres, row.alpha / units.radians]
        for row, turn in zip(robot.rows, turns, strict=True)
    ]  # fmt: skip


def test_the_stanford_arm_comes_back_from_frames_cell_by_cell():
    """Its axes leave no choice but signs, and those are the table's."""
    robot = robokin.load("stanford")
    back = robokin.to_convention(robokin.to_convention(robot, "frames"), "standard")
    assert cells(back) == cells(robot)
    assert np.array_equal(back.tool, np.eye(4))


def test_the_pumas_table_is_craigs():
    """J. J. Craig, Introduction to Robotics, 3rd ed., fig. 3.21: row i holds a and alpha of the link before."""
    standard = robokin.load("puma560")
    modified = robokin.to_convention(standard, "modified")
    assert [(row.a, row.alpha) for row in modified.rows[1:]] == [(row.a, row.alpha) for row in standard.rows[:-1]]
    assert (modified.rows[0].a, modified.rows[0].alpha) == (0.0, 0.0)
    assert cells(robokin.to_convention(modified, "standard")) == cells(standard)


def test_what_names_a_parameter_moves_with_its_cell():
    robot = robokin.load("planar3r")
    modified = robokin.to_convention(robot, "modified")
    assert dict(robot.rows[0].texts)["a"] == dict(modified.rows[1].texts)["a"]
    assert deviation(robot, robokin.to_convention(modified, "standard")) == 0.0


def test_a_robot_in_the_convention_is_returned_as_it_is():
    for name, convention in (("puma560", "standard"), ("panda", "modified"), ("scara-frames", "frames")):
        robot = robokin.load(name)
        assert robokin.to_convention(robot, convention) is robot


def test_the_numbers_are_round_where_those_of_the_robot_are():
    table = robokin.to_convention(robokin.load("scara-frames"), "standard")
    assert cells(table) == [[90.0, 0.0, 325.0, 0.0], [0.0, 0.0, 275.0, 180.0], [90.0, -387.0, 0.0, 180.0]]


def frames_robot(*steps, kinds="", tool=(0.1, 0.2, 0.3)):
    kinds = kinds or "R" * len(steps)
    rows = [
        Joint(f"j{i}", JointType.REVOLUTE if kind == "R" else JointType.PRISMATIC, origin=step)
        for i, (kind, step) in enumerate(zip(kinds, steps, strict=True), start=1)
    ]
    return Robot("arm", tuple(rows), "frames", tool=translation_transform(tool))


def tilted(angle, kinds="RR", p=(0.3, 0.2, 0.1)):
    """Two joints whose axes are a small angle from parallel, and askew."""
    return frames_robot(np.eye(4), transform(rotation_transform([1.0, 0.3, 0.0], angle)[:3, :3], p), kinds=kinds)


@pytest.mark.parametrize("convention", ["standard", "modified"])
@pytest.mark.parametrize("half", [0.0, np.pi])
def test_nearly_parallel_axes_are_told_from_parallel_ones(convention, half):
    for angle in (1e-16, 1e-13):
        assert robokin.to_convention(tilted(half + angle), convention).notes == ()
    for angle in (1e-11, 9e-10):
        made = robokin.to_convention(tilted(half + angle), convention)
        assert f"axes {angle:.1g} rad from parallel are taken as parallel" in made.notes[0].message
        assert angle / 10 < deviation(tilted(half + angle), made) < 10 * angle
    for angle in (2e-9, 1e-6, 1e-4):
        with pytest.raises(InputError, match=rf"j1 and j2 of arm are {angle:.2g} rad .* convention frames holds them"):
            robokin.to_convention(tilted(half + angle), convention)
    for angle in (2e-3, 0.02):
        assert deviation(tilted(half + angle), robokin.to_convention(tilted(half + angle), convention)) <= SAME


@pytest.mark.parametrize("kinds", ["RP", "PR", "PP"])
@pytest.mark.parametrize("angle", [2e-9, 1e-6, 1e-4, 5e-4])
def test_a_slide_may_be_nearly_parallel_to_its_neighbour(kinds, angle):
    """It has a direction and no place: its axis is put where it meets the other one."""
    robot = tilted(angle, kinds)
    for convention in ("standard", "modified"):
        made = robokin.to_convention(robot, convention)
        assert deviation(robot, made) <= SAME
        assert max(abs(row.d) for row in made.rows) < 1.0


def test_nearly_parallel_axes_that_meet_nearby_have_a_table():
    robot = tilted(1e-5, p=(0.0, 0.0, 0.4))
    assert deviation(robot, robokin.to_convention(robot, "standard")) <= SAME


def test_a_calibrated_table_changes_between_tables_though_its_feet_are_far_away():
    """Cells only change rows: there is nothing to be lost, wherever the common normals are."""
    row = "{type: R, d: -574.1, a: -0.4, alpha: 0.0006}"
    robot = read_text(f"robokin: 1\nname: a\njoints:\n  - {row}\n  - {{type: R, d: 574.2, a: -0.39, alpha: 0.001}}\n")
    there = robokin.to_convention(robot, "modified")
    assert cells(robokin.to_convention(there, "standard")) == cells(robot)


@pytest.mark.parametrize("scale", [1e-6, 1e-3, 1e3, 1e5])
def test_the_size_of_an_arm_does_not_matter(scale):
    rng = np.random.default_rng(11)

    def scaled(T):
        return transform(T[:3, :3], scale * T[:3, 3])

    for _ in range(15):
        robot = placed_chain(rng)
        rows = tuple(
            replace(row, origin=scaled(row.origin), offset=row.offset * (scale if row.type == "prismatic" else 1.0))
            for row in robot.rows
        )
        robot = replace(robot, rows=rows, base=scaled(robot.base), tool=scaled(robot.tool))
        for convention in ("standard", "modified"):
            assert deviation(robot, robokin.to_convention(robot, convention)) <= SAME


def test_units_change_no_pose():
    rng = np.random.default_rng(12)
    for length in ("m", "cm", "mm", "in"):
        for angle in ("rad", "deg"):
            robot = replace(placed_chain(rng), units=Units(length, angle))
            assert deviation(robot, robokin.to_convention(robot, "standard")) <= SAME


def test_fixed_rows_go_into_the_others():
    turn = transform(rotation_from_rpy([0.3, 0.2, 0.1]), [0.1, 0.2, 0.3])
    rows = [Joint("f0", JointType.FIXED, origin=turn), Joint("a", JointType.REVOLUTE, origin=np.eye(4)),
            Joint("f1", JointType.FIXED, origin=turn), Joint("b", JointType.REVOLUTE, origin=turn),
            Joint("f2", JointType.FIXED, origin=turn)]  # fmt: skip
    robot = Robot("arm", tuple(rows), "frames")
    for convention in ("standard", "modified"):
        table = robokin.to_convention(robot, convention)
        assert [row.name for row in table.rows] == ["a", "b"]
        assert deviation(robot, table) <= SAME


@pytest.mark.parametrize("convention", CONVENTIONS)
def test_a_robot_without_joints(convention):
    turn = transform(rotation_from_rpy([0.3, 0.2, 0.1]), [0.1, 0.2, 0.3])
    row = Joint("f", JointType.FIXED, theta=1.0, d=2.0, a=3.0, alpha=0.5)
    still = Joint("f", JointType.FIXED, origin=turn)
    for robot in (Robot("post", (still,), "frames", tool=turn), Robot("post", (row,), base=turn)):
        made = robokin.to_convention(robot, convention)
        found = robokin.forward_kinematics(made, []), robokin.forward_kinematics(robot, [])
        assert np.max(np.abs(found[0] - found[1])) < 1e-15


def test_what_is_no_robot_and_no_convention_is_refused():
    with pytest.raises(InputTypeError, match="expected a Robot"):
        robokin.to_convention("puma560", "standard")
    with pytest.raises(InputError, match="expected 'standard', 'modified' or 'frames'"):
        robokin.to_convention(robokin.load("puma560"), "craig")
