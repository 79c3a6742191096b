"""How long a command takes to start, against a Typer program that does next to nothing."""

from __future__ import annotations

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
ROBOKIN = "from robokin.cli import main; main()"


def run() -> None:
    print(f"start, medians of {RUNS} interleaved runs, ms")
    with tempfile.TemporaryDirectory() as folder:
        bare = Path(folder) / "bare.py"
        bare.write_text(BARE)
        commands = {
            "a Typer program that imports numpy and yaml": [str(bare)],
            "robokin fk puma560 --q 90,0,90,0,0,0": ["-c", ROBOKIN, "fk", "puma560", "--q", "90,0,90,0,0,0"],
            "robokin ik puma560 --pose …": ["-c", ROBOKIN, "ik", "puma560", "--pose", POSE],
            "robokin --help": ["-c", ROBOKIN, "--help"],
        }
        limits = {
            "robokin fk puma560 --q 90,0,90,0,0,0": 1.35,
            "robokin ik puma560 --pose …": 1.6,
            "robokin --help": 1.15,
        }
        taken: dict[str, list[float]] = {name: [] for name in commands}
        for _ in range(RUNS):
            for name, arguments in commands.items():
                start = time.perf_counter()
                subprocess.run([sys.executable, *arguments], stdout=subprocess.DEVNULL, check=True)
                taken[name].append(time.perf_counter() - start)
    medians = {name: statistics.median(times) for name, times in taken.items()}
    base = next(iter(medians.values()))
    for name, median in medians.items():
        remark = f"{median / base:.2f} times the bare program (limit {limits[name]})" if name in limits else ""
        line(name, f"{median * 1e3:.0f}", remark)
