"""The help: it fits a page, it names every option, and its examples run."""

from __future__ import annotations

import shlex
from pathlib import Path

import pytest

import robokin
from robokin.cli.app import COMMANDS

from .conftest import PROGRAM


def examples(call, command):
    lines = call(command, "--help").lines
    return [line.strip() for line in lines[lines.index("Examples:") + 1 :]]


def test_the_overview_names_every_command(call):
    answer = call("--help")
    assert (answer.status, answer.err) == (0, "")
    for name, line in COMMANDS.items():
        assert any(row.split()[:1] == [name] and row.endswith(line) for row in answer.lines)
    assert call("-h").out == answer.out


def test_the_version(call):
    assert call("--version").text == f"robokin {robokin.__version__}\n"


@pytest.mark.parametrize("command", COMMANDS)
def test_the_help_of_a_command(call, command):
    answer = call(command, "--help")
    assert (answer.status, answer.err) == (0, "")
    assert answer.lines[0].split()[1:3] == ["robokin", command]
    assert max(map(len, answer.lines)) <= 80
    assert "Examples:" in answer.lines
    assert "\n\n\n" not in answer.text
    assert "-f, --format FORMAT" in answer.text
    assert "-o, --output FILE" in answer.text
    assert "--json" in answer.text
    for word in ("<str>", "{", "TEXT"):
        assert word not in answer.text
    assert call(command, "-h").out == answer.out


@pytest.mark.parametrize("command", COMMANDS)
def test_the_examples_run(call, command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    rows = b"0,0,0,0,0,0\n10,20,30,40,50,60\n90,0,90,0,0,0\n"
    Path("joints.csv").write_bytes(rows)
    Path("robots").mkdir()
    for name in ("arm.yaml", "robots/arm.yaml"):
        Path(name).write_text("robokin: 1\nname: Arm\njoints:\n  - {type: R, a: 1}\n")
    assert len(examples(call, command)) >= 1
    for example in examples(call, command):
        stdin = b""
        for stage in example.split(" | "):
            words = shlex.split(stage)
            if words[0] != "robokin":
                assert stage.endswith("joints.csv")
                stdin = rows
                continue
            globbed = [str(path) for word in words[1:] for path in (Path().glob(word) if "*" in word else [word])]
            answer = call(*globbed, stdin=stdin)
            assert (answer.status, answer.err) == (0, ""), example
            stdin = answer.out
        assert words[0] == "robokin"


def test_the_module_is_a_program_too(run):
    import subprocess

    done = subprocess.run([PROGRAM[0], "-m", "robokin", "--version"], capture_output=True, text=True, check=True)
    assert done.stdout == f"robokin {robokin.__version__}\n"


def test_a_shell_completes_commands_and_robots(run):
    import subprocess

    from .conftest import environment

    def completed(words):
        env = environment(_ROBOKIN_COMPLETE="complete_bash", COMP_WORDS=words, COMP_CWORD=str(len(words.split()) - 1))
        return subprocess.run(PROGRAM, capture_output=True, text=True, check=False, env=env).stdout.split()

    assert completed("robokin f") == ["fk", "frame"]
    assert "puma560" in completed("robokin fk puma5")
