"""The native kernel tells solutions apart, lists them and brings them on as Python's code does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from inverse.loops import named
from library_entries import entry

import robokin
from robokin.inverse import verify
from robokin.inverse.elimination import complex_newton
from robokin.inverse.elimination.complex_newton import distinct, regular
from robokin.inverse.elimination.loop import native_loop
from robokin.inverse.second_look import EXACT, FINE, LEAST, LONGEST, finely_closed
from robokin.inverse.self_motion import pose_correction
from robokin.inverse.self_motion.pose_correction import least_squares
from robokin.inverse.verify import Found, distinct_and_close, told_by_tables
from robokin.kernel import native_kernel
from robokin.kernel.chain import chain_of, chain_size
from robokin.kernel.native_kernel import handle
from robokin.kernel.residual import error_and_jacobian

native = native_kernel.native
pytestmark = pytest.mark.skipif(native is None, reason="no native kernel in use")


def listed(rng, revolute, targets):
    """Solutions of some targets: single ones, equal ones, some beside each other, at half turns and in one cell."""
    n = len(revolute)
    parts = []
    for target in range(targets):
        q = rng.uniform(-4.0, 4.0, (rng.integers(1, 9), n))
        q[rng.random(q.shape) < 0.2] = rng.choice([-np.pi, np.pi, 0.0, -0.0, np.pi / 2, -np.pi + 3e-10])
        again = q[rng.integers(0, len(q), 6)]
        away = rng.choice([0.0, 1e-9, 4e-7, 3e-6, 5e-5, 1e-3], (6, 1)) * rng.choice([-1.0, 1.0], again.shape)
        again = again + away + np.where(revolute, 2 * np.pi * rng.integers(-1, 2, again.shape), 0.0)
        q = np.concatenate([q, again])
        parts.append((np.full(len(q), target), q))
    index, q = (np.concatenate(part) for part in zip(*parts, strict=True))
    order = rng.permutation(len(index))
    off = 10.0 ** rng.uniform(-16, -9, (2, len(index)))
    return Found(index[order], q[order], *off)


@pytest.mark.parametrize("name", ["crx10ia", "stanford", "scara", "panda"])
def test_lists_are_alike(name, rng):
    robot = entry(name)
    for _ in range(20):
        found = listed(rng, robot.revolute, 12)
        expected, equal, close = told_by_tables(found, robot.revolute, 0.7)
        got, same, near = distinct_and_close(found, robot.revolute, 0.7)
        for field in ("index", "q", "position", "angle"):
            assert np.array_equal(getattr(got, field), getattr(expected, field))
        assert np.array_equal(equal, same)
        assert np.array_equal(close, near)


def test_lists_of_targets_alone_are_those_among_others(rng):
    revolute = entry("crx10ia").revolute
    found = listed(rng, revolute, 30)
    every = distinct_and_close(found, revolute, 1.0)[0]
    for target in (0, 17, 29):
        alone = distinct_and_close(found.pick(found.index == target), revolute, 1.0)[0]
        assert np.array_equal(every.q[every.index == target], alone.q)


@pytest.mark.parametrize("name", ["crx10ia", "ur5e", "stanford"])
def test_complex_solutions_are_told_apart_alike(name, rng, monkeypatch):
    loop = named(name)
    z = rng.uniform(-3.0, 3.0, (60, 6)) + 1j * rng.normal(size=(60, 6))
    z = z[rng.integers(0, 60, 200)] + np.where(loop.revolute, 2 * np.pi * rng.integers(-2, 3, (200, 6)), 0.0)
    z += rng.choice([0.0, 1e-9, 1e-3], (200, 1))
    index = rng.integers(0, 5, 200)
    for apart in (1e-4, 10.0 ** rng.uniform(-7, -2, 200)):
        got = distinct(loop, index, z, apart)
        with monkeypatch.context() as patch:
            patch.setattr(complex_newton, "native", None)
            expected = distinct(loop, index, z, apart)
        for target in range(5):
            # Of equal ones any may stay.
            assert np.sum(got[index == target]) == np.sum(expected[index == target])
    assert distinct(loop, index[:0], z[:0]).shape == (0,)


@pytest.mark.parametrize("name", ["crx10ia", "ur5e", "stanford"])
def test_regular_solutions_are_those_of_singular_values(name, rng, instructions, monkeypatch):
    loop = named(name)
    q = rng.uniform(-3.0, 3.0, (400, 6)) + 0j
    q[:200] += 1j * rng.normal(size=(200, 6))
    q[300:] = q[300:].real * (rng.random((100, 6)) < 0.4) + 10.0 ** rng.uniform(-9, -1, (100, 1))
    q[5, 2], q[6, 3], q[7, 1] = np.nan, 1j * 900.0, np.inf
    residual = 10.0 ** rng.uniform(-17, -8, 400)
    for least in (1e-7, 1e-6, 1e-4, 1e-2):
        with np.errstate(all="ignore"):
            got = regular(loop, q, residual, least)
            with monkeypatch.context() as patch:
                patch.setattr(complex_newton, "native", None)
                expected = regular(loop, q, residual, least)
        assert np.array_equal(got, expected)
        assert 0 < np.sum(got) < 400
        assert np.array_equal(regular(loop, q[7:9], residual[7:9], least), got[7:9])


@pytest.mark.parametrize("name", ["crx10ia", "ur5e", "scara", "stanford"])
def test_last_steps_lead_as_far_as_those_of_python(name, rng, instructions):
    robot = entry(name)
    chain, size = chain_of(robot), chain_size(chain_of(robot))
    q = np.radians(30.0) * rng.integers(-5, 6, (40, robot.n))
    q[:20] = rng.uniform(-2.0, 2.0, (20, robot.n))
    q = np.where(robot.revolute, q, 0.1 * q)
    T = robokin.forward_kinematics(robot, q)
    start = q + 1e-6 * rng.normal(size=q.shape)
    start[3], start[4] = q[3], q[4] + 0.3
    error, _ = error_and_jacobian(chain, T, start, size)
    known = handle(chain)
    got, left = native.finely_closed(known, T, start, error, size, FINE, LONGEST, LEAST, EXACT)
    expected, wished = start.copy(), error.copy()
    finely_closed(chain, T, expected, wished, size)
    off, least = (np.max(np.abs(part), axis=1) for part in (left, wished))
    assert np.all(np.abs(off - least) <= 1e-13 + 1e-3 * least)
    assert np.allclose(got[:20], expected[:20], rtol=0, atol=1e-9)
    assert np.array_equal(error_and_jacobian(chain, T, got, size)[0], left)
    alone = native.finely_closed(known, T[7:8], start[7:8], error[7:8], size, FINE, LONGEST, LEAST, EXACT)
    assert np.array_equal(alone[0][0], got[7])


@pytest.mark.parametrize("shape", [(6, 6), (7, 7), (6, 7), (7, 3), (3, 4), (2, 5)])
def test_shortest_steps_are_those_of_python(shape, rng, instructions, monkeypatch):
    A, b = rng.normal(size=(37, *shape)), rng.normal(size=(37, shape[0]))
    A[::3, -1], A[1::3, -1] = A[::3, 0], A[1::3, 0] + 1e-9
    dx = least_squares(A, b)
    monkeypatch.setattr(pose_correction, "native", None)
    assert np.allclose(dx, least_squares(A, b), rtol=1e-6, atol=1e-6)
    assert np.array_equal(dx[4:5], native.shortest(A[4:5], b[4:5], 1e-7))


def test_all_instructions_give_the_same_digits(rng):
    before, loop, chain = native.instructions(), native_loop(named("crx10ia")), chain_of(entry("panda"))
    z, A, b = rng.normal(size=(21, 12)), rng.normal(size=(21, 6, 7)), rng.normal(size=(21, 6))
    q = rng.normal(size=(21, 7))
    T = robokin.forward_kinematics(entry("panda"), q + 1e-3)
    error = error_and_jacobian(chain, T, q, 1.0)[0]

    def answers():
        return [
            native.regular(loop, z, np.full(21, 0.1)),
            native.shortest(A, b, 1e-7),
            *native.finely_closed(handle(chain), T, q, error, 1.0, 6, 0.1, 1e-9, 1e-14),
        ]

    native.instructions("base")
    expected = answers()
    native.instructions(before)
    assert all(np.array_equal(got, wish) for got, wish in zip(answers(), expected, strict=True))


def test_what_is_no_number_is_sorted_too(rng):
    revolute = np.ones(6, dtype=bool)
    found = listed(rng, revolute, 20)
    q = found.q.copy()
    q[rng.random(q.shape) < 0.1] = np.nan
    q[3, 2], q[7, 1] = np.inf, -np.inf
    with np.errstate(all="ignore"):
        got, _, _ = distinct_and_close(replace(found, q=q), revolute, 1.0)
    sound = np.isfinite(q).all(axis=1)
    expected = told_by_tables(found.pick(sound), revolute, 1.0)[0]
    kept = np.isfinite(got.q).all(axis=1)
    assert set(map(bytes, got.q[kept])) == set(map(bytes, expected.q))


def test_arrays_that_do_not_fit_are_refused():
    one, loop, arm = np.ones, native_loop(named("crx10ia")), handle(chain_of(entry("panda")))
    index, told = np.zeros(3, dtype=np.intp), (verify.CELLS, one(6), verify.THRESHOLDS)
    weights = one((3, 6))
    fine = (arm, one((3, 4, 4)), one((3, 7)), one((3, 6)), 1.0, 3, 0.1, 1e-9, 1e-14)
    for wrong in (
        lambda: native.arranged(index, one((2, 6)), one(3), one(6), 1.0, *told),
        lambda: native.arranged(index, one((3, 5)), one(3), one(6), 1.0, *told),
        lambda: native.arranged(index, one((3, 6)), one(2), one(6), 1.0, *told),
        lambda: native.arranged(index - 1, one((3, 6)), one(3), one(6), 1.0, *told),
        lambda: native.arranged(index + 2**40, one((3, 6)), one(3), one(6), 1.0, *told),
        lambda: native.arranged(index, one((3, 6)), one(3), one(6), 1.0, one(3), *told[1:]),
        lambda: native.arranged(index, one((3, 6)), one(3), one(6), 1.0, told[0], one(5), told[2]),
        lambda: native.each_once(one(5), weights, index, one((3, 12)), one(3), 4),
        lambda: native.each_once(one(6), weights, index, one((3, 11)), one(3), 4),
        lambda: native.each_once(one(6), one((2, 6)), index, one((3, 12)), one(3), 4),
        lambda: native.each_once(one(6), weights, index, one((3, 12)), one(2), 4),
        lambda: native.regular(arm, one((3, 12)), one(3)),
        lambda: native.regular(loop, one((3, 11)), one(3)),
        lambda: native.regular(loop, one((3, 12)), one(4)),
        lambda: native.shortest(one((3, 6, 7)), one((3, 5)), 1e-7),
        lambda: native.shortest(one((3, 8, 7)), one((3, 8)), 1e-7),
        lambda: native.shortest(one((3, 6, 17)), one((3, 6)), 1e-7),
        lambda: native.finely_closed(loop, *fine[1:]),
        lambda: native.finely_closed(*fine[:5], -1, *fine[6:]),
        lambda: native.finely_closed(*fine[:3], one((3, 5)), *fine[4:]),
    ):
        with pytest.raises(ValueError, match=r"fit|steps|six|numbers of targets"):
            wrong()
    for few in (native.arranged, native.each_once, native.regular, native.shortest, native.finely_closed):
        with pytest.raises(TypeError):
            few(loop)
    for thresholds in ((1.0, 2.0), None, 1.0, one(4)):
        with pytest.raises(TypeError):
            native.arranged(index, one((3, 6)), one(3), one(6), 1.0, *told[:2], thresholds)
    assert native.each_once(one(6), weights, index, one((3, 12)), one(3), 2**63 - 1).sum() == 1
    with pytest.raises(TypeError):
        native.arranged(None, one((3, 6)), one(3), one(6), 1.0, *told)
