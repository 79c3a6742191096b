"""Work that has to be put in order before the program ends: a file half written, a bar shown, workers that run.

Whoever heeds a request to end (Ctrl-C, SIGTERM) looks at `in_order.depth`: within it an exception goes up, so that each
`finally` has its turn; outside of it the program may end on the spot, without the files of `UNFINISHED`.
"""

from __future__ import annotations

import os

UNFINISHED: set[str] = set()
"""Paths of files under a temporary name: they are removed whatever happens."""


class in_order:  # noqa: N801 - read as `with in_order():`
    """Here a request to end goes up as KeyboardInterrupt or SystemExit, for there is something to put in order."""

    depth = 0
    """How many of these there are around what is done now."""

    heeded = False
    """Whether this process is a program that heeds requests to end."""

    def __enter__(self) -> None:
        """Begin."""
        in_order.depth += 1

    def __exit__(self, *error: object) -> None:
        """End."""
        in_order.depth -= 1


class unfinished(in_order):  # noqa: N801 - as above
    """A file that must not stay under this name after the end."""

    def __init__(self, path: str) -> None:
        self.path = path

    def __enter__(self) -> None:
        """From here on the file may be there."""
        UNFINISHED.add(self.path)
        super().__enter__()

    def __exit__(self, *error: object) -> None:
        """Remove it, if it is still there."""
        super().__exit__(*error)
        remove(self.path)
        UNFINISHED.discard(self.path)


def remove(path: str) -> None:
    """Remove a file, if it is there."""
    try:
        os.unlink(path)  # noqa: PTH108 - pathlib is not loaded here
    except OSError:
        return
