"""Inverse kinematics from Python, all solutions, in blocks and on one core; what is found and how fast."""

from __future__ import annotations

import importlib.util
import time
from typing import Any

import numpy as np

import robokin
from benchmarks.machine import best_of, line
from robokin.inverse.analysis import analyse
from robokin.inverse.solve import solve_many
from robokin.kernel.chain import chain_of

SEED = 560
COUNTS = {"puma560": 20_000, "ur5e": 20_000, "stanford": 20_000, "crx10ia": 2_000, "manocha-canny-1994": 2_000,
          "raghavan-roth-1990": 2_000, "thumb": 5_000, "scara": 20_000}  # fmt: skip
LIMITS = {"puma560": 5, "ur5e": 5, "crx10ia": 180, "manocha-canny-1994": 180, "raghavan-roth-1990": 180}


def random_poses(robot: robokin.Robot, count: int) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(SEED)
    q = np.where(robot.revolute, rng.uniform(-3, 3, (count, robot.n)), rng.uniform(0.1, 0.5, (count, robot.n)))
    return q, robokin.forward_kinematics(robot, q)


def found_share(robot: robokin.Robot, found: np.ndarray, q: np.ndarray) -> float:
    """The part of the poses whose generating joint values are among the solutions."""
    gap = np.abs(found - q[:, None])
    gap = np.where(robot.revolute, np.minimum(gap % (2 * np.pi), 2 * np.pi - gap % (2 * np.pi)), gap)
    return float(np.mean(np.min(np.max(np.nan_to_num(gap, nan=9.0), axis=2), axis=1) < 1e-4))


def run() -> None:
    print("inverse kinematics, every solution, µs a pose")
    taken: dict[str, float] = {}
    for name, count in COUNTS.items():
        robot = robokin.load(name)
        q, T = random_poses(robot, count)
        start = time.perf_counter()
        analysis = analyse(chain_of(robot))
        analysed = (time.perf_counter() - start) * 1e3
        solve_many(robot, T[:10], limits=False)
        result = solve_many(robot, T, limits=False)
        taken[name] = best_of(lambda robot=robot, T=T: solve_many(robot, T, limits=False), 3) / count * 1e6
        share = found_share(robot, result.q, q)
        limit = f" (limit {LIMITS[name]})" if name in LIMITS else ""
        remark = f"{analysis.method}, analysis {analysed:.0f} ms, found {share:.2%}, {result.count.mean():.1f} a pose"
        line(f"{name}{limit}", f"{taken[name]:.1f}", remark)
    _limits("puma560", 100_000)
    _limits("panda", 20_000)
    _peers(taken)


def _limits(name: str, count: int) -> None:
    robot = robokin.load(name)
    q = np.random.default_rng(SEED).uniform(*robot.limits.T, (count, robot.n))
    T = robokin.forward_kinematics(robot, q)
    start = time.perf_counter()
    answered = float(np.mean(solve_many(robot, T).count > 0))
    taken = (time.perf_counter() - start) / count * 1e6
    line(f"{name} within its limits, {count:,} poses", f"{taken:.0f}", f"answered {answered:.2%} (limit 99.9 %)")


def _peers(ours: dict[str, float]) -> None:
    for package, measure in {"eaik": _eaik, "ssik": _ssik, "roboticstoolbox": _toolbox}.items():
        if importlib.util.find_spec(package) is None:
            line(package, "–", "not installed")
            continue
        for name in ("puma560", "ur5e"):
            try:
                taken = measure(robokin.load(name), random_poses(robokin.load(name), 500)[1])
            except Exception as error:
                line(f"{package}, {name}", "–", f"{type(error).__name__}: {error}"[:70])
            else:
                line(f"{package}, {name}", f"{taken:.1f}", f"{taken / ours[name]:.2f} times as long")


def _dh(robot: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    return tuple(np.array([getattr(row, cell) for row in robot.rows]) for cell in ("alpha", "a", "d"))


def _eaik(robot: Any, T: np.ndarray) -> float:
    from eaik.IK_DH import DhRobot

    arm = DhRobot(*_dh(robot))
    return best_of(lambda: arm.IK_batched(T, 1), 3) / len(T) * 1e6


def _ssik(robot: Any, T: np.ndarray) -> float:
    import ssik

    arm = ssik.Manipulator.from_dh(*_dh(robot))
    return best_of(lambda: [arm.solve(target) for target in T[:50]], 2) / 50 * 1e6


def _toolbox(robot: Any, T: np.ndarray) -> float:
    import roboticstoolbox as rtb

    arm = rtb.DHRobot([rtb.RevoluteDH(d=row.d, a=row.a, alpha=row.alpha) for row in robot.rows])
    solver = arm.analytic_ik()
    return best_of(lambda: [solver.solve(target, False) for target in T[:100]], 2) / 100 * 1e6
