"""The figures of earlier runs: a JSON a run, and what got worse since the last one on the same machine.

They stand in benchmarks/history, or in the folder that BENCH_HISTORY names.
"""

from __future__ import annotations

import json
import os
import subprocess
import time
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import robokin
from benchmarks import machine

FOLDER = Path(__file__).parent / "history"

NOISE = 1.25
"""A figure is worse when it grew by more than this beyond what all grew by: a machine has faster and slower days."""

WIDE = 4.0
"""And by more than so many typical deviations of all figures."""

FEW = 8
"""Figures in common that are too few to tell how fast the day is."""


class Worse(NamedTuple):
    """A figure that grew, from `before` to `now`, `growth` times as much as all did."""

    name: str
    before: float
    now: float
    growth: float


def folder() -> Path:
    """Where the runs are."""
    return Path(os.environ.get("BENCH_HISTORY") or FOLDER)


def this_run() -> dict[str, Any]:
    """The run that has just been made."""
    return {
        "time": time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime()),
        "machine": machine.describe(),
        "robokin": robokin.__version__,
        "kernel": robokin.kernel_in_use,
        "commit": _commit(),
        "load": round(os.getloadavg()[0], 2) if hasattr(os, "getloadavg") else None,
        "figures": dict(machine.figures),
    }


def _commit() -> str:
    asked = ["git", "describe", "--always", "--dirty"]
    try:
        done = subprocess.run(asked, cwd=Path(__file__).parent, capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        return ""
    return done.stdout.strip()


def kept_runs(runs: Path) -> list[dict[str, Any]]:
    """The runs of a folder, the oldest first; a file that is none is named and passed over."""
    found = []
    for path in sorted(runs.glob("*.json")):
        try:
            run = json.loads(path.read_text())
            whole = isinstance(run["time"], str) and all(value + 0.0 > 0.0 for value in run["figures"].values())
        except (OSError, ValueError, TypeError, LookupError, AttributeError):
            whole = False
        if whole:
            found.append(run)
        else:
            print(f"{path} is no run, and is passed over")
    return sorted(found, key=lambda run: run["time"])


def earlier(run: dict[str, Any], runs: Path) -> dict[str, Any] | None:
    """The last run before this one on the same machine, with the same Python and numpy and the same kernel."""
    found = None
    for other in kept_runs(runs):
        same = all(other.get(key) == run[key] for key in ("machine", "kernel"))
        if same and other["time"] < run["time"] and other["figures"].keys() & run["figures"].keys():
            found = other
    return found


def worse(before: dict[str, float], now: dict[str, float]) -> list[Worse]:
    """What grew beyond noise, the most first."""
    names = [name for name in now if before.get(name, 0.0) > 0.0 and now[name] > 0.0]
    if not names:
        return []
    growth = np.log([now[name] / before[name] for name in names])
    day = float(np.median(growth)) if len(names) >= FEW else 0.0
    deviation = 1.4826 * float(np.median(np.abs(growth - day))) if len(names) >= FEW else 0.0
    limit = max(np.log(NOISE), WIDE * deviation)
    found = [
        Worse(name, before[name], now[name], float(np.exp(each - day)))
        for name, each in zip(names, growth.tolist(), strict=True)
        if each - day > limit
    ]
    return sorted(found, key=lambda one: -one.growth)


def keep() -> None:
    """Write this run down, and say what got worse since the last one."""
    run, runs = this_run(), folder()
    if not run["figures"]:
        return
    print()
    last = earlier(run, runs)
    path = runs / f"{run['time'].replace(':', '')}.json"
    try:
        runs.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(run, indent=1, ensure_ascii=False) + "\n")
        print(f"kept as {path}")
    except OSError as error:
        print(f"not kept: {error}")
    if last is None:
        print("the first such run on this machine, with this Python, numpy and kernel")
        return
    common = last["figures"].keys() & run["figures"].keys()
    grown = worse(last["figures"], run["figures"])
    said = f"{len(grown)} of {len(common)} figures got worse" if grown else f"none of {len(common)} figures got worse"
    print(f"{said} beyond noise since {last['time']} ({last.get('commit', '')})")
    for one in grown:
        print(f"  {one.name:<70} {one.before:.3g} to {one.now:.3g}: {one.growth:.2f} times what all grew by")
