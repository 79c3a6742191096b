"""Cores: what 2, 4, 8 … of them win over one, in Python, through the command line, and by local workers of Dask."""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

import robokin
from benchmarks.machine import best_of, line
from robokin.jobs.ordered_map import usable_cores

SEED = 560
PART_SECONDS = 10.0


def run() -> None:
    counts = [1, *(1 << k for k in range(1, 7) if 1 << k <= usable_cores())]
    print(f"cores: times as fast as one, and the share of the ideal; {usable_cores()} usable")
    robot = robokin.load("puma560")
    q = np.random.default_rng(SEED).uniform(-1.5, 1.5, (2_000_000, 6))
    T = robokin.forward_kinematics(robot, q[:400_000])
    over("forward_kinematics, 2,000,000 rows", counts, lambda n: robokin.forward_kinematics(robot, q, cores=n))
    over("jacobian, 2,000,000 rows", counts, lambda n: robokin.jacobian(robot, q, cores=n))
    over("solve_ik, puma560, 400,000 poses", counts, lambda n: robokin.solve_ik(robot, T, cores=n))
    general = robokin.load("crx10ia")
    places = robokin.forward_kinematics(general, q[:40_000])
    over("solve_ik, crx10ia, 40,000 poses", counts, lambda n: robokin.solve_ik(general, places, cores=n), 1)
    with tempfile.TemporaryDirectory() as folder:
        streams(Path(folder), q, counts)
        workers(Path(folder), counts)


def over(name: str, counts: list[int], work: Callable[[int], object], times: int = 3) -> None:
    """A line for each number of cores."""
    alone = 0.0
    for cores in counts:
        taken = best_of(lambda cores=cores: work(cores), times)  # type: ignore[misc]  # the loop's variable is bound
        alone = alone or taken
        line(f"{name}, {cores}", f"{taken:.3f}", f"s; {alone / taken:.2f} times one core: {alone / taken / cores:.2f}")


def streams(folder: Path, q: np.ndarray, counts: list[int]) -> None:
    """Files in and out, start included."""
    np.savetxt(folder / "q.csv", q[:1_000_000], delimiter=",", fmt="%.9g")
    np.save(folder / "q.npy", q)

    def asked(ending: str, cores: int) -> None:
        target = folder / f"poses{ending}"
        target.unlink(missing_ok=True)
        seconds_of("fk", "puma560", "-i", f"{folder}/q{ending}", "-o", str(target), "--cores", str(cores))

    for ending, rows in ((".csv", "1,000,000"), (".npy", "2,000,000")):
        over(f"fk -i q{ending}, {rows} rows", counts, lambda n, ending=ending: asked(ending, n), 2)  # type: ignore[misc]


def workers(folder: Path, counts: list[int]) -> None:
    """Parts of some ten seconds, one for each worker, against one core: `--cores N` and `--cluster local:N`."""
    rows = samples_of(PART_SECONDS, folder)
    for how, named in (("--cores", ""), ("--cluster", "local:")):
        alone = 0.0
        for count in counts:
            target = f"{folder}/{how[2:]}{count}/"
            size = ["--samples", str(rows * count), "--part-rows", str(rows)]
            taken = seconds_of("workspace", "puma560", *size, "-o", target, how, f"{named}{count}")
            alone = alone or taken
            share = f"s; {alone / taken:.2f} of the ideal"
            line(f"{count} parts of {PART_SECONDS:g} s, {how} {named}{count}", f"{taken:.2f}", share)
            shutil.rmtree(target)


def samples_of(seconds: float, folder: Path) -> int:
    """So many samples take one core so long."""
    few, target = 5_000_000, f"{folder}/few/"
    size = ["--samples", str(few), "--part-rows", str(few)]
    taken = seconds_of("workspace", "puma560", *size, "-o", target, "--cores", "1")
    return int(few * seconds / taken) // 100_000 * 100_000


def seconds_of(*words: str) -> float:
    """The time of a command, its start included."""
    began = time.perf_counter()
    subprocess.run([sys.executable, "-m", "robokin", *words], check=True, capture_output=True)
    return time.perf_counter() - began
