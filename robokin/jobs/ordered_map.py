"""A function of many blocks on several cores, its results in the blocks' order whatever the number of cores.

The workers are those of `concurrent.futures`, or of an executor that is lent. Processes are forked where that is safe,
so that the function may be anything and starts with all that has been prepared. Elsewhere (Windows, macOS) threads do
the work, for numpy lets go of the interpreter's lock, or fresh processes for a program that may be started again: the
function must then pickle, and a script needs its `if __name__ == "__main__":`.
"""

from __future__ import annotations

import contextlib
import os
import signal
import sys
import threading
import warnings
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sized
from functools import partial
from itertools import chain, islice
from typing import TYPE_CHECKING, Any, Literal, TypeVar

from robokin.errors import InputError, RobokinError
from robokin.jobs.executors import lent_executor, lent_pool
from robokin.jobs.stages import counted
from robokin.jobs.worker_threads import here, in_worker

if TYPE_CHECKING:
    from concurrent.futures import Future, ProcessPoolExecutor
    from multiprocessing.connection import Connection

Block = TypeVar("Block")
Result = TypeVar("Result")
Workers = Literal["auto", "processes", "threads"]

MOST_CORES = 1024
"""Cores at most: more are a slip."""

AHEAD = 4
"""Blocks for each core that are done, or being done, before the oldest result is taken: it bounds the memory."""

GRACE = 1.0
"""Seconds that a worker between two blocks has to end by itself before it is ended."""


ENDED = "a worker process was ended from outside, expected more memory or fewer cores"


class WorkerError(RobokinError):
    """A worker process came to an end in the middle of its block."""


def usable_cores() -> int:
    """The cores that this process may run on."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def ordered_map(
    function: Callable[[Block], Result],
    blocks: Iterable[Block],
    cores: int | None = None,
    window: int | None = None,
    workers: Workers = "auto",
) -> Iterator[Result]:
    """The results of function(block), in the blocks' order; blocks are drawn as they are needed.

    cores: how many to use, all usable ones for None. window: blocks under way or done before the oldest result is
    taken, `AHEAD` for each core for None. workers: "processes" are forked or else fresh ones, "threads" share this
    process, "auto" forks or else takes threads. With one core, or fewer than two blocks, and inside a worker, all is
    done here. Blocks and results travel between processes and so must pickle. An error of the function, or of what the
    blocks are drawn from, is raised here in its block's turn. Where an executor is lent (executors.py) it works on what
    does not share this process, whatever the number of cores, unless that is one. Raises InputError for less than one
    core, WorkerError when a worker was ended from outside (as a system short of memory does).
    """
    return _mapped(_in_turn, function, blocks, cores, window, workers)


def finished_map(
    function: Callable[[Block], Result], blocks: Iterable[Block], cores: int | None = None
) -> Iterator[Result]:
    """The same results as they are finished, in whatever order: for work that is put in its place elsewhere.

    A block that takes long holds up no other one's result. Raises as `ordered_map` does, but for the order.
    """
    return _mapped(_as_finished, function, blocks, cores, None, "processes")


def _mapped(
    taken: Callable[[Callable[[], Any], Iterator[Any], int], Iterator[Any]],
    function: Callable[[Any], Any],
    blocks: Iterable[Any],
    cores: int | None,
    window: int | None,
    workers: Workers,
) -> Iterator[Any]:
    """The results of a function of blocks, in the order in which `taken` takes them from a pool."""
    if cores is not None and cores < 1:
        raise InputError(f"found {cores} cores, expected at least 1")
    total = len(blocks) if isinstance(blocks, Sized) else None
    lent = None if workers == "threads" or cores == 1 or in_worker() else lent_executor()
    waiting = iter(blocks)
    first: list[Any] = []
    try:
        first.extend(islice(waiting, 2 if lent else cores or usable_cores()))
    except Exception as error:
        waiting = _raising(error)
    drawn = chain(first, waiting)
    if len(first) < 2 or in_worker():
        return counted(map(function, drawn), total)
    if lent is not None:
        ahead = max(window or 0, AHEAD * lent.workers)
        return counted(taken(partial(lent_pool, lent.executor, function), drawn, ahead), total)
    several = len(first)
    threads = workers == "threads" or (workers == "auto" and not _can_fork())
    pool = _thread_pool if threads else _process_pool
    return counted(taken(partial(pool, function, several), drawn, window or AHEAD * several), total)


def _in_turn(pool: Callable[[], Any], blocks: Iterator[Block], window: int) -> Iterator[Any]:
    """The results of blocks that a pool's workers take, the oldest first, at most `window` of them not yet taken."""
    from concurrent.futures import BrokenExecutor

    under_way: deque[Future[Any]] = deque()
    try:
        with pool() as submit:
            while True:
                try:
                    under_way.append(submit(next(blocks)))
                except StopIteration:
                    break
                except Exception as error:
                    blocks = _raising(error)
                    break
                if len(under_way) >= window:
                    yield under_way.popleft().result()
            while under_way:
                yield under_way.popleft().result()
            yield from blocks  # there are no more, or what is wrong with the next one is said
    except BrokenExecutor:
        raise WorkerError(ENDED) from None


def _as_finished(pool: Callable[[], Any], blocks: Iterator[Any], window: int) -> Iterator[Any]:
    """The results of blocks that a pool's workers take, each when it is there, at most `window` under way."""
    from concurrent.futures import BrokenExecutor
    from queue import SimpleQueue

    finished: SimpleQueue[Any] = SimpleQueue()
    under_way: set[Any] = set()
    try:
        with pool() as submit:
            for block in blocks:
                under_way.add(promise := submit(block))
                promise.add_done_callback(finished.put)
                del promise
                if len(under_way) >= window:
                    yield _next_finished(finished, under_way)
            while under_way:
                yield _next_finished(finished, under_way)
    except BrokenExecutor:
        raise WorkerError(ENDED) from None


def _next_finished(finished: Any, under_way: set[Any]) -> Any:
    promise = finished.get()
    under_way.discard(promise)
    return promise.result()


def _raising(error: Exception) -> Iterator[Any]:
    """No blocks but an error."""
    raise error
    yield


def _can_fork() -> bool:
    return sys.platform.startswith("linux")


@contextlib.contextmanager
def _thread_pool(function: Callable[[Any], Any], cores: int) -> Iterator[Callable[[Any], Future[Any]]]:
    from concurrent.futures import ThreadPoolExecutor

    pool = ThreadPoolExecutor(cores, initializer=_begin_thread)
    try:
        yield lambda block: pool.submit(function, block)
    finally:
        pool.shutdown(cancel_futures=True)


@contextlib.contextmanager
def _process_pool(function: Callable[[Any], Any], cores: int) -> Iterator[Callable[[Any], Future[Any]]]:
    """Processes that begin with the function, and end when this block does, whatever they are at."""
    from concurrent.futures import ProcessPoolExecutor
    from multiprocessing import get_context

    fork = _can_fork()
    context: Any = get_context("fork" if fork else "spawn")
    theirs, ours = context.Pipe(duplex=False)
    start = (function, theirs, ours if fork else None)
    pool = ProcessPoolExecutor(cores, context, initializer=_begin_process, initargs=start)
    try:
        yield partial(_submitted, pool)
    except BaseException:
        with contextlib.suppress(OSError):
            for _ in range(cores):
                ours.send_bytes(b"")  # one for each: a message without content is read whole or not at all
        raise
    finally:
        pool.shutdown(cancel_futures=True)
        ours.close()
        theirs.close()


def _submitted(pool: ProcessPoolExecutor, block: Any) -> Future[Any]:
    with warnings.catch_warnings(), no_interrupt():
        # Python warns of threads that a fork leaves behind: those of the algebra library, which knows of forks.
        warnings.simplefilter("ignore", DeprecationWarning)
        return pool.submit(_work, block)


@contextlib.contextmanager
def no_interrupt() -> Iterator[None]:
    """Hold back Ctrl-C, so that a process is not hit by it before it has learned to ignore it."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def default_signals() -> None:
    """In a new process: Ctrl-C, which reaches every process of a terminal, is for the one that started it to heed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    for name in ("SIGTERM", "SIGHUP", "SIGPROF"):
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), signal.SIG_DFL)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})


def _begin_thread() -> None:
    here.worker = True


def _begin_process(
    function: Callable[[Any], Any], told: Connection[Any, Any], other: Connection[Any, Any] | None
) -> None:
    """A worker process begins. told: from where it hears that it should end; other: its other end, if it is here."""
    default_signals()
    if other is not None:
        other.close()
    here.worker, here.function, here.between = True, function, threading.Lock()
    here.between.acquire()
    threading.Thread(target=_end_when_told, args=(told, here.between), daemon=True).start()


def _end_when_told(told: Connection[Any, Any], between: threading.Lock) -> None:
    """End this process in the middle of its block when it is told to, or when the one that started it is gone.

    A result that is being handed back is handed back first: the other side would wait for the rest of it.
    """
    with contextlib.suppress(EOFError, OSError):
        told.recv_bytes()
        between.acquire(timeout=GRACE)
    os._exit(0)


def _work(block: Any) -> Any:
    """A worker process works at a block."""
    here.between.release()
    try:
        return here.function(block)
    except Exception as error:
        wrong = _portable(error)
    finally:
        here.between.acquire()
    raise wrong  # not within the handler, whose error might travel with it


def _portable(error: Exception) -> Exception:
    """The error, or one that says it in words where it does not pickle: it may have arguments of its own."""
    import pickle

    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        return RuntimeError(f"{type(error).__name__}: {error}")
    return error
