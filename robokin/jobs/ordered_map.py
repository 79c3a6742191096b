"""A function of many tasks on all cores, its results in the tasks' order whatever the number of cores.

Worker processes are forked, so that the function may be anything and starts with all that has been prepared; where
there is no safe fork (Windows, macOS) threads do the work, for numpy lets go of the interpreter's lock.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import signal
import sys
import warnings
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sized
from itertools import islice
from typing import TYPE_CHECKING, Any, TypeVar

from robokin.errors import InputError, RobokinError
from robokin.jobs.stages import counted

if TYPE_CHECKING:
    from multiprocessing.connection import Connection
    from multiprocessing.process import BaseProcess

Task = TypeVar("Task")
Result = TypeVar("Result")

AHEAD = 4
"""Tasks for each core that are done, or being done, before the oldest result is taken: it bounds the memory."""

GRACE = 1.0
"""Seconds that a worker has to end by itself before it is told to."""


class WorkerError(RobokinError):
    """A worker process came to an end in the middle of its task."""


def usable_cores() -> int:
    """The cores that this process may run on."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def in_order(function: Callable[[Task], Result], tasks: Iterable[Task], cores: int | None = None) -> Iterator[Result]:
    """The results of function(task), in the tasks' order; tasks are drawn as they are needed.

    cores: how many to use, all usable ones for None. With one core, or fewer than two tasks, and inside a worker,
    all is done in this process. Tasks and results travel between processes and so must pickle. An error of the
    function is raised here in its task's turn. Raises InputError for less than one core, WorkerError when a
    worker was ended from outside (as a system short of memory does).
    """
    if cores is not None and cores < 1:
        raise InputError(f"found {cores} cores, expected at least 1")
    total = len(tasks) if isinstance(tasks, Sized) else None
    waiting = iter(tasks)
    first = list(islice(waiting, cores or usable_cores()))
    if len(first) < 2 or _is_worker():
        return counted(map(function, _chained(first, waiting)), total)
    return counted((_forked if _can_fork() else _threaded)(function, _chained(first, waiting), len(first)), total)


def _chained(first: list[Task], rest: Iterator[Task]) -> Iterator[Task]:
    while first:
        yield first.pop(0)
    yield from rest


def _can_fork() -> bool:
    return sys.platform.startswith("linux")


def _is_worker() -> bool:
    """Whether this is a worker process, which has a core of its own and no more."""
    process = sys.modules.get("multiprocessing.process")
    return process is not None and bool(process.current_process().daemon)


def _threaded(function: Callable[[Task], Result], tasks: Iterator[Task], cores: int) -> Iterator[Result]:
    from concurrent.futures import Future, ThreadPoolExecutor

    pool = ThreadPoolExecutor(cores)
    futures: deque[Future[Result]] = deque()
    try:
        for task in tasks:
            futures.append(pool.submit(function, task))
            if len(futures) >= AHEAD * cores:
                yield futures.popleft().result()
        while futures:
            yield futures.popleft().result()
    finally:
        pool.shutdown(cancel_futures=True)


def _forked(function: Callable[[Task], Result], tasks: Iterator[Task], cores: int) -> Iterator[Result]:
    from multiprocessing.connection import wait

    workers: dict[Connection[Any, Any], BaseProcess] = {}
    busy: dict[Any, int] = {}  # which task each worker's connection has
    done: dict[int, tuple[bool, Any]] = {}
    drawn = given = 0
    try:
        _start(function, cores, workers)
        idle = list(workers)
        more = True
        while True:
            # A worker gets a task only when it waits for one, so that neither side waits for the other to read.
            while more and idle and drawn - given < AHEAD * cores:
                try:
                    task = next(tasks)
                except StopIteration:
                    more = False
                    break
                connection = idle.pop()
                busy[connection] = drawn
                _send(connection, task)
                drawn += 1
            while given in done:
                good, value = done.pop(given)
                given += 1
                if not good:
                    raise value
                yield value
            if given == drawn and not more:
                return
            if given == drawn or (more and idle and drawn - given < AHEAD * cores):
                continue
            for ready in wait(list(busy)):
                done[busy.pop(ready)] = _receive(ready)
                idle.append(ready)  # type: ignore[arg-type]
    finally:
        _end(workers)


def _start(function: Callable[[Task], Result], cores: int, workers: dict[Connection[Any, Any], BaseProcess]) -> None:
    """Fork workers, each with a connection."""
    from multiprocessing import get_context

    context = get_context("fork")
    for _ in range(cores):
        ours, theirs = context.Pipe()
        process = context.Process(target=_work, args=(function, theirs, [*workers, ours]), daemon=True)
        with warnings.catch_warnings(), _no_interrupt():
            # Python warns of threads that a fork leaves behind: those of the algebra library, which knows of forks.
            warnings.simplefilter("ignore", DeprecationWarning)
            process.start()
        theirs.close()
        workers[ours] = process


@contextlib.contextmanager
def _no_interrupt() -> Iterator[None]:
    """Hold back Ctrl-C, so that a worker is not hit by it before it has learned to ignore it."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _work(function: Callable[[Any], Any], connection: Connection[Any, Any], others: list[Connection[Any, Any]]) -> None:
    """A worker's life: tasks come, results go, until the other side hangs up. It never says a word."""
    # Ctrl-C reaches every process of a terminal; the one that started the workers ends them.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    for name in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(name, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    for other in others:
        other.close()
    with contextlib.suppress(EOFError, OSError):
        while True:
            task = connection.recv()
            answer: tuple[bool, Any]
            try:
                answer = True, function(task)
            except Exception as error:
                answer = False, error
            connection.send_bytes(_packed(answer))


def _packed(answer: tuple[bool, Any]) -> bytes:
    try:
        packed = pickle.dumps(answer, pickle.HIGHEST_PROTOCOL)
        pickle.loads(packed) if not answer[0] else None
    except Exception as error:  # an error with arguments of its own may pickle badly, and a result not at all
        cause = error if answer[0] else answer[1]
        return pickle.dumps((False, RuntimeError(f"{type(cause).__name__}: {cause}")))
    return packed


def _send(connection: Connection[Any, Any], task: object) -> None:
    # A worker that is gone is noticed where its answer is read.
    with contextlib.suppress(BrokenPipeError, ConnectionResetError):
        connection.send(task)


def _receive(connection: Any) -> tuple[bool, Any]:
    try:
        return connection.recv()  # type: ignore[no-any-return]
    except (EOFError, ConnectionResetError):
        return False, WorkerError("a worker process was ended from outside, expected more memory or fewer cores")


def _end(workers: dict[Connection[Any, Any], BaseProcess]) -> None:
    """Hang up, which ends workers that wait; end the others, and wait until all are gone."""
    for connection in workers:
        connection.close()
    for process in workers.values():
        process.terminate()
    for process in workers.values():
        process.join(GRACE)
        if process.is_alive():
            process.kill()
            process.join()
