"""Whatever a user can type ends in an answer or a sentence: what was found, what was expected, and status 2."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sweeps import sweep

from .conftest import invoke, refused

FK = ["fk", "puma560"]
HOME = [*FK, "--q", "home"]

USAGE = {
    "an unknown command": (["fkk"], ["no command 'fkk'", "did you mean 'fk'"]),
    "a command like none": (["zzzz"], ["no command 'zzzz'", "expected one of", "fk", "frame"]),
    "no robot": (["fk"], ["ROBOT is missing", "robokin fk --help"]),
    "no expression": (["frame"], ["EXPR is missing"]),
    "no file": (["validate"], ["FILE... is missing"]),
    "an unknown robot": (["fk", "puma56", "--q", "home"], ["'puma56'", "did you mean puma560"]),
    "a robot like none": (["show", "qqqqqq"], ["'qqqqqq'", "robokin list"]),
    "a file that is not there": (["show", "./none.yaml"], ["none.yaml", "no such file"]),
    "a wheeled base": (["fk", "car", "--q", "1"], ["car is a wheeled base", "expected a robot"]),
    "a mechanism": (["fk", "four-bar", "--q", "1"], ["four-bar is a mechanism", "expected a robot"]),
    "an unknown option": ([*HOME, "--fromat", "json"], ["'--fromat'", "'--format'", "--help"]),
    "an option of another command": ([*FK, "--quat", "1,0,0,0"], ["no option '--quat'; did you mean '--as'"]),
    "one dash": ([*FK, "-q", "home"], ["no option '-q'", "did you mean '--q'"]),
    "an option of no command": (["--jsn"], ["no option '--jsn'"]),
    "nothing after an option": ([*FK, "--q"], ["--q has nothing after it", "expected"]),
    "a flag with a value": ([*HOME, "--json=1"], ["--json has a value", "expected"]),
    "an unknown format": (
        [*HOME, "-f", "jsn"],
        ["--format", "'jsn'", "table, json, jsonl, csv, parquet or arrow", "'json'"],
    ),
    "npy on standard output": ([*HOME, "-f", "npy"], ["--format", "'npy'", "expected"]),
    "two formats": ([*HOME, "--json", "-f", "csv"], ["exclude each other", "expected one of them"]),
    "an unknown angle unit": ([*HOME, "--angle", "degree"], ["--angle", "'degree'", "rad or deg", "mean 'deg'"]),
    "an unknown length unit": ([*HOME, "--length", "km"], ["--length", "'km'", "m, cm, mm or in"]),
    "an unknown orientation": ([*HOME, "--as", "quaternoin"], ["--as", "'quaternoin'", "did you mean 'quaternion'"]),
    "a parameter without a value": ([*HOME, "--set", "a1"], ["--set", "'a1'", "expected NAME=VALUE"]),
    "a parameter that is not there": (["fk", "planar2r", "--q", "0,0", "--set", "a9=1"], ["'a9'", "did you mean 'a"]),
    "a parameter that is no number": (["fk", "planar2r", "--q", "0,0", "--set", "a1=x"], ["a1=x", "unknown name 'x'"]),
}

VALUES = {
    "no values": (FK, ["--q is missing", "expected 6 values", "RRRRRR", "--q 0,0,0,0,0,0", "--q -"]),
    "too few values": ([*FK, "--q", "1,2,3"], ["found 3 values", "expected 6", "PUMA 560"]),
    "too many values": ([*FK, "--q", "1,2,3,4,5,6,7"], ["found 7 values", "expected 6"]),
    "a vector of words": ([*FK, "--q", "90", "0", "90", "0", "0", "0"], ["'0 90 0 0 0'", "in quotes"]),
    "nothing": ([*FK, "--q", ""], ["found 0 values", "expected 6"]),
    "commas": ([*FK, "--q", ",,,,,"], ["value 1 of 6", "found nothing", "expected a number"]),
    "a comma at the end": ([*FK, "--q", "1,2,3,4,5,"], ["value 6 of 6", "found nothing"]),
    "nan": ([*FK, "--q", "1,2,3,4,5,nan"], ["value 6 of 6", "'nan'", "expected a finite number"]),
    "inf": ([*FK, "--q", "-inf,2,3,4,5,6"], ["value 1 of 6", "'inf'", "expected a finite number"]),
    "an overflow": ([*FK, "--q", "1,2,3,4,5,1e999"], ["value 6 of 6", "too large", "finite"]),
    "a power": ([*FK, "--q", "9**9**9,2,3,4,5,6"], ["value 1 of 6", "too large"]),
    "pi in degrees": ([*FK, "--q", "pi/2,0,0,0,0,0"], ["value 1 of 6", "pi", "degrees", "deg(pi/2)"]),
    "a word": ([*FK, "--q", "1,2,3,4,5,x"], ["value 6 of 6", "'x'", "expected"]),
    "a unit": ([*FK, "--q", "90deg,0,0,0,0,0"], ["value 1 of 6", "expected a number"]),
    "a degree sign": ([*FK, "--q", "90°,0,0,0,0,0"], ["°", "expected a bare number"]),
    "semicolons": ([*FK, "--q", "1;2;3;4;5;6"], ["expected 6"]),
    "code": ([*FK, "--q", "__import__('os'),0,0,0,0,0"], ["value 1 of 6", "expected"]),
    "division by zero": ([*FK, "--q", "1/0,0,0,0,0,0"], ["division by zero"]),
    "a pose that is not there": ([*FK, "--q", "hom"], ["'hom'", "did you mean 'home'"]),
    "a pose of a robot with none": (["fk", "planar2r", "--q", "home"], ["'home'", "has none"]),
    "a file as values": ([*FK, "--q", "joints.csv"], ["'joints.csv'", "--input joints.csv"]),
    "standard input and more": ([*FK, "--q", "-", "--q", "home"], ["--q -", "expected no other --q"]),
    "two sources": ([*HOME, "--input", "x.csv"], ["exclude each other"]),
    "an input that is not there": ([*FK, "--input", "none.csv"], ["none.csv", "no such file", "expected"]),
    "an input that is a folder": ([*FK, "--input", "."], ["directory", "expected"]),
    "a batch for no joints": (["fk", "assembly", "--q", "-"], ["no joints"]),
}
ALL = {**USAGE, **VALUES}


@pytest.mark.parametrize(("arguments", "fragments"), ALL.values(), ids=ALL.keys())
def test_a_sentence_says_what_is_wrong(call, arguments, fragments):
    refused(call(*arguments), *fragments)


def test_no_arguments_show_the_help_on_stderr(call):
    answer = call()
    assert (answer.status, answer.out) == (2, b"")
    assert answer.err == call("--help").text


def test_an_error_in_a_description_names_its_place(call, tmp_path):
    path = tmp_path / "arm.yaml"
    path.write_text("robokin: 1\nname: Arm\njoints:\n  - {type: R, alpah: 90}\n")
    refused(call("fk", path, "--q", "1"), f"{path}:4:15: ", "'alpah'", "did you mean 'alpha'")


# Streams -------------------------------------------------------------------------------------------------

GOOD = "1,2,3,4,5,6\n"

LINES = {
    "too few values": ("1,2,3,4,5\n", ["found 5 values", "expected 6"]),
    "too many values": ("1,2,3,4,5,6,7\n", ["found 7 values", "expected 6"]),
    "text": ("1,2,three,4,5,6\n", ["'three'", "expected"]),
    "nan": ("1,2,nan,4,5,6\n", ["'nan'", "expected a finite number"]),
    "inf": ("1,2,3,4,5,-Infinity\n", ["'Infinity'", "expected a finite number"]),
    "an overflow": ("1,2,1e999,4,5,6\n", ["too large", "finite"]),
    "an empty cell": ("1,2,,4,5,6\n", ["found nothing", "expected a number"]),
    "a comma at the end": ("1,2,3,4,5,6,\n", ["found 7 values", "expected 6"]),
    "pi in degrees": ("pi,2,3,4,5,6\n", ["pi", "degrees"]),
    "an open quote": ('"1,2,3,4,5,6\n', ["expected"]),
    "another header": ("q1,q2,q3,q4,q5,q6\n", ["'q1'", "expected"]),
    "a long word": ("9" * 5000 + "\n", ["found 1 value", "expected 6"]),
    "no text": ("1,2,\0,4,5,6\n", ["expected UTF-8"]),
    "nothing but NUL": ("\0\n", ["expected"]),
    "semicolons": ("1;2;3;4;5;6\n", ["found 1 value", "expected 6"]),
}


@pytest.mark.parametrize(("line", "fragments"), LINES.values(), ids=LINES.keys())
@pytest.mark.parametrize("before", sweep(["", "# joints\n\nq1,q2,q3,q4,q5,q6\n"], 2), ids=["rows", "header"])
def test_a_wrong_line_names_its_number(call, line, fragments, before):
    for number, ending in ((5, "\r\n"), (4711, "\n")):
        lines = before + GOOD * (number - 1 - before.count("\n")) + line + GOOD * 10
        stdin = lines.replace("\n", ending).encode(errors="surrogateescape")
        answer = call(*FK, "--q", "-", "-f", "csv", stdin=stdin)
        sentence = answer.err.strip()
        assert answer.status == 2
        assert sentence.startswith(f"robokin: standard input, line {number}: "), sentence[:200]
        assert all(fragment in sentence for fragment in fragments), sentence[:500]
        assert "\n" not in sentence


def test_the_number_is_right_beyond_many_blocks(call):
    stdin = ("q1,q2,q3,q4,q5,q6\n" + GOOD * 60_000 + "1,2,3\n" + GOOD).encode()
    answer = call(*FK, "--q", "-", "-f", "csv", stdin=stdin)
    assert answer.status == 2
    assert "line 60002: found 3 values" in answer.err


@pytest.mark.parametrize("line", [LINES["too few values"], LINES["text"], LINES["nan"]], ids=["few", "text", "nan"])
def test_the_first_line_may_be_wrong_too(call, line):
    text, fragments = line
    refused(call(*FK, "--q", "-", stdin=text.encode()), "line 1: ", *fragments)


def test_a_header_must_have_the_columns(call, tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("a,b,c,d,e,f\n" + GOOD)
    refused(call(*FK, "-i", path), f"{path}, line 1: ", "found the columns a, b, c", "expected q1, q2, q3")
    path.write_text("q1,q2,q3,q4,q5,q6,q1\n1,2,3,4,5,6,7\n")
    refused(call(*FK, "-i", path), "line 1: ", "'q1' twice", "expected it once")
    path.write_text("t,q1,q2,q3,q4,q5,q6\n0,1,2,3,4,5,6\n" + GOOD)
    refused(call(*FK, "-i", path), "line 3: ", "found 6 values", "expected 7, as in the header")


JSON_LINES = {
    "no JSON": ("{", ["this is not JSON", "at column", "on each line"]),
    "another key": ('{"p": [1, 2]}', ["the key 'q' is missing"]),
    "no list": ('{"q": 1}', ["found 1", "expected a list"]),
    "a number": ("7", ["found 7", "expected a list"]),
    "too few values": ("[1, 2]", ["found 2 values", "expected 6"]),
    "a truth": ("[1, 2, 3, 4, 5, true]", ["found true", "expected a finite number"]),
    "nothing": ("[1, 2, 3, 4, 5, null]", ["found null", "expected a finite number"]),
    "a list": ("[1, 2, 3, 4, 5, [6]]", ["found [6]", "expected a finite number"]),
    "NaN": ("[1, 2, 3, 4, 5, NaN]", ["found NaN", "expected a finite number"]),
    "an overflow": ("[1, 2, 3, 4, 5, 1e999]", ["found Infinity", "expected a finite number"]),
    "a huge integer": ("[1, 2, 3, 4, 5, 1" + "0" * 400 + "]", ["expected a finite number"]),
    "too huge an integer": ("[1, 2, 3, 4, 5, 1" + "0" * 9000 + "]", ["this is not JSON"]),
    "NaN beside": ('{"time": NaN, "q": [1, 2, 3, 4, 5, 6]}', ["found NaN", "expected a finite number"]),
    "a key twice": ('{"q": [1, 2, 3, 4, 5, 6], "q": [1, 2, 3, 4, 5, 7]}', ["the key 'q' twice", "expected it once"]),
    "a name twice": ('{"q": {"q1": 1, "q2": 2, "q3": 3, "q4": 4, "q5": 5, "q6": 6, "q1": 0}}', ["the key 'q1' twice"]),
    "a word": ('[1, 2, 3, 4, 5, "x"]', ["'x'", "expected"]),
    "depth": ("[" * 100_000, ["this is not JSON"]),
    "unknown units": ('{"q": [1,2,3,4,5,6], "units": {"angle": "grad"}}', ["units", "rad or deg"]),
    "units of lists": ('{"q": [1,2,3,4,5,6], "units": {"angle": [], "length": {}}}', ["units", "rad or deg"]),
    "units in a word": ('{"q": [1,2,3,4,5,6], "units": "deg"}', ["units", "expected length"]),
}


@pytest.mark.parametrize(("line", "fragments"), sweep(JSON_LINES.values(), 3), ids=JSON_LINES.keys())
def test_a_wrong_document_names_its_line(call, line, fragments):
    stdin = ("[1,2,3,4,5,6]\n\n" * 2355 + line + "\n").encode()
    answer = call(*FK, "--q", "-", "-f", "jsonl", stdin=stdin)
    assert answer.status == 2
    sentence = answer.err.strip()
    assert sentence.startswith("robokin: standard input, line 4711: "), sentence[:300]
    assert all(fragment in sentence for fragment in fragments), sentence[:500]
    assert len(sentence) < 500


def test_a_number_that_is_too_large_to_be_written_is_refused_with_its_line(call):
    """What stands beside joint values goes through to the output, which would be no JSON."""
    row = '{"q": [1, 2, 3, 4, 5, 6], "t": [{"a": %s}]}'
    answer = call(*FK, "--q", "-", "-f", "jsonl", stdin=f"{row % 1}\n{row % '1e999'}\n".encode())
    assert answer.status == 2
    assert "line 2: found a number that is too large, expected a finite one" in answer.err


def test_a_line_without_end_is_not_awaited(call):
    refused(call(*FK, "--q", "-", stdin=b"1" * (3 << 20)), "line 1: longer than")


# Anything at all -----------------------------------------------------------------------------------------

PIECES = st.sampled_from(
    [
        *("0", "1", "90", "-90", "1e3", "1e999", ".5", "pi", "nan", "inf", "home", "deg(pi)", "sqrt(2)", "sqrt(-1)"),
        *("atan2(1,2)", "1/0", "(", ")", "[", "]", ",", ";", "-", "+", "**", "*", "/", "q1", "'", '"', "#", "\\"),
        *("Trans(", "Rot(", "x,", "z,30)", "RPY(1,2,3)", "Quat(1,0,0,0)", "Inv(", "Matrix([[", "]])"),
        *("é", "°", "−", "", " ", "\t", "\0", "\n"),
    ]
)


def answered(answer, *statuses):
    assert answer.status in statuses, answer
    assert "Traceback" not in answer.err
    if answer.status:
        assert answer.err.startswith("robokin: ")


@pytest.mark.slow
@settings(deadline=None, max_examples=80)
@given(st.lists(PIECES, max_size=12), st.sampled_from(["", " ", ","]))
def test_any_vector_and_any_expression_get_an_answer(pieces, joint):
    text = joint.join(pieces)
    answered(invoke(*FK, f"--q={text}", "--json"), 0, 2)
    answered(invoke("frame", "--json", "--", text), 0, 2)
    answered(invoke("frame", "Rot(z,30)", f"--point={text}", "--json"), 0, 2)


@pytest.mark.slow
@settings(deadline=None, max_examples=60)
@given(st.one_of(st.binary(max_size=60), st.lists(PIECES, max_size=30).map(lambda p: ",".join(p).encode())))
def test_any_bytes_get_an_answer(stdin):
    for more in ([], ["-f", "jsonl"]):
        answered(invoke(*FK, "--q", "-", *more, stdin=stdin), 0, 2)
    answered(invoke("fk", "planar2r", "--q", "-", "-f", "csv", stdin=b"\x93NUMPY" + stdin), 0, 2)
    answered(invoke("fk", "planar2r", "--q", "-", "-f", "csv", stdin=b"[" + stdin), 0, 2)


WORDS = ["fk", "show", "frame", "validate", "schema", "puma560", "--q", "-", "home", "-f", "--json", "--set", "-h"]


@settings(deadline=None, max_examples=60)
@given(st.lists(st.one_of(st.sampled_from(WORDS), st.text(max_size=8)), min_size=1))
def test_any_words_get_an_answer(words):
    # What would write a file, or read one that is there, is left out.
    words = [word for word in words if not word.startswith(("-o", "--o", "-i", "--i", "."))]
    if words:
        answered(invoke(*words), 0, 2)


SECOND_VALUES = [
    ("path", "puma560", "--to", "home", "--from", "home", "--from", "0,0,0,0,0,0"),
    ("fk", "puma560", "--q", "home", "--angle", "deg", "--angle=rad"),
    ("fk", "puma560", "--q", "home", "-f", "csv", "--format", "json"),
    ("fk", "puma560", "--q", "home", "-fcsv", "-fjson"),
    ("ik", "puma560", "--xyz", "500,100,300", "--rpy", "0,0,0", "--rpy", "0,0,1"),
    ("check", "fk", "puma560", "--q", "home", "--expect", "1,2,3", "--tol", "1", "--atol", "2"),
]


@pytest.mark.parametrize("words", SECOND_VALUES)
def test_an_option_with_one_value_is_not_given_two(call, words):
    answer = call(*words)
    assert (answer.status, answer.out) == (2, b"")
    assert "is given twice, with " in answer.err


def test_the_same_value_twice_and_repeatable_options_are_taken(call):
    assert call("fk", "puma560", "--q", "home", "--angle", "deg", "--angle", "deg").status == 0
    assert call("fk", "puma560", "--q", "home", "--q", "0,0,0,0,0,0").status == 0
    # A value may look like the name of an option.
    assert call("fk", "puma560", "--q", "--angle", "--angle", "rad").err.startswith("robokin: --q: found")


MEANT = [
    (("forward", "puma560"), "'fk'"), (("inverse",), "'ik'"), (("mobility", "four-bar"), "'dof'"),
    (("grade",), "'check'"), (("trajectory",), "'path'"), (("draw", "puma560"), "'plot'"),
    (("jacobain",), "'jacobian'"),
    (("help",), "robokin --help"), (("puma560",), "robokin show puma560"), (("Puma560",), "robokin show"),
    (("ik", "puma560", "--quaternions", "1,0,0,0"), "'--quat'"), (("fk", "puma560", "--units", "mm"), "'--length'"),
    (("check", "ik", "puma560", "--answers", "a.csv"), "'--input'"), (("fk", "puma560", "--joints", "1"), "'--q'"),
    (("ik", "puma560", "--tol", "1"), "'--tol-position'"), (("path", "puma560", "--start", "home"), "'--from'"),
    (("workspace", "puma560", "--out", "a.csv"), "'--output'"), (("fk", "puma560", "--radians"), "'--angle'"),
]  # fmt: skip


@pytest.mark.parametrize(("words", "meant"), MEANT)
def test_what_other_tools_call_it_is_understood_as_a_question(call, words, meant):
    answer = call(*words)
    assert (answer.status, answer.out) == (2, b"")
    assert meant in answer.err


def test_nothing_is_suggested_that_is_not_near(call):
    assert "did you mean" not in call("xyzzy").err
    assert "did you mean" not in call("fk", "puma560", "--wurzelbrunft", "1").err
