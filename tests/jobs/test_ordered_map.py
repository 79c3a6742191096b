"""Results come in their tasks' order, from any number of cores; nothing is left behind."""

from __future__ import annotations

import math
import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

from robokin.errors import InputError
from robokin.jobs import ordered_map as jobs
from robokin.jobs.ordered_map import WorkerError, ordered_map, usable_cores


def square(x):
    return x * x


def slow_first(x):
    time.sleep(0.02 if x % 3 == 0 else 0.0)
    return x, os.getpid()


def fail_at_five(x):
    if x == 5:
        raise ValueError("five is wrong")
    return x


def end_at_five(x):
    if x == 5:
        os._exit(9)
    return x


class StubbornError(Exception):
    """An error that does not pickle, whatever other libraries teach pickle of errors."""

    def __init__(self, a, b):
        super().__init__(f"{a} and {b}")
        self.lock = threading.Lock()


def fail_stubbornly(x):
    raise StubbornError(x, "more")


def no_children():
    return not multiprocessing.active_children()


@pytest.mark.parametrize("cores", [1, 2, 3, None])
def test_results_come_in_order(cores):
    assert list(ordered_map(square, range(50), cores)) == [x * x for x in range(50)]
    assert no_children()


def test_slow_tasks_do_not_change_the_order():
    results = list(ordered_map(slow_first, range(30), 3))
    assert [x for x, _ in results] == list(range(30))
    assert len({process for _, process in results}) == 3
    assert os.getpid() not in {process for _, process in results}


def test_threads_do_the_same(monkeypatch):
    monkeypatch.setattr(jobs, "_can_fork", lambda: False)
    assert list(ordered_map(square, range(50), 3)) == [x * x for x in range(50)]
    with pytest.raises(ValueError, match="five"):
        list(ordered_map(fail_at_five, range(50), 2))


def test_one_task_or_one_core_stays_in_this_process():
    assert [pid for _, pid in ordered_map(slow_first, [1], 4)] == [os.getpid()]
    assert {pid for _, pid in ordered_map(slow_first, range(4), 1)} == {os.getpid()}
    assert list(ordered_map(square, [], 2)) == []


def test_functions_need_not_pickle():
    factor = np.arange(3.0)
    assert [float(value.sum()) for value in ordered_map(lambda x: factor * x, range(5), 2)] == [0, 3, 6, 9, 12]


def test_large_tasks_and_results_pass(rng):
    tasks = [rng.random(200_000) for _ in range(9)]
    for task, result in zip(tasks, ordered_map(np.sqrt, tasks, 2), strict=True):
        assert np.array_equal(result, np.sqrt(task))


def test_tasks_are_drawn_as_they_are_needed():
    drawn = []

    def tasks():
        for x in range(10_000):
            drawn.append(x)
            yield x

    results = ordered_map(square, tasks(), 2)
    for _ in range(3):
        next(results)
    assert len(drawn) <= 3 + jobs.AHEAD * 2 + 2
    results.close()
    assert no_children()


@pytest.mark.parametrize("cores", [1, 2])
def test_an_error_is_raised_in_its_turn(cores):
    results = ordered_map(fail_at_five, range(20), cores)
    assert [next(results) for _ in range(5)] == [0, 1, 2, 3, 4]
    with pytest.raises(ValueError, match="five is wrong"):
        next(results)
    assert no_children()


def test_an_error_that_cannot_travel_is_told_in_words():
    with pytest.raises(RuntimeError, match="StubbornError: 0 and more"):
        list(ordered_map(fail_stubbornly, range(3), 2))


def test_a_worker_that_is_ended_is_noticed():
    with pytest.raises(WorkerError, match="ended from outside"):
        list(ordered_map(end_at_five, range(20), 2))
    assert no_children()


def test_a_worker_does_its_own_work_alone():
    def inner(x):
        return sum(ordered_map(square, range(x), 2))

    assert list(ordered_map(inner, range(5), 2)) == [0, 0, 1, 5, 14]


def test_less_than_one_core_is_refused():
    with pytest.raises(InputError, match="found 0 cores, expected at least 1"):
        ordered_map(square, range(3), 0)
    assert usable_cores() >= 1


INTERRUPTED = """
import signal, time
signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background jobs are started without
from robokin.jobs.ordered_map import ordered_map

def work(x):
    time.sleep(0.02)
    return x

try:
    for x in ordered_map(work, range(100_000), 2):
        print(x, flush=True)
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""


@pytest.mark.skipif(os.name == "nt", reason="there are no process groups")
def test_ctrl_c_ends_everything_without_a_word():
    process = subprocess.Popen(
        [sys.executable, "-c", INTERRUPTED], stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True
    )
    assert process.stdout.readline() == b"0\n"
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does: to every process of the group
    out, err = process.communicate(timeout=20)
    assert out.endswith(b"interrupted\n")
    assert err == b""
    assert process.returncode == 0
    with pytest.raises(ProcessLookupError):
        os.killpg(process.pid, 0)


@pytest.mark.skipif(os.name == "nt", reason="there are no process groups")
def test_workers_end_when_their_parent_is_killed():
    process = subprocess.Popen([sys.executable, "-c", INTERRUPTED], stdout=subprocess.PIPE, start_new_session=True)
    assert process.stdout.readline() == b"0\n"
    process.kill()
    process.communicate(timeout=20)
    for _ in range(200):
        try:
            os.killpg(process.pid, 0)
        except ProcessLookupError:
            return
        time.sleep(0.05)
    pytest.fail("a worker outlived its parent")


def test_an_error_of_the_blocks_comes_behind_the_results_before_it():
    for good in (1, 5, 20):
        drawn = (x if x < good else [][x] for x in range(50))
        results = ordered_map(square, drawn, 2)
        assert [next(results) for _ in range(good)] == [x * x for x in range(good)]
        with pytest.raises(IndexError):
            next(results)
    assert no_children()


def test_fresh_processes_do_the_same(monkeypatch):
    monkeypatch.setattr(jobs, "_can_fork", lambda: False)
    assert list(ordered_map(math.factorial, range(20), 2, workers="processes")) == [
        math.factorial(x) for x in range(20)
    ]
    with pytest.raises(ValueError, match="factorial"):
        list(ordered_map(math.factorial, [1, 2, -1], 2, workers="processes"))
    assert no_children()


def test_work_under_way_is_given_up_when_nobody_waits_for_it():
    results = ordered_map(lambda x: time.sleep(30.0 * (x > 0)), range(8), 2)
    next(results)
    began = time.monotonic()
    results.close()
    assert time.monotonic() - began < 10.0
    assert no_children()


def test_the_window_bounds_what_is_drawn_before_the_oldest_result_is_taken():
    drawn = []
    results = ordered_map(square, (drawn.append(x) or x for x in range(1000)), 2, window=3)
    next(results)
    assert len(drawn) <= 4
    results.close()
