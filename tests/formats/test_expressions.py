"""Number expressions: their value, their grammar, and what has none."""

from __future__ import annotations

import math
import time

import pytest

from robokin.errors import ExpressionError
from robokin.formats.expression_tokens import MAX_LENGTH
from robokin.formats.number_expressions import FUNCTIONS, Scope, Value, evaluate
from robokin.formats.parameters import Parameters

RADIANS = Scope()
DEGREES = Scope(degrees=True)
ANGLES = [0.0, 1e-300, 1e-9, 0.3, 15.0, 30.0, 45.0, 59.99, 60.0, 90.0, 120.0, 135.0, 150.0, 179.0, 180.0, 210.0, 225.0,
          270.0, 299.9, 330.0, 359.0, 360.0, 390.0, 720.0, 1e6 + 30.0]  # fmt: skip


def radians(text):
    return evaluate(text, RADIANS).number


def degrees(text):
    return evaluate(text, DEGREES).number


def refused(text, scope=RADIANS, **given):
    with pytest.raises(ExpressionError) as caught:
        evaluate(text, scope, **given)
    error = caught.value
    assert "expected" in error.message or "did you mean" in error.message
    assert 0 <= error.position <= len(error.text)
    assert "\n" not in str(error)
    assert len(str(error)) < 400
    return error


# Numbers and operators -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1", 1.0), ("012", 12.0), ("1e-3", 1e-3), ("1E+3", 1e3), (".5", 0.5), ("5.", 5.0), ("1.e2", 100.0),
        ("  7 ", 7.0), ("\t7\n", 7.0), ("\u00a07", 7.0), ("0", 0.0), ("1e-400", 0.0), ("00.50", 0.5),
        ("9007199254740993", 9007199254740992.0), ("0.1+0.2", 0.1 + 0.2),
        ("1+2*3", 7.0), ("(1+2)*3", 9.0), ("7-2-1", 4.0), ("8/4/2", 1.0), ("8/4*2", 4.0), ("1-2+3", 2.0),
        ("-1", -1.0), ("+1", 1.0), ("--1", 1.0), ("-+-1", 1.0), ("3 - -2", 5.0), ("3*-2", -6.0), ("6/-2", -3.0),
        ("2**3", 8.0), ("2**3**2", 512.0), ("(2**3)**2", 64.0), ("-2**2", -4.0), ("(-2)**2", 4.0), ("2**-1", 0.5),
        ("2**-2**2", 2**-4), ("-2**-2", -0.25), ("2*3**2", 18.0), ("2**0.5", math.sqrt(2.0)), ("0**0", 1.0),
        ("pi", math.pi), ("-pi/2", -math.pi / 2), ("2*pi", 2 * math.pi), ("sqrt(2)/2", math.sqrt(2) / 2),
        ("sqrt((3))", math.sqrt(3)), ("abs(-3)", 3.0), ("abs(3)", 3.0), ("min(3)", 3.0), ("min(3, 1, 2)", 1.0),
        ("max(3, 1, 2)", 3.0), ("max(min(1, 2), 0)", 1.0), ("sin ( 0 )", 0.0), ("atan2(1, -1)", math.atan2(1, -1)),
        ("deg(pi)", 180.0), ("rad(180)", math.pi), ("rad(deg(1.25))", 1.25), ("8**(1/3)", 2.0),
    ],
)  # fmt: skip
def test_value(text, value):
    assert radians(text) == pytest.approx(value, rel=1e-15, abs=0)


def test_min_and_max_take_any_number_of_values():
    numbers = ", ".join(str(i) for i in range(500))
    assert radians(f"min({numbers})") == 0.0
    assert radians(f"max({numbers})") == 499.0


@pytest.mark.parametrize("name", FUNCTIONS)
def test_every_function_of_the_format_is_there(name):
    arguments = "0.25, 0.5" if name == "atan2" else "0.25"
    ours = {"deg": math.degrees, "rad": math.radians, "abs": abs, "min": min, "max": max}
    function = ours.get(name) or getattr(math, name)
    expected = function(0.25, 0.5) if name in ("atan2", "min", "max") else function(0.25)
    if name in ("min", "max"):
        arguments = "0.25, 0.5"
    assert radians(f"{name}({arguments})") == expected


def test_the_functions_are_those_of_the_format():
    named = "sqrt sin cos tan asin acos atan atan2 abs min max"  # and, said apart, deg and rad
    assert {*FUNCTIONS} == {*named.split(" "), "deg", "rad"}


# Trigonometry in degrees -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("sin(0)", 0.0), ("sin(30)", 0.5), ("sin(90)", 1.0), ("sin(150)", 0.5), ("sin(180)", 0.0), ("sin(210)", -0.5),
        ("sin(270)", -1.0), ("sin(330)", -0.5), ("sin(360)", 0.0), ("sin(-30)", -0.5), ("sin(-90)", -1.0),
        ("sin(-180)", 0.0), ("sin(3630)", 0.5), ("cos(0)", 1.0), ("cos(60)", 0.5), ("cos(90)", 0.0), ("cos(120)", -0.5),
        ("cos(180)", -1.0), ("cos(240)", -0.5), ("cos(270)", 0.0), ("cos(300)", 0.5), ("cos(-60)", 0.5),
        ("cos(-90)", 0.0),
        ("tan(0)", 0.0), ("tan(45)", 1.0), ("tan(135)", -1.0), ("tan(225)", 1.0), ("tan(315)", -1.0),
        ("tan(-45)", -1.0),
        ("tan(-135)", 1.0), ("tan(180)", 0.0), ("asin(1)", 90.0), ("acos(-1)", 180.0), ("atan(1)", 45.0),
        ("atan2(1, -1)", 135.0), ("atan2(-1, -1)", -135.0), ("atan2(0, -1)", 180.0),
    ],
)  # fmt: skip
def test_degrees_are_exact_where_the_value_is(text, value):
    assert degrees(text) == value
    assert math.copysign(1.0, degrees(text)) == 1.0 or value < 0, "no negative zeros"


@pytest.mark.parametrize("angle", ANGLES)
def test_laws_of_sine_and_cosine_in_degrees(angle):
    sine, cosine = degrees(f"sin({angle!r})"), degrees(f"cos({angle!r})")
    assert sine == pytest.approx(math.sin(math.radians(angle)), abs=3e-16 * max(1.0, angle / 90))
    assert cosine == pytest.approx(math.cos(math.radians(angle)), abs=3e-16 * max(1.0, angle / 90))
    assert sine**2 + cosine**2 == pytest.approx(1.0, abs=1e-15)
    assert degrees(f"sin(-{angle!r})") == -sine
    assert degrees(f"cos(-{angle!r})") == cosine
    assert degrees(f"sin({angle!r}+360)") == pytest.approx(sine, abs=1e-15)


@pytest.mark.parametrize("angle", [1e-17, 1e-12, 1e-6, 1e-3])
def test_small_angles_keep_their_digits_on_both_sides_of_zero(angle):
    for sign in (1, -1):
        assert degrees(f"sin({sign * angle!r})") == pytest.approx(math.radians(sign * angle), rel=1e-6)


@pytest.mark.parametrize("angle", [-80.0, -12.5, 0.0, 33.0, 60.0, 89.0])
def test_inverse_functions_undo_the_functions(angle):
    assert degrees(f"asin(sin({angle}))") == pytest.approx(angle, abs=1e-12)
    assert degrees(f"atan(tan({angle}))") == pytest.approx(angle, abs=1e-12)
    assert degrees(f"acos(cos({angle}))") == pytest.approx(abs(angle), abs=1e-12)
    assert degrees(f"atan2(sin({angle}), cos({angle}))") == pytest.approx(angle, abs=1e-12)


@pytest.mark.parametrize("name", ["sin", "cos", "tan"])
def test_radians_and_degrees_agree_by_the_conversions(name):
    assert degrees(f"{name}(deg(0.7))") == pytest.approx(radians(f"{name}(0.7)"), rel=1e-14)
    assert radians(f"{name}(rad(40))") == pytest.approx(degrees(f"{name}(40)"), rel=1e-14)


# pi in degrees ---------------------------------------------------------------------------------------

HALF_PI = Parameters({"h": "pi/2", "k": "h + 1", "ok": "deg(h)"}, degrees=True).scope()


@pytest.mark.parametrize(
    "text", ["pi", "pi/2", "-pi/2", "90 + 0*pi", "sqrt(pi)", "2**pi", "min(1, pi)", "atan2(pi, 1)", "h", "-h", "k/2"]
)
def test_an_angle_in_degrees_mentions_no_pi(text):
    error = refused(text, HALF_PI, angle=True)
    assert f"write deg({text})" in error.message
    assert evaluate(text, HALF_PI).number is not None, "a length may mention it"


@pytest.mark.parametrize("text", ["sin(pi/6)", "1 + cos( pi )", "tan(h)", "sin(k)", "sin(abs(-pi))"])
def test_an_argument_in_degrees_mentions_no_pi(text):
    error = refused(text, HALF_PI)
    inner = text[text.index("(") + 1 : text.rindex(")")].strip()
    assert f"write deg({inner})" in error.message


@pytest.mark.parametrize("text", ["deg(pi/2)", "deg(h)", "ok", "sin(deg(pi/6))", "90", "deg(pi)/2", "rad(90)"])
def test_degrees_made_of_pi_are_angles(text):
    assert math.isfinite(evaluate(text, HALF_PI, angle=True).number)


def test_radians_may_mention_pi():
    assert evaluate("pi/2", RADIANS, angle=True) == Value(math.pi / 2, mentions_pi=True)
    assert radians("sin(pi/2)") == 1.0


# Parameters ------------------------------------------------------------------------------------------


def test_parameters_stand_in_any_order():
    parameters = Parameters({"c": "a + b", "a": "b*2", "b": "3"}, degrees=False)
    assert parameters.value("c").number == 9.0
    assert evaluate("c/a", parameters.scope()).number == 1.5


def test_a_long_chain_of_parameters_is_no_deep_one():
    nested = "(" * 40
    texts = {f"p{i}": f"{nested}p{i + 1}{')' * 40} + 1" for i in range(1000)} | {"p1000": "0"}
    assert Parameters(texts, degrees=False).value("p0").number == 1000.0


@pytest.mark.parametrize(
    ("texts", "circle"),
    [
        ({"a": "a"}, "a -> a"),
        ({"a": "b", "b": "a + 1"}, "a -> b -> a"),
        ({"a": "b", "b": "c", "c": "sin(b)"}, "b -> c -> b"),
    ],
)
def test_parameters_in_a_circle(texts, circle):
    with pytest.raises(ExpressionError) as caught:
        Parameters(texts, degrees=False).value("a")
    assert f"circle ({circle})" in str(caught.value)


def test_a_great_circle_is_told_in_short():
    texts = {f"p{i}": f"p{(i + 1) % 2000}" for i in range(2000)}
    with pytest.raises(ExpressionError) as caught:
        Parameters(texts, degrees=False).value("p0")
    assert "p0 -> p1 -> " in str(caught.value)
    assert len(str(caught.value)) < 200


def test_an_error_belongs_to_the_parameter_where_it_stands():
    with pytest.raises(ExpressionError) as caught:
        Parameters({"a": "b", "b": "1 +", "c": "1"}, degrees=False).value("a")
    assert caught.value.parameter == "b"


def test_a_parameter_is_evaluated_once():
    texts = {f"p{i}": f"p{i + 1} + p{i + 1}" for i in range(60)} | {"p60": "1"}
    assert Parameters(texts, degrees=False).value("p0").number == 2.0**60


# What has no value -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "position", "said"),
    [
        ("", 0, "found nothing"), ("  ", 0, "found nothing"), ("1 +", 3, "found the end"), ("(1", 2, "expected ')'"),
        ("1)", 1, "expected the end"), ("1 2", 2, "found '2'"), ("2(3)", 1, "found '('"), ("* 2", 0, "found '*'"),
        ("1//2", 2, "found '/'"), ("1 % 2", 2, "found '%'"), ("1,5", 1, "found ','"), ("1:30", 1, "found ':'"),
        ("1e", 0, "found '1e'"), ("1.2.3", 0, "found '1.2.3'"), ("0x1F", 0, "found '0x1F'"), ("1_000", 0, "'1_000'"),
        ("1e1e1", 0, "found '1e1e1'"), ("10mm", 0, "found '10mm'"), (".", 0, "found '.'"), ("١", 0, "such as 12"),
        ("5 pi", 2, "found 'pi'"), ("90 deg", 3, "found 'deg'"), ("sin", 0, "expected sin(…)"), ("sin 30", 0, "sin(…)"),
        ("sin()", 4, "found ')'"), ("sin(1", 5, "expected ')'"),
        ("sin(1, 2)", 0, "found sin() with 2 arguments, expected 1"),
        ("atan2(1)", 0, "expected 2"), ("atan2(1, 2, 3)", 0, "found atan2() with 3 arguments, expected 2"),
        ("min()", 4, "found ')'"), ("max(1,)", 6, "found ')'"), ("no", 0, "unknown name 'no'"),
        ("sine(1)", 0, "did you mean 'sin'"), ("Sin(1)", 0, "did you mean 'sin'"), ("exec(1)", 0, "unknown function"),
        ("__import__(1)", 0, "unknown function"), ("pi(2)", 0, "unknown function 'pi'"), ("Pi", 0, "did you mean 'pi'"),
        ("pi.real", 2, "found '.real'"), ("'1'", 0, "expected a number or an expression"), ("[1]", 0, "found '['"),
        ("1 if 2 else 3", 2, "found 'if'"), ("a = 1", 2, "found '='"), ("lambda: 1", 6, "expected"),
        ("1;2", 1, "expected ','"),
        ("−1", 0, "found '−', expected '-'"), ("2×3", 1, "expected '*'"), ("2·3", 1, "expected '*'"),
        ("6÷2", 1, "expected '/'"),
        ("2^3", 1, "expected '**'"), ("π", 0, "expected 'pi'"), ("90°", 2, "stated once"), ("1–2", 1, "expected '-'"),
        ("nan", 0, "expected a finite number"), ("inf", 0, "finite"), ("-Infinity", 1, "finite"),
        ("1\u200b", 1, "u200b"),
        ("y'", 0, "unknown name"), ("½", 0, "expected"), ("\ud800", 0, "ud800"), ("\x1b[31m", 0, "x1b"),
    ],
)  # fmt: skip
def test_what_cannot_be_read(text, position, said):
    error = refused(text)
    assert error.position == position
    assert said in error.message


@pytest.mark.parametrize(
    "text",
    [
        "1/0", "1/(2-2)", "0/0", "0**-1", "sqrt(-1)", "asin(2)", "acos(-1.01)", "(0-8)**(1/3)", "(-1)**0.5", "1e999",
        "-1e999",
        "1e308*10", "1e308+1e308", "1e308/1e-10", "9**9**9", "9**9**9**9", "2**1024", "10**400", "deg(1e308)",
        "1e200**2",
        "sqrt(1e999)", "min(1, 1e999)", "1e999-1e999",
    ],
)  # fmt: skip
def test_what_has_no_finite_value(text):
    refused(text)
    refused(text, DEGREES)


@pytest.mark.parametrize("angle", [90, -90, 270, 450])
def test_the_tangent_of_a_right_angle(angle):
    assert "tan() has no value at" in refused(f"tan({angle})", DEGREES).message


def test_nearest_names():
    scope = Parameters({"l1": "1", "shoulder": "2"}, degrees=False).scope()
    assert "did you mean 'shoulder'" in refused("sholder", scope).message
    assert "did you mean 'l1'" in refused("2*l2", scope).message
    assert "expected one of pi, l1, shoulder" in refused("zzz", scope).message


# What costs much -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "text",
    [
        "(" * 10_000, "(" * 5000 + "1" + ")" * 5000, "(" * 51 + "1" + ")" * 51, "sin(" * 2000, "-" * 9999,
        "2**" * 3000 + "2",
        "1" * 9999 + "x", "1" * 9999 + ".", "x" * 10_000, "1e" * 5000, " " * 10_000, "1+" * 6000 + "1", "9" * 11_000,
        "." * 9999,
        "min(" + "1," * 4990, "_" * 9000 + "(1)",
    ],
)  # fmt: skip
def test_long_and_deep_expressions_end_soon_in_a_sentence(text):
    start = time.process_time()
    refused(text)
    assert time.process_time() - start < 1.0


def test_what_is_long_and_right_is_read():
    start = time.process_time()
    assert radians("1+" * 4999 + "1") == 5000.0
    assert radians("-" * 9998 + "1") == 1.0
    assert radians("1" * 300) == float("1" * 300)
    assert radians("(" * 49 + "1" + ")" * 49) == 1.0
    assert radians("1" + " " * (MAX_LENGTH - 1)) == 1.0
    assert time.process_time() - start < 1.0
