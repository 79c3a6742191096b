"""The arms of the library against the manufacturers' own descriptions, read by `vendor_urdf` and kept as figures."""

from __future__ import annotations

import math

import numpy as np
import pytest
from conftest import data
from library_entries import names_of
from vendor_urdf import Urdf, figures

import robokin
from robokin.model import Robot

VENDORS = data("vendors.json")

MAKERS_OWN = {"openarm-left", "openarm-right", "r1pro-left", "r1pro-right", "viperx300s", "widowx250s", "z1"}
"""Arms whose tool frame is their maker's, with another axis than z out of the flange."""
NO_FLANGE = {"raghavan-roth-1990", "raghavan-roth-rprrpr", "manocha-canny-1994"}
"""Tables of the literature that are no machine's."""


def values(robot, q):
    """Joint values [rad | m] of those in degrees and millimetres."""
    return np.array(q) * np.where([joint.type == "prismatic" for joint in robot.joints], 1e-3, math.pi / 180)


def rotation(w, x, y, z):
    """The rotation (3, 3) of a unit quaternion: the vector part turns by its double."""
    v = np.array([x, y, z])
    K = np.cross(np.eye(3), v)
    return np.eye(3) + 2 * w * K + 2 * K @ K


@pytest.mark.parametrize("entry", VENDORS, ids=lambda entry: entry["id"])
def test_the_flange_is_where_the_maker_has_it(entry):
    """Positions to a nanometre, or to the rounding of the source."""
    robot = robokin.load(entry["id"])
    tolerance = entry.get("tolerance_mm", 1e-5)
    for q, position, quaternion in entry["poses"]:
        T = robokin.forward_kinematics(robot, values(robot, q))
        assert np.max(np.abs(1e3 * T[:3, 3] - position)) < tolerance
        assert np.max(np.abs(T[:3, :3] - rotation(*quaternion))) < max(1e-8, 1e-2 * tolerance)


@pytest.mark.parametrize("entry", VENDORS, ids=lambda entry: entry["id"])
def test_the_limits_are_the_makers(entry):
    """To three digits of radians, as some sources print them. What differs more says why."""
    robot = robokin.load(entry["id"])
    for i, (joint, limits) in enumerate(zip(robot.joints, entry["limits"], strict=True), start=1):
        if str(i) in entry.get("other_limits", {}):
            continue
        assert joint.unlimited == (limits is None), i
        if limits is not None:
            scale = 1e3 if joint.type == "prismatic" else 180 / math.pi
            assert np.array(joint.limits) * scale == pytest.approx(limits, abs=0.06), i


def test_every_figure_has_its_source():
    assert len({entry["id"] for entry in VENDORS}) == len(VENDORS) >= 80
    for entry in VENDORS:
        assert all(entry[key] for key in ("repository", "file", "commit", "licence", "base", "tip"))


@pytest.mark.parametrize(
    "name",
    names_of(Robot, 6),
)
def test_z_points_out_of_the_flange(name):
    """ISO 9787: from the origin of the last link's frame to the flange, where these are two places."""
    robot = robokin.load(name)
    if name in MAKERS_OWN | NO_FLANGE:
        return
    frames = robokin.link_frames(robot, np.zeros(robot.n))
    tool = robokin.forward_kinematics(robot, np.zeros(robot.n))
    axis, way = frames[robot.n - 1, :3, 2], tool[:3, 3] - frames[robot.n - 1, :3, 3]
    length = axis @ way
    if robot.convention == "standard" and abs(length) > 1e-3 and "lecture" not in robot.source:
        assert tool[:3, 2] @ (axis * length) > 0


URDF = """<robot name="two">
 <joint name="a" type="revolute"><parent link="base"/><child link="one"/><origin xyz="0 0 1" rpy="1.5708 0 0"/>
  <axis xyz="0 0 2"/><limit lower="-1" upper="2"/></joint>
 <joint name="b" type="prismatic"><parent link="one"/><child link="two"/><axis xyz="0 1 0"/>
  <limit lower="0" upper="0.5"/></joint>
 <joint name="side" type="continuous"><parent link="one"/><child link="other"/></joint>
 <joint name="c" type="fixed"><parent link="two"/><child link="tip"/><origin xyz="0.25 0 0"/></joint>
</robot>"""


def test_the_reader_of_urdf_by_hand():
    """Joint a turns about -y, b slides along what was z at zero."""
    urdf = Urdf(URDF)
    assert [joint["name"] for joint in urdf.moving("base", "tip")] == ["a", "b"]
    assert np.allclose(urdf.pose("base", "tip", [0, 0.5]) @ [0, 0, 0, 1], [0.25, 0, 1.5, 1])
    assert np.allclose(urdf.pose("base", "tip", [math.pi / 2, 0.5]) @ [0, 0, 0, 1], [-0.5, 0, 1.25, 1])
    assert np.allclose(urdf.pose("one", "tip", [0.5])[:3, 3], [0.25, 0.5, 0])
    found = figures({"base": "base", "tip": "tip"}, urdf)
    assert found["limits"] == [[-57.296, 114.592], [0.0, 500.0]]
    assert found["poses"][0] == [
        [0, 0],
        [250.0, 0.0, 1000.0],
        [round(math.sqrt(0.5), 12), round(math.sqrt(0.5), 12), 0.0, 0.0],
    ]


@pytest.mark.parametrize("q", [[1, 0, 0, 0], [0, 0.6, 0.8, 0], [0.5, -0.5, 0.5, 0.5]])
def test_quaternions_there_and_back(q):
    from vendor_urdf import quaternion

    assert np.allclose(rotation(*quaternion(rotation(*q))), rotation(*q), atol=1e-12)
