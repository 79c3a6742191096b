"""Requests to end, at any moment: the status is 128 + the signal's number, nothing half written stays, nothing is said
but that it was interrupted."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time

import pytest
from sweeps import sweep

from .conftest import environment

pytestmark = pytest.mark.skipif(os.name != "posix", reason="signals")

SIGNALS = {signal.SIGINT: 130, signal.SIGTERM: 143, signal.SIGHUP: 129}

READY = """\
import os, signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)
for number in (signal.SIGTERM, signal.SIGHUP):  # nohup has the tests' own process ignore it
    signal.signal(number, signal.SIG_DFL)
import robokin.cli.interruptions as interruptions
heed = interruptions.heed
def heeded():
    heed()
    os.write(9, b"x")
interruptions.heed = heeded
from robokin.cli import main
main()
"""
"""The command line, which writes to descriptor 9 as soon as it heeds requests."""


def started(*arguments, folder, code=READY):
    """A process, and what is read from it when it heeds requests to end."""
    reader, writer = os.pipe()

    def ready():
        os.dup2(writer, 9)

    process = subprocess.Popen(
        [sys.executable, "-c", code, *arguments], cwd=folder, env=environment(), pass_fds=(9,), preexec_fn=ready,
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip
    os.close(writer)
    assert os.read(reader, 1) == b"x"
    os.close(reader)
    return process


def ended(process):
    """Its status; one that does not end is killed, so that nobody waits for it."""
    try:
        return process.wait(timeout=60)
    finally:
        process.kill()


COMMANDS = [
    ["fk", "puma560", "--q", "home", "-o", "out.csv"],
    ["list", "-o", "out.json"],
    ["workspace", "planar3r", "--samples", "65536", "-o", "out.npy"],
    ["check", "fk", "puma560", "--q", "home", "--expect", "1,2,3", "--gradescope", "out.json"],
]


@pytest.mark.parametrize("number", sweep(SIGNALS, 3))
def test_at_any_moment(tmp_path, number):
    """From the first moment on: while modules are imported, while it works, while it ends."""
    for i, pause in enumerate([0.0, 0.0, 0.01, 0.03, 0.06, 0.1, 0.15, 0.25]):
        folder = tmp_path / str(i)
        folder.mkdir()
        with started(*COMMANDS[i % len(COMMANDS)], folder=folder) as process:
            time.sleep(pause)
            process.send_signal(number)
            out, err = process.communicate(timeout=60)
        status, words = process.returncode, err.decode()
        files = [entry.name for entry in folder.iterdir()]
        if status in (0, 3):  # it was done before
            assert files == [COMMANDS[i % len(COMMANDS)][-1]]
            continue
        assert status == SIGNALS[number], words
        assert files in ([], ["out.npy.part", "out.npy.part.json"], ["out.npy.part.json", "out.npy.part"],
                         [COMMANDS[i % len(COMMANDS)][-1]])  # fmt: skip
        said = ["robokin: interrupted"] if number == signal.SIGINT else []
        assert [line for line in words.splitlines() if not line.startswith("robokin: --output")] == said
        assert b"Traceback" not in out


@pytest.mark.parametrize("number", sweep(SIGNALS, 3))
@pytest.mark.parametrize(
    "command",
    [["show", "./pipe"], ["fk", "puma560", "-i", "pipe"], ["ik", "puma560", "--matrix", "pipe"],
     ["check", "fk", "puma560", "-i", "pipe"], ["schema", "-o", "pipe.json"], ["fk", "puma560", "--q", "-"]],
    ids=" ".join,
)  # fmt: skip
def test_while_it_waits_for_the_other_end_of_a_pipe(tmp_path, command, number):
    for name in ("pipe", "pipe.json"):
        os.mkfifo(tmp_path / name)
    if number == signal.SIGHUP and command[0] != "show":
        pytest.skip("as the others")
    with started(*command, folder=tmp_path) as process:
        time.sleep(0.3)
        process.send_signal(number)
        assert ended(process) == SIGNALS[number]


def test_a_request_that_was_switched_off_stays_off(tmp_path):
    code = READY.replace("signal.default_int_handler", "signal.SIG_IGN")
    with started("fk", "puma560", "--q", "-", "-f", "csv", folder=tmp_path, code=code) as process:
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(b"1,2,3,4,5,6\n", timeout=60)
    assert (process.returncode, err, out.count(b"\n")) == (0, b"", 2)


WITHIN = """\
import os, signal, sys
from robokin.cli import interruptions
from robokin.unfinished_work import in_order, unfinished
interruptions.heed()
def ask(): os.kill(os.getpid(), signal.SIGTERM)
try:
    with unfinished("half"):
        open("half", "w").close()
        {body}
except BaseException:
    interruptions.leave_if_asked()
    raise
"""


@pytest.mark.parametrize(
    "body",
    [
        "ask()",
        "ask()\n        ask()",
        "try: ask()\n        except BaseException: os.unlink('none')",
        "try: ask()\n        finally: raise ImportError('instead')",
        "class A:\n            def __del__(self): ask()\n        A(); print('not reached')",
        "import weakref\n        a = type('A', (), {})(); r = weakref.ref(a, lambda r: ask()); del a; print('not')",
    ],
    ids=["plain", "twice", "lost in an error", "lost in a finally", "in a finalizer", "in a callback"],
)
def test_a_request_holds_whatever_becomes_of_its_exception(tmp_path, body):
    done = subprocess.run(
        [sys.executable, "-c", WITHIN.format(body=body)], cwd=tmp_path, env=environment(), capture_output=True,
        check=False,
    )  # fmt: skip
    assert (done.returncode, done.stdout, done.stderr) == (143, b"", b"")
    assert not [*tmp_path.iterdir()]
