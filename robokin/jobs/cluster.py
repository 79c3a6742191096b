"""Work on the machines of a Dask cluster, or on processes of this machine that are one.

A scheduler hands tasks to workers, and those of a worker that is lost to others. What a task needs travels with it, and
what it gives comes back or stands in a file: no worker holds anything that others need.

Dask and its scheduler come with `robokin[cluster]`; nothing of them is loaded before a cluster is asked for.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import logging
import os
import pickle
import re
import signal
import threading
import time
import warnings
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError, Future, InvalidStateError
from importlib import import_module
from typing import Any
from weakref import WeakSet

from robokin.errors import InputError, shown
from robokin.jobs.executors import lent
from robokin.jobs.ordered_map import MOST_CORES, WorkerError, no_interrupt, usable_cores

LOCAL = "local"
"""The address of processes of this machine, alone or with a number: `local:4`."""

EXPECTED = f"{LOCAL}:N, tcp://HOST:PORT, or the file of a scheduler"
FILE = "the one that `dask scheduler --scheduler-file` writes"

ADDRESS = re.compile(
    r"inproc://[^\s/]+/[0-9]+/\S+|(?:(?P<kind>[a-z]+)://)?(?:[^\s/:\[\]]+|\[[0-9A-Za-z:.%]+\]):(?P<port>[0-9]{1,5})"
)
"""Addresses of schedulers: of a machine (a name, a number, of IPv6 in brackets), or of this process."""

INSTALL = "expected Dask: pip install 'robokin[cluster]'"

CONNECTING = 10.0
"""Seconds that a scheduler has to answer."""

ARRIVING = 60.0
"""Seconds that the first worker of a cluster has to arrive."""

LEFT_ALONE = 300.0
"""Seconds that a cluster whose workers are all gone has to get others, before its tasks are given up."""

LOOKING = 5.0
"""Seconds from one look at the number of workers to the next."""

SETTINGS = {
    "distributed.worker.daemon": False,  # marks of answers are made in a process of their own
    "distributed.comm.timeouts.connect": f"{CONNECTING:g}s",
    "distributed.scheduler.work-stealing": True,
    # A process that takes the place of one that ended may take longer than Dask's 15 s to start, on a busy machine; it
    # would be closed, and nobody would be left.
    "distributed.deploy.lost-worker-timeout": f"{LEFT_ALONE:g}s",
    "distributed.admin.large-graph-warning-threshold": "1GB",  # the rows of a part go with its task
    # Without Dask's MALLOC_TRIM_THRESHOLD_, by which each block's arrays go back to the system and come anew, page by
    # page: half as much time again.
    "distributed.nanny.pre-spawn-environ": dict.fromkeys(
        ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS"), 1
    ),
}
"""Of Dask, for as long as a cluster is used here; what is wrong is said in sentences."""


_ALONE = "the cluster has had no worker for {:g} s, expected at least one until the work is done"

LOGGERS = ("distributed", "distributed.client")
"""Of Dask's loggers those that have a level of their own."""


@contextlib.contextmanager
def cluster(address: str) -> Iterator[int]:
    """Within, maps of blocks are worked on by a cluster; gives the number of its workers.

    address: that of a Dask scheduler (`tcp://HOST:PORT`), the JSON file that it writes of itself, or `local:N` for N
    processes of this machine, which end with the block. Raises InputError for what is no address and where Dask is
    missing, WorkerError where nobody answers, or no worker arrives.
    """
    local = _local_workers(address)
    with contextlib.ExitStack() as open_now:
        distributed = open_now.enter_context(_distributed())
        if local is not None:
            address = open_now.enter_context(_local_cluster(distributed, local))
        else:
            address = _scheduler_address(distributed, address)
        client = open_now.enter_context(_client(distributed, address))
        workers = _workers(client, address, local)
        executor = open_now.enter_context(contextlib.closing(_ClusterExecutor(client)))
        open_now.enter_context(lent(executor, workers))
        yield workers


def _local_workers(address: str) -> int | None:
    """The number of `local:N`, all usable cores for `local`; None for another address. Raises InputError."""
    name, colon, count = address.strip().partition(":")
    if not name and not colon:
        raise InputError(f"found no address of a cluster, expected {LOCAL}:N or that of a Dask scheduler")
    if name.casefold() != LOCAL:
        return None
    if not colon:
        return usable_cores()
    if not (count.isascii() and count.isdecimal() and len(count) < 9 and 1 <= int(count) <= MOST_CORES):
        raise InputError(f"found the cluster '{shown(address)}', expected {LOCAL}:N with N from 1 to {MOST_CORES}")
    return int(count)


def _scheduler_address(distributed: Any, given: str) -> str:
    """The address of a scheduler, from its file too: Dask itself waits long for one that is none. Raises InputError."""
    address = given.strip()
    if address.endswith(".json") or os.path.isfile(address):  # noqa: PTH113 - no path but for this
        try:
            with open(address, encoding="utf-8") as file:  # noqa: PTH123
                address = str(json.load(file)["address"])
        except FileNotFoundError:
            raise InputError(f"{shown(given)}: no such file, expected {FILE}") from None
        except OSError as error:
            raise InputError(f"{shown(given)}: {error.strerror}, expected {FILE}") from None
        except (ValueError, KeyError, TypeError):
            raise InputError(f"{shown(given)}: found no address of a scheduler in it, expected {FILE}") from None
    address = address.rstrip("/")
    form = ADDRESS.fullmatch(address)
    if form is None or form["kind"] not in (None, *distributed.comm.registry.backends) or not _is_port(form["port"]):
        raise InputError(f"found the cluster '{shown(address)}', expected {EXPECTED}")
    if form["kind"] in ("tls", "wss") and not _has_certificates(distributed):
        raise InputError(f"found the cluster '{shown(address)}', expected certificates in Dask's settings for TLS")
    return address


def _is_port(port: str | None) -> bool:
    """Whether this is a port's number; None where the address has no place for one."""
    return port is None or 0 < int(port) < 1 << 16


def _has_certificates(distributed: Any) -> bool:
    """Whether Dask's settings name those that TLS needs, or what finds them. Raises InputError."""
    try:
        context = distributed.Security().get_connection_args("client").get("ssl_context")
    except OSError as error:
        said = f"found certificates that cannot be read ({shown(str(error))})"
        raise InputError(f"{said}, expected those that Dask's settings name") from None
    return context is not None or bool(import_module("dask").config.get("distributed.client.security-loader", None))


@contextlib.contextmanager
def _distributed() -> Iterator[Any]:
    """Dask's scheduler with the settings that are needed, and without its logs: what is wrong is said in sentences.

    Raises InputError where it is not installed.
    """
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", module="distributed|dask|tornado|asyncio")
        try:
            dask, distributed = import_module("dask"), import_module("distributed")
        except ImportError as error:
            raise InputError(f"found no module {error.name}, {INSTALL}") from None
        muted = [logging.getLogger(name) for name in LOGGERS]
        levels = [one.level for one in muted]
        for one in muted:
            one.setLevel(logging.CRITICAL + 1)
        try:
            with dask.config.set(SETTINGS):
                yield distributed
        finally:
            for one, level in zip(muted, levels, strict=True):
                one.setLevel(level)


@contextlib.contextmanager
def _local_cluster(distributed: Any, workers: int) -> Iterator[str]:
    """The address of a scheduler whose workers are processes of this machine. Raises WorkerError."""
    try:
        with no_interrupt(), _interrupts_ignored():
            own = distributed.LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                processes=True,
                memory_limit=0,
                dashboard_address="127.0.0.1:0",
                silence_logs=logging.CRITICAL + 1,
                preload="robokin.jobs.cluster_worker",
            )
    except Exception as error:
        raise WorkerError(f"{LOCAL}:{workers} did not start ({_said(error)}), expected processes to work") from None
    try:
        yield str(own.scheduler_address)
    finally:
        with contextlib.suppress(Exception):
            own.close(timeout=CONNECTING)


@contextlib.contextmanager
def _interrupts_ignored() -> Iterator[None]:
    """Processes that are started within ignore Ctrl-C, which is for this one to heed; here it is held back."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


@contextlib.contextmanager
def _client(distributed: Any, address: str) -> Iterator[Any]:
    """Whoever hands tasks to the scheduler at HOST:PORT. Raises InputError, WorkerError where nobody answers."""
    try:
        with no_interrupt():
            client = distributed.Client(address, timeout=CONNECTING, set_as_default=False)
    except (OSError, TimeoutError) as error:
        cause = getattr(error.__cause__ or error, "strerror", None)
        why = f" ({shown(cause)})" if cause else ""
        sentence = f"no scheduler answers at {shown(address)} in {CONNECTING:g} s{why}"
        raise WorkerError(f"{sentence}, expected a Dask scheduler that runs, or {LOCAL}:N") from None
    except (ValueError, TypeError, KeyError) as error:
        said = f"found the cluster '{shown(address)}' ({_said(error)})"
        raise InputError(f"{said}, expected {EXPECTED}") from None
    try:
        yield client
    finally:
        with contextlib.suppress(Exception):
            client.close(timeout=CONNECTING)


def _workers(client: Any, address: str, wanted: int | None) -> int:
    """How many workers there are, when at least one has come. Raises WorkerError."""
    try:
        client.wait_for_workers(wanted or 1, timeout=ARRIVING)
        return int(sum(client.nthreads().values()))
    except (OSError, TimeoutError):
        raise WorkerError(f"{shown(address)}: no worker has come in {ARRIVING:g} s, expected at least one") from None


def _said(error: BaseException) -> str:
    """An error of Dask's in a few words."""
    return shown(str(error) or type(error).__name__)


class _ClusterExecutor:
    """Takes tasks for a cluster; each brings the versions along with which its answer would be the same."""

    def __init__(self, client: Any) -> None:
        self.client, self.versions = client, versions()
        self.given: WeakSet[Any] = WeakSet()
        self.giving = threading.Lock()
        self.alone, self.over = False, threading.Event()
        threading.Thread(target=self._look_for_workers, daemon=True).start()

    def submit(self, fn: Callable[..., Any], /, *arguments: Any) -> Any:
        """Have a function called by some worker."""
        if self.alone:
            raise WorkerError(_ALONE.format(LEFT_ALONE))
        call = pickle.dumps(_Call(self.versions, fn, arguments))
        task = self.client.submit(pickle.loads, call, pure=False)
        with self.giving:
            self.given.add(task)
        return _ClusterPromise(self, task)

    def close(self) -> None:
        """What has not begun is left out."""
        self.over.set()
        with self.giving:
            tasks = [*self.given]
        with contextlib.suppress(Exception):
            self.client.cancel(tasks)

    def _look_for_workers(self) -> None:
        """Give the tasks up when there has been no worker for a long time: Dask would wait for ever."""
        seen = time.monotonic()
        while not self.over.wait(LOOKING):
            with contextlib.suppress(Exception):
                if self.client.nthreads():
                    seen = time.monotonic()
            if time.monotonic() - seen > LEFT_ALONE and not self.over.is_set():
                self.alone = True
                self.close()


class _Call:
    """A call that is made where it is unpickled: to the scheduler, which has no robokin, it is a string of bytes."""

    def __init__(
        self, versions: tuple[tuple[str, str], ...], fn: Callable[..., Any], arguments: tuple[Any, ...]
    ) -> None:
        self.parts = versions, fn, *arguments

    def __reduce__(self) -> tuple[Callable[..., Any], tuple[Any, ...]]:
        return _checked_call, self.parts


class _ClusterPromise:
    """A task of a cluster; what went wrong with the cluster itself is said in sentences.

    Dask's own executor takes a result that is there for an error if the worker that has it is lost in that moment.
    """

    def __init__(self, executor: _ClusterExecutor, task: Any) -> None:
        self.executor, self.task = executor, task
        self.promise: Future[Any] = Future()
        executor.client.loop.add_callback(self._brought)

    async def _brought(self) -> None:
        """Have the result here as soon as there is one: what a worker holds is lost with it."""
        try:
            result = await self.task
        except (asyncio.CancelledError, CancelledError):
            self.promise.cancel()
            self.promise.set_running_or_notify_cancel()
        except Exception as error:
            with contextlib.suppress(InvalidStateError):  # cancelled meanwhile
                self.promise.set_exception(error)
        else:
            with contextlib.suppress(InvalidStateError):
                self.promise.set_result(result)

    def result(self) -> Any:
        """What the function gave, or its error. Raises WorkerError where the cluster has lost it for good."""
        try:
            return self.promise.result()
        except CancelledError:
            if self.executor.alone:
                raise WorkerError(_ALONE.format(LEFT_ALONE)) from None
            raise WorkerError("the scheduler is gone, expected it to stay until the work is done") from None
        except Exception as error:
            if type(error).__name__ == "KilledWorker":
                raise WorkerError(
                    "several workers came to an end with the same part, expected workers with more memory, or smaller "
                    "parts"
                ) from None
            if isinstance(error, ModuleNotFoundError):
                said = f"a worker of the cluster has no module {error.name}"
                raise WorkerError(f"{said}, expected robokin on each, with the same extras") from None
            raise

    def cancel(self) -> None:
        """Leave the task out if it has not begun."""
        if self.promise.cancel():
            self.task.cancel()

    def add_done_callback(self, fn: Callable[[Any], object], /) -> None:
        """Have a function called when the task is over."""
        self.promise.add_done_callback(lambda _: fn(self))


def versions() -> tuple[tuple[str, str], ...]:
    """What the last digits of an answer may hang on: the versions of this program, of its kernel, of what is below."""
    import numpy

    import robokin
    from robokin.kernel.native_kernel import kernel_in_use

    return (("robokin", robokin.__version__), ("kernel", kernel_in_use), ("numpy", numpy.__version__))


def _checked_call(expected: tuple[tuple[str, str], ...], function: Callable[..., Any], *arguments: Any) -> Any:
    """In a worker: the function's result. Raises WorkerError where this program is another one than who asks has."""
    for (name, wanted), (_, found) in zip(expected, versions(), strict=True):
        if wanted != found:
            raise WorkerError(f"a worker of the cluster has {name} {found}, expected {wanted} as here")
    return function(*arguments)
