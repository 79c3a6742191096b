"""`--cores`: on several cores the same bytes, notes and status come out as on one."""

from __future__ import annotations

import json
import os
import pathlib
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

import robokin
from robokin.cli import cores as cores_module
from robokin.tables import text_source

from .conftest import PROGRAM


@pytest.fixture(autouse=True)
def small_is_long(monkeypatch):
    """Files of a few rows have several blocks, and are worth several cores."""
    monkeypatch.setattr(text_source, "CHUNK", 1 << 10)
    for name in ("robokin.cli.commands.fk_command.MANY", "robokin.cli.commands.ik_command.SOME"):
        monkeypatch.setattr(name, 0)


@pytest.fixture
def joints(tmp_path, rng):
    """Joint values of the PUMA 560 [deg], some outside the limits, a time in front and a name behind."""
    low, high = np.degrees(robokin.load("puma560").limits).T
    rows = rng.uniform(low, high, (40, 6))
    rows[31, 0] = 175.0
    path = tmp_path / "joints.csv"
    lines = [f"{0.1 * i:g},{','.join(map(repr, row))},p{i}\n" for i, row in enumerate(rows.tolist())]
    path.write_text("t,q1,q2,q3,q4,q5,q6,name\n" + "".join(lines))
    return path


@pytest.fixture
def poses(joints, call, tmp_path):
    path = tmp_path / "poses.csv"
    text = call("fk", "puma560", "-i", str(joints), "-f", "csv").text.splitlines()
    assert text[0].startswith("t,name,")
    far = ["7,far", *["9e3"] * (text[0].count(",") - 1)]
    path.write_text("\n".join([*text, ",".join(far)]) + "\n")
    return path


def as_on_one_core(call, *words):
    one, two = (call(*words, "--cores", cores) for cores in ("1", "2"))
    assert (two.out, two.err, two.status) == (one.out, one.err, one.status)
    return one


@pytest.mark.parametrize("kind", ["csv", "jsonl", "json", "table"])
@pytest.mark.parametrize("more", [("--as", "matrix"), ("--drop",)], ids=" ".join)
def test_poses_are_the_same(kind, more, call, joints):
    answer = as_on_one_core(call, "fk", "puma560", "-i", str(joints), "-f", kind, *more)
    assert answer.status == 0 and "1 of 40 configurations is outside" in answer.err
    if kind == "json":
        assert [document.get("name") for document in json.loads(answer.text)] == [
            None if more == ("--drop",) else f"p{i}" for i in range(40)
        ]


@pytest.mark.parametrize(
    ("kind", "more"),
    [
        ("csv", ("--turns",)),
        ("csv", ("--tol-position", "1")),
        ("jsonl", ("--hold", "q6=0")),
        ("json", ("--max", "2")),
        ("table", ()),
    ],
    ids=str,
)
def test_solutions_are_the_same(kind, more, call, poses):
    answer = as_on_one_core(call, "ik", "puma560", "-i", str(poses), "-f", kind, *more)
    assert answer.status == 3 and "of 41 targets" in answer.err
    if kind == "csv":
        last = answer.text.splitlines()[-1]
        assert last.startswith("7,far,41,0,")


@pytest.mark.parametrize(("command", "kind"), [("fk", "csv"), ("fk", "json"), ("ik", "jsonl")])
def test_documents_and_what_they_carry_are_the_same(command, kind, call, joints, tmp_path):
    path = tmp_path / "documents.jsonl"
    path.write_bytes(call("fk", "puma560", "-i", str(joints), "-f", "jsonl").out)
    assert as_on_one_core(call, command, "puma560", "-i", str(path), "-f", kind).status == 0


@pytest.mark.parametrize("kind", ["csv", "jsonl", "json", "table"])
@pytest.mark.parametrize("command", ["fk", "ik"])
def test_a_file_without_rows_is_the_same(command, kind, call, tmp_path):
    path = tmp_path / "empty.csv"
    path.write_text("q1,q2,q3,q4,q5,q6\n" if command == "fk" else "x,y,z,roll,pitch,yaw\n")
    as_on_one_core(call, command, "puma560", "-i", str(path), "-f", kind)


@pytest.mark.parametrize("kind", ["csv", "json"])
def test_what_is_before_a_mistake_is_the_same(kind, call, joints):
    joints.write_text(joints.read_text().replace("p37\n", "p37,1,2\n"))
    answer = as_on_one_core(call, "fk", "puma560", "-i", str(joints), "-f", kind)
    assert answer.status == 2 and "line 39" in answer.err


def test_arrays_are_the_same(call, joints, tmp_path, monkeypatch):
    monkeypatch.setattr("robokin.tables.array_rows.ARRAY_ROWS", 7)
    rows = np.loadtxt(joints, delimiter=",", skiprows=1, usecols=range(1, 7))
    np.save(tmp_path / "joints.npy", rows)

    def array(cores):
        path = tmp_path / f"{cores}.npy"
        source = str(tmp_path / "joints.npy")
        assert "1 of 40 configurations" in call("fk", "puma560", "-i", source, "-o", str(path), "--cores", cores).err
        return path.read_bytes()

    assert array("1") == array("2")


def test_a_pose_that_is_no_number_is_said_in_its_turn(call, tmp_path):
    path = tmp_path / "far.csv"
    path.write_text("0,0\n" * 400 + "0,1e308\n" + "0,0\n" * 400)
    answer = as_on_one_core(call, "fk", "cylindrical", "-i", str(path), "-f", "csv")
    assert answer.status == 2


def test_marks_are_the_same(call, joints, tmp_path):
    answers = tmp_path / "answers.csv"
    answers.write_bytes(call("fk", "puma560", "-i", str(joints), "-f", "csv", "--drop").out)
    for kind in ("csv", "json", "table"):
        as_on_one_core(call, "check", "fk", "puma560", "-i", str(answers), "-f", kind)


def test_a_pipe_and_a_short_file_stay_in_this_process(joints):
    assert cores_module.cores_worth(None, str(joints), 1 << 20) == 1
    assert cores_module.cores_worth(4, str(joints), 1) == 4
    assert cores_module.cores_worth(4, "nowhere.csv", 0) == 1
    assert cores_module.cores_worth(4, None, 0) == 1


@pytest.mark.parametrize("command", ["fk", "ik"])
@pytest.mark.parametrize("cores", ["0", "-1", "2000", "two"])
def test_a_number_of_cores_is_whole(command, cores, call, joints):
    answer = call(command, "puma560", "-i", str(joints), f"--cores={cores}")
    assert answer.status == 2 and "--cores: found" in answer.err and "from 1 to 1024" in answer.err


@pytest.fixture
def long_file(tmp_path, rng):
    """Joint values of the PUMA 560 that take a while."""
    lines = [",".join(map(repr, row)) + "\n" for row in rng.uniform(-90.0, 90.0, (2000, 6)).tolist()]
    path = tmp_path / "long.csv"
    path.write_text("".join(lines) * 100)
    return path


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads the table of processes")
@pytest.mark.parametrize("output", [True, False])
def test_ctrl_c_ends_all_processes_and_leaves_no_file(output, long_file, tmp_path):
    words = ["fk", "puma560", "-i", str(long_file), "-f", "jsonl", "--cores", "2"]
    words += ["-o", str(tmp_path / "poses.jsonl")] if output else []
    with subprocess.Popen(
        [*PROGRAM, *words], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, start_new_session=True
    ) as process:
        while not pathlib.Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text():
            time.sleep(0.05)
        time.sleep(0.2)
        os.killpg(process.pid, signal.SIGINT)
        _, err = process.communicate(timeout=60)
    assert (process.returncode, err) == (130, b"robokin: interrupted\n")
    assert [path.name for path in tmp_path.iterdir()] == ["long.csv"]
    for _ in range(200):
        try:
            os.killpg(process.pid, 0)
        except ProcessLookupError:
            return
        time.sleep(0.05)
    pytest.fail("a worker outlived the program")
