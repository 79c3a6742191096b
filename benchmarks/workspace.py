"""The workspace on all cores: positions and orientations a second, whole runs, and memory at any number of samples."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import time
from dataclasses import replace
from functools import partial
from itertools import count
from pathlib import Path

import numpy as np

import robokin
from benchmarks.machine import best_of, line
from robokin.jobs.ordered_map import ordered_map, usable_cores
from robokin.jobs.sequences import RANDOM_BLOCK
from robokin.model import JointType, Robot
from robokin.workspace.attitudes import attitudes, group_of
from robokin.workspace.extremes import extent
from robokin.workspace.sampling import joint_values, positions
from robokin.workspace.space import Space, space_of
from robokin.workspace.trials import fractions

SAMPLES = 1 << 25
POSITIONS = 8e6
"""Positions of the PUMA's tool a second that are wanted of two cores."""

QUERIES = 150_000
"""Orientation queries a second that are wanted of two cores."""

MEMORY = 300
ROBOTS = ("planar3r", "puma560", "scara", "stanford", "thumb", "panda")
RUN_LIMIT = 3.0

WRITTEN = """
import resource, sys
import robokin
from robokin.cli.sample_files import write_samples
from robokin.cli.sample_rows import Samples
from robokin.workspace.space import space_of

name, samples, orientation = sys.argv[1], int(sys.argv[2]), sys.argv[3] or None
space = space_of(robokin.load("puma560"))
kind = name.rpartition(".")[2]
write_samples(name, Samples(space, space.robot.units, kind, samples=samples, joints=True, orientation=orientation))
peaks = [resource.getrusage(who).ru_maxrss / 1024 for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
print(max(peaks))
"""


def farthest(space: Space, start: int) -> float:
    """A number that needs every position of a task, so that none is sent from process to process."""
    p = positions(space, joint_values(space, "sobol", 0, start, RANDOM_BLOCK, SAMPLES))
    return float(np.max(p))


def run() -> None:
    cores = usable_cores()
    print(f"workspace, on {cores} cores")
    _positions(cores)
    _orientations(cores)
    _extremes()
    _runs()
    _closed_forms()
    _files()


def _positions(cores: int) -> None:
    for name in ("puma560", "planar3r", "panda"):
        space = space_of(robokin.load(name))
        count = SAMPLES if name == "puma560" else SAMPLES // 4
        for used in sorted({1, cores}):
            work = partial(farthest, space)
            taken = best_of(
                lambda work=work, used=used, count=count: list(ordered_map(work, range(0, count, RANDOM_BLOCK), used)),
                3,
            )
            wanted = f"limit {POSITIONS / 1e6:.0f} on two cores" if name == "puma560" and used > 1 else ""
            line(f"{name}, million positions a second, {used} cores", f"{count / taken / 1e6:.1f}", wanted, time=False)


def _orientations(cores: int) -> None:
    for name in ("puma560", "planar3r", "ur5e"):
        space = space_of(robokin.load(name))
        tried = attitudes(space, group_of(space), 128, 0)
        p = positions(space, joint_values(space, "random", 1, 0, 4096, 4096)).T
        start = time.perf_counter()
        found = fractions(space, tried, p, cores)
        taken = time.perf_counter() - start
        asked = len(p) * len(tried.rotations)
        wanted = f"limit {QUERIES:,}; " if name == "puma560" else ""
        line(
            f"{name}, orientation queries a second",
            f"{asked / taken:,.0f}",
            f"{wanted}{np.mean(found):.1%} can be reached",
            time=False,
        )


def _extremes() -> None:
    for name in ("puma560", "panda"):
        space = space_of(robokin.load(name))
        seeds = count()  # the answer for a seed is kept
        taken = best_of(lambda space=space, seeds=seeds: extent(space, next(seeds)))
        line(f"{name}, bounds and reach, ms", f"{taken * 1e3:.0f}", "on one core")


def _runs() -> None:
    for name in ROBOTS:
        command = [sys.executable, "-m", "robokin", "workspace", name, "--json"]
        start = time.perf_counter()
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        taken = time.perf_counter() - start
        answer = json.loads(done.stdout)
        size = next(key for key in ("volume", "area", "length", "dimension") if key in answer)
        remark = f"limit {RUN_LIMIT:.0f}; {size} {answer[size]:.6g}"
        if f"{size}_error" in answer:
            remark += f" ± {answer[f'{size}_error'] / answer[size]:.2%}"
        line(f"robokin workspace {name}, s", f"{taken:.2f}", remark)


def _without_limits(name: str) -> Robot:
    """A robot of the library with all its turns free."""
    robot = robokin.load(name)
    turning = [row.moves and row.type is JointType.REVOLUTE for row in robot.rows]
    rows = [
        replace(row, limits=(-np.inf, np.inf)) if turns else row for row, turns in zip(robot.rows, turning, strict=True)
    ]
    return replace(robot, rows=tuple(rows))


def _closed_forms() -> None:
    """Sizes against closed forms, at the usual number of samples and at 16 times as many."""
    a, b, c = (row.a for row in robokin.load("planar3r").rows)
    every_angle = np.pi * ((a + b - c) ** 2 - (abs(a - b) + c) ** 2)
    upper, fore = (row.a for row in robokin.load("anthropomorphic").rows if row.a)
    shell = 4.0 / 3.0 * np.pi * ((upper + fore) ** 3 - abs(upper - fore) ** 3)
    # The PUMA's wrist reaches a shell without a cylinder; its tool turns everywhere in the ring that remains of it.
    offset, tool = 0.14909, 0.05625
    wrist = np.hypot(np.hypot(0.43307, 0.02032) + 0.4318, offset)
    ring = 4.0 / 3.0 * np.pi * ((wrist - tool) ** 2 - (offset + tool) ** 2) ** 1.5
    scara = robokin.load("scara")
    reach = robokin.analyse_workspace(scara).measure.value
    cases: list[tuple[str, Robot, bool, float]] = [
        ("anthropomorphic without limits, volume", _without_limits("anthropomorphic"), False, shell),
        ("planar3r, every angle", robokin.load("planar3r"), True, every_angle),
        ("scara, every angle (all that it reaches)", scara, True, reach),
        ("puma560 without limits, every direction", _without_limits("puma560"), True, ring),
    ]
    for name, robot, every, truth in cases:
        for times, limit in ((1, 0.005), (16, 0.0005)):
            start = time.perf_counter()
            found = robokin.analyse_workspace(robot, samples=times * 131072, dextrous=every)
            taken = time.perf_counter() - start
            size = found.dexterity.every if found.dexterity is not None else found.measure
            line(
                f"{name}, {times} x 131072 samples, bound",
                f"{size.error / size.value:.4%}",
                f"limit {limit:.2%}; off by {abs(size.value / truth - 1.0):.4%}; {taken:.1f} s",
            )


def _files() -> None:
    with tempfile.TemporaryDirectory() as folder:
        for ending, samples, orientation in (
            (".npy", 4_000_000, ""),
            (".csv", 500_000, "rpy"),
            (".jsonl", 200_000, "rpy"),
        ):
            path = str(Path(folder) / f"cloud{ending}")
            start = time.perf_counter()
            done = subprocess.run(
                [sys.executable, "-c", WRITTEN, path, str(samples), orientation],
                capture_output=True,
                text=True,
                check=True,
            )
            rate = samples / (time.perf_counter() - start)
            with_ = "joints and orientations" if orientation else "joints"
            remark = (
                f"{Path(path).stat().st_size / 1e6:.0f} MB; peak memory {float(done.stdout):.0f} MB (limit {MEMORY})"
            )
            line(f"{samples:,} samples with {with_} to {ending}, a second", f"{rate:,.0f}", remark, time=False)
            Path(path).unlink()
