"""How long a command takes to start, against a Typer program that does next to nothing."""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from benchmarks.machine import line

RUNS = 15

BARE = """
import numpy
import typer
import yaml

app = typer.Typer()


@app.command()
def main(name: str = "world") -> None:
    print("hello", name, numpy.pi, yaml.__version__)


app()
"""

POSE = "Trans(300,400,500) RPY(10,20,30)"
Q = "90,0,90,0,0,0"
ROBOKIN = "from robokin.cli import main; main()"

COMMANDS = {
    "robokin fk puma560 --q …": (["fk", "puma560", "--q", Q], 0.65),
    "robokin fk puma560 --q … --json": (["fk", "puma560", "--q", Q, "--json"], 0.5),
    "robokin ik puma560 --pose …": (["ik", "puma560", "--pose", POSE], 0.95),
    "robokin list": (["list"], 0.6),
    "robokin --help": (["--help"], 1.15),
}
"""Command lines, and how much of the bare program's time each may take."""

QUESTIONS = 2000
"""Questions to one server."""


def run() -> None:
    print(f"start, medians of {RUNS} interleaved runs, ms")
    with tempfile.TemporaryDirectory() as folder:
        bare = Path(folder) / "bare.py"
        bare.write_text(BARE)
        first = "a Typer program that imports numpy and yaml"
        commands = {first: [str(bare)], **{name: ["-c", ROBOKIN, *words] for name, (words, _) in COMMANDS.items()}}
        # As it is installed: compiled once.
        environment = {**os.environ, "PYTHONPYCACHEPREFIX": folder}
        environment.pop("PYTHONDONTWRITEBYTECODE", None)
        taken: dict[str, list[float]] = {name: [] for name in commands}
        for i in range(RUNS + 1):
            for name, arguments in commands.items():
                start = time.perf_counter()
                subprocess.run([sys.executable, *arguments], stdout=subprocess.DEVNULL, check=True, env=environment)
                if i:  # the first one compiles
                    taken[name].append(time.perf_counter() - start)
    medians = {name: statistics.median(times) for name, times in taken.items()}
    for name, median in medians.items():
        remark = ""
        if name in COMMANDS:
            remark = f"{median / medians[first]:.2f} times the bare program (limit {COMMANDS[name][1]})"
        line(name, f"{median * 1e3:.0f}", remark)
    served()


def served() -> None:
    """How long a question to `robokin serve` takes, asked in JSON and in words, one after the other."""
    words = "fk puma560 --q 10.5,0.1,20.25,30.125,0.5,0.3"
    asked = '{"id": 7, "command": "fk", "robot": "puma560", "q": [10.5, 0.1, 20.25, 30.125, 0.5, 0.3]}'
    for name, question in (("words", words), ("JSON", asked)):
        with subprocess.Popen(
            [sys.executable, "-c", ROBOKIN, "serve"], stdin=subprocess.PIPE, stdout=subprocess.PIPE
        ) as server:
            assert server.stdin is not None and server.stdout is not None
            times = []
            for _ in range(QUESTIONS):
                start = time.perf_counter()
                server.stdin.write(question.encode() + b"\n")
                server.stdin.flush()
                server.stdout.readline()
                times.append(time.perf_counter() - start)
            server.stdin.close()
        line(f"robokin serve: fk in {name}", f"{statistics.median(times) * 1e6:.0f}", "µs, there and back (limit 50)")
