"""Trees drawn at random, and configurations of them: within the limits, at them, at round values."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from robokin.model import Tree
from robokin.model.graph import Coupling, Graph, GraphJoint, Tip
from robokin.spatial import rotation_from_rpy, transform


def placed(rng):
    """A constant transform with right angles and zeros among its numbers."""
    angles = np.where(rng.random(3) < 0.5, rng.choice([0.0, np.pi / 2, -np.pi / 2], 3), rng.uniform(-3.0, 3.0, 3))
    return transform(rotation_from_rpy(angles), np.where(rng.random(3) < 0.3, 0.0, rng.uniform(-0.3, 0.3, 3)))


def random_tree(rng):
    """A trunk with one to three branches; some joints slide, some advance as they turn, some follow or are added to."""
    links, joints = ["base"], []

    def grow(at, count, tag):
        for i in range(count):
            kind = rng.choice(["revolute", "prismatic", "helical"], p=[0.75, 0.15, 0.1])
            low, high = np.sort(rng.uniform(-0.4, 0.4, 2) if kind == "prismatic" else rng.uniform(-3.0, 3.0, 2))
            if rng.random() < 0.2:
                low, high = -np.inf, np.inf
            links.append(f"{tag}{i}")
            before = placed(rng)
            joint = GraphJoint(f"{tag}{i}", str(kind), at, len(links) - 1, before=before, limits=(low, high))
            joints.append(replace(joint, pitch=0.05 if kind == "helical" else 0.0))
            at = len(links) - 1
        return at

    trunk = grow(0, int(rng.integers(1, 3)), "trunk")
    tips = [
        Tip(f"tip{b}", grow(trunk, int(rng.integers(2, 5)), "abc"[b]), placed(rng)) for b in range(rng.integers(1, 4))
    ]
    couplings = []
    for number, joint in enumerate(joints[1:], start=1):
        if rng.random() < 0.3:
            led = rng.choice(number, min(number, int(rng.integers(1, 3))), replace=False)
            ratios = tuple((joints[i].name, float(rng.choice([1.0, -1.0, 2 / 3]))) for i in led)
            couplings.append(Coupling(joint.name, ratios, 0.1, bool(rng.random() < 0.3)))
    following = {one.joint for one in couplings}
    joints = [replace(one, limits=(-np.inf, np.inf)) if one.name in following else one for one in joints]
    return Tree("random", Graph(tuple(links), tuple(joints), tips=tuple(tips), couplings=tuple(couplings)))


def configurations(tree, count, rng):
    """Within the limits, some joints at one, some at round values."""
    reach = np.where(tree.revolute, np.pi, 0.3)
    low, high = (np.where(np.isinf(tree.limits), reach[:, None] * [-1.0, 1.0], tree.limits)).T
    q = rng.uniform(low, high, (count, tree.n))
    kind = rng.random(q.shape)
    q = np.where(kind < 0.1, low, np.where(kind < 0.2, high, q))
    return np.where((kind > 0.8) & tree.revolute, np.clip(np.round(q / (np.pi / 2)) * (np.pi / 2), low, high), q)
