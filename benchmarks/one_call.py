"""One call beside a batch, from Python on one core: what a loop over poses costs, and what it need not cost."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

import robokin
from benchmarks.machine import best_of, line

SEED = 560
POSES = 40
ROBOTS: dict[str, dict[str, Any]] = {
    "puma560": {}, "ur5e": {}, "irb120": {}, "crx10ia": {}, "panda": {"hold": {2: 0.3}}, "iiwa14": {"hold": {2: 0.3}},
}  # fmt: skip


def run() -> None:
    print("one call beside a batch, µs a call and µs a pose")
    for name, options in ROBOTS.items():
        robot = robokin.load(name)
        q = np.random.default_rng(SEED).uniform(*np.clip(robot.limits, -3.0, 3.0).T, (4096, robot.n))
        for joint, value in options.get("hold", {}).items():
            q[:, joint] = value
        forward(name, robot, q)
        inverse(name, robot, robokin.forward_kinematics(robot, q[:1000]), options)


def forward(name: str, robot: robokin.Robot, q: np.ndarray) -> None:
    """The lines of forward kinematics and of the Jacobian."""
    for what, ask in (("forward_kinematics", robokin.forward_kinematics), ("jacobian", robokin.jacobian)):
        each = [partial(ask, robot, one) for one in q[:POSES]]
        pair(f"{name}, {what}", each, partial(ask, robot, q), len(q))


def inverse(name: str, robot: robokin.Robot, T: np.ndarray, options: dict[str, Any]) -> None:
    """The lines of inverse kinematics, with all solutions within the limits."""
    held = ", a joint held" if options else ""
    some = T[:POSES]
    looks = {
        "asked": lambda result: None,
        "all solutions": lambda result: result.solutions,
        "and their names": lambda result: [solution.branch for solution in result.solutions],
    }
    for look, of in looks.items():
        each = [lambda one=one, of=of: of(robokin.solve_ik(robot, one, **options)) for one in some]
        pair(f"{name}, solve_ik{held}, {look}", each, lambda: robokin.solve_ik(robot, T, **options), len(T))


def pair(name: str, each: list[Any], together: Any, count: int) -> None:
    """A line: the mean of some calls, and a batch's share of each pose."""
    one = best_of(lambda: [ask() for ask in each], 9) / len(each) * 1e6
    batch = best_of(together, 3) / count * 1e6
    line(name, f"{one:.1f}", f"batch {batch:.2f}: {one / batch:.0f} times as long")
