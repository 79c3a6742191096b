"""The matrices that the lectures print, symbol by symbol."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import data
from derivation.evaluation import matrix_of, texts

import robokin
from robokin.derivation.symbolic_kinematics import symbolic_kinematics
from robokin.formats import read_text

LECTURES = data("lectures.json")


def matrices(robot):
    symbolic = symbolic_kinematics(robokin.load(robot))
    return {**{name: texts(matrix) for name, matrix in symbolic.matrices.items()}, "T": texts(symbolic.T)}


@pytest.mark.parametrize("entry", LECTURES["closed_forms"], ids=lambda entry: entry["robot"])
def test_the_products_that_the_slides_print(entry):
    """C. Laschi, slides Planar 3-link, Spherical, Anthropomorphic manipulator, Spherical wrist and Geometric
    manipulator model; W. Lucia, slides Three-link planar and Anthropomorphic arm (Tables 2.1 and 2.4).

    The one of M. Yim's planar arm (T02 = A1 A2) is not written out there.
    """
    assert matrices(entry["robot"])["T"] == entry["matrix"]


def test_the_links_of_the_planar_arm():
    """M. Yim, Robotics: Fundamentals, week 5, slide Planar Forward Kinematics, A1 and A2."""
    found = matrices("planar2r")
    for i in "12":
        assert found[f"A{i}"] == [
            [f"c{i}", f"-s{i}", "0", f"a{i}*c{i}"],
            [f"s{i}", f"c{i}", "0", f"a{i}*s{i}"],
            ["0", "0", "1", "0"],
            ["0", "0", "0", "1"],
        ]


def test_poses_and_displacements_of_the_scara_arm():
    """C. Laschi, Robot mechanics and kinematics, slide Geometric manipulator model (after T. Bajd et al., eq.
    2.24): 0H1 D1, 1H2 D2 and 2H3 D3."""
    found = matrices("scara-frames")
    bottom = ["0", "0", "0", "1"]
    assert found["A1"] == [["c1", "-s1", "0", "0"], ["s1", "c1", "0", "0"], ["0", "0", "1", "l1"], bottom]
    assert found["A2"] == [["c2", "-s2", "0", "0"], ["s2", "c2", "0", "l2"], ["0", "0", "1", "0"], bottom]
    assert found["A3"] == [["1", "0", "0", "0"], ["0", "1", "0", "l3"], ["0", "0", "1", "-d3"], bottom]


DH_ROW = "robokin: 1\nname: row\njoints: [{type: R, d: 1, a: 2, alpha: 0.5}]\n"


def test_the_matrix_of_one_row():
    """M. Yim, slide DH Link Transformation; W. Lucia, slide Denavit-Hartenberg Convention; the lecture
    Homogeneous Transformations and Forward Kinematics, slide Forward kinematics: DH parameters.

    R. Ahmed (1.8) writes the same with the twist first, -ca*s. C. Laschi's slide prints -a sin(theta) and -d
    in the last column, which is wrong: her own products (a1*s1, c2*d3) have +.
    """
    symbolic = symbolic_kinematics(read_text(DH_ROW))
    printed = [[cell.replace("c", "c1").replace("s", "s1") if "a" not in cell else cell for cell in row]
               for row in LECTURES["dh_matrix"]["matrix"]]  # fmt: skip
    printed[0] = ["c1", "-s1*ca1", "s1*sa1", "a1*c1"]
    printed[1] = ["s1", "c1*ca1", "-c1*sa1", "a1*s1"]
    printed[2] = ["0", "sa1", "ca1", "d1"]
    assert texts(symbolic.T) == printed


TWO_LINKS = """
robokin: 1
name: two-link arm with the tool's frame turned
units: {length: m, angle: deg}
parameters: {a1: 1, a2: 1}
joints: [{type: R, a: a1}, {type: R, a: a2}]
tool: "Matrix([[0, 0, 1, 0], [0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 0, 1]])"
"""


def test_the_end_effector_of_the_two_link_arm():
    """W. Lucia, ENGR 7401 lecture 2, slide How to compute direct kinematics (Fig. 2.14), T_e^b."""
    assert texts(symbolic_kinematics(read_text(TWO_LINKS)).T) == [
        ["0", "s12", "c12", "a1*c1+a2*c12"],
        ["0", "-c12", "s12", "a1*s1+a2*s12"],
        ["1", "0", "0", "0"],
        ["0", "0", "0", "1"],
    ]


def test_the_stanford_arm_is_the_product_of_two_printed_matrices(rng):
    """C. Laschi, slide Stanford manipulator: T_6^0 = T_3^0 T_6^3, which is not written out there."""
    (product,) = LECTURES["products"]
    robot = robokin.load(product["robot"])
    symbolic = symbolic_kinematics(robot)
    printed = {entry["robot"]: entry["matrix"] for entry in LECTURES["closed_forms"]}
    scope = {"d2": symbolic.values["d2"], "d6": symbolic.values["d6"], "__builtins__": {}}
    for _ in range(20):
        q = rng.uniform(-3, 3, 6)
        for i in (1, 2, 4, 5, 6):
            scope |= {f"c{i}": np.cos(q[i - 1]), f"s{i}": np.sin(q[i - 1])}
        scope["d3"] = q[2]
        arm, wrist = (
            np.array([[eval(cell, scope) for cell in row] for row in printed[name]]) for name in product["of"]
        )
        values = {**symbolic.values, "__builtins__": {}, **scope}
        T = np.array([[eval(cell, values) for cell in row] for row in texts(symbolic.T)])
        assert np.max(np.abs(T - arm @ wrist)) < 1e-10
    # In the letters of both slides: a bracket of T_6^3 inside one of T_3^0.
    assert texts(symbolic.T)[0][0] == "c1*(c2*(c4*c5*c6-s4*s6)-s2*s5*c6)-s1*(s4*c5*c6+c4*s6)"


def test_the_worked_links_of_the_planar_robot():
    """R. Ahmed, Robot Kinematics (BRAC University CSE 461, 2023), 1.8: T1, T2 and T3 at 30, 45, 10 degrees.

    Printed to two digits, which are multiplied further: T2 has 22.72 = 32*0.71 for 22.63, so its position
    is held to what a cosine's rounding by 0.005 makes of 32 cm, and the products are not compared.
    """
    robot = robokin.load("planar3r-brac")
    symbolic = symbolic_kinematics(robot)
    assert symbolic.values == {"a1": 20.0, "a2": 32.0, "a3": 10.0}
    q = robot.poses["example"]
    for i in "123":
        # The values are lengths in centimetres; the angles are in radians here.
        found = matrix_of(robot, symbolic, symbolic.matrices[f"A{i}"], q[None])[0]
        printed = np.array(LECTURES["links_of_brac_example"][f"T{i}"])
        assert np.max(np.abs(found - printed)[:, :3]) <= 0.005 + 1e-12
        assert np.max(np.abs(found - printed)[:, 3]) <= 0.005 * 32


CRAIG = [
    ["c1*(c23*(c4*c5*c6-s4*s6)-s23*s5*c6)+s1*(s4*c5*c6+c4*s6)",
     "c1*(c23*(-c4*c5*s6-s4*c6)+s23*s5*s6)+s1*(c4*c6-s4*c5*s6)",
     "-c1*(c23*c4*s5+s23*c5)-s1*s4*s5", "c1*(a2*c2+a3*c23-d4*s23)-d3*s1"],
    ["s1*(c23*(c4*c5*c6-s4*s6)-s23*s5*c6)-c1*(s4*c5*c6+c4*s6)",
     "s1*(c23*(-c4*c5*s6-s4*c6)+s23*s5*s6)-c1*(c4*c6-s4*c5*s6)",
     "-s1*(c23*c4*s5+s23*c5)+c1*s4*s5", "s1*(a2*c2+a3*c23-d4*s23)+d3*c1"],
    ["-s23*(c4*c5*c6-s4*s6)-c23*s5*c6", "-s23*(-c4*c5*s6-s4*c6)+c23*s5*s6",
     "s23*c4*s5-c23*c5", "-a3*s23-a2*s2-d4*c23"],
    ["0", "0", "0", "1"],
]  # fmt: skip
"""J. J. Craig, Introduction to Robotics, 3rd ed., eq. (3.14), the PUMA 560, from memory."""


def test_the_puma_is_as_compact_as_its_textbook(rng):
    found = matrices("puma560-craig")["T"]
    assert found[0] == [
        "c1*(c23*(c4*c5*c6-s4*s6)-s23*s5*c6)+s1*(s4*c5*c6+c4*s6)",
        "-c1*(c23*(c4*c5*s6+s4*c6)-s23*s5*s6)-s1*(s4*c5*s6-c4*c6)",
        "-c1*(c23*c4*s5+s23*c5)-s1*s4*s5",
        "c1*(a2*c2+a3*c23-s23*d4)-s1*d3",
    ]
    # A sign stands before the parentheses and not in them, d follows the sines; the rest is the book's.
    angles = {name: rng.uniform(-3, 3) for name in ("1", "2", "23", "4", "5", "6")}
    scope = {letter + name: f(value) for name, value in angles.items() for letter, f in (("c", np.cos), ("s", np.sin))}
    scope |= {"a2": 0.4318, "a3": 0.0203, "d3": 0.15, "d4": 0.433, "__builtins__": {}}
    for row, printed in zip(found, CRAIG, strict=True):
        for cell, book in zip(row, printed, strict=True):
            assert abs(eval(cell, scope) - eval(book, scope)) < 1e-14
            assert sorted(filter(str.isalnum, cell)) == sorted(filter(str.isalnum, book))
