"""Mobility: every mechanism of the library, a long chain, and the start of a bare count against `robokin fk`."""

from __future__ import annotations

import statistics
import subprocess
import sys
import time

import numpy as np

from benchmarks.machine import best_of, line
from robokin.formats import library_names, load_any
from robokin.mobility.trace import trace
from robokin.mobility.verdict import mobility_of
from robokin.model import Mechanism, MechanismJoint

RUNS = 15
SLOWEST = 3
ROBOKIN = "from robokin.cli import main; main()"
LIBRARY_LIMIT, MEDIAN_LIMIT, CHAIN_LIMIT, START_LIMIT = 0.5, 0.01, 1.0, 1.0
"""Seconds for any mechanism of the library, for the one in the middle, and for 200 links; start of a bare count in
starts of `robokin fk`."""


def chain(count: int) -> Mechanism:
    """Planar four-bars, each standing on the coupler of the one before: 3 count + 1 links."""
    links, joints = ["0"], []
    z = np.array([[0.0, 0.0, 1.0]])
    for k in range(count):
        base, a, b, c = "0" if k == 0 else f"b{k - 1}", f"a{k}", f"b{k}", f"c{k}"
        links += [a, b, c]
        places = ((0.0, 0.0), (0.2, 2.0), (2.5, 2.3), (2.0, 0.0))
        for pair, place in zip(((base, a), (a, b), (b, c), (c, base)), places, strict=True):
            at = np.array([3.0 * k + place[0], 2.0 * k + place[1], 0.0])
            joints.append(MechanismJoint(str(len(joints)), "revolute", pair, 1, at, z))
    return Mechanism("a chain", "planar", tuple(links), tuple(joints), "0")


def legs(kind: str) -> Mechanism:
    """Six equal legs between congruent hexagons, with universal or ball joints below: branches that are double."""
    joints = []
    freedoms = {"universal": 2, "spherical": 3}
    for i in range(6):
        foot = np.array([2.0 * np.cos(np.pi * i / 3.0), 2.0 * np.sin(np.pi * i / 3.0), 0.0])
        axes = np.eye(3)[:2] if kind == "universal" else None
        joints.append(MechanismJoint(f"foot {i}", kind, ("0", f"leg {i}"), freedoms[kind], foot, axes))
        top = foot + np.array([0.0, 0.0, 2.0])
        joints.append(MechanismJoint(f"top {i}", "spherical", (f"leg {i}", "platform"), 3, top))
    return Mechanism("legs", "spatial", ("0", "platform", *(f"leg {i}" for i in range(6))), tuple(joints), "0")


def cranks(count: int) -> Mechanism:
    """Equal cranks of a parallelogram at its change point: branches that meet."""
    z, joints = np.array([[0.0, 0.0, 1.0]]), []
    for i in range(count):
        joints.append(MechanismJoint(f"A{i}", "revolute", ("0", f"c{i}"), 1, np.array([2.0 * i, 0.0, 0.0]), z))
        joints.append(MechanismJoint(f"B{i}", "revolute", (f"c{i}", "b"), 1, np.array([2.0 * i + 1.0, 0.0, 0.0]), z))
    return Mechanism("cranks", "planar", ("0", "b", *(f"c{i}" for i in range(count))), tuple(joints), "0")


def run() -> None:
    print("mobility, from Python, ms")
    entries = [load_any(name) for name in library_names()]
    mechanisms = [entry for entry in entries if isinstance(entry, Mechanism)]
    times = {m.id: best_of(lambda m=m: mobility_of(m), 3) for m in mechanisms}
    slowest = sorted(times, key=times.__getitem__, reverse=True)[:SLOWEST]
    median = statistics.median(times.values())
    line(f"{len(times)} mechanisms of the library, median", f"{median * 1e3:.1f}", f"limit {MEDIAN_LIMIT * 1e3:.0f}")
    for name in slowest:
        line(f"among the slowest: {name}", f"{times[name] * 1e3:.0f}", f"limit {LIBRARY_LIMIT * 1e3:.0f}")
    long = chain(67)
    taken = best_of(lambda: mobility_of(long), 3)
    line(f"a planar chain of {len(long.links)} links", f"{taken * 1e3:.0f}", f"limit {CHAIN_LIMIT * 1e3:.0f}")
    special = {"three cranks in a line": cranks(3), "a hexapod of equal legs, U-S": legs("universal"),
               "a hexapod of equal legs, S-S": legs("spherical")}  # fmt: skip
    for name, mechanism in special.items():
        line(name, f"{best_of(lambda m=mechanism: mobility_of(m), 2) * 1e3:.0f}")
    four = load_any("four-bar")
    assert isinstance(four, Mechanism)
    line("360 configurations of a four-bar", f"{best_of(lambda: trace(four, 360), 3) * 1e3:.0f}")
    _starts()


def _starts() -> None:
    print(f"start, medians of {RUNS} interleaved runs, ms")
    bare_count = ["dof", "--links", "7", "--joints", "6R", "--space", "spatial"]
    commands = {
        "robokin fk puma560 --q 90,0,90,0,0,0": ["fk", "puma560", "--q", "90,0,90,0,0,0"],
        "robokin dof --links 7 --joints 6R --space spatial": bare_count,
        "robokin dof bennett": ["dof", "bennett"],
    }
    taken: dict[str, list[float]] = {name: [] for name in commands}
    for _ in range(RUNS):
        for name, arguments in commands.items():
            start = time.perf_counter()
            subprocess.run([sys.executable, "-c", ROBOKIN, *arguments], stdout=subprocess.DEVNULL, check=True)
            taken[name].append(time.perf_counter() - start)
    medians = {name: statistics.median(times) for name, times in taken.items()}
    first, bare, _ = medians
    for name, median in medians.items():
        limit = f" (limit {START_LIMIT})" if name == bare else ""
        remark = f"{median / medians[first]:.2f} times that of fk{limit}" if name != first else ""
        line(name, f"{median * 1e3:.0f}", remark)
