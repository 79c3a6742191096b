"""Self-motions in a batch are those of each pose alone, looked for when they are asked for."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from sweeps import sweep

import robokin


def same(one, other):
    """Two results have the same self-motions, to the last digit."""
    assert one.families_complete == other.families_complete
    assert len(one.families) == len(other.families)
    for f, g in zip(one.families, other.families, strict=True):
        assert (f.joints, f.dimension, f.closed, f.solution) == (g.joints, g.dimension, g.closed, g.solution)
        for a, b in zip(f.arcs, g.arcs, strict=True):
            assert (a.whole, a.swivel) == (b.whole, b.swivel)
            assert np.array_equal(a.q, b.q)


@pytest.mark.parametrize(
    ("name", "options"),
    sweep(
        [
            ("iiwa14", {}),
            ("iiwa14", {"most": 3}),
            ("rm75", {"turns": True}),
            ("iiwa14", {"limits": False, "near": np.full(7, 0.3)}),
            ("iiwa14", {"hold": {3: 0.9}}),
            ("panda", {}),
            ("human-arm", {"most": 2}),
        ],
        5,
    ),
)
def test_a_batch_lists_the_self_motions_of_each_pose(name, options, rng):
    robot = robokin.load(name)
    low, high = np.where(np.isinf(robot.limits), np.array([-1.0, 1.0]), robot.limits).T
    q = rng.uniform(low, high, (2, robot.n))
    if "hold" in options:
        q[:, 3] = 0.9
    T = robokin.forward_kinematics(robot, q)
    batch = robokin.solve_ik(robot, T, **options)
    for i in (1, 0):
        alone = robokin.solve_ik(robot, T[i], **options)
        same(batch[i], alone)
        for solution, other in zip(batch[i], alone, strict=True):
            assert np.array_equal(solution.q, other.q)
            assert (solution.free, solution.branch) == (other.free, other.branch)


def test_copies_keep_what_was_not_asked_for_yet(rng):
    robot = robokin.load("iiwa14")
    T = robokin.forward_kinematics(robot, rng.uniform(*robot.limits.T, (2, 7)))
    alone = robokin.solve_ik(robot, T[1])
    batch = robokin.solve_ik(robot, T)
    result = batch[1]
    assert "families" not in vars(result)
    same(pickle.loads(pickle.dumps(result)), alone)
    same(pickle.loads(pickle.dumps(batch))[1], alone)
    same(result, alone)
    assert "families" in vars(result)
    with pytest.raises(AttributeError, match="no attribute 'family'"):
        _ = result.family


def test_arms_without_a_joint_to_spare_have_them_at_once(rng):
    robot = robokin.load("puma560")
    q = np.array([[0.1, 0.2, 0.3, 0.4, 0.0, 0.2], [0.1, 0.2, 0.3, 0.4, 0.5, 0.2]])
    batch = robokin.solve_ik(robot, robokin.forward_kinematics(robot, q))
    assert [len(vars(result)["families"]) > 0 for result in batch] == [True, False]
