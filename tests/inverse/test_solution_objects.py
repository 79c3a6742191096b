"""Solutions are the same objects whether the native kernel makes them or Python does."""

from __future__ import annotations

import copy
import dataclasses
import gc
import pickle
import random
import sys
import threading

import numpy as np
import pytest

import robokin
from robokin.inverse import solutions
from robokin.inverse.solutions import Solution, named_later
from robokin.kernel.native_kernel import native

needs_kernel = pytest.mark.skipif(native is None, reason="no native kernel in use")


def called(place):
    return f"number {place}"


def free_of(place):
    return (place + 1, place + 2)


def drawn(rng):
    """What `named_later` may be asked."""
    joints, count = int(rng.integers(1, 8)), int(rng.integers(0, 9))
    table = rng.normal(size=(count, joints + 3 + int(rng.integers(0, 3))))
    table[:, joints + 2] = rng.integers(0, 2, count)
    if count and rng.random() < 0.3:
        table[0, : joints + 2] = rng.choice([np.nan, np.inf, -0.0], joints + 2)
    pattern = None
    if rng.random() < 0.5:
        held = int(rng.integers(0, 3))
        pattern = rng.permutation(np.concatenate([np.full(joints, np.nan), rng.normal(size=held)]))
    rows = None if rng.random() < 0.5 else rng.permutation(count)[: int(rng.integers(0, count + 1))].tolist()
    free = [(), (2, 3), [free_of(k) for k in range(count)], free_of][int(rng.integers(4))]
    return called, table, joints, free, rows, bool(rng.integers(2)), pattern, int(rng.integers(0, 40))


def seen(one):
    """All that can be seen of a solution."""
    return (
        type(one), one.q.tobytes(), one.q.dtype, one.q.shape, one.q.flags.writeable, one.branch, one.within_limits,
        type(one.within_limits), repr(one.position_error), repr(one.angle_error), one.free, repr(one),
    )  # fmt: skip


@needs_kernel
def test_the_kernel_makes_what_python_makes(rng, monkeypatch):
    for _ in range(300):
        asked = drawn(rng)
        mine = named_later(*asked)
        theirs = tuple(solutions._named_later(*asked))
        assert type(mine) is tuple
        assert [list(vars(one)) for one in mine] == [list(vars(one)) for one in theirs]
        assert [*map(seen, mine)] == [*map(seen, theirs)]
        assert [vars(one).keys() for one in mine] == [vars(one).keys() for one in theirs]
        table = asked[1]
        before = [one.q.copy() for one in mine]
        table[:] = 7.0  # its rows are copies
        assert all(np.array_equal(one.q, q, equal_nan=True) for one, q in zip(mine, before, strict=True))


@pytest.mark.parametrize("looked_at", [False, True])
def test_solutions_are_frozen_values_that_can_be_copied_and_pickled(looked_at):
    robot = robokin.load("puma560")
    T = robokin.forward_kinematics(robot, [0.1, -0.7, 0.4, 0.5, 0.6, -0.3])
    result = robokin.solve_ik(robot, T)
    names = [part.name for part in dataclasses.fields(Solution)]
    assert names == ["q", "branch", "within_limits", "position_error", "angle_error", "free"]
    assert len(result) > 1
    for one in result:
        if looked_at:
            assert "wrist" in one.branch
        others = [copy.copy(one), copy.deepcopy(one), dataclasses.replace(one)]
        others += [pickle.loads(pickle.dumps(one, protocol)) for protocol in range(pickle.HIGHEST_PROTOCOL + 1)]
        for other in others:
            assert seen(other) == seen(one)
            assert other != one  # solutions are told apart by who they are
            assert {*names} >= {*vars(other)}
        assert one == one and hash(one) == hash(one) and len({one, *others}) == 1 + len(others)
        with pytest.raises(dataclasses.FrozenInstanceError):
            one.q = one.q
        with pytest.raises(dataclasses.FrozenInstanceError):
            one.other = 1
        with pytest.raises(dataclasses.FrozenInstanceError):
            del one.branch
        with pytest.raises(AttributeError, match="'Solution' object has no attribute 'other'"):
            _ = one.other
        assert list(dataclasses.asdict(one)) == names
        moved = dataclasses.replace(one, branch="mine")
        assert (moved.branch, moved.position_error) == ("mine", one.position_error)
        assert one.q.base is None or one.q.base.shape[-1] == 6
        one.q[0] += 1.0  # an array of its own
    again = robokin.solve_ik(robot, T)
    assert [[one.q[0] + 1.0, *one.q[1:]] for one in again] == [one.q.tolist() for one in result]


def test_a_joint_that_is_held_stands_in_every_solution(rng):
    robot = robokin.load("iiwa14")
    for value in (0.3, -0.0, 0.3):
        q = rng.uniform(-1.5, 1.5, 7)
        q[2] = value
        T = robokin.forward_kinematics(robot, q)
        for limits in (True, False):
            result = robokin.solve_ik(robot, T, limits=limits, hold={2: value})
            assert len(result) and all(one.q[2] == value for one in result)
            assert np.allclose([robokin.forward_kinematics(robot, one.q) for one in result], T, atol=1e-12)
            assert min(np.abs(one.q - q).max() for one in result) < 1e-9
            assert len({one.branch for one in result}) == len(result)


@pytest.mark.parametrize("most", [None, 1, 3, 100])
@pytest.mark.parametrize("near", [None, [0.3, -1.0, 0.7, 2.0, -0.4, 4.0]])
def test_one_pose_is_listed_and_counted_as_a_batch_of_one(most, near, rng):
    for name in ("puma560", "ur5e", "crx10ia"):
        robot = robokin.load(name)
        for q in rng.uniform(-3.0, 3.0, (12, 6)):
            T = robokin.forward_kinematics(robot, q)
            for limits in (True, False):
                one = robokin.solve_ik(robot, T, limits=limits, most=most, near=near)
                many = robokin.solve_ik(robot, T[None], limits=limits, most=most, near=near)[0]
                assert dict(one.counts) == dict(many.counts)
                assert (one.complete, one.postures, one.basis, one.certificate) == (
                    many.complete, many.postures, many.basis, many.certificate,
                )  # fmt: skip
                if near is not None:
                    # Equally near ones, by the last digit, may change places.
                    moves = [[np.max(np.abs(s.q - near)) for s in result] for result in (one, many)]
                    assert np.allclose(*moves, atol=1e-8)
                    assert moves[0] == sorted(moves[0])
                    continue
                assert [s.branch for s in one] == [s.branch for s in many]
                assert [(s.within_limits, s.free) for s in one] == [(s.within_limits, s.free) for s in many]
                assert np.allclose([s.q for s in one], [s.q for s in many], atol=1e-8)


@needs_kernel
def test_what_is_no_table_of_solutions_is_refused(rng):
    good = [Solution, called, rng.normal(size=(3, 9)), 6, (), None, False, None, 0]
    assert len(native.solution_objects(*good)) == 3

    class Slotted:
        __slots__ = ("q",)

    class OfInt(int):
        pass

    wrong = {
        0: [int, dict, np.ndarray, object, type, OfInt, type(Solution), Solution(np.zeros(1), "", True, 0.0, 0.0), None,
            Slotted, 3, BaseException],
        2: [None, [[1.0] * 9], np.zeros(9), np.zeros((3, 8)), np.zeros((2, 3, 9)), np.zeros((3, 0)),
            np.array(["a"] * 9)[None], np.full((2, 9), 1j), np.array([[object()] * 9])],
        3: [-1, 7, 10**30, 1.5, None, "6", 5.0],
        4: [[], [()], [(), ()]],
        5: [(), (1,), "0", 3, [3], [-1], [True], [0.0], [None], [10**30], [0, 1, 2, 3]],
        6: [np.zeros(2)],
        7: [np.zeros(6), np.full(5, np.nan), np.full(7, np.nan), np.full((6, 1), np.nan), np.array(np.nan), 3,
            [np.nan] * 6, np.empty(0)],
        8: [1.5, None, "0", 10**30],
    }  # fmt: skip
    for place, values in wrong.items():
        for value in values:
            asked = [*good]
            asked[place] = value
            with pytest.raises((TypeError, ValueError, IndexError, OverflowError, AttributeError)):
                native.solution_objects(*asked)
    for count in (0, 1, 8, 10):
        with pytest.raises(TypeError):
            native.solution_objects(*([*good, 0][:count]))
    assert native.solution_objects(*good[:8], -5)[0].branch == "number -5"
    for other in (np.asfortranarray(good[2]), good[2].astype(">f8")):
        made = native.solution_objects(*good[:2], other, *good[3:])
        assert [one.q.tolist() for one in made] == good[2][:, :6].tolist()


@needs_kernel
def test_no_references_are_lost(rng):
    table = rng.normal(size=(8, 9))
    name, free = object(), [()] * 8
    before = [sys.getrefcount(one) for one in (name, table, free, Solution)]
    for k in range(50):
        made = native.solution_objects(Solution, name, table, 6, free, [0, 3], False, None, 0)
        with pytest.raises(IndexError):
            native.solution_objects(Solution, name, table, 6, free[:2], [0, 3], False, None, k)
        with pytest.raises(ValueError, match="fit"):
            native.solution_objects(Solution, name, table, 7, free, None, False, None, k)
    assert all(gc.is_tracked(one) for one in made)
    del made
    assert [sys.getrefcount(one) for one in (name, table, free, Solution)] == before


@needs_kernel
def test_code_that_runs_meanwhile_may_change_what_was_given():
    """A collection of garbage runs finalizers, which may be anyone's."""
    table, rows, free = np.zeros((800, 9)), [], []

    class Last:
        def __init__(self):
            self.me = self

        def __del__(self):
            rows.clear()
            free.clear()
            table.resize((0, 9), refcheck=False)

    threshold = gc.get_threshold()
    gc.set_threshold(50, 2, 2)
    try:
        for _ in range(20):
            table.resize((800, 9), refcheck=False)
            rows[:], free[:] = range(800), [()] * 800
            Last()
            try:
                made = native.solution_objects(Solution, called, table, 6, free, rows, False, None, 0)
            except IndexError:  # of a list that became too short
                continue
            assert all(one.q.shape == (6,) for one in made)
    finally:
        gc.set_threshold(*threshold)


def test_several_threads_may_look_at_results_at_once(rng):
    robot = robokin.load("ur5e")
    T = robokin.forward_kinematics(robot, rng.uniform(-2, 2, (40, 6)))
    expected = [[(one.q.tobytes(), one.branch) for one in robokin.solve_ik(robot, pose)] for pose in T]
    shared = [robokin.solve_ik(robot, pose) for pose in T]
    wrong = []

    def ask(seed):
        order = [*range(len(T))] * 5
        random.Random(seed).shuffle(order)
        for i in order:
            for result in (robokin.solve_ik(robot, T[i]), shared[i]):
                if [(one.q.tobytes(), one.branch) for one in result] != expected[i]:
                    wrong.append(i)

    threads = [threading.Thread(target=ask, args=(seed,)) for seed in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


@pytest.mark.parametrize("name, hold", [("puma560", None), ("crx10ia", None), ("iiwa14", {2: 0.3}), ("iiwa14", None)])
def test_a_result_knows_its_question_however_it_is_come_by(name, hold, rng):
    robot = robokin.load(name)
    q = rng.uniform(-1.0, 1.0, robot.n)
    q[2] = 0.3
    T = robokin.forward_kinematics(robot, q)
    names = {part.name for part in dataclasses.fields(solutions.Result)}

    def result():
        return robokin.solve_ik(robot, T, hold=hold)

    def looked_at():
        one = result()
        assert len(one) and one.question is one.question
        return one

    for make in (result, looked_at):
        for other in (
            make(),
            copy.copy(make()),
            copy.deepcopy(make()),
            pickle.loads(pickle.dumps(make())),
            dataclasses.replace(make()),
        ):
            asked = other.question
            assert type(other) is solutions.Result
            assert (asked.task, asked.limits, asked.hold) == ("pose", True, hold or {})
            assert np.array_equal(asked.T, T) and asked.robot.id == robot.id
            assert all(hasattr(other, field) for field in names)
            assert repr(other) == repr(result())
            with pytest.raises(dataclasses.FrozenInstanceError):
                other.question = None
    one = result()
    T[0, 3] += 1.0  # the question holds a copy
    assert not np.array_equal(one.question.T, T)
    with pytest.raises(dataclasses.FrozenInstanceError):
        result().complete = False
    with pytest.raises(AttributeError, match="object has no attribute 'other'"):
        _ = result().other


def test_fields_are_asked_for_in_any_order(rng):
    robot = robokin.load("puma560")
    poses = robokin.forward_kinematics(robot, rng.uniform(-2.0, 2.0, (6, 6)))
    poses[:2, :3, 3] *= 9.0  # out of reach
    names = [part.name for part in dataclasses.fields(solutions.Result)]
    for T in poses:
        expected = {name: repr(getattr(robokin.solve_ik(robot, T), name)) for name in names}
        for _ in range(4):
            result = robokin.solve_ik(robot, T)
            for name in rng.permutation(names).tolist():
                assert repr(getattr(result, name)) == expected[name]
            assert {*names} <= {*vars(result)}
            assert not {"_tell", "_question"} & {*vars(result)}
