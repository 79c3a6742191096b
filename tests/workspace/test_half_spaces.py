"""What linear inequalities leave: shadows, hulls and points, against every point of a fine grid or a draw."""

from __future__ import annotations

import numpy as np
import pytest

from robokin.workspace.half_spaces import HalfSpaces


def drawn(seed, n):
    """A box and some inequalities that its middle satisfies."""
    rng = np.random.default_rng((seed, 0x4A1F))
    low, high = -rng.uniform(0.2, 2.0, n), rng.uniform(0.2, 2.0, n)
    G = rng.choice([-1.0, 0.0, 1.0, 0.5], (3, n))
    return low, high, HalfSpaces.of(G, rng.uniform(0.05, 1.0, 3))


@pytest.mark.parametrize("seed", range(12))
def test_hull_and_shadow_hold_what_is_there_and_no_more(seed):
    n = 2 + seed % 3
    low, high, cuts = drawn(seed, n)
    rng = np.random.default_rng(seed)
    u = low[:, None] + (high - low)[:, None] * rng.random((n, 400_000))
    u = u[:, cuts.contains(u)]
    least, greatest = cuts.hull(low, high)
    assert np.all(u.min(axis=1) >= least - 1e-12)
    assert np.all(u.max(axis=1) <= greatest + 1e-12)
    # A draw comes near every end, but for narrow corners of four dimensions.
    room = 0.1 if n < 4 else 0.4
    assert np.all(u.min(axis=1) - least < room)
    assert np.all(greatest - u.max(axis=1) < room)
    shadow = cuts.joined(HalfSpaces.box(low, high)).shadow([0, 1])
    assert not shadow.linked[2:].any()
    assert np.all(shadow.contains(u))
    # Whatever is in the shadow has values of the others.
    v = low[:, None] + (high - low)[:, None] * rng.random((n, 300))
    v = v[:, shadow.contains(v)]
    whole = cuts.joined(HalfSpaces.box(low, high))
    for i in range(v.shape[1]):
        fixed = whole.at(0, v[0, i]).at(1, v[1, i])
        for j in range(2, n):
            one = fixed.shadow([j])
            a, b = one.ranges(j, np.zeros((n, 1)))
            assert not one.empty
            assert a[0] <= b[0] + 1e-9


@pytest.mark.parametrize("seed", range(6))
def test_points_fill_what_is_left_to_its_ends(seed):
    n = 2 + seed % 2
    low, high, cuts = drawn(seed, n)
    u = np.random.default_rng(seed).random((n, 20_000))
    u[:, ::2] = np.clip(1.6 * u[:, ::2] - 0.3, 0.0, 1.0)
    q = cuts.filled(u, low, high)
    assert np.all(cuts.contains(q))
    assert np.all((q >= low[:, None] - 1e-12) & (q <= high[:, None] + 1e-12))
    least, greatest = cuts.hull(low, high)
    np.testing.assert_allclose(q[0].min(), least[0], atol=1e-9)
    np.testing.assert_allclose(q[0].max(), greatest[0], atol=1e-9)
    for row, h in zip(cuts.cutting(low, high).G, cuts.cutting(low, high).h, strict=True):
        assert np.max(row @ q - h) > -0.1


def test_what_cuts_nothing_and_what_leaves_nothing_is_known():
    low, high = np.zeros(2), np.ones(2)
    wide = HalfSpaces.of(np.array([[1.0, 1.0], [1.0, -1.0]]), np.array([2.5, 0.5]))
    assert len(wide.cutting(low, high).h) == 1
    none = HalfSpaces.of(np.array([[1.0, 1.0], [-1.0, -1.0]]), np.array([0.5, -0.7]))
    least, greatest = none.hull(low, high)
    assert np.any(least > greatest)
    unbounded = HalfSpaces.of(np.array([[1.0, -1.0], [-1.0, 1.0]]), np.array([0.5, 0.5]))
    least, greatest = unbounded.hull(np.array([0.0, -np.inf]), np.array([1.0, np.inf]))
    np.testing.assert_allclose([least, greatest], [[0.0, -0.5], [1.0, 1.5]])
