"""What is written loads again: the same robot, to the last digit where its units allow."""

from __future__ import annotations

import math
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest
from kinematics.placed_axes import ROBOTS, SAME, deviation, kept, placed_chain
from sweeps import sweep

import robokin
from robokin.formats import read_text
from robokin.formats.exact_numbers import angle_text, number_text, rpy_exactly, transform_text
from robokin.formats.number_expressions import Scope
from robokin.formats.transform_expressions import evaluate_transform
from robokin.formats.written_robot import written
from robokin.formats.written_urdf import urdf_text
from robokin.kernel.chain import chain_of, chain_size
from robokin.model import Joint, JointType, Robot
from robokin.spatial import rotation_from_rpy, transform
from robokin.units import Units

UNITS = [Units(length, angle) for length in ("m", "cm", "mm", "in") for angle in ("rad", "deg")]


def chains(seed, count):
    rng = np.random.default_rng(seed)
    for i in range(count):
        robot = replace(placed_chain(rng), units=UNITS[i % len(UNITS)])
        yield from (robokin.to_convention(robot, convention) for convention in ("standard", "modified", "frames"))


def expect_the_same(robot):
    text = written(robot)
    back = read_text(text)
    assert deviation(robot, back) <= SAME
    assert back.units == robot.units
    assert back.convention == robot.convention
    assert [row.name for row in back.rows] == [row.name for row in robot.rows]
    assert np.array_equal(np.isinf(back.limits), np.isinf(robot.limits))
    finite = np.isfinite(robot.limits)
    np.testing.assert_allclose(back.limits[finite], robot.limits[finite], rtol=4e-16, atol=0.0)


@pytest.mark.parametrize("seed", sweep(range(20), 7))
def test_random_chains_load_again(seed):
    for robot in chains(seed, 50):
        expect_the_same(robot)


@pytest.mark.parametrize("name", sweep(ROBOTS, 6))
def test_robots_of_the_library_load_again(name):
    robot = robokin.load(name)
    expect_the_same(robot)
    back = read_text(written(robot), id=robot.id)
    kept(replace(robot, poses={}, source=""), replace(back, poses={}, source=""))
    assert (back.name, back.description, back.source) == (robot.name, robot.description, robot.source)
    for pose, q in robot.poses.items():
        np.testing.assert_allclose(back.poses[pose], q, rtol=4e-16, atol=0.0)


def test_the_pumas_description_reads_as_people_write_it():
    text = written(robokin.load("puma560"))
    assert "  - {name: shoulder, type: revolute, d: 149.09, a: 431.8, alpha: 0, limits: [-225, 45]}\n" in text
    assert text.endswith("poses:\n  home: [90, 0, 90, 0, 0, 0]\n")
    assert "base:" not in text


@pytest.mark.parametrize("units", UNITS, ids=str)
def test_numbers_read_as_the_value_they_are_of(units):
    rng = np.random.default_rng(1)
    for typed in [0.0, 1.0, -90.0, 0.1, 431.8, 1e-7, 1e15, 123456789.125, *rng.normal(size=50)]:
        for factor in (units.metres, units.radians):
            value = typed * factor
            assert float(number_text(value, factor)) * factor == value
            assert len(number_text(value, factor)) <= len(repr(float(typed)))


def test_an_angle_in_radians_is_said_in_parts_of_pi():
    rad = Units("m", "rad")
    said = {math.pi: "pi", -math.pi / 2: "-pi/2", 2 * math.pi / 3: "2*pi/3", 1.5708: "1.5708", 0.0: "0", 1.0: "1"}
    assert {value: angle_text(value, rad) for value in said} == said
    assert angle_text(math.pi / 2, Units("m", "deg")) == "90"


@pytest.mark.parametrize("units", UNITS, ids=str)
def test_transforms_read_as_what_they_are(units):
    rng = np.random.default_rng(2)
    near = [np.pi / 2, -np.pi / 2, np.pi, 1e-9, np.pi / 2 - 1e-9, np.pi / 2 - 1e-7, 0.0, 0.5]
    for _ in range(200):
        angles = rng.choice(near, 3) if rng.random() < 0.7 else rng.uniform(-3, 3, 3)
        T = transform(rotation_from_rpy(angles), rng.normal(size=3) * (rng.random() < 0.7))
        text = transform_text(T, units)
        read = evaluate_transform(text, Scope(degrees=units.degrees), units)
        assert np.max(np.abs(read - T)) <= 1.1e-15, text
        again = rotation_from_rpy(rpy_exactly(T[:3, :3]))
        assert np.max(np.abs(again - T[:3, :3])) <= 1.1e-15
    assert transform_text(np.eye(4), units) == ""


def test_names_and_texts_that_yaml_would_read_as_something_else():
    odd = [
        "null",
        "yes",
        "a: b",
        "a #b",
        "- a",
        "'q'",
        '"',
        "{x}",
        "[1]",
        "é 漢",
        "a\\b",
        "1e3",
        "~",
        "@a",
        "%a",
        "x,y",
    ]
    rows = tuple(Joint(name, JointType.REVOLUTE, a=1.0) for name in odd)
    robot = Robot("# name: x", rows, description="a: b\nc", source="\x1b[31m 'red'", poses={"up": np.zeros(len(odd))})
    back = read_text(written(robot))
    assert [row.name for row in back.rows] == odd
    assert (back.name, back.description, back.source) == ("# name: x", "a: b c", "[31m 'red'")


def test_no_letter_steers_a_terminal():
    robot = Robot("a\u202eb \U000e0001c", (Joint("\u200fx", JointType.REVOLUTE, a=1.0),), source="\u202e")
    assert all(letter.isprintable() or letter == "\n" for letter in written(robot) + urdf_text(robot))
    back = read_text(written(robot))
    assert (back.name, back.rows[0].name, back.source) == (robot.name, robot.rows[0].name, robot.source)


def test_names_that_are_there_twice_and_none_at_all():
    robot = Robot("", tuple(Joint(name, JointType.REVOLUTE, a=1.0) for name in ("a", "a", "", "2")))
    assert [row.name for row in read_text(written(robot)).rows] == ["a", "a_2", "3", "2"]
    root = ElementTree.fromstring(urdf_text(robot))
    assert [joint.get("name") for joint in root.iter("joint")] == ["a", "a_2", "joint_3", "joint_2", "tool"]


def test_a_joint_with_one_limit():
    robot = Robot("a", (Joint("x", JointType.PRISMATIC, limits=(-np.inf, 0.5)),))
    assert read_text(written(robot)).limits.tolist() == [[-1e6, 0.5]]
    (limit,) = ElementTree.fromstring(urdf_text(robot)).iter("limit")
    assert (limit.get("lower"), limit.get("upper")) == ("-1000000", "0.5")


# URDF -------------------------------------------------------------------------------------------------------------


def numbers(text):
    return [float(part) for part in text.split()]


def turned(axis, angle):
    """Rodrigues' formula."""
    x, y, z = axis
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + math.sin(angle) * K + (1 - math.cos(angle)) * K @ K


def urdf_pose(text, q):
    """The pose of the last link: the product of the joints, as the format has it, in the order of the chain."""
    root = ElementTree.fromstring(text)
    joints = {joint.find("parent").get("link"): joint for joint in root.findall("joint")}
    values, T, link = list(q), np.eye(4), "base_link"
    while link in joints:
        joint = joints[link]
        link = joint.find("child").get("link")
        if (origin := joint.find("origin")) is not None:
            r, p, y = numbers(origin.get("rpy"))
            T = T @ transform(turned([0, 0, 1], y) @ turned([0, 1, 0], p) @ turned([1, 0, 0], r),
                              numbers(origin.get("xyz")))  # fmt: skip
        if joint.get("type") == "fixed":
            continue
        axis, value = np.array(numbers(joint.find("axis").get("xyz"))), values.pop(0)
        slides = joint.get("type") == "prismatic"
        T = T @ (transform(np.eye(3), axis * value) if slides else transform(turned(axis, value), np.zeros(3)))
    assert not values
    assert link == root.findall("link")[-1].get("name")
    return T


def expect_the_same_urdf(robot, rng):
    text = urdf_text(robot)
    size = chain_size(chain_of(robot))
    for _ in range(3):
        q = np.where(robot.revolute, 1.0, size) * rng.uniform(-3, 3, robot.n)
        off = np.abs(urdf_pose(text, q) - robokin.forward_kinematics(robot, q))
        assert np.max(off[:3, 3]) <= SAME * size
        assert np.max(off[:3, :3]) <= SAME


@pytest.mark.parametrize("seed", sweep(range(20), 7))
def test_a_urdf_has_the_poses_of_random_chains(seed):
    rng = np.random.default_rng(seed)
    for robot in chains(seed + 100, 17):
        expect_the_same_urdf(robot, rng)


@pytest.mark.parametrize("name", sweep(ROBOTS, 6))
def test_a_urdf_has_the_poses_of_the_library(name):
    robot = robokin.load(name)
    expect_the_same_urdf(robot, np.random.default_rng(0))
    root = ElementTree.fromstring(urdf_text(robot))
    for part in ("link", "joint"):
        names = [one.get("name") for one in root.findall(part)]
        assert len({*names}) == len(names)
    moving = [joint for joint in root.findall("joint") if joint.get("type") != "fixed"]
    assert len(moving) == robot.n
    for joint, own in zip(moving, robot.joints, strict=True):
        limit = joint.find("limit")
        assert (joint.get("type") == "continuous") == (limit is None)
        if limit is None:
            assert own.unlimited
            continue
        assert {"lower", "upper", "effort", "velocity"} == {*limit.keys()}
        if not own.unlimited:
            assert (float(limit.get("lower")), float(limit.get("upper"))) == own.limits


def test_a_urdf_of_hostile_names_is_well_formed():
    rows = tuple(Joint(name, JointType.REVOLUTE, a=1.0) for name in ('"><x>', "--", "a b", "a_b", "\x00", "漢"))
    robot = Robot("<robot> -- & -", rows, source="]]> --> <!-- ---")
    root = ElementTree.fromstring(urdf_text(robot))
    names = [joint.get("name") for joint in root.findall("joint")]
    assert names == ["x", "joint_--", "a_b", "a_b_2", "joint_5", "joint_6", "tool"]
