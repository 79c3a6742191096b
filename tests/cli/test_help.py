"""The help: it fits a page, it names every option, and its examples run."""

from __future__ import annotations

import shlex
import subprocess
from importlib.util import find_spec
from pathlib import Path

import pytest
from sweeps import sweep

import robokin
from robokin.cli.app import COMMANDS

from .conftest import PROGRAM, environment

ROOT = Path(__file__).parent.parent.parent


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
    assert call("--version").text == f"robokin {robokin.__version__} ({robokin.kernel_in_use} kernel)\n"


@pytest.mark.parametrize("command", COMMANDS)
def test_the_help_of_a_command(call, command):
    answer = call(command, "--help")
    assert (answer.status, answer.err) == (0, "")
    assert answer.lines[0].split()[1:3] == ["robokin", command]
    assert max(map(len, answer.lines)) <= 80
    assert "Examples:" in answer.lines
    assert "\n\n\n" not in answer.text
    if command != "serve":  # whose answers are documents
        assert "-f, --format FORMAT" in answer.text
        assert "-o, --output FILE" in answer.text
    assert "--json" in answer.text
    for word in ("<str>", "{", "TEXT"):
        assert word not in answer.text
    assert call(command, "-h").out == answer.out


TAKES_LONG = pytest.param("workspace", marks=pytest.mark.slow)


@pytest.mark.parametrize("command", [*(name for name in COMMANDS if name != "workspace"), TAKES_LONG])
def test_the_examples_run(call, command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    rows = b"0,0,0,0,0,0\n10,20,30,40,50,60\n90,0,90,0,0,0\n"
    Path("joints.csv").write_bytes(rows)
    Path("table.txt").write_text((ROOT / "tests/data/pasted_table.txt").read_text())
    Path("joints-table.csv").write_text("i,theta,d,a,alpha\n1,0,89.159,0,90\n2,0,0,-425,0\n")
    Path("robots/arms").mkdir(parents=True)
    for name in ("arm.yaml", "robots/arm.yaml", "robots/arms/arm.yaml"):
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
    done = subprocess.run([PROGRAM[0], "-m", "robokin", "--version"], capture_output=True, text=True, check=True)
    assert done.stdout == f"robokin {robokin.__version__} ({robokin.kernel_in_use} kernel)\n"


def completed(words, **more):
    """What bash offers for the last of some words."""
    env = environment(_ROBOKIN_COMPLETE="complete_bash", COMP_WORDS=words, COMP_CWORD=str(len(words.split(" ")) - 1))
    done = subprocess.run(PROGRAM, capture_output=True, text=True, check=False, env=env, **more)
    assert done.stderr == ""
    return done.stdout.split()


def test_a_shell_completes_commands_and_robots():
    assert completed("robokin f") == ["fk", "frame"]
    assert "puma560" in completed("robokin fk puma5")
    assert "scorbot" in completed("robokin workspace scara --compare scor")


def test_a_shell_completes_what_options_take(tmp_path):
    assert completed("robokin fk puma560 -f ") == ["table", "json", "jsonl", "csv", "parquet", "arrow"]
    assert completed("robokin fk puma560 --length c") == ["cm"]
    assert completed("robokin ik puma560 --method a") == ["auto", "analytic"]
    assert completed("robokin fk puma560 --q h") == ["home"]
    assert completed("robokin path puma560 --from h") == ["home"]
    assert completed("robokin fk no-such-robot --q h") == []
    assert completed("robokin ik human-hand --target i") == ["index="]
    assert completed("robokin ik human-hand --tip ") == ["thumb", "index", "middle", "ring", "little"]
    assert completed("robokin fk human-hand --q pi") == ["pinch"]
    assert completed("robokin ik puma560 --tip ") == completed("robokin ik no-such.yaml --target ") == []
    (tmp_path / "my arm.yaml").write_text("robokin: 1\nname: A\njoints:\n  - {type: R, a: 1}\nposes: {up: [90]}\n")
    (tmp_path / "mine").mkdir()
    (tmp_path / "m.txt").write_text("")
    offered = completed("robokin fk m", cwd=tmp_path)
    assert {"mine/", "my", "arm.yaml"} <= set(offered)
    assert "m.txt" not in offered


WORDS = {"--format": ("fk", "puma560"), "--angle": ("fk", "puma560"), "--length": ("fk", "puma560"),
         "--as": ("fk", "puma560"), "--method": ("ik", "puma560"), "--frame": ("jacobian", "puma560"),
         "--task": ("jacobian", "puma560"), "--sampling": ("workspace", "planar2r")}  # fmt: skip


@pytest.mark.parametrize("option", sweep(WORDS, 4))
def test_what_is_offered_is_accepted(call, option):
    command, robot = WORDS[option]
    more = {"ik": ("--xyz", "500,100,300"), "workspace": ("-n", "64")}.get(command, ("--q", "home"))
    offered = completed(f"robokin {command} {robot} {option} ")
    assert len(offered) >= 2
    for word in offered:
        answer = call(command, robot, *more, option, word)
        if word in ("parquet", "arrow") and find_spec("pyarrow") is None:
            assert "pip install 'robokin[parquet]'" in answer.err
            continue
        assert answer.status == 0, answer.err
