"""What the figures were taken on, and how times are taken."""

from __future__ import annotations

import contextlib
import os
import platform
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np


def describe() -> str:
    """The machine in a line."""
    model = platform.processor() or platform.machine()
    info = Path("/proc/cpuinfo")
    if info.exists():
        names = [line.partition(":")[2].strip() for line in info.read_text().splitlines() if "model name" in line]
        model = names[0] if names else model
    return (
        f"{model}, {os.cpu_count()} cores, {platform.system()}, Python {platform.python_version()}, "
        f"numpy {np.__version__}; one thread"
    )


def best_of(action: Callable[[], object], times: int = 5) -> float:
    """The least of some wall times of an action [s]: the one that other work disturbed least."""
    taken = []
    for _ in range(times):
        start = time.perf_counter()
        action()
        taken.append(time.perf_counter() - start)
    return min(taken)


figures: dict[str, float] = {}
"""The times of this run, for the history."""

_benchmark = ""


def begin(benchmark: str) -> None:
    """The lines that follow are of a benchmark."""
    global _benchmark
    _benchmark = benchmark


def line(name: str, figure: str, remark: str = "", *, time: bool = True) -> None:
    """A line of the report. `time` tells that its figure is a time, of which more is worse."""
    print(f"  {name:<52} {figure:>12}  {remark}".rstrip())
    with contextlib.suppress(ValueError):
        value = float(figure.replace(",", ""))
        if time:
            note(name, value)


def note(name: str, value: float) -> None:
    """Keep a time for the history."""
    figures[f"{_benchmark}: {name.strip()}"] = value
