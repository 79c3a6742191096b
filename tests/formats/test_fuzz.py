"""Whatever a user can type ends in an answer or a sentence: random texts, and two independent evaluators."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
from formats.texts import DEGREES, HEAD, arm, linkage
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from kinematics.reference import rot, trans

from robokin.errors import DescriptionError, ExpressionError, RobokinError
from robokin.formats import read_text
from robokin.formats.library import library_files
from robokin.formats.number_expressions import Scope, evaluate
from robokin.formats.parameters import Parameters
from robokin.formats.transform_expressions import evaluate_transform
from robokin.model import Mechanism, Robot, Tree, WheeledBase
from robokin.units import Units


def repeat(times):
    """The same examples in every run, as many as given."""
    return settings(
        max_examples=times,
        derandomize=True,
        deadline=None,
        database=None,
        suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much],
    )


# Texts -----------------------------------------------------------------------------------------------


def read_or_say(text):
    """Read a text: a value that is whole, or an error with a sentence and a place."""
    try:
        value = read_text(text, "f.yaml")
    except DescriptionError as error:
        assert error.line >= 1
        assert error.column >= 1
        for one in error.errors:
            assert one.line <= len(re.split(r"\r\n|[\n\r\x85\u2028\u2029]", text)) + 1
            assert one.sentence.isprintable()
            assert "expected" in one.message or "did you mean" in one.message, one.message
            assert not one.excerpt or len(one.excerpt.split("\n")) == 2
        return
    assert isinstance(value, Robot | Mechanism | WheeledBase | Tree)
    repr(value)
    if isinstance(value, Robot):
        for row in value.rows:
            assert all(map(math.isfinite, (row.theta, row.d, row.a, row.alpha, row.offset)))
            assert row.limits[0] <= row.limits[1]
        for T in (value.base, value.tool):
            assert np.all(np.isfinite(T))
            assert np.allclose(T[:3, :3] @ T[:3, :3].T, np.eye(3), atol=1e-9)
        assert all(np.all(np.isfinite(pose)) for pose in value.poses.values())
    elif isinstance(value, WheeledBase):
        for wheel in value.wheels:
            assert all(map(math.isfinite, (wheel.x, wheel.y, wheel.angle, wheel.radius, wheel.offset, wheel.roller)))
    elif isinstance(value, Tree):
        assert all(np.all(np.isfinite(pose)) for pose in value.poses.values())
        assert all(np.all(np.isfinite(part)) for joint in value.graph.joints for part in (joint.before, joint.after))
    else:
        for joint in value.joints:
            assert joint.axes is None or np.allclose(np.linalg.norm(joint.axes, axis=1), 1.0)


@pytest.mark.slow
@repeat(200)
@given(st.text(max_size=200))
def test_any_text(text):
    read_or_say(text)


@repeat(200)
@given(st.text(st.sampled_from(" \n\t:-[]{},&*#?|>!%@`'\"ab12~<="), max_size=80))
def test_text_of_yaml_signs(text):
    read_or_say(text)
    read_or_say(HEAD + "joints: " + text)


WORDS = st.sampled_from(
    ["robokin", "name", "units", "joints", "parameters", "poses", "base", "tool", "convention", "links", "space",
     "ground",
     "type", "theta", "d", "a", "alpha", "offset", "limits", "origin", "axis", "axes", "at", "pitch", "freedoms",
     "normal",
     "actuated", "kind", "wheels", "wheeled", "steering", "output", "expected", "castor", "swedish", "steered",
     "length", "angle", "mm", "deg", "R", "P", "F", "RRP", "revolute", "prismatic", "fixed", "helical",
     "planar",
     "frames", "modified", "true", "x", "1", "0", "-90", "1e-3", "pi/2", "1/0", "9**9**9", ".inf", "nan", "~", "''",
     "é", "<<",
     "Trans(1,2,3)", "'Trans(1, 2, 3) Rot(z, 90)'", "Inv(", "&a 1", "*a", "!!int 1", "012", "1:30", "l1", "\"\\e\"",
     "- - -"]
)  # fmt: skip
FLOW = st.recursive(
    WORDS,
    lambda inner: st.one_of(
        st.lists(inner, max_size=4).map(lambda parts: "[" + ", ".join(parts) + "]"),
        st.lists(st.tuples(WORDS, inner), max_size=5).map(
            lambda pairs: "{" + ", ".join(f"{key}: {value}" for key, value in pairs) + "}"
        ),
    ),
    max_leaves=12,
)


@pytest.mark.slow
@repeat(250)
@given(st.lists(st.tuples(WORDS, FLOW), max_size=6))
def test_text_like_a_description(pairs):
    body = "".join(f"{key}: {value}\n" for key, value in pairs)
    read_or_say(body)
    read_or_say("robokin: 1\nname: x\n" + body)


@pytest.mark.slow
@repeat(250)
@given(st.lists(st.tuples(WORDS, FLOW), max_size=4), st.sampled_from(["R", "P", "F", "revolute"]))
def test_rows_of_anything(pairs, kind):
    cells = ", ".join([f"type: {kind}", *(f"{key}: {value}" for key, value in pairs)])
    for convention in ("standard", "frames"):
        read_or_say(arm(cells, head=DEGREES + f"convention: {convention}\nparameters: {{l1: 1}}\n"))
    read_or_say(f"{DEGREES}joints: {{{cells}}}\n")


@pytest.mark.slow
@repeat(150)
@given(
    st.lists(st.tuples(WORDS, FLOW), max_size=4),
    st.sampled_from(["revolute", "helical", "universal", "custom", "planar"]),
)
def test_joints_of_anything(pairs, kind):
    cells = ", ".join([f"type: {kind}, links: [ground, crank]", *(f"{key}: {value}" for key, value in pairs)])
    read_or_say(linkage(cells))
    read_or_say(linkage(cells, space="spatial"))


LIBRARY = [path.read_text(encoding="utf-8") for path in library_files()]


@pytest.mark.slow
@repeat(300)
@given(
    st.sampled_from(LIBRARY), st.integers(0, 10_000), st.integers(0, 12), st.one_of(st.text(max_size=6), WORDS, FLOW)
)  # fmt: skip
def test_the_library_with_a_piece_replaced(text, start, length, piece):
    start %= len(text)
    read_or_say(text[:start] + piece + text[start + length :])


# Numbers ---------------------------------------------------------------------------------------------

# An expression and what Python makes of it, both written at once: `ours` is the format's text, `python`
# the same for eval, where `f` holds the functions.
NAMES = {"l1": 2.5, "shift": -0.75, "x_2": 30.0}
PYTHON = {
    "sqrt": math.sqrt, "asin": math.asin, "acos": math.acos, "atan": math.atan, "atan2": math.atan2, "abs": abs,
    "deg": math.degrees, "rad": math.radians, "sin": math.sin, "cos": math.cos, "tan": math.tan,
}  # fmt: skip

literals = st.one_of(
    st.integers(0, 200).map(lambda i: (str(i), f"{float(i)!r}")),
    st.integers(0, 99).map(lambda i: (f"0{i}", f"{float(i)!r}")),  # 012 is twelve
    st.floats(0, 1e6).map(lambda x: (repr(x), repr(x))),
    st.integers(0, 999).map(lambda i: (f".{i:03}", f"0.{i:03}")),
    st.integers(-5, 5).map(lambda i: (f"2e{i}", f"2e{i}")),
)
atoms = st.one_of(literals, st.sampled_from(list(NAMES)).map(lambda n: (n, n)), st.just(("pi", "pi")))


def compound(inner):
    def binary(left, operator, right, space):
        return f"{left[0]}{space}{operator}{space}{right[0]}", f"{left[1]} {operator} {right[1]}"

    def call(name, argument):
        return f"{name}({argument[0]})", f"{name}({argument[1]})"

    def many(name, arguments):
        ours, python = zip(*arguments, strict=True)
        return f"{name}({', '.join(ours)})", f"{name}([{', '.join(python)}])"

    return st.one_of(
        st.builds(binary, inner, st.sampled_from(["+", "-", "*", "/", "**"]), inner, st.sampled_from(["", " ", "\n "])),
        inner.map(lambda one: (f"({one[0]})", f"({one[1]})")),
        inner.map(lambda one: (f"-{one[0]}", f"-{one[1]}")),
        inner.map(lambda one: (f"- +{one[0]}", f"- +{one[1]}")),
        st.builds(call, st.sampled_from([name for name in PYTHON if name != "atan2"]), inner),
        st.builds(lambda y, x: (f"atan2({y[0]},{x[0]})", f"atan2({y[1]}, {x[1]})"), inner, inner),
        st.builds(many, st.sampled_from(["min", "max"]), st.lists(inner, min_size=1, max_size=3)),
    )


EXPRESSIONS = st.recursive(atoms, compound, max_leaves=10)


class RefusedError(Exception):
    """What the format refuses although Python has a value for it."""


def python_value(text, functions):
    """The value by Python's own grammar; None where there is none that is real and finite."""
    names = {"min": min, "max": max, "pi": math.pi, **functions, **NAMES}
    try:
        # Powers of floats by `**` are complex for a negative base, which the format refuses too.
        value = eval(text, {"__builtins__": {}}, names)
        return float(value) if not isinstance(value, complex) and math.isfinite(value) else None
    except (ValueError, ZeroDivisionError, OverflowError, TypeError):
        return None


def our_value(text, scope):
    try:
        return evaluate(text, scope).number
    except ExpressionError:
        return None


def agree(ours, theirs):
    return theirs == ours or (ours is not None and math.isclose(ours, theirs, rel_tol=1e-9, abs_tol=1e-12))


@repeat(700)
@given(EXPRESSIONS)
@example(("-2**2", "-2.0**2.0"))
@example(("2**-2**2", "2.0**-2.0**2.0"))
@example(("8/4/2", "8.0/4.0/2.0"))
def test_numbers_agree_with_python(pair):
    ours, python = pair
    scope = Parameters({name: repr(value) for name, value in NAMES.items()}, degrees=False).scope()
    theirs = python_value(python, PYTHON)
    value = our_value(ours, scope)
    if theirs is None:
        assert value is None
    elif value is None:
        # Only what overflows on its way may have a value in Python and none here.
        assert overflows(python)
    else:
        assert agree(value, theirs), (ours, value, theirs)


def overflows(python):
    """Whether a step of the evaluation is infinite although the end is not: each step is checked here."""

    class Checked(float):
        def _of(self, value):
            if isinstance(value, complex) or not math.isfinite(value):
                raise RefusedError
            return Checked(value)

        def __add__(self, other):
            return self._of(float(self) + float(other))

        def __sub__(self, other):
            return self._of(float(self) - float(other))

        def __mul__(self, other):
            return self._of(float(self) * float(other))

        def __truediv__(self, other):
            return self._of(float(self) / float(other))

        def __pow__(self, other):
            return self._of(float(self) ** float(other))

        def __neg__(self):
            return Checked(-float(self))

        def __pos__(self):
            return self

        def __abs__(self):
            return Checked(abs(float(self)))

    def checked(function):
        return lambda *values: Checked(0)._of(function(*values))

    literal = re.compile(r"(?<![\w.])(\d+\.?\d*(?:e[+-]?\d+)?)")
    functions = {name: checked(function) for name, function in PYTHON.items()}
    names = {"min": min, "max": max, "pi": Checked(math.pi), "C": Checked, **functions}
    names.update({name: Checked(value) for name, value in NAMES.items()})
    try:
        eval(literal.sub(r"C(\1)", python), {"__builtins__": {}}, names)
    except (RefusedError, OverflowError):
        return True
    return False


DEGREE_FUNCTIONS = PYTHON | {
    "sin": lambda x: math.sin(math.radians(x)),
    "cos": lambda x: math.cos(math.radians(x)),
    "tan": lambda x: math.tan(math.radians(x)),
    "asin": lambda x: math.degrees(math.asin(x)),
    "acos": lambda x: math.degrees(math.acos(x)),
    "atan": lambda x: math.degrees(math.atan(x)),
    "atan2": lambda y, x: math.degrees(math.atan2(y, x)),
}


@repeat(250)
@given(st.sampled_from(["sin", "cos", "tan"]), st.floats(-1e5, 1e5))
def test_trigonometry_in_degrees_agrees_with_radians(name, angle):
    theirs = DEGREE_FUNCTIONS[name](angle)
    ours = our_value(f"{name}({angle!r})", Scope(degrees=True))
    if ours is None or abs(theirs) > 1e6:  # at a right angle, where only the rounded one has a tangent
        assert name == "tan"
        assert abs(theirs) > 1e6
    else:
        assert ours == pytest.approx(theirs, rel=1e-9, abs=1e-10 * (1 + theirs**2))


@repeat(250)
@given(st.sampled_from(["asin", "acos", "atan"]), st.floats(-1.5, 1.5))
def test_inverse_trigonometry_in_degrees(name, x):
    ours = our_value(f"{name}({x!r})", Scope(degrees=True))
    theirs = python_value(f"{name}({x!r})", DEGREE_FUNCTIONS)
    assert agree(ours, theirs) if theirs is not None else ours is None


PIECES = st.sampled_from(
    ["1", "0", "2.5", "1e3", "1e-3", ".5", "1e999", "pi", "l1", "zz", "sin", "sqrt", "atan2", "min", "deg", "rad",
     "inf", "nan",
     "(", ")", "(", ")", "+", "-", "*", "/", "**", ",", "[", "]", " ", "\t", "\n", "'", "°", "−", "π", "^", "é", "\0",
     "\ud800",
     "Trans", "Rot", "x", "y'", "Inv", "Matrix", "Quat", "RPY", "DH", "Trans(1,2,3)", "Rot(z,90)", "Quat(1,0,0,0)",
     "[[", "]]"]
)  # fmt: skip
STRINGS = st.one_of(st.text(max_size=60), st.lists(PIECES, max_size=25).map("".join))
SCOPE = Parameters({"l1": "2", "half": "pi/2"}, degrees=True).scope()


@repeat(700)
@given(STRINGS, st.booleans())
def test_any_string_is_a_number_or_a_sentence(text, angle):
    try:
        value = evaluate(text, SCOPE, angle=angle)
    except ExpressionError as error:
        assert 0 <= error.position <= len(text)
        assert "expected" in str(error) or "did you mean" in str(error)
        assert str(error).isprintable()
    else:
        assert isinstance(value.number, float)
        assert math.isfinite(value.number)
        assert not (angle and value.mentions_pi)


# Transforms ------------------------------------------------------------------------------------------

NUMBERS = st.floats(-10, 10).map(lambda x: round(x, 6))
AXES = st.tuples(NUMBERS, NUMBERS, NUMBERS).filter(lambda v: max(map(abs, v)) > 1e-3)
X, Y, Z = np.eye(3)
LETTERS = {"x": X, "y": Y, "z": Z}


def listed(values):
    return ", ".join(repr(value) for value in values)


def quaternion(axis, angle):
    u = np.array(axis) / np.linalg.norm(axis)
    q = [math.cos(angle / 2), *(math.sin(angle / 2) * u).tolist()]
    return f"Quat({listed(q)})", rot(u, angle)


def matrix(axis, angle, p):
    T = trans(*p) @ rot(axis, angle)
    return "Matrix([" + ", ".join(f"[{listed(row)}]" for row in T.tolist()) + "])", T


TRIPLES = st.tuples(NUMBERS, NUMBERS, NUMBERS)
STEP = st.one_of(
    TRIPLES.map(lambda p: (f"Trans({listed(p)})", trans(*p))),
    st.tuples(st.sampled_from("xyz"), st.sampled_from(["", "'", "''"]), NUMBERS).map(
        lambda t: (f"Rot({t[0]}{t[1]}, {t[2]!r})", rot(LETTERS[t[0]], t[2]))
    ),
    st.tuples(AXES, NUMBERS).map(lambda t: (f"rot([{listed(t[0])}], {t[1]!r})", rot(t[0], t[1]))),
    TRIPLES.map(lambda a: (f"RPY({listed(a)})", rot(Z, a[2]) @ rot(Y, a[1]) @ rot(X, a[0]))),
    TRIPLES.map(lambda a: (f"euler({listed(a)})", rot(Z, a[0]) @ rot(Y, a[1]) @ rot(Z, a[2]))),
    st.tuples(NUMBERS, NUMBERS, NUMBERS, NUMBERS).map(
        lambda c: (f"DH({listed(c)})", rot(Z, c[0]) @ trans(0, 0, c[1]) @ trans(c[2], 0, 0) @ rot(X, c[3]))
    ),
    st.tuples(NUMBERS, NUMBERS, NUMBERS, NUMBERS).map(
        lambda c: (f"MDH({listed(c)})", rot(X, c[0]) @ trans(c[1], 0, 0) @ rot(Z, c[2]) @ trans(0, 0, c[3]))
    ),
    st.builds(quaternion, AXES, NUMBERS),
    st.builds(matrix, AXES, NUMBERS, TRIPLES),
)


def product(steps, separator):
    T = np.eye(4)
    for _, M in steps:
        T = T @ M
    return separator.join(text for text, _ in steps), T


PRODUCTS = st.recursive(
    STEP,
    lambda inner: st.one_of(
        st.builds(product, st.lists(inner, max_size=4), st.sampled_from([" ", "*", " * ", "", "\n"])),
        inner.map(lambda one: (f"Inv({one[0]})", np.linalg.inv(one[1]))),
        inner.map(lambda one: (f"INV({one[0]} {one[0]})", np.linalg.inv(one[1] @ one[1]))),
    ),
    max_leaves=6,
)


@repeat(250)
@given(PRODUCTS)
def test_products_agree_with_numpy(pair):
    text, expected = pair
    if re.search(r"\*\s*(\*|\)|$)|(\(|^)\s*\*", text):  # an empty product beside a '*'
        return
    T = evaluate_transform(text, Scope(), Units())
    assert np.allclose(T, expected, rtol=1e-9, atol=1e-9 * max(1.0, np.abs(expected).max()))


@repeat(200)
@given(PRODUCTS, st.sampled_from(["mm", "cm", "in"]))
def test_units_scale_the_position_alone(pair, length):
    text, expected = pair
    if re.search(r"\*\s*(\*|\)|$)|(\(|^)\s*\*", text):
        return
    units = Units(length)
    T = evaluate_transform(text, Scope(), units)
    assert np.allclose(T[:3, :3], expected[:3, :3], atol=1e-9)
    assert np.allclose(T[:3, 3], expected[:3, 3] * units.metres, atol=1e-9 * max(1.0, np.abs(expected).max()))


@repeat(700)
@given(STRINGS)
def test_any_string_is_a_transform_or_a_sentence(text):
    try:
        T = evaluate_transform(text, SCOPE, Units("mm", "deg"))
    except ExpressionError as error:
        assert 0 <= error.position <= len(text)
        assert str(error).isprintable()
    else:
        assert T.shape == (4, 4)
        assert np.all(np.isfinite(T))
        assert np.allclose(T[:3, :3] @ T[:3, :3].T, np.eye(3), atol=1e-9)


# Both parsers of YAML --------------------------------------------------------------------------------


@repeat(150)
@given(st.lists(st.tuples(WORDS, FLOW), max_size=5))
def test_without_libyaml_the_same_is_read(pairs):
    import yaml

    text = "robokin: 1\nname: x\n" + "".join(f"{key}: {value}\n" for key, value in pairs)

    def outcome():
        try:
            return repr(read_text(text))
        except RobokinError as error:
            return None if "not YAML" in str(error) else str(error)

    first = outcome()
    with pytest.MonkeyPatch.context() as patch:
        patch.delattr(yaml, "CSafeLoader", raising=False)
        second = outcome()
    assert first is None or second is None or first == second
