"""Files and texts: the head of a description, its parameters, and whatever else a file may hold."""

from __future__ import annotations

import os
import random
import time
from pathlib import Path

import pytest
from formats.texts import DEGREES, HEAD, arm, error_of, linkage, place

from robokin.errors import DescriptionError, InputError
from robokin.formats import read_file, read_text
from robokin.model import Mechanism, Robot

FORMAT_ROBOT = """
robokin: 1                      # format version, required
name: PUMA 560                  # required
description: one line           # optional
source: author, title, table    # optional: where the numbers come from, and which of them are not published
units: {length: mm, angle: deg} # length: m | cm | mm | in ; angle: deg | rad ; default {m, rad}
convention: standard            # standard (distal, Paul/Spong/Siciliano) | modified (proximal, Craig) | frames
parameters: {l1: 431.8, l2: l1/2}   # optional named numbers, usable in every cell below, overridable with --set
base: Trans(0, 0, 660)          # optional fixed transform from the world to frame 0 (a transform expression)
joints:
  - {name: waist, type: revolute, d: 0, a: 0, alpha: -90, limits: [-160, 160]}
  - {type: prismatic, theta: 0, a: 0, alpha: 0, limits: [0, 200], offset: 0}
tool: Trans(0, 0, 56.25)        # optional fixed transform from the last frame to the end effector
poses:                          # optional named configurations, usable as `--q home`
  home: [90, 0]
"""


def file_error(path, data):
    path.write_bytes(data)
    with pytest.raises(DescriptionError) as caught:
        read_file(path)
    assert str(caught.value).startswith(f"{path}:{caught.value.line}:{caught.value.column}: ")
    assert "expected" in caught.value.message
    return caught.value


# The head --------------------------------------------------------------------------------------------


def test_the_example_of_the_format():
    robot = read_text(FORMAT_ROBOT, id="puma")
    assert (robot.id, robot.name, robot.description) == ("puma", "PUMA 560", "one line")
    assert robot.source == "author, title, table"
    assert dict(robot.parameters) == {"l1": 431.8, "l2": 215.9}
    assert robot.types == "RP"
    assert robot.joints[0].name == "waist"
    assert robot.base[2, 3] == pytest.approx(0.660)
    assert robot.tool[2, 3] == pytest.approx(0.05625)


def test_robots_and_mechanisms_are_told_apart():
    assert isinstance(read_text(arm()), Robot)
    assert isinstance(read_text(linkage("type: revolute, links: [ground, crank]")), Mechanism)


def test_lines_of_text_are_joined():
    robot = read_text(arm(tail="description: >-\n  two\n  lines\nsource: |\n  a\n\n  b\n"))
    assert (robot.description, robot.source) == ("two lines", "a b")


@pytest.mark.parametrize("name", ["560", "'012'", "no", "~~", "α-arm 🤖", "'x: y'", "1e3"])
def test_a_name_is_what_is_written(name):
    assert read_text(arm(head=f"robokin: 1\nname: {name}\n")).name == name.strip("'")


@pytest.mark.parametrize(
    ("text", "at", "said"),
    [
        ("name: x\njoints: [{type: R}]\n", "1:1", "found no key 'robokin', expected `robokin: 1`"),
        ("\n# comment\nname: x\n", "3:1", "found no key 'robokin'"),
        ("name: x\nrobokn: 1\n", "2:1", "found the unknown key 'robokn', expected `robokin: 1`"),
        ("Robokin: 1\n", "1:1", "found the unknown key 'Robokin'"),
        ("robokin: 2\nname: x\n", "1:10", "found format version '2', expected 1"),
        ("robokin: 1.0\n", "1:10", "found format version '1.0'"),
        ("robokin:\nname: x\n", "1:9", "found nothing, expected the format's version"),
        ("robokin: [1]\nname: x\n", "1:10", "found a list of 1"),
        ("robokin: 1\njoints: [{type: R}]\n", "1:1", "found no 'name' in a robot, expected name: the name in full"),
        ("robokin: 1\nname:\njoints: [{type: R}]\n", "2:6", "found nothing, expected the name"),
        ("robokin: 1\nname: [a]\njoints: [{type: R}]\n", "2:7", "found a list of 1, expected the name"),
        (arm(tail="description: {a: b}\n"), "6:14", "found a mapping, expected the description"),
        (arm(tail="source: ''\n"), "6:9", "expected the source"),
        (arm(tail="jonts: 1\n"), "6:1", "found the unknown key 'jonts' in a robot; did you mean 'joints'"),
        (arm(tail="Units: 1\n"), "6:1", "did you mean 'units'"),
        (arm(tail="xyzzy: 1\n"), "6:1", "expected one of robokin, name, description"),
        (arm(tail="1: 1\n"), "6:1", "found the unknown key '1'"),
        (arm(tail='"a\\e[2J": 1\n'), "6:1", "found the unknown key 'a\\x1b[2J'"),
        (arm(tail=f"? {'k' * 2000}\n: 1\n"), "6:3", "..."),
        ("robokin: 1\njoints: [{type: R}]", "1:1", "found no 'name'"),
        ("- robokin: 1\n", "1:1", "found a list of 1, expected a description"),
        ("hello", "1:1", "found 'hello', expected a description"),
        ("{}", "1:1", "found nothing in the file"),
        ("12", "1:1", "found '12', expected a description"),
    ],
)
def test_a_wrong_head(text, at, said):
    error = error_of(text)
    assert said in error.message
    assert f"{error.line}:{error.column}" == at


# Parameters ------------------------------------------------------------------------------------------


def test_parameters_in_any_order_and_in_every_cell():
    head = DEGREES + "parameters: {c: a + b, a: b*2, b: 3, angle: 10*b, l_1: sqrt(a - 2), é: 5}\n"
    text = arm(
        "type: R, d: c, a: é, alpha: angle, offset: -angle, limits: [-angle, angle]",
        "type: P, theta: angle/3",
        head=head, tail="base: Trans(a, b, c) Rot(z, angle)\nposes: {p: [angle, l_1]}\n",
    )  # fmt: skip
    robot = read_text(text)
    assert dict(robot.parameters) == {"c": 9, "a": 6, "b": 3, "angle": 30, "l_1": 2, "é": 5}
    assert (robot.rows[0].d, robot.rows[0].a) == pytest.approx((0.009, 0.005), rel=1e-15)
    assert robot.base[:3, 3] == pytest.approx([0.006, 0.003, 0.009])
    assert robot.poses["p"] == pytest.approx([0.5235987755982988, 0.002])


@pytest.mark.parametrize(
    ("parameters", "at", "said"),
    [
        ("{a: b, b: a}", "4:17", "found parameters that refer to each other in a circle (a -> b -> a)"),
        ("{x: 1, a: a}", "4:23", "circle (a -> a)"),
        ("{a: b + 1, b: 1/0}", "4:27", "parameter b: found a division by zero"),
        ("{a: 1, a: 2}", "4:20", "found the key 'a' twice, first on line 4"),
        ("{a: zz}", "4:17", "parameter a: found the unknown name 'zz', expected one of pi, a or a number"),
        ("{pi: 3}", "4:14", "this one has a meaning already"),
        ("{π: 3}", "4:14", "this one has a meaning already"),
        ("{sin: 3}", "4:14", "found the parameter 'sin', expected another name"),
        ("{inf: 3}", "4:14", "meaning already"),
        ("{NaN: 3}", "4:14", "meaning already"),
        ("{1a: 3}", "4:14", "found the parameter '1a', expected a name of letters, digits and _"),
        ("{a-b: 3}", "4:14", "expected a name of letters"),
        ("{'a b': 3}", "4:14", "expected a name of letters"),
        ('{"e\\u0301": 3}', "4:14", "expected a name of letters"),
        ("{'': 3}", "4:14", "expected a name of letters"),
        ("{a: }", "4:17", "found nothing, expected parameter a: a number"),
        ("{a: [1]}", "4:17", "found a list of 1, expected parameter a"),
        ("{a: {b: 1}}", "4:17", "found a mapping"),
        ("{a: .nan}", "4:17", "expected a finite number"),
        ("[1, 2]", "4:13", "found a list of 2, expected parameters: a mapping of names to numbers"),
        ("5", "4:13", "found '5', expected parameters"),
    ],
)
def test_wrong_parameters(parameters, at, said):
    error = error_of(arm(head=DEGREES + f"parameters: {parameters}\n"))
    assert said in error.message
    assert f"{error.line}:{error.column}" == at


def test_parameters_can_be_replaced():
    text = arm("type: R, a: l2, alpha: t", head=DEGREES + "parameters: {l1: 100, l2: l1/2, t: 90}\n")
    assert read_text(text).rows[0].a == 0.050
    assert read_text(text, overrides={"l1": "10"}).rows[0].a == 0.005
    assert read_text(text, overrides={"l2": "2*3"}).rows[0].a == 0.006
    assert read_text(text, overrides={"l2": "l1*2"}).rows[0].a == 0.2
    assert read_text(text, overrides={"l1": "l2", "l2": "7"}).parameters["l1"] == 7.0
    with pytest.raises(DescriptionError, match=r"write deg\(t\)"):
        read_text(text, overrides={"t": "pi/2"})


@pytest.mark.parametrize("broken", ["1/0", "zz", "l1"])
def test_a_broken_cell_may_be_replaced(broken):
    text = arm(head=DEGREES + f"parameters: {{l1: {broken}}}\n")
    assert place(text) == "4:18"
    assert read_text(text, overrides={"l1": "1"}).parameters["l1"] == 1.0


@pytest.mark.parametrize(
    ("overrides", "said"),
    [
        ({"l3": "1"}, "has no parameter 'l3'; did you mean"),
        ({"zzz": "1"}, "expected one of l1, l2"),
        ({"l1": ".inf"}, "parameter l1=.inf: found '.inf', expected a number"),
        ({"l1": "1e999"}, "parameter l1=1e999: found a result that is too large"),
        ({"l1": "l2"}, "circle (l1 -> l2 -> l1)"),
        ({"l1": "("}, "parameter l1=(: found the end"),
        ({"l1": "\x1b[2J"}, "parameter l1=\\x1b[2J"),
        ({"l1": "1" * 20_000}, "found an expression of 20000 characters"),
    ],
)
def test_wrong_overrides(overrides, said):
    text = arm(head=DEGREES + "parameters: {l1: 100, l2: l1/2}\n")
    with pytest.raises(InputError) as caught:
        read_text(text, "arm.yaml", overrides)
    assert said in str(caught.value)
    assert str(caught.value).isprintable()
    assert len(str(caught.value)) < 300


@pytest.mark.slow
def test_thirty_thousand_parameters_take_no_time():
    start = time.process_time()
    names = [f"p{i}: p{i + 1}" for i in range(30_000)]
    robot = read_text(arm(head=HEAD + f"parameters: {{{', '.join(names)}, p30000: 7}}\n"))
    assert robot.parameters["p0"] == 7.0
    assert time.process_time() - start < 10.0


# Files -----------------------------------------------------------------------------------------------


def test_a_file_is_named_by_its_stem(tmp_path):
    path = tmp_path / "my-arm.yaml"
    path.write_text(arm())
    assert read_file(path).id == "my-arm"
    assert read_file(path, id="other").id == "other"


@pytest.mark.parametrize("mark", [b"", b"\xef\xbb\xbf"], ids=["no mark", "byte order mark"])
@pytest.mark.parametrize("ending", ["\n", "\r\n", "\r"], ids=["LF", "CRLF", "CR"])
def test_byte_order_marks_and_line_endings(tmp_path, mark, ending):
    path = tmp_path / "arm.yaml"
    path.write_bytes(mark + FORMAT_ROBOT.replace("\n", ending).encode())
    assert read_file(path).types == "RP"
    wrong = mark + arm("type: R, a: x").replace("\n", ending).encode()
    error = file_error(path, wrong)
    assert (error.line, error.column) == (5, 18)


@pytest.mark.parametrize(
    ("data", "line", "column", "said"),
    [
        (b"", 1, 1, "found nothing in the file"),
        (b"\xef\xbb\xbf", 1, 1, "found nothing in the file"),
        (b"# only\n\n# comments\n", 1, 1, "found nothing in the file"),
        (b"robokin: 1\nname: \xff\n", 2, 7, "expected YAML in UTF-8"),
        (b"robokin: 1\nname: \xc3\xa9\xe9\n", 2, 8, "expected YAML in UTF-8"),
        (b"\xef\xbb\xbfrobokin: 1\nname: \xff\n", 2, 7, "expected YAML in UTF-8"),
        (b"\xef\xbb\xbf\xff", 1, 1, "expected YAML in UTF-8"),
        (b"\xed\xa0\x80", 1, 1, "expected YAML in UTF-8"),
        ("robokin: 1".encode("utf-16"), 1, 1, "expected YAML in UTF-8"),
        ("robokin: 1".encode("utf-16-le"), 1, 2, "U+0000"),
        (b"\x7fELF\x02\x01\x01" + bytes(range(256)), 1, 136, "expected YAML in UTF-8"),
        (b"\x89PNG\r\n\x1a\n", 1, 1, "expected YAML in UTF-8"),
        (b"robokin: 1\nna\0me: x\n", 2, 3, "U+0000"),
        (b"robokin: 1\nname: x\x1b[31m\n", 2, 8, "U+001B"),
        (b"\0" * 1000, 1, 1, "U+0000"),
        (b"x" * (10 << 20), 1, 1, "found a file over 1 MiB"),
        (arm().encode() + b"#" * (1 << 20), 1, 1, "found a file over 1 MiB"),
    ],
)
def test_what_is_no_description(tmp_path, data, line, column, said):
    error = file_error(tmp_path / "arm.yaml", data)
    if data.startswith(b"\x7fELF"):
        line, column = error.line, error.column  # where the first byte of 0x80 or more falls does not matter
    assert (error.line, error.column) == (line, column)
    assert said in error.message


def test_a_file_of_one_mebibyte_is_read(tmp_path):
    path = tmp_path / "arm.yaml"
    text = arm()
    path.write_text(text + "#" * ((1 << 20) - len(text)))
    assert read_file(path).types == "R"


@pytest.mark.parametrize("kind", ["missing", "folder", "under a file", "null", "long", "loop", "dangling"])
def test_what_cannot_be_opened(tmp_path, kind):
    (tmp_path / "file").write_text("x")
    (tmp_path / "loop").symlink_to("loop")
    (tmp_path / "dangling").symlink_to("nowhere")
    names = {
        "folder": ".",
        "under a file": "file/x.yaml",
        "null": "a\0b.yaml",
        "long": "x" * 5000,
        "missing": "no.yaml",
    }
    with pytest.raises(InputError, match="expected") as caught:
        read_file(tmp_path / names.get(kind, kind))
    assert isinstance(caught.value, ValueError)


def test_a_file_that_may_not_be_read(tmp_path):
    path = tmp_path / "arm.yaml"
    path.write_text(arm())
    path.chmod(0)
    try:
        if os.access(path, os.R_OK):
            pytest.skip("this user may read everything")
        with pytest.raises(InputError, match="cannot be read"):
            read_file(path)
    finally:
        path.chmod(0o600)


def test_an_endless_file_is_cut_off():
    start = time.process_time()
    with pytest.raises(InputError):
        read_file(Path("/dev/zero"))
    assert time.process_time() - start < 5.0


def test_random_bytes_end_in_a_sentence(tmp_path):
    dice = random.Random(560)
    path = tmp_path / "arm.yaml"
    for _ in range(200):
        path.write_bytes(dice.randbytes(dice.randrange(1, 200)))
        with pytest.raises(InputError):
            read_file(path)
