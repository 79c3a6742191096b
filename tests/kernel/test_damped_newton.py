"""Damped Newton steps: what they end at, that rows do not touch each other, and that limits hold."""

from __future__ import annotations

import numpy as np
import pytest

from robokin.kernel.damped_newton import (
    Judged,
    Trial,
    brought_down,
    held_at,
    led_down,
    limited,
    singular_step,
    solved,
)


def circle(rows, x):
    """Errors and Jacobians of points x (k, 2) that should lie on the unit circle and on the line x = y."""
    e = np.stack([1.0 - np.sum(x * x, axis=1), x[:, 1] - x[:, 0]], axis=1)
    J = np.stack([2.0 * x, np.broadcast_to([1.0, -1.0], x.shape)], axis=1)
    return e, J


def step(rows, x, e, J):
    return limited(singular_step(J, e, 0.01 * np.sum(e * e, axis=1)), 0.3)


def down(x, low=-np.inf, high=np.inf):
    bounds = np.full(2, low), np.full(2, high)
    return brought_down(circle, step, x, *bounds, steps=40, arrived=1e-28)


def test_steps_end_at_a_zero_and_rows_are_alone(rng):
    x = rng.uniform(0.1, 3.0, (30, 2))
    ends, errors = down(x)
    assert np.allclose(ends, np.sqrt(0.5), rtol=0, atol=1e-12)
    assert np.max(np.abs(errors)) < 1e-13
    for i in (0, 7, 29):
        assert np.allclose(down(x[i : i + 1])[0][0], ends[i], rtol=0, atol=1e-14)
    assert [part.shape for part in down(x[:0])] == [(0, 2), (0, 2)]


def test_limits_hold_and_the_best_stays(rng):
    x = rng.uniform(0.0, 0.5, (20, 2))
    ends, errors = down(x, 0.0, 0.5)
    assert np.all((ends >= 0.0) & (ends <= 0.5))
    assert np.allclose(circle(None, ends)[0], errors)
    assert np.all(np.sum(errors**2, axis=1) <= np.sum(circle(None, x)[0] ** 2, axis=1))


def test_a_row_without_numbers_disturbs_none(rng):
    x = rng.uniform(0.5, 1.0, (3, 2))
    x[1] = np.nan
    assert np.allclose(down(x)[0][[0, 2]], np.sqrt(0.5))


def led(x, axis=0, steps=200, arrive=1e-12):
    """Gradient steps on Rosenbrock's function of points x (k, 2), or (2, k), their lengths following their success."""

    def look(rows, x):
        a, b = x if axis else x.T
        slope = np.stack([2.0 * (a - 1.0) - 40.0 * a * (b - a * a), 20.0 * (b - a * a)], axis=0 if axis else 1)
        return (a - 1.0) ** 2 + 10.0 * (b - a * a) ** 2, slope

    def step(rows, x, here, trust):
        reach = trust[0] if axis else trust[0][:, None]
        return Trial(x - reach * here[1], trust, here[0] > arrive)

    def judge(x, here, there, trial):
        better = there[0] < here[0]
        return Judged(better, (np.where(better, 1.5, 0.3) * trial.trust[0],), there[0] < 0.1 * arrive)

    return led_down(look, step, judge, x, (np.full(x.shape[axis], 0.1),), steps=steps, told=2, axis=axis)


@pytest.mark.parametrize("axis", [0, -1])
def test_trials_are_taken_that_lead_down_and_rows_are_alone(rng, axis):
    x = rng.uniform(-2.0, 2.0, (2, 40) if axis else (40, 2))
    x[..., 0] = 1.0
    before = x.copy()
    ends, f, slopes = led(x, axis)
    assert np.array_equal(x, before)
    start = led(x, axis, steps=0)
    assert np.array_equal(start[0], x) and np.all(f <= start[1])
    again = led(ends, axis, steps=0)
    assert np.array_equal(again[1], f) and np.array_equal(again[2], slopes)
    some = (slice(None), slice(7, 8)) if axis else slice(7, 8)
    for whole, alone in zip((ends, slopes), led(x[some], axis)[::2], strict=True):
        assert np.array_equal(whole[some], alone)
    # More steps never lead up again, and in the end all arrive.
    assert np.all(led(x, axis, steps=300)[1] <= f)
    assert np.max(led(x, axis, steps=5000)[1]) <= 1e-12


def test_rows_first_and_rows_last_are_the_same(rng):
    x = rng.uniform(-2.0, 2.0, (30, 2))
    for rows, columns in zip(led(x), led(np.ascontiguousarray(x.T), -1), strict=True):
        assert np.array_equal(rows, columns.T)


def test_no_rows_and_a_row_without_numbers_end_nothing(rng):
    assert [part.shape for part in led(np.zeros((0, 2)))] == [(0, 2), (0,), (0, 2)]
    x = rng.uniform(0.5, 1.0, (3, 2))
    x[1] = np.nan
    ends, f, _ = led(x, steps=5000)
    assert np.isnan(ends[1]).all() and np.max(f[[0, 2]]) <= 1e-12


def test_held_and_limited():
    x, low, high = np.array([[0.0, 0.5, 1.0, 1.0]]), np.zeros(4), np.ones(4)
    assert held_at(x, low, high, np.array([[-1.0, 1.0, 1.0, -1.0]])).tolist() == [[True, False, True, False]]
    assert limited(np.array([[4.0, 2.0], [0.5, -1.0]]), 2.0).tolist() == [[2.0, 1.0], [0.5, -1.0]]
    assert limited(np.array([[4.0], [2.0]]), 2.0, axis=0).tolist() == [[2.0], [1.0]]


def test_the_singular_step_is_that_of_the_normal_equations(rng):
    J, e, damping = rng.normal(size=(10, 6, 7)), rng.normal(size=(10, 6)), rng.uniform(0.1, 1.0, 10)
    M = np.swapaxes(J, 1, 2) @ J + damping[:, None, None] * np.eye(7)
    expected = np.linalg.solve(M, (np.swapaxes(J, 1, 2) @ e[:, :, None]))[:, :, 0]
    assert np.allclose(singular_step(J, e, damping), expected)


def test_symmetric_systems_by_their_upper_triangles(rng):
    for n in (1, 2, 6):
        A = rng.normal(size=(20, n, n))
        A = A @ np.swapaxes(A, 1, 2) + 0.1 * np.eye(n)
        b = rng.normal(size=(n, 20))
        upper = np.triu(A) + np.tril(np.full((n, n), np.nan), -1)
        x, D, y = solved(np.ascontiguousarray(upper.transpose(1, 2, 0)), b)
        assert np.allclose(np.einsum("sij,js->is", A, x), b)
        assert np.allclose(np.prod(D, axis=0), np.linalg.det(A))
        # bᵀ A⁻¹ b is the sum of y² / D.
        assert np.allclose(np.sum(y * y / D, axis=0), np.sum(b * x, axis=0))
