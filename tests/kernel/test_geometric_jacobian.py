"""The geometric Jacobian is the derivative of frames: by complex steps, in base and tool, for one and for many."""

from __future__ import annotations

import numpy as np
import pytest
from kernel.test_frames import chains

from robokin.kernel.chain import Chain
from robokin.kernel.frames import frames
from robokin.kernel.geometric_jacobian import BLOCK, jacobian, jacobian_of, motion
from robokin.kernel.sweep import sweep, twists
from robokin.spatial import rotation_from_rpy, transform

STEP = 1e-30
"""An imaginary step has no rounding: f'(q) = Im f(q + i STEP) / STEP to the last digit."""


def by_complex_steps(chain, q):
    """(6, n) the tool's twist by each joint at q (n,), from complex frames alone."""
    values = (q + chain.offsets)[:, None] + 1j * STEP * np.eye(chain.n)
    _, X = sweep(chain.constants[1:], chain.revolute, values, chain.constants[0])
    R, D = X[:3].real.transpose(2, 1, 0), X.imag.transpose(2, 1, 0) / STEP
    W = D[:, :, :3] @ R.transpose(0, 2, 1)
    return np.stack([*D[:, :, 3].T, W[:, 2, 1], W[:, 0, 2], W[:, 1, 0]])


def test_it_is_the_derivative(rng):
    for chain in chains(rng):
        if not chain.n:
            continue
        q = rng.uniform(-3, 3, chain.n)
        assert np.allclose(jacobian(chain, q), by_complex_steps(chain, q), rtol=0, atol=1e-11)


def test_base_and_tool_differ_by_the_tool_s_rotation(rng):
    for chain in chains(rng):
        q = rng.uniform(-3, 3, (4, chain.n))
        R = frames(chain, q)[:, -1, :3, :3]
        base, tool = jacobian(chain, q), jacobian(chain, q, "tool")
        for rows in (slice(3), slice(3, 6)):
            assert np.allclose(R @ tool[:, rows], base[:, rows], rtol=0, atol=1e-11)


@pytest.mark.parametrize("shape", [(), (1,), (2, 3), (0, 2)])
def test_any_leading_shape(shape, rng):
    chain = list(chains(rng))[5]
    q = rng.uniform(-3, 3, (*shape, chain.n))
    J = jacobian(chain, q)
    assert J.shape == (*shape, 6, chain.n)
    for where in np.ndindex(shape):
        assert np.array_equal(J[where], jacobian(chain, q[where]))


def test_lengths_in_sizes(rng):
    for chain in chains(rng):
        q, size = rng.uniform(-3, 3, (3, chain.n)), 2.5
        expected = jacobian(chain, q)
        expected[:, :3, chain.revolute] /= size
        assert np.allclose(jacobian(chain, q, size=size), expected, rtol=0, atol=1e-12)


def test_of_a_frame_in_the_tool(rng):
    G = transform(rotation_from_rpy(rng.uniform(-1, 1, 3)), rng.normal(size=3))
    for chain in chains(rng):
        q = rng.uniform(-3, 3, (2, chain.n))
        F = frames(chain, q)
        F[:, -1] = F[:, -1] @ G
        longer = Chain(np.concatenate([chain.constants[:-1], chain.constants[-1:] @ G]), chain.revolute,
                             chain.offsets)  # fmt: skip
        assert np.allclose(jacobian_of(F, chain.revolute), jacobian(longer, q), rtol=0, atol=1e-11)


@pytest.mark.parametrize("count", [0, 1, 5, BLOCK + 3])
def test_columns_say_the_same(count, rng):
    for chain in chains(rng, 4):
        q, size = rng.uniform(-3, 3, (count, chain.n)), 1.7
        J, F = jacobian(chain, q, size=size), frames(chain, q)
        linear, axes, tool = motion(chain, np.ascontiguousarray(q.T), size)
        assert np.allclose(linear.transpose(2, 1, 0), J[:, :3], rtol=0, atol=1e-12)
        assert np.allclose(axes.transpose(2, 0, 1), F[:, :-1, :3, 2], rtol=0, atol=1e-12)
        assert np.allclose(tool.transpose(2, 1, 0), F[:, -1, :3], rtol=0, atol=1e-12)


def test_twists_are_the_jacobian_of_the_point_at_the_origin(rng):
    for chain in chains(rng):
        q = rng.uniform(-3, 3, (3, chain.n))
        axes, _ = sweep(chain.constants[1:], chain.revolute, np.ascontiguousarray((q + chain.offsets).T),
                        chain.constants[0])  # fmt: skip
        F = frames(chain, q)
        F[:, -1, :3, 3] = 0.0
        assert np.allclose(twists(axes, chain.revolute).transpose(2, 1, 0), jacobian_of(F, chain.revolute), atol=1e-11)
