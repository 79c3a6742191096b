"""Transform expressions against products of matrices that are written a second time."""

from __future__ import annotations

import math
import time

import numpy as np
import pytest
from kinematics.reference import rot, trans

from robokin.errors import ExpressionError
from robokin.formats.number_expressions import Scope
from robokin.formats.parameters import Parameters
from robokin.formats.printed_matrices import pose_from_matrix
from robokin.formats.transform_expressions import evaluate_transform
from robokin.units import Units

X, Y, Z = np.eye(3)
SI = Units()
MM_DEG = Units("mm", "deg")


def evaluate(text, units=SI, notes=None, texts=None):
    scope = Parameters(texts or {}, units.degrees).scope()
    return evaluate_transform(text, scope, units, notes)


def same(text, expected, units=SI, atol=1e-15):
    T = evaluate(text, units)
    assert T.shape == (4, 4)
    assert np.allclose(T, expected, rtol=0, atol=atol), T


def refused(text, units=SI):
    with pytest.raises(ExpressionError) as caught:
        evaluate(text, units)
    error = caught.value
    assert "expected" in error.message or "did you mean" in error.message
    assert 0 <= error.position <= len(text)
    return error


AXES = {"x": X, "y": Y, "z": Z}
ORDERS = ["xyz", "xzy", "yxz", "yzx", "zxy", "zyx", "xyx", "xzx", "yxy", "yzy", "zxz", "zyz"]


@pytest.mark.parametrize("order", ORDERS)
def test_the_twelve_orders_of_euler_angles(order):
    """Lower case turns about moving axes, so the steps multiply; upper case about fixed ones, so backwards."""
    first, second, third = (rot(AXES[letter], angle) for letter, angle in zip(order, (0.1, -0.2, 3.0), strict=True))
    same(f"Euler({order}, 0.1, -0.2, 3)", first @ second @ third)
    same(f"euler({order.upper()}, 0.1, -0.2, 3)", third @ second @ first)
    same(f"Euler({order}, 90, 0, -90)", evaluate(f"Rot({order[0]}, 90) Rot({order[2]}, -90)", MM_DEG), MM_DEG)


def test_orders_that_are_none_are_refused():
    for text in ("Euler(xxy, 1, 2, 3)", "Euler(Xyz, 1, 2, 3)", "Euler(xyz 1, 2, 3)", "Euler(xyz, 1, 2)", "Euler(xyz)"):
        refused(text)
    # A parameter with such a name is a parameter.
    assert np.allclose(evaluate("Euler(xyz, 1, 2)", texts={"xyz": "0.5"}), evaluate("Euler(0.5, 1, 2)"))


# Each step -------------------------------------------------------------------------------------------

STEPS = [
    ("", np.eye(4)),
    ("  ", np.eye(4)),
    ("Trans(1, -2, 3)", trans(1, -2, 3)),
    ("Rot(x, 0.3)", rot(X, 0.3)),
    ("Rot(y, 0.3)", rot(Y, 0.3)),
    ("Rot(z, 0.3)", rot(Z, 0.3)),
    ("Rot(z, -pi/2)", rot(Z, -math.pi / 2)),
    ("Rot([0, 0, 5], 0.3)", rot(Z, 0.3)),
    ("Rot([1, -2, sqrt(3)], 0.3)", rot([1, -2, math.sqrt(3)], 0.3)),
    ("RPY(0.1, 0.2, 0.3)", rot(Z, 0.3) @ rot(Y, 0.2) @ rot(X, 0.1)),
    ("Euler(0.1, 0.2, 0.3)", rot(Z, 0.1) @ rot(Y, 0.2) @ rot(Z, 0.3)),
    # KUKA: R = Rz(A) Ry(B) Rx(C); FANUC: R = Rz(R) Ry(P) Rx(W); Kawasaki: R = Rz(O) Ry(A) Rz(T).
    ("ABC(0.1, 0.2, 0.3)", rot(Z, 0.1) @ rot(Y, 0.2) @ rot(X, 0.3)),
    ("WPR(0.1, 0.2, 0.3)", rot(Z, 0.3) @ rot(Y, 0.2) @ rot(X, 0.1)),
    ("OAT(0.1, 0.2, 0.3)", rot(Z, 0.1) @ rot(Y, 0.2) @ rot(Z, 0.3)),
    ("RotVec(0.1, -0.2, 0.3)", rot([0.1, -0.2, 0.3], math.sqrt(0.14))),
    ("RotVec(0, 0, 0)", np.eye(4)),
    ("RotVec(0, 4, 0)", rot(Y, 4)),
    ("QuatXYZW(0, sin(0.2), 0, cos(0.2))", rot(Y, 0.4)),
    ("QuatXYZW(0, 0, 0, -1)", np.eye(4)),
    ("Quat(cos(0.2), 0, sin(0.2), 0)", rot(Y, 0.4)),
    ("Quat(-1, 0, 0, 0)", np.eye(4)),
    ("DH(0.1, 2, 3, 0.4)", rot(Z, 0.1) @ trans(0, 0, 2) @ trans(3, 0, 0) @ rot(X, 0.4)),
    ("MDH(0.4, 3, 0.1, 2)", rot(X, 0.4) @ trans(3, 0, 0) @ rot(Z, 0.1) @ trans(0, 0, 2)),
    ("Inv(Trans(1, 2, 3))", trans(-1, -2, -3)),
    ("Inv(Rot(x, 0.3) Trans(1, 2, 3))", trans(-1, -2, -3) @ rot(X, -0.3)),
    ("Inv(Inv(DH(0.1, 2, 3, 0.4)))", rot(Z, 0.1) @ trans(3, 0, 2) @ rot(X, 0.4)),
    ("Inv()", np.eye(4)),
    ("Matrix([[0, -1, 0, 4], [1, 0, 0, 5], [0, 0, 1, 6], [0, 0, 0, 1]])", trans(4, 5, 6) @ rot(Z, math.pi / 2)),
    ("Matrix([[0, -1, 0, 4], [1, 0, 0, 5], [0, 0, 1, 6]])", trans(4, 5, 6) @ rot(Z, math.pi / 2)),
]


@pytest.mark.parametrize(("text", "expected"), STEPS, ids=[text for text, _ in STEPS])
def test_step(text, expected):
    same(text, expected)


@pytest.mark.parametrize(("text", "expected"), STEPS[2:], ids=[text for text, _ in STEPS[2:]])
def test_laws_of_a_product(text, expected):
    same(f"{text} {text}", expected @ expected, atol=1e-14)
    same(f"{text}*{text}", expected @ expected, atol=1e-14)
    same(f"{text}{text}", expected @ expected, atol=1e-14)
    same(f"Inv({text}) {text}", np.eye(4), atol=1e-14)
    same(f"{text} Inv({text})", np.eye(4), atol=1e-14)
    same(
        text.swapcase().replace("PI", "pi").replace("SQRT", "sqrt").replace("COS", "cos").replace("SIN", "sin"),
        expected,
    )


def test_steps_multiply_from_left_to_right():
    same("Trans(1, 0, 0) Rot(z, 0.5) Trans(0, 2, 0)", trans(1, 0, 0) @ rot(Z, 0.5) @ trans(0, 2, 0))
    same("Rot(z, 0.5)\n  * Trans(0, 2, 0)\n  Rot(x, 1)", rot(Z, 0.5) @ trans(0, 2, 0) @ rot(X, 1.0))


def test_the_inverse_of_a_product_is_the_product_of_inverses():
    a, b = "DH(0.3, 1, 2, 0.7)", "RPY(1, 2, 3) Trans(4, 5, 6)"
    assert np.allclose(evaluate(f"Inv({a} {b})"), evaluate(f"Inv({b}) Inv({a})"), atol=1e-14)


@pytest.mark.parametrize("axis", ["y'", "y''", "Y'", "Y", "y′", "y’"])
def test_a_primed_axis_is_the_axis(axis):
    same(f"Rot(z, 0.1) Rot({axis}, 0.2) Rot(z{axis[1:]}, 0.3)", rot(Z, 0.1) @ rot(Y, 0.2) @ rot(Z, 0.3))


# Units and parameters --------------------------------------------------------------------------------


@pytest.mark.parametrize(("length", "metres"), [("m", 1.0), ("cm", 0.01), ("mm", 0.001), ("in", 0.0254)])
def test_lengths_are_in_the_unit_at_hand(length, metres):
    units = Units(length, "deg")
    same("Trans(10, 20, 30)", trans(*(metres * np.array([10, 20, 30]))), units)
    same("DH(90, 10, 20, 0)", rot(Z, math.pi / 2) @ trans(20 * metres, 0, 10 * metres), units, atol=1e-14)
    same("MDH(90, 10, 0, 20)", rot(X, math.pi / 2) @ trans(10 * metres, 0, 20 * metres), units, atol=1e-14)
    same("Matrix([[1,0,0,10],[0,1,0,20],[0,0,1,30]])", trans(*(metres * np.array([10, 20, 30]))), units)


def test_angles_are_in_the_unit_at_hand():
    same("RPY(10, 20, 30)", evaluate("RPY(rad(10), rad(20), rad(30))"), MM_DEG)
    same("Rot(z, deg(pi/2))", rot(Z, math.pi / 2), MM_DEG)
    same("Rot([sin(30), 0, cos(60)], 90)", rot([1, 0, 1], math.pi / 2), MM_DEG)


@pytest.mark.parametrize(
    ("text", "angle"),
    [("Rot(z, pi/2)", "pi/2"), ("RPY(0, pi, 0)", "pi"), ("Euler(0, 0, -pi)", "-pi"), ("DH(pi/2, 0, 0, 0)", "pi/2"),
     ("MDH(2*pi, 0, 0, 0)", "2*pi"), ("Trans(sin(pi/6), 0, 0)", "pi/6"), ("Inv(Rot(x, (pi)))", "(pi)")],
)  # fmt: skip
def test_an_angle_in_degrees_mentions_no_pi(text, angle):
    error = refused(text, MM_DEG)
    assert f"write deg({angle})" in error.message
    assert text[error.position :].startswith(angle)
    assert evaluate(text).shape == (4, 4)


def test_parameters_are_numbers_here_too():
    T = evaluate("Trans(x, 2*x, Trans) Rot(x, x)", texts={"x": "0.5", "Trans": "3"})
    assert np.allclose(T, trans(0.5, 1, 3) @ rot(X, 0.5))


# Matrices and quaternions ----------------------------------------------------------------------------


def matrix_text(M):
    return "Matrix([" + ", ".join("[" + ", ".join(f"{v!r}" for v in map(float, row)) + "]" for row in M) + "])"


def test_a_whole_matrix_is_taken_as_it_stands():
    T = trans(1, 2, 3) @ rot([1, 2, 3], 0.7)
    notes = []
    assert np.array_equal(evaluate(matrix_text(T), notes=notes), T)
    assert notes == []


@pytest.mark.parametrize("digits", [4, 5, 8])
def test_a_printed_matrix_becomes_the_nearest_rotation(digits, rng):
    for _ in range(20):
        R = rot(rng.normal(size=3), rng.uniform(0, 3))
        notes = []
        T = evaluate(matrix_text(np.round(R, digits)), notes=notes)
        assert np.allclose(T[:3, :3].T @ T[:3, :3], np.eye(3), atol=1e-14)
        assert np.linalg.det(T[:3, :3]) > 0
        assert np.max(np.abs(T - R)) < 2 * 10.0**-digits
        assert len(notes) == 1
        assert "nearest rotation" in notes[0]


def test_a_printed_quaternion_is_normalised_with_a_note():
    notes = []
    T = evaluate("Quat(0.7071, 0, 0, 0.7071)", notes=notes)
    assert np.allclose(T, rot(Z, math.pi / 2), atol=1e-15)
    assert len(notes) == 1
    assert "length is 0.99999" in notes[0]


@pytest.mark.parametrize(
    "q", ["1, 1, 0, 0", "0, 0, 0, 0", "2, 0, 0, 0", "0.9, 0, 0, 0", "1e200, 1, 1, 1", "1e-200, 0, 0, 0"]
)
def test_a_quaternion_is_of_length_one(q):
    assert "expected 1" in refused(f"Quat({q})").message


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        ("[1, 0.1, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]", "no rotation"),
        ("[2, 0, 0, 0], [0, 2, 0, 0], [0, 0, 2, 0]", "no rotation"),
        ("[0, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0]", "no rotation"),
        ("[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, -1, 0]", "reflection"),
        ("[0, 1, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0]", "reflection"),
        ("[1e200, 0, 0, 0], [0, 1e200, 0, 0], [0, 0, 1e200, 0]", "no rotation"),
        ("[1.01, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]", "off by 0.02, expected at most 0.001"),
        ("[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 2]", "last row 0 0 0 2, expected 0 0 0 1"),
        ("[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [1, 0, 0, 1]", "last row"),
        ("[1, 0, 0], [0, 1, 0], [0, 0, 1]", "3×3, expected 4×4"),
        ("[1, 0, 0, 0]", "1×4, expected 4×4"),
        ("[1, 0, 0, 0], [0, 1, 0], [0, 0, 1, 0]", "expected 4 rows of 4 numbers"),
        ("[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1], [0, 0, 0, 1]", "5×4"),
    ],
)
def test_what_is_no_pose(rows, said):
    assert said in refused(f"Matrix([{rows}])").message


@pytest.mark.parametrize("rows", [[[1, 2], [3]], [["a"] * 4] * 4, None, [], [[]], [[[1.0]]], "x", {}, [[None] * 4] * 4])
def test_a_pose_from_what_is_no_matrix(rows):
    with pytest.raises(ValueError, match="expected"):
        pose_from_matrix(rows, SI)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_a_pose_is_finite(value):
    M = np.eye(4)
    M[0, 3] = value
    with pytest.raises(ValueError, match="not finite"):
        pose_from_matrix(M, SI)


# What cannot be read ---------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "position", "said"),
    [
        ("Tran(1, 2, 3)", 0, "did you mean 'Trans'"), ("Foo()", 0, "expected one of Trans, Rot"),
        ("Trans", 5, "found the end"),
        ("Trans 1, 2, 3", 6, "expected Trans(x, y, z)"), ("Trans()", 6, "found ')'"),
        ("Trans(1, 2)", 10, "after 2 of 3"),
        ("Trans(1, 2, 3, 4)", 13, "expected ')' to end Trans"), ("Trans(1, 2, 3", 13, "found the end"),
        ("Trans(1 2 3)", 8, "after 1 of 3 arguments"), ("Trans(1, 2, 3))", 14, "found ')'"),
        ("Trans(1,2,3),", 12, "found ','"),
        ("Rot(w, 1)", 4, "expected x, y, z or [x, y, z]"), ("Rot(1, 2)", 4, "as the axis"),
        ("Rot(z)", 5, "after the axis"),
        ("Rot(-z, 1)", 4, "found '-' as the axis"), ("Rot([1, 2], 3)", 9, "found ']'"),
        ("Rot([0, 0, 0], 1)", 4, "zero"),
        ("Rot([1, 2, 3, 4], 1)", 12, "expected ']'"), ("Rot(z, )", 7, "found ')'"), ("Rot(z, nan)", 7, "finite"),
        ("RPY(1, 2)", 8, "RPY(roll, pitch, yaw)"), ("Euler(1)", 7, "Euler(phi, theta, psi)"),
        ("Quat(1, 0, 0)", 12, "w, x, y, z"),
        ("DH(1, 2, 3)", 10, "DH(theta, d, a, alpha)"), ("MDH(1, 2, 3)", 11, "MDH(alpha, a, theta, d)"),
        ("Inv(", 4, "the end"),
        ("Inv(1)", 4, "found '1'"), ("Inv(Trans(1, 2, 3)", 18, "found the end"), ("Matrix(1)", 7, "expected '['"),
        ("Matrix([])", 8, "expected '['"), ("Matrix([[]])", 9, "found ']'"),
        ("Matrix([[1, 2], 3])", 16, "expected '['"),
        ("* Trans(1, 2, 3)", 0, "expected a step"), ("Trans(1, 2, 3) *", 16, "after '*', expected a step"),
        ("Trans(1, 2, 3) * * Rot(x, 1)", 17, "expected a step"), ("Trans(1, 2, 3) + Rot(x, 1)", 15, "found '+'"),
        ("1", 0, "found '1'"),
        ("[[1, 0], [0, 1]]", 0, "expected a step"), ("Trans(1e999, 0, 0)", 6, "too large"),
        ("Trans(12345e990, 0, 0)", 6, "too large"), ("Rot(z, -9.51e990)", 8, "too large"),
        (f"Rot(z, 951e{'9' * 5000})", 7, "too large"),
        ("Trans(1/0, 0, 0)", 7, "zero"),
        ("Trans(a, 0, 0)", 6, "unknown name 'a'"), ("Trans[1, 2, 3]", 5, "found '['"), ("°", 0, "found '°'"),
        ("x", 0, "expected one of"),
        ("Trans(1, 2, 3).T", 14, "found '.T'"), ("Rot(z, 1:30)", 8, "found ':'"),
        ("Trans(−1, 0, 0)", 6, "expected '-'"),
    ],
)  # fmt: skip
def test_what_cannot_be_read(text, position, said):
    error = refused(text)
    assert error.position == position
    assert said in error.message


@pytest.mark.parametrize(
    "text",
    ["Trans(1e308, 0, 0) Trans(1e308, 0, 0)", "Trans(1e308, 1e308, 0) Rot(z, 0.7) Trans(1e308, 1e308, 0)",
     "Rot(z, 0.8) Trans(1.7e308, -1.7e308, 0)", "Inv(Rot(z, 0.8) Trans(0, 0, 1) Trans(1.7e308, -1.7e308, 0))"],
)  # fmt: skip
def test_a_product_is_finite_too(text):
    assert "too large" in refused(text).message


@pytest.mark.parametrize("length", ["1e200", "1e-5", "1.7e308", "1"])
def test_the_length_of_an_axis_does_not_matter(length):
    same(f"Rot([{length}, 0, 0], 0.3)", rot(X, 0.3))
    same(f"Rot([{length}, -{length}, 0], 0.3)", rot([1, -1, 0], 0.3))


@pytest.mark.parametrize(
    "text",
    ["Inv(" * 2000, "Inv(" * 60 + ")" * 60, "Trans(" * 1500, "Matrix([" * 1000, "(" * 10_000, "Rot(x," * 1600,
     "x" * 10_000,
     "Trans(1,2,3)" * 1000, "Matrix([" + "[1,2]," * 1600],
)  # fmt: skip
def test_long_and_deep_expressions_end_soon_in_a_sentence(text):
    start = time.process_time()
    assert len(str(refused(text))) < 400
    assert time.process_time() - start < 1.0


def test_many_steps_stay_a_rotation():
    start = time.process_time()
    T = evaluate("Rot([1,2,3],1)" * 700, Units("m", "deg"))
    assert np.allclose(T[:3, :3].T @ T[:3, :3], np.eye(3), atol=1e-12)
    assert np.allclose(T, rot([1, 2, 3], np.radians(700)), atol=1e-12)
    assert time.process_time() - start < 1.0


def test_the_scope_may_be_empty():
    assert np.array_equal(evaluate_transform("Rot(z, 90)", Scope(degrees=True), MM_DEG), np.round(rot(Z, np.pi / 2)))


# Makers' words against each other and against what is printed -----------------------------------------

GIMBAL = [0.0, 90.0, -90.0, 180.0, -180.0, 30.0, 90.0 + 1e-7]


@pytest.mark.parametrize("middle", GIMBAL)
def test_the_makers_angles_where_two_axes_fall_together(middle):
    """At a middle angle of 90° (ABC, WPR) or 0 (OAT) only the sum or the difference of the others counts."""
    a, c = 25.0, -70.0
    x, y, z = (lambda angle, axis=axis: rot(axis, math.radians(angle)) for axis in (X, Y, Z))
    same(f"ABC({a}, {middle}, {c})", z(a) @ y(middle) @ x(c), MM_DEG)
    same(f"WPR({c}, {middle}, {a})", z(a) @ y(middle) @ x(c), MM_DEG)
    same(f"OAT({a}, {middle}, {c})", z(a) @ y(middle) @ z(c), MM_DEG)
    same(f"Euler(zyx, {a}, {middle}, {c})", evaluate(f"ABC({a}, {middle}, {c})", MM_DEG), MM_DEG)
    same(f"Euler(XYZ, {c}, {middle}, {a})", evaluate(f"WPR({c}, {middle}, {a})", MM_DEG), MM_DEG)
    same(f"Euler(zyz, {a}, {middle}, {c})", evaluate(f"Euler({a}, {middle}, {c})", MM_DEG), MM_DEG)
    if middle == 90.0:
        same(f"ABC({a}, 90, {c})", evaluate(f"ABC({a - c}, 90, 0)", MM_DEG), MM_DEG)
    if middle == 0.0:
        same(f"OAT({a}, 0, {c})", evaluate(f"Rot(z, {a + c})", MM_DEG), MM_DEG)


def test_a_rotation_vector_near_none_and_at_half_a_turn():
    for size in (0.0, 1e-300, 1e-12, 1e-8, math.pi, math.pi - 1e-9, 2 * math.pi, 100.0):
        axis = np.array([2.0, -1.0, 2.0]) / 3
        x, y, z = (repr(float(part)) for part in axis * size)
        same(f"RotVec({x}, {y}, {z})", rot(axis, size), atol=1e-13)


def test_what_is_printed_of_an_orientation():
    """The quaternion of Rz(90°), a UR's downward tool (0, π, 0), and the tool of an ABB that looks down, 0 0 1 0."""
    s = math.sqrt(0.5)
    same(f"QuatXYZW(0, 0, {s!r}, {s!r})", rot(Z, math.pi / 2))
    same(f"Quat({s!r}, 0, 0, {s!r})", rot(Z, math.pi / 2))
    same("RotVec(0, pi, 0)", np.diag([-1.0, 1.0, -1.0, 1.0]))
    same("Quat(0, 0, 1, 0)", np.diag([-1.0, 1.0, -1.0, 1.0]))
    same("QuatXYZW(0, 1, 0, 0)", np.diag([-1.0, 1.0, -1.0, 1.0]))


@pytest.mark.parametrize("word", ["rotvec", "ABC", "wpr", "Oat", "QUATXYZW"])
def test_makers_words_in_any_case_and_too_few_numbers(word):
    numbers = "0, 0, 0, 1" if word.lower() == "quatxyzw" else "0, 0, 0"
    same(f"{word}({numbers})", np.eye(4))
    assert "expected" in refused(f"{word}({numbers[3:]})").message
    assert "expected" in refused(f"{word}({numbers}, 0)").message


def test_wrong_words_of_makers_are_answered():
    assert "RotVec" in refused("RotVek(1, 2, 3)").message
    assert "QuatXYZW" in refused("QuatXZYW(0, 0, 0, 1)").message
    assert "expected lower case (about moving axes) or upper case" in refused("Euler(xYz, 1, 2, 3)").message
    assert "found a quaternion of length 2" in refused("QuatXYZW(0, 0, 0, 2)").message
