"""Followed curves in the native kernel: they run through the same places, and have the same pieces within limits."""

import numpy as np
import pytest
from library_entries import entry

import robokin
from robokin.inverse.analysis import analysis_of
from robokin.inverse.self_motion import curve_crossings, native_curves, solution_sets, spread
from robokin.inverse.self_motion.arcs import arcs_of_each
from robokin.inverse.self_motion.curve_crossings import crossings
from robokin.inverse.self_motion.solution_sets import families
from robokin.kernel.native_kernel import kernel_in_use, native

pytestmark = pytest.mark.skipif(kernel_in_use != "native", reason="compares the native kernel with Python")


def followed(robot, q):
    """The self-motions of the pose at q (n,) that a few solutions are on, with the pose."""
    analysis = analysis_of(robot)
    T = robokin.forward_kinematics(robot, q)
    seeds = np.array([one.q for one in robokin.solve_ik(robot, T, limits=False).solutions] + [q])
    sets = families(analysis.chain, T[None], seeds, analysis.size)
    return analysis, T, sets.curves[0]


def configurations(robot, rng):
    """A random one, a round one, one with a joint at its limit."""
    low, high = np.clip(robot.limits, -np.pi, np.pi).T
    q = rng.uniform(low, high, (3, robot.n))
    q[1] = np.clip(np.radians(30.0) * np.round(q[1] / np.radians(30.0)), low, high)
    q[2, 3] = low[3]
    return q


@pytest.mark.parametrize("name", ["panda", "gen72", "rizon4"])
def test_pieces_within_the_limits_are_those_of_python(name, rng, monkeypatch):
    robot = entry(name)
    for q in configurations(robot, rng):
        analysis, T, curves = followed(robot, q)
        asked = curves, analysis.chain, np.broadcast_to(T, (len(curves), 4, 4)), robot.limits, analysis.size
        quick = arcs_of_each(*asked)
        with monkeypatch.context() as patch:
            patch.setattr(native_curves, "native", None)
            slow = arcs_of_each(*asked)
        assert [[(len(arc.q), arc.whole) for arc in arcs] for arcs in quick] == [
            [(len(arc.q), arc.whole) for arc in arcs] for arcs in slow
        ]
        assert sum(len(arcs) for arcs in quick) > 0
        for mine, theirs in zip(quick, slow, strict=True):
            for one, other in zip(mine, theirs, strict=True):
                assert np.max(np.abs(one.q - other.q)) < 1e-7
                assert np.max(np.abs(robokin.forward_kinematics(robot, one.q) - T)) < 1e-9


def test_the_same_curves_run_through_a_place(rng, monkeypatch):
    robot = entry("panda")
    analysis, T, curves = followed(robot, configurations(robot, rng)[0])
    curve = curves[0]
    x = np.concatenate([curve.x[::7] + 2.0 * np.pi * rng.integers(-1, 2, (len(curve.x[::7]), 7)), curves[-1].x[:3]])
    x[1] += 1e-3
    ways = rng.normal(size=x.shape)
    ways[::2] = 0.0
    ways[: len(x) - 3][::2] = curve.tangents[::7][::2]
    many = np.broadcast_to(T, (len(x), 4, 4))
    levels = native_curves.levels_of([curve] * len(x), analysis.chain, many, x, ways, analysis.size)
    on = np.zeros(len(x), dtype=bool)
    on[solution_sets._passes([curve] * len(x), analysis.chain, many, x, analysis.size)[0]] = True
    assert np.array_equal(levels > 0.0, on)
    assert on[0]
    assert not on[1]
    asked = analysis.chain, many, [curve] * len(x), x, ways, analysis.size
    quick = solution_sets._through(*asked)
    with monkeypatch.context() as patch:
        patch.setattr(native_curves, "native", None)
        assert np.array_equal(quick, solution_sets._through(*asked))
    assert quick.any()
    assert not quick.all()


@pytest.mark.parametrize("name", ["panda", "rizon4"])
def test_crossings_are_those_of_all_singular_values(name, rng, monkeypatch):
    robot = entry(name)
    for q in (*configurations(robot, rng), np.radians([0.0, 30.0, 0.0, -90.0, 0.0, 90.0, 0.0])):
        analysis, T, curves = followed(robot, q)
        targets = np.broadcast_to(T, (len(curves), 4, 4))
        which, at = crossings(curves, analysis.chain, targets, analysis.size)
        for curve in curves:
            object.__setattr__(curve, "second", None)
        with monkeypatch.context() as patch:
            patch.setattr(curve_crossings, "native", None)
            others, places = crossings(curves, analysis.chain, targets, analysis.size)
        assert np.array_equal(which, others)
        assert np.allclose(at, places, atol=1e-6)


def test_least_singular_values_are_those_of_lapack(rng):
    J = rng.normal(size=(400, 6, 7))
    J[::4, 0] = 1e-3 * J[::4, 0] + J[::4, 1]
    J[::5, 2] = 1e-7 * J[::5, 0] + J[::5, 1]
    J[-1] = 0.0
    J[-2, :, :3] = 0.0
    right = np.linalg.svd(J, compute_uv=False)[:, -1]
    assert np.allclose(native.least_values(J), right, rtol=1e-11, atol=1e-14)
    six = np.ascontiguousarray(J[:, :, :6])
    assert np.allclose(native.least_values(six), np.linalg.svd(six, compute_uv=False)[:, -1], rtol=1e-11, atol=1e-14)


def test_spread_ones_are_those_of_python(rng):
    for count in (1, 5, 200):
        x = np.concatenate([rng.uniform(-np.pi, np.pi, (count, 7)), np.radians(30.0) * rng.integers(-6, 7, (count, 7))])
        move, rank = rng.uniform(size=2 * count), 1e3 * rng.integers(0, 2, 2 * count)
        for most in (1, 16, 64):
            for preferred in (None, rank):
                places = native.spread(x.T, move, most, preferred)
                assert places.tolist() == spread._spread_by_rows(x.T, move, most, preferred).tolist()
