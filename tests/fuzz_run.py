"""Runs hostile calls in a process that may hang or die, and says what was wrong with what came of them."""

from __future__ import annotations

import contextlib
import functools
import io
import json
import multiprocessing
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
import traceback
import warnings
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any
from unittest import mock

from fuzz_calls import Call
from fuzz_files import FOLDER, KINDS

STATUSES = {0, 2, 3, 130}

SOFT, HARD = 15.0, 60.0
"""Seconds of a call: of processor time before it is a finding, of any time before it is ended."""

MEMORY = 6 << 30
"""Bytes that a process may take, so that a finding does not take the machine's."""

RENEWED = 2000
"""Calls after which a process is replaced by a fresh one."""

PROGRAM = [sys.executable, "-c", "from robokin.cli import main; main()"]

ROOT = Path(__file__).parent.parent


@dataclass(frozen=True)
class Outcome:
    """What came of a call: no status where it crashed or was ended."""

    status: int | None
    out: bytes
    err: str
    seconds: float
    crash: str = ""
    place: str = ""
    left: tuple[str, ...] = ()

    @property
    def shape(self) -> tuple[object, ...]:
        """What calls that are answered in the same way have in common."""
        sentence = re.sub(r"'[^']*'|\"[^\"]*\"|[\d.,e+-]+|\S+\.\w+", "#", self.err[:300])
        return self.status, sentence, self.place, len(self.out).bit_length()


class Worker:
    """A process that runs one call after another."""

    def __init__(self) -> None:
        self.call: Call | None = None
        self.folder = tempfile.TemporaryDirectory()
        self.start()

    def start(self) -> None:
        """Start the process."""
        context = multiprocessing.get_context("fork")
        self.pipe, theirs = context.Pipe()
        self.process = context.Process(target=serve, args=(theirs, Path(self.folder.name)), daemon=False)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)  # of threads beside a fork: none of them is used in it
            self.process.start()
        theirs.close()
        self.done = 0

    def ask(self, call: Call) -> None:
        """Have a call run; `answer` gives what comes of it."""
        if self.done >= RENEWED:
            self.stop()
            self.start()
        self.call, self.since = call, time.monotonic()
        self.pipe.send(call)

    def answer(self) -> Outcome | None:
        """What came of the call, None while it runs. One that hangs or kills its process is over, too."""
        seconds = time.monotonic() - self.since
        if self.pipe.poll():
            try:
                self.done += 1
                outcome: Outcome = self.pipe.recv()
                return outcome
            except EOFError:
                self.process.join()
                ended = f"the process ended with {self.process.exitcode}"
                self.start()
                return Outcome(None, b"", "", seconds, ended, "killed")
        if seconds < HARD:
            return None
        self.stop()
        self.start()
        return Outcome(None, b"", "", seconds, f"no end after {HARD:g} s", "hang")

    def end(self) -> None:
        """End the process, for good."""
        self.stop()
        self.folder.cleanup()

    def stop(self) -> None:
        """End the process."""
        self.process.kill()
        self.process.join()
        self.pipe.close()


def serve(pipe: Any, folder: Path) -> None:
    """Answer calls, in the worker's process."""
    with contextlib.suppress(ImportError, ValueError):
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    # What a command line is read with is made once and not for every call, which takes longer than most of them.
    from robokin.cli import app

    app.build = functools.cache(app.build)
    parent = os.getppid()
    (folder / FOLDER).mkdir(exist_ok=True)
    with contextlib.suppress(EOFError, BrokenPipeError):
        while os.getppid() == parent:  # else nobody asks any more
            if pipe.poll(1.0):
                pipe.send(outcome_of(pipe.recv(), folder))


def outcome_of(call: Call, folder: Path) -> Outcome:
    """Run a call in a folder that holds its files and nothing else."""
    for name, data in call.files.items():
        if name in KINDS:
            path = folder / name
            path.parent.mkdir(exist_ok=True)
            path.write_bytes(data)
    os.chdir(folder)
    outcome = (in_a_process if call.own_process else in_this_process)(call)
    there = {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()}
    for entry in folder.iterdir():
        if entry.name != FOLDER:
            shutil.rmtree(entry) if entry.is_dir() else entry.unlink()
    strange = {name for name in there - call.files.keys() if not any(name in word for word in call.arguments[1:])}
    return replace(outcome, left=tuple(sorted(strange)))


class Screen(io.TextIOWrapper):
    """A stream that says whether it is a terminal."""

    terminal = False

    def isatty(self) -> bool:
        return self.terminal


def in_this_process(call: Call) -> Outcome:
    """Run a call with streams of its own."""
    from robokin.cli import run

    encoding = "ascii" if call.environment.get("LANG") == "C" or "PYTHONIOENCODING" in call.environment else "utf-8"
    out = Screen(io.BytesIO(), encoding=encoding, errors="strict")
    err = Screen(io.BytesIO(), encoding=encoding, errors="backslashreplace")
    source = Screen(io.BytesIO(call.stdin), encoding="utf-8")
    out.terminal = err.terminal = call.terminal
    streams = {"stdin": source, "stdout": out, "stderr": err, **dict.fromkeys(call.closed)}
    status: int | None = None
    crash = place = ""
    start = time.process_time()
    with (
        mock.patch.multiple(sys, **streams),
        mock.patch.dict(os.environ, {**environment(), **call.environment}),
        warnings.catch_warnings(),
    ):
        warnings.simplefilter("always")
        try:
            status = run(list(call.arguments))
            out.flush()
        except BaseException as error:
            crash = "".join(traceback.format_exception(error))
            place = f"{type(error).__name__} at {where(error)}"
    seconds = time.process_time() - start
    err.flush()
    return Outcome(status, out.buffer.getvalue(), err.buffer.getvalue().decode(errors="replace"), seconds, crash, place)


def environment() -> dict[str, str]:
    """What is the same for all calls."""
    return {"COLUMNS": "80", "NO_COLOR": "", "TERM": "xterm"}


def where(error: BaseException) -> str:
    """The innermost place in robokin."""
    frames = [frame for frame in traceback.extract_tb(error.__traceback__) if "/robokin/" in frame.filename]
    return f"{frames[-1].filename.rpartition('/robokin/')[2]}:{frames[-1].name}" if frames else "no place in robokin"


def in_a_process(call: Call) -> Outcome:
    """Run a call in a process of its own, with closed descriptors where it asks for them."""
    numbers = [("stdin", "stdout", "stderr").index(name) for name in call.closed]

    def close() -> None:
        for number in numbers:
            os.close(number)

    start = time.monotonic()
    surroundings = {
        **os.environ,
        **environment(),
        **call.environment,
        "PYTHONPATH": str(ROOT),
        "PYTHONWARNINGS": "always",
    }
    try:
        done = subprocess.run(
            [*PROGRAM, *call.arguments], input=call.stdin, capture_output=True, env=surroundings, preexec_fn=close,
            timeout=HARD - 5.0, check=False,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        return Outcome(None, b"", "", HARD, "no end", "hang")
    err = done.stderr.decode(errors="replace")
    place = f"Traceback: {err.strip().splitlines()[-1][:80]}" if "Traceback (most" in err else ""
    return Outcome(done.returncode, done.stdout, err, min(time.monotonic() - start, SOFT), "", place)


CLEARED = "\x1b[K"
"""What clears the rest of a terminal's line."""


def faults(call: Call, outcome: Outcome) -> Iterator[str]:
    """What is wrong with what came of a call: a name for each kind."""
    command, err = call.arguments[0], outcome.err
    if outcome.place:
        yield f"{outcome.place}" if outcome.place not in ("hang", "killed") else f"{outcome.place}: {call.command}"
        return
    if outcome.status not in STATUSES:
        yield f"status {outcome.status}: {command}"
    if outcome.seconds > SOFT:
        yield f"slow: {call.command}"
    if found := re.search(r"\w*Warning\b[^\n]{0,60}", err):
        yield f"warning: {found[0]}"
    if outcome.status == 2 and not err and "stderr" not in call.closed and command not in ("validate", "check"):
        yield f"status 2 without a sentence: {command}"
    # The line that says how far long work is clears itself; a CSV for programs keeps names as they are.
    text = err.replace(CLEARED, "") if call.terminal else err
    raw = b"\x1b" in outcome.out and not call.terminal and "csv" not in call.arguments
    if "\x1b" in text or raw:
        yield f"steering characters: {call.command}"
    if outcome.left:
        yield f"left behind: {call.command}"
    if asks_json(call) and outcome.out[:1] in (b"{", b"[") and not is_json(outcome.out):
        yield f"no JSON: {call.command}"


def asks_json(call: Call) -> bool:
    """Whether a call asks for JSON on standard output."""
    return bool({"--json", "json", "jsonl"} & {*call.arguments}) and "stdout" not in call.closed


def is_json(out: bytes) -> bool:
    """Whether an output is a document, or one on each line, without NaN and Infinity."""

    def refuse(word: str) -> Any:
        raise ValueError(word)

    def read(text: str) -> bool:
        try:
            json.loads(text, parse_constant=refuse)
        except ValueError:
            return False
        return True

    text = out.decode(errors="replace")
    return read(text) or all(read(line) for line in text.splitlines())
