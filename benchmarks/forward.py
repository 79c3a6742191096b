"""Forward kinematics of a million poses of the PUMA 560, from Python, on one core."""

from __future__ import annotations

import importlib.util

import numpy as np

import robokin
from benchmarks.machine import best_of, line

COUNT = 1_000_000
SEED = 560


def stacked(robot: robokin.Robot, q: np.ndarray) -> np.ndarray:
    """The usual way in numpy: one 4×4 matrix a joint and pose, multiplied up."""
    T = np.broadcast_to(robot.base, (len(q), 4, 4))
    for i, row in enumerate(robot.rows):
        A = np.zeros((len(q), 4, 4))
        c, s, ca, sa = np.cos(q[:, i]), np.sin(q[:, i]), np.cos(row.alpha), np.sin(row.alpha)
        A[:, 0, 0], A[:, 0, 1], A[:, 0, 2], A[:, 0, 3] = c, -s * ca, s * sa, row.a * c
        A[:, 1, 0], A[:, 1, 1], A[:, 1, 2], A[:, 1, 3] = s, c * ca, -c * sa, row.a * s
        A[:, 2, 1], A[:, 2, 2], A[:, 2, 3] = sa, ca, row.d
        A[:, 3, 3] = 1.0
        T = T @ A
    return T @ robot.tool


def run() -> None:
    print(f"forward kinematics, {COUNT:,} poses of puma560, µs a pose")
    robot = robokin.load("puma560")
    q = np.random.default_rng(SEED).uniform(-3, 3, (COUNT, 6))
    part = q[: COUNT // 5]
    error = np.max(np.abs(robokin.forward_kinematics(robot, part) - stacked(robot, part)))
    ours = best_of(lambda: robokin.forward_kinematics(robot, q)) / COUNT * 1e6
    theirs = best_of(lambda: stacked(robot, part), 3) / len(part) * 1e6
    line("robokin.forward_kinematics", f"{ours:.3f}", "limit 0.25")
    line("stacked 4×4 products in numpy", f"{theirs:.3f}", f"{theirs / ours:.1f} times as long (limit 7)")
    line("greatest difference between the two", f"{error:.1e}", "m | 1", time=False)
    single = robot.poses["home"]
    one = best_of(lambda: [robokin.forward_kinematics(robot, single) for _ in range(200)]) / 200 * 1e6
    line("one pose at a time", f"{one:.0f}", "µs a call")
    _toolbox(robot, part, ours)
    _pinocchio(robot, part, ours)


def _toolbox(robot: robokin.Robot, q: np.ndarray, ours: float) -> None:
    if importlib.util.find_spec("roboticstoolbox") is None:
        line("Robotics Toolbox for Python", "–", "not installed")
        return
    import roboticstoolbox as rtb

    links = [rtb.RevoluteDH(d=row.d, a=row.a, alpha=row.alpha) for row in robot.rows]
    ets = rtb.DHRobot(links).ets()
    taken = best_of(lambda: ets.eval(q), 3) / len(q) * 1e6
    line(f"Robotics Toolbox {rtb.__version__}, ETS.eval, compiled", f"{taken:.3f}", f"{taken / ours:.1f} times as long")


def _pinocchio(robot: robokin.Robot, q: np.ndarray, ours: float) -> None:
    if importlib.util.find_spec("pinocchio") is None:
        line("pinocchio", "–", "not installed")
        return
    import pinocchio as pin

    model = pin.Model()
    parent, before = 0, np.eye(4)
    for i, row in enumerate(robot.rows):
        parent = model.addJoint(parent, pin.JointModelRZ(), pin.SE3(before), f"joint{i}")
        c, s = np.cos(row.alpha), np.sin(row.alpha)
        before = np.array([[1, 0, 0, row.a], [0, c, -s, 0], [0, s, c, row.d], [0, 0, 0, 1.0]])
    data = model.createData()
    part = q[:20_000]
    taken = best_of(lambda: [pin.forwardKinematics(model, data, row) for row in part], 3) / len(part) * 1e6
    line(f"pinocchio {pin.__version__}, called pose by pose", f"{taken:.3f}", f"{taken / ours:.1f} times as long")
