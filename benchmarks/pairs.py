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
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import robokin
from benchmarks.machine import line
from robokin.number_text import show

SEED = 560
ROUNDS = 3
ARMS = ("puma560", "ur5e", "crx10ia", "panda", "panda-q5", "panda-q7", "iiwa14")
"""What is asked about; after -q the joint that is held, where it is not the third."""
HELD = {"panda": {2: 0.3}, "panda-q5": {4: 0.3}, "panda-q7": {6: 0.3}, "iiwa14": {2: 0.3}}
"""The third of a Panda leaves an arm without a closed form, the fifth one of the fourth degree."""
LINES = 200_000
"""Of the files."""


class Question(NamedTuple):
    """A line of the table: what is measured of an arm, over how many calls or poses, and by which peers."""

    title: str
    what: str
    arm: str
    count: int
    peers: tuple[tuple[str, str], ...] = ()
    """Each with what it is asked for: it may have several ways."""


PEERS = ("pinocchio", "eaik", "ssik", "toolbox", "polars")

FORWARD = (("pinocchio", "fk-one"), ("pinocchio", "fk-copy"), ("eaik", "fk-one"), ("toolbox", "fk-one"))
JACOBIAN = (("pinocchio", "jacobian-one"), ("toolbox", "jacobian-one"))
WRIST = (("eaik", "ik-one"), ("ssik", "ik-one"), ("ssik", "ik-from-dh"), ("toolbox", "ik-one"))
SSIK = (("ssik", "ik-one"),)

QUESTIONS = [
    Question("forward kinematics, one", "fk-one", "puma560", 200, FORWARD),
    Question("forward kinematics, batch", "fk-batch", "puma560", 100_000, (("toolbox", "fk-batch"),)),
    Question("Jacobian, one", "jacobian-one", "puma560", 200, JACOBIAN),
    Question("Jacobian, batch", "jacobian-batch", "puma560", 50_000),
]  # fmt: skip
for arm in ("puma560", "ur5e"):
    QUESTIONS += [
        Question("inverse kinematics, one", "ik-one", arm, 40, WRIST),
        Question("inverse kinematics, one, all objects", "ik-objects", arm, 40),
        Question("inverse kinematics, batch", "ik-batch", arm, 5000, (("eaik", "ik-batch"),)),
    ]
for arm, count in (("crx10ia", 500), ("panda", 1000), ("iiwa14", 2000)):
    QUESTIONS += [
        Question("inverse kinematics, one", "ik-one", arm, 20, SSIK),
        Question("inverse kinematics, one, all objects", "ik-objects", arm, 20),
        Question("inverse kinematics, batch", "ik-batch", arm, count),
    ]
for arm in ("panda-q5", "panda-q7"):
    QUESTIONS += [
        Question("inverse kinematics, one", "ik-one", arm, 40),
        Question("inverse kinematics, batch", "ik-batch", arm, 2000),
    ]
QUESTIONS += [
    Question("CSV to CSV, a line", "csv-batch", "puma560", LINES, (("polars", "csv-batch"),)),
    Question(".npy to .npy, a row", "npy-batch", "puma560", LINES),
]

WORDS = {
    "fk-copy": "with its pose as an array", "ik-from-dh": "from a table", "fk-one": "", "fk-batch": "", "ik-one": "",
    "ik-batch": "", "jacobian-one": "", "csv-batch": "no kinematics",
}  # fmt: skip
"""What a peer's way is, beside being asked the same."""


class Answerer:
    """A side in a process of its own; None for what it does not know, for good when it has ended."""

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
        self.version = str(self.ask(what="version").get("version", ""))

    def ask(self, **question: Any) -> dict[str, Any]:
        if self.missing:
            return {"missing": self.missing}
        assert self.process.stdin is not None and self.process.stdout is not None
        try:
            self.process.stdin.write(json.dumps(question) + "\n")
            self.process.stdin.flush()
            answer = self.process.stdout.readline()
        except BrokenPipeError:
            answer = ""
        if answer:
            found: dict[str, Any] = json.loads(answer)
            return found
        self.missing = f"it ended with status {self.process.wait()}"
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
        np.savez(Path(folder) / f"{name}.npz", q=q, T=robokin.forward_kinematics(robot, q[:5000]), held=held, **cells)
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
                    line(name, "–", "not installed")
            for question in QUESTIONS:
                _line(question, kernels, sides)
        finally:
            for side in sides.values():
                side.close()


def _line(question: Question, kernels: tuple[str, ...], sides: dict[str, Answerer]) -> None:
    """Ask all who know in turn, and print what each took."""
    asked = [(name, question.what) for name in kernels]
    asked += [(name, what) for name, what in question.peers if sides[name].version]
    least: dict[tuple[str, str], float] = {}
    missing: dict[tuple[str, str], str] = {}
    for _ in range(ROUNDS):
        for one in asked:
            if one in missing:
                continue
            answer = sides[one[0]].ask(what=one[1], arm=question.arm, count=question.count)
            if "seconds" in answer:
                least[one] = min(least.get(one, np.inf), answer["seconds"] * 1e6)
            else:
                missing[one] = answer["missing"]
    ours = least.get((kernels[0], question.what), np.nan)
    for name, what in asked:
        label = name if name in kernels else " ".join([*filter(None, [name, sides[name].version, WORDS[what]])])
        title = f"{question.arm}, {question.title}: {label}"
        if (name, what) in missing:
            line(title, "–", missing[name, what])
        else:
            figure = least[name, what]
            line(title, f"{figure:.3g}", "" if name == kernels[0] else f"{show(round(figure / ours, 2))} times as long")
