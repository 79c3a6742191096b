"""`robokin plot`: pictures in their files, what they show as text and data, and what is refused."""

from __future__ import annotations

import json
import re
import sys

import numpy as np
import pytest

from .conftest import poses_of, refused

TARGET = "Trans(500,149,200) RPY(0,90,0)"


def page_data(path):
    (text,) = re.findall(r'<script id="data" type="application/json">(.*?)</script>', path.read_text(), re.DOTALL)
    return json.loads(text)


@pytest.mark.parametrize(
    ("name", "start"),
    [("a.png", b"\x89PNG"), ("a.svg", b"<?xml"), ("a.pdf", b"%PDF-"), ("a.html", b"<!DOCTYPE html>")],
)
def test_a_picture_goes_to_its_file(call, tmp_path, name, start):
    if not name.endswith("html"):
        pytest.importorskip("matplotlib")
    answer = call("plot", "scara", "--q", "10,20,100,30", "--frames", "-o", tmp_path / name)
    assert (answer.status, answer.out, answer.err) == (0, b"", "")
    assert (tmp_path / name).read_bytes().startswith(start)
    assert [file.name for file in tmp_path.iterdir()] == [name]


@pytest.mark.parametrize("arguments", [["assembly"], ["planar3r", "--set", "a1=0", "--set", "a2=0", "--set", "a3=0"],
                                       ["human-body", "--frames"], ["planar3r", "--view", "30,40"]])  # fmt: skip
@pytest.mark.parametrize("ending", ["png", "html"])
def test_arms_out_of_the_ordinary_are_drawn_too(call, tmp_path, arguments, ending):
    pytest.importorskip("matplotlib")
    answer = call("plot", *arguments, "-o", tmp_path / f"a.{ending}")
    assert (answer.status, answer.err) == (0, "")


def test_the_corners_run_from_the_base_to_the_tool(call):
    (arm,) = call("plot", "puma560", "--q", "10,20,30,40,50,60", "--json").json["arms"]
    T = poses_of("puma560", [10, 20, 30, 40, 50, 60])
    assert np.allclose(arm["points"][-1], T[:3, 3])
    assert np.allclose(arm["pose"]["matrix"], T)
    assert arm["points"][0] == [0.0, 0.0, 0.0]
    assert [joint["type"] for joint in arm["joints"]] == ["revolute"] * 6


def test_without_values_home_is_drawn_or_zero_in_the_middle_of_strokes(call):
    assert call("plot", "puma560", "--json").json["arms"][0]["q"] == [90, 0, 90, 0, 0, 0]
    assert call("plot", "scara", "--json").json["arms"][0]["q"] == [0, 0, 105, 0]


def test_several_configurations_are_one_arm_and_ghosts(call):
    arms = call("plot", "planar3r", "--q", "30,40,50", "--q", "60,20,10", "-f", "jsonl").jsonl
    assert [arm["ghost"] for arm in arms] == [False, True]
    assert [arm["label"] for arm in arms] == ["(30°, 40°, 50°)", "(60°, 20°, 10°)"]


def test_every_solution_is_drawn_and_named_by_its_branch(call, tmp_path):
    solved = call("ik", "puma560", "--pose", TARGET, "--json").json["solutions"]
    document = call("plot", "puma560", "--ik", TARGET, "--json").json
    assert document["reachable"]
    assert [arm["label"] for arm in document["arms"]] == [solution["branch"] for solution in solved]
    for arm, solution in zip(document["arms"], solved, strict=True):
        assert np.allclose(arm["q"], solution["q"])
        assert np.allclose(arm["points"][-1], [500, 149, 200])
    assert [arm["ghost"] for arm in document["arms"]] == [False] + [True] * (len(solved) - 1)
    path = tmp_path / "a.html"
    assert call("plot", "puma560", "--q", "home", "--ik", TARGET, "-o", path).status == 0
    data = page_data(path)
    assert data["q"] == [90, 0, 90, 0, 0, 0]
    assert [ghost["label"] for ghost in data["ghosts"]] == ["", *(solution["branch"] for solution in solved)]
    assert np.allclose(np.reshape(data["target"], (4, 4))[:3, 3], [500, 149, 200])


def test_what_cannot_be_reached_has_status_3_and_its_nearest_is_drawn(call, tmp_path):
    path = tmp_path / "a.html"
    answer = call("plot", "planar2r", "--ik", "5,5", "-o", path)
    assert answer.status == 3
    assert answer.err == "robokin: no solution: out of reach\n"
    data = page_data(path)
    assert data["ghosts"][0]["label"].startswith("nearest: position error ")
    assert "out of reach" in data["note"]
    document = call("plot", "planar2r", "--ik", "5,5", "--json").json
    assert (document["reachable"], document["reason"]) == (False, "out of reach")


@pytest.mark.parametrize("text", ["1.2,0.7", "1.2,0.7,0", "Trans(1.2,0.7,0) Rot(z,30)",
                                  "[[1,0,0,1.2],[0,1,0,0.7],[0,0,1,0],[0,0,0,1]]"])  # fmt: skip
def test_a_target_is_an_expression_a_matrix_or_a_place(call, text):
    document = call("plot", "planar3r", "--ik", text, "--json").json
    for arm in document["arms"]:
        assert np.allclose(arm["points"][-1], [1.2, 0.7, 0.0])


def test_units_and_parameters_are_taken(call):
    document = call("plot", "scara", "--set", "a1=100", "--length", "cm", "--angle", "rad", "--json").json
    assert document["units"] == {"length": "cm", "angle": "rad"}
    assert np.allclose(document["arms"][0]["points"][-1], [37.5, 0.0, 23.2])


def test_csv_has_a_row_for_each_corner(call):
    answer = call("plot", "planar2r", "--q", "0,90", "-f", "csv")
    assert answer.columns == ["arm", "corner", "x", "y", "z"]
    # Both links lie along one axis of the world; the tool's pose is forward kinematics'.
    assert answer.numbers[:, :2].tolist() == [[1, 1], [1, 2], [1, 3]]
    assert np.allclose(answer.numbers[-1, 2:], poses_of("planar2r", [0, 90])[:3, 3])


def test_the_text_is_a_page_of_80_columns_with_numbered_frames(call):
    answer = call("plot", "scara", "--q", "20,30,100,0", "--frames")
    assert (answer.status, answer.err) == (0, "")
    assert max(map(len, answer.lines)) <= 80
    assert len(answer.lines) < 36
    assert {"1", "2", "3", "4"} <= set(re.findall(r"(?<=[⠀-⣿ ])[1-4](?=[⠀-⣿ ]|$)", answer.text, re.MULTILINE))
    assert "x [mm]" in answer.text


def test_values_outside_the_limits_are_drawn_and_said(call, tmp_path):
    answer = call("plot", "puma560", "--q", "500,0,0,0,0,0", "-o", tmp_path / "a.html")
    assert answer.status == 0
    assert "joint 1 (waist) = 500 deg is outside its limits -160 .. 160" in answer.err


def test_the_same_command_gives_the_same_bytes(call, tmp_path):
    pages = []
    for name in ("a.html", "b.html"):
        call("plot", "puma560", "--ik", TARGET, "-o", tmp_path / name)
        pages.append((tmp_path / name).read_bytes())
    assert pages[0] == pages[1]


def test_a_page_and_a_text_need_no_matplotlib(call, tmp_path, monkeypatch):
    monkeypatch.setattr("robokin.pictures.workspace_stills.find_spec", lambda name: None)
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    assert call("plot", "puma560", "-o", tmp_path / "a.html").status == 0
    assert call("plot", "puma560").status == 0
    refused(call("plot", "puma560", "-o", tmp_path / "a.png"), "`pip install matplotlib`")
    assert not (tmp_path / "a.png").exists()


@pytest.mark.parametrize(
    ("arguments", "fragments"),
    [
        (["puma560", "-o", "a.gif"], ["a.gif", ".png, .svg, .pdf or .html"]),
        (["puma560", "-o", "nowhere/a.html"], ["--output", "nowhere"]),
        (["puma560", "-o", "a.html", "--json"], ["--output", "--json"]),
        (["puma560", "-o", "a.html", "-f", "csv"], ["--output", "--format"]),
        (["puma560", "--q", "-"], ["--q", "found '-'"]),
        (["puma560", "--q", "1,2"], ["--q", "found 2 values"]),
        (["puma560", "--q", "hoem"], ["hoem", "did you mean 'home'"]),
        (["scara", "--q", "0,0,1e12,0"], ["too long", "smaller"]),
        (["puma560", "--ik", ""], ["--ik", "found nothing"]),
        (["puma560", "--ik", "1,2"], ["--ik", "found 2 values"]),
        (["puma560", "--ik", "1,2,3,4"], ["--ik", "found 4 values"]),
        (["puma560", "--ik", "1,2,up"], ["--ik", "up"]),
        (["puma560", "--ik", "Trans(1,2)"], ["--ik", "Trans(x, y, z)"]),
        (["puma560", "--ik", "[[1]]"], ["--ik"]),
        (["assembly", "--ik", "1,2,3"], ["no joints"]),
        (["puma560", "--view", "1"], ["--view", "azimuth, elevation"]),
        (["puma560", "--view", "1,100"], ["--view", "±90"]),
        (["puma560", "--view", "up,1"], ["--view", "up"]),
        (["car"], ["is a wheeled base"]),
        (["puma56"], ["puma56", "puma560"]),
    ],
)
def test_what_is_wrong_gets_a_sentence(call, arguments, fragments, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    answer = call("plot", *arguments)
    if "1e12" in str(arguments):
        assert answer.status == 2
        assert all(fragment in answer.err for fragment in fragments)
    else:
        refused(answer, *fragments)
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
def test_plot_draws_mechanisms(call, tmp_path):
    text = call("plot", "four-bar").text
    assert "Four-bar linkage" in text
    assert "x [m]" in text
    record = call("plot", "sarrus", "--json").json
    assert (record["mechanism"], record["ground"], len(record["links"])) == ("sarrus", "base", 6)
    assert record["joints"][0]["position"] == record["links"][0]["points"]["A1"]
    rows = call("plot", "four-bar", "-f", "csv").csv
    assert rows[0] == ["link", "joint", "x", "y", "z"]
    assert len(rows) == 9
    for name in ("a.html", "b.png"):
        if name.endswith("png"):
            pytest.importorskip("matplotlib")
        answer = call("plot", "bennett", "--view", "10,20", "-o", tmp_path / name)
        assert (answer.status, answer.out, answer.err) == (0, b"", "")
    answer = call("plot", "shaky-triangle", "-o", tmp_path / "c.html")
    assert answer.status == 0
    assert "drawn as it stands" in answer.err
    answer = call("dof", "sarrus", "--plot", tmp_path / "d.html", "--point", "platform:0,0,1")
    assert answer.status == 0
    assert page_data(tmp_path / "d.html")["paths"]
    for words, said in ((("four-bar", "--q", "1"), "--q is for robots"), (("car",), "is a wheeled base"),
                        (("four-bar", "-o", "x.bmp"), ".png, .svg, .pdf, .html or .gif")):  # fmt: skip
        answer = call("plot", *words)
        assert answer.status == 2
        assert said in answer.err


def test_targets_are_said_as_for_ik(call):
    by_expression = call("plot", "puma560", "--ik", "Trans(500,149,200) RPY(0,90,0)", "--json").json
    by_options = call("plot", "puma560", "--xyz", "500,149,200", "--rpy", "0,90,0", "--json").json
    assert by_options["arms"] == by_expression["arms"]
    assert call("plot", "planar3r", "--xy", "0.9,1.2", "--phi", "90").status == 0
    assert call("plot", "planar3r", "--xy", "0.9,1.2", "--ik", "1,1").status == 2
    assert call("plot", "bennett", "--xyz", "1,1,1").status == 2


def test_a_tree_is_drawn_whole_in_every_format(call, tmp_path):
    answer = call("plot", "human-hand", "--q", "pinch")
    assert (answer.status, answer.err) == (0, "")
    assert answer.lines[0] == "Human hand  q = pinch"
    assert max(map(len, answer.lines)) <= 80
    assert [line.split()[0] for line in answer.lines[-5:]] == ["thumb", "index", "middle", "ring", "little"]
    tips = call("fk", "human-hand", "--q", "pinch", "--json").json["tips"]
    document = call("plot", "human-hand", "--q", "pinch", "--json").json
    (tree,) = document["trees"]
    assert tree["tips"].keys() == tips.keys()
    ends = np.concatenate(tree["lines"])
    for name, pose in tips.items():
        assert np.allclose(tree["tips"][name]["matrix"], pose["matrix"], atol=1e-9)
        assert np.min(np.linalg.norm(ends - pose["position"], axis=1)) < 1e-6
    assert len(tree["joints"]) == 21
    table = call("plot", "human-hand", "--q", "pinch", "--q", "open", "-f", "csv")
    assert table.columns == ["tree", "line", "corner", "x", "y", "z"]
    assert {(row[0], row[1]) for row in table.numbers.tolist()} == {(i, k) for i in (1, 2) for k in range(1, 6)}
    lines = call("plot", "human-hand", "--q", "pinch", "--q", "open", "-f", "jsonl").jsonl
    assert [(line["label"], line["ghost"]) for line in lines] == [("pinch", False), ("open", True)]
    path = tmp_path / "hand.html"
    assert call("plot", "human-hand", "--q", "fist", "-o", path).status == 0
    data = page_data(path)
    assert [name for name, _ in data["groups"]] == ["thumb", "index", "middle", "ring", "little"]
    assert list(data["poses"]) == ["default", "open", "fist", "pinch", "tripod"]
    one = call("plot", "human-hand", "--tip", "index", "--ik", "150,30,-60", "--json").json
    assert one["reachable"]
    assert len(one["arms"]) > 1


def test_a_finger_whose_joints_hang_together_is_drawn_and_notes_are_said_once(call, tmp_path):
    path = tmp_path / "finger.urdf"
    joint = (
        '<joint name="{0}" type="revolute"><parent link="{1}"/><child link="{2}"/>'
        '<origin xyz="0.04 0 0" rpy="{3} 0 0"/><axis xyz="0 0 1"/>'
        '<limit lower="0" upper="1.5" effort="1" velocity="1"/>{4}</joint>'
    )
    mimic = '<mimic joint="pip" multiplier="0.5" offset="0.1"/>'
    path.write_text(
        '<robot name="finger"><link name="a"/><link name="b"/><link name="c"/>'
        + joint.format("pip", "a", "b", "1.5708", "")
        + joint.format("dip", "b", "c", "0", mimic)
        + "</robot>"
    )
    answer = call("plot", path, "--q", "0.4", "--json")
    assert answer.status == 0
    assert answer.err.count("cut in print") == 1
    (tree,) = answer.json["trees"]
    assert [joint["name"] for joint in tree["joints"]] == ["pip", "dip"]
    assert call("plot", path, "--q", "0.4,0.3").status == 2


@pytest.mark.parametrize("ending", ["html", "gif"])
def test_a_mechanism_moves_by_its_drive_and_a_point_is_traced(call, tmp_path, ending):
    if ending == "gif":
        pytest.importorskip("matplotlib")
    path = tmp_path / f"bar.{ending}"
    answer = call("plot", "four-bar", "--drive", "D", "--point", "coupler:3,4", "-o", path)
    assert (answer.status, answer.out, answer.err) == (0, b"", "")
    if ending == "html":
        data = page_data(path)
        assert data["labels"][data["lead"]] == "D"
        assert len(data["paths"]) == 1
        assert data["command"] == f"robokin dof four-bar --trace {len(data['poses'])} --drive D"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["four-bar", "--drive", "D"], ["--drive is about a motion", "expected --output"]),
        (["four-bar", "--drive", "Z", "-o", "a.html"], ["unknown joint 'Z'"]),
        (["four-bar", "--point", "arm:1,2", "-o", "a.html"], ["--point: found the unknown link 'arm'"]),
        (["puma560", "--drive", "D", "-o", "a.html"], ["--drive is for mechanisms"]),
        (["puma560", "-o", "a.gif"], ["--output: found 'a.gif'", "a .gif is of what moves"]),
        (["shaky-triangle", "-o", "a.gif"], ["a .gif shows a motion", "only trembles"]),
        (["shaky-triangle", "--drive", "A", "-o", "a.html"], ["only trembles"]),
    ],
)
def test_what_of_a_motion_cannot_be_drawn(call, words, said, tmp_path, monkeypatch):
    if any(word.endswith("gif") for word in words):
        pytest.importorskip("matplotlib")
    monkeypatch.chdir(tmp_path)
    refused(call("plot", *words), *said)
    assert not list(tmp_path.iterdir())


def test_the_page_says_the_command_line_with_its_options(call, tmp_path):
    path = tmp_path / "finger.html"
    assert call("plot", "human-hand", "--tip", "index", "-o", path).status == 0
    assert page_data(path)["words"] == "human-hand --tip index"
    assert call("plot", "planar2r", "--set", "a2=0.5", "--angle", "rad", "-o", path).status == 0
    assert page_data(path)["words"] == "planar2r --set a2=0.5"
