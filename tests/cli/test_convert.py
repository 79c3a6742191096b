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
