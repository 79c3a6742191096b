"""The native kernel's elimination finds what Python's finds, and says that it is all by the same rule."""

from __future__ import annotations

import threading
from dataclasses import replace

import numpy as np
import pytest
from library_entries import entry

import robokin
from robokin.inverse import window
from robokin.inverse.analysis import analyse, analysis_of
from robokin.inverse.claims import COUNTED
from robokin.inverse.elimination.native_elimination import _numbers, native_elimination
from robokin.inverse.solve_blocks import complete_solutions
from robokin.kernel import native_kernel
from robokin.kernel.chain import Chain, chain_of
from robokin.kernel.frames import pose
from robokin.kernel.native_kernel import handle

native = native_kernel.native
pytestmark = pytest.mark.skipif(native is None, reason="no native kernel in use")

# Followed forwards and backwards, with the target among the first links and the last.
ARMS = ("crx10ia", "xarm6", "piper-old", "manocha-canny-1994", "raghavan-roth-1990")

ROUND = np.radians(15.0)


def known_of(analysis):
    return native_elimination(analysis.solver.first, analysis.loop, analysis.six.chain, analysis.number)


def random_arm(rng):
    """An analysed chain of six turning joints in general position, or one with parallel and meeting axes."""
    constants = np.tile(np.eye(4), (7, 1, 1))
    special = rng.random() < 0.5
    for one in constants:
        axis, turn = rng.integers(3), rng.choice([0.0, 0.5, 1.0]) * np.pi if special else rng.uniform(-3, 3)
        one[:3, :3] = robokin.spatial.rotation_from_axis_angle(np.eye(3)[axis], turn)
        one[:3, 3] = rng.choice([0.0, 0.0, 0.3, 0.5], 3) if special else rng.uniform(-0.5, 0.5, 3)
    return analyse(Chain(constants, np.ones(6, dtype=bool), rng.uniform(-1, 1, 6)))


def sets_agree(analysis, T, monkeypatch):
    """Both kernels' solutions of targets are the same sets; which targets the native one proves to be complete."""
    rest, free = np.zeros(6), np.tile([-np.inf, np.inf], (6, 1))
    mine, claims = complete_solutions(analysis, T, rest, free, None)
    with monkeypatch.context() as patch:
        patch.setattr(window, "native_elimination", lambda *told: None)
        theirs, python = complete_solutions(analysis, T, rest, free, None)
    count, expected = (np.bincount(found.index, minlength=len(T)) for found in (mine, theirs))
    surely = (claims.basis == COUNTED) & (python.basis == COUNTED)
    assert np.array_equal(count[surely], expected[surely])
    both = np.flatnonzero(count == expected)
    q, wished = (found.q[np.isin(found.index, both)] for found in (mine, theirs))
    gap = np.abs(q - wished)
    assert np.minimum(gap, 2.0 * np.pi - gap).max(initial=0.0) < 1e-6
    assert np.mean(count == expected) > 0.97
    return claims.basis == COUNTED


@pytest.mark.parametrize("name", ARMS)
def test_arms_of_the_library_at_random_and_round_poses(name, rng, instructions, monkeypatch):
    robot = entry(name)
    analysis = analysis_of(robot)
    q = np.concatenate([rng.uniform(-3, 3, (40, 6)), ROUND * rng.integers(-12, 13, (8, 6))])
    complete = sets_agree(analysis, robokin.forward_kinematics(robot, q), monkeypatch)
    assert complete[:40].all()


def test_random_arms(rng, monkeypatch):
    compared = 0
    for _ in range(8):
        analysis = random_arm(rng)
        if analysis.solver is None or not hasattr(analysis.solver, "first") or analysis.number is None:
            continue
        if not hasattr(analysis.solver, "splits") or known_of(analysis) is None:
            continue
        q = np.concatenate([rng.uniform(-3, 3, (20, 6)), ROUND * rng.integers(-12, 13, (3, 6))])
        sets_agree(analysis, pose(analysis.chain, q), monkeypatch)
        compared += 1
    assert compared >= 2


def test_solutions_close_the_arm_and_are_never_more_than_there_are(rng, instructions):
    robot = entry("crx10ia")
    known = known_of(analysis_of(robot))
    T = robokin.forward_kinematics(robot, rng.uniform(-3, 3, (300, 6)))
    index, q, position, angle, tried, whole = known.many(T)
    assert whole.mean() > 0.99
    count = np.bincount(index, minlength=len(T))
    assert np.all(count <= known.number)
    assert np.all(count[whole] % 2 == 0)
    assert np.all(tried >= 0)
    off = np.abs(robokin.forward_kinematics(robot, q) - T[index]).max(axis=(1, 2))
    assert off.max() < 2e-9
    assert np.median(off) < 1e-14
    assert position.max() < 2e-9
    assert angle.max() < 1e-9


def test_one_target_and_many_are_the_same_digits_with_every_set_of_instructions(rng):
    robot = entry("hc10")
    known = known_of(analysis_of(robot))
    T = robokin.forward_kinematics(robot, rng.uniform(-3, 3, (40, 6)))
    before, answers = native.instructions(), []
    for name in ("base", "avx2"):
        try:
            native.instructions(name)
        except ValueError:
            continue
        answers.append(native.eliminated(known.known, T))
        alone = [native.eliminated(known.known, one[None]) for one in T]
        assert b"".join(rows.tobytes() for _, rows in alone) == answers[-1][1].tobytes()
    native.instructions(before)
    assert all(rows.tobytes() == answers[0][1].tobytes() for _, rows in answers)


def test_targets_out_of_reach_and_of_no_meaning_are_answered_with_nothing(instructions):
    robot = entry("crx10ia")
    known = known_of(analysis_of(robot))
    far = np.eye(4)
    far[:3, 3] = 50.0
    strange = [np.full((4, 4), np.nan), np.full((4, 4), np.inf), np.zeros((4, 4)), np.full((4, 4), 1e300), -np.eye(4)]
    index, q, _, _, _, _ = known.many(np.stack([far, *strange]))
    assert not len(index)
    assert q.shape == (0, 6)
    assert known.many(np.empty((0, 4, 4)))[1].shape == (0, 6)


def test_no_target_has_more_solutions_than_were_tried(rng):
    """Where the equations of a round pose say nothing all that is found comes from poses next door."""
    robot = entry("hc10")
    known = known_of(analysis_of(robot))
    q = ROUND * rng.integers(-12, 13, (200, 6))
    q[0] = np.radians([-180.0, 90.0, 90.0, 0.0, 0.0, 0.0])
    T = robokin.forward_kinematics(robot, q)
    index, _, _, _, tried, _ = known.many(T)
    assert np.all(np.bincount(index, minlength=len(T)) <= tried)
    batch = robokin.solve_ik(robot, T[:12], limits=False)
    alone = [robokin.solve_ik(robot, one, limits=False) for one in T[:12]]
    assert batch.count.tolist() == [len(one) for one in alone]


def test_arrays_that_do_not_fit_are_refused():
    analysis = analysis_of(entry("crx10ia"))
    chain, known = analysis.six.chain, known_of(analysis)
    numbers = _numbers(analysis.solver.first, analysis.loop, 16)
    arm = handle(chain)
    with pytest.raises(ValueError, match="targets"):
        native.eliminated(known.known, np.zeros((3, 5)))
    with pytest.raises(TypeError):
        native.eliminated(known.known, [1.0])
    with pytest.raises(ValueError, match="PyCapsule"):
        native.eliminated(arm, np.zeros((1, 4, 4)))
    for wrong in (numbers[:-1], np.append(numbers, 0.0), numbers[None], np.full(len(numbers), np.nan)):
        with pytest.raises(ValueError, match=r"fit|dimensions"):
            native.elimination(arm, wrong)
    with pytest.raises(ValueError, match="fit"):
        native.elimination(handle(chain_of(entry("panda"))), numbers)
    with pytest.raises(TypeError):
        native.elimination(arm)


def test_no_numbers_however_hostile_break_it(rng):
    analysis = analysis_of(entry("crx10ia"))
    numbers, arm = _numbers(analysis.solver.first, analysis.loop, 16), handle(analysis.six.chain)
    T = np.stack([np.eye(4), *rng.normal(size=(5, 4, 4))])
    made = 0
    for k in range(600):
        wrong = numbers.copy()
        if k % 3:
            wrong[6:12] = [rng.integers(2), rng.integers(6), rng.integers(6), rng.integers(4), rng.integers(25), 1]
        else:
            wrong[rng.integers(len(wrong))] = rng.choice([-1.0, 0.5, 7.0, 1e300, -1e300, 1e-300, 0.0, np.inf])
        try:
            known = native.elimination(arm, wrong)
        except ValueError:
            continue
        made += 1
        counts, rows = native.eliminated(known, T)
        assert rows.shape == (counts[:, 2].sum(), 8)
    assert made > 50


def test_several_threads_may_ask_at_once(rng):
    robot = entry("crx10ia")
    known = known_of(analysis_of(robot))
    T = robokin.forward_kinematics(robot, rng.uniform(-3, 3, (60, 6)))
    expected, answers = native.eliminated(known.known, T)[1].tobytes(), []
    threads = [
        threading.Thread(target=lambda: answers.append(native.eliminated(known.known, T)[1].tobytes()))
        for _ in range(4)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert answers == [expected] * 4


def test_one_call_is_answered_by_it_and_the_twin_by_few_operations(rng):
    robot = entry("crx10ia")
    T = robokin.forward_kinematics(robot, rng.uniform(-3, 3, (12, 6)))
    together = robokin.solve_ik(robot, T, limits=False)
    for k, one in enumerate(T):
        alone = robokin.solve_ik(robot, one, limits=False)
        assert alone.complete
        assert len(alone) == together.count[k]
        np.testing.assert_allclose([s.q for s in alone], together.q[k, : len(alone)], rtol=0, atol=1e-9)


def test_a_loop_whose_rows_have_no_clear_degrees_has_a_greater_pencil(rng, monkeypatch):
    analysis = analysis_of(entry("raghavan-roth-1990"))
    solver = analysis.solver.first
    plain = type(solver)(analysis.loop, solver.split)
    plain.degrees = None
    known = native_elimination(plain, analysis.loop, analysis.six.chain, analysis.number)
    T = robokin.forward_kinematics(entry("raghavan-roth-1990"), rng.uniform(-3, 3, (30, 6)))
    few = known_of(analysis).many(T)
    many = known.many(T)
    assert many[5].mean() > 0.9
    both = few[5] & many[5]
    assert np.array_equal(np.bincount(few[0], minlength=30)[both], np.bincount(many[0], minlength=30)[both])


def test_a_shifted_perturbed_or_sliding_loop_is_left_to_python():
    analysis = analysis_of(entry("crx10ia"))
    solver, loop = analysis.solver.first, analysis.loop
    assert native_elimination(solver, loop, analysis.six.chain, None) is None
    sliding = replace(loop, revolute=np.array([True, True, True, True, True, False]))
    assert native_elimination(solver, sliding, analysis.six.chain, 16) is None
    assert native_elimination(type(solver)(loop, 13), loop, analysis.six.chain, 16) is None
