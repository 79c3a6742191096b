"""All mistakes of a description at once, each with its line; what only follows from another is not listed."""

from __future__ import annotations

import random
import unicodedata

import pytest
from formats.texts import DEGREES, HEAD, arm, error_of, linkage

from robokin.errors import MAX_LISTED, DescriptionError, InputError
from robokin.formats import library_names, read_text
from robokin.formats.excerpts import excerpt
from robokin.formats.library import load_any

ROWS = [
    "type: R, d: 149.09, a: 0, alpha: -90, limits: [-160, 160]",
    "type: R, d: 0, a: l1 - l2, alpha: 0, offset: 90",
    "type: P, theta: 0, a: 0, alpha: 90, limits: [0, 200]",
    "type: R, d: 40, alpha: 0",
]

# Each changes a piece of a right file into a wrong one, at a place of its own.
SLIPS = {
    "units": ("angle: deg", "angle: degree"),
    "a parameter": ("l1: 431.8", "l1: 431.8 mm"),
    "another parameter": ("l2: 20", "l2: sqrt(-1)"),
    "a base": ("base: Trans(0, 0, 660)", "base: Tran(0, 0, 660)"),
    "a key of a row": ("a: 0, alpha: -90", "a: 0, alhpa: -90"),
    "limits": ("[-160, 160]", "[160, -160]"),
    "an end of limits": ("[0, 200]", "[zero, 200]"),
    "a cell": ("d: 149.09", "d: 149,09"),
    "a word for a number": ("offset: 90", "offset: ninety"),
    "the variable's cell": ("theta: 0, a: 0", "d: 7, a: 0"),
    "a tool": ("tool: Trans(0, 0, 56.25)", "tool: Trans(0, 0)"),
    "a pose": ("home: [0, 0, 10, 0]", "home: [0, 0, 10]"),
    "a pose's value": ("up: [0, 90, 0, 0]", "up: [0, 90°, 0, 0]"),
    "an unknown key": ("source: a book", "sorce: a book"),
    "a key given twice": ("d: 40, alpha: 0", "d: 40, alpha: 0, alpha: 1"),
}

RIGHT = (
    HEAD + "source: a book\nunits: {length: mm, angle: deg}\nparameters: {l1: 431.8, l2: 20}\nbase: Trans(0, 0, 660)\n"
    "joints:\n" + "".join(f"  - {{{row}}}\n" for row in ROWS)
    + "tool: Trans(0, 0, 56.25)\nposes:\n  home: [0, 0, 10, 0]\n  up: [0, 90, 0, 0]\n"
)  # fmt: skip


def test_the_right_file_is_right():
    assert read_text(RIGHT).types == "RRPR"


@pytest.mark.parametrize("name", SLIPS)
def test_one_mistake_is_one(name):
    old, new = SLIPS[name]
    assert RIGHT.count(old) == 1
    error = error_of(RIGHT.replace(old, new))
    line = RIGHT[: RIGHT.index(old)].count("\n") + 1
    assert error.line == line


def test_k_mistakes_are_k(seed=28):
    dice = random.Random(seed)
    for _ in range(60):
        chosen = dice.sample(sorted(SLIPS), dice.randrange(2, 9))
        text = RIGHT
        lines = []
        for name in chosen:
            old, new = SLIPS[name]
            lines.append(RIGHT[: RIGHT.index(old)].count("\n") + 1)
            text = text.replace(old, new)
        error = error_of(text, mistakes=len(chosen))
        assert sorted(one.line for one in error.errors) == sorted(lines)
        assert [(one.line, one.column) for one in error.errors] == sorted((e.line, e.column) for e in error.errors)
        for one in error.errors:
            shown, mark = one.excerpt.split("\n")
            assert shown == f"{one.line:>4} | {text.splitlines()[one.line - 1]}"
            assert mark.index("^") == 7 + one.column - 1
            assert one.sentence in str(error)
            assert one.excerpt in str(error)


@pytest.mark.parametrize(
    ("text", "places"),
    [
        # A broken parameter is one mistake, wherever it is named.
        (arm("type: R, a: l1, d: 2*l1", "type: P, a: l2", head=DEGREES + "parameters: {l1: 1/0, l2: l1}\n"), ["4:18"]),
        (arm("type: R, a: l1", head=DEGREES + "parameters: [1, 2]\n"), ["4:13"]),
        # Of a row whose type is not known only what does not depend on it is judged.
        (arm("type: Q, theta: 5, limits: [5, 1], a: x", tail="poses: {p: [0, 0]}\n"), ["5:12", "5:44"]),
        (arm("typ: R, a: 1"), ["5:6"]),
        (arm("a: 1", "type: R, theta: q2"), ["5:5"]),
        # What cells belong to a table is not known where the convention is not.
        (arm("type: R, origin: 'Trans(0, 0, 1)'", head=DEGREES + "convention: craig\n"), ["4:13"]),
        (arm("type: R, alpha: pi/2", head=HEAD + "units: {angle: grad}\n"), ["3:16"]),
        (linkage("type: revolute, links: [ground, crnk]", "type: revolut, links: [crank, rocker], at: [0, x]"),
         ["6:38", "7:12", "7:53"]),
        (linkage("type: revolute, links: [ground, crank]", space="plane"), ["3:8"]),
        ("robokin: 1\nname: x\nspace: planar\nlinks: [a, [b]]\njoints: [{type: revolute, links: [a, b]}]\n", ["4:12"]),
        ("robokin: 1\nkind: wheeled\nname: b\nwheels:\n"
         "  - {type: fixd, at: [0], radius: -1}\n  - {at: [0, x], drivn: true}\n",
         ["5:12", "5:22", "5:35", "6:5", "6:14", "6:18"]),
        # An alias repeats a row, not its mistake.
        (DEGREES + "joints:\n  - &r {type: R, a: x}\n  - *r\n  - *r\n", ["5:21"]),
        # A file that ends early has no more than that.
        ("robokin: 1\nname: x\njoints: [{type: R, alhpa: 5}\n", ["4:1"]),
    ],
)  # fmt: skip
def test_what_follows_from_a_mistake_is_not_listed(text, places):
    error = error_of(text, mistakes=len(places))
    assert [f"{one.line}:{one.column}" for one in error.errors] == places


def test_a_long_list_is_cut_and_hostile_files_end():
    error = error_of(arm(*["type: R, a: x"] * 50), mistakes=50)
    assert str(error).endswith("\nand 30 more")
    assert sum(one.sentence in str(error) for one in error.errors) == MAX_LISTED
    with pytest.raises(DescriptionError) as caught:
        read_text(arm(*["type: R, alhpa: 1, thta: 2, limts: 3"] * 1000))
    assert len(caught.value.errors) == 200


def test_a_file_that_may_be_mended_in_one_round_is_mended():
    text = RIGHT
    for old, new in SLIPS.values():
        text = text.replace(old, new)
    lines = {one.line for one in error_of(text, mistakes=len(SLIPS)).errors}
    mended = [RIGHT.splitlines()[i - 1] if i in lines else line for i, line in enumerate(text.splitlines(), start=1)]
    assert read_text("\n".join(mended)).types == "RRPR"


@pytest.mark.parametrize(
    ("line", "column", "width", "shown", "mark"),
    [
        ("a: 1", 4, 1, "a: 1", "   ^"),
        ("alpha: ninety", 8, 6, "alpha: ninety", "       ^~~~~~"),
        ("\ta: x", 5, 9, " a: x", "    ^"),
        ("名前: x", 5, 1, "名前: x", "      ^"),
        ("e\u0301: x", 5, 1, "e\u0301: x", "   ^"),
        ("a\u202eb: x", 6, 1, "a\\u202eb: x", "          ^"),
        ("x" * 300 + "!" + "y" * 300, 301, 1, "…" + "x" * 60 + "!" + "y" * 39 + "…", " " * 61 + "^"),
        ("abc", 9, 1, "abc", "   ^"),
    ],
)
def test_the_line_is_shown_and_the_place_marked(line, column, width, shown, mark):
    text, below = excerpt(["", line], 2, column, width).split("\n")
    assert text == f"   2 | {shown}"
    assert below == f"     | {mark}"
    assert unicodedata.normalize("NFC", text).isprintable()


def test_no_line_is_shown_where_there_is_none():
    assert excerpt(["a"], 3, 1, 1) == excerpt([" "], 1, 1, 1) == excerpt([], 1, 1, 1) == ""


# Names and formats ---------------------------------------------------------------------------------------


def test_the_library_knows_its_names_in_any_case():
    assert load_any("PUMA560").id == load_any("Puma560").id == "puma560"
    assert all(name == name.lower() for name in library_names())


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("kuka", "'kuka' is in the title of"),
        ("Kinova", "gen3"),
        ("puma", "did you mean puma560"),
        ("quat", "`robokin list` shows what there is"),
        ("forward", "`robokin list` shows what there is"),
    ],
)
def test_a_wrong_name_gets_names_that_are_near_or_of_its_maker(name, said):
    with pytest.raises(InputError) as caught:
        load_any(name)
    assert said in str(caught.value)


def test_a_file_without_its_ending_is_meant(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "arm1.yaml").write_text(arm())
    with pytest.raises(InputError, match=r"named 'arm1' in the library; did you mean arm1\.yaml"):
        load_any("arm1")


def test_a_wrong_path_is_explained(tmp_path):
    (tmp_path / "my-arm.yaml").write_text(arm())
    for name, said in {"my_arm.yaml": "did you mean", "PUMA560.yaml": "written without an ending: puma560"}.items():
        with pytest.raises(InputError, match="no such file") as caught:
            load_any(tmp_path / name)
        assert said in str(caught.value)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('<?xml version="1.0"?>\n<robot name="a"><joint/></robot>\n', "found a URDF, expected YAML"),
        ('<robot xmlns:xacro="http://ros.org/wiki/xacro">', "found a URDF"),
        ("<mujoco>\n</mujoco>", "found an MJCF file"),
        ("<sdf version='1.6'/>", "found an SDF file"),
        ("<svg/>", "found XML"),
        ("i,theta,d,a,alpha\n1,0,0.1,0,90\n", "found a table in CSV"),
        ("1;0;0,1;0\n2;0;0,2;0\n", "found a table in CSV"),
        ("0\t1\t2\n3\t4\t5\n", "found a table in CSV"),
        ("| i | theta | d |\n|---|---|---|\n", "found a table in Markdown"),
        ("\\begin{tabular}{ccc}\n", "found LaTeX"),
    ],
)
def test_another_format_is_named(text, said):
    error = error_of(text)
    assert (error.line, error.column) == (1, 1)
    assert said in error.message


@pytest.mark.parametrize("space", [" ", "\n\t", "\n"])
def test_json_is_read(space):
    text = '{"robokin": 1,@"name": "x",@"units": {"length": "mm", "angle": "deg"},@"joints": [{"type": "R", "a": 0.5}]}'
    assert read_text(text.replace("@", space)).rows[0].a == 0.0005
