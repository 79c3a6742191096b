"""How long a command takes to start, against a Typer program that does next to nothing; both kernels.

And what `import robokin` takes, and what the native kernel adds to a wheel.
"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tempfile
import time
import zlib
from pathlib import Path

import robokin
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

IMPORTED = "import time; start = time.process_time(); import robokin; print(time.process_time() - start)"

ANSWERED = {"native": 50, "python": 80}
"""How long one may take [µs]."""


def run() -> None:
    print(f"start, medians of {RUNS} interleaved runs, ms")
    kernels = ("native", "python") if robokin.kernel_in_use == "native" else ("python",)
    bare = "a Typer program that imports numpy and yaml"
    with tempfile.TemporaryDirectory() as folder:
        program = Path(folder) / "bare.py"
        program.write_text(BARE)
        asked = {(bare, ""): [str(program)]}
        asked |= {(name, kernel): ["-c", ROBOKIN, *COMMANDS[name][0]] for name in COMMANDS for kernel in kernels}
        # As it is installed: compiled once.
        environment = {**os.environ, "PYTHONPYCACHEPREFIX": folder}
        environment.pop("PYTHONDONTWRITEBYTECODE", None)
        taken: dict[tuple[str, str], list[float]] = {key: [] for key in asked}
        for i in range(RUNS + 1):
            for (name, kernel), arguments in asked.items():
                told = {**environment, "ROBOKIN_KERNEL": kernel}
                start = time.perf_counter()
                subprocess.run([sys.executable, *arguments], stdout=subprocess.DEVNULL, check=True, env=told)
                if i:  # the first one compiles
                    taken[name, kernel].append(time.perf_counter() - start)
        asked_of_import = [sys.executable, "-c", IMPORTED]
        spent = [subprocess.run(asked_of_import, capture_output=True, check=True, env=environment) for _ in range(RUNS)]
    medians = {key: statistics.median(times) for key, times in taken.items()}
    first = medians[bare, ""]
    line(bare, f"{first * 1e3:.0f}")
    for name, (_, limit) in COMMANDS.items():
        for kernel in kernels:
            median = medians[name, kernel]
            remark = f"{median / first:.2f} times the bare program (limit {limit})"
            line(f"{name}: {kernel}", f"{median * 1e3:.0f}", remark)
    line("import robokin, processor time", f"{min(float(one.stdout) for one in spent) * 1e3:.1f}")
    for kernel in kernels:
        served(kernel)
    added()


def served(kernel: str) -> None:
    """How long a question to `robokin serve` takes, asked in JSON and in words, one after the other."""
    words = "fk puma560 --q 10.5,0.1,20.25,30.125,0.5,0.3"
    asked = '{"id": 7, "command": "fk", "robot": "puma560", "q": [10.5, 0.1, 20.25, 30.125, 0.5, 0.3]}'
    for name, question in (("words", words), ("JSON", asked)):
        with subprocess.Popen(
            [sys.executable, "-c", ROBOKIN, "serve"], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
            env={**os.environ, "ROBOKIN_KERNEL": kernel},
        ) as server:  # fmt: skip
            assert server.stdin is not None and server.stdout is not None
            times = []
            for _ in range(QUESTIONS):
                start = time.perf_counter()
                server.stdin.write(question.encode() + b"\n")
                server.stdin.flush()
                server.stdout.readline()
                times.append(time.perf_counter() - start)
            server.stdin.close()
        median = statistics.median(times) * 1e6
        limit = f"µs, there and back (limit {ANSWERED[kernel]})"
        line(f"robokin serve, fk in {name}: {kernel}", f"{median:.0f}", limit)


def added() -> None:
    """How much a wheel is larger by the native kernel, packed."""
    kernel = [path for path in (Path(robokin.__file__).parent / "kernel").glob("_native.*") if path.suffix != ".pyi"]
    size = sum(len(zlib.compress(path.read_bytes())) for path in kernel)
    line("what the native kernel adds to a wheel", f"{size / 1000:.0f}", "kB (limit 400)", time=False)
