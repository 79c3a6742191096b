"""The table of a robot: conventions, cells, units, limits, poses, and every way to write one wrong."""

from __future__ import annotations

import copy
import math
import pickle
import re

import numpy as np
import pytest
from formats.texts import DEGREES, HEAD, arm, cell, error_of, linkage, only_row, place
from kinematics.reference import forward, rot, trans

import robokin
from robokin.formats import read_text

X, Y, Z = np.eye(3)
LENGTHS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254}
ANGLES = {"deg": math.pi / 180, "rad": 1.0}
FRAMES = HEAD + "convention: frames\n"


# Laws ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("length", LENGTHS)
@pytest.mark.parametrize("angle", ANGLES)
def test_cells_are_in_the_units_of_the_file(length, angle):
    head = HEAD + f"units: {{length: {length}, angle: {angle}}}\n"
    m, r = LENGTHS[length], ANGLES[angle]
    tail = "poses: {there: [2, 5]}\nbase: Trans(1, 2, 3) Rot(z, 0.5)\ntool: Rot(x, 0.25) Trans(0, 0, 4)\n"
    rows = ["type: R, d: 2, a: 3, alpha: 0.5, offset: 0.25, limits: [-1, 1.5]",
            "type: P, theta: 0.75, a: 1, alpha: -0.5, offset: 4, limits: [0, 6]"]  # fmt: skip
    robot = read_text(arm(*rows, head=head, tail=tail))
    turn, slide = robot.rows
    assert (turn.theta, turn.d, turn.a, turn.alpha, turn.offset) == (0, 2 * m, 3 * m, 0.5 * r, 0.25 * r)
    assert (slide.theta, slide.d, slide.a, slide.alpha, slide.offset) == (0.75 * r, 0, m, -0.5 * r, 4 * m)
    assert turn.limits == (-1 * r, 1.5 * r)
    assert slide.limits == (0, 6 * m)
    assert np.array_equal(robot.poses["there"], [2 * r, 5 * m])
    assert np.allclose(robot.base, trans(m, 2 * m, 3 * m) @ rot(Z, 0.5 * r), atol=1e-15)
    assert np.allclose(robot.tool, rot(X, 0.25 * r) @ trans(0, 0, 4 * m), atol=1e-15)
    assert robot.units.as_record() == {"length": length, "angle": angle}


def test_units_are_metres_and_radians_unless_stated():
    for head, record in [
        (HEAD, {"length": "m", "angle": "rad"}),
        (HEAD + "units: {length: mm}\n", {"length": "mm", "angle": "rad"}),
        (HEAD + "units: {angle: deg}\n", {"length": "m", "angle": "deg"}),
        (HEAD + "units: {}\n", {"length": "m", "angle": "rad"}),
    ]:
        assert read_text(arm(head=head)).units.as_record() == record


@pytest.mark.parametrize("convention", ["standard", "modified"])
def test_a_table_is_the_product_that_its_convention_states(convention, rng):
    rows = ["type: R, d: 0.1, a: 0.2, alpha: 0.3, offset: 0.4", "type: P, theta: 0.5, a: 0.6, alpha: 0.7, offset: 0.8",
            "type: fixed, theta: 0.9, d: 1.0, a: 1.1, alpha: 1.2", "type: R, a: 0.3"]  # fmt: skip
    tail = "base: Trans(1, 2, 3)\ntool: Rot(y, 0.5)\n"
    robot = read_text(arm(*rows, head=HEAD + f"convention: {convention}\n", tail=tail))

    def step(theta, d, a, alpha):
        z, x = rot(Z, theta) @ trans(0, 0, d), trans(a, 0, 0) @ rot(X, alpha)
        return z @ x if convention == "standard" else x @ z

    for q in rng.uniform(-2, 2, (5, 3)):
        expected = trans(1, 2, 3) @ step(q[0] + 0.4, 0.1, 0.2, 0.3) @ step(0.5, q[1] + 0.8, 0.6, 0.7)
        expected = expected @ step(0.9, 1.0, 1.1, 1.2) @ step(q[2], 0, 0.3, 0) @ rot(Y, 0.5)
        assert np.allclose(robokin.forward_kinematics(robot, q), expected, atol=1e-14)
        assert np.allclose(forward(robot, q), expected, atol=1e-14)


def test_standard_is_the_convention_unless_stated():
    assert read_text(arm()).convention == "standard"


@pytest.mark.parametrize(
    ("axis", "vector"),
    [("", Z), ("axis: x", X), ("axis: y", Y), ("axis: z", Z), ("axis: Y'", Y), ("axis: [0, 0, 2]", Z),
     ("axis: [-1, 0, 0]", -X),
     ("axis: [1, 1/2, sqrt(3)]", np.array([1, 0.5, math.sqrt(3)]) / math.sqrt(4.25)), ("axis: [1e200, 0, 0]", X),
     ("axis: [-1.5e308, 0, -1.5e308]", -(X + Z) / math.sqrt(2))],
)  # fmt: skip
def test_a_frames_row_is_its_origin_and_a_motion_along_its_axis(axis, vector):
    rows = [f"type: {kind}, origin: 'Trans(1, 2, 3) Rot(x, 0.5)', offset: 0.25, {axis}".rstrip(", ") for kind in "RP"]
    robot = read_text(arm(*rows, head=FRAMES))
    assert np.allclose(robot.rows[0].axis, vector, atol=1e-15)
    origin = trans(1, 2, 3) @ rot(X, 0.5)
    expected = origin @ rot(vector, 0.7 + 0.25) @ origin @ trans(*(vector * (0.3 + 0.25)))
    assert np.allclose(robokin.forward_kinematics(robot, [0.7, 0.3]), expected, atol=1e-14)


def test_a_frames_row_needs_neither_origin_nor_axis():
    robot = read_text(arm("type: R", "type: F", "type: P", head=FRAMES))
    assert np.allclose(robokin.forward_kinematics(robot, [0.7, 0.3]), rot(Z, 0.7) @ trans(0, 0, 0.3))


@pytest.mark.parametrize(
    ("written", "kind"),
    [("revolute", "revolute"), ("R", "revolute"), ("r", "revolute"), ("prismatic", "prismatic"), ("P", "prismatic"),
     ("fixed", "fixed"), ("F", "fixed"), ("'R'", "revolute")],
)  # fmt: skip
def test_types_and_their_letters(written, kind):
    assert only_row(f"type: {written}").type == kind


def test_a_fixed_row_takes_no_variable():
    robot = read_text(arm("type: R", "type: fixed, theta: 90, d: 100", "type: P", tail="poses: {home: [90, 5]}\n"))
    assert (robot.n, robot.types, len(robot.rows)) == (2, "RP", 3)
    assert robot.joints[1].name == "3"


def test_a_chain_of_fixed_rows_has_no_joints():
    robot = read_text(arm("type: fixed, d: 100", tail="poses: {home: []}\n"))
    assert robot.n == 0
    assert robot.limits.shape == (0, 2)
    assert robot.poses["home"].shape == (0,)
    assert np.allclose(robokin.forward_kinematics(robot, []), trans(0, 0, 0.1))


def test_limits():
    assert only_row("type: R").unlimited
    row = only_row("type: R, limits: [-90, 2*45]")
    assert row.limits == (-math.pi / 2, math.pi / 2)
    assert only_row("type: P, limits: [5, 5]").limits == (0.005, 0.005)


def test_names_are_numbers_unless_given():
    robot = read_text(arm("type: R", "name: elbow  joint, type: R", "type: fixed", "type: R"))
    assert [row.name for row in robot.rows] == ["1", "elbow joint", "3", "4"]


def test_poses_hold_expressions_and_keep_their_order():
    head = DEGREES + "parameters: {p: 30}\n"
    robot = read_text(arm("type: R", "type: P", head=head, tail="poses:\n  b-1: [2*p, p/3]\n  a: [-90, 1e1]\n"))
    assert list(robot.poses) == ["b-1", "a"]
    assert robot.poses["b-1"] == pytest.approx([math.pi / 3, 0.01], rel=1e-15)


def test_everything_read_is_read_only():
    robot = read_text(arm("type: R, origin: 'Trans(1, 2, 3)', axis: x", head=FRAMES, tail="poses: {p: [1]}\n"))
    arrays = [robot.base, robot.tool, robot.limits, robot.poses["p"], robot.rows[0].origin, robot.rows[0].axis]
    for array in arrays:
        with pytest.raises(ValueError):
            array[...] = 0.0
    with pytest.raises(TypeError):
        robot.poses["q"] = None
    with pytest.raises(TypeError):
        robot.parameters["q"] = None
    with pytest.raises(AttributeError):
        robot.name = "x"


@pytest.mark.parametrize(
    "empty", ["base:\n", "tool: ~\n", "base: ''\n", "base: '  '\n", "parameters:\n", "parameters: {}\n"]
)
def test_an_optional_key_may_be_empty(empty):
    robot = read_text(arm(tail=empty))
    assert np.array_equal(robot.base, np.eye(4))
    assert np.array_equal(robot.tool, np.eye(4))


# The table by columns --------------------------------------------------------------------------------


def test_columns_are_rows():
    text = HEAD + (
        "joints:\n  type: RPF\n  name: [a, b, c]\n  theta: [0, 0.5, 0.25]\n  d: [1, 0, 2]\n  a: [3, 4, 5]\n"
        "  alpha: [pi/2, 0, 0]\n  offset: [0.1, 0.2, 0]\n  limits: [[-1, 1], ~, ]\n"
    )
    columns = read_text(text.replace("~, ]", "~, ~]"))
    rows = read_text(arm(
        "name: a, type: R, d: 1, a: 3, alpha: pi/2, offset: 0.1, limits: [-1, 1]",
        "name: b, type: P, theta: 0.5, a: 4, offset: 0.2", "name: c, type: F, theta: 0.25, d: 2, a: 5", head=HEAD,
    ))  # fmt: skip
    for one, other in zip(columns.rows, rows.rows, strict=True):
        assert vars(one) == vars(other)


@pytest.mark.parametrize(
    "types", ["RRPR", "'RRPR'", "R R P R", "rrpr", "[R, R, P, R]", "[revolute, revolute, prismatic, r]"]
)
def test_the_types_of_columns(types):
    robot = read_text(DEGREES + f"joints: {{type: {types}, a: [1, 2, 3, 4]}}\n")
    assert robot.types == "RRPR"
    assert [row.a for row in robot.rows] == [0.001, 0.002, 0.003, 0.004]


def test_columns_of_frames():
    text = FRAMES + "joints:\n  type: RP\n  origin: ['Trans(1, 0, 0)', ~]\n  axis: [[0, 1, 0], x]\n"
    robot = read_text(text)
    assert np.allclose(robokin.forward_kinematics(robot, [0.5, 2]), trans(1, 0, 0) @ rot(Y, 0.5) @ trans(2, 0, 0))


@pytest.mark.parametrize("zero", ["0", "0.0", "0.", "-0", ".0", "00", "~", ""])
def test_a_zero_where_the_variable_stands_says_nothing(zero):
    robot = read_text(DEGREES + f"joints: {{type: RP, theta: [{zero or '~'}, 90], d: [10, {zero or '~'}]}}\n")
    assert (robot.rows[0].theta, robot.rows[1].d) == (0.0, 0.0)


@pytest.mark.parametrize(
    ("columns", "at", "said"),
    [
        ("type: RRR, a: [1, 2]", "4:24", "found 2 values in the column a, expected 3"),
        ("type: RRR, a: [1, 2, 3, 4]", "4:24", "found 4 values"),
        ("type: RRR, a: []", "4:24", "found 0 values"),
        ("type: RRR, a: 5", "4:24", "found '5', expected the column a: a list"),
        ("type: RRR, limits: [0, 1]", "4:29", "found 2 values in the column limits"),
        ("a: [1, 2]", "4:9", "found no 'type'"),
        ("type: RXR", "4:17", "found 'X' as the type"),
        ("type: 'RXR'", "4:18", "found 'X' as the type"),
        ("type: [R, X]", "4:20", "found 'X' as the type"),
        ("type: [R, [P]]", "4:20", "found a list of 1"),
        ("type: {R: 1}", "4:16", "expected the joints' types: a list"),
        ("type: ''", "4:9", "found no joints"),
        ("type: RR, theta: [0, 45]", "4:31", "a constant shift as 'offset'"),
        ("type: RP, d: [0, 5]", "4:27", "d = q + offset"),
        ("type: RF, offset: [0, 5]", "4:32", "it has no variable"),
        ("type: RF, thta: [0, 5]", "4:20", "did you mean 'theta'"),
        ("type: RF, a: [0, 5 mm]", "4:27", "a of row 2: found 'mm'"),
        ("type: RF, origin: [~, ~]", "4:20", "`convention: frames`"),
        ("type: RR, name: [a, a]", "4:17", "expected another name"),
    ],
)
def test_wrong_columns(columns, at, said):
    error = error_of(f"{DEGREES}joints: {{{columns}}}\n")
    assert said in error.message
    assert f"{error.line}:{error.column}" == at


# Cells that hold what they cannot --------------------------------------------------------------------

NO_NUMBERS = [
    ".inf", "-.inf", "+.INF", ".nan", ".NaN", "nan", "inf", "-inf", "Infinity", "1e999", "-1e999", "9**9**9",
    "9**9**9**9",
    "(0-8)**(1/3)", "1/0", "sqrt(-1)", "asin(2)", "~", "", "null", "no", "yes", "true", "1:30", "0x10", "0o7",
    "1_000", "1 000", "1.000,5", "12mm", "45°", "−1", "2×3", "π/2", "'1", "[1]", "{a: 1}", "1e", "--", "()", "a", "1 +",
    "@", "'' ''", "1e308*10", "sin", "sin()", "None", "__import__('os')", "1;2", "½",
]  # fmt: skip


@pytest.mark.parametrize("text", NO_NUMBERS)
@pytest.mark.parametrize(
    "before",
    ["joints:\n  - type: P\n    a: ", "joints:\n  - type: P\n    alpha: ", "joints:\n  - type: P\n    theta: ",
     "joints:\n  - type: R\n    d: ", "joints:\n  - type: R\n    offset: ", "parameters:\n  p: ",
     "joints:\n  - type: R\n    limits:\n      - 0\n      - ", "joints:\n  - type: R\nposes:\n  p:\n    - "],
    ids=["a", "alpha", "theta", "d", "offset", "parameter", "limits", "pose"],
)  # fmt: skip
def test_every_cell_takes_a_finite_number(before, text):
    body = before + text + "\n"
    error = error_of(DEGREES + body + ("" if "joints" in body else "joints: [{type: R}]\n"))
    assert error.line >= len((DEGREES + before).splitlines())


@pytest.mark.parametrize("text", ["012", "1e1", "  10 ", "'10'", '"5*2"', "10.", "20/2", "+10", "\u00a010", "2*(3+2)"])
def test_every_way_to_write_a_number(text):
    assert only_row(f"type: R, a: {text}", head=HEAD).a == (12.0 if "12" in text else 10.0)


def test_one_thousandth_is_a_number():
    assert only_row("type: R, a: 1e-3", head=HEAD).a == 1e-3


@pytest.mark.parametrize("name", ["alpha", "theta"])
@pytest.mark.parametrize("text", ["pi/2", "-pi", "p", "q/2", "asin(1)*pi/180", "0*pi"])
def test_an_angle_in_degrees_mentions_no_pi(name, text):
    error = error_of(arm(f'type: P, {name}: "{text}"', head=DEGREES + "parameters: {p: pi/2, q: p + 1}\n"))
    assert "found pi in an angle that is in degrees" in error.message
    assert f"write deg({text})" in error.message
    assert (error.line, error.column) == (6, 15 + len(name) + 2)


@pytest.mark.parametrize(
    ("text", "at"),
    [
        (arm("type: R, offset: pi/2"), "5:23"),
        (arm("type: R, limits: [-pi, 90]"), "5:24"),
        (arm("type: R", tail="poses: {p: [pi]}\n"), "6:13"),
        (arm("type: R", tail="base: Rot(z, pi/2)\n"), "6:7"),
        (arm("type: R", tail="tool: Trans(0, sin(pi/6), 0)\n"), "6:7"),
        (arm("type: R, a: 100*sin(pi/6)"), "5:18"),
        (arm("type: R", head=DEGREES + "parameters: {s: sin(pi/6)}\n"), "4:17"),
    ],
)
def test_pi_in_degrees_wherever_an_angle_is_due(text, at):
    error = error_of(text)
    assert "write deg(" in error.message
    assert f"{error.line}:{error.column}" == at


def test_lengths_in_degrees_and_angles_in_radians_may_mention_pi():
    assert cell("2*pi") == pytest.approx(2e-3 * math.pi)
    assert cell("deg(pi/2)", "alpha") == pytest.approx(math.pi / 2)
    assert only_row("type: P, offset: pi, limits: [-pi, pi]").offset == pytest.approx(1e-3 * math.pi)
    assert only_row("type: R, alpha: pi/2, limits: [-pi, pi]", head=HEAD).limits == (-math.pi, math.pi)


@pytest.mark.parametrize(
    ("expression", "value"),
    [
        ("sin(30)", 0.5),
        ("cos(60)", 0.5),
        ("2*tan(45)", 2.0),
        ("asin(1)", 90.0),
        ("sqrt(2)*cos(45)", 1.0),
        ("atan2(1, 1)", 45.0),
    ],
)
def test_trigonometry_is_in_the_unit_of_the_file(expression, value):
    assert cell(expression, head=HEAD + "units: {angle: deg}\n") == pytest.approx(value, rel=1e-15)


# Rows that are wrong ---------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("row", "column", "said"),
    [
        ("type: R, theta: 90", 22, "expected the variable (`theta: q + c`), or no theta and a constant"),
        ("type: R, theta: 0", 22, "found '0' as theta of row 1, where the joint variable stands"),
        ("type: R, theta: ", 22, "a constant shift as 'offset' (theta = q + offset)"),
        ("type: P, d: 5", 18, "no d and a constant shift as 'offset' (d = q + offset)"),
        ("type: fixed, offset: 5", 27, "it has no variable"),
        ("type: F, limits: [0, 1]", 23, "it has no variable"),
        ("a: 5", 5, "found no 'type' in row 1, expected type: revolute (R), prismatic (P), helical (H) or fixed (F)"),
        ("type: revolut", 12, "did you mean 'revolute'"),
        ("type: Revolute", 12, "did you mean 'revolute'"),
        ("type: spherical", 12, "expected revolute, prismatic, helical or fixed"),
        ("type: ", 12, "found nothing, expected the type"),
        ("type: [R]", 12, "found a list of 1, expected the type"),
        ("type: R, alhpa: 5", 15, "found the unknown key 'alhpa' in row 1; did you mean 'alpha'?"),
        ("type: R, Alpha: 5", 15, "did you mean 'alpha'"),
        ("type: R, zzz: 5", 15, "expected one of name, type, limits, offset, sense, theta, d, a, alpha"),
        ("type: R, origin: 'Trans(1, 0, 0)'", 15, "expected one of name, type, limits, offset, sense, theta, d, a"),
        ("type: R, axis: x", 15, "or `convention: frames`"),
        ("type: R, limits: [90, -90]", 23, "found min above max in the limits of row 1"),
        ("type: R, limits: [1]", 23, "found a list of 1 as limits of row 1"),
        ("type: R, limits: [1, 2, 3]", 23, "expected 2 values"),
        ("type: R, limits: 90", 23, "found '90', expected limits of row 1: [min, max]: a list"),
        ("type: R, limits: {min: 0, max: 1}", 23, "found a mapping"),
        ("type: R, limits: [-.inf, 1]", 24, "expected a finite number"),
        ("type: R, name: ", 21, "found nothing, expected the name of row 1"),
        ("type: R, name: [a]", 21, "expected the name of row 1"),
        ("type: R, a: [1]", 18, "found a list of 1, expected a of row 1: a number or an expression"),
        ("type: R, a: l9", 18, "a of row 1: found the unknown name 'l9'"),
        ('type: R, a: "1 +\\n zz"', 18, "found the unknown name 'zz', expected pi or a number (in '1 + zz')"),
        ('type: R, name: "a\\e[31m"', 21, "found 'a\\x1b[31m' with a control character"),
    ],
)
def test_a_wrong_row(row, column, said):
    error = error_of(arm(row))
    assert said in error.message
    assert (error.line, error.column) == (5, column)


@pytest.mark.parametrize(
    ("row", "column", "said"),
    [
        ("type: R, theta: 5", 15, "found 'theta' in row 1 of the frames convention, expected one of name, type"),
        ("type: R, a: 5", 15, "or `convention: standard or modified`"),
        ("type: R, axis: w", 21, "expected x, y, z or [x, y, z]"),
        ("type: R, axis: [1, 0]", 21, "found a list of 2 as the axis of row 1"),
        ("type: R, axis: [0, 0, 0]", 21, "found zero as the axis of row 1"),
        ("type: R, axis: [0, 0, nan]", 28, "expected a finite number"),
        ("type: R, axis: {x: 1}", 21, "found a mapping as the axis"),
        ("type: R, axis: ", 21, "found nothing as the axis"),
        ("type: R, origin: [1, 2, 3]", 23, "expected origin of row 1: a transform expression such as"),
        ("type: R, origin: 'Tran(1, 0, 0)'", 23, "did you mean 'Trans'"),
        ("type: R, origin: 5", 23, "expected a step such as"),
    ],
)
def test_a_wrong_row_of_frames(row, column, said):
    error = error_of(arm(row, head=FRAMES))
    assert said in error.message
    assert (error.line, error.column) == (5, column)


@pytest.mark.parametrize(
    ("text", "at", "said"),
    [
        (arm("name: a, type: R", "name: a, type: R"), "6:5", "found the name 'a' of row 2 on row 1 too"),
        (arm("name: 2, type: R", "type: R"), "6:5", "expected another name"),
        (DEGREES + "joints: []\n", "4:9", "found no joints"),
        (DEGREES + "joints:\n", "4:8", "found nothing, expected the joints: a list"),
        (DEGREES + "joints: RRR\n", "4:9", "found 'RRR', expected the joints: a list"),
        (DEGREES + "joints: [R]\n", "4:10", "found 'R', expected row 1: a mapping"),
        (DEGREES + "joints: [[R]]\n", "4:10", "found a list of 1, expected row 1"),
        (DEGREES + "joints: [{type: R}, ~]\n", "4:21", "found nothing, expected row 2"),
        (DEGREES, "1:1", "found no 'joints' in a robot"),
        (arm(head=DEGREES + "convention: craig\n"), "4:13", "expected standard, modified, frames, screws or opw"),
        (arm(head=DEGREES + "convention: Standard\n"), "4:13", "did you mean 'standard'"),
        (arm(head=HEAD + "units: mm\n"), "3:8", "found 'mm', expected units: a mapping"),
        (arm(head=HEAD + "units: {length: ft}\n"), "3:17", "expected m, cm, mm or in"),
        (arm(head=HEAD + "units: {angle: degrees}\n"), "3:16", "expected rad or deg"),
        (arm(head=HEAD + "units: {lenght: m}\n"), "3:9", "did you mean 'length'"),
        (arm(head=HEAD + "units: {length: [m]}\n"), "3:17", "found a list of 1"),
        (arm(tail="poses: [1]\n"), "6:8", "found a list of 1, expected poses"),
        (arm(tail="poses: {home: 5}\n"), "6:15", "expected the pose home: a list"),
        (arm(tail="poses: {home: [1, 2]}\n"), "6:15", "found 2 values in the pose home, expected 1"),
        (arm(tail="poses: {home: []}\n"), "6:15", "found 0 values"),
        (arm(tail="poses: {home: [[1]]}\n"), "6:16", "expected the pose home: a number"),
        (arm(tail="poses: {1a: [0]}\n"), "6:9", "found the pose '1a', expected a name of letters"),
        (arm(tail="poses: {a b: [0]}\n"), "6:9", "expected a name of letters"),
        (arm(tail="base: [1, 2]\n"), "6:7", "expected base: a transform expression"),
        (arm(tail="base: Trans(1, 2)\n"), "6:7", "base: found ')' after 2 of 3 arguments"),
        (arm(tail="tool:\n  Trans(0, 0, 1) Foo(1)\n"), "7:3", "tool: found the unknown step 'Foo'"),
        (arm(tail="tool: Trans(1e999, 0, 0)\n"), "6:7", "too large"),
        (arm(tail="tool: Trans(1, 0, 0)" + " Trans(1, 0, 0)" * 9999 + "\n"), "6:7", "expected at most"),
        (arm(*["type: R"] * 1001), "5:3", "found 1001 rows, expected at most 1000"),
    ],
)  # fmt: skip
def test_a_wrong_table(text, at, said):
    error = error_of(text)
    assert said in error.message
    assert f"{error.line}:{error.column}" == at


def test_a_robot_can_be_copied_and_pickled():
    robot = robokin.load("puma560")
    for again in (copy.deepcopy(robot), pickle.loads(pickle.dumps(robot))):
        assert (again.name, again.units, again.types, dict(again.parameters)) == (
            robot.name, robot.units, robot.types, dict(robot.parameters),
        )  # fmt: skip
        q = again.poses["home"]
        assert np.array_equal(robokin.forward_kinematics(again, q), robokin.forward_kinematics(robot, q))
        with pytest.raises(ValueError):
            q[0] = 1.0


@pytest.mark.parametrize(
    ("text", "at"),
    [
        (arm("type: R, a: 1e308", head=HEAD), "4:18"),
        (arm("type: R, a: 1000001", head=HEAD), "4:18"),
        (arm("type: R, d: l1", head=DEGREES + "parameters: {l1: 1000000001}\n"), "6:18"),
        (arm("type: R, alpha: -1e91", head=HEAD), "4:22"),
        (arm("type: P, limits: [-1e100, 1]", head=HEAD), "4:24"),
        (arm("type: P, offset: 10**99", head=HEAD), "4:23"),
        (arm(head=HEAD, tail="tool: Trans(0, 0, 1e200)\n"), "5:7"),
        (arm(head=HEAD, tail="tool: Trans(1e7, 0, 0) Trans(-1e7, 0, 0)\n"), "5:7"),
        (arm(head=HEAD, tail="base: Inv(DH(0, -1e7, 0, 0))\n"), "5:7"),
        (arm(head=HEAD, tail="base: Matrix([[1, 0, 0, 1e7], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])\n"), "5:7"),
        (arm("type: R, origin: 'Trans(0, 1e7, 0)'", head=FRAMES), "5:23"),
        (arm(head=HEAD, tail="poses: {p: [1e300]}\n"), "5:13"),
        (linkage("type: revolute, links: [ground, crank], at: [0, 1e300]"), "6:54"),
        (linkage("type: helical, links: [ground, crank], pitch: -1e300"), "6:52"),
    ],
)
def test_what_no_machine_measures_is_refused(text, at):
    """So that no sum or product of what a file holds can overflow, and lengths beside it still have their digits."""
    error = error_of(text)
    assert re.search(r"expected (a length below 1e\+06 m|an angle below 1e\+90 rad)", error.message)
    assert f"{error.line}:{error.column}" == at


def test_a_thousand_rows_are_read():
    robot = read_text(DEGREES + "joints:\n" + "  - {type: R, a: 1, alpha: 90}\n" * 1000)
    assert robot.n == 1000


def test_a_wrong_row_is_counted_and_placed():
    assert place(arm("type: R", "type: R, a: 1", "type: R, a: x")) == "7:18"
    assert "row 3" in error_of(arm("type: R", "type: R", "type: R, a: x")).message
