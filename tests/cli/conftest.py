"""Two ways to run a command line: in this process, for the many, and in one of its own."""

from __future__ import annotations

import csv
import io
import json
import os
import re
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np
import pytest

import robokin
from robokin.cli import run as run_here

EXCERPT = re.compile(r"\n +[0-9]+ \| .*\n +\| +\^~*(?=\n|$)")
"""The line of a description that an error shows, and the mark below it."""

PROGRAM = [sys.executable, "-c", "from robokin.cli import main; main()"]


@dataclass(frozen=True)
class Answer:
    """What a command line wrote, and its status."""

    status: int
    out: bytes
    err: str

    @property
    def text(self) -> str:
        return self.out.decode()

    @property
    def lines(self) -> list[str]:
        return self.text.splitlines()

    @property
    def json(self) -> Any:
        """The document, which holds nothing but JSON."""
        return strict_json(self.text)

    @property
    def jsonl(self) -> list[Any]:
        return [strict_json(line) for line in self.lines]

    @property
    def csv(self) -> list[list[str]]:
        return list(csv.reader(io.StringIO(self.text)))

    @property
    def columns(self) -> list[str]:
        return self.csv[0]

    @property
    def numbers(self) -> np.ndarray:
        """The rows of a CSV below its header."""
        return np.array([[float(cell) for cell in row] for row in self.csv[1:]]).reshape(-1, len(self.columns))

    def numbers_of(self, column: str) -> list[float]:
        """A column of a CSV."""
        place = self.columns.index(column)
        return [float(row[place]) for row in self.csv[1:]]


def strict_json(text: str) -> Any:
    """A JSON document without the words that Python also reads."""

    def refuse(word: str) -> Any:
        raise AssertionError(f"{word} is no JSON")

    return json.loads(text, parse_constant=refuse)


def invoke(*arguments: str, stdin: bytes = b"") -> Answer:
    """Run a command line in this process."""
    out, err = io.TextIOWrapper(io.BytesIO(), encoding="utf-8"), io.StringIO()
    source = io.TextIOWrapper(io.BytesIO(stdin), encoding="utf-8")
    with (
        mock.patch.multiple(sys, stdin=source, stdout=out, stderr=err),
        mock.patch.dict(os.environ, {"COLUMNS": "80"}),
    ):
        status = run_here([str(argument) for argument in arguments])
        out.flush()
    return Answer(status, out.buffer.getvalue(), err.getvalue())


@pytest.fixture
def call() -> Callable[..., Answer]:
    """Run a command line in this process."""
    return invoke


@pytest.fixture
def run(tmp_path: Path) -> Callable[..., Answer]:
    """Run a command line in a process of its own."""

    def run(*arguments: str, stdin: bytes = b"", **options: Any) -> Answer:
        options = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "input": stdin, **options}
        done = subprocess.run([*PROGRAM, *map(str, arguments)], env=environment(), check=False, timeout=60, **options)
        return Answer(done.returncode, done.stdout or b"", (done.stderr or b"").decode())

    return run


def environment(**more: str) -> dict[str, str]:
    """An environment in which nothing asks for colour or a width."""
    kept = {name: value for name, value in os.environ.items() if name not in ("COLUMNS", "NO_COLOR", "FORCE_COLOR")}
    return {**kept, **more}


def refused(answer: Answer, *fragments: str, status: int = 2) -> None:
    """Whether a command line ended with a sentence on stderr that says all of this, and nothing else."""
    assert answer.status == status, answer
    assert answer.out == b""
    sentence, rest = answer.err.rstrip("\n"), answer.err[len(answer.err.rstrip("\n")) :]
    assert sentence.startswith("robokin: "), answer.err
    assert rest == "\n"
    if EXCERPT.search(sentence):  # a mistake in a description is shown with its line, and so are those after it
        sentence = EXCERPT.sub("", sentence)
    assert "\n" not in sentence
    assert "Traceback" not in sentence
    for fragment in fragments:
        assert fragment in sentence, (fragment, sentence)


def poses_of(name: str, q: Any, **parameters: Any) -> np.ndarray:
    """The poses of a robot of the library at q in its own units, in its own units, as the package computes them."""
    robot = robokin.load(name, **parameters)
    factors = np.where(robot.revolute, robot.units.radians, robot.units.metres)
    T = robokin.forward_kinematics(robot, np.asarray(q, dtype=float) * factors)
    T[..., :3, 3] /= robot.units.metres
    return T + 0.0
