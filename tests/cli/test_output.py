"""Where output goes: files that are whole or absent, pipes that close, devices that are full, terminals."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from sweeps import sweep

from .conftest import PROGRAM, environment, refused

Q = ["--q", "10,-20,30,40,-50,60"]
ANSI = "\x1b"
BATCH = b"1,2,3,4,5,6\n" * 200


def entries(folder):
    return sorted(entry.name for entry in folder.iterdir())


# Files ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("ending", ["csv", "jsonl", "json"])
@pytest.mark.parametrize("q", [Q, [*Q, *Q], None], ids=["one", "several", "batch"])
def test_a_file_holds_what_the_format_prints(call, tmp_path, ending, q):
    arguments, stdin = (q, b"") if q else (["--q", "-"], BATCH)
    path = tmp_path / f"out.{ending}"
    answer = call("fk", "puma560", *arguments, "--output", path, stdin=stdin)
    assert (answer.status, answer.out, answer.err) == (0, b"", "")
    assert path.read_bytes() == call("fk", "puma560", *arguments, "-f", ending, stdin=stdin).out
    assert entries(tmp_path) == [path.name]


@pytest.mark.parametrize(("q", "count"), [(Q, 1), ([*Q, *Q], 2), (None, 200)], ids=["one", "several", "batch"])
def test_an_array_has_a_pose_for_each_configuration(call, tmp_path, q, count):
    arguments, stdin = (q, b"") if q else (["--q", "-"], BATCH)
    assert call("fk", "puma560", *arguments, "-o", tmp_path / "T.npy", stdin=stdin).status == 0
    documents = call("fk", "puma560", *arguments, "-f", "jsonl", stdin=stdin).jsonl
    assert np.load(tmp_path / "T.npy").tolist() == [document["pose"]["matrix"] for document in documents]
    assert len(documents) == count


@pytest.mark.parametrize("command", [["list"], ["show", "puma560"], ["validate", "puma560"], ["frame", "Rot(z,30)"]])
@pytest.mark.parametrize("ending", ["csv", "jsonl", "json"])
def test_every_command_writes_files(call, tmp_path, command, ending):
    path = tmp_path / f"out.{ending}"
    assert call(*command, "-o", path).status == 0
    assert path.read_bytes() == call(*command, "-f", ending).out


@pytest.mark.parametrize("command", [["list"], ["show", "puma560"], ["validate", "puma560"], ["schema"]])
def test_what_is_no_array_makes_none(call, tmp_path, command):
    refused(call(*command, "-o", tmp_path / "out.npy"), "expected", ".json")
    assert entries(tmp_path) == []


def test_an_ending_is_read_in_any_case(call, tmp_path):
    assert call("fk", "puma560", *Q, "-o", tmp_path / "OUT.CSV").status == 0
    assert (tmp_path / "OUT.CSV").read_bytes().startswith(b"q1,")


def test_an_existing_file_is_replaced_only_by_a_whole_one(call, tmp_path):
    path = tmp_path / "out.csv"
    path.write_text("kept\n")
    refused(call("fk", "puma560", "--q", "-", "-o", path, stdin=BATCH + b"1,2,x,4,5,6\n"), "line 201")
    assert path.read_text() == "kept\n"
    assert entries(tmp_path) == ["out.csv"]
    assert call("fk", "puma560", "--q", "-", "-o", path, stdin=BATCH).status == 0
    assert len(path.read_text().splitlines()) == 201


def test_the_input_may_be_the_output(call, tmp_path):
    path = tmp_path / "joints.csv"
    path.write_bytes(BATCH)
    assert call("fk", "puma560", "--input", path, "--output", path).status == 0
    assert len(path.read_text().splitlines()) == 201


def test_a_link_stays_a_link(call, tmp_path):
    (tmp_path / "far").mkdir()
    target, link = tmp_path / "far" / "out.csv", tmp_path / "link.csv"
    target.write_text("old\n")
    link.symlink_to(target)
    assert call("fk", "puma560", *Q, "-o", link).status == 0
    assert link.is_symlink()
    assert target.read_text().startswith("q1,")
    assert entries(tmp_path / "far") == ["out.csv"]


def test_there_must_be_a_place_to_write(call, tmp_path):
    refused(call("fk", "puma560", *Q, "-o", tmp_path / "none" / "out.csv"), "--output", "No such file", "expected")
    (tmp_path / "out.csv").mkdir()
    refused(call("fk", "puma560", *Q, "-o", tmp_path / "out.csv"), "found a directory", "expected")
    assert entries(tmp_path) == ["out.csv"]


@pytest.mark.skipif(os.name != "posix" or os.geteuid() == 0, reason="root may write anywhere")
def test_a_folder_that_may_not_be_written(call, tmp_path):
    folder = tmp_path / "locked"
    folder.mkdir()
    folder.chmod(0o500)
    refused(call("fk", "puma560", *Q, "-o", folder / "out.csv"), "Permission denied", "expected")


@pytest.mark.parametrize("name", ["out", "out.txt", "out.xlsx", "-", "csv"])
def test_an_ending_that_says_nothing(call, name):
    refused(call("fk", "puma560", *Q, "-o", name), f"found '{name}'", "expected", ".csv, .jsonl, .json, .npy, .parquet")


def test_ending_and_format_may_agree_but_not_differ(call, tmp_path):
    path = tmp_path / "out.json"
    assert call("fk", "puma560", *Q, "-o", path, "--json").status == 0
    assert json.loads(path.read_text())["robot"] == "puma560"
    for chosen in (["-f", "csv"], ["-f", "table"], ["-f", "jsonl"]):
        refused(call("fk", "puma560", *Q, "-o", tmp_path / "other.json", *chosen), "expected one of them")
    assert entries(tmp_path) == ["out.json"]


# Full devices, closed pipes, closed streams --------------------------------------------------------------


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full")
@pytest.mark.parametrize(
    "command", sweep(["list", "fk puma560 --q home --json", "frame Rot(z,30)", "fk puma560 --q -", "-h"], 3)
)
def test_a_full_device_is_said_once(run, command):
    with Path("/dev/full").open("wb") as full:
        answer = run(*command.split(), stdin=BATCH, stdout=full)
    assert answer.status == 2
    assert answer.err.startswith("robokin: standard output: No space left on device")
    assert answer.err.count("\n") == 1


@pytest.mark.parametrize("form", ["csv", "json"])
def test_a_closed_pipe_ends_quietly(tmp_path, form):
    source = tmp_path / "joints.csv"
    source.write_bytes(BATCH * 200)
    command = [*PROGRAM, "fk", "puma560", "--input", source, "-f", form]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=environment()) as process:
        assert process.stdout is not None and process.stderr is not None
        assert process.stdout.readline()
        process.stdout.close()
        assert process.wait(timeout=60) == 0
        assert process.stderr.read() == b""


@pytest.mark.parametrize("command", ["--help", "list", "fk --help", "list --json", "fk puma560 --q home"])
def test_nobody_reads(command):
    reader, writer = os.pipe()
    os.close(reader)
    with os.fdopen(writer, "wb") as closed:
        done = subprocess.run(
            [*PROGRAM, *command.split()], stdout=closed, stderr=subprocess.PIPE, env=environment(), check=False
        )
    assert (done.returncode, done.stderr) == (0, b"")


@pytest.mark.skipif(os.name != "posix", reason="the shell closes the streams")
@pytest.mark.parametrize(
    ("command", "closed", "status", "sentence"),
    sweep(
        [
            ("list", ">&-", 2, "standard output is closed"),
            ("fk puma560 --q home", ">&-", 2, "standard output is closed"),
            ("fk puma560 --q -", "<&-", 2, "standard input is closed"),
            ("fk puma560 --q home", "<&-", 0, ""),
            ("--version", ">&-", 2, "standard output is closed"),
        ],
        3,
    ),
)
def test_a_stream_may_be_closed_from_the_start(tmp_path, command, closed, status, sentence):
    line = f'"$0" -c "$1" {command} {closed}'
    done = subprocess.run(
        ["sh", "-c", line, sys.executable, PROGRAM[-1]], capture_output=True, text=True, check=False, env=environment()
    )
    assert done.returncode == status
    assert sentence in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.skipif(os.name != "posix", reason="the shell closes the streams")
def test_a_closed_stderr_puts_no_message_among_the_data():
    line = '"$0" -c "$1" fk puma560 --q 170,0,0,0,0,0 --json 2>&-'
    done = subprocess.run(["sh", "-c", line, *PROGRAM[::2]], capture_output=True, text=True, check=False)
    assert (done.returncode, json.loads(done.stdout)["within_limits"]) == (0, False)


# Interruptions -------------------------------------------------------------------------------------------

INTERRUPTIBLE = [sys.executable, "-c", "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)\n"
                 "from robokin.cli import main; main()"]  # fmt: skip
"""A process started in the background inherits that Ctrl-C is ignored."""


@pytest.mark.skipif(os.name != "posix", reason="signals")
@pytest.mark.parametrize("ending", ["csv", "npy"])
@pytest.mark.parametrize(("number", "status"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_an_interruption_leaves_no_file(tmp_path, ending, number, status):
    path = tmp_path / f"out.{ending}"
    command = [*INTERRUPTIBLE, "fk", "puma560", "--q", "-", "-o", str(path)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE, env=environment()) as process:
        assert process.stdin is not None and process.stderr is not None
        process.stdin.write(BATCH)
        process.stdin.flush()
        while not any(entry.stat().st_size for entry in tmp_path.iterdir()):
            assert process.poll() is None
            time.sleep(0.01)
        process.send_signal(number)
        assert process.wait(timeout=60) == status
        assert process.stderr.read() == (b"robokin: interrupted\n" if number == signal.SIGINT else b"")
    assert entries(tmp_path) == []


@pytest.mark.skipif(os.name != "posix", reason="signals")
def test_ctrl_c_on_the_way_to_standard_output():
    command = [*INTERRUPTIBLE, "fk", "puma560", "--q", "-", "-f", "csv"]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=environment()
    ) as process:
        assert process.stdin is not None and process.stdout is not None and process.stderr is not None
        process.stdin.write(b"1,2,3,4,5,6\n")
        process.stdin.flush()
        process.stdout.readline()
        process.stdout.readline()
        process.send_signal(signal.SIGINT)
        assert process.wait(timeout=60) == 130
        assert process.stderr.read() == b"robokin: interrupted\n"


# Tables --------------------------------------------------------------------------------------------------

TABLES = [
    ["list"],
    ["fk", "puma560", *Q],
    ["fk", "puma560", *Q, *Q, "--as", "matrix"],
    ["fk", "puma560", *Q, *Q, "--as", "quaternion", "--length", "in"],
    ["fk", "crx30ia", *Q, *Q, "--as", "euler"],
    ["fk", "human-body", "--q", "-17.123456789 " * 21, "--frames"],
    ["fk", "human-body", "--q", "-17.123456789 " * 21, "--q", "1 " * 21, "--frames"],
    ["frame", "Trans(12345.678901,-1/3,7) Rot([1,2,3],33)", "--length", "mm"],
    ["frame", "Trans(1,2,3) " * 10],
]


@pytest.mark.parametrize("command", TABLES, ids=lambda command: " ".join(command)[:40])
def test_a_table_is_plain_whole_and_fits_a_page(call, command):
    text = call(*command).text
    assert ANSI not in text
    assert "…" not in text
    lines = text.splitlines()
    assert lines == [line.rstrip() for line in lines]
    title = "Trans(1,2,3) " * 10  # a long title is what the user typed
    assert max(len(line) for line in lines if not line.startswith(title[:40])) <= 80
    assert text.endswith("\n")


def test_colour_is_not_forced_into_a_pipe(run):
    env = environment(FORCE_COLOR="1", TERM="xterm-256color", COLORTERM="truecolor")
    done = subprocess.run([*PROGRAM, "show", "puma560"], capture_output=True, check=True, env=env)
    assert ANSI.encode() not in done.stdout


def on_a_terminal(*command, **more):
    """What a command line writes to a terminal of 80 columns."""
    pty = pytest.importorskip("pty")
    ours, theirs = pty.openpty()
    env = environment(TERM="xterm-256color", COLUMNS="80", **more)
    with subprocess.Popen([*PROGRAM, *command], stdout=theirs, stderr=subprocess.PIPE, env=env) as process:
        os.close(theirs)
        pieces = []
        while True:
            try:
                piece = os.read(ours, 1 << 16)
            except OSError:  # the other end is closed
                break
            if not piece:
                break
            pieces.append(piece)
        assert process.wait(timeout=60) == 0
    os.close(ours)
    return b"".join(pieces).decode().replace("\r\n", "\n")


@pytest.mark.parametrize("command", [["show", "puma560"], ["list", "kuka"], ["fk", "puma560", *Q]])
def test_a_terminal_gets_colour_and_the_same_words(call, command):
    text = on_a_terminal(*command)
    assert ANSI in text
    plain = re.sub(r"\x1b\[[\d;]*m", "", text)
    assert [line.rstrip() for line in plain.splitlines()] == call(*command).lines


def test_no_color_is_heeded():
    text = on_a_terminal("show", "puma560", NO_COLOR="1")
    assert not re.search(r"\x1b\[[\d;]*3\dm", text)


def test_programs_formats_are_the_same_on_a_terminal(call):
    for form in ("json", "csv"):
        assert on_a_terminal("fk", "puma560", *Q, "-f", form) == call("fk", "puma560", *Q, "-f", form).text
