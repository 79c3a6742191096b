"""Batches that threads share: the bytes of one core, and nothing left behind by interrupts, errors and forks."""

from __future__ import annotations

import multiprocessing
import os
import pickle
import signal
import threading
from concurrent.futures import ProcessPoolExecutor

import numpy as np
import pytest

import robokin
from robokin.inverse import answered_batch, batch_tables, hold, plain_targets, solve, swivel_block
from robokin.inverse.batch_tables import NativeKind, empty_tables
from robokin.inverse.one_target_arm import one_target_arm
from robokin.jobs import ordered_map
from robokin.kernel.native_kernel import native

FIELDS = ("q", "count", "position_error", "angle_error", "within_limits")

needs_kernel = pytest.mark.skipif(native is None, reason="Python's twin answers batches by processes")


@pytest.fixture
def small_shares(monkeypatch):
    """Threads that take a few targets at a time."""
    for module, name in (
        (answered_batch, "BLOCK"),
        (batch_tables, "PACKED"),
        (hold, "SHARE"),
        (plain_targets, "QUICK_SHARE"),
        (plain_targets, "SLOW_SHARE"),
        (solve, "COPIED"),
        (swivel_block, "SHARE"),
    ):
        monkeypatch.setattr(module, name, 7)


def targets(name, m, rng, held=None):
    """A robot with poses that it reaches, one that it does not, and some at which it is singular."""
    robot = robokin.load(name)
    q = rng.uniform(*np.clip(robot.limits, -2.9, 2.9).T, (m, robot.n))
    q[m // 2] = 0.0
    for joint, value in (held or {}).items():
        q[:, joint] = value
    T = robokin.forward_kinematics(robot, q)
    T[m // 3, :3, 3] += 40.0
    T[m // 4, :3, 3] *= 1.4
    return robot, T


def content(batch):
    """All that is told of a batch, as bytes."""
    told = [getattr(batch, field).tobytes() for field in FIELDS]
    told += [str(getattr(batch, field).shape).encode() for field in FIELDS]
    reasons = [batch.reason(i) for i in range(len(batch))]
    return [*told, pickle.dumps((batch.branches(), reasons, batch.complete, batch.method))]


@pytest.mark.parametrize(
    ("name", "asked"),
    [
        ("puma560", {}),
        ("ur5e", {"near": [0.1, 0.2, 0.3, 0.4, 0.5, 0.6], "most": 2}),
        ("crx10ia", {}),
        ("crx10ia", {"near": [0.1, 0.2, 0.3, 0.4, 0.5, 0.6], "most": 3, "limits": False}),
        ("panda", {"hold": {2: 0.3}}),
        ("panda", {"hold": {4: 0.3}, "near": [0.1, 0.2, 0.3, -1.4, 0.5, 1.6, 0.7], "most": 2}),
        ("iiwa14", {"hold": {0: 3.0}, "limits": False}),
        ("iiwa14", {"hold": {2: 0.3}, "turns": True}),
        ("iiwa14", {}),
    ],
    ids=str,
)
def test_any_number_of_cores_gives_the_same_bytes(name, asked, small_shares, rng):
    robot, T = targets(name, 36, rng, asked.get("hold"))
    one = content(robokin.solve_ik(robot, T, cores=1, **asked))
    for cores in (2, 3, 8, None):
        assert content(robokin.solve_ik(robot, T, cores=cores, **asked)) == one


@pytest.mark.parametrize("asked", [{}, {"most": 2}, {"limits": False}, {"near": np.full(7, 0.4)}], ids=str)
@pytest.mark.parametrize(("name", "joint"), [("panda", 2), ("panda", 6), ("iiwa14", 0)])
def test_held_values_stand_between_those_of_the_part(name, joint, asked, small_shares, rng):
    robot, T = targets(name, 36, rng, {joint: 0.3})
    whole = robokin.solve_ik(robot, T, hold={joint: 0.3}, cores=2, **asked)
    arm = hold.held_arm(robot, {joint: 0.3})
    own = {**asked, "near": arm.own(asked["near"])} if "near" in asked else asked
    part = robokin.solve_ik(arm.part, T, **own)
    assert np.array_equal(whole.q, arm.whole(part.q), equal_nan=True)
    for field in FIELDS[1:]:
        assert np.array_equal(getattr(whole, field), getattr(part, field), equal_nan=field.endswith("error"))


@needs_kernel
def test_held_values_that_do_not_fit_are_refused(rng):
    robot, T = targets("puma560", 3, rng)
    arm = one_target_arm(robot)
    rows = native.roots(arm.kernel, None)
    held = np.array([np.nan, 0.5, *[np.nan] * 5])
    asked = (arm.kernel, T, True, None, None, None)
    native.solutions(*asked, empty_tables(3, rows, 7), held)
    for pattern in (
        held[:6],
        np.append(held, np.nan),
        np.zeros(7),
        held[None],
        np.full(40, np.nan),
        held[:0],
        "x",
        0.5,
    ):
        with pytest.raises((TypeError, ValueError)):
            native.solutions(*asked, empty_tables(3, rows, 7), pattern)
    for n, pattern in ((6, held), (8, held), (7, None)):
        with pytest.raises(ValueError, match="tables"):
            native.solutions(*asked, empty_tables(3, rows, n), pattern)


@needs_kernel
@pytest.mark.parametrize("asked", [{}, {"most": 1}, {"near": [0.5, -0.5, 1.0, 0.1, 0.2, 0.3], "most": 2}], ids=str)
@pytest.mark.parametrize("name", ["puma560", "ur5e", "crx10ia"])
def test_shares_are_those_of_a_target_alone(name, asked, small_shares, rng):
    robot, T = targets(name, 24, rng)
    batch = robokin.solve_ik(robot, T, cores=2, **asked)
    for i in range(0, 24, 5):
        alone = robokin.solve_ik(robot, T[i], **asked)
        listed = batch.q[i, : batch.count[i]]
        assert np.array_equal(listed, np.array([one.q for one in alone]).reshape(listed.shape))
        assert batch[i].record() == alone.record()


@needs_kernel
@pytest.mark.parametrize("name", ["puma560", "crx10ia", "iiwa14"])
def test_what_the_kernel_answers_needs_no_process(name, small_shares, monkeypatch, rng):
    def no_pool(*_):
        raise AssertionError("a process was started")

    monkeypatch.setattr(ordered_map, "_process_pool", no_pool)
    monkeypatch.setattr(answered_batch, "BLOCK", 4000)
    robot, T = targets(name, 40, rng)
    assert robokin.solve_ik(robot, T, cores=2).count.any()


@needs_kernel
def test_ctrl_c_amid_a_batch_leaves_no_thread(small_shares, monkeypatch, rng):
    robot, T = targets("crx10ia", 60, rng)
    threads, begun = set(threading.enumerate()), []

    def disturbed(self, *arguments, real=NativeKind.filled):
        begun.append(0)
        fill = self.fill

        def part(*given):
            begun.append(0)
            if len(begun) == 4:
                os.kill(os.getpid(), signal.SIGINT)
            fill(*given)

        object.__setattr__(self, "fill", part)
        return real(self, *arguments)

    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with monkeypatch.context() as patch:
            patch.setattr(NativeKind, "filled", disturbed)
            with pytest.raises(KeyboardInterrupt):
                robokin.solve_ik(robot, T, cores=2)
    finally:
        signal.signal(signal.SIGINT, before)
    assert set(threading.enumerate()) == threads
    assert not multiprocessing.active_children()
    assert robokin.solve_ik(robot, T, cores=2).count.any()


@needs_kernel
def test_an_error_of_a_thread_is_raised_and_ends_the_others(small_shares, monkeypatch, rng):
    robot, T = targets("ur5e", 60, rng)
    threads, real, asked = set(threading.enumerate()), plain_targets._fill, []

    def short_of_memory(*given):
        asked.append(0)
        if len(asked) == 3:
            raise MemoryError("no room")
        real(*given)

    monkeypatch.setattr(plain_targets, "_fill", short_of_memory)
    with pytest.raises(MemoryError, match="no room"):
        robokin.solve_ik(robot, T, cores=2)
    assert set(threading.enumerate()) == threads


def _bytes_of(name, T, cores):
    return content(robokin.solve_ik(robokin.load(name), T, cores=cores))


@pytest.mark.filterwarnings("ignore:This process:DeprecationWarning")
@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
def test_processes_that_are_forked_amid_a_batch_answer_too(small_shares, rng):
    robot, T = targets("puma560", 40, rng)
    one, over = content(robokin.solve_ik(robot, T)), threading.Event()

    def work():
        while not over.is_set():
            robokin.solve_ik(robot, T, cores=2)

    thread = threading.Thread(target=work)
    thread.start()
    try:
        with ProcessPoolExecutor(2, multiprocessing.get_context("fork")) as pool:
            given = [pool.submit(_bytes_of, "puma560", T, cores) for cores in (1, 2, 3)]
            assert [each.result(60) for each in given] == [one] * 3
    finally:
        over.set()
        thread.join()


def test_who_writes_into_a_result_changes_no_single_answer(small_shares, rng):
    for name in ("puma560", "crx10ia"):
        robot, T = targets(name, 30, rng)
        batch, other = robokin.solve_ik(robot, T), robokin.solve_ik(robot, T)
        for field in FIELDS:
            getattr(other, field)[:] = 0
        assert other.branches() == batch.branches()
        assert [one.record() for one in other] == [one.record() for one in batch]


@needs_kernel
def test_tables_that_do_not_fit_are_refused(rng):
    robot, T = targets("crx10ia", 3, rng)
    arm = one_target_arm(robot)
    rows = native.roots(arm.kernel, arm.elimination)
    good = empty_tables(3, rows, 6)
    asked = (arm.kernel, T, True, None, arm.elimination, None)
    native.solutions(*asked, good, None)
    read_only = empty_tables(3, rows, 6)
    read_only.q.flags.writeable = False
    other_types = (good[0], *(table.astype(np.int32) for table in good[1:5]), *good[5:])
    every_other = empty_tables(6, rows, 6).part(slice(None, None, 2))
    wrong = [empty_tables(2, rows, 6), empty_tables(3, rows + 1, 6), empty_tables(3, rows, 5), read_only]
    for tables in (*wrong, other_types, every_other, list(good), good[:8], (), None, (None,) * 9):
        with pytest.raises(ValueError, match="tables"):
            native.solutions(*asked, tables, None)
    for most in (-1, 1.5, "2"):
        with pytest.raises((TypeError, ValueError, OverflowError)):
            native.solutions(*asked[:5], most, good, None)
    for elimination in (arm.kernel, 3, "x"):
        with pytest.raises((TypeError, ValueError)):
            native.solutions(*asked[:4], elimination, None, good, None)
        with pytest.raises((TypeError, ValueError)):
            native.roots(arm.kernel, elimination)
    for count in (0, 1, 3):
        with pytest.raises(TypeError):
            native.roots(*[arm.kernel] * count)
    native.solutions(*asked[:5], 0, good, None)
    assert not good.listed.any()
    assert np.isnan(good.q).all()
