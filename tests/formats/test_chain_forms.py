"""Chains as screws, by elementary steps and by OPW's lengths, against tables and formulas that are written out."""

from __future__ import annotations

import numpy as np
import pytest
from formats.texts import DEGREES, HEAD, error_of
from kinematics.reference import forward, rot, trans
from sweeps import sweep

import robokin
from robokin.formats import library_names, read_text
from robokin.formats.library import load_any
from robokin.model import Robot
from robokin.records.description_records import robot_record
from robokin.reports.description_tables import description_table

X, Y, Z = np.eye(3)
AXES = {"x": X, "y": Y, "z": Z}


def robots(every):
    """The library's robots by name; a sample of them is looked at each time."""
    return sweep([name for name in library_names() if isinstance(load_any(name), Robot) and load_any(name).n], every)


def size_of(robot):
    """How large a robot is [m], at least one metre."""
    return max(1.0, *(abs(row.a) + abs(row.d) + (0 if row.origin is None else abs(row.origin[:3, 3]).max())
                      for row in robot.rows))  # fmt: skip


def draws(robot, rng, count=5):
    return [np.zeros(robot.n), *rng.uniform(-3, 3, (count, robot.n))]


def same(robot, other, rng, tolerance=1e-12):
    """Two robots are at the same pose wherever their joints are."""
    assert robot.types == other.types
    for q in draws(robot, rng):
        assert np.max(np.abs(forward(robot, q) - forward(other, q))) < tolerance * size_of(robot)
        T = robokin.forward_kinematics(other, q)
        assert np.max(np.abs(forward(robot, q) - T)) < tolerance * size_of(robot)


def listed(values):
    return "[" + ", ".join(repr(float(value)) for value in values) + "]"


def matrix(T):
    return "Matrix([" + ", ".join(listed(row) for row in T) + "])"


# Screws ----------------------------------------------------------------------------------------------


def axes_at_zero(robot):
    """Direction and point of each joint's axis in the world at q = 0, by the definition of each convention."""
    T = np.array(robot.base)
    found = []
    for row in robot.rows:
        moves = row.type != "fixed"
        if robot.convention == "frames":
            T = T @ row.origin
            axis = np.array(row.axis)
        else:
            axis = Z
            if robot.convention == "modified":
                T = T @ rot(X, row.alpha) @ trans(row.a, 0, 0)
        if moves:
            found.append((row.type.letter, row.sense * (T[:3, :3] @ axis), T[:3, 3]))
        turned = row.offset if row.type == "revolute" else row.theta
        slid = row.offset if row.type == "prismatic" else row.d
        if robot.convention == "frames":
            if row.type == "revolute":
                T = T @ rot(row.axis, row.offset)
            elif row.type == "prismatic":
                T = T @ trans(*(row.axis * row.offset))
        else:
            T = T @ rot(Z, turned) @ trans(0, 0, slid)
            if robot.convention == "standard":
                T = T @ trans(row.a, 0, 0) @ rot(X, row.alpha)
    return found, T @ robot.tool


@pytest.mark.parametrize("name", robots(4))
def test_the_axes_of_a_robot_and_its_zero_pose_are_the_robot(name, rng):
    robot = load_any(name)
    axes, home = axes_at_zero(robot)
    rows = "".join(f"  - {{type: {kind}, axis: {listed(w)}, at: {listed(p)}}}\n" for kind, w, p in axes)
    same(robot, read_text(f"{HEAD}convention: screws\nhome: '{matrix(home)}'\njoints:\n{rows}"), rng)


def test_a_point_anywhere_on_an_axis_is_the_axis(rng):
    text = "convention: screws\nhome: Trans(1, 2, 3)\njoints: [{{type: R, axis: [1, 2, 2], at: {}}}]\n"
    same(read_text(HEAD + text.format([1, 0, 2])), read_text(HEAD + text.format([4, 6, 8])), rng)
    slide = "convention: screws\nhome: Trans(1, 2, 3)\njoints: [{{type: R, at: [1, 1, 0]}}, {{type: P, axis: y{}}}]\n"
    same(read_text(HEAD + slide.format("")), read_text(HEAD + slide.format(", at: [5, 6, 7]")), rng)


def test_a_product_of_exponentials_written_out(rng):
    """The 3R arm of Lynch and Park, Modern Robotics (2017), example 4.2 in short: axes z, -y and x."""
    robot = read_text(
        "robokin: 1\nname: arm\nunits: {length: mm, angle: deg}\nparameters: {l1: 1000, l2: 500}\nconvention: screws\n"
        "base: Trans(0, 0, 100)\nhome: Trans(l1, 0, -l2) RPY(0, 90, 0)\n"
        "joints: {type: RRR, axis: [z, [0, -1, 0], x], at: [[0, 0, 0], [l1, 0, 0], [0, 0, -l2]], sense: [1, 1, -1]}\n"
        "poses: {home: [0, 90, 0]}\n"
    )

    def about(axis, point, angle):
        return trans(*point) @ rot(axis, angle) @ trans(*(-np.array(point)))

    for q in draws(robot, rng):
        T = about(Z, (0, 0, 0), q[0]) @ about(-Y, (1, 0, 0), q[1]) @ about(X, (0, 0, -0.5), -q[2])
        expected = trans(0, 0, 0.1) @ T @ trans(1, 0, -0.5) @ rot(Y, np.pi / 2)
        assert np.allclose(robokin.forward_kinematics(robot, q), expected, atol=1e-14)
    assert np.allclose(robot.poses["home"], [0, np.pi / 2, 0])


SCREWS = DEGREES + "convention: screws\nhome: Trans(1, 2, 3)\njoints:\n  - {type: R, axis: z, at: [1, 2, 3]}\n"


@pytest.mark.parametrize(
    ("old", "new", "where", "said"),
    [
        ("home: Trans(1, 2, 3)\n", "", "1:1", "found no 'home'"),
        ("home: Trans(1, 2, 3)", "home: [1, 2, 3]", "5:7", "transform expression"),
        ("Trans(1, 2, 3)", "Tran(1, 2, 3)", "5:7", "did you mean 'Trans'?"),
        ("home:", "hom:", "5:1", "did you mean 'home'?"),
        ("screws", "screw", "4:13", "did you mean 'screws'?"),
        ("type: R", "type: F", "7:12", "expected revolute or prismatic"),
        ("at: [1, 2, 3]", "at: [1, 2]", "7:28", "expected 3 values"),
        ("at: [1, 2, 3]", "at: 5", "7:28", "a list"),
        ("at: [1, 2, 3]", "at: [1, 2, x]", "7:35", "unknown name 'x'"),
        ("axis: z", "axis: [0, 0, 0]", "7:21", "found zero"),
        ("axis: z", "axs: z", "7:15", "did you mean 'axis'?"),
        ("axis: z", "origin: ''", "7:15", "or `convention: frames`"),
        ("axis: z", "offset: 9", "7:15", "of the screws convention"),
        ("convention: screws\n", "convention: screws\ntool: ''\n", "5:1", "'home' is the tool's pose"),
        ("convention: screws\n", "convention: screws\nc4: 5\n", "5:1", "expected it only with `convention: opw`"),
    ],
)
def test_wrong_screws(old, new, where, said):
    assert SCREWS.count(old) == 1
    error = error_of(SCREWS.replace(old, new))
    assert f"{error.line}:{error.column}" == where
    assert said in error.message


def test_screws_without_their_convention_are_answered_with_it():
    error = error_of(SCREWS.replace("convention: screws\n", ""), mistakes=3)
    assert all("`convention: screws`" in one.message for one in error.errors)


# Elementary steps ------------------------------------------------------------------------------------


def steps_of(robot):
    """A table of Denavit-Hartenberg rows as elementary steps, in radians and metres."""
    steps = []
    for number, row in zip(np.cumsum([row.moves for row in robot.rows]), robot.rows, strict=True):
        x = [f"tx({row.a!r})", f"Rx({row.alpha!r})"]
        q = f"{'-' if row.sense < 0 else ''}q{number} + {row.offset!r}".replace("+ -", "- ")
        turn, slide = f"Rz({q if row.type == 'revolute' else repr(row.theta)})", f"tz({row.d!r})"
        if row.type == "prismatic":
            slide = f"tz({q})"
        steps += [turn, slide, *x] if robot.convention == "standard" else [*x[::-1], turn, slide]
    return " ".join(steps)


@pytest.mark.parametrize("name", robots(4))
def test_a_table_by_its_elementary_steps_is_the_table(name, rng):
    robot = load_any(name)
    if robot.convention == "frames":
        return
    text = f"{HEAD}base: '{matrix(robot.base)}'\ntool: '{matrix(robot.tool)}'\nets: {steps_of(robot)}\n"
    same(robot, read_text(text), rng)


def test_the_panda_as_its_toolbox_prints_it(rng):
    """The sequence of Haviland and Corke, "Kinematic derivatives using the elementary transform sequence" (2020)."""
    text = (
        "tz(0.333) ⊕ Rz(q0) ⊕ Rx(-90°) ⊕ Rz(q1) ⊕ Rx(90°) ⊕ tz(0.316) ⊕ Rz(q2) ⊕ tx(0.0825) ⊕ Rx(90°) ⊕ Rz(q3) ⊕ "
        "tx(-0.0825) ⊕ Rx(-90°) ⊕ tz(0.384) ⊕ Rz(q4) ⊕ Rx(90°) ⊕ Rz(q5) ⊕ tx(0.088) ⊕ Rx(90°) ⊕ tz(0.107) ⊕ Rz(q6)"
    )
    panda = load_any("panda")
    for units in ("{length: m, angle: rad}", "{length: m, angle: deg}"):
        same(panda, read_text(f"{HEAD}units: {units}\nets: {text}\n"), rng)


def test_the_puma_by_its_steps(rng):
    """Corke, "A simple and systematic approach to assigning Denavit-Hartenberg parameters" (2007): tz L1, Rz q1, …"""
    robot = read_text(
        f"{HEAD}parameters: {{L1: 0.672, L2: -0.2337, L3: 0.4318, L4: 0.0203, L5: 0.0837, L6: 0.4318}}\n"
        "ets: Tz(L1) Rz(q1) Ty(L2) Ry(q2) Tz(L3) Tx(L4) Ty(L5) Ry(q3) Tz(L6) Rz(q4) Ry(q5) Rz(q6)\n"
    )
    # The same arm as a table. The zero has the arm up; L4 stands before the elbow, across the upper arm.
    far, lean = float(np.hypot(0.4318, 0.0203)), float(np.arctan2(0.0203, 0.4318))
    table = read_text(
        f"{HEAD}base: Trans(0, 0, 0.672)\njoints:\n  - {{type: R, alpha: -pi/2}}\n"
        f"  - {{type: R, a: {far!r}, d: -0.15, offset: {lean!r} - pi/2}}\n"
        f"  - {{type: R, alpha: pi/2, offset: pi/2 - {lean!r}}}\n"
        "  - {type: R, d: 0.4318, alpha: -pi/2}\n  - {type: R, alpha: pi/2}\n  - {type: R}\n"
    )
    same(table, robot, rng)
    for q in draws(robot, rng):
        expected = (
            trans(0, 0, 0.672) @ rot(Z, q[0]) @ trans(0, -0.2337, 0) @ rot(Y, q[1]) @ trans(0.0203, 0.0837, 0.4318)
        )
        expected = expected @ rot(Y, q[2]) @ trans(0, 0, 0.4318) @ rot(Z, q[3]) @ rot(Y, q[4]) @ rot(Z, q[5])
        assert np.allclose(robokin.forward_kinematics(robot, q), expected, atol=1e-14)


SAME_STEPS = [
    "tz(0.3) Rz(q1) tx(0.1) Ry(-q2) tz(q3) tx(0.2)",
    "TZ(0.3)*RZ(Q1)*TX(0.1)*RY(-Q2)*TZ(Q3)*TX(0.2)",
    "tz(0.3).Rz(q0).tx(0.1).Ry(-q1).tz(q2).tx(0.2)",
    "Tz(0.3)Rz(q(1))Tx(0.1)Ry(-q(2))Tz(q[3])Tx(0.2)",
    "tz(0.3) ⊕ Rz() ⊕ tx(0.1) ⊕ Ry(-q) ⊕ tz() ⊕ tx(0.2)",
    "tz(0.3) + Rz(theta1) + tx(0.1) + Ry( - θ₂ ) + tz(d3) + tx(0.2) ",
    "tz (0.3) | Rz(q_1), tx(l) · Ry(-q₂) tz(q3) tx(2*l)",
    "Rz(q1) Rz(90°) Rz(-pi/2) tz(0.3) tx(l) Ry(-q2) tz(q3) tx(l) Rx(0) tx(l)",
]


@pytest.mark.parametrize("text", SAME_STEPS)
def test_ways_to_write_steps(text, rng):
    robot = read_text(f'{HEAD}parameters: {{l: 0.1}}\nets: "{text}"\n')
    for q in draws(robot, rng):
        expected = trans(0, 0, 0.3) @ rot(Z, q[0]) @ trans(0.1, 0, 0) @ rot(Y, -q[1]) @ trans(0.2, 0, q[2])
        assert np.allclose(robokin.forward_kinematics(robot, q), expected, atol=1e-14)


def test_steps_over_lines_with_constants_limits_poses_and_a_tool(rng):
    robot = read_text(
        f"{DEGREES}parameters: {{d1: 300, s: 45}}\nets: |\n  tz(d1) Rz(90 - q1)\n  tx(100) Ry(q2 + s) tz(q3 - d1)\n"
        "limits: [[-90, 90], ~, [0, 500]]\ntool: Trans(0, 0, d1)\nposes: {home: [0, 90, 100]}\n"
    )
    assert robot.types == "RRP"
    assert np.allclose(robot.limits, [[-np.pi / 2, np.pi / 2], [-np.inf, np.inf], [0, 0.5]])
    assert np.allclose(robot.poses["home"], [0, np.pi / 2, 0.1])
    for q in draws(robot, rng):
        expected = trans(0, 0, 0.3) @ rot(Z, np.pi / 2 - q[0]) @ trans(0.1, 0, 0) @ rot(Y, q[1] + np.pi / 4)
        assert np.allclose(robokin.forward_kinematics(robot, q), expected @ trans(0, 0, q[2]), atol=1e-14)


@pytest.mark.parametrize(
    ("text", "column", "said"),
    [
        ("~", 6, "expected a text of steps"),
        ("[tz(1)]", 6, "expected a text of steps"),
        ("tz(1) tx(2)", 6, "found no joint"),
        ("Rz(q1) Rw(3)", 13, "did you mean 'Rx', 'Ry' or 'Rz'?"),
        ("Rz(q1) Trans(3, 0, 0)", 13, "unknown step 'Trans'"),
        ("Rz(q1) tx 3", 13, "without its argument"),
        ("Rz(q1) tx(3", 13, "expected ')'"),
        ("Rz(q1) tx(3))", 18, "expected a step"),
        ("Rz(q1) 7", 13, "expected a step"),
        ("'Rz(q1) tx(l1)'", 17, "unknown name 'l1'"),
        ("Rz(q1) tx(5°)", 16, "found '°'"),
        ("Rz(q1) Rx(pi/2)", 16, "found pi in an angle that is in degrees"),
        ("Rz(q1) tx(1e10)", 16, "expected a length below"),
        ("Rz(q1) Ry(q3)", 16, "found q3 where q2 is due"),
        ("Rz(q2) Ry(q3)", 9, "found q2 where q1 (or q0, counting from 0) is due"),
        ("Rz(q2) Ry(q1)", 9, "found q2 where q1"),
        ("Rz(q0) Ry(q2)", 16, "found q2 where q1 is due"),
        ("Rz(q1) Ry(q1)", 16, "found q1 a second time"),
        ("Rz(q1) Ry(q2 + q1)", 16, "a coupling, which ets cannot say"),
        ("Rz(q1) Ry(2*q2)", 16, "found more than the joint's variable q2 and a constant"),
        ("Rz(q1) Ry(q99999)", 16, "unknown name"),
        ("Rz(q1) Ry(d2)", 16, "unknown name 'd2'"),
    ],
)
def test_wrong_steps(text, column, said):
    error = error_of(f"{DEGREES}ets: {text}\n")
    assert (error.line, error.column) == (4, column)
    assert said in error.message


def test_all_mistakes_of_steps_at_once():
    text = f"{DEGREES}parameters: {{q2: 5}}\nets: Rz(q1) Rw(3) tx(5 mm) Ry(q2) tz(q3)\n"
    error = error_of(text, mistakes=3)
    assert [one.column for one in error.errors] == [13, 22, 31]
    error_of(f"{DEGREES}parameters: [1]\nets: Rz(q1) tx(l1)\n")
    for tail in ("joints: []", "home: ''", "convention: standard", "a1: 5"):
        assert "beside `ets`" in error_of(f"{DEGREES}ets: Rz(q1)\n{tail}\n").message
    assert "expected 2: a pair for each" in error_of(f"{DEGREES}ets: Rz(q1) tx(1) Rz(q2)\nlimits: [[0, 1]]\n").message
    assert "found min above max" in error_of(f"{DEGREES}ets: Rz(q1)\nlimits: [[1, 0]]\n").message


def test_hostile_steps_end_soon():
    for text in (
        "Rz(" * 3000,
        "1" * 9000,
        f"Rz({'1' * 9000}x°)",
        f"Rz(q1) tx({'(' * 2000}1{')' * 2000})",
        "Rz() " * 1999,
    ):
        error_of(f'{DEGREES}ets: "{text}"\n')
    error_of(f'{DEGREES}ets: "{"Rz() " * 20000}"\n')
    error_of(f'{DEGREES}ets: "{"Rz(x) " * 1500}"\n', mistakes=200)


# OPW -------------------------------------------------------------------------------------------------

OPW = (
    DEGREES + "convention: opw\na1: 150\na2: -20\nb: 30\nc1: 450\nc2: 610\nc3: 660\nc4: 80\n"
    "offsets: [10, -90, 5, 0, 0, 15]\nsenses: [-1, 1, 1, -1, 1, -1]\n"
)


def opw_pose(lengths, offsets, senses, q):
    """The flange's pose (4, 4), as the formula has it."""
    a1, a2, b, c1, c2, c3, c4 = lengths
    u = np.array(senses) * q - np.array(offsets)
    T = rot(Z, u[0]) @ trans(a1, b, c1) @ rot(Y, u[1]) @ trans(0, 0, c2) @ rot(Y, u[2]) @ trans(a2, 0, c3)
    return T @ rot(Z, u[3]) @ rot(Y, u[4]) @ rot(Z, u[5]) @ trans(0, 0, c4)


def test_an_arm_by_its_lengths(rng):
    """A KUKA KR 16's set, with offsets of every joint."""
    robot = read_text(OPW + "base: Trans(0, 0, 100)\ntool: Rot(x, 90)\nlimits: [[-185, 185], ~, ~, ~, ~, ~]\n")
    lengths, offsets = np.array([150, -20, 30, 450, 610, 660, 80]) / 1000, np.radians([10, -90, 5, 0, 0, 15])
    for q in draws(robot, rng):
        expected = trans(0, 0, 0.1) @ opw_pose(lengths, offsets, [-1, 1, 1, -1, 1, -1], q) @ rot(X, np.pi / 2)
        assert np.allclose(robokin.forward_kinematics(robot, q), expected, atol=1e-14)
    assert np.allclose(robot.limits[0], np.radians([-185, 185]))


def test_random_arms_by_their_lengths(rng):
    for _ in range(20):
        lengths, offsets = rng.uniform(-1, 1, 7), rng.uniform(-3, 3, 6)
        senses = rng.choice([-1, 1], 6)
        named = zip(("a1", "a2", "b", "c1", "c2", "c3", "c4"), lengths, strict=True)
        text = "".join(f"{name}: {float(value)!r}\n" for name, value in named)
        robot = read_text(f"{HEAD}convention: opw\n{text}offsets: {listed(offsets)}\nsenses: {[*map(int, senses)]}\n")
        for q in draws(robot, rng):
            expected = opw_pose(lengths, offsets, senses, q)
            assert np.allclose(robokin.forward_kinematics(robot, q), expected, atol=1e-13)


def test_at_zero_the_arm_points_up():
    robot = read_text(f"{HEAD}convention: opw\nc2: 2\nc3: 3\nc1: 1\nc4: 0.5\n")
    assert np.allclose(robokin.forward_kinematics(robot, np.zeros(6)), trans(0, 0, 6.5))


def test_the_inverse_of_an_arm_by_its_lengths_finds_where_it_is(rng):
    robot = read_text(OPW)
    q = rng.uniform(-1, 1, 6)
    solutions = robokin.solve_ik(robot, robokin.forward_kinematics(robot, q))
    errors = [np.max(np.abs(np.angle(np.exp(1j * (np.asarray(one.q) - q))))) for one in solutions.solutions]
    assert min(errors) < 1e-9


@pytest.mark.parametrize(
    ("old", "new", "where", "said"),
    [
        ("c2: 610\n", "", "1:1", "found no 'c2'"),
        ("c4: 80", "c5: 80", "11:1", "found the unknown key 'c5'"),
        ("c4: 80", "c4: 80 mm", "11:5", "c4: found 'mm'"),
        ("opw", "oppw", "4:13", "did you mean 'opw'?"),
        ("[10, -90, 5, 0, 0, 15]", "[10, -90, 5, 0, 0]", "12:10", "expected 6 values"),
        ("[10, -90, 5, 0, 0, 15]", "[10, -90, pi, 0, 0, 15]", "12:20", "found pi in an angle"),
        ("[-1, 1, 1, -1, 1, -1]", "[-1, 1, 1, -1, 1, 0]", "13:27", "expected 1 or -1"),
        ("[-1, 1, 1, -1, 1, -1]", "-++-+-", "13:9", "a list"),
        ("offsets:", "ofsets:", "12:1", "did you mean 'offsets'"),
        ("b: 30", "joints: []", "7:1", "expected it only with a table of joints"),
    ],
)
def test_wrong_lengths(old, new, where, said):
    assert OPW.count(old) == 1
    error = error_of(OPW.replace(old, new))
    assert f"{error.line}:{error.column}" == where
    assert said in error.message


# What symbols are made of ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    "text",
    [
        "convention: screws\nhome: Trans(l, 2*l, 0)\n"
        "joints: [{type: R, at: [l, 1, 0]}, {type: R, axis: y, at: [0, l, 5]}]\n",
        "ets: tz(l) Rz(q1) tx(2*l) Ry(30) tx(l) Rz(q2 + l) ty(l)\ntool: Trans(l, 0, 0)\n",
        "ets: tz(l) Rz(q1) tx(2) Rz(30) ty(1)\ntool: Trans(l, 0, 0)\n",
        "convention: opw\na1: l\nb: 2*l\nc2: 400\nc3: 10*l\nc4: l\noffsets: [0, l, 0, 0, 0, 0]\ntool: Trans(l, 0, 0)\n",
    ],
)
def test_the_texts_of_coordinates_are_what_they_say(text):
    """Each text that is kept has the value of its coordinate, so that symbols may stand for numbers."""
    robot = read_text(f"{DEGREES}parameters: {{l: 40}}\n{text}")

    def value(expression):
        return read_text(f"{DEGREES}parameters: {{l: 40}}\nets: tx({expression}) Rz(q1)\n").rows[0].origin[0, 3]

    kept = [(row.origin["xyz".index(at), 3] if at in "xyz" else np.degrees(row.offset) / 1000, text)
            for row in robot.rows for at, text in row.texts]  # fmt: skip
    kept += [(robot.tool["xyz".index(where[-1]), 3], text) for where, text in robot.texts]
    assert len(kept) >= 2 or robot.n == 1
    for number, expression in kept:
        assert np.isclose(number, value(expression), atol=1e-12), expression


def test_show_prints_the_variable_with_its_offset():
    robot = read_text(f"{DEGREES}ets: Rz(q1) tx(5) Rz(90 - q2) tx(5) Rz(q3 - 30)\n")
    lines = description_table(robot_record(robot, robot.units)).decode()
    assert "for q1" not in lines
    assert "0 0 1  for 90 - q2" in lines
    assert "0 0 1  for q3 - 30" in lines
