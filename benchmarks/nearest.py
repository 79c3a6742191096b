"""Counts, not times: whether nearest is nearest, beside known configurations and at the edge of the reach.

`python -m benchmarks.nearest` takes `--targets`, `--chains` (random ones) and `--seed`.
"""

from __future__ import annotations

import argparse
import time

import numpy as np
from inverse.arms import random_chain

import robokin
from benchmarks.machine import line
from robokin.inverse.analysis import analysis_of
from robokin.inverse.numeric.closest import nearest_configurations
from robokin.inverse.verify import residuals
from robokin.spatial import rotation_from_axis_angle

SEED = 560
TARGETS = 2_000
TWIST = 0.01
"""How far a target is from the pose of its configuration [rad | size]."""

ARMS = (
    "scara", "adept-one", "planar3r", "stanford-arte", "scorbot", "thumb", "anthropomorphic", "puma560", "gp8", "z1",
    "ur5e", "cr5", "xarm6", "piper-old", "hc10", "crx10ia", "yam", "viperx300s", "kr210-r2700", "tx2-60",
    "r2000ic-210l", "lrmate200id", "xmate-sr3", "j2n6s200", "gen3-lite", "raghavan-roth-1990", "raghavan-roth-rprrpr",
    "panda", "fr3", "gen3", "gen72", "iiwa14", "yumi-left", "yumi-right", "r1pro-left", "openarm-left", "rizon4",
    "planar2r",
)  # fmt: skip
"""Library arms with two to seven joints, of every family."""

CHOSEN_OF = 1500
"""Configurations of which those farthest in and out are at the edge of the reach."""


def configurations(robot: robokin.Robot, count: int, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Within the limits (count, n): a third inside, a third with some joints at limits, a third with all; the kind."""
    size = analysis_of(robot).size
    reach = np.where(robot.revolute, np.pi, size)[:, None] * [-1.0, 1.0]
    low, high = np.where(np.isinf(robot.limits), reach, robot.limits).T
    q = rng.uniform(low, high, (count, robot.n))
    at_limit = np.where(rng.random(q.shape) < 0.5, low, high)
    kind = np.arange(count) % 3
    chance = np.array([0.0, 0.5, 1.0])[kind]
    return np.where(rng.random(q.shape) < chance[:, None], at_limit, q), kind


def moved(T: np.ndarray, size: float, rng: np.random.Generator) -> np.ndarray:
    """Poses (m, 4, 4) turned, shifted, or both by at most `TWIST`."""
    out = T.copy()
    for i, way in enumerate(rng.integers(0, 3, len(T))):
        axis, along = rng.normal(size=(2, 3))
        if way != 1:
            turn = rotation_from_axis_angle(axis / np.linalg.norm(axis), rng.uniform(0.0, TWIST))
            out[i, :3, :3] = turn @ out[i, :3, :3]
        if way != 0:
            out[i, :3, 3] += size * rng.uniform(0.0, TWIST) * along / np.linalg.norm(along)
    return out


def home(robot: robokin.Robot) -> np.ndarray:
    """Zero, or the limit that is nearest to it."""
    return np.clip(0.0, *robot.limits.T)


def at_the_edge(robot: robokin.Robot, count: int, rng: np.random.Generator) -> np.ndarray:
    """Configurations (count, n) of those that reach farthest from the middle of all places, and least far."""
    q, _ = configurations(robot, CHOSEN_OF, rng)
    p = robokin.forward_kinematics(robot, q)[:, :3, 3]
    order = np.argsort(np.linalg.norm(p - np.mean(p, axis=0), axis=1))
    return q[rng.choice(np.concatenate([order[:40], order[-80:]]), count)]


def worse_than_known(robot: robokin.Robot, count: int, edge: bool, rng: np.random.Generator) -> tuple[int, float]:
    """How many nearest configurations are worse than the one that the target was made from, and the time [s]."""
    analysis = analysis_of(robot)
    q = at_the_edge(robot, count, rng) if edge else configurations(robot, count, rng)[0]
    T = moved(robokin.forward_kinematics(robot, q), analysis.size, rng)
    start = time.process_time()
    _, position, angle = nearest_configurations(analysis, T, robot.limits, home(robot), 0)
    taken = time.process_time() - start
    known, turned = residuals(T, robokin.forward_kinematics(robot, q))
    off = (position - known) / analysis.size
    return int(np.sum((off > 1e-9) | ((np.abs(off) <= 1e-9) & (angle > turned + 1e-7)))), taken


def run(targets: int = TARGETS, chains: int = 0, seed: int = SEED) -> None:
    """Print the counts of `targets` over all arms, and as many at the edge of the reach."""
    rng = np.random.default_rng(seed)
    robots = [robokin.load(name) for name in ARMS] + [random_chain(rng) for _ in range(chains)]
    each = -(-targets // len(robots))
    for title, edge in (("beside a known one", False), ("the same at the edge of the reach", True)):
        total, taken = 0, 0.0
        print(f"nearest configurations worse than a known one, {title} (limit 0)")
        for robot in robots:
            worse, seconds = worse_than_known(robot, each, edge, rng)
            total, taken = total + worse, taken + seconds
            if worse:
                line(robot.name, str(worse), f"of {each}", time=False)
        line(
            "all arms",
            str(total),
            f"of {each * len(robots)}, {taken / each / len(robots) * 1e3:.1f} ms a target",
            time=False,
        )


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.nearest", description=__doc__)
    parser.add_argument("--targets", type=int, default=TARGETS)
    parser.add_argument("--chains", type=int, default=0, help="how many random chains besides the library's arms")
    parser.add_argument("--seed", type=int, default=SEED)
    asked = parser.parse_args()
    run(asked.targets, asked.chains, asked.seed)


if __name__ == "__main__":
    main()
