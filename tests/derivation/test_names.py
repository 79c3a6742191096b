"""What things are called: parameters by their names, lengths by their cells, angles by their joints."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest
from derivation.evaluation import evaluated, texts

import robokin
from robokin.derivation.symbolic_cells import linear_of
from robokin.derivation.symbolic_kinematics import symbolic_kinematics
from robokin.derivation.written_sums import latex, latex_name
from robokin.formats import read_text
from robokin.units import Units


def arm(*rows, tail="", convention="standard", parameters="l1: 400, l2: l1/2, beta: 30"):
    table = "".join(f"  - {{{row}}}\n" for row in rows)
    head = f"robokin: 1\nname: arm\nunits: {{length: mm, angle: deg}}\nconvention: {convention}\n"
    return read_text(f"{head}parameters: {{{parameters}}}\njoints:\n{table}{tail}")


def position(robot, **options):
    return [row[3] for row in texts(symbolic_kinematics(robot, **options).T)[:3]]


@pytest.mark.parametrize(
    ("cell", "written"),
    [
        ("l1", "l1*c1"), ("-l1", "-l1*c1"), ("l2/2", "0.5*l2*c1"), ("2*(l1 - l2)", "c1*(2*l1-2*l2)"),
        ("l1 + 10", "c1*(l1+10)"),
        ("l1 - l1", "0"), ("0*l1 + 5", "5*c1"), ("300", "a1*c1"), ("0", "0"), ("1e2*l1", "100*l1*c1"),
        ("l1*l2", "a1*c1"), ("l1*sin(beta)", "a1*c1"), ("sqrt(l1)", "a1*c1"), ("l1**1", "a1*c1"), ("l1 + 012", "a1*c1"),
    ],
)  # fmt: skip
def test_a_cell_that_is_linear_prints_its_parameters(cell, written, rng):
    robot = arm(f"type: R, a: '{cell}'")
    assert position(robot)[0] == written
    q = rng.uniform(-3, 3, (5, 1))
    for units in (robot.units, Units("m", "rad")):
        assert np.max(np.abs(evaluated(robot, q, units) - robokin.forward_kinematics(robot, q))) < 1e-12


def test_a_formula_that_is_none_is_told_beside_its_letter():
    symbolic = symbolic_kinematics(arm("type: R, a: l1*sin(beta)"))
    assert symbolic.values == {"a1": 200.0}
    assert symbolic.notes == {"a1": "l1*sin(beta)"}


def test_parameters_change_their_values_and_not_the_matrices():
    symbolic = [symbolic_kinematics(robokin.load("planar3r", a1=a1)) for a1 in (1, 0)]
    assert symbolic[0].T == symbolic[1].T
    assert [each.values["a1"] for each in symbolic] == [1.0, 0.0]
    assert symbolic_kinematics(robokin.load("planar3r"), Units("mm", "deg")).values["a2"] == 600.0


def test_names_that_mean_something_else_get_a_mark():
    robot = arm("type: R, a: c1", "type: R, a: q1, d: 3", "type: P, a: d2", parameters="c1: 1, q1: 2, d2: 4")
    symbolic = symbolic_kinematics(robot)
    assert symbolic.values == {"c1_": 1.0, "q1_": 2.0, "d2": 4.0, "d2_": 3.0}
    assert symbolic.definitions == {"d3": "q3"}
    assert position(robot) == ["c1_*c1+c12*(q1_+d2)", "c1_*s1+s12*(q1_+d2)", "d2_+d3"]


def test_a_sliding_joint_whose_letter_is_a_parameter_goes_by_its_variable():
    robot = arm("type: R, a: d2", "type: P, alpha: 90", parameters="d2: 4")
    assert position(robot) == ["d2*c1", "d2*s1", "q2"]


def test_offsets_of_right_angles_are_signs_and_others_belong_to_theta():
    robot = arm("type: R, a: 1, offset: 90", "type: R, a: 1, offset: 180 - beta", "type: P, alpha: 0, offset: l1")
    symbolic = symbolic_kinematics(robot)
    assert position(robot) == ["-a1*s1-a2*s12", "a1*c1+a2*c12", "d3"]
    assert symbolic.definitions == {"theta2": "q2 - beta + 180", "d3": "q3 + l1"}
    assert symbolic.functions["c12"].argument == "q1 + theta2"
    assert symbolic.values == {"a1": 1.0, "a2": 1.0, "beta": 30.0, "l1": 400.0}


def test_axes_against_each_other_subtract():
    robot = arm("type: R, a: l1, alpha: 180", "type: R, a: l2")
    symbolic = symbolic_kinematics(robot)
    assert position(robot)[0] == "l1*c1+l2*c1m2"
    assert symbolic.functions["c1m2"].argument == "q1 - q2"
    assert latex(symbolic.T[0][0], symbolic.functions) == "c_{1-2}"


def test_a_slide_between_parallel_axes_does_not_part_them():
    robot = arm("type: R, alpha: 90", "type: P, alpha: -90", "type: R, a: l1")
    assert position(robot) == ["l1*c13+s1*d2", "l1*s13-c1*d2", "0"]


def test_twists_and_fixed_rows():
    robot = arm("type: R, alpha: beta, d: l1", "type: fixed, theta: 20, a: 5", "type: R")
    symbolic = symbolic_kinematics(robot)
    assert list(symbolic.matrices) == ["A1", "Af2", "A2"]
    assert symbolic.functions["ca1"].argument == "alpha1"
    assert symbolic.definitions["alpha1"] == "beta"
    assert symbolic.values == {"beta": 30.0, "l1": 400.0, "af2": 5.0, "thetaf2": 20.0}
    assert texts(symbolic_kinematics(robot, numbers=True).matrices["A1"])[2][:3] == [
        "0",
        "0.49999999999999994",
        "0.8660254037844387",
    ]


def test_a_modified_row_holds_the_length_before_it():
    robot = arm("type: R, a: 3", "type: R, a: 7, alpha: 10", convention="modified")
    assert symbolic_kinematics(robot).values == {"a0": 3.0, "a1": 7.0, "alpha1": 10.0}


def test_poses_print_the_parameters_of_their_shifts():
    tail = "base: Rot(z, 90) Trans(l1, 0, 5)\ntool: Trans(0, 0, l2) Rot(y, 90) Trans(0, l2, 0)\n"
    robot = arm("type: R", tail=tail)
    assert robot.texts == (("base y", "l1"), ("tool y", "l2"), ("tool z", "l2"))
    assert position(robot) == ["-l2*c1", "l1-l2*s1", "z0+l2"]
    inverse = arm("type: R", tail="tool: Inv(Trans(l1, 0, 0))\n")
    assert position(inverse)[0] == "xt*c1"
    assert symbolic_kinematics(inverse).values == {"xt": -400.0}
    assert arm("type: R", tail="tool: ''\nbase: ~\n").texts == ()
    turns = "Rot(x, 30) Trans(0, 0, 0.1) " * 300
    assert position(arm("type: R", tail=f"tool: Trans(l1, 0, 0) {turns}\n")) == ["l1*c1", "l1*s1", "0"]
    # What is too long to be read as a formula has a letter and a value.
    long = arm("type: R", tail=f"tool: Trans(0, 0, l1) {turns} Trans(0, 0, 7)\n")
    assert symbolic_kinematics(long).values == {"zt": pytest.approx(407.0)}


def test_a_turned_base_is_one_more_angle():
    robot = arm("type: R, a: l1", tail="base: Rot(z, beta)\n")
    assert position(robot)[0] == "l1*c01"
    assert symbolic_kinematics(robot).functions["c01"].argument == "theta0 + q1"


def test_many_joints_are_kept_apart():
    robot = arm(*["type: R, a: 1"] * 12)
    row = texts(symbolic_kinematics(robot).T)[0]
    assert row[3].startswith("a1*c1+a2*c1_2+")
    symbolic = symbolic_kinematics(robot)
    assert latex(symbolic.T[0][0], symbolic.functions).startswith("c_{1,2,3,")


def test_texts_are_kept_small_and_travel():
    assert robokin.load("puma560").rows[1].texts == ()
    robot = robokin.load("z1")
    assert robot.rows[2].texts == (("a", "forearm"), ("offset", "180 - slant"))
    assert robokin.load("scara-frames").rows[1].texts == (("y", "l2"),)
    for twin in (copy.deepcopy(robot), pickle.loads(pickle.dumps(robot))):
        assert [row.texts for row in twin.rows] == [row.texts for row in robot.rows]
        assert symbolic_kinematics(twin).T == symbolic_kinematics(robot).T


def test_texts_that_are_no_formula():
    for text in (
        "l1 +",
        "lambda",
        "f(l1)",
        "l1[0]",
        "'l1'",
        "l1/0",
        "l1" + " + l1" * 200,
        "(" * 60,
        "l1 if l1 else 0",
        "9**9**9**9*l1",
    ):
        assert linear_of(text, 1.0, {"l1": 1.0, "lambda": 1.0}) is None
    assert linear_of("l1", 2.0, {"l1": 1.0}) is None  # not what the cell says
    assert linear_of("l1 - 1e-3*l1", 0.999, {"l1": 1.0}) == {"l1": 0.999}


@pytest.mark.parametrize(
    ("name", "expected"),
    [("a2", "a_{2}"), ("l_1", "l_{1}"), ("theta3", r"\theta_{3}"), ("upper_arm", r"\mathrm{upper\_arm}"), ("h", "h"),
     ("forearm", r"\mathrm{forearm}"), ("d2_", "d_{2}'"), ("beta", r"\beta")],
)  # fmt: skip
def test_names_in_latex(name, expected):
    assert latex_name(name) == expected
