"""Names of solutions: whether they are unique among the solutions of a pose, and the same a little farther on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

import robokin
from benchmarks.machine import line
from robokin.formats import library_names, load_any
from robokin.inverse.analysis import analysis_of
from robokin.inverse.solve import solve_many
from robokin.inverse.verify import wrapped

SEED = 17
POSES = 200
STEP = 1e-4
"""The length of the step from a configuration to its neighbour [rad | size]."""


@dataclass(frozen=True)
class Names:
    """Of an arm: poses looked at, those where two solutions have one name, and those that a small step renames.

    numbered: poses where a number is needed to tell solutions apart.
    """

    arm: str
    poses: int
    repeated: int
    renamed: int
    numbered: int


def unique_names(poses: int = POSES, seed: int = SEED, most: int = 6) -> list[Names]:
    """A row for each arm of the library with at most `most` joints."""
    arms = [entry for entry in map(load_any, library_names()) if isinstance(entry, robokin.Robot)]
    return [names_of(arm, poses, seed) for arm in arms if 1 <= arm.n <= most]


def names_of(robot: robokin.Robot, poses: int, seed: int = SEED) -> Names:
    """The row of one arm: poses of random joint values, within a turn and the arm's size, joint limits aside."""
    rng = np.random.default_rng(seed)
    scale = np.where(robot.revolute, 1.0, analysis_of(robot).size)
    q = rng.uniform(-1.0, 1.0, (poses, robot.n)) * np.where(robot.revolute, np.pi, scale)
    step = rng.normal(size=q.shape)
    step *= STEP / np.linalg.norm(step, axis=1)[:, None]
    repeated = numbered = 0
    for names, _ in (answers := _answers(robot, q)):
        repeated += len(set(names)) < len(names)
        numbered += any("number" in name for name in names)
    there = _answers(robot, q + step * scale)
    renamed = sum(a is not None and b is not None and a != b for (_, a), (_, b) in zip(answers, there, strict=True))
    return Names(robot.id, poses, repeated, renamed, numbered)


def _answers(robot: robokin.Robot, q: np.ndarray) -> list[tuple[list[str], str | None]]:
    """For each configuration the names of all solutions of its pose, and its own, if it is among them."""
    found = solve_many(robot, robokin.forward_kinematics(robot, q), limits=False)
    names = iter(found.branches())
    answers = []
    for i, count in enumerate(found.count.tolist()):
        own = [next(names) for _ in range(count)]
        gap = np.max(np.abs(wrapped(found.q[i, :count] - q[i], robot.revolute)), axis=1)
        answers.append((own, own[int(np.argmin(gap))] if count and np.min(gap) < STEP / 10.0 else None))
    return answers


def run() -> None:
    print(f"names of solutions, {POSES} random poses an arm")
    rows = unique_names()
    line("poses where two solutions have one name", str(sum(row.repeated for row in rows)), "limit 0", time=False)
    line("poses that a step of 1e-4 renames", str(sum(row.renamed for row in rows)), f"{len(rows)} arms", time=False)
    for row in rows:
        if row.repeated or row.renamed:
            line(f"  {row.arm}", f"{row.repeated}, {row.renamed}", f"repeated, renamed of {row.poses}")
