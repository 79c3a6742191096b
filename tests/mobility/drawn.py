"""Mechanisms without a plan: planar, spherical and spatial, with joints in one point or on a line, parallel axes, pins
of three links, links of no length, and contacts anywhere."""

from __future__ import annotations

import numpy as np
from mobility.linkages import Z, unit

from robokin.model import Mechanism, MechanismJoint

FREEDOMS = {"cylindrical": 2, "universal": 2, "spherical": 3, "planar": 3, "fixed": 0, "gear": 2, "cam": 2}
KINDS = {
    "planar": ["revolute"] * 8 + ["prismatic"] * 2 + ["gear", "cam", "rolling", "planar", "fixed"],
    "spherical": ["revolute"],
    "spatial": ["revolute"] * 6 + ["spherical"] * 2
    + ["prismatic", "helical", "cylindrical", "universal", "planar", "fixed"],
}  # fmt: skip


def drawn(rng):
    """Any mechanism."""
    space = str(rng.choice(["planar", "planar", "spherical", "spatial", "spatial"]))
    n, more = int(rng.integers(3, 9)), int(rng.integers(1, 4))
    points = _points(rng, n + more)
    pairs = [(i, int(rng.integers(0, i))) for i in range(1, n)]
    pairs += [tuple(int(x) for x in rng.choice(n, 2, replace=False)) for _ in range(more)]
    if rng.random() < 0.6:
        pairs = [(i, (i + 1) % n) for i in range(n)] + pairs[n - 1 : n + more - 2]
    few = rng.integers(-1, 2, (2, 3)).astype(float)
    even, parallel = rng.random() < 0.6, rng.random() < 0.5
    kinds = ["revolute"] * int(rng.choice([0, 0, 6, 60])) + KINDS[space]
    joints = []
    for i, (a, b) in enumerate(pairs):
        kind = str(rng.choice(kinds))
        axis = rng.integers(-1, 2, 3).astype(float) if even else rng.normal(size=3)
        axis = few[int(rng.integers(0, 2))] if parallel and rng.random() < 0.9 else axis
        at = points[rng.integers(0, len(points))].copy()
        if space == "planar":
            at[2] = 0.0
            axis = np.array([*axis[:2], 0.0]) if kind in ("prismatic", "gear", "cam") else np.array(Z)
            axis = axis if np.any(axis) else np.array([1.0, 0.0, 0.0])
        axis = unit(axis) if np.any(axis) else np.array(Z)
        if space == "spherical":
            at = axis * float(rng.integers(0, 3))
        axes = [axis, unit(np.cross(axis, rng.normal(size=3)))] if kind == "universal" else [axis]
        links = [f"l{a}", f"l{b}"]
        third = f"l{rng.integers(0, n)}"
        if kind == "revolute" and rng.random() < 0.12 and third not in links:
            links.append(third)
        pitch = float(rng.choice([0.1, 0.0, -0.1])) if kind == "helical" else 0.0
        joints.append(MechanismJoint(f"j{i}", kind, tuple(links), FREEDOMS.get(kind, 1), at, np.array(axes), pitch))
    return Mechanism("drawn", space, tuple(f"l{i}" for i in range(n)), tuple(joints), "l0")


def _points(rng, count):
    """Places (count, 3) for joints: on a grid, on a line, short ones, all one, or anywhere."""
    kind = rng.random()
    if kind < 0.3:
        return rng.integers(0, 3, (count, 3)).astype(float)
    if kind < 0.55:
        return np.outer(rng.integers(0, 5, count), [1.0, 0.0, 0.0])
    if kind < 0.65:
        return np.round(rng.normal(size=(count, 3)), 1)
    if kind < 0.7:
        return np.tile(rng.normal(size=3), (count, 1))
    return rng.normal(size=(count, 3))
