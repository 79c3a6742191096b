"""What inverse kinematics does the short way is what the long way gives."""

from __future__ import annotations

import numpy as np
import pytest
from sweeps import sweep

import robokin
from robokin.inverse.analysis import analysis_of
from robokin.inverse.elimination.neighbours import next_door
from robokin.inverse.elimination.splits import Elimination, elimination_of
from robokin.inverse.numeric.least_squares import descend
from robokin.inverse.second_look import look_again
from robokin.inverse.self_motion.fold import to_multiple_roots
from robokin.inverse.self_motion.pose_correction import least_squares
from robokin.inverse.solve_blocks import rows_of
from robokin.inverse.verify import nothing
from robokin.inverse.window import least_singular_values, nearly_singular
from robokin.kernel.ranks import ROOT_RANK

ANYWHERE = np.tile([-np.inf, np.inf], (6, 1))


@pytest.fixture
def rng():
    return np.random.default_rng(11)


def round_poses(robot, rng, count, step=30):
    q = np.radians(step) * rng.integers(-150 // step, 150 // step + 1, (count, robot.n))
    return q, robokin.forward_kinematics(robot, q)


@pytest.mark.parametrize("shape", [(6, 6), (7, 6), (6, 7), (8, 6)])
@pytest.mark.parametrize("slide", [1.0, 1e2, 1e6])
def test_a_step_is_that_of_the_singular_values(rng, shape, slide):
    A = rng.normal(size=(60, *shape)) * ([slide] + [1.0] * (shape[1] - 1))
    A[20:40, :, 1] = A[20:40, :, 2] + 1e-4 * rng.normal(size=(20, shape[0]))
    A[40:50, :, 1], A[50] = A[40:50, :, 2], 0.0
    b = rng.normal(size=(60, shape[0]))
    for one, side, step in zip(A, b, least_squares(A, b), strict=True):
        greatest = np.linalg.norm(one, 2)
        expected = np.linalg.pinv(one, rcond=ROOT_RANK / greatest if greatest else 1.0) @ side
        assert np.max(np.abs(step - expected)) <= 1e-4 * np.max(np.abs(expected))


def test_places_of_some_targets(rng):
    count = rng.integers(0, 4, 30)
    index = np.repeat(np.arange(30), count)
    for chosen in (np.arange(30), np.array([], dtype=np.intp), np.flatnonzero(rng.random(30) < 0.3)):
        assert np.array_equal(rows_of(chosen, count), np.flatnonzero(np.isin(index, chosen)))


def test_near_singular_by_determinants_is_near_singular_by_values(rng):
    for name in ("puma560", "xarm6", "stanford", "scorbot"):
        robot = robokin.load(name)
        analysis = analysis_of(robot, "pose")
        q = rng.uniform(-1, 1, (200, robot.n))
        q[:100, -2] = 10.0 ** rng.uniform(-9, -3, 100)
        values = least_singular_values(analysis.own, q, analysis.size)
        for below in (np.full(200, 5e-6), np.full(200, 1e-7), 2.0 * values, 0.5 * values):
            assert np.array_equal(nearly_singular(analysis.own, q, analysis.size, below), values < below)


@pytest.mark.parametrize("name", sweep(["xarm6", "piper-old", "crx10ia"], 3))
def test_what_is_counted_next_door_is_what_all_ways_find(name, rng, monkeypatch):
    robot = robokin.load(name)
    analysis = analysis_of(robot, "pose")
    q, T = round_poses(robot, rng, 24)
    index, found, whole = next_door(analysis, T)
    assert np.count_nonzero(whole) > 4
    for i in np.flatnonzero(whole):
        gap = found[index == i] - q[i]
        assert np.min(np.max(np.abs(gap - 2 * np.pi * np.round(gap / (2 * np.pi))), axis=1)) < 1e-9
    T = T[whole][:6]
    rest = np.zeros(6)
    counted, claims = look_again(analysis, T, nothing(6), rest, ANYWHERE, None, np.zeros(len(T), dtype=bool))
    assert set(claims.basis.tolist()) == {1}
    monkeypatch.setattr("robokin.inverse.elimination.neighbours.COUNTED_AT", 0)
    followed, claims = look_again(analysis, T, nothing(6), rest, ANYWHERE, None, np.zeros(len(T), dtype=bool))
    assert set(claims.basis.tolist()) == {2}
    assert np.array_equal(counted.index, followed.index)
    assert np.allclose(counted.q, followed.q, rtol=0, atol=1e-8)


@pytest.mark.slow
def test_multiple_roots_of_many_are_those_of_each(rng, monkeypatch):
    robot = robokin.load("hc10")
    calls = []

    def recorded(*told):
        calls.append((told, to_multiple_roots(*told)))
        return calls[-1][1]

    monkeypatch.setattr("robokin.inverse.self_motion.singular_solutions.to_multiple_roots", recorded)
    robokin.solve_ik(robot, round_poses(robot, rng, 24, 90)[1])
    assert any(found.any() for _, (_, found) in calls)
    for (chain, T, q, size, null), (roots, found) in calls:
        for i in range(min(len(q), 12)):
            root, alone = to_multiple_roots(chain, T[i : i + 1], q[i : i + 1], size, null)
            assert alone[0] == found[i]
            assert not found[i] or np.allclose(root[0], roots[i], rtol=0, atol=1e-9)
        none, nowhere = to_multiple_roots(chain, T[:0], q[:0], size, null)
        assert (len(none), len(nowhere)) == (0, 0)


def test_a_descent_does_not_depend_on_those_beside_it(rng):
    robot = robokin.load("stanford")
    analysis = analysis_of(robot, "pose")
    q = rng.uniform(-1, 1, (30, 6))
    T = robokin.forward_kinematics(robot, q)
    start = q + 10.0 ** rng.uniform(-8, -0.5, (30, 1)) * rng.normal(size=q.shape)
    together, off = descend(analysis.own, T, start, analysis.size)
    for i in range(30):
        alone, own = descend(analysis.own, T[i : i + 1], start[i : i + 1], analysis.size)
        assert np.allclose(alone[0], together[i], rtol=0, atol=1e-9)
        assert np.allclose(own[0], off[i], rtol=0, atol=1e-9)
    assert descend(analysis.own, T[:0], q[:0], analysis.size)[0].shape == (0, 6)


def test_an_elimination_is_made_once_and_is_the_same():
    loop = analysis_of(robokin.load("xarm6"), "pose").loop
    kept = elimination_of(loop, 4)
    assert elimination_of(loop, 4) is kept
    closing = loop.closing(np.eye(4)[None])
    for ours, theirs in zip(kept.all_candidates(closing), Elimination(loop, 4).all_candidates(closing), strict=True):
        assert np.array_equal(ours.values, theirs.values)
