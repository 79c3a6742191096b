"""What a terminal is shown: no number cut at any width, and nothing from a file or an argument that steers it."""

from __future__ import annotations

import os
import re
import sys
from pathlib import Path
from unittest import mock

import numpy as np
import pytest
from rich.cells import cell_len
from sweeps import sweep

from robokin.errors import visible
from robokin.formats import library_names
from robokin.reports import page_tables as tables
from robokin.reports.page_tables import Table, heading, pairs, render

NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?![\w.])")
STEERING = "\x1b[31m\x9b2J\x07\r\x08\u202e\u2066\u200f\x7f"
RAW = re.compile("[\x00-\x09\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069]")

LEG = """\
robokin: 1
name: Leg
units: {length: m, angle: deg}
parameters: {length_of_the_upper_part_of_the_left_front_leg_of_the_walking_machine: 0.4375, b: 12345.678901}
joints:
  - {name: shoulder rotation of the left front leg 1, type: revolute, d: 0.125, alpha: -90, limits: [-161.125, 160.5]}
  - {name: shoulder_lift_of_the_left_front_leg_of_the_machine, type: revolute, a: b, offset: 179.123456}
  - {name: knee, type: prismatic, a: 0.875, alpha: 33.333333, limits: [0.000001, 123456.789012]}
poses: {where_the_leg_stands_when_the_machine_has_been_switched_off_for_the_night: [1.111111, 2.222222, 3.333333]}
"""
SHOWN = ["0.125", "-90", "-161.125", "160.5", "12345.678901", "179.123456", "0.875", "33.333333", "123456.789012",
         "0.000001", "1.111111", "2.222222", "3.333333", "0.4375"]  # fmt: skip


@pytest.fixture
def leg(tmp_path):
    path = tmp_path / "leg.yaml"
    path.write_text(LEG)
    return path


def on_terminal(columns, draw):
    """What a page is on a terminal so wide."""
    with (
        mock.patch.object(sys, "stdout", mock.Mock(isatty=lambda: True)),
        mock.patch.dict(os.environ, {"COLUMNS": str(columns), "TERM": "dumb"}),
    ):
        return draw().decode()


# Widths ---------------------------------------------------------------------------------------------------


def test_long_names_cut_no_number(call, leg):
    answer = call("show", leg)
    assert answer.status == 0
    found = NUMBER.findall(answer.text)
    for number in SHOWN:
        assert number in found
    assert "…" not in answer.text
    assert max(map(len, answer.lines)) < 110, "names give way"


@pytest.mark.parametrize("columns", [1, 2, 5, 10, 17, 20, 33, 40, 61, 79, 80, 81, 100, 150, 300])
def test_no_width_cuts_a_number(call, leg, monkeypatch, columns):
    monkeypatch.setattr(tables.shutil, "get_terminal_size", lambda fallback: os.terminal_size((columns, 24)))
    real = render
    monkeypatch.setattr(tables, "render", lambda *parts: on_terminal(columns, lambda: real(*parts)).encode())
    found = NUMBER.findall(call("show", leg).text)
    for number in SHOWN:
        assert number in found


@pytest.mark.parametrize("name", sweep(library_names()[::7], 4))
def test_the_numbers_of_a_page_are_those_of_a_page_without_end(call, monkeypatch, name):
    """However the table is fitted into 80 columns."""
    narrow = call("show", name)
    monkeypatch.setattr(tables, "WIDTH", 10_000)
    wide = call("show", name)
    assert sorted(NUMBER.findall(narrow.text)) == sorted(NUMBER.findall(wide.text))


def test_words_of_a_column_come_out_in_order_at_every_width():
    rng = np.random.default_rng(7)
    words = ["0.125", "-90", "q1", "shoulder", "a" * 60, "x", "12345.678901", "日本語", "é", "=", "(3,", "4)"]
    for columns in (1, 3, 8, 20, 40, 80, 200):
        for _ in range(10):
            drawn = Table(gap=int(rng.integers(1, 4)))
            cells = [[" ".join(rng.choice(words, rng.integers(0, 9))) for _ in range(3)] for _ in range(4)]
            for i in range(3):
                drawn.add_column(f"c{i}", justify=["left", "right"][i % 2], no_wrap=bool(rng.integers(2)))
            for row in cells:
                drawn.add_row(*row)
            text = on_terminal(columns, lambda drawn=drawn: render(drawn))
            for number in ("0.125", "-90", "12345.678901"):
                given = sum(cell.split().count(number) for row in cells for cell in row)
                assert text.split().count(number) == given
            letters = sorted("".join(text.split()).replace("─", ""))
            assert letters == sorted("".join(["c0c1c2", *(cell for row in cells for cell in row)]).replace(" ", ""))


def test_wide_letters_and_accents_are_counted():
    assert [cell_len(text) for text in ("abc", "日本", "é", "e\u0301", "")] == [3, 4, 1, 1, 0]


def test_columns_stand_below_each_other():
    drawn = pairs([("日本", "1"), ("a", "2"), ("é", "3")])
    assert render(drawn).decode() == "日本  1\na     2\né     3\n"


# Control characters ---------------------------------------------------------------------------------------


def test_what_steers_is_written_out():
    assert visible("a\x1b[31m\u202eb\nc\u00a0d") == "a\\x1b[31m\\u202eb\\nc\u00a0d"
    assert visible("a\nb", lines=True) == "a\nb"
    assert visible("Stäubli 日本 −90° θ") == "Stäubli 日本 −90° θ"
    page = render(heading(STEERING, STEERING), pairs([(STEERING, STEERING)]), STEERING).decode()
    assert not RAW.search(page)
    assert page.count("\\x1b[31m") == 5


@pytest.mark.parametrize(
    "command",
    [
        ["list", STEERING],
        ["show", STEERING],
        ["show", f"./{STEERING}.yaml"],
        ["fk", "puma560", "--q", STEERING],
        ["fk", "puma560", "--input", STEERING],
        ["fk", "puma560", "-f", STEERING],
        ["fk", "puma560", "-o", STEERING],
        ["fk", "puma560", "-o", f"{STEERING}/x.csv", "--q", "home"],
        ["fk", "puma560", f"--{STEERING}"],
        ["fk", "puma560", "--set", f"{STEERING}=1"],
        ["ik", "puma560", "--pose", STEERING],
        ["ik", "puma560", "--matrix", STEERING],
        ["check", STEERING],
        ["check", "dh", f"{STEERING}.yaml", "--against", "puma560"],
        ["validate", f"{STEERING}.yaml", "puma560"],
        ["frame", STEERING],
        ["workspace", "planar3r", "--slice", STEERING],
        ["dof", "four-bar", "--between", STEERING],
        [STEERING],
    ],
    ids=lambda command: " ".join(command).encode("unicode_escape").decode()[:40],
)
def test_no_argument_steers_the_terminal(call, command):
    answer = call(*command)
    assert answer.status in (2, 3)
    assert not RAW.search(answer.err.rstrip("\n") + answer.text)
    assert answer.err.count("\n") == 1


def test_no_file_s_name_steers_the_terminal(call, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    name = f"{STEERING}.yaml"
    for text in (LEG, LEG.replace("alpha: -90", "alpha: x")):
        Path(name).write_text(text)
        for command in (["show", name], ["fk", name, "--q", "1,2,3"], ["validate", name], ["dof", name],
                        ["check", "dh", name, "--against", "puma560"], ["fk", name, "--q", "-"],
                        ["singular", name], ["show", name, "--json"], ["validate", name, "--json"]):  # fmt: skip
            answer = call(*command)
            assert not RAW.search(answer.text + answer.err), command
    assert call("validate", f"./{name}", "--json").json[0]["file"] == f"./{name}", "JSON has the name as it is"


@pytest.mark.parametrize("form", ["table", "json", "jsonl"])
def test_no_student_s_name_steers_the_terminal(call, tmp_path, form):
    path = tmp_path / "class.csv"
    key = f"id,student,{','.join(f'q{i}' for i in range(1, 7))},x,y,z"
    path.write_text(f"{key}\n1,{STEERING.replace(chr(13), '')},0,0,0,0,0,0,1,2,3\n2,b\u202e,0,0,0,0,0,0,x\x1b,2,3\n")
    answer = call("check", "fk", "puma560", "-i", path, "-f", form)
    assert answer.status == 3, answer
    assert not RAW.search(answer.text + answer.err)
    if form == "json":
        assert answer.json["items"][1]["student"] == "b\u202e"


@pytest.mark.parametrize("name", ["a\\e[31m", "a\\u202eb", "a\\x9bb", "a\\u2028b", "a\\tb"])
def test_no_name_in_a_description_steers_the_terminal(call, tmp_path, name):
    path = tmp_path / "arm.yaml"
    for old in ("name: Leg", "name: knee"):
        path.write_text(LEG.replace(old, f'name: "{name}"'))
        for command in (["show"], ["fk", "--q", "1,2,3"], ["fk", "--q", "1,2,3", "--q", "2,3,4"], ["validate"],
                        ["fk", "--symbolic"], ["jacobian", "--q", "1,2,3"]):  # fmt: skip
            answer = call(command[0], path, *command[1:])
            assert not RAW.search(answer.text + answer.err), (command, answer)
