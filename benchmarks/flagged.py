"""The time of poses that are looked at again: those with singular solutions and self-motions, in a batch and alone.

`python -m benchmarks.flagged` prints milliseconds a pose, of this process's own time, for arms of each kind.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator
from unittest import mock

import numpy as np
from inverse import arms, truth

import robokin
from benchmarks import machine
from robokin.inverse import solve_blocks

SEED = 561

TOGETHER, ALONE = 12.0, 60.0
"""Milliseconds that a pose may take on average, in a batch and alone."""

KINDS = arms.KINDS[1:]

ARMS = ("ur7e", "ur5e", "viperx300s", "crx10ia", "hc10", "xarm6", "gp8", "puma560", "tx2-60", "scara", "gen3-lite",
        "thumb")  # fmt: skip
"""Two UR arms, arms of an elimination, with a wrist, with fewer joints."""


def flagged(robot: robokin.Robot, T: np.ndarray) -> np.ndarray:
    """Which of poses T (m, 4, 4) are looked at again."""
    seen = []

    def watched(analysis, again, *rest):
        seen.append(again)
        return look_again(analysis, again, *rest)

    # The solver itself says which poses it doubts; no answer does.
    look_again = solve_blocks.look_again
    with mock.patch.object(solve_blocks, "look_again", watched):
        robokin.solve_ik(robot, T)
    again = np.concatenate([np.empty((0, 4, 4)), *seen])
    return np.array([bool(np.any(np.all(np.abs(again - pose) < 1e-12, axis=(1, 2)))) for pose in T], dtype=bool)


def poses(name: str, each: int) -> tuple[robokin.Robot, list[str], np.ndarray]:
    """An arm, and its poses of each kind that are looked at again: their kinds and the poses (m, 4, 4)."""
    robot = robokin.load(name)
    scale, rng = truth.Scale(robot), np.random.default_rng(SEED)
    q = np.concatenate([arms.configurations(robot, scale, rng, each, kind) for kind in KINDS])
    T = robokin.forward_kinematics(robot, q)
    some = flagged(robot, T)
    return robot, [kind for i, kind in enumerate(np.repeat(KINDS, each).tolist()) if some[i]], T[some]


def taken(robot: robokin.Robot, T: np.ndarray, rounds: int) -> float:
    """Milliseconds that each of poses T (m, 4, 4) takes in a batch, its answer read: the least of some rounds."""
    times = []
    for _ in range(rounds):
        start = time.process_time()
        list(robokin.solve_ik(robot, T))
        times.append(time.process_time() - start)
    return 1e3 * min(times) / max(len(T), 1)


def measured(name: str, each: int, alone: int, rounds: int) -> Iterator[tuple[str, int, float, float]]:
    """For poses with self-motions and for others: how many, and what each takes in a batch and alone [ms]."""
    robot, _, T = poses(name, each)
    if not len(T):
        return
    moving = np.array([bool(result.families) for result in robokin.solve_ik(robot, T)])
    for title, some in (("self-motions", T[moving]), ("single solutions", T[~moving])):
        if len(some):
            chosen = some[np.unique(np.linspace(0, len(some) - 1, alone).astype(int))]
            each_alone = [taken(robot, one[None], rounds) for one in chosen]
            yield title, len(some), taken(robot, some, rounds), float(np.mean(each_alone))


def run(names: tuple[str, ...] = ARMS, each: int = 8, alone: int = 6, rounds: int = 3) -> None:
    """Print the times."""
    print(f"poses that are looked at again, ms a pose: in a batch (limit {TOGETHER:g}), alone (limit {ALONE:g})")
    every: dict[str, list[tuple[float, float]]] = {}
    for name in names:
        for title, count, together, alone_ in measured(name, each, alone, rounds):
            every.setdefault(title, []).append((together, alone_))
            machine.line(f"{name}, {title}", f"{together:.1f} {alone_:6.1f}", f"{count} poses")
    every["all"] = [pair for pairs in every.values() for pair in pairs]
    for title, pairs in every.items():
        machine.line(f"mean, {title}", "{:.1f} {:6.1f}".format(*np.mean(pairs, axis=0)))


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.flagged", description=__doc__)
    parser.add_argument("--arms", default="", help="library arms, separated by commas; every one with 'all'")
    parser.add_argument("--each", type=int, default=8, help="poses of each kind, of which those looked at again count")
    parser.add_argument("--alone", type=int, default=6, help="how many of them are solved alone")
    parser.add_argument("--rounds", type=int, default=3, help="of so many times the least is taken")
    asked = parser.parse_args()
    names = tuple(arms.library_arms()) if asked.arms == "all" else tuple(asked.arms.split(",")) if asked.arms else ARMS
    print(machine.describe())
    run(names, asked.each, asked.alone, asked.rounds)


if __name__ == "__main__":
    main()
