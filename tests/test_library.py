"""The library against the tables of its sources, copied independently, and the PUMA's frame sets against each other."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import data
from kinematics.reference import rot, trans

import robokin
from robokin.formats import library_names, load_any
from robokin.model import Robot

TABLES = data("tables.json")
LECTURE_ROBOTS = [
    "puma560", "scara", "scorbot", "fanuc", "stanford", "thumb", "planar2r", "planar3r", "planar3r-brac", "spherical",
    "anthropomorphic", "spherical-wrist", "anthropomorphic-wrist", "cylindrical", "cartesian", "scara-frames",
    "human-arm", "human-body", "assembly",
]  # fmt: skip
LECTURE_MECHANISMS = ["four-bar", "parallel-four-bar", "six-bar", "universal-joint", "sarrus"]


def table_pose(table, q_deg_mm):
    """The pose (4, 4) [mm] of a copied table."""
    T = np.eye(4)
    for (kind, offset, d, a, alpha, *_), value in zip(table["rows"], q_deg_mm, strict=True):
        turns = kind == "revolute"
        z = rot([0, 0, 1], np.radians(offset + value if turns else offset)) @ trans(0, 0, d if turns else d + value)
        x = trans(a, 0, 0) @ rot([1, 0, 0], np.radians(alpha))
        T = T @ (z @ x if table["convention"] == "standard" else x @ z)
    return T


def table_values(table, q):
    """The table's joint values for the robot's: another zero and other senses where the maker has them so."""
    return np.array(table.get("senses", 1)) * q + np.array(table.get("shifts", 0))


def placed(table, T):
    base = np.eye(4) if table["base"] is None else np.array(table["base"])
    tool = np.eye(4) if table["tool"] is None else np.array(table["tool"])
    return base @ T @ tool


@pytest.mark.parametrize("table", TABLES, ids=[f"{i}-{table['id']}" for i, table in enumerate(TABLES)])
def test_the_file_is_the_table(table, rng):
    robot = robokin.load(table["id"])
    turns = np.array([row[0] == "revolute" for row in table["rows"]])
    for q in [np.zeros(robot.n), *rng.uniform(-150, 150, (4, robot.n))]:
        T = robokin.forward_kinematics(robot, q * np.where(turns, np.pi / 180, 1e-3))
        T[:3, 3] *= 1e3
        expected = placed(table, table_pose(table, table_values(table, q)))
        assert np.max(np.abs(T[:3, 3] - expected[:3, 3])) <= table["tolerance_mm"]
        assert np.max(np.abs(T[:3, :3] - expected[:3, :3])) <= table["tolerance_rotation"]


@pytest.mark.parametrize("table", [t for t in TABLES if t["zero_position_mm"]], ids=lambda t: t["id"])
def test_the_printed_zero_pose(table):
    T = table_pose(table, np.zeros(len(table["rows"])))
    assert np.max(np.abs(T[:3, 3] - table["zero_position_mm"])) <= table["zero_tolerance_mm"]
    assert np.max(np.abs(T[:3, :3] - table["zero_rotation"])) <= 5e-7


@pytest.mark.parametrize("table", TABLES, ids=[f"{i}-{table['id']}" for i, table in enumerate(TABLES)])
def test_limits_are_those_of_the_table(table):
    """To the digits that the source prints: four for tables derived from a URDF."""
    robot = robokin.load(table["id"])
    for joint, (kind, *_, low, high) in zip(robot.joints, table["rows"], strict=True):
        if low is None or joint.unlimited:
            continue
        scale = 180 / np.pi if kind == "revolute" else 1e3
        # 0.06: a limit printed to four digits, such as -166.0 for -166.0031.
        assert np.array(joint.limits) * scale == pytest.approx([low, high], abs=0.06)


def test_everything_of_the_lectures_is_there():
    assert set(LECTURE_ROBOTS) | set(LECTURE_MECHANISMS) <= set(library_names())
    assert all(isinstance(load_any(name), Robot) for name in LECTURE_ROBOTS)
    assert not any(isinstance(load_any(name), Robot) for name in LECTURE_MECHANISMS)
    assert sum(isinstance(load_any(name), Robot) for name in library_names()) >= 75


@pytest.mark.parametrize("name", library_names())
def test_every_entry_states_its_source(name):
    entry = load_any(name)
    assert entry.id == name
    assert len(entry.source) > 15
    assert entry.name
    assert entry.description


def test_the_pumas_frame_sets_are_one_arm(rng):
    """Where the wrist's axes meet, in Lee's, Paul's, Craig's and Armstrong's frames.

    The dimensions differ a little from source to source, so each set is compared with Lee's table made of
    its own dimensions: q_Paul = q_Lee + 180° and q_Craig,3 = q_Lee,3 + 180° on the first three joints.
    """
    shift = {
        "puma560-paul": np.array([np.pi, np.pi, np.pi]),
        "puma560-craig": np.array([0.0, 0.0, np.pi]),
        "puma560-akb": np.zeros(3),
    }
    lee = robokin.load("puma560")
    q = rng.uniform(-2, 2, (50, 3))
    full = np.concatenate([q, np.zeros((50, 3))], axis=1)
    centre = robokin.link_frames(lee, full)[:, 4, :3, 3]
    for name, offset in shift.items():
        robot = robokin.load(name)
        values = np.concatenate([q + offset, np.zeros((50, 3))], axis=1)
        # The origin of frame 5 is the wrist centre in every set.
        found = robokin.link_frames(robot, values)[:, 5, :3, 3]
        # 431.8 against 433.07 mm in d4 and 149.09 against 150.05 in d3 are the greatest differences.
        assert np.max(np.linalg.norm(found - centre, axis=1)) < 2.5e-3, name


def test_the_thumb_lies_along_y_at_zero():
    T = robokin.forward_kinematics(robokin.load("thumb"), np.zeros(5))
    assert np.allclose(1e3 * T[:3, 3], [0, 46.2 + 31.6 + 27.4, 0], atol=1e-9)


def test_the_body_stretches_its_arm_sideways_at_zero():
    robot = robokin.load("human-body")
    L = robot.parameters
    T = robokin.forward_kinematics(robot, np.zeros(21))
    sideways, up = -(L["L5"] + L["L6"] + L["L7"] + L["L8"]), L["L1"] + L["L2"] + L["L3"] + L["L4"]
    assert np.allclose(T[:3, 3], [sideways, up, 0], atol=1e-12)


def test_parameters_change_the_robot():
    T = robokin.forward_kinematics(robokin.load("planar3r", a1=2.0, a2="1/2", a3=0.25), np.zeros(3))
    assert np.allclose(T[:3, 3], [2.75, 0, 0]) or robokin.load("planar3r").units.length != "m"
