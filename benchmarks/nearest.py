"""Counts, not times: whether nearest is nearest, and whether every pose of a redundant arm is answered."""

from __future__ import annotations

import time

import numpy as np

import robokin
from benchmarks.machine import line
from robokin.inverse.analysis import analysis_of
from robokin.inverse.closest import nearest_configurations
from robokin.inverse.solve import solve_many
from robokin.inverse.verify import residuals
from robokin.spatial import rotation_from_axis_angle

SEED = 560
TARGETS = 2_000
POSES = 10_000
TWIST = 0.01
"""How far a target is from the pose of its configuration [rad | size]."""

ARMS = (
    "scara", "adept-one", "planar3r", "stanford-rtb", "scorbot", "thumb", "anthropomorphic", "puma560", "gp8", "z1",
    "ur5e", "cr5", "xarm6", "piper", "hc10", "crx10ia", "yam", "viperx300s", "kr210-r2700", "tx2-60", "r2000ic-210l",
    "lrmate200id", "xmate-sr3", "j2n6s200", "gen3-lite", "raghavan-roth-1990", "raghavan-roth-rprrpr", "panda", "fr3",
    "gen3", "gen72", "iiwa14", "yumi-left", "yumi-right", "r1pro-left", "openarm-left", "rizon4", "planar2r",
)  # fmt: skip
"""Library arms with two to seven joints, of every family."""

REDUNDANT = ("panda", "iiwa14", "gen72", "r1pro-right", "yumi-right")


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


def worse_than_known(robot: robokin.Robot, count: int, rng: np.random.Generator) -> tuple[int, float]:
    """How many nearest configurations are worse than the one that the target was made from, and the time [s]."""
    analysis = analysis_of(robot)
    q, _ = configurations(robot, count, rng)
    T = moved(robokin.forward_kinematics(robot, q), analysis.size, rng)
    start = time.perf_counter()
    _, position, angle = nearest_configurations(analysis, T, robot.limits, home(robot), 0)
    taken = time.perf_counter() - start
    known, turned = residuals(T, robokin.forward_kinematics(robot, q))
    off = (position - known) / analysis.size
    return int(np.sum((off > 1e-9) | ((np.abs(off) <= 1e-9) & (angle > turned + 1e-7)))), taken


def unanswered(robot: robokin.Robot, count: int, rng: np.random.Generator) -> tuple[np.ndarray, float]:
    """How many poses within the limits get no solution, of each kind, and the time [s]."""
    q, kind = configurations(robot, count, rng)
    T = robokin.forward_kinematics(robot, q)
    start = time.perf_counter()
    result = solve_many(robot, T)
    return np.bincount(kind[result.count == 0], minlength=3), time.perf_counter() - start


def run(targets: int = TARGETS, poses: int = POSES) -> None:
    """Print both counts: `targets` over all arms, `poses` for each redundant arm."""
    print(f"nearest configurations worse than a known one, {targets} targets (limit 0)")
    rng = np.random.default_rng(SEED)
    each, total, taken = -(-targets // len(ARMS)), 0, 0.0
    for name in ARMS:
        worse, seconds = worse_than_known(robokin.load(name), each, rng)
        total, taken = total + worse, taken + seconds
        if worse:
            line(name, str(worse), f"of {each}")
    line("all arms", str(total), f"of {each * len(ARMS)}, {taken / each / len(ARMS) * 1e3:.1f} ms a target")
    print(f"poses of redundant arms within limits without a solution, {poses} an arm (limit 0)")
    for name in REDUNDANT:
        missing, seconds = unanswered(robokin.load(name), poses, rng)
        inside, some, every = missing.tolist()
        remark = f"inside {inside}, some at limits {some}, all at limits {every}; {seconds / poses * 1e3:.1f} ms a pose"
        line(name, str(inside + some + every), remark)
