"""Random chains of every kind."""

from __future__ import annotations

import numpy as np

from robokin.model import Joint, JointType, Robot
from robokin.spatial import rotation_from_rpy, transform

RIGHT = np.pi / 2


def random_chain(rng, n, convention="standard", special=False):
    """A chain of n rows of any type; `special` makes half of the lengths 0 and most twists right angles."""
    rows = []
    for i in range(n):
        kind = JointType(rng.choice(["revolute", "revolute", "revolute", "prismatic", "fixed"]))
        a, d = rng.normal(size=2) * (rng.random(2) < (0.5 if special else 1.0))
        alpha = rng.choice([0.0, RIGHT, -RIGHT, np.pi, 1.0]) if special else rng.uniform(-3, 3)
        offset = rng.choice([0.0, RIGHT, 0.3]) if kind is not JointType.FIXED else 0.0
        theta = 0.0 if kind is JointType.REVOLUTE else rng.choice([0.0, -RIGHT, 0.7])
        if convention == "frames":
            origin = transform(rotation_from_rpy(rng.choice([0.0, RIGHT, 0.4], 3)), [a, 0.0, d])
            axis = [[1.0, 0, 0], [0, 1.0, 0], [0, 0, 1.0], [0, 0, -1.0], [0.6, 0.0, 0.8]][rng.integers(5)]
            rows.append(Joint(str(i), kind, offset=offset, origin=origin, axis=np.array(axis)))
        else:
            d = 0.0 if kind is JointType.PRISMATIC else d
            rows.append(Joint(str(i), kind, theta=theta, d=d, a=a, alpha=alpha, offset=offset))
    base = transform(rotation_from_rpy(rng.uniform(-1, 1, 3)), rng.normal(size=3)) if rng.random() < 0.5 else np.eye(4)
    tool = transform(rotation_from_rpy(rng.uniform(-1, 1, 3)), rng.normal(size=3)) if rng.random() < 0.5 else np.eye(4)
    return Robot("random chain", tuple(rows), convention, base=base, tool=tool)
