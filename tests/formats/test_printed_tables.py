"""Tables as others printed them, in pages, reports and programs: each becomes the robot that it prints."""

from __future__ import annotations

import math
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

import robokin
from robokin.errors import InputError
from robokin.formats.first_description import of_table
from robokin.formats.pasted_description import Wishes
from robokin.formats.read import read_text

PRINTED = Path(__file__).parent.parent / "data/pasted_tables"
KR210 = "R 0 0.75 0 0; R -90 0 0.35 -90; R 0 0 1.25 0; R 0 1.5 -0.054 -90; R 0 0 0 90; R 0 0 0 -90; F 0 0.303 0 0"


class Printed(NamedTuple):
    """What a table prints: convention, unit of length, and rows of kind, theta, d, a, alpha, angles in degrees.

    wishes: what is said beside it, for tables that leave it open; library: the robot of the library that it is.
    """

    source: str
    convention: str
    length: str
    rows: str
    wishes: dict | None = None
    library: str = ""


TABLES = {
    "kr210": Printed("a report on Udacity's KUKA KR210 project, README", "modified", "m", KR210),
    "kr210_names": Printed(
        "another such report: its last row is the gripper, and slides not", "modified", "m",
        "R 0 1 0 0; R -90 0 2 -90; R 0 0 3 0; R 0 5 4 -90; R 0 0 0 90; R 0 0 0 -90; F 0 6 0 0",
        {"values": {"d1": "1", "a1": "2", "a2": "3", "a3": "4", "d4": "5", "d7": "6"}},
    ),
    "kr210_two_tables": Printed("another such report, with a table of positions before", "modified", "m", KR210),
    "gen3_lite": Printed(
        "Lgx521/EE368_Project, scripts/README.md", "modified", "mm",
        "R 0 243.3 0 0; R 90 30 0 90; R 90 20 280 180; R 90 245 0 90; R 180 57 0 90; R 90 235 0 90",
    ),
    "openmanipulator": Printed(
        "a MATLAB function GetDH of the OpenManipulator-X", "modified", "mm",
        "R 0 77 0 0; R -90 0 0 -90; R 90 0 128 0; R 0 0 124 0; F 0 0 126 0", {"types": "RRRRF"},
    ),
    "named_links": Printed(
        "TickTockTime/Robotics-2018, Lab1_stanford.m: the twists have names", "standard", "m",
        "R 0 0 0 -90; R 0 .1 0 90; P 0 0 0 0; R 0 .5 0 90; R 0 0 0 -90; R 0 0 0 0",
    ),
    "leg_vectors": Printed(
        "BomingHu123/matlab_dq_hexapod, dhnormal.m: Link([th(1), d(1), a(1), alp(1)])", "standard", "m",
        "R 0 -.0112 .0503 -90; R 0 0 .0724 0; R 0 0 0 0",
    ),
    "taken_apart": Printed(
        "a script on the Gen3 Lite: alpha, a, d, theta = DH_table[i]", "standard", "m",
        "R 0 .2433 0 90; R 90 .03 .28 180; R 90 .02 0 90; R 90 .245 0 90; R 180 .057 0 90; R 90 .235 0 0",
    ),
    "planar_comment": Printed(
        "deemano/roboticArm, main.py: headings in a comment, centimetres in others", "standard", "cm",
        "R 0 13 5.1 90; R 0 0 6.65 0; R 0 4.9 6.55 0", {"values": {"a3": "6.65", "a4": "6.55", "a5": "4.9"}},
    ),
    "tuples": Printed(
        "frank20a/Robotics, data.py: rows are tuples", "standard", "m",
        "R 0 .183 0 0; R -90 0 0 -90; R 0 0 .21 0; R 180 .2215 .03 -90; R 0 0 0 90; R 0 .0237 .0055 -90",
        {"columns": ("alpha", "a", "d", "theta")},
    ),
    "chinese": Printed(
        "a paper at hanspub.org, a cell a line, as its page is copied", "standard", "m",
        "R 0 0 1 90; R 0 0 2 0; R 0 0 3 0", {"values": {"l0": "1", "l1": "2", "l2": "3"}},
    ),
    "ikpy_links": Printed(
        "a chain of ikpy, whose DHLink adds its theta", "standard", "m",
        "R 0 .1075 0 90; R 90 0 .0985 0; R 0 0 .0985 0; R 0 0 .0845 0",
    ),
    "scara_remark": Printed(
        "a README: (prismatic) behind a line's end", "standard", "m", "R 0 1 2 0; R 0 0 3 0; P 0 0 0 0; R 0 0 0 0",
        {"values": {"d1": "1", "a1": "2", "a2": "3"}},
    ),
    "ur5_symbols": Printed(
        "a sympy script on the UR5: theta is q_syms[0]", "standard", "m",
        "R 0 .1625 0 90; R 0 0 -.425 0; R 0 0 -.3922 0; R 0 .1333 0 90; R 0 .0997 0 -90; R 0 .0996 0 0",
    ),
    "seven_rows": Printed(
        "an exercise in MATLAB, two comments of which name its columns", "standard", "m",
        "F 90 1 0 90; R 0 2 0 90; R 0 4 3 -90; P 90 5 0 90; P 0 6 0 90; R 0 0 -7 180; P 0 8 0 0",
        {"values": {"L0": "1", "L1": "2", "L2A": "3", "L2B": "4", "L3": "5", "L4": "6", "L5": "7", "L6": "8"}},
    ),
    "parentheses": Printed(
        "uw-biorobotics/IKBT#8", "standard", "m",
        "R 0 1 0 90; R 90 0 2 0; R 0 0 3 0; R 90 0 0 90; R 0 9 0 0; F 0 0 0 0",
        {"columns": ("theta", "alpha", "a", "d"), "values": {"d1": "1", "d2": "2", "d3": "3", "d4": "4", "d5": "5"}},
    ),
    "double_bars": Printed(
        "siddarth09/Robotics-for-arm-manpulation, README", "standard", "mm", "R 60 0 24 0; R 45 0 30 180",
        {"types": "RR"},
    ),
    "kuka_entities": Printed(
        "another report on the KR210: its page says modified elsewhere", "modified", "m", KR210,
        {"convention": "modified"},
    ),
    "kr5_links": Printed(
        "P. Corke's mdl_KR5, in ros-industrial/kuka_experimental#130", "standard", "m",
        "R 0 0.4 0.18 90; R 0 0.135 0.6 180; R 0 0.135 0.12 -90; R 0 0.62 0 90; R 0 0 0 -90; R 0 0 0 0",
    ),
    "baxter_links": Printed(
        "a MATLAB script of Baxter's left arm, five of its joints", "standard", "m",
        "R 0 0.27035 0.069 -90; R 90 0 0 90; R 0 0.36435 0.069 -90; R 0 0 0 90; R 0 0.37429 0.01 -90",
    ),
    "irb_matrix": Printed(
        "a MATLAB script with its lengths before the matrix", "standard", "m",
        "R 0 0.399 0 -90; R -90 0 0.35 0; R 0 0 0.042 -90; R 0 0.351 0 90; R 0 0 0 -90; R -180 0.082 0 0",
    ),
    "jaco_matrix": Printed(
        "a MATLAB function getDH_rad, four of the Jaco's joints; the first turns the other way", "standard", "m",
        "-R 0 0.2755 0 90; R -90 0 0.41 180; R 90 -0.0098 0 90; R 0 -0.2502 0 60",
        {"columns": ("theta", "d", "a", "alpha")},
    ),
    "prismatic_matrix": Printed(
        "GCarmo4/SRMan-Project, RobotX.m: d before theta, called v", "standard", "mm",
        "P 0 0 0 -90; R 0 0 25 90; R -90 0 315 0; R 0 0 35 90; R 0 -365 0 -90; R 0 0 0 90; R 0 -80 0 0",
        {"columns": ("d", "theta", "a", "alpha", "offset")},
    ),
    "mycobot_lists": Printed(
        "elephantrobotics/pymycobot#7: theta, alpha, a, d", "standard", "m",
        "R 0 0.13156 0 90; R 0 0 -0.1104 0; R 0 0 -0.096 0; R 0 0.06639 0 90; R 0 0.07318 0 -90; R 0 0.0436 0 0",
        {"types": "RRRRRR"},
    ),
    "ar3_calls": Printed(
        "petercorke/robotics-toolbox-python#199", "standard", "m",
        "R 0 0.16977 0.0642 -90; R 0 0 0.305 0; R 0 0 0 90; R 0 -0.22263 0 -90; R 0 0 0 90; R 0 -0.03625 0 0",
    ),
    "m10ia_vectors": Printed(
        "4rtur1t0/ARTE#7: a list for each column", "standard", "m",
        "R 0 0.45 0.15 -90; R -90 0 0.6 0; R 0 0 0.2 -90; R 0 0.64 0 90; R 0 0 0 -90; R 180 0.1 0 0",
    ),
    "backticks": Printed(
        "notes in Markdown, every cell as code", "standard", "m", "R 0 .35 0 90; R 0 0 .45 0; R 0 0 .3 0",
    ),
    "bcr": Printed(
        "notes in Markdown, the lengths in a list before the table", "standard", "m",
        "R 0 .2 0 90; R 0 0 .065 -90; R 0 .41 0 90; R 0 0 -.065 -90; R 0 .31 0 90; R 0 0 .06 -90; R 0 .105 0 0",
    ),
    "exam_rrp": Printed(
        "an examination, its angles bold", "standard", "m", "R 0 1 0 -90; R 0 2 0 90; P 0 0 0 0",
        {"values": {"h1": "1", "d2": "2"}},
    ),
    "exam_rpr": Printed(
        "another one: the second joint slides", "standard", "m", "R 0 1 0 90; P 0 0 -2 -90; R 0 0 2 90",
        {"values": {"l1": "1", "l2": "2"}},
    ),
    "mycobot_pro": Printed(
        "a README of the myCobot Pro 600", "standard", "mm",
        "R 0 219.34 0 90; R -90 0 -250 0; R 0 0 -250 0; R 90 -108 0 -90; R 0 109.1 0 90; R 0 -75.86 0 180",
    ),
    "values_in_cells": Printed(
        "a README: `d_1 = 0.5` in a cell", "standard", "m", "R 0 .5 0 90; R 0 0 1 0; R 0 0 .8 0",
    ),
    "five_joints": Printed(
        "a report in LaTeX, its rows `0 \\to 1`", "standard", "m",
        "R 0 1 0 -90; R -90 0 2 180; R 0 0 3 180; R 90 0 0 90; R 0 9 0 0",
        {"values": {"L1": "1", "L2": "2", "L3": "3", "L4": "4", "L5": "5"}},
    ),
    "one_line": Printed(
        "LaTeX in one line", "standard", "m", "R 0 1 0 90; R 0 0 2 0; R 0 0 3 0; R 0 4 0 -90",
        {"values": {"d1": "1", "a2": "2", "a3": "3", "d4": "4"}},
    ),
    "theta_zero": Printed(
        "notes in Markdown: theta_zero is an offset", "modified", "m",
        "R 0 .33 0 0; R -90 0 .04 -90; R 0 0 .445 0; R 0 .44 .04 -90; R 0 0 0 90; R 0 .08 0 -90",
    ),
    "ur5e": Printed(
        "Universal Robots, DH Parameters for calculations of kinematics and dynamics", "standard", "m",
        "R 0 .1625 0 90; R 0 0 -.425 0; R 0 0 -.3922 0; R 0 .1333 0 90; R 0 .0997 0 -90; R 0 .0996 0 0",
        {"types": "RRRRRR"}, "ur5e",
    ),
    "mycobot_pi": Printed(
        "takeshiD/urdf2dh, README", "standard", "mm",
        "R 0 131.56 0 0; R -90 0 0 90; R 0 0 -110.4 0; R -90 66.39 -96 0; R 90 73.18 0 90; R 0 43.6 0 -90",
    ),
    "arctan": Printed(
        "a student's report: the angle is phi, with an arctangent", "modified", "m",
        "R 180 3 0 0; R 126.86989764584402 0 0 90; R 53.13010235415598 0 5 0",
        {"values": {"L0": "1", "L1": "2", "L2": "4", "L3": "3"}},
    ),
    "franka": Printed(
        "Franka's documentation, its modified convention said beside", "modified", "m",
        "R 0 .333 0 0; R 0 0 0 -90; R 0 .316 0 90; R 0 0 .0825 90; R 0 .384 -.0825 -90; R 0 0 0 90; R 0 0 .088 90; "
        "F 0 .107 0 0", {"convention": "modified"}, "panda",
    ),
    "commented_latex": Printed(
        "LaTeX in the comments of a program", "modified", "mm",
        "R 0 131.56 0 90; R 0 0 -110.4 0; R 0 0 -96 0; R 0 66.39 0 90; R 0 73.18 0 -90; R 0 0 0 0",
    ),
    "mixed_links": Printed(
        "a MATLAB script with links in both forms", "standard", "m",
        "R 0 1 0 90; R 0 1 0 -90; P 0 1 0 90; R 0 0 0 -90; R 0 1 0 0",
    ),
    "subscripts": Printed(
        "bharathkukka/6AxisManipulator, README: subscripts in HTML", "modified", "m",
        "R 0 1 0 0; R 0 0 2 -90; R 0 0 3 0; R 0 0 4 0; R 270 5 6 270; R 270 7 0 270",
        {"values": {"d1": "1", "a1": "2", "a2": "3", "a3": "4", "d2": "5", "a4": "6", "d3": "7"}},
    ),
    "kr210_subscripts": Printed("a report on the KUKA KR210, subscripts in HTML", "modified", "m", KR210),
    "kr210_dictionary": Printed("a program on the KUKA KR210: a dictionary of sympy", "modified", "m", KR210),
    "kr210_latex": Printed(
        "another report on it, LaTeX in a README, the lengths as sums beside; its alpha_1 is of the other sign",
        "modified", "m", KR210.replace("R -90 0 0.35 -90", "R -90 0 0.35 90"),
    ),
    "planar_variable": Printed(
        "a README: θ1 *(variable)*", "standard", "m", "R 0 0 1 0; R 0 0 2 0", {"values": {"L1": "1", "L2": "2"}},
    ),
    "ur10_dhlinks": Printed(
        "a program with DHLink of the Robotics Toolbox for Python, limits of two joints beside", "standard", "m",
        "R 0 .1273 0 90; R 0 0 -.612 0; R 0 0 -.5723 0; R 0 .163941 0 90; R 0 .1157 0 -90; R 0 .0922 0 0", None, "ur10",
    ),
    "doosan_dhlinks": Printed(
        "a program with DHLink, limits among the arguments", "standard", "m",
        "R 0 .135 0 90; R 90 0 .411 0; R 90 0 0 90; R 0 .368 0 -90; R 180 0 0 90; R 0 .121 0 0",
    ),
    "rail_links": Printed(
        "a MATLAB class of a UR3e on a rail: Link([pi 0 0 pi/2 1]) slides", "standard", "m",
        "P 180 0 0 90; R 0 .15185 0 90; R 0 0 -.24355 0; R 0 0 -.2132 0; R 0 .13105 0 90; R 0 .08535 0 -90; "
        "R 0 .0921 0 0",
    ),
    "rrp_links": Printed(
        "a MATLAB script, its calls over several lines: Link('theta', 0, …) slides", "modified", "m",
        "R 0 0 0 0; R 0 0 1 0; P 0 0 2 0", {"values": {"l1": "1", "l2": "2"}},
    ),
    "needle_matrix": Printed(
        "a program of sympy: a needle that turns and slides", "standard", "m",
        "P 0 0 0 0; R 0 0 0 180; P 90 0 5 90; R 0 0 2 0",
        {"columns": ("theta", "d", "a", "alpha"), "values": {"l2": "3", "l3": "4", "l4": "2"}},
    ),
    "indexed_matrix": Printed(
        "a program of sympy: q[0] is the first", "standard", "m",
        "R 0 1 2 90; R 90 0 3 0; R -90 0 0 -90; R 0 4 0 90; R 0 0 0 -90; R 0 5 0 0",
        {"columns": ("alpha", "a", "d", "theta"),
         "values": {"d1": "1", "a1": "2", "a2": "3", "d4": "4", "d6": "5"}},
    ),
    "radians_matrix": Printed(
        "a program on the iiwa, its third joint held: math.radians(-90), symbols[0]", "standard", "mm",
        "R 0 360 0 -90; R 0 0 0 90; F 0 420 0 90; R 0 0 0 -90; R 0 399.5 0 -90; R 0 0 0 90; R 0 205.5 0 0",
        {"columns": ("alpha", "a", "d", "theta")},
    ),
    "scara_cells": Printed(
        "a MATLAB function with a cell array, names in quotes", "standard", "m",
        "R 0 1 0 0; R 0 0 2 0; P 0 0 3 0; R 0 0 0 0", {"values": {"l0": "1", "l1": "2", "l2": "3"}},
    ),
    "data_frame": Printed(
        "a program of pandas: a list for each column in a dictionary", "standard", "m",
        "R 0 1 0 90; R 0 0 2 0; R 0 0 3 0",
        {"values": {"d1": "1", "a2": "2", "a3": "3"}},
    ),
    "puma_docstring": Printed(
        "the docstring of a program on the PUMA 560: travel in degrees, twists in parts of π", "standard", "m",
        "R 0 0 0 90; R 0 0 .4318 0; R 0 .15005 .0203 -90; R 0 .4318 0 90; R 0 0 0 -90; R 0 0 0 0",
    ),
    "pincher_matrix": Printed(
        "a MATLAB function of the PhantomX Pincher: jA(1)", "standard", "m",
        "R 0 .04495 0 90; R 0 0 .1035 0; R 0 0 .10375 0; R 0 0 .111 0", {"columns": ("a", "alpha", "d", "theta")},
    ),
    "boat_rotor": Printed(
        "a README with names as code, its last row the tool's", "standard", "m", "R 0 0 0 0; R 0 0 0 0; F 0 .01 0 0",
    ),
    "ur5_records": Printed(
        "a program on the UR5: DHParam(d=…, alpha=…), two of its joints", "standard", "m",
        "R 0 .089159 0 90; R 0 0 -.425 0",
    ),
    "humanoid_leg": Printed(
        "a README of a humanoid: units in some cells", "standard", "m",
        "R 0 0 0 90; R 0 0 0 90; R 0 0 0 -90; R 0 .35 0 0; R 0 .32 0 90; R 0 0 .08 0",
    ),
    "toolbox_print": Printed(
        "print(robot) of the Robotics Toolbox for Python, three joints of its PUMA 560", "standard", "m",
        "R 0 .6718 0 90; R 0 0 .4318 0; R 0 .15 .0203 -90",
    ),
}  # fmt: skip


def pose(convention, scale, rows, q):
    """The last frame (4, 4) of rows as `Printed` has them, multiplied out."""
    T, values = np.eye(4), iter(q)
    for kind, *cells in rows:
        theta, d, a, alpha = (float(cell) for cell in cells)
        theta, d, a, alpha = math.radians(theta), d * scale, a * scale, math.radians(alpha)
        theta += {"R": 1, "-R": -1}[kind] * next(values) if kind.endswith("R") else 0.0
        d += next(values) if kind == "P" else 0.0
        c, s, ca, sa = math.cos(theta), math.sin(theta), math.cos(alpha), math.sin(alpha)
        z = np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, d], [0, 0, 0, 1]])
        x = np.array([[1, 0, 0, a], [0, ca, -sa, 0], [0, sa, ca, 0], [0, 0, 0, 1]])
        T = T @ (z @ x if convention == "standard" else x @ z)
    return T


@pytest.mark.parametrize("name", TABLES)
def test_a_printed_table_is_its_robot(name):
    printed = TABLES[name]
    rows = [row.split() for row in printed.rows.split(";")]
    made = of_table((PRINTED / f"{name}.txt").read_text(encoding="utf-8"), Wishes(name, **(printed.wishes or {})))
    assert made.types == "".join(row[0][-1] for row in rows)
    assert (made.convention, made.units.length, made.missing) == (printed.convention, printed.length, ())
    robot = read_text(made.text)
    scale = {"m": 1.0, "cm": 1e-2, "mm": 1e-3}[printed.length]
    for q in np.random.default_rng(7).uniform(-2.0, 2.0, (5, robot.n)):
        T = robokin.forward_kinematics(robot, q)
        assert np.abs(T - pose(printed.convention, scale, rows, q)).max() < 2e-5  # -1.5708 is a rounded right angle
        if printed.library:
            library = robokin.forward_kinematics(robokin.load(printed.library), q)
            assert np.allclose(library[:3, 3], T[:3, 3], atol=1e-9)


def test_every_table_is_read_and_has_a_source():
    assert {path.stem for path in PRINTED.glob("*.txt")} == {*TABLES}
    assert all(printed.source for printed in TABLES.values())


HEADS = "i\tθ\td\ta\tα\n"
FIRST = HEADS + "1\tθ1\t0\t0.1\t90°\n"


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (
            FIRST + "2\tθ1\t0\t0.1\t0\n",
            "line 3: found theta1 after theta1, expected the rows from the base to the tool",
        ),
        (FIRST + "3\tθ3\t0\t1\t0\n2\tθ2\t0\t1\t0\n", "line 4: found theta2 after theta3"),
        (FIRST + "2\tθ2 - θ1\t0\t1\t0\n", "line 3: found theta1, the variable of line 2"),
        (FIRST + "2\tθ2\t0.3\t\n3\tθ3\t0\t1\t0\tx\n", "line 4: found 6 cells, expected 5"),
        ("i,theta,d,a,alpha\n1,q1,0,0.1,90°\n2,q2,0,0.1\n3,q3,0,0,1,9°\n", "line 3: found 4 cells, expected 5"),
        (FIRST + "\n" + FIRST, r"found 2 lines of headings \(line 1, '\w+, .*' and line 4, '.*'\), expected one table"),
        (
            FIRST + "\nθ\td\ta\tα\njoint angle\tlink offset\tlink length\tlink twist\n",
            r"found 2 lines of headings \(line 1, '.*' and line 4, 'θ, d, a, α'\), expected one table",
        ),
        (FIRST + "2\t0\t0\t1\t0\n3\t0\t0\t1\t0\n", "found no variable in 2 of 3 rows"),
        (FIRST + "2\tθ2 (90)\t0\t1\t0\n", r"line 3: found 'θ2 \(90\)', expected theta2 alone"),
        (FIRST + "2\tθ2 = 90\t0\t1\t0\n", "line 3: found 'θ2 = 90', expected the joint's variable"),
        (FIRST + "2\tθ2\t0.1²\t1\t0\n", "line 3: found '0.1²', expected it without the mark of a footnote"),
        (FIRST + "2\tθ2\t1 050\t1\t0\n", "line 3: '1 050' in d: found '050'"),
        (FIRST + "2\tθ2\tL1 L2\tL3\t0\n", "line 3: 'L1 L2' in d"),
        ("i\tθ [rad]\td\ta\tα [deg]\n1\tq1 + 1.57\t0\t1\t90\n", "found angles in deg and in rad"),
        ("i\tθ\td\ta\tα\n1\tq1\t0\t1\tπ/2\n2\tq2\t0\t1\t90\n", "found angles with pi, and such as 90"),
        ("i\tθ\td\ta\tα\tlimits\n1\tq1\t0\t1\t1.5708\t±170\n", "found angles such as 170 and 1.5708"),
        (FIRST + "2\tθ2*\t0\t1\t0\n", "line 2: found theta1 without a star"),
        ("i\tω\td\ta\tα\n1\tθ1 - 90°\t0\t1\t90°\n", "found joints' variables in the column 'ω'"),
        ("i\tθ\td\ta_{i-1}\tα_i\n1\tθ1\t0\t1\t90°\n", "found a and alpha of different links"),
        ("dh = [[q1, 0, 0.1, 0],\n [q2, 0, 0.1],\n [q3, 0, 0.1, 0]]", "line 2: found 3 numbers, expected 4"),
        ("dh = [q1 0 0.1 0; q2 0 0.1; q3 0 0.1 0];", "line 1: found 3 numbers, expected 4"),
        ("L(1) = Link([0 1 0 0]);\nL(2) = Link([0 1 0]);\n", "line 2: found 3 numbers in a Link"),
        ("L(1) = Link([0 1 0 0]);\nL(2) = Link();\n", "line 2: found a link without numbers"),
        ("a = RevoluteDH(d=1)\nb = RevoluteMDH(d=1)\n", "found links in the modified convention and others"),
        ("a = RevoluteDH(d=1)\nb = RevoluteDH(d=1, flip=True)\n", "line 2: found a link with flip"),
        ("d = [1, 2];\n", "found no table"),
        ("i\tθ\td_{i-1}\ta\tα\n1\tθ1\t0\t1\t90°\n2\tθ2\t0\t1\t0\n", "found d or theta of i - 1 in the headings"),
        ("L1 = Link('theta', 1, 'd', 2, 'a', 0)\nL2 = Link('d', 1)\n", "line 1: found a link with theta and d"),
        ("a = DHLink(d=1, theta=pi/2)\nb = DHLink(d=1)\n", "line 1: found theta pi/2 of a link that turns"),
        ("s = {alpha0: 0, a0: 1, d1: 1, alpha1: 0, a1: 1, alpha2: 0, a2: 1, d3: 1}", "found no value of d2"),
        ("s = {alpha0: 0, a0: 1, d1: 1, d1: 2, alpha1: 0, a1: 1, d2: 1, q2: q2}", "line 1: found d1 twice"),
        (
            "[{'d': 1, 'a': 0, 'alpha': 0}, {'d': 1, 'a': 0, 'alpha': 0, 'theta': 0}]",
            "line 1: found d, a, alpha, theta",
        ),
        ("<tr><td>θ<td>d<td>a<td>α</tr>\n<tr><td colspan=2>1<td>2<td>90</tr>", "line 2: found a cell over several"),
        (HEADS + "1(R)\tθ1\t0\t1\t90°\n2(P*)\tθ2\t0\t1\t0\n", r"line 3: found 'P\*' beside the number"),
        ("alpha1 = -pi/2\n" + FIRST + "2\tθ2\t0\t1\talpha1\n", "found alpha1 = -pi/2 beside angles in degrees"),
        ("alpha1 = 0.4\n" + HEADS + "1\tθ1\t0\t1\talpha1\n2\tθ2\t0\t1\t0\n", "found angles such as 0.4 without"),
        (
            "# theta, d, a, alpha\nm = [[q1, 0, 0.1, 0], [q2, 0, 0.2, 0]]\nfor a, alpha, d, theta in m:\n",
            "line 3: found a, alpha, d, theta and in line 1 theta, d, a, alpha",
        ),
        (HEADS + "1\tθ1\t0\t" + "1" * 5000 + "\t90°\n", "line 2: found a cell of 5000 characters"),
    ],
)
def test_a_row_is_lost_or_guessed_by_no_slip(text, sentence):
    with pytest.raises(InputError, match=sentence):
        of_table(text, Wishes())


@pytest.mark.parametrize("seed", range(60))
def test_a_row_that_lost_a_separator_is_no_row_less(seed):
    rng = np.random.default_rng(seed)
    name = [*TABLES][seed % len(TABLES)]
    lines = (PRINTED / f"{name}.txt").read_text(encoding="utf-8").split("\n")
    places = [(k, at) for k, line in enumerate(lines) for at, letter in enumerate(line) if letter in "|\t,;&"]
    if not places:
        return
    k, at = places[rng.integers(len(places))]
    lines[k] = lines[k][:at] + " " + lines[k][at + 1 :]
    try:
        made = of_table("\n".join(lines), Wishes("arm", **(TABLES[name].wishes or {})))
    except InputError:
        return
    assert len(made.types) == TABLES[name].rows.count(";") + 1, lines[k]


@pytest.mark.parametrize(("given", "sentence"), [({"length": "mm"}, "--length mm"), ({"angle": "rad"}, "--angle rad")])
def test_a_unit_against_that_of_the_table_is_refused(given, sentence):
    with pytest.raises(InputError, match=sentence):
        of_table("i\tθ\td [m]\ta [m]\tα [deg]\n1\tθ1\t0\t1\t90\n", Wishes("arm", **given))


def test_what_stands_beside_a_table():
    assert of_table(FIRST + "The arm at θ1 = 30°", Wishes()).types == "R"  # a pose, no constant
    twice = of_table(FIRST.replace("0.1", "L1") + "L1 = 0.3\nL1 = 0.5\n", Wishes())
    assert twice.missing == ("L1",)
    assert of_table("Last modified on May 2\n" + FIRST, Wishes()).convention == "standard"
    for beside in (
        "L1 = 0.3 + 0.1",
        "L1, L2 = 0.3, 0.1",
        "L2, L1 = 0.3, 0.1",
        "L1 = 1,5",
        "L1 = 0.3 * 2",
        "L1 = 300-400",
    ):
        assert of_table(FIRST.replace("0.1", "L1") + beside + "\n", Wishes()).missing == ("L1",)
    told = of_table("Modified DH parameters\n" + FIRST, Wishes())
    assert told.convention == "modified" and "convention: modified, as the text says" in told.notes


def test_a_column_of_variables_says_which_they_are():
    """R. P. Paul, Robot Manipulators, table 2.2: of the Stanford arm's d2 and d3 one is a variable."""
    text = "Link\tVariable\tα\ta\td\n1\tθ1\t-90°\t0\t0\n2\tθ2\t90°\t0\td2\n3\td3\t0°\t0\td3\n"
    made = of_table(text, Wishes())
    assert (made.types, made.missing) == ("RRP", ("d2",))


def test_limits_of_a_program():
    text = "Revolute('d', 1, 'qlim', [-170 170]*pi/180)\nRevoluteDH(d=1, alpha=pi/2, qlim=np.array([-1, 2]))\n"
    made = of_table(text.replace("[-1, 2]", "[-pi, pi/2]"), Wishes())
    assert np.degrees(read_text(made.text).limits).tolist() == pytest.approx(np.array([[-170, 170], [-180, 90]]))
    with pytest.raises(InputError, match="found the limits"):
        of_table(text.replace("pi/180", "2"), Wishes())


def test_limits_of_a_program_in_degrees_are_degrees():
    """However small: deg2rad([-3 3]) is no ±3 rad."""
    text = "a = Link('d', 1, 'qlim', deg2rad([-3 3]))\nb = Link('d', 1, 'alpha', pi/2)\nb.qlim = np.radians([-2, 1])\n"
    assert np.degrees(read_text(of_table(text, Wishes()).text).limits) == pytest.approx(np.array([[-3, 3], [-2, 1]]))


def test_nothing_of_a_call_is_lost_where_its_line_ends():
    made = of_table(
        "L(1) = Link('d', 1, ...\n 'alpha', pi/2, ...  % the twist\n 'a', 2);\nL(2) = Link('d', 0)\n", Wishes()
    )
    row = read_text(made.text).rows[0]
    assert (row.alpha, row.a) == (math.pi / 2, 2.0)


HTML = """<table><thead>
<tr><th>Joint</th><th>&theta;<sub>i</sub></th><th>d<sub>i</sub> (mm)</th><th>a (mm)</th><th>&alpha;</th></tr></thead>
<tr>
 <td>1</td><td>&theta;<sub>1</sub> &minus; 90&deg;</td><td>290</td><td>0</td><td>-90<sup>o</sup></td></tr>
<tr><td>2</td><td>&theta;<sub>2</sub></td><td>0</td><td>270</td><td>0</td></tr></table>"""
WIKI = (
    "{| class='w'\n! i !! θ !! d !! a !! α\n|-\n| 1 || θ1 - 90° || 290 || 0 || -90°\n|-\n| 2 || θ2 || 0 || 270 || 0\n|}"
)
ASCII_DOC = "|===\n|i |θ~i~ |d~i~ |a~i~ |α~i~\n|1 |θ~1~ - 90° |290 |0 |-90°\n|2 |θ~2~ |0 |270 |0\n|==="
OF_PDF = "i\nθi\ndi\nai\nαi\n1\nθ∗1 − 90°\n290\n0\n−90°\n2\nθ∗2\n0\n270\n0\n"
GRID = "+---+---+\n| i | θ | d | a | α |\n+===+\n| 1 | θ1 - 90° | 290 | 0 | -90° |\n+---+\n| 2 | θ2 | 0 | 270 | 0 |"


@pytest.mark.parametrize("text", [HTML, WIKI, ASCII_DOC, OF_PDF, GRID])
def test_a_table_is_the_same_in_each_markup(text):
    made = of_table(text, Wishes())
    rows = [(row.offset, row.d, row.a, row.alpha) for row in read_text(made.text).rows]
    assert np.allclose(rows, [(-math.pi / 2, 0.29, 0, -math.pi / 2), (0, 0, 0.27, 0)])
    with pytest.raises(InputError, match="line"):
        of_table(text.replace("290", "2.9.0"), Wishes())


def test_cells_on_lines_of_their_own_are_a_table_only_where_rows_are_numbered():
    for wrong in (OF_PDF.replace("\n2\n", "\n3\n"), OF_PDF + "1\n", OF_PDF.replace("290\n", "")):
        with pytest.raises(InputError, match="found no table"):
            of_table(wrong, Wishes())


@pytest.mark.parametrize(
    "part",
    [
        " ",
        "\n",
        "(1,",
        "a,b,c,d\n",
        "x=(",
        "|3|(prismatic)",
        "<script>",
        "<tr><td>",
        "{",
        "f(alpha=",
        "q[1]",
        "x" * 199,
        "Link('d',1)",
        "~a~",
    ],
)
def test_a_text_of_nothing_else_is_refused(part):
    """However long: none of these ends in more than a sentence, or in a search without an end."""
    with pytest.raises(InputError):
        of_table(part * (190_000 // len(part)), Wishes())


def test_a_matrix_may_break_its_rows_where_it_likes():
    for text in ("m = [q1 0 0.1 0\n q2 0 0.2 0;\n q3 0 0.3 0];", "m = [[q1,0,0.1,0], [q2,0,0.2,0],\n\n[q3,0,0.3,0]]"):
        assert of_table("% theta d a alpha\n" + text, Wishes()).types == "RRR"


def test_a_heading_of_the_next_link_makes_it_modified():
    text = (
        "i & $a_i$ & $\\alpha_i$ & $d_{i+1}$ & $\\theta_{i+1}$ \\\\ 0 & 0 & 0 & 0 & $\\theta_1$ \\\\ "
        "1 & 2 & $90^\\circ$ & 0 & $\\theta_2$ \\\\"
    )
    assert of_table(text, Wishes()).convention == "modified"


@pytest.mark.parametrize(
    "spoilt", ["a: b # c", "[x", "{y", '"', "'", "- z", "\x1b[31m", "\u202eq", "&a", "*b", "!t", "%"]
)
def test_nothing_of_a_table_steers_its_description_or_a_terminal(spoilt):
    rows = f"{spoilt} one\tq1\t0\t0.1\t90°\t{spoilt}\n{spoilt} two\tq2\t0\t0.1\t0\t{spoilt}\n"
    text = f"joint\tθ\td\ta\tα\tx{spoilt}\n{rows}{spoilt}\n"
    made = of_table(text, Wishes(spoilt))
    assert made.types == "RR" and len(read_text(made.text).rows) == 2
    assert all(note.isprintable() for note in made.notes) and made.text.replace("\n", "").isprintable()
    with pytest.raises(InputError) as told:
        of_table(FIRST + f"2\tθ2\t\x1b{spoilt}\t0\t0\n", Wishes())
    assert str(told.value).isprintable()


def test_a_value_is_an_expression():
    with pytest.raises(InputError, match="--set L1: "):
        of_table(FIRST.replace("0.1", "L1"), Wishes("arm", values={"L1": "3\n  evil: 4"}))
