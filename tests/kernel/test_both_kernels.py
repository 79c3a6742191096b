"""Both kernels answer alike, claims and all, wherever joints stand: each in a process of its own."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from typing import Any

import numpy as np
import pytest
from library_entries import entry, names_of

import robokin
from robokin.model import Robot
from robokin.spatial import rotation_from_axis_angle

SAME = ("complete", "reason", "all_known", "postures", "families_complete")
"""What both say of a pose; not what a claim rests on, for one may count what the other must follow."""

CLOSE = 1e-5
"""What solutions [rad or m] differ by that are the same: a double root is known to half of its digits."""


GROUPS = [names_of(Robot, 6, 7)[first::40] for first in range(0, 40, 4)]
"""A tenth of the library's arms of six and seven joints."""


def poses(robot: Robot, rng: np.random.Generator) -> list[np.ndarray]:
    """Poses at random and at round joint values, at limits, one ulp beside, with cut digits, and out of reach."""
    low, high = np.clip(np.nan_to_num(robot.limits, posinf=np.pi, neginf=-np.pi), -2 * np.pi, 2 * np.pi).T
    random, limited = rng.uniform(low, high), rng.uniform(low, high)
    step = np.radians(rng.choice([15.0, 30.0, 45.0, 90.0]))
    round_values = np.clip(np.round(rng.uniform(low, high) / step) * step, low, high)
    limited[rng.integers(robot.n)] = (low, high)[rng.integers(2)][rng.integers(robot.n)]
    limited = np.clip(limited, low, high)
    T = [robokin.forward_kinematics(robot, q) for q in (random, round_values, limited)]
    beside, cut, far = T[1].copy(), T[1].copy(), T[0].copy()
    row, column = rng.integers(3), rng.integers(4)
    beside[row, column] = np.nextafter(beside[row, column], 2.0)
    cut[:3] = np.round(cut[:3], 6)
    far[:3, :3] = far[:3, :3] @ rotation_from_axis_angle([0.0, 0.0, 1.0], 0.3)
    far[:3, 3] *= rng.uniform(2.0, 4.0)
    return [*T, beside, cut, far]


def answers(names: list[str]) -> list[dict[str, Any]]:
    """What this process's kernel answers to seeded poses of arms, in the order of asking."""
    found = []
    for name in names:
        robot = robokin.load(name)
        rng = np.random.default_rng([560, *name.encode()])
        for T in poses(robot, rng):
            j, limit = int(rng.integers(robot.n)), robot.limits
            held = float(np.clip(0.5, *np.clip(limit[j], -1.0, 1.0)))
            for asked in ({}, {"hold": {j: held}}) if robot.n == 6 else ({"hold": {j: held}},):
                result = robokin.solve_ik(robot, T, **asked)
                one = {key: getattr(result, key) for key in SAME}
                one |= {"q": [s.q.tolist() for s in result], "branches": [s.branch for s in result]}
                one |= {"arm": f"{name} {asked}", "free": [bool(s.free) for s in result]}
                found.append(one)
    return found


def by_kernel(kernel: str, names: list[str]) -> list[dict[str, Any]]:
    environment = {**os.environ, "ROBOKIN_KERNEL": kernel, "PYTHONPATH": os.pathsep.join(sys.path)}
    program = (
        f"import json, sys; from kernel.test_both_kernels import answers; json.dump(answers({names!r}), sys.stdout)"
    )
    done = subprocess.run([sys.executable, "-c", program], env=environment, capture_output=True, text=True, check=True)
    found: list[dict[str, Any]] = json.loads(done.stdout)
    return found


@pytest.mark.skipif(robokin.kernel_in_use != "native", reason="no native kernel in use")
@pytest.mark.parametrize("names", [["puma560"], *(pytest.param(names, marks=pytest.mark.slow) for names in GROUPS)])
def test_both_kernels_answer_alike(names: list[str]) -> None:
    for native, python in zip(by_kernel("native", names), by_kernel("python", names), strict=True):
        assert [native[key] for key in SAME] == [python[key] for key in SAME], native["arm"]
        if not native["all_known"] or any(native["free"]) or any(python["free"]):
            continue  # which of a self-motion's members is listed is nobody's promise
        a, b = (
            np.array(one["q"]).reshape(-1, entry(names[0]).n if not one["q"] else len(one["q"][0]))
            for one in (native, python)
        )
        assert a.shape == b.shape, native["arm"]
        assert native["branches"] == python["branches"], native["arm"]
        gap = np.abs(a - b)
        assert np.minimum(gap, np.abs(2.0 * np.pi - gap)).max(initial=0.0) < CLOSE, native["arm"]
