"""What a worker of a local cluster does first: Dask calls it by its name."""

from __future__ import annotations

import contextlib
import signal
from typing import Any


def dask_setup(worker: Any) -> None:
    """Leave Ctrl-C, which reaches all processes of a terminal, to the one that started this."""
    with contextlib.suppress(ValueError):  # a worker that is a thread of another process
        signal.signal(signal.SIGINT, signal.SIG_IGN)
