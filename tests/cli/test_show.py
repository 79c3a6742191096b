"""`robokin show`: the table as a lecture prints it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from library_entries import names_of
from sweeps import sweep

import robokin
from robokin.formats import library_names
from robokin.model import Robot

from .conftest import refused

ROBOTS = names_of(Robot)


def test_the_puma_s_table(call):
    lines = call("show", "puma560").lines
    assert lines[0] == "PUMA 560  standard convention, lengths in mm, angles in deg"
    assert lines[2].split() == ["i", "joint", "type", "theta", "d", "a", "alpha", "limits"]
    assert lines[4].split() == ["1", "waist", "revolute", "q1", "0", "0", "-90", "-160", "..", "160"]
    assert lines[6].split() == ["3", "elbow", "revolute", "q3", "0", "-20.32", "90", "-45", "..", "225"]
    text = "\n".join(lines)
    for words in ("anthropomorphic", "spherical: axes 4, 5, 6", "F = 6(7 - 6 - 1) + 6 = 6", "pose home  90  0  90"):
        assert words in text
    assert "R = N - M  0" in text


def test_the_puma_s_document(call):
    record = call("show", "puma560", "--json").json
    assert call("show", "puma560", "-f", "jsonl").jsonl == [record]
    assert (record["robot"], record["name"], record["kind"]) == ("puma560", "PUMA 560", "robot")
    assert record["units"] == {"length": "mm", "angle": "deg"}
    assert (record["class"], record["n"], record["m"], record["redundancy"]) == ("anthropomorphic", 6, 6, 0)
    assert record["poses"] == {"home": [90, 0, 90, 0, 0, 0]}
    assert record["rows"][1] == {
        "i": 2, "name": "shoulder", "type": "revolute", "variable": "q2", "theta": None, "d": 149.09, "a": 431.8,
        "alpha": 0.0, "offset": 0.0, "sense": 1, "limits": [-225.0, 45.0],
    }  # fmt: skip


@pytest.mark.parametrize("name", sweep(library_names(), 5))
def test_every_table_is_plain_whole_and_fits_a_page(call, name):
    answer = call("show", name)
    assert (answer.status, answer.err) == (0, "")
    assert "\x1b" not in answer.text
    assert "…" not in answer.text
    assert max(map(len, answer.lines)) <= 80
    assert all(line == line.rstrip() for line in answer.lines)


@pytest.mark.parametrize("name", sweep(library_names(), 5))
def test_every_document_and_its_rows_in_other_units(call, name):
    units = ["--length", "in", "--angle", "rad"]
    (record,) = call("show", name, "-f", "jsonl", *units).jsonl
    assert record["units"] == {"length": "in", "angle": "rad"}
    table = call("show", name, "-f", "csv", *units).csv
    rows = record[{"robot": "rows", "tree": "joints", "mechanism": "joints", "wheeled": "wheels"}[record["kind"]]]
    assert table[0] == list(rows[0])
    assert len(table) == len(rows) + 1
    assert all(len(row) == len(table[0]) for row in table)


@pytest.mark.parametrize("name", sweep(ROBOTS, 5))
def test_the_rows_are_the_robot_s(call, name):
    robot = robokin.load(name)
    record = call("show", name, "--json").json
    assert record["joints"] == robot.types
    assert [row["name"] for row in record["rows"]] == [row.name for row in robot.rows]
    assert record["redundancy"] == record["n"] - record["m"]
    for said, row in zip(record["rows"], robot.rows, strict=True):
        if robot.convention != "frames":
            assert said["a"] * robot.units.metres == pytest.approx(row.a, rel=1e-14)
            assert said["alpha"] * robot.units.radians == pytest.approx(row.alpha, rel=1e-14)
        if said["limits"] is None:
            assert not math.isfinite(row.limits[0])
        else:
            unit = robot.units.radians if row.type == "revolute" else robot.units.metres
            assert [limit * unit for limit in said["limits"]] == pytest.approx(row.limits, rel=1e-14)


def test_other_units(call):
    millimetres, inches = (
        call("show", "puma560", "--json").json,
        call("show", "puma560", "--json", "--length", "in").json,
    )
    assert inches["units"]["length"] == "in"
    assert inches["rows"][1]["a"] == pytest.approx(millimetres["rows"][1]["a"] / 25.4)


def test_parameters_can_be_set(call):
    record = call("show", "scara-frames", "--set", "l1=500", "--json").json
    assert record["parameters"]["l1"] == 500
    assert record["rows"][0]["origin"][2][3] == 500


def test_a_mechanism_has_links_and_joints(call):
    record = call("show", "four-bar", "--json").json
    assert (record["mechanism"], record["kind"], record["space"], record["grubler"]) == (
        "four-bar",
        "mechanism",
        "planar",
        1,
    )
    assert [joint["name"] for joint in record["joints"]] == ["A", "B", "C", "D"]
    assert "F = 1" in call("show", "four-bar").text


def test_a_wheeled_base_has_wheels(call):
    record = call("show", "mecanum", "--json").json
    assert (record["base"], record["kind"], record["steering"]) == ("mecanum", "wheeled", "independent")
    assert [wheel["roller"] for wheel in record["wheels"]] == [-45, 45, 45, -45]
    assert record["wheels"][1]["at"] == [235, -150]
    assert "the steered wheels stay parallel" in call("show", "synchro-drive").text


def test_names_are_words_and_no_style(call, tmp_path):
    path = tmp_path / "arm.yaml"
    path.write_text(
        'robokin: 1\nname: "arm [/x] [bold]y :smile:"\ndescription: "[/red] [link=a]b"\n'
        'joints:\n  - {name: "[/a]", type: R, a: 1}\n'
    )
    answer = call("show", path)
    assert answer.status == 0
    for words in ("arm [/x] [bold]y :smile:", "[/a]", "[/red] [link=a]b"):
        assert words in answer.text
    assert "arm [/x] [bold]y :smile:" in call("fk", path, "--q", "0").text


def test_what_show_cannot_read(call):
    refused(call("show", "puma56"), "did you mean puma560")
    refused(call("show"), "ROBOT is missing")
    refused(call("show", "puma560", "extra"), "'extra'", "expected nothing more")
    refused(call("show", "puma560", "--length", "furlong"), "--length", "expected m, cm, mm or in")


@pytest.mark.parametrize("name, text", [
    ("kr6-r900", "(980, 0, 435) mm, z along +x"), ("puma560", "(411.48, 149.09, 489.32) mm, z along +z"),
    ("ur5e", "(-817.2, -232.9, 62.8) mm, z along -y"), ("assembly", "(7, -8, 6) cm, z along +z"),
    ("yumi-left", "(564.597461, -0.648654, 417.406963) mm, z along (0.57156, -0.616978, -0.540978)"),
])  # fmt: skip
def test_where_the_tool_frame_stands_at_zero(call, name, text):
    assert f"at zero tool frame at {text}" in " ".join(call("show", name).text.split())


def test_the_place_at_zero_is_what_fk_says(call):
    """In any units, to the last digits of arithmetic, with no negative zero."""
    for name in ("kr6-r900", "scara", "yumi-left"):
        zero = call("show", name, "--length", "in", "--json").json["at_zero"]
        assert list(zero) == ["position", "z", "z_along"]
        robot = robokin.load(name)
        T = robokin.forward_kinematics(robot, np.zeros(robot.n))
        assert zero["position"] == pytest.approx(T[:3, 3] / 0.0254, abs=1e-9)
        assert zero["z"] == pytest.approx(T[:3, 2], abs=1e-9)
        assert "-0.0" not in map(str, [*zero["position"], *zero["z"]])
    assert call("show", "scara", "--json").json["at_zero"]["z_along"] == "-z"
    assert call("show", "yumi-left", "--json").json["at_zero"]["z_along"] is None


def test_a_table_has_some_of_very_many_poses_and_says_how_many_more(call, tmp_path):
    path = tmp_path / "many.yaml"
    rows = "".join(f"  p{i}: [{i}]\n" for i in range(100))
    path.write_text(f"robokin: 1\nname: Many\nunits: {{angle: deg}}\njoints:\n  - {{type: R, a: 1}}\nposes:\n{rows}")
    text = call("show", path).text
    assert "pose p39" in text
    assert "pose p40" not in text
    assert "and 60 more poses, which --json has" in text
    assert len(call("show", path, "--json").json["poses"]) == 100


# Tables that are made --------------------------------------------------------------------------------------------


def product(document, q):
    """The pose that a document's standard table has at q, base and tool included."""
    T = np.array(document["base"])
    values = iter(q)
    for row in document["rows"]:
        value = row["sense"] * next(values) + row["offset"]
        theta, d = (value, row["d"]) if row["type"] == "revolute" else (row["theta"], value)
        c, s, ca, sa = np.cos(theta), np.sin(theta), np.cos(row["alpha"]), np.sin(row["alpha"])
        a = row["a"]
        T = T @ [[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d], [0, 0, 0, 1]]
    return T @ np.array(document["tool"])


@pytest.mark.parametrize("robot", ["puma560", "panda", "scara", "stanford", "ur5e", "human-arm", "so-101"])
def test_a_urdf_is_shown_as_its_table(call, tmp_path, robot):
    file = tmp_path / "arm.urdf"
    assert call("convert", robot, "-o", file).status == 0
    answer = call("show", file, "--json", "--exact")
    assert answer.err == ""
    document = answer.json
    assert (document["convention"], document["made_from"]) == ("standard", "frames")
    own = robokin.load(robot)
    for q in np.random.default_rng(0).uniform(-2.0, 2.0, (5, own.n)):
        np.testing.assert_allclose(product(document, q), robokin.forward_kinematics(own, q), atol=1e-11)
    text = call("show", file, "--exact").text
    assert "standard convention, lengths in m, angles in rad" in text
    assert "made from the joints' frames, which robokin convert --convention frames prints" in " ".join(text.split())


def test_the_chain_of_a_tree_is_shown_as_its_table(call):
    document = call("show", "human-hand", "--tip", "index", "--json", "--length", "m", "--angle", "rad").json
    assert (document["convention"], document["made_from"]) == ("standard", "frames")
    own = robokin.load("human-hand", tip="index")
    for q in np.random.default_rng(1).uniform(-2.0, 2.0, (5, own.n)):
        np.testing.assert_allclose(product(document, q), robokin.forward_kinematics(own, q), atol=1e-12)
    assert document["parameters"] == {"HL": 190.0, "HB": 85.0}
    assert call("show", "human-hand", "--tip", "index", "-f", "csv").text.startswith("i,name,type,variable,theta,d,a")


def test_a_table_that_someone_wrote_is_shown_as_it_is(call):
    for robot in ("scara-frames", "puma560", "puma560-craig"):
        assert "made from" not in call("show", robot).text
        assert "made_from" not in call("show", robot, "--json").json


def test_a_urdf_without_a_table_is_shown_in_frames(call, tmp_path):
    file = tmp_path / "near.urdf"
    file.write_text(
        '<robot name="near"><link name="a"/><link name="b"/><link name="c"/>'
        '<joint name="p" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint>'
        '<joint name="q" type="continuous"><parent link="b"/><child link="c"/><axis xyz="0 0 1"/>'
        '<origin xyz="0.4 0.01 0" rpy="0.0001 0 0"/></joint></robot>'
    )
    answer = call("show", file)
    assert answer.status == 0
    assert "0.0001 rad from parallel" in answer.err
    assert "frames convention" in answer.text
    assert "made from" not in answer.text
