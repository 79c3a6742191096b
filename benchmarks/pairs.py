"""One call and a batch, with the native kernel and without, beside every peer that is there, in one run.

Each side answers in a process of its own, in turn and several times over; of each figure the least counts. PEERS names
the folder of packages where the peers are, if they are not beside robokin's own.
"""

from __future__ import annotations

import contextlib
import json
import os
import subprocess
import sys
import tempfile
import threading
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import robokin
from benchmarks.machine import line, note
from robokin.number_text import show

SEED = 560
ROUNDS = 3
ARMS = ("puma560", "ur5e", "crx10ia", "panda", "panda-q5", "panda-q7", "iiwa14")
"""What is asked about; after -q the joint that is held, where it is not the third."""
HELD = {"panda": {2: 0.3}, "panda-q5": {4: 0.3}, "panda-q7": {6: 0.3}, "iiwa14": {2: 0.3}}
"""The third of a Panda leaves an arm without a closed form, the fifth one of the fourth degree."""
RESCUED = {"crx10ia": (17459, 20771, 34965, 47679, 87321)}
"""Of 100,000 configurations those at whose poses the elimination alone does not find all complex solutions: these are
solved from poses next door, in the same call."""
LINES = 200_000
"""Of the files."""
PATIENCE = 300.0
"""Seconds that one answer may take: a peer that hangs is ended."""


WAYS = ("one", "rescued", "all objects", "batch")
"""The columns: a call; a call for a pose that is solved from poses next door; a call that looks at all solutions; one
call for all."""


class Question(NamedTuple):
    """A table: what is measured of an arm, over how many calls or poses of each way, and by which peers."""

    title: str
    arm: str
    what: str
    counts: dict[str, int]
    peers: tuple[tuple[str, str, tuple[str, ...], str], ...] = ()
    """Each with what it is asked for, in which ways, and what is to be said of it: it may stand here more than once."""


PEERS = ("pinocchio", "eaik", "ssik", "toolbox", "polars")

BOTH, ONE, BATCH = ("one", "batch"), ("one",), ("batch",)
FORWARD = (
    ("pinocchio", "fk", ONE, ""), ("pinocchio", "fk-copy", ONE, "with its pose as an array"), ("eaik", "fk", ONE, ""),
    ("toolbox", "fk", BOTH, ""),
)  # fmt: skip
JACOBIAN = (("pinocchio", "jacobian", ONE, ""), ("toolbox", "jacobian", ONE, ""))
CLOSED = (
    ("eaik", "ik", BOTH, ""), ("ssik", "ik", ONE, "its own arm"), ("ssik", "ik-dh", ONE, "from a table"),
    ("toolbox", "ik", ONE, "its exported C, one solution"),
)  # fmt: skip
OWN = (("ssik", "ik", ONE, "its own arm"),)
SAMPLED = (("ssik", "ik", ONE, "its own arm, all of its samples"),)
CSV = (("polars", "csv", BATCH, "no kinematics"),)
INVERSE = "inverse kinematics"

QUESTIONS = [
    Question("forward kinematics", "puma560", "fk", {"one": 200, "batch": 100_000}, FORWARD),
    Question("Jacobian", "puma560", "jacobian", {"one": 200, "batch": 50_000}, JACOBIAN),
    Question(INVERSE, "puma560", "ik", {"one": 40, "all objects": 40, "batch": 5000}, CLOSED),
    Question(INVERSE, "ur5e", "ik", {"one": 40, "all objects": 40, "batch": 5000}, CLOSED),
    Question(INVERSE, "crx10ia", "ik", {"one": 20, "rescued": 5, "all objects": 20, "batch": 500}, OWN),
    Question(f"{INVERSE}, joint 3 held", "panda", "ik", {"one": 20, "all objects": 20, "batch": 1000}, SAMPLED),
    Question(f"{INVERSE}, joint 5 held", "panda-q5", "ik", {"one": 40, "batch": 2000}),
    Question(f"{INVERSE}, joint 7 held", "panda-q7", "ik", {"one": 40, "batch": 2000}),
    Question(f"{INVERSE}, joint 3 held", "iiwa14", "ik", {"one": 20, "all objects": 20, "batch": 2000}, SAMPLED),
    # Followed when it is looked at.
    Question("self-motions within the limits", "panda", "motions", {"all objects": 4}),
    Question("self-motions within the limits", "iiwa14", "motions", {"one": 20, "all objects": 20, "batch": 500}),
    Question("CSV to CSV, a line", "puma560", "csv", {"batch": LINES}, CSV),
    Question(".npy to .npy, a row", "puma560", "npy", {"batch": LINES}),
]


class Answerer:
    """A side in a process of its own; `missing` for what it does not know, for good when it has ended."""

    def __init__(self, name: str, folder: str) -> None:
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), "PYTHONWARNINGS": "ignore"}
        environment["POLARS_MAX_THREADS"] = "1"
        if name in ("native", "python"):
            environment["ROBOKIN_KERNEL"] = name
        self.name, self.missing = name, ""
        self.process = subprocess.Popen(
            [sys.executable, "-m", "benchmarks.pair_sides", name, folder],
            env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
        )  # fmt: skip
        about = self.ask(what="version")
        self.version = str(about.get("version", ""))
        self.absent = "" if self.version else about["missing"]

    def ask(self, **question: Any) -> dict[str, Any]:
        if self.missing:
            return {"missing": self.missing}
        assert self.process.stdin is not None and self.process.stdout is not None
        timer = threading.Timer(PATIENCE, self.process.kill)
        timer.start()
        try:
            self.process.stdin.write(json.dumps(question) + "\n")
            self.process.stdin.flush()
            answer = self.process.stdout.readline()
        except BrokenPipeError:
            answer = ""
        if answer:
            timer.cancel()
            found: dict[str, Any] = json.loads(answer)
            return found
        status = self.process.wait()
        self.missing = f"it ended with status {status}" if timer.is_alive() else f"no answer within {PATIENCE:g} s"
        timer.cancel()
        return {"missing": self.missing}

    def close(self) -> None:
        assert self.process.stdin is not None
        with contextlib.suppress(BrokenPipeError):
            self.process.stdin.close()
        self.process.wait()


def prepare(folder: str) -> None:
    """What is asked about, for all sides."""
    for name in ARMS:
        robot = robokin.load(name.partition("-q")[0])
        q = np.random.default_rng(SEED).uniform(*np.clip(robot.limits, -3.0, 3.0).T, (100_000, robot.n))
        for joint, value in HELD.get(name, {}).items():
            q[:, joint] = value
        held = np.array([*HELD.get(name, {}).items()]).reshape(-1, 2)
        cells = {cell: np.array([getattr(row, cell) for row in robot.rows]) for cell in ("alpha", "a", "d")}
        poses = {"T": robokin.forward_kinematics(robot, q[:5000])}
        if name in RESCUED:
            poses["rescued"] = robokin.forward_kinematics(robot, q[[*RESCUED[name]]])
        np.savez(Path(folder) / f"{name}.npz", q=q, held=held, **poses, **cells)
    rows = np.random.default_rng(SEED).uniform(-100, 100, (LINES, 6))
    np.save(Path(folder) / "rows.npy", rows)
    (Path(folder) / "rows.csv").write_text("\n".join(",".join(map(repr, row)) for row in rows.tolist()) + "\n")


def run() -> None:
    print("one call and a batch, with the native kernel and without, and peers; µs of processor time a call or pose")
    with tempfile.TemporaryDirectory() as folder:
        prepare(folder)
        kernels = ("native", "python") if robokin.kernel_in_use == "native" else ("python",)
        sides = {name: Answerer(name, folder) for name in (*kernels, *PEERS)}
        try:
            for name in PEERS:
                if not sides[name].version:
                    line(name, "–", sides[name].absent)
            for question in QUESTIONS:
                table(question, kernels, sides)
        finally:
            for side in sides.values():
                side.close()


def table(question: Question, kernels: tuple[str, ...], sides: dict[str, Answerer]) -> None:
    """Ask all who know in turn, and print what each took."""
    title = f"{question.arm.partition('-q')[0]}, {question.title}"
    ways = [way for way in WAYS if way in question.counts]
    rows = [(name, question.what, ways, name) for name in kernels]
    for name, what, some, words in question.peers:
        if sides[name].version:
            label = f"{name} {sides[name].version}"
            rows.append((name, what, [*some], f"{label}, {words}" if words else label))
    found: list[dict[str, float]] = [{} for _ in rows]
    missing: list[dict[str, str]] = [{} for _ in rows]
    for _ in range(ROUNDS):
        for (name, what, some, _), least, why in zip(rows, found, missing, strict=True):
            for way in [way for way in some if way not in why]:
                asked = f"{what}-{way.replace(' ', '-')}"
                answer = sides[name].ask(what=asked, arm=question.arm, count=question.counts[way])
                if "seconds" in answer:
                    least[way] = min(least.get(way, np.inf), answer["seconds"] * 1e6)
                else:
                    why[way] = answer["missing"]
    print(f"\n  {title:<48}{''.join(f'{way:>13}' for way in ways)}")
    for (*_, label), least, why in zip(rows, found, missing, strict=True):
        cells = "".join(f"{least[way]:>13.3g}" if way in least else f"{'–':>13}" for way in ways)
        ratios = [show(round(least[way] / found[0][way], 2)) for way in ways if way in least and way in found[0]]
        times = f"{', '.join(ratios)} times as long" if least is not found[0] and ratios else ""
        print(f"    {label:<46}{cells}  {'; '.join([*filter(None, [times]), *dict.fromkeys(why.values())])}".rstrip())
        for way, figure in least.items():
            note(f"{title}, {way}: {label}", float(f"{figure:.3g}"))
