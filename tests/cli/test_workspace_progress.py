"""Long work of `robokin workspace` shows its stage on a terminal, and Ctrl-C says what was done."""

from __future__ import annotations

import os
import select
import signal
import subprocess
import sys
import time

import pytest

from .conftest import environment

pytestmark = pytest.mark.skipif(os.name != "posix", reason="terminals and signals")

PROGRAM = [sys.executable, "-c", "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)\n"
           "from robokin.cli import main; main()"]  # fmt: skip

LONG = ("workspace", "panda", "--dextrous", "--samples", "30000", "--cores", "1")


def interrupted(terminal, ready):
    """What stderr says until Ctrl-C, which comes when `ready` says so of it, and after; and the status."""
    reading, writing = os.openpty() if terminal else os.pipe()
    said, start = b"", time.monotonic()
    with subprocess.Popen([*PROGRAM, *LONG], stdout=subprocess.DEVNULL, stderr=writing, env=environment()) as process:
        os.close(writing)
        sent = False
        while time.monotonic() - start < 60.0:
            if select.select([reading], [], [], 0.1)[0]:
                try:
                    data = os.read(reading, 4096)
                except OSError:
                    break
                if not data:
                    break
                said += data
            if not sent and ready(said, time.monotonic() - start):
                process.send_signal(signal.SIGINT)
                sent = True
        status = process.wait(timeout=60)
    os.close(reading)
    return status, said.decode()


def test_a_terminal_sees_the_stage_and_ctrl_c_what_was_done():
    status, said = interrupted(True, lambda said, _: b"map of the orientations" in said)
    assert status == 130
    last = [line for line in said.replace("\r\x1b[K", "\n").splitlines() if line.startswith("robokin: ")]
    assert last[-1] == "robokin: interrupted"
    assert "done: bounds, volume; not done: map of the orientations" in last[-2]


def test_without_a_terminal_nothing_is_shown_before_ctrl_c():
    status, said = interrupted(False, lambda _, seconds: seconds > 4.0)
    assert status == 130
    assert "\x1b" not in said
    assert said.endswith("robokin: interrupted\n")
    assert len(said.splitlines()) <= 2
