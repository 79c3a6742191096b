"""Work goes to whatever executor is lent, and comes back as from one's own processes."""

from __future__ import annotations

import os
import threading
import time
from concurrent.futures import Future, ProcessPoolExecutor, ThreadPoolExecutor
from functools import partial

import pytest

from robokin.errors import InputError
from robokin.jobs.executors import lent, lent_executor
from robokin.jobs.ordered_map import AHEAD, finished_map, ordered_map


def square(x):
    return x * x


def slow_first(x):
    time.sleep(0.2 if x == 0 else 0.0)
    return x


def fail_at_five(x):
    if x == 5:
        raise InputError("found five, expected another")
    return x


def inner(x):
    """A map within a task: all of it is done where the task is."""
    return [*ordered_map(where, range(3))] == [where(0)] * 3


def where(_):
    return os.getpid(), threading.get_ident()


class AtOnce:
    """The least that an executor is: it does the work when it gets it."""

    def __init__(self):
        self.taken = 0

    def submit(self, fn, /, *arguments):
        self.taken += 1
        future = Future()
        try:
            future.set_result(fn(*arguments))
        except Exception as error:
            future.set_exception(error)
        return future


@pytest.fixture(params=[ThreadPoolExecutor, ProcessPoolExecutor, None])
def executor(request):
    if request.param is None:
        yield AtOnce()
        return
    import multiprocessing

    more = {"mp_context": multiprocessing.get_context("spawn")} if request.param is ProcessPoolExecutor else {}
    with request.param(2, **more) as pool:
        yield pool


def test_results_are_those_of_ones_own_processes_and_in_order(executor):
    with lent(executor, 2):
        assert [*ordered_map(slow_first, range(40))] == [*range(40)]
        assert [*ordered_map(square, iter(range(40)), cores=2, window=1)] == [x * x for x in range(40)]
        assert sorted(finished_map(square, range(40))) == [x * x for x in range(40)]
        assert all(ordered_map(inner, range(4)))
    assert lent_executor() is None


def test_an_error_is_raised_in_its_blocks_turn(executor):
    with lent(executor, 2):
        results = ordered_map(fail_at_five, range(40))
        assert [next(results) for _ in range(5)] == [*range(5)]
        with pytest.raises(InputError, match="found five"):
            next(results)
        with pytest.raises(InputError, match="found five"):
            [*finished_map(fail_at_five, range(40))]


def test_blocks_are_drawn_as_they_are_needed():
    drawn = []

    def blocks():
        for x in range(1000):
            drawn.append(x)
            yield x

    with lent(AtOnce(), 2):
        results = ordered_map(square, blocks())
        for count in range(1, 50):
            next(results)
            assert len(drawn) <= 2 * AHEAD + count + 1
        drawn.clear()
        results = finished_map(square, blocks())
        for count in range(1, 50):
            next(results)
            assert len(drawn) <= 2 * AHEAD + count + 1


def test_what_shares_this_process_stays_in_it():
    with lent(AtOnce(), 2):
        taken = lent_executor().executor
        assert [*ordered_map(square, range(9), workers="threads")] == [x * x for x in range(9)]
        assert [*ordered_map(square, range(9), cores=1)] == [x * x for x in range(9)]
        assert [*ordered_map(square, [3])] == [9]
        assert not taken.taken


def test_a_function_that_does_not_pickle_does_for_threads():
    with ThreadPoolExecutor(2) as pool, lent(pool, 2):
        assert [*ordered_map(lambda x: x + 1, range(9))] == [*range(1, 10)]


def test_what_has_not_begun_is_left_out():
    begun = []

    def work(x, gate):
        begun.append(x)
        if x:
            gate.wait(5.0)
        return x

    gate = threading.Event()
    with ThreadPoolExecutor(1) as pool, lent(pool, 4):
        results = finished_map(partial(work, gate=gate), range(30))
        assert next(results) == 0
        results.close()
        gate.set()
    assert len(begun) <= 2


@pytest.mark.parametrize("cores", [1, 2, 3])
def test_results_come_as_they_are_finished(cores):
    assert sorted(finished_map(square, range(30), cores)) == [x * x for x in range(30)]
    assert [*finished_map(square, [], cores)] == []
    if cores > 1:
        assert next(iter(finished_map(slow_first, range(8), cores))) != 0
    with pytest.raises(InputError, match="found five"):
        [*finished_map(fail_at_five, range(40), cores)]
    with pytest.raises(InputError, match="found 0 cores"):
        finished_map(square, [1], 0)
