"""Executors lent from outside: whatever takes a function and hands back a future, as those of `concurrent.futures` do.

Within `lent` every map of blocks whose work may leave this process goes to the executor in place of processes of its
own. Results stay in the blocks' order, so that they are the same wherever they were made.
"""

from __future__ import annotations

import contextlib
import pickle
from collections.abc import Callable, Iterator
from contextvars import ContextVar
from functools import lru_cache
from typing import TYPE_CHECKING, Any, Protocol
from weakref import WeakSet

from robokin.jobs.worker_threads import as_worker

if TYPE_CHECKING:  # to make classes of them takes longer than all else here

    class Promise(Protocol):
        """What an executor hands back for a task."""

        def result(self) -> Any:
            """The result when it is there, or the error of the function."""

        def cancel(self) -> Any:
            """Leave the task out if it has not begun."""

        def add_done_callback(self, fn: Callable[[Any], object], /) -> Any:
            """Have a function called when the task is over."""

    class Executor(Protocol):
        """Whatever takes tasks: an executor of `concurrent.futures`, of Dask, of MPI."""

        def submit(self, fn: Callable[..., Any], /, *arguments: Any) -> Promise:
            """Have a function called somewhere, some time."""


MOST_FUNCTIONS = 8
"""Functions that a worker keeps ready: a command has one or two at a time."""


class Lent:
    """An executor and how many workers it has, by which the number of tasks under way is bounded."""

    def __init__(self, executor: Executor, workers: int) -> None:
        self.executor, self.workers = executor, workers


_LENT: ContextVar[Lent | None] = ContextVar("lent executor", default=None)


def lent_executor() -> Lent | None:
    """The executor that work goes to now; None for processes or threads of one's own."""
    return _LENT.get()


@contextlib.contextmanager
def lent(executor: Executor, workers: int) -> Iterator[None]:
    """Within, maps of blocks go to the executor, which has so many workers."""
    token = _LENT.set(Lent(executor, max(workers, 1)))
    try:
        yield
    finally:
        _LENT.reset(token)


@contextlib.contextmanager
def lent_pool(executor: Executor, function: Callable[[Any], Any]) -> Iterator[Callable[[Any], Promise]]:
    """How to have the function of a block worked on by an executor; at the end what has not begun is left out.

    The function travels as one string of bytes, which a worker unpacks once and not with every block.
    """
    try:
        task: Callable[..., Any] = _packed_call
        work: Any = pickle.dumps(function)
    except Exception:  # what does not pickle may still do for an executor of threads
        task, work = _plain_call, function
    given: WeakSet[Any] = WeakSet()

    def submit(block: Any) -> Promise:
        promise = executor.submit(task, work, block)
        given.add(promise)
        return promise

    try:
        yield submit
    finally:
        for promise in given:
            promise.cancel()


def _packed_call(work: bytes, block: Any) -> Any:
    return _plain_call(_unpacked(work), block)


def _plain_call(function: Callable[[Any], Any], block: Any) -> Any:
    with as_worker():
        return function(block)


@lru_cache(maxsize=MOST_FUNCTIONS)
def _unpacked(work: bytes) -> Callable[[Any], Any]:
    function: Callable[[Any], Any] = pickle.loads(work)
    return function
