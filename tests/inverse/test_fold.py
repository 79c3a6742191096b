"""Double roots to full digits: found, told from self-motions, and judged by how far the target is from the fold."""

from __future__ import annotations

import numpy as np
import pytest

import robokin
from robokin.inverse.elimination.loop import chain_size
from robokin.inverse.self_motion.fold import to_fold
from robokin.inverse.self_motion.singular_solutions import classify
from robokin.kernel.chain import chain_of
from robokin.spatial import rotation_transform

STRETCHED = float(np.arctan2(433.07, -20.32))  # the PUMA's elbow: a3 = -20.32 mm, d4 = 433.07 mm

FOLDS = [
    ("ur5e", 2, 0.0),
    ("puma560", 2, STRETCHED),
    ("adept-one", 1, 0.0),
    ("scara", 1, 0.0),
    ("planar3r", 1, 0.0),
    ("scorbot", 2, 0.0),
]


def at_fold(name, joint, value, rng, count=60):
    robot = robokin.load(name)
    low, high = np.where(np.isinf(robot.limits), [-2.0, 2.0], robot.limits).T
    q = rng.uniform(low, high, (count, robot.n))
    q[:, joint] = value
    chain = chain_of(robot)
    return robot, chain, chain_size(chain), q, robokin.forward_kinematics(robot, q)


@pytest.mark.parametrize(("name", "joint", "value"), FOLDS)
def test_a_double_root_has_full_digits(name, joint, value, rng):
    robot, chain, size, q, T = at_fold(name, joint, value, rng)
    seeds = q + rng.normal(size=q.shape) * 1e-5 * np.where(robot.revolute, 1.0, size)
    local = classify(chain, T, seeds, size)
    assert np.all(local.dimension == 0)
    assert np.mean(local.double) >= 0.95
    assert np.max(np.abs(local.q - q)[local.double]) < 1e-12
    fold = to_fold(chain, T, seeds, size)
    assert np.max(np.abs(fold.q - q)[fold.double]) < 1e-12


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("xarm6", (30, -90, -90, 0, 180, -150)),  # three solutions merge
        ("xarm6", (-180, 0, -180, -180, 180, -180)),
        ("ur5e", (90, -180, 0, -90, 180, 0)),  # shoulder, elbow or wrist at once: four
        ("ur5e", (-150, 90, 0, -90, -180, -60)),  # three null vectors
        ("tx2-60", (-90, 0, 0, 0, 90, 90)),
        ("cr5", (0, -180, 0, -180, 90, 90)),
    ],
)
@pytest.mark.parametrize("noise", [1e-8, 1e-6, 3e-5])
def test_a_multiple_root_has_full_digits(name, values, noise, rng):
    robot, q = robokin.load(name), np.radians(values)
    chain = chain_of(robot)
    local = classify(
        chain, robokin.forward_kinematics(robot, q), q + noise * rng.normal(size=(4, 6)), chain_size(chain)
    )
    assert local.dimension.tolist() == [0] * 4
    assert local.double.all()
    assert np.max(np.abs(local.q - q)) < 1e-12


def test_a_double_root_at_a_limit_is_within_the_limits(rng):
    robot, chain, size, q, T = at_fold("adept-one", 1, 0.0, rng)
    q[:, 0] = np.where(rng.random(len(q)) < 0.5, *robot.limits[0])
    T = robokin.forward_kinematics(robot, q)
    seeds = q + rng.normal(size=q.shape) * 1e-6 * np.where(robot.revolute, 1.0, size)
    assert not robot.within_limits(seeds).all()
    fold = to_fold(chain, T, seeds, size)
    assert fold.double.all()
    assert robot.within_limits(fold.q).all()


@pytest.mark.parametrize("off", [1e-10, 1e-8, 1e-6])
def test_a_target_beside_the_fold_is_not_at_it(off, rng):
    """Its two solutions, or none, are √off apart; the fold itself misses the target by about `off`."""
    robot, chain, size, q, _ = at_fold("ur5e", 2, 0.0, rng, 20)
    q[:, 2] = np.sqrt(off)
    T = robokin.forward_kinematics(robot, q)
    fold = to_fold(chain, T, q, size)
    found = np.isfinite(fold.mu)
    assert np.mean(found) >= 0.9
    assert not fold.double.any()
    assert np.all((fold.mu[found] > 1e-4 * off) & (fold.mu[found] < off))
    assert np.allclose(fold.q[found, 2], 0.0, rtol=0, atol=1e-9)


def test_a_self_motion_is_no_fold(rng):
    for name, joint in (("puma560", 4), ("ur5e", 4)):
        _, chain, size, q, T = at_fold(name, joint, 0.0, rng, 20)
        fold = to_fold(chain, T, q, size)
        assert not fold.double.any()
        assert np.array_equal(fold.q, q)
        assert np.all(classify(chain, T, q, size).dimension == 1)


def test_a_regular_solution_and_a_redundant_arm_are_no_folds(rng):
    _, chain, size, q, T = at_fold("puma560", 2, 0.4, rng, 20)
    assert not to_fold(chain, T, q, size).double.any()
    _, chain, size, q, T = at_fold("panda", 2, 0.0, rng, 5)
    assert not to_fold(chain, T, q, size).double.any()


def test_the_fold_of_a_turned_target_is_beside_its_seed(rng):
    """A target so far off that its fold is elsewhere leaves the seed as it is."""
    _, chain, size, q, T = at_fold("ur5e", 2, 0.0, rng, 5)
    far = T @ rotation_transform([1.0, 0.0, 0.0], 0.5)
    fold = to_fold(chain, far, q, size)
    assert not fold.double.any()
    assert np.array_equal(fold.q[~np.isfinite(fold.mu)], q[~np.isfinite(fold.mu)])
