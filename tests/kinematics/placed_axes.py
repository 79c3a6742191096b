"""Random chains whose neighbouring axes lie to each other in every way that axes can."""

from __future__ import annotations

import numpy as np

import robokin
from robokin.formats import library_names, load_any
from robokin.kernel.chain import chain_of, chain_size
from robokin.model import Joint, JointType, Robot
from robokin.spatial import rotation_from_rpy, transform

WAYS = ("skew", "parallel", "antiparallel", "coincident", "turned round", "intersecting", "right angle", "any")
RIGHT = np.pi / 2
SAME = 1e-12

ROBOTS = [name for name in library_names() if isinstance(load_any(name), Robot)]


def step_between(rng, way):
    """The pose of the next joint's frame: its z lies to this one's as the way says."""
    spin = rotation_from_rpy([0.0, 0.0, rng.choice([0.0, RIGHT, -RIGHT, np.pi, rng.uniform(-3, 3)])])
    twist = {"skew": rng.uniform(0.2, 2.9), "intersecting": rng.uniform(0.2, 2.9), "right angle": RIGHT,
             "antiparallel": np.pi, "turned round": np.pi}.get(way, 0.0)  # fmt: skip
    p = rng.normal(size=3) * (rng.random(3) < 0.7)
    if way in ("coincident", "turned round"):
        p[:2] = 0.0
    if way == "any":
        return transform(rotation_from_rpy(rng.uniform(-3, 3, 3)), p)
    R = spin @ rotation_from_rpy([twist, 0.0, 0.0]) @ rotation_from_rpy([0.0, 0.0, rng.choice([0.0, 0.4, RIGHT])])
    if way in ("intersecting", "right angle") and rng.random() < 0.7:
        p = np.array([0.0, 0.0, rng.normal()]) + R[:, 2] * rng.normal()
    return transform(R, p)


def placed_chain(rng, n=None):
    """A robot of frames with n joints (1 to 8): turning and sliding, first and last too, of either sense."""
    n = int(rng.integers(1, 9)) if n is None else n
    rows = []
    for i in range(n):
        kind = JointType.PRISMATIC if rng.random() < 0.25 else JointType.REVOLUTE
        axis = [[0, 0, 1.0], [0, 0, 1.0], [0, 0, -1.0], [1.0, 0, 0], [0.6, 0.0, 0.8]][rng.integers(5)]
        rows.append(
            Joint(
                f"j{i + 1}",
                kind,
                offset=rng.choice([0.0, RIGHT, 0.3]),
                limits=(-1.5, 2.5) if rng.random() < 0.5 else (-np.inf, np.inf),
                origin=step_between(rng, rng.choice(WAYS)),
                axis=np.array(axis),
                sense=1 if rng.random() < 0.8 else -1,
            )
        )
        if rng.random() < 0.15:
            rows.append(Joint(f"f{i + 1}", JointType.FIXED, origin=step_between(rng, rng.choice(WAYS))))
    ends = [step_between(rng, "any") if rng.random() < 0.5 else np.eye(4) for _ in "bt"]
    return Robot("random chain", tuple(rows), "frames", base=ends[0], tool=ends[1])


def deviation(one, other, seed=0):
    """How far the poses of two robots are apart, in the size of the arm."""
    q = np.random.default_rng(seed).uniform(-3, 3, (5, one.n))
    size = chain_size(chain_of(one))
    q = np.where(one.revolute, q, q * size)
    off = np.abs(robokin.forward_kinematics(one, q) - robokin.forward_kinematics(other, q))
    return max(np.max(off[:, :3, 3]) / size, np.max(off[:, :3, :3]))


def kept(one, other):
    """What a change of convention leaves as it is."""
    assert [joint.name for joint in one.joints] == [joint.name for joint in other.joints]
    assert one.types == other.types
    assert np.array_equal(one.limits, other.limits)
    assert np.array_equal(one.senses, other.senses)
    assert {name: list(q) for name, q in one.poses.items()} == {name: list(q) for name, q in other.poses.items()}
    assert (one.name, one.id, one.units, one.source) == (other.name, other.id, other.units, other.source)
