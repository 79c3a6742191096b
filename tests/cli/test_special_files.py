"""What is no regular file: pipes, devices, links, descriptors, to read from and to write to; and closed streams."""

from __future__ import annotations

import contextlib
import itertools
import json
import os
import socket
import stat
import subprocess
import sys
import threading
from pathlib import Path

import pytest
from sweeps import sweep

from robokin.errors import OutputError
from robokin.files import descriptor_of
from robokin.tables.sink import sink

from .conftest import PROGRAM, environment, refused

pytestmark = pytest.mark.skipif(not Path("/dev/zero").exists(), reason="the devices of Unix")

Q = ["--q", "10,-20,30,40,-50,60"]
CHECK = ["check", "fk", "puma560", *Q, "--expect", "1,2,3"]
MATRIX = b"[[1,0,0,500],[0,1,0,149],[0,0,1,200],[0,0,0,1]]"


@contextlib.contextmanager
def fed(path, data):
    """A named pipe that somebody writes into."""
    os.mkfifo(path)
    writer = threading.Thread(target=lambda: path.write_bytes(data), daemon=True)
    writer.start()
    yield path
    writer.join(timeout=10)


@contextlib.contextmanager
def drained(path):
    """A named pipe that somebody reads; what comes is in the list afterwards."""
    os.mkfifo(path)
    read = []
    reader = threading.Thread(target=lambda: read.append(path.read_bytes()), daemon=True)
    reader.start()
    yield read
    reader.join(timeout=10)


def bind(path):
    """A socket in the folder."""
    with socket.socket(socket.AF_UNIX) as made:
        made.bind(path)


# Inputs ---------------------------------------------------------------------------------------------------

INPUTS = {
    "a matrix": ["ik", "puma560", "--matrix", "{}"],
    "configurations": ["fk", "puma560", "--input", "{}"],
    "targets": ["ik", "puma560", "--input", "{}"],
    "answers": ["check", "fk", "puma560", "--input", "{}"],
    "a key": ["check", "ik", "puma560", "--input", __file__, "--key", "{}"],
    "a description": ["show", "{}"],
    "a table": ["check", "dh", "{}", "--against", "puma560"],
    "what is right": ["check", "dh", "puma560", "--against", "{}"],
    "Jacobians": ["jacobian", "puma560", "--input", "{}"],
}


@pytest.mark.parametrize("command", INPUTS.values(), ids=INPUTS.keys())
@pytest.mark.parametrize(
    "source", sweep(["/dev/zero", "/dev/urandom", "/dev/null", ".", "none", "socket", "/proc/self/mem"], 3)
)
def test_every_input_is_bounded_and_ends_in_a_sentence(call, tmp_path, monkeypatch, command, source):
    monkeypatch.chdir(tmp_path)
    if source == "socket":
        bind("socket")
    path = source if "/" in source else f"./{source}"
    answer = call(*(part.format(path) for part in command))
    if source == "/dev/null" and "--input" in command and command[0] != "check":
        assert answer.status == 0
    else:
        assert answer.status in (2, 3)
        assert "Traceback" not in answer.err
    assert len(answer.err) < 1000


def test_a_matrix_comes_from_a_pipe_and_from_standard_input(call, tmp_path):
    expected = call("ik", "puma560", "--matrix", MATRIX.decode(), "--json").json["solutions"]
    for data in (MATRIX, MATRIX.replace(b"],", b"]\n,"), b"x,y,z,roll,pitch,yaw\n500,149,200,0,0,0\n"):
        with fed(tmp_path / "m.csv", data) as path:
            assert call("ik", "puma560", "--matrix", path, "--json").json["solutions"] == expected
        path.unlink()
        assert call("ik", "puma560", "--matrix", "-", "--json", stdin=data).json["solutions"] == expected


def test_a_file_of_a_matrix_is_a_page(call, tmp_path):
    path = tmp_path / "m.json"
    path.write_bytes(MATRIX + b" " * (1 << 20))
    refused(call("ik", "puma560", "--matrix", path), "found more than 1 MiB")


def test_a_description_comes_from_a_pipe(call, tmp_path):
    text = b"robokin: 1\nname: x\njoints: [{type: revolute, a: 1}]\n"
    with fed(tmp_path / "arm.yaml", text) as path:
        assert call("show", path, "--json").json["name"] == "x"


# Outputs --------------------------------------------------------------------------------------------------

OUTPUTS = {
    "rows": (["fk", "puma560", *Q, "-o", "{}"], "csv"),
    "an array": (["fk", "puma560", *Q, "-o", "{}"], "npy"),
    "all solutions": (["ik", "planar3r", "--xy", "1,1", "--phi", "30", "-o", "{}"], "npy"),
    "samples": (["workspace", "planar3r", "--samples", "100", "-o", "{}"], "csv"),
    "samples in an array": (["workspace", "planar3r", "--samples", "100", "-o", "{}"], "npy"),
    "marks": ([*CHECK, "--gradescope", "{}"], "json"),
    "a page": (["plot", "planar3r", "-o", "{}"], "html"),
    "a picture": (["workspace", "planar3r", "--samples", "512", "--plot", "{}"], "html"),
    "symbols": (["fk", "planar3r", "--symbolic", "--latex", "-o", "{}"], "tex"),
    "the schema": (["schema", "-o", "{}"], "json"),
}


@pytest.mark.parametrize(("command", "ending"), OUTPUTS.values(), ids=OUTPUTS.keys())
def test_a_pipe_gets_what_a_file_gets_and_stays_a_pipe(call, tmp_path, command, ending):
    path, pipe = tmp_path / f"file.{ending}", tmp_path / f"pipe.{ending}"
    status = call(*(part.format(path) for part in command)).status
    with drained(pipe) as read:
        assert call(*(part.format(pipe) for part in command)).status == status
    assert read == [path.read_bytes()]
    assert stat.S_ISFIFO(pipe.stat().st_mode)
    assert sorted(entry.name for entry in tmp_path.iterdir()) == [path.name, pipe.name]


@pytest.mark.parametrize(("command", "ending"), OUTPUTS.values(), ids=OUTPUTS.keys())
def test_a_device_is_written_to_and_stays_a_device(call, tmp_path, command, ending):
    for device, status in (("/dev/null", (0, 3)), ("/dev/full", (2,))):
        link = tmp_path / f"{device[5:]}.{ending}"
        link.symlink_to(device)
        answer = call(*(part.format(link) for part in command))
        assert answer.status in status, answer
        assert link.is_symlink()
        assert stat.S_ISCHR(Path(device).stat().st_mode)
    assert "No space left on device" in answer.err
    assert answer.err.count("\n") == 1
    assert len([*tmp_path.iterdir()]) == 2


def test_links_to_descriptors_are_followed(run, tmp_path):
    assert json.loads(run(*CHECK, "--gradescope", "/dev/stdout", "-o", tmp_path / "m.json").out)["tests"]
    out = tmp_path / "out"
    with out.open("wb") as stream:
        stream.write(b"before\n")
        stream.flush()
        run(*CHECK, "--gradescope", "/dev/stdout", stdout=stream)
    text = out.read_text()
    assert text.startswith("before\n{"), "what was there stays"
    assert "0 of 1 answer right, score 0.00" in text.splitlines()[-1], "in order"
    (tmp_path / "link.csv").symlink_to("/dev/fd/1")
    assert run("fk", "puma560", *Q, "-o", tmp_path / "link.csv").out == run("fk", "puma560", *Q, "-f", "csv").out
    assert (tmp_path / "link.csv").is_symlink()


def test_which_paths_are_descriptors(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "7").write_text("")
    for name in ("7", "./7", "x", "", "/", "1/2", "\0", "x" * 5000):
        assert descriptor_of(name) is None
    assert descriptor_of("/dev/stdout") == 1
    assert descriptor_of(f"/proc/{os.getpid()}/fd/2") == 2
    Path("a").symlink_to("b")
    Path("b").symlink_to("a")
    assert descriptor_of("a") is None


def test_the_permissions_of_a_file_are_kept(call, tmp_path):
    path = tmp_path / "out.csv"
    for mode in (0o600, 0o664, 0o640):
        path.write_text("old")
        path.chmod(mode)
        call("fk", "puma560", *Q, "-o", path)
        assert stat.S_IMODE(path.stat().st_mode) == mode
        assert path.read_text().startswith("q1,")


def test_a_file_that_may_not_be_written_is_not_replaced(tmp_path, monkeypatch):
    path = tmp_path / "out.csv"
    path.write_text("old")
    monkeypatch.setattr(os, "access", lambda *asked: False)
    with pytest.raises(OutputError, match="Permission denied, expected a place"), sink(str(path)):
        raise AssertionError("nothing is computed for it")
    assert path.read_text() == "old"


@pytest.mark.parametrize(("command", "ending"), sweep(OUTPUTS.values(), 3), ids=OUTPUTS.keys())
def test_places_that_are_no_places(call, tmp_path, monkeypatch, command, ending):
    monkeypatch.chdir(tmp_path)
    bind(f"socket.{ending}")
    Path(f"folder.{ending}").mkdir()
    Path(f"loop.{ending}").symlink_to(f"loop.{ending}")
    for name in ("folder", "socket", "none/x", "loop", "x" * 300, f"folder.{ending}/none/x"):
        answer = call(*(part.format(f"{name}.{ending}") for part in command))
        refused(answer, name[:50], "expected a place that can be written")
    assert len([*tmp_path.iterdir()]) == 3


def test_a_pipe_is_not_resumed(call, tmp_path):
    os.mkfifo(tmp_path / "c.csv")
    refused(call("workspace", "planar3r", "--samples", "9", "-o", tmp_path / "c.csv", "--resume"), "expected a file")


# Closed streams -------------------------------------------------------------------------------------------

CLOSED = ["list", "list -f csv", "show four-bar", "dof four-bar", "fk puma560 --q home --json", "--help", "-h",
          "check fk puma560 --q home --expect 1,2,3", "frame Rot(z,30)", "", "workspace planar3r --samples 512",
          "validate puma560", "nonsense"]  # fmt: skip


@pytest.mark.parametrize("command", sweep(CLOSED, 4))
def test_streams_that_are_closed_bring_no_traceback(tmp_path, command):
    kinds = [part for count in (1, 2, 3) for part in itertools.combinations(("<&-", ">&-", "2>&-"), count)]
    kinds = kinds if command == "list" else [(">&-",), ("<&-", ">&-", "2>&-")]
    for closed in kinds:
        line = f'"$0" -c "$1" {command.replace("(", chr(92) + "(").replace(")", chr(92) + ")")} {" ".join(closed)}'
        done = subprocess.run(
            ["sh", "-c", line, sys.executable, PROGRAM[-1]], capture_output=True, text=True, check=False,
            env=environment(), cwd=tmp_path, timeout=60,
        )  # fmt: skip
        assert "Traceback" not in done.stderr + done.stdout
        right = 0 if command not in ("", "nonsense") else 2
        assert done.returncode == (2 if ">&-" in closed else right), (closed, done)
        if closed == (">&-",) and right == 0:
            assert done.stderr == "robokin: standard output is closed, expected a place that can be written\n"


def test_a_file_is_written_though_standard_output_is_closed(tmp_path):
    line = '"$0" -c "$1" fk puma560 --q home -o out.csv >&- 2>&-'
    done = subprocess.run(["sh", "-c", line, *PROGRAM[::2]], check=False, env=environment(), cwd=tmp_path)
    assert done.returncode == 0
    assert (tmp_path / "out.csv").read_text().startswith("q1,")
    line = '"$0" -c "$1" check fk puma560 --q home --expect 1,2,3 --gradescope /dev/stdout -o x.csv >&-'
    done = subprocess.run(["sh", "-c", line, *PROGRAM[::2]], check=False, env=environment(), cwd=tmp_path)
    assert done.returncode == 2
