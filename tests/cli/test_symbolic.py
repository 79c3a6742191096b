"""`robokin fk --symbolic`: the pages, the forms, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import data

import robokin

from .conftest import poses_of, refused

CLOSED_FORMS = {entry["robot"]: entry for entry in data("lectures.json")["closed_forms"]}

ANTHROPOMORPHIC = """\
T = A1 A2 A3 =
[ c1*c23  -c1*s23   s1  c1*(a2*c2 + a3*c23) ]
[ s1*c23  -s1*s23  -c1  s1*(a2*c2 + a3*c23) ]
[ s23      c23      0   a2*s2 + a3*s23      ]
[ 0        0        0   1                   ]

c1 = cos(q1), s1 = sin(q1), c2 = cos(q2), s2 = sin(q2), c23 = cos(q2 + q3),
  s23 = sin(q2 + q3), c3 = cos(q3), s3 = sin(q3)
a2 = 0.5, a3 = 0.4
"""


def test_the_page(call):
    answer = call("fk", "anthropomorphic", "--symbolic")
    assert (answer.status, answer.err) == (0, "")
    assert answer.text.endswith(ANTHROPOMORPHIC)
    assert answer.text.startswith(
        "Anthropomorphic arm  standard convention, lengths in m, angles in deg\n\nA1 =\n[ c1  0   s1  0 ]\n"
    )


@pytest.mark.parametrize(
    "robot", ["puma560", "z1", "j2n6s200", "human-arm", "yumi-left", "assembly", "cartesian", "thumb"]
)
@pytest.mark.parametrize("numbers", [(), ("--numbers",)])
def test_a_page_is_80_columns_wide(call, robot, numbers):
    answer = call("fk", robot, "--symbolic", "--frames", *numbers)
    assert answer.status == 0
    assert max(map(len, answer.lines)) <= 80
    assert not any(line != line.rstrip() for line in answer.lines)


def test_long_matrices_have_a_line_an_entry(call):
    lines = call("fk", "puma560-craig", "--symbolic").lines
    assert "nx = c1*(c23*(c4*c5*c6 - s4*s6) - s23*s5*c6) + s1*(s4*c5*c6 + c4*s6)" in lines
    assert "px = c1*(a2*c2 + a3*c23 - s23*d4) - s1*d3" in lines
    assert lines[-1] == "a2 = 431.8, d3 = 149.09, a3 = 20.32, d4 = 433.07"


@pytest.mark.parametrize("robot", sorted(CLOSED_FORMS))
def test_json_has_the_lectures_matrix(call, robot):
    document = call("fk", robot, "--symbolic", "--json").json
    assert [[cell.replace(" ", "") for cell in row] for row in document["T"]] == CLOSED_FORMS[robot]["matrix"]
    assert list(document) == ["schema", "robot", "id", "units", "matrices", "T", "symbols"]
    assert all(matrix["name"].startswith("A") for matrix in document["matrices"])
    assert call("fk", robot, "--symbolic", "-f", "jsonl").jsonl == [document]


def test_json_says_what_every_symbol_means(call, rng):
    robot = robokin.load("z1")
    document = call("fk", "z1", "--symbolic", "--json").json
    assert document["symbols"]["theta3"] == "q3 - slant + 180"
    assert document["symbols"]["c23"] == "cos(q2 + theta3)"
    q = rng.uniform(-90, 90, 6)
    scope = {f"q{i}": value for i, value in enumerate(q, start=1)}
    scope |= {"cos": lambda x: np.cos(np.radians(x)), "sin": lambda x: np.sin(np.radians(x))}
    for name, meaning in document["symbols"].items():  # in this order each needs only what is before it
        scope[name] = eval(str(meaning), scope)
    T = np.array([[eval(cell, scope) for cell in row] for row in document["T"]])
    assert np.max(np.abs(T - poses_of(robot.id, q))) < 1e-10


def test_frames_are_the_products(call):
    frames = call("fk", "stanford", "--symbolic", "--frames", "--json").json["frames"]
    assert [frame["name"] for frame in frames] == [f"T_0_{i}" for i in range(1, 7)]
    arm = [[cell.replace(" ", "") for cell in row] for row in frames[2]["matrix"]]
    assert arm == CLOSED_FORMS["spherical"]["matrix"]


def test_csv_has_a_row_a_line(call):
    rows = call("fk", "planar2r", "--symbolic", "-f", "csv").csv
    assert rows[0] == ["matrix", "axis", "n", "s", "a", "p"]
    assert rows[-3:] == [
        ["T", "x", "c12", "-s12", "0", "a1*c1 + a2*c12"], ["T", "y", "s12", "c12", "0", "a1*s1 + a2*s12"],
        ["T", "z", "0", "0", "1", "0"],
    ]  # fmt: skip


def test_latex(call):
    text = call("fk", "anthropomorphic", "--symbolic", "--latex").text
    assert "T = A_{1} A_{2} A_{3} = \\begin{bmatrix}\n  c_{1} c_{23} & -c_{1} s_{23} & s_{1} & " in text
    assert " & c_{1} (a_{2} c_{2} + a_{3} c_{23}) \\\\\n" in text
    assert text.count("\\begin{bmatrix}") == text.count("\\end{bmatrix}") == 4
    assert text.count("{") == text.count("}")
    assert "% c_{23} = \\cos(q2 + q3)\n" in text
    assert text.endswith("% lengths in m, angles in deg\n")


def test_python_in_the_units_asked_for(call, rng):
    q = rng.uniform(-90, 90, (4, 6))
    for units, lengths, angles in (((), 1.0, 1.0), (("--length", "m", "--angle", "rad"), 1e-3, np.pi / 180)):
        scope = {}
        exec(call("fk", "puma560", "--symbolic", "--python", *units).text, scope)
        T = scope["forward_kinematics"](q * angles)
        T[..., :3, 3] /= lengths
        assert np.max(np.abs(T - poses_of("puma560", q))) < 1e-9


def test_files_by_their_endings(call, tmp_path):
    for ending, options in (
        (".tex", ("--latex",)),
        (".py", ("--python",)),
        (".json", ("--json",)),
        (".csv", ("-f", "csv")),
    ):
        path = tmp_path / f"planar{ending}"
        answer = call("fk", "planar3r", "--symbolic", "-o", path)
        assert (answer.status, answer.out, answer.err) == (0, b"", "")
        assert path.read_bytes() == call("fk", "planar3r", "--symbolic", *options).out
        path.unlink()
        if ending in (".tex", ".py"):
            assert call("fk", "planar3r", "--symbolic", *options, "-o", path).status == 0


def test_parameters_of_the_command_line(call):
    symbols = call("fk", "planar3r", "--symbolic", "--set", "a1=2.5", "--length", "cm", "--json").json["symbols"]
    assert (symbols["a1"], symbols["a2"]) == (250.0, 60.0)
    assert "[ c1  -s1  0  2.5*c1 ]" in call("fk", "planar3r", "--symbolic", "--set", "a1=2.5", "--numbers").lines


def test_small_numbers_are_not_shown_as_nothing(call, tmp_path):
    path = tmp_path / "arm.yaml"
    path.write_text("robokin: 1\nname: arm\njoints: [{type: R, a: 2e-9}]\n")
    assert "a1 = 2e-09" in call("fk", path, "--symbolic").lines


def test_what_is_refused(call, tmp_path):
    fk = ("fk", "planar3r")
    for option in ("--latex", "--python", "--numbers"):
        refused(call(*fk, option), f"{option} says how to write matrices in symbols, expected --symbolic with it")
    for options in (("--q", "0,0,0"), ("--input", "q.csv"), ("--as", "rpy")):
        refused(call(*fk, "--symbolic", *options), f"expected no {options[0]} with it")
    refused(call(*fk, "--symbolic", "--latex", "--python"), "exclude each other, expected one of them")
    refused(call(*fk, "--symbolic", "--latex", "--json"), "--latex and --format json exclude each other")
    refused(call(*fk, "--symbolic", "--latex", "-o", tmp_path / "a.py"), "expected a name that ends with .tex")
    refused(call(*fk, "--symbolic", "--json", "-o", tmp_path / "a.tex"), "say different things")
    refused(call(*fk, "--symbolic", "-o", tmp_path / "a.npy"), "expected a name that ends with .csv, .jsonl or .json")
    refused(call(*fk, "--symbolc"), "--symbolic")
    refused(call("fk", "four-bar", "--symbolic"), "expected a robot")
    refused(call("fk", "planar33", "--symbolic"), "planar3r")
    refused(call(*fk, "--symbolic", "--set", "a9=1"), "a9")
    assert not list(tmp_path.iterdir())


def test_the_same_bytes_every_time(run):
    first = run("fk", "fr3", "--symbolic", "--json")
    assert first.status == 0
    assert run("fk", "fr3", "--symbolic", "--json").out == first.out
