"""What a thread is: a worker has one core of its own, and starts no further workers."""

from __future__ import annotations

import contextlib
import sys
import threading
from collections.abc import Callable, Iterator
from typing import Any


class _Here(threading.local):
    worker = False
    function: Callable[[Any], Any]
    between: threading.Lock
    """Held by a worker process but for the time in which it works at a block: it may be handing back a result."""


here = _Here()
"""The present thread."""


def in_worker() -> bool:
    """Whether this thread, or this whole process, is a worker."""
    process = sys.modules.get("multiprocessing.process")
    return here.worker or (process is not None and bool(process.current_process().daemon))


@contextlib.contextmanager
def as_worker() -> Iterator[None]:
    """Within, this thread is a worker."""
    before, here.worker = here.worker, True
    try:
        yield
    finally:
        here.worker = before
