"""Forward kinematics through the command line: files in, files out, time and memory."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from benchmarks.machine import best_of, line

COUNT = 1_000_000
LIMITS = {".npy": 0.7, ".csv": 6.0}
MEMORY = 150

ONE = [sys.executable, "-m", "robokin", "fk", "puma560", "--q", "home", "--json"]

MEASURED = """
import sys
sys.argv = ["robokin", *sys.argv[1:]]
from robokin.cli import run
status = run(sys.argv[1:])
print(next(int(row.split()[1]) / 1024 for row in open("/proc/self/status") if row.startswith("VmHWM")))
sys.exit(status)
"""


def run() -> None:
    print(f"robokin fk puma560 --input FILE --output FILE, {COUNT:,} lines, µs a pose, start included")
    start = best_of(lambda: subprocess.run(ONE, capture_output=True, check=True))
    line("start alone (one pose), s", f"{start:.2f}", f"{start / COUNT * 1e6:.2f} µs of each figure below")
    q = np.random.default_rng(560).uniform(-100, 100, (COUNT, 6))
    with tempfile.TemporaryDirectory() as folder:
        np.save(Path(folder) / "q.npy", q)
        lines = (",".join(map(repr, row)) for row in q.tolist())
        (Path(folder) / "q.csv").write_text("\n".join(lines) + "\n")
        for ending, limit in LIMITS.items():
            source, target = f"{folder}/q{ending}", f"{folder}/poses{ending}"
            command = [sys.executable, "-c", MEASURED, "fk", "puma560", "--input", source, "--output", target]
            memory: list[float] = []

            def once(command: list[str] = command, memory: list[float] = memory, target: str = target) -> None:
                Path(target).unlink(missing_ok=True)  # taking an old file's place costs the time to free it
                done = subprocess.run(command, capture_output=True, text=True, check=True)
                memory.append(float(done.stdout))

            taken = best_of(once, 3) / COUNT * 1e6
            line(
                f"{ending} to {ending}",
                f"{taken:.2f}",
                f"limit {limit}; peak memory {max(memory):.0f} MB (limit {MEMORY})",
            )
