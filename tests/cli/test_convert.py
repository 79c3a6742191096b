"""`robokin convert` and `show --yaml`: every format, and what is not written."""

from __future__ import annotations

import csv
import json
from xml.etree import ElementTree

import numpy as np
import pytest

import robokin
from robokin.formats import read_text

from .conftest import refused


def same(one, other):
    q = np.random.default_rng(0).uniform(-2, 2, (5, one.n))
    off = np.abs(robokin.forward_kinematics(one, q) - robokin.forward_kinematics(other, q))
    return np.max(off) < 1e-12


@pytest.mark.parametrize("convention", ["standard", "modified", "frames"])
@pytest.mark.parametrize("robot", ["puma560", "panda", "scara-frames"])
def test_a_description_in_every_convention(call, robot, convention):
    answer = call("convert", robot, "--convention", convention)
    assert (answer.status, answer.err) == (0, "")
    made = read_text(answer.text)
    assert made.convention == convention
    assert same(robokin.load(robot), made)
    assert call("convert", robot, "--convention", convention, "-o", "-").out == answer.out
    assert call("convert", robot, "--convention", convention, "-f", "yaml").out == answer.out


def test_a_written_description_is_a_robot_of_every_command(call, tmp_path):
    file = tmp_path / "craig.yaml"
    answer = call("convert", "puma560", "--convention", "modified", "-o", file)
    assert (answer.status, answer.out, answer.err) == (0, b"", "")
    poses = [call("fk", name, "--q", "home", "--json").json["pose"]["matrix"] for name in ("puma560", file)]
    np.testing.assert_allclose(*poses, atol=1e-9)
    assert call("validate", file).status == 0
    assert call("check", "dh", file, "--against", "puma560").status == 0


def test_show_prints_the_description_too(call):
    shown = call("show", "puma560", "--yaml")
    assert (shown.status, shown.err) == (0, "")
    assert shown.out == call("convert", "puma560").out
    made = call("show", "planar2r", "--yaml", "--length", "mm", "--angle", "rad", "--set", "a2=a1/2")
    assert "units: {length: mm, angle: rad}" in made.text
    assert "a: 500" in made.text
    for more in (["--json"], ["-f", "csv"], ["-o", "x.csv"]):
        refused(call("show", "puma560", "--yaml", *more), "--yaml has one form", "robokin convert")
    refused(call("show", "four-bar", "--yaml"), "four-bar is a mechanism")


def test_a_urdf_by_its_ending(call, tmp_path):
    file = tmp_path / "a.URDF"
    assert call("convert", "puma560", "-o", file, "--length", "m").status == 0
    root = ElementTree.fromstring(file.read_text())
    assert root.get("name") == "puma560"
    assert len([joint for joint in root.findall("joint") if joint.get("type") == "revolute"]) == 6
    assert call("convert", "puma560", "-f", "urdf").out == file.read_bytes()
    refused(call("convert", "puma560", "-f", "urdf", "--convention", "modified"), "expected frames or nothing")


def test_tables_for_papers(call, tmp_path):
    text = call("convert", "panda", "--convention", "standard", "-f", "markdown").text
    assert text.startswith("Franka Emika Panda: standard convention, lengths in mm, angles in deg\n\n")
    assert "| 3 | 3 | revolute | q3 | 316 | 82.5 | 90 | -166.003061 .. 166.003061 |" in text
    assert text.endswith("\ntool: Trans(0, 0, 107)\n")
    assert len({line.count("|") for line in text.splitlines() if line.startswith("|")}) == 1
    latex = call("convert", "scara-frames", "--convention", "modified", "-f", "latex").text
    assert r"$\alpha_{i-1}$ & $a_{i-1}$ & $\theta_i$ & $d_i$" in latex
    assert r"1 & theta1 & revolute & $0$ & $0$ & $q_{1} + 90$ & $0$ &  \\" in latex
    assert latex.count(r"\toprule") == latex.count(r"\bottomrule") == 1
    for ending, form in ((".md", "markdown"), (".tex", "latex")):
        assert call("convert", "puma560", "-o", tmp_path / f"a{ending}").status == 0
        assert (tmp_path / f"a{ending}").read_bytes() == call("convert", "puma560", "-f", form).out


def test_names_that_mean_something_to_latex_and_markdown(call, tmp_path):
    file = tmp_path / "odd.yaml"
    file.write_text('robokin: 1\nname: "50 % & a_b | {x} $y$ \\\\ #"\njoints:\n  - {name: "a_b|%&", type: R, a: 1}\n')
    latex = call("convert", file, "-f", "latex").text
    assert r"a\_b|\%\& & revolute" in latex
    markdown = call("convert", file, "-f", "markdown").text
    assert r"| a_b\|%& |" in markdown


def test_a_csv_and_documents_are_those_of_show(call, tmp_path):
    assert call("convert", "puma560", "-f", "csv").out == call("show", "puma560", "-f", "csv").out
    assert call("convert", "puma560", "--json").json == call("show", "puma560", "--json").json
    assert call("convert", "puma560", "-f", "jsonl").out == call("show", "puma560", "-f", "jsonl").out
    answer = call("convert", "panda", "-o", tmp_path / "a.csv")
    assert "a CSV has no place for tool: Trans(0, 0, 107)" in answer.err
    assert len(list(csv.DictReader((tmp_path / "a.csv").read_text().splitlines()))) == 7
    assert call("convert", "panda", "--convention", "frames", "-o", tmp_path / "a.json").status == 0
    assert json.loads((tmp_path / "a.json").read_text())["convention"] == "frames"


def test_parameters_and_units(call):
    made = read_text(call("convert", "planar2r", "--set", "a2=2*a1", "--length", "in").text)
    assert made.units.length == "in"
    assert same(robokin.load("planar2r", a2="2*a1"), made)


def near(tilt):
    return (
        "robokin: 1\nname: near\nconvention: frames\njoints:\n  - {type: R}\n"
        f'  - {{type: R, origin: "Trans(0.3, 0.2, 0) RPY({tilt}, 0, 0)"}}\n'
    )


def test_axes_that_are_nearly_parallel(call, tmp_path):
    file = tmp_path / "near.yaml"
    file.write_text(near(1e-5))
    answer = call("convert", file, "--convention", "standard", "-o", tmp_path / "out.yaml")
    refused(answer, "1e-05 rad from parallel", "convention frames")
    assert not (tmp_path / "out.yaml").exists()
    assert call("convert", file, "--convention", "frames").status == 0
    file.write_text(near(1e-10))
    answer = call("convert", file, "--convention", "standard")
    assert answer.status == 0
    assert "axes 1e-10 rad from parallel are taken as parallel" in answer.err


@pytest.mark.parametrize(
    ("arguments", "fragments"),
    [
        (["puma560", "-o", "a.step"], ["'a.step'", ".yaml, .yml, .urdf"]),
        (["puma560", "-o", "a.yaml", "-f", "urdf"], ["say different things"]),
        (["puma560", "--json", "-f", "urdf"], ["exclude each other"]),
        (["puma560", "-f", "step"], ["--format: found 'step'", "yaml, urdf"]),
        (["puma560", "--convention", "craig"], ["--convention: found 'craig'", "standard, modified or frames"]),
        (["four-bar"], ["four-bar is a mechanism", "expected a robot"]),
        (["car"], ["car is a wheeled base"]),
        (["no-such"], ["no-such"]),
        (["puma560", "--set", "x=1"], ["no parameter"]),
        (["puma560", "-o", "no/such/folder/a.yaml"], ["--output no/such/folder/a.yaml"]),
    ],
)
def test_what_is_wrong_is_said(call, arguments, fragments):
    refused(call("convert", *arguments), *fragments)


# Trees ------------------------------------------------------------------------------------------------------------

FORKED = """\
<robot name="torso">
  <link name="body"/><link name="left"/><link name="hand"/><link name="right"/>
  <joint name="turn" type="continuous"><parent link="body"/><child link="left"/><axis xyz="0 0 1"/></joint>
  <joint name="lift" type="continuous"><parent link="body"/><child link="right"/><axis xyz="0 0 1"/></joint>
  <joint name="bend" type="continuous"><parent link="left"/><child link="hand"/>
    <origin xyz="0.3 0 0.1"/><axis xyz="0 1 0"/></joint>
</robot>
"""


def same_tips(one, other):
    assert [*one] == [*other]
    for name, tip in one.items():
        np.testing.assert_allclose(tip["matrix"], other[name]["matrix"], atol=1e-9)


@pytest.mark.parametrize("convention", ["standard", "modified", "frames"])
def test_a_tree_is_written_as_its_branches(call, convention, tmp_path):
    file = tmp_path / "hand.yaml"
    answer = call("convert", "human-hand", "--convention", convention, "-o", file)
    assert (answer.status, answer.err) == (0, "")
    assert f"convention: {convention}\n" in file.read_text()
    for pose in ("pinch", "fist"):
        poses = [call("fk", name, "--q", pose, "--json").json["tips"] for name in ("human-hand", file)]
        same_tips(*poses)
    assert call("show", "human-hand", "--yaml").out == call("convert", "human-hand").out
    assert call("show", "human-hand", "--yaml", "--tip", "index").text.startswith("robokin: 1\n")


def test_another_order_of_joint_values_is_said(call, tmp_path):
    file = tmp_path / "torso.urdf"
    file.write_text(FORKED)
    answer = call("convert", file)
    assert answer.status == 0
    assert "in another order than before: q is turn, bend, lift" in answer.err
    tree = read_text(answer.text)
    assert [joint.name for joint in tree.joints] == ["hand.turn", "hand.bend", "right.lift"]
    assert tree.tips == ("hand", "right")
    again = tmp_path / "again.yaml"
    again.write_text(answer.text)
    assert call("convert", again).err == ""


def test_a_tree_as_a_urdf(call, tmp_path):
    file = tmp_path / "hand.urdf"
    assert call("convert", "human-hand", "-o", file).err == ""
    q = ",".join(map(str, range(21)))
    tips = [call("fk", name, "--q", q, "--angle", "deg", "--length", "mm", "--json").json["tips"]
            for name in ("human-hand", file)]  # fmt: skip
    same_tips(*tips)
    refused(call("convert", "human-hand", "-f", "urdf", "--convention", "modified"), "expected frames or nothing")


def test_tables_of_branches(call):
    text = call("convert", "human-hand", "--convention", "standard", "-f", "markdown").text
    assert text.startswith("Human hand: tree of 5 branches, lengths in mm, angles in deg\n\nthumb, on base: standard")
    assert "| 4 | dip | revolute | q9 | 0 | 18.43 | 0 | 0 .. 90 |" in text
    assert text.endswith("- tip ring: the end of ring\n- tip little: the end of little\n")
    latex = call("convert", "human-hand", "-f", "latex").text
    assert latex.count(r"\toprule") == latex.count(r"\end{tabular}") == 5
    answer = call("convert", "human-hand", "--convention", "modified", "-f", "csv")
    rows = list(csv.DictReader(answer.text.splitlines()))
    assert [row["variable"] for row in rows] == [f"q{i}" for i in range(1, 22)]
    assert rows[8] | {"branch": "index", "on": "base", "name": "dip", "a": "27.17", "limits": "0.0 90.0"} == rows[8]
    assert "a CSV has no place for base: Trans(9.12, 22.61, 0); tool: Trans(30.02, 0, 0) of thumb" in answer.err
    assert call("convert", "human-hand", "--json").json == call("show", "human-hand", "--json").json
    refused(call("convert", "human-hand", "--json", "--convention", "standard"), "document of a tree", "--tip with one")


def test_tables_say_what_joints_follow(call, tmp_path):
    file = tmp_path / "pair.yaml"
    file.write_text(
        "robokin: 1\nname: pair\nunits: {length: mm, angle: deg}\nbranches:\n"
        "  a: {joints: [{name: p, type: R}, {name: s, type: P}, {name: q, type: R, offset: 5}, {name: r, type: R}]}\n"
        "  b: {on: a, joints: [{name: t, type: R}]}\n"
        "couplings:\n  - {joint: q, follows: p, ratio: -2, offset: 10}\n  - {joint: r, adds: {p: 1, s: 0.5}}\n"
    )
    text = call("convert", file, "--convention", "standard", "-f", "markdown").text
    assert "| 3 | q | revolute | -2 q1 + 15 | 0 |" in text
    assert "| 4 | r | revolute | q1 + 0.5 q2 + q3 | 0 |" in text
    assert "| 1 | t | revolute | q4 | 0 |" in text
    assert "b, on a: standard convention" in text


FOREARM = """\
robokin: 1
name: forearm
units: {length: mm, angle: deg}
joints:
  - {name: a, type: R, a: 300, limits: [-90, 90], motion_limits: [-80, 80]}
  - {name: b, type: R, a: 200, offset: 20}
  - {name: screw, type: H, pitch: 5, alpha: 90}
couplings:
  - {joint: b, adds: a, ratio: -1}
  - {joint: screw, follows: {b: 2, a: 1/3}, offset: 10}
"""


@pytest.mark.parametrize("convention", ["standard", "modified", "frames"])
def test_joints_that_hang_on_others_do_so_in_every_form(call, tmp_path, convention):
    file, made = tmp_path / "forearm.yaml", tmp_path / "made.yaml"
    file.write_text(FOREARM)
    assert call("convert", file, "--convention", convention, "-o", made).err == ""
    poses = [call("fk", name, "--q", "30,40", "--json").json["pose"]["matrix"] for name in (file, made)]
    np.testing.assert_allclose(*poses, atol=1e-9)
    text = call("convert", file, "--convention", convention, "-f", "markdown").text
    for line in ("screw: advances 5 a turn", "coupled: b adds -1 a", "coupled: screw follows 2 b + 0.333333 a + 10"):
        assert f"\n{line}\n" in text
    rows = list(csv.DictReader(call("convert", file, "--convention", convention, "-f", "csv").text.splitlines()))
    assert [row["pitch"] for row in rows] == ["", "", "5.0"]
    # Tables have no column for limits of motions: of a joint that moves alone they are in its own.
    assert [row["limits"] for row in rows] == ["-80.0 80.0", "", ""]
    refused(call("convert", file, "-f", "urdf"), "joint b moves with a, b")


def test_a_chain_without_what_moves_it(call, tmp_path):
    file = tmp_path / "two.yaml"
    chain = "{joints: [{name: p, type: R, a: 1}, {name: q, type: R, a: 1}]}"
    file.write_text(f"robokin: 1\nname: two\nbranches:\n  a: {chain}\n  b: {chain}\n"
                    "couplings: [{joint: b.q, follows: a.p, ratio: 2}]\n")  # fmt: skip
    refused(call("convert", file, "--tip", "b"), "a.p moves others and is not in the chain", "expected the tree")
    assert call("convert", file).status == call("convert", file, "-f", "urdf").status == 0
