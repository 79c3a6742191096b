"""Random trees: every kind of joint, couplings, fixed parts, tips anywhere, names that files would read otherwise."""

from __future__ import annotations

import numpy as np
from kinematics.placed_axes import WAYS, step_between

import robokin
from robokin.errors import InputError
from robokin.model import Tree
from robokin.model.graph import Coupling, Graph, GraphJoint, Tip
from robokin.spatial import invert, z_to
from robokin.units import Units

UNITS = [Units(length, angle) for length in ("m", "cm", "mm", "in") for angle in ("rad", "deg")]

HOSTILE = ["yes", "null", "1e3", "a: b", "c\nd", 'q"u', "'", "{x}", "a #b", "-", "~", "", "[1", "x.y", "b.", ".c", "on",
           "base", "é 漢", "a\\b", "\u202e", "a,b", "%", "*x", "&y", "!", "0x1f", "12:30", "<", "world"]  # fmt: skip
"""Names of links, joints and tips that a description must quote, or cannot hold."""


def drawn_tree(rng, *, helical=True, adds=True, hostile=False, n=None):
    """A tree of some joints: chains, forks, stumps without a tip; its joints are in any order that there is.

    Joints have their axes in every way to each other. helical, adds: whether it has such joints and couplings.
    """
    n = int(rng.integers(1, 12)) if n is None else n
    parents = [int(rng.choice([i, i, rng.integers(0, i + 1)])) for i in range(n)]
    kinds = rng.choice(
        ["revolute", "prismatic", "fixed", "helical" if helical else "revolute"], n, p=[0.5, 0.2, 0.2, 0.1]
    )
    joints = []
    for i, (parent, kind) in enumerate(zip(parents, kinds, strict=True)):
        before, after = step_between(rng, rng.choice(WAYS)), np.eye(4)
        form = rng.integers(3)
        if form == 0:  # as a URDF has it: an axis in the child's frame
            A = z_to(rng.choice([[1, 0, 0], [0, -1, 0], [0, 0, -1], [0.6, 0, 0.8]]))
            before, after = before @ A, invert(A)
        elif form == 1:  # as a table has it
            after = step_between(rng, rng.choice(WAYS))
        limits = [(-np.inf, np.inf), (-1.5, 2.5), (0.0, 0.0)][rng.choice(3, p=[0.5, 0.45, 0.05])]
        zero = float(rng.choice([0.0, np.pi / 2, 0.3]))
        fixed = kind == "fixed"
        joints.append(GraphJoint(f"j{i}", str(kind), parent, i + 1, int(not fixed), before, after,
                                 pitch=0.05 if kind == "helical" else 0.0, zero=0.0 if fixed else zero,
                                 limits=(-np.inf, np.inf) if fixed else limits, row=i,
                                 motion_limits=(-1.5, 1.7) if not fixed and rng.random() < 0.1 else (-np.inf, np.inf),
                                 ))  # fmt: skip
    moving = [joint.name for joint in joints if joint.moves]
    couplings = []
    for i, name in enumerate(moving):
        if i and rng.random() < 0.25:
            own = bool(adds and rng.random() < 0.5)
            count = int(rng.integers(1, 3)) if adds else 1
            others = dict.fromkeys(rng.choice(moving[:i], count))
            ratios = tuple((str(other), float(rng.choice([1.0, -1.0, 2 / 3, 0.731, 1e-3]))) for other in others)
            couplings.append(Coupling(name, ratios, float(rng.choice([0.0, 0.2])), own))
    links = [f"l{i}" for i in range(n + 1)]
    leaves = {*range(n + 1)} - {*parents} or {0}
    tips = [Tip(f"t{link}", link, step_between(rng, "any") if rng.random() < 0.5 else np.eye(4))
            for link in range(n + 1) if rng.random() < (0.8 if link in leaves else 0.15)] or [Tip("t", n)]  # fmt: skip
    order = rng.permutation(n) if rng.random() < 0.3 else np.arange(n)
    joints = [joints[i] for i in order]
    if hostile:
        links, joints, couplings, tips = _called(rng, links, joints, couplings, tips)
    base = step_between(rng, "any") if rng.random() < 0.3 else np.eye(4)
    graph = Graph(tuple(links), tuple(joints), base=base, tips=tuple(tips), couplings=tuple(couplings))
    free = [joint for joint in couplings if not joint.own]
    poses = {"home": rng.uniform(-1.0, 1.0, len(moving) - len(free))}
    units = UNITS[rng.integers(len(UNITS))]
    try:
        return Tree("random tree", graph, "random", units=units, poses=poses)
    except InputError:  # limits of joints that follow leave nothing
        return drawn_tree(rng, helical=helical, adds=adds, hostile=hostile)


def _called(rng, links, joints, couplings, tips):
    """The same with hostile names, each once."""

    def names(count):
        return [HOSTILE[i] if i < len(HOSTILE) else f"n{i}" for i in rng.permutation(max(count, len(HOSTILE)))[:count]]

    named = dict(zip([joint.name for joint in joints], names(len(joints)), strict=True))
    fields = (
        "type",
        "parent",
        "child",
        "freedoms",
        "before",
        "after",
        "pitch",
        "zero",
        "limits",
        "row",
        "motion_limits",
    )
    joints = [GraphJoint(named[joint.name], *(getattr(joint, key) for key in fields)) for joint in joints]
    couplings = [Coupling(named[one.joint], tuple((named[other], ratio) for other, ratio in one.ratios), one.offset,
                          one.own) for one in couplings]  # fmt: skip
    tips = [Tip(name, tip.link, tip.tool) for tip, name in zip(tips, names(len(tips)), strict=True)]
    return names(len(links)), joints, couplings, tips


def values_of(tree, rng, count=4):
    """(count, n) [rad | m] values of a tree's variables."""
    return rng.uniform(-2.0, 2.0, (count, tree.n))


def tips_apart(one, q, other, p):
    """How far the poses of the tips of two trees are apart, in the lengths of the first, tip by tip in their order."""
    graph = one.graph
    steps = [T for joint in graph.joints for T in (joint.before, joint.after)] + [tip.tool for tip in graph.tips]
    size = max(sum(float(np.linalg.norm(T[:3, 3])) for T in steps), 1e-3)
    off = np.abs(robokin.tip_poses(one, q) - robokin.tip_poses(other, p))
    return max(float(np.max(off[..., :3, 3])) / size, float(np.max(off[..., :3, :3])))
