"""Which joints move the tool's origin, over which values, and what kind of set that makes."""

from __future__ import annotations

import pickle
from dataclasses import replace

import numpy as np
import pytest
from sweeps import sweep

import robokin
from robokin.errors import InputError
from robokin.model import Joint, JointType, Robot
from robokin.spatial import rotation_transform, translation_transform
from robokin.workspace.extremes import extent
from robokin.workspace.sampling import joint_values, positions
from robokin.workspace.space import joint_box, space_of

INF = np.inf


def revolute(name, limits=(-INF, INF), **cells):
    return Joint(name, JointType.REVOLUTE, limits=limits, **cells)


def slide(name, limits=(0.0, 0.5), **cells):
    return Joint(name, JointType.PRISMATIC, limits=limits, **cells)


@pytest.mark.parametrize(
    ("name", "dimension", "moving", "quantity"),
    [
        ("planar2r", 2, 2, "area"),
        ("planar3r", 2, 3, "area"),
        ("puma560", 3, 5, "volume"),
        ("stanford", 3, 5, "volume"),
        ("scara", 3, 3, "volume"),
        ("cylindrical", 3, 3, "volume"),
        ("cartesian", 3, 3, "volume"),
        ("panda", 3, 6, "volume"),
    ],
)
def test_the_library_s_arms_have_the_dimension_they_should(name, dimension, moving, quantity):
    space = space_of(robokin.load(name))
    assert space.dimension == dimension
    assert space.moving == tuple(range(moving))
    assert space.quantity == quantity


def test_curves_surfaces_and_points():
    circle = space_of(Robot("circle", (revolute("1", a=1.0),)))
    assert (circle.dimension, circle.basis is None, circle.quantity) == (1, True, "length")
    line = space_of(Robot("line", (slide("1"),)))
    assert line.dimension == 1
    assert np.allclose(np.abs(line.basis[:, 0]), [0, 0, 1])
    torus = space_of(Robot("torus", (revolute("1", a=1.0, alpha=np.pi / 2), revolute("2", a=0.3))))
    assert (torus.dimension, torus.basis is None) == (2, True)
    point = space_of(Robot("point", (revolute("1"),)))
    assert (point.dimension, point.moving, point.quantity) == (0, (), "point")


def test_a_flat_set_lies_in_its_plane_wherever_the_base_stands(rng):
    base = translation_transform([0.3, -0.2, 0.9]) @ rotation_transform([1.0, -2.0, 0.5], 1.1)
    space = space_of(replace(robokin.load("planar3r"), base=base))
    assert np.allclose(space.basis.T @ space.basis, np.eye(2))
    assert np.allclose(space.basis.T @ base[:3, 2], 0, atol=1e-9)
    p = positions(space, joint_values(space, "random", 0, 0, 100, 100)).T
    assert np.allclose((p - space.centre) @ base[:3, 2], 0, atol=1e-12)


def test_symmetry_is_about_the_first_axis_if_that_makes_a_whole_turn():
    base = translation_transform([0.3, -0.2, 0.9]) @ rotation_transform([1.0, -2.0, 0.5], 1.1)
    free = Robot("free", (revolute("1", a=0.4), revolute("2", (-1, 1), a=0.3, alpha=0.5), slide("3")), base=base)
    space = space_of(free)
    assert np.allclose(space.axis[:3, 2], base[:3, 2])
    assert np.allclose(np.cross(space.axis[:3, 3] - base[:3, 3], base[:3, 2]), 0, atol=1e-12)
    tied = replace(free, rows=(revolute("1", (-3, 3), a=0.4), *free.rows[1:]))
    assert space_of(tied).axis is None
    assert space_of(robokin.load("cartesian")).axis is None


def test_a_whole_turn_is_made_once():
    rows = (
        revolute("1", a=1.0),
        revolute("2", (-7.0, 7.0), a=1.0),
        revolute("3", (0.0, INF), a=1.0),
        revolute("4", (-INF, 1.0), a=1.0),
        revolute("5", (-1.0, 2.0), a=1.0),
        revolute("6", (0.0, 2 * np.pi), a=1.0),
        slide("7", (-0.1, 0.2)),
    )
    low, high, full = joint_box(Robot("turns", rows))
    assert full.tolist() == [True, True, True, True, False, True, False]
    assert np.allclose(low, [-np.pi, -np.pi, 0, 1 - 2 * np.pi, -1, 0, -0.1])
    assert np.allclose((high - low)[full], 2 * np.pi)
    assert np.allclose(high[~full], [2.0, 0.2])


def test_sliding_joints_without_limits_are_named():
    endless = slide("1", (-INF, INF)), revolute("2"), slide("3", (0.0, INF))
    with pytest.raises(InputError, match="joints 1, 3 slide without limits, expected limits"):
        space_of(Robot("endless", endless))
    with pytest.raises(InputError, match="joint 1 slides without limits, expected limits"):
        space_of(Robot("endless", endless[:2]))


def test_a_robot_without_joints_has_no_workspace():
    with pytest.raises(InputError, match="has no joints"):
        space_of(Robot("post", (Joint("1", JointType.FIXED, d=1.0),)))


def test_scale_and_units_do_not_matter():
    robot = robokin.load("puma560")
    for k in (1e-4, 1.0, 1e4):
        rows = tuple(replace(row, a=k * row.a, d=k * row.d) for row in robot.rows)
        space = space_of(replace(robot, rows=rows))
        assert (space.dimension, space.moving) == (3, (0, 1, 2, 3, 4))


def test_a_space_travels_between_processes():
    space = space_of(robokin.load("scara"))
    again = pickle.loads(pickle.dumps(space))
    assert (again.moving, again.dimension, again.size) == (space.moving, space.dimension, space.size)
    assert np.array_equal(again.low, space.low)


@pytest.mark.parametrize("name", sweep(["puma560", "stanford", "planar3r", "ur5e", "viperx300s"], 3))
def test_a_joint_that_its_limits_hold_is_no_joint(name):
    """The same set as that of the robot with a fixed row there, which has the same poses."""
    robot = robokin.load(name)
    for i in range(robot.n):
        low, high = np.clip(robot.limits[i], -1.0, 1.0)
        value = 0.3 * low + 0.7 * high
        rows = [replace(row, limits=(value, value)) if row is robot.joints[i] else row for row in robot.rows]
        held = replace(robot, rows=tuple(rows))
        space = space_of(held)
        assert list(np.flatnonzero(space.held)) == [i]
        assert i not in space.moving
        q = np.random.default_rng(i).uniform(-1.0, 1.0, robot.n)
        q[i] = value
        same = robokin.forward_kinematics(space.arm, np.delete(q, i))
        assert np.allclose(robokin.forward_kinematics(held, q), same, atol=1e-12)
        fixed = space_of(space.arm)
        assert (fixed.dimension, len(fixed.moving)) == (space.dimension, len(space.moving))
        these, those = extent(space), extent(fixed)
        assert np.allclose(these.high, those.high, atol=1e-8)
        assert these.q_high[0, i] == pytest.approx(value)


def test_a_planar_arm_with_a_held_joint_has_finitely_many_orientations():
    robot = robokin.load("planar3r")
    rows = [replace(row, limits=(0.5, 0.5)) if k == 2 else row for k, row in enumerate(robot.rows)]
    found = robokin.analyse_workspace(replace(robot, rows=tuple(rows)), samples=1 << 13, dextrous=True)
    a, b, c = (row.a for row in robot.rows)
    hand = np.hypot(b + c * np.cos(0.5), c * np.sin(0.5))
    truth = 4.0 * np.pi * a * hand
    assert abs(found.measure.value - truth) <= found.measure.error < 1e-3 * truth
    assert found.dexterity.group == "finite"
    assert found.dexterity.several.value == pytest.approx(found.measure.value, rel=1e-3)
    assert found.dexterity.every.value == 0.0
