"""Whether "all solutions" are all: the laws of inverse kinematics on round, singular and random poses, counted.

`python -m benchmarks.completeness` takes some minutes; `--full` takes 500 poses of each library arm and 100 of each of
1,000 random chains. `--arms xarm6,piper-old` and `--failures FILE` show what breaks where.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
import warnings
import zlib
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from inverse import arms, judge, truth

import robokin
from benchmarks import machine

SEED = 560
SHORT = {"unanswered": "unans", "lost": "lost", "on no family": "nofam", "falsely complete": "false", "wrong": "wrong",
         "twice": "twice", "by an ulp": "ulp", "batch": "batch", "error": "error"}  # fmt: skip

MEANING = """unans  no solution, though the configuration that made the pose is one, within the limits
lost   a regular generating configuration is not among the solutions (1e-6)
nofam  a singular one is neither listed nor on a self-motion
false  called complete, though it or a solution that Newton's method finds from guesses is missing
wrong  a listed solution misses the pose or the limits;  twice  one is listed twice (1e-5)
ulp    the regular solutions change with the last digits of the pose
batch  the answer differs from that for the pose alone;  error  an exception or a warning
all    called complete, %: by a count of all complex solutions or branches (count), else by an account of all paths
ms     a pose in a batch, its result read;  alone  a pose alone that is not certified by a count"""


@dataclass
class Tally:
    """What is counted of a group of poses."""

    poses: int = 0
    broken: Counter[str] = field(default_factory=Counter)
    basis: Counter[str] = field(default_factory=Counter)
    complete: int = 0
    together: float = 0.0
    alone: list[float] = field(default_factory=list)


@dataclass
class Report:
    """The tallies by group, and the inputs that break a law."""

    tallies: dict[str, dict[str, Tally]] = field(default_factory=dict)
    failures: list[tuple[str, str, str, str]] = field(default_factory=list)
    searched: int = 0

    def groups(self, *names: tuple[str, str]) -> list[Tally]:
        """The tallies of blocks and rows, made when first asked for."""
        return [self.tallies.setdefault(block, {}).setdefault(row, Tally()) for block, row in names]


@dataclass(frozen=True)
class Amount:
    """How much is measured: poses of each kind, the share that is searched from guesses and that is solved alone."""

    each: int
    searched: float
    guesses: int
    alone: float
    seed: int


@dataclass
class Arm:
    """An arm under judgement; block: which part of the report it is in."""

    robot: Any
    block: str
    title: str
    rng: np.random.Generator
    scale: Any = field(init=False)

    def __post_init__(self) -> None:
        self.scale = truth.Scale(self.robot)


def measure(report: Report, robot: Any, block: str, title: str, amount: Amount) -> None:
    """Judge the answers for one arm's poses of every kind: random ones together, and all others together."""
    arm = Arm(robot, block, title, np.random.default_rng([amount.seed, zlib.crc32(title.encode())]))
    for kinds in (arms.KINDS[:1], arms.KINDS[1:]):
        made = [arms.configurations(robot, arm.scale, arm.rng, amount.each, kind) for kind in kinds]
        labels = [kind for kind in kinds for _ in range(amount.each)]
        measure_together(report, arm, np.concatenate(made), labels, amount)


def measure_together(report: Report, arm: Arm, q: Any, kinds: list[str], amount: Amount) -> None:
    """Judge the answers for the poses of q: (m, n), which are solved in one call; each alone where that fails."""
    T = robokin.forward_kinematics(arm.robot, q)
    try:
        start = time.process_time()
        results = list(robokin.solve_ik(arm.robot, T))
        taken = (time.process_time() - start) / len(T)
        other = robokin.solve_ik(arm.robot, judge.shaken(T, arm.rng))
    except Exception as error:
        failed = f"{type(error).__name__}: {error}"
        report.failures.append((arm.title, f"{kinds[0]} …", "error", f"{len(T)} poses together: {failed}"))
        if len(T) > 1:
            for i, kind in enumerate(kinds):
                measure_together(report, arm, q[i : i + 1], [kind], amount)
            return
        for tally in report.groups((arm.block, "all"), (f"{arm.block}: arms with faults", arm.title)):
            tally.poses += 1
            tally.broken["error"] += 1
        return
    for i, (kind, result) in enumerate(zip(kinds, results, strict=True)):
        row = kind if not kind.startswith("round") else "round, disturbed"
        method = result.method.removeprefix("three ")
        tallies = report.groups(
            (arm.block, "all"),
            (f"{arm.block}: by pose", row),
            (f"{arm.block}: by method", f"{method}, {arm.robot.n}"),
            (f"{arm.block}: arms with faults", arm.title),
        )
        moved = other.q[i, : other.count[i]]
        broken, alone, remark = judged(report, arm, q[i], T[i], result, moved, amount)
        count(tallies, result, broken, taken, alone)
        if broken:
            least = float(truth.least_singular_value(arm.robot, arm.scale, q[i]))
            what = f"{arms.in_own_units(arm.robot, q[i])} s {least:.1e}{remark}"
            report.failures.append((arm.title, kind, ", ".join(broken), what))


def judged(
    report: Report, arm: Arm, q: Any, T: Any, result: Any, moved: Any, amount: Amount
) -> tuple[list[str], float | None, str]:
    """The laws that an answer breaks; how long the pose takes alone [s], if that was tried; how that answer differs.

    moved: (k, n) the solutions for the pose with other last digits.
    """
    known, alone, remark = (), None, ""
    if arm.rng.random() < amount.searched:
        known, _ = truth.search(arm.robot, arm.scale, T, arm.rng, guesses=amount.guesses)
        report.searched += 1
    broken = judge.faults(arm.robot, arm.scale, q, T, result, known)
    if judge.differ(arm.robot, arm.scale, judge.listed(arm.robot, result), moved):
        broken.append("by an ulp")
    if arm.rng.random() < amount.alone:
        start = time.process_time()
        try:
            single = robokin.solve_ik(arm.robot, T)
        except Exception as error:
            return [*broken, "error"], None, f", alone {type(error).__name__}: {error}"
        alone = time.process_time() - start
        difference = judge.differs_alone(arm.robot, arm.scale, result, single)
        if difference:
            broken.append("batch")
            remark = f", {difference}"
    return broken, alone, remark


def count(tallies: list[Tally], result: Any, broken: list[str], taken: float, alone: float | None) -> None:
    """Add an answer to tallies."""
    for tally in tallies:
        tally.poses += 1
        tally.together += taken
        tally.broken.update(broken)
        tally.complete += result.complete
        tally.basis[result.basis or "none"] += 1
        if alone is not None and result.basis != "counted":
            tally.alone.append(alone)


HEAD = f"  {'':<18}{'poses':>6}" + "".join(f" {SHORT[law]}" for law in SHORT) + (
    f"{'all%':>5}{'count':>6}{'ms':>6}{'alone':>6}"
)  # fmt: skip


def row(name: str, tally: Tally) -> str:
    cells = "".join(f" {tally.broken[law] or '·':>{len(SHORT[law])}}" for law in SHORT)
    share = [f"{100.0 * part / max(tally.poses, 1):.0f}" for part in (tally.complete, tally.basis["counted"])]
    alone = f"{1e3 * np.mean(tally.alone):.0f}" if tally.alone else "·"
    together = f"{1e3 * tally.together / max(tally.poses, 1):.1f}"
    return f"  {name[:18]:<18}{tally.poses:>6}{cells}{share[0]:>5}{share[1]:>6}{together:>6}{alone:>6}"


def printed(report: Report, tables: dict[str, str]) -> Iterator[str]:
    """The report, line by line; tables: those of the random chains."""
    for block in sorted(report.tallies):
        rows = report.tallies[block]
        if block.endswith("faults"):
            rows = {name: tally for name, tally in rows.items() if tally.broken}
            rows = dict(sorted(rows.items(), key=lambda one: -sum(one[1].broken.values()))[:30])
        if rows:
            yield f"{block}\n{HEAD}"
            yield from (row(name, tally) for name, tally in rows.items())
            yield ""
    seen: set[str] = set()
    yield "examples: what is broken, the arm, the configuration in degrees and mm, its least singular value s"
    for title, kind, broken, what in report.failures:
        if broken not in seen and len(seen) < 24:
            seen.add(broken)
            yield f"  {broken}: {title} ({kind}) {what}{tables.get(title, '')}"


def chains(count: int, seed: int) -> Iterator[tuple[str, Any]]:
    """Random chains with a name of each."""
    for i in range(count):
        robot = arms.random_chain(np.random.default_rng([seed, i]))
        yield f"chain {i} {robot.types}", robot


def progress(text: str) -> None:
    """Say on a terminal how far it is, in one line."""
    if sys.stderr.isatty():
        print(f"\r{text:<79}", end="\r", file=sys.stderr, flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.completeness", description=__doc__)
    parser.add_argument("--full", action="store_true", help="500 poses an arm, 1,000 chains")
    parser.add_argument("--arms", default="", help="library arms, separated by commas; none with '-'")
    parser.add_argument("--chains", type=int, default=None, help="how many random chains")
    parser.add_argument("--each", type=int, default=None, help="poses of each kind for an arm")
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument("--seconds", type=float, default=np.inf, help="no further arm is begun after so long")
    parser.add_argument("--searched", type=float, default=None, help="share of poses that are searched from guesses")
    parser.add_argument("--alone", type=float, default=None, help="share of poses that are solved alone too")
    parser.add_argument("--failures", type=Path, default=None, help="a file for all inputs that break a law")
    asked = parser.parse_args()
    warnings.simplefilter("error")
    full = asked.full or os.environ.get("FULL", "") not in ("", "0")
    each = asked.each or (46 if full else 2)
    searched = asked.searched if asked.searched is not None else 0.05 if full else 0.25
    alone = asked.alone if asked.alone is not None else 0.05 if full else 0.15
    amount = Amount(each, searched, 1000 if full else 300, alone, asked.seed)
    if asked.failures:
        asked.failures.write_text("")
    names = [] if asked.arms == "-" else asked.arms.split(",") if asked.arms else arms.library_arms()
    count = asked.chains if asked.chains is not None else 0 if asked.arms not in ("", "-") else 1000 if full else 100
    report, start, tables = Report(), time.perf_counter(), {}
    print(machine.describe())
    spread = replace(amount, each=max(1, each // 5))
    wanted = [("library", name, robokin.load(name), amount) for name in names]
    wanted += [("random chains", title, robot, spread) for title, robot in chains(count, asked.seed)]
    for block, title, robot, many in wanted:
        if time.perf_counter() - start > asked.seconds:
            print(f"{asked.seconds:g} s are over: {title} and what follows are left out")
            break
        seen = len(report.failures)
        measure(report, robot, block, title, many)
        tables[title] = f" | {arms.dh_of(robot)}" if block == "random chains" else ""
        progress(f"{title}: {len(report.failures)} inputs that break a law so far")
        if asked.failures:
            with asked.failures.open("a") as file:
                for arm, kind, broken, what in report.failures[seen:]:
                    file.write(f"{arm} | {kind} | {broken} | {what}{tables[arm]}\n")
    for line in printed(report, tables):
        print(line)
    print(f"\n{MEANING}\n\n{report.searched} poses searched from random guesses; {time.perf_counter() - start:.0f} s")


if __name__ == "__main__":
    main()
