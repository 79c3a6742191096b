"""What stands in for a standard stream that was closed before the program started (`>&-`)."""

from __future__ import annotations

import io
import os
import sys
from typing import Any

from robokin.errors import OutputError
from robokin.files import CLOSED


def complete() -> None:
    """Put something in the place of each closed stream.

    Its descriptor is taken, so that no file that is opened later gets it and with it what a library prints. What is
    written to a closed standard output is an error, as `cat >&-` has it; messages to a closed standard error are lost.
    """
    for number in (0, 1, 2):
        try:
            os.fstat(number)
        except OSError:
            CLOSED.add(number)
            os.open(os.devnull, os.O_RDWR)  # the lowest number that is free, which is this one
    if sys.stdout is None:
        sys.stdout = ClosedOutput()
    if sys.stderr is None:
        sys.stderr = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115, PTH123 - it stays open to the end


class ClosedOutput(io.TextIOBase):
    """A standard output that takes nothing."""

    def write(self, data: Any) -> int:
        """Raise OutputError."""
        raise OutputError("standard output is closed, expected a place that can be written")

    @property
    def buffer(self) -> Any:
        """The stream of bytes below: it takes nothing either."""
        return self
