"""Frames along a chain are products of its matrices, for one configuration and for any number of them."""

from __future__ import annotations

import numpy as np
import pytest
from kinematics.chains import random_chain

from robokin.kernel.chain import chain_of
from robokin.kernel.columns import BLOCK
from robokin.kernel.frames import frames, joint_motion, pose
from robokin.kernel.sweep import sweep


def product(chain, q):
    """The frames (n + 1, 4, 4) at q (n,), one matrix after the other."""
    found = [chain.constants[0]]
    for turns, value, C in zip(chain.revolute, q + chain.offsets, chain.constants[1:], strict=True):
        c, s = np.cos(value), np.sin(value)
        J = np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]]) if turns else np.eye(4)
        J[2, 3] += 0.0 if turns else value
        found.append(found[-1] @ J @ C)
    return np.array(found)


def chains(rng, count=6):
    """Chains of each convention and of any number of joints."""
    for convention in ("standard", "modified", "frames"):
        for n in range(count):
            yield chain_of(random_chain(rng, n, convention, special=bool(n % 2)))


def test_frames_are_products_of_matrices(rng):
    for chain in chains(rng):
        q = rng.uniform(-3, 3, chain.n)
        expected = product(chain, q)
        assert np.allclose(frames(chain, q), expected, rtol=0, atol=1e-12)
        assert np.allclose(pose(chain, q), expected[-1], rtol=0, atol=1e-12)


@pytest.mark.parametrize("shape", [(), (1,), (7,), (2, 3), (2, 0, 3), (BLOCK + 1,)])
def test_any_leading_shape(shape, rng):
    chain = chain_of(random_chain(rng, 5))
    q = rng.uniform(-3, 3, (*shape, chain.n))
    F, T = frames(chain, q), pose(chain, q)
    assert (F.shape, T.shape) == ((*shape, chain.n + 1, 4, 4), (*shape, 4, 4))
    for where in [where for where in np.ndindex(shape) if sum(where) % 500 == 0]:
        assert np.array_equal(F[where], frames(chain, q[where]))
        assert np.array_equal(T[where], pose(chain, q[where]))


def test_a_sweep_comes_to_the_same_frames(rng):
    for chain in chains(rng):
        q = rng.uniform(-3, 3, (9, chain.n))
        values = np.ascontiguousarray((q + chain.offsets).T)
        axes, X = sweep(chain.constants[1:], chain.revolute, values, chain.constants[0])
        F = frames(chain, q)
        assert np.allclose(axes.transpose(3, 1, 2, 0), F[:, :-1, :3, 2:], rtol=0, atol=1e-12)
        assert np.allclose(X.transpose(2, 1, 0), F[:, -1, :3], rtol=0, atol=1e-12)


@pytest.mark.parametrize("turns", [True, False])
@pytest.mark.parametrize("kind", [float, complex])
def test_joint_motions_add_up(turns, kind, rng):
    a, b = rng.normal(size=(2, 4)).astype(kind)
    assert np.allclose(joint_motion(turns, a) @ joint_motion(turns, b), joint_motion(turns, a + b))
    assert np.array_equal(joint_motion(turns, a[0]), joint_motion(turns, a)[0])
