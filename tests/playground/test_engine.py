"""The playground's answers are those of the command line, and every command of the lectures' pages has one."""

from __future__ import annotations

import importlib.util
import io
import re
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest

import robokin

ROOT = Path(__file__).parent.parent.parent


def module(name):
    """A file of docs/playground as a module."""
    spec = importlib.util.spec_from_file_location(name, ROOT / "docs" / "playground" / f"{name}.py")
    made = importlib.util.module_from_spec(spec)
    sys.modules.setdefault(name, made)
    spec.loader.exec_module(made)
    return made


engine = module("engine")
build = module("build")
pages = {page["id"]: page for page in build.lectures()}


@pytest.fixture(autouse=True)
def _folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def test_a_command_is_answered_as_in_a_shell(capfd):
    from robokin.cli.program import run

    found = engine.run("robokin fk puma560 --q home", 80)
    run(["fk", "puma560", "--q", "home"])
    assert found["text"] == capfd.readouterr().out and found["status"] == 0 and found["said"] == ""


@pytest.mark.parametrize("name", pages)
def test_every_command_of_a_lecture_has_an_answer(name):
    commands = [part["command"] for part in pages[name]["parts"] if "command" in part]
    assert len(commands) >= 10
    for command in commands:
        found = engine.run(command)
        assert found["status"] in (0, 3), (command, found["said"])
        assert found["text"] or found["note"].endswith("is written"), command


def test_pages_keep_their_words_and_lose_their_links():
    html = "".join(part.get("html", "") for page in pages.values() for part in page["parts"])
    assert "Grübler" in html and "<a" not in html and "console" not in html


def test_pipes_between_commands_and_filters_at_their_end():
    both = engine.run("robokin ik planar2r --xy 1,0.5 -f csv | robokin fk planar2r --input - -f csv | cut -d, -f 4-")
    assert both["status"] == 0 and both["text"].count("\n") == 3
    assert both["note"] == "the whole answer, without | cut -d, -f 4-"
    assert engine.run("fk planar2r --q 0,0 | head -n 3 | tail -n 1")["note"].endswith("| head -n 3 | tail -n 1")


@pytest.mark.parametrize(
    "command",
    ["ls", "rm -rf /", "fk planar2r --q 0,0; ls", "fk planar2r > x", "fk planar2r && ls", "ls | robokin fk planar2r",
     "fk planar2r | robokin show planar2r", "fk 'planar2r", "serve", "cat < x", "|", "for x in a; do"],
)  # fmt: skip
def test_what_is_no_command_of_robokin_is_refused_with_a_sentence(command):
    found = engine.run(command)
    assert found["status"] == 2 and found["said"] and not found["text"] and not found["files"]


def test_files_that_a_command_writes_are_handed_on():
    found = engine.run("robokin plot planar2r -o arm.html")
    assert list(found["files"]) == ["arm.html"] and found["files"]["arm.html"].startswith(b"<!DOCTYPE html>")
    assert not engine.run("robokin fk planar2r --q 0,0")["files"]


def test_a_description_is_written_and_judged():
    good = engine.description("puma560")
    assert engine.written("robot.yaml", good)["valid"]
    assert engine.run("fk robot.yaml --q home")["text"].split() == engine.run("fk puma560 --q home")["text"].split()
    bad = engine.written("robot.yaml", good.replace("revolute", "revolut", 1))
    (mistake,) = bad["errors"]
    assert not bad["valid"] and good.splitlines()[mistake["line"] - 1].lstrip().startswith("- {name: waist")
    assert engine.written("robot.yaml", engine.description("four-bar"))["kind"] == "mechanism"
    assert engine.written("robot.yaml", "")["errors"] and engine.written("robot.yaml", "a: [")["errors"]
    with pytest.raises(ValueError, match="no robot"):
        engine.description("../../etc/passwd")


def test_the_tips_of_a_tree_have_the_places_of_their_joint_values():
    for name in ("shadow-hand", "human-hand", "yumi", "baxter"):
        tree = robokin.load_tree(name)
        found = engine.written("robot.yaml", engine.description(name))
        assert [tip for tip, _ in found["tips"]] == list(tree.tips) and found["joints"] == tree.n
        q = np.linspace(0.1, 0.9, tree.n)
        for (tip, joints), pose in zip(found["tips"], robokin.tip_poses(tree, q), strict=True):
            assert np.allclose(robokin.forward_kinematics(tree.robot(tip), q[joints]), pose)
    assert engine.written("robot.yaml", engine.description("puma560"))["tips"] == []
    assert engine.written("robot.yaml", "a: [")["tips"] == []


def test_an_answer_that_fails_is_said_and_the_next_one_is_given(monkeypatch):
    monkeypatch.setattr(engine, "run_program", lambda words: 1 / 0)
    assert engine.run("fk planar2r")["said"] == "robokin: the answer failed (ZeroDivisionError: division by zero)\n"


def test_the_streams_are_as_before(monkeypatch):
    before = sys.stdin, sys.stdout, sys.stderr
    engine.run("fk planar2r --q 0,0")
    engine.run("fk nothing")
    assert (sys.stdin, sys.stdout, sys.stderr) == before


def test_what_is_served_goes_with_its_licences(tmp_path):
    wheel = tmp_path / "numpy.whl"
    with zipfile.ZipFile(wheel, "w") as made:
        made.writestr("numpy-2.dist-info/LICENSE.txt", "BSD")
    names = zipfile.ZipFile(io.BytesIO(build.packages(wheel))).namelist()
    told = (build.HERE / "licences.txt").read_text().lower()
    for name in (*build.PACKAGES, "pyyaml", "numpy"):
        folder = re.compile(rf"{re.sub('[-_]', '[-_]', name)}-[^/]*\.dist-info/(licenses/)?LICENSE", re.IGNORECASE)
        assert any(map(folder.match, names)), name
        assert name in told
    assert "robokin/LICENSE" in names
