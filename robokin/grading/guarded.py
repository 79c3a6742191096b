"""Answers worked on in a process of their own, which is ended where an answer takes more than its budget.

What a student hands in may hold anything: numbers that a search does not come to an end with, a text that takes the
memory of the machine. A signal's handler cannot end a calculation in a library; ending a process ends anything. One
process works on all answers, one after the other, and hands back what it found; it is ended and started anew, from
the next answer on, only where an answer was too much. So a class costs one process, and an answer whatever its
author wrote no more than its own mark.

The budget is processor time, so that a busy machine takes nobody's mark; a clock ends what waits instead. Where the
system can, the process is forked, may take `MEMORY` more than it starts with, and may write no file.
"""

from __future__ import annotations

import contextlib
import os
import signal
import sys
import warnings
from collections.abc import Callable, Generator, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

from robokin.errors import RobokinError

if TYPE_CHECKING:
    from multiprocessing.connection import Connection
    from multiprocessing.process import BaseProcess

Task = TypeVar("Task")
Result = TypeVar("Result")

BUDGET = 10.0
"""Seconds for an answer unless it is said otherwise: a hundred times what the slowest honest one takes."""

MEMORY = 1 << 30
"""Bytes that an answer may take: some ten times what the largest honest one does."""

PATIENCE = 3.0
"""So many times the budget, and a second, may pass on the clock: other processes may have the processor meanwhile."""

LINUX = sys.platform.startswith("linux")


@dataclass(frozen=True)
class Overrun:
    """That an answer was given up: `why` in words."""

    why: str


def guarded(
    function: Callable[[Task], Result], tasks: Sequence[Task], budget: float = BUDGET
) -> Generator[Result | Overrun, None, None]:
    """The result of function(task) for each task, in order, or an Overrun for one that took too much.

    budget: seconds of processor time for each. A RobokinError of the function is raised here in its task's turn. Tasks
    and results travel between processes and so must pickle.
    """
    given = 0
    while given < len(tasks):
        connection, process = _started(function, tasks[given:], budget)
        try:
            while given < len(tasks):
                outcome = _received(connection, process, budget)
                given += 1
                if isinstance(outcome, Exception):
                    raise outcome
                yield outcome
                if isinstance(outcome, Overrun):
                    break
        finally:
            connection.close()
            process.kill()
            process.join()


def _started(
    function: Callable[[Any], Any], tasks: Sequence[Any], budget: float
) -> tuple[Connection[Any, Any], BaseProcess]:
    """A process that works on some tasks."""
    from multiprocessing import get_context

    context: Any = get_context("fork" if LINUX else "spawn")
    ours, theirs = context.Pipe(duplex=False)
    process: BaseProcess = context.Process(target=_work, args=(function, tasks, budget, theirs, ours), daemon=True)
    with warnings.catch_warnings(), _no_interrupt():
        # Python warns of threads that a fork leaves behind: those of the algebra library, which knows of forks.
        warnings.simplefilter("ignore", DeprecationWarning)
        process.start()
    theirs.close()
    return ours, process


@contextlib.contextmanager
def _no_interrupt() -> Iterator[None]:
    """Hold back Ctrl-C, so that a process is not hit by it before it has learned to ignore it."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _received(connection: Connection[Any, Any], process: BaseProcess, budget: float) -> Any:
    """What the process found for its task, or an Overrun."""
    try:
        if not connection.poll(PATIENCE * budget + 1.0):
            return Overrun(f"it took more than {PATIENCE:g} times the {budget:g} s that an answer may take")
        return connection.recv()
    except (EOFError, OSError):
        process.join()
        if process.exitcode == -getattr(signal, "SIGPROF", 0):
            return Overrun(f"it took more than the {budget:g} s that an answer may take")
        return Overrun("the calculation broke down")


def _work(
    function: Callable[[Any], Any],
    tasks: Sequence[Any],
    budget: float,
    connection: Connection[Any, Any],
    other: Connection[Any, Any],
) -> None:
    """The life of the process: a result for each task, in order, until one was too much. It never says a word.

    other: the end that results are read from. It is closed here, so that nobody is there any more when the reader ends.
    """
    other.close()
    _alone()
    with contextlib.suppress(BrokenPipeError):  # nobody is there any more
        for task in tasks:
            _timer(budget)
            outcome: Any
            try:
                outcome = function(task)
            except MemoryError:
                outcome = Overrun(f"it took more than the {MEMORY >> 20} MiB that an answer may take")
            except RobokinError as error:
                outcome = error
            except Exception as error:  # one answer that trips up the calculation must not take the class with it
                outcome = Overrun(f"the calculation broke down ({type(error).__name__})")
            _timer(0.0)
            connection.send(outcome)
            if isinstance(outcome, Overrun):
                break
    connection.close()
    # Not by way of what the parent has registered for its own end.
    os._exit(0)


def _alone() -> None:
    """Shut the process in: its own signals, no output, no files, no more memory than an answer may take."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    for name in ("SIGTERM", "SIGHUP", "SIGPROF"):
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), signal.SIG_DFL)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    nowhere = os.open(os.devnull, os.O_RDWR)
    for stream in (1, 2):
        os.dup2(nowhere, stream)
    sys.stdout = sys.stderr = open(nowhere, "w", closefd=False)  # noqa: SIM115 - for the life of the process
    if not LINUX:
        return
    import resource

    with open("/proc/self/statm", "rb") as file:  # noqa: PTH123 - no path, the kernel's own table
        used = int(file.read().split()[0]) * resource.getpagesize()
    for kind, most in (
        (resource.RLIMIT_AS, used + MEMORY),
        (resource.RLIMIT_FSIZE, 0),
        (resource.RLIMIT_CORE, 0),
    ):
        hard = resource.getrlimit(kind)[1]
        resource.setrlimit(kind, (most if hard == resource.RLIM_INFINITY else min(most, hard), hard))


def _timer(seconds: float) -> None:
    """Have the system end this process after so many seconds of its work; 0 for never."""
    if hasattr(signal, "setitimer"):
        signal.setitimer(signal.ITIMER_PROF, seconds)
