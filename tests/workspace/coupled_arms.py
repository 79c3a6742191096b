"""Arms whose joints hang on each other, made up: fingers, forearms held against the horizontal, gears, screws."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robokin.model import Joint, JointType, Robot
from robokin.model.coupled_robot import driven
from robokin.model.graph import Coupling

Array = NDArray[np.float64]
FREE = (-np.inf, np.inf)
R, P = JointType.REVOLUTE, JointType.PRISMATIC


def arm(rows: list[Joint], *couplings: Coupling, tool: Array | None = None, base: Array | None = None) -> Robot:
    """A robot of rows j1, j2, … with couplings."""
    fields = {
        "name": "coupled", "rows": tuple(rows), "convention": "standard",
        "tool": np.eye(4) if tool is None else tool, "base": np.eye(4) if base is None else base,
    }  # fmt: skip
    return driven(fields, couplings)


def follows(joint: int, other: int, ratio: float, offset: float = 0.0) -> Coupling:
    """A joint without a variable of its own."""
    return Coupling(f"j{joint}", ((f"j{other}", ratio),), offset, False)


def adds(joint: int, other: int, ratio: float = 1.0) -> Coupling:
    """A joint to whose variable another's is added."""
    return Coupling(f"j{joint}", ((f"j{other}", ratio),), 0.0, True)


def planar_finger(
    lengths: list[float], ratios: list[float], first: tuple[float, float], second: tuple[float, float],
    scale: float = 1.0,
) -> Robot:  # fmt: skip
    """A joint, a second one, and more that follow the second by ratios."""
    rows = [Joint(f"j{i + 1}", R, a=a * scale) for i, a in enumerate(lengths)]
    rows[0] = Joint("j1", R, a=lengths[0] * scale, limits=first)
    rows[1] = Joint("j2", R, a=lengths[1] * scale, limits=second)
    return arm(rows, *(follows(i + 3, 2, ratio) for i, ratio in enumerate(ratios)))


def spatial_finger(scale: float = 1.0, base: Array | None = None) -> Robot:
    """Abduction, two joints, and a last one that follows by two thirds; some 0.1 m long."""
    rows = [
        Joint("j1", R, alpha=-np.pi / 2, limits=(-0.35, 0.35)),
        Joint("j2", R, a=0.046 * scale, limits=(-0.8, 1.6)),
        Joint("j3", R, a=0.027 * scale, limits=(0.0, 1.7)),
        Joint("j4", R, a=0.018 * scale),
    ]
    return arm(rows, follows(4, 3, 2.0 / 3.0), base=base)


def drawn_arm(seed: int) -> Robot | None:
    """An arm of two to five joints with couplings and limits of every kind; None where none can be made."""
    rng = np.random.default_rng((seed, 0xC0A5))
    n = int(rng.integers(2, 6))
    scale = float(rng.choice([1e-3, 1.0, 1.0, 1e3]))
    rows, couplings = [], []
    for i in range(1, n + 1):
        turns = rng.random() < 0.8
        low, high = np.sort(rng.uniform(-2.5, 2.5, 2)) * (1.0 if turns else scale)
        limits = [(low, high), FREE if turns else (low, high), (low, low)][int(rng.choice(3, p=[0.7, 0.2, 0.1]))]
        motion = (-1.5, 1.5) if turns and rng.random() < 0.3 else FREE
        earlier = [row for row in rows if row.type is R]
        if turns and earlier and rng.random() < 0.6:
            own = bool(rng.random() < 0.5)
            ratio = float(rng.choice([1.0, -1.0, 2.0 / 3.0, 0.5, -2.0, rng.uniform(-2.0, 2.0)]))
            couplings.append(Coupling(f"j{i}", ((rng.choice(earlier).name, ratio),), 0.1, own))
            limits, motion = (limits, motion) if own else (FREE, FREE)
        rows.append(
            Joint(
                f"j{i}", R if turns else P, a=float(rng.choice([0.0, 1.0, rng.uniform(-1, 1)])) * scale,
                d=float(rng.choice([0.0, rng.uniform(-1, 1)])) * scale * turns,
                alpha=float(rng.choice([0.0, np.pi / 2, -np.pi / 2, rng.uniform(-3, 3)])), limits=limits,
                motion_limits=motion, sense=int(rng.choice([1, 1, -1])),
            )
        )  # fmt: skip
    tool = np.eye(4)
    tool[:3, 3] = rng.uniform(-0.4, 0.4, 3) * scale
    try:
        return arm(rows, *couplings, tool=tool)
    except ValueError:
        return None
