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
from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, TypeVar

from robokin.errors import RobokinError
from robokin.jobs.ordered_map import WorkerError, default_signals, no_interrupt, ordered_map

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

SHARE = 64
"""Answers that a worker of a cluster marks at a time."""

LINUX = sys.platform.startswith("linux")

NO_PROCESSES = sys.platform in ("emscripten", "wasi")
"""Whether there are no processes to start, as in a browser: who asks there marks their own answer, without a budget."""


@dataclass(frozen=True)
class Overrun:
    """That an answer was given up: `why` in words."""

    why: str


def guarded(
    function: Callable[[Task], Result], tasks: Sequence[Task], budget: float = BUDGET, cores: int = 1
) -> Generator[Result | Overrun, None, None]:
    """The result of function(task) for each task, in order, or an Overrun for one that took too much.

    budget: seconds of processor time for each. cores: so many processes share the tasks. A RobokinError of the function
    is raised here in its task's turn. Tasks and results travel between processes and so must pickle.
    """
    if NO_PROCESSES:
        yield from map(function, tasks)
        return
    with contextlib.ExitStack() as running:
        lanes = [running.enter_context(_Lane(function, tasks[first::cores], budget)) for first in range(cores)]
        for number in range(len(tasks)):
            outcome = lanes[number % cores].next()
            if isinstance(outcome, Exception):
                raise outcome
            yield outcome


def shared_out(
    function: Callable[[Task], Result], tasks: Sequence[Task], budget: float
) -> Generator[Result | Overrun, None, None]:
    """The same from the workers of an executor that is lent, each of which starts a process for its share of tasks."""
    shares = [tasks[first : first + SHARE] for first in range(0, len(tasks), SHARE)]
    for outcomes in ordered_map(partial(_share, function, budget), shares):
        yield from outcomes


def _share(function: Callable[[Any], Any], budget: float, tasks: Sequence[Any]) -> list[Any]:
    from multiprocessing import current_process

    if current_process().daemon:
        raise WorkerError(
            "the workers of the cluster may start no processes, which answers are marked in, expected workers with "
            "DASK_DISTRIBUTED__WORKER__DAEMON=False"
        )
    return list(guarded(function, tasks, budget))


class _Lane:
    """The tasks of one core: a process works on them one after the other, and another one goes on behind an Overrun."""

    def __init__(self, function: Callable[[Any], Any], tasks: Sequence[Any], budget: float) -> None:
        self.function, self.tasks, self.budget = function, tasks, budget
        self.given = 0
        self.running: tuple[Connection[Any, Any], BaseProcess] | None = None

    def __enter__(self) -> _Lane:
        """Begin with the first task that has no outcome yet."""
        if self.given < len(self.tasks):
            self.running = _started(self.function, self.tasks[self.given :], self.budget)
        return self

    def __exit__(self, *error: object) -> None:
        """End, whatever goes on."""
        if self.running is not None:
            connection, process = self.running
            self.running = None
            connection.close()
            process.kill()
            process.join()

    def next(self) -> Any:
        """What the process found for the next task, or an Overrun, or the error to raise."""
        if self.running is None:
            self.__enter__()
        assert self.running is not None
        outcome = _received(*self.running, self.budget)
        self.given += 1
        if isinstance(outcome, Overrun) or self.given == len(self.tasks):
            self.__exit__()
        return outcome


def _started(
    function: Callable[[Any], Any], tasks: Sequence[Any], budget: float
) -> tuple[Connection[Any, Any], BaseProcess]:
    """A process that works on some tasks."""
    from multiprocessing import get_context

    context: Any = get_context("fork" if LINUX else "spawn")
    ours, theirs = context.Pipe(duplex=False)
    process: BaseProcess = context.Process(target=_work, args=(function, tasks, budget, theirs, ours), daemon=True)
    with warnings.catch_warnings(), no_interrupt():
        # Python warns of threads that a fork leaves behind: those of the algebra library, which knows of forks.
        warnings.simplefilter("ignore", DeprecationWarning)
        process.start()
    theirs.close()
    return ours, process


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
    default_signals()
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
