"""Requests to end the program: Ctrl-C, SIGTERM, SIGHUP. At any moment they end it with 128 + their number.

Most of the time nothing has to be put in order, and the program ends on the spot: an exception might come up inside
another library's import or in a finalizer, where it is lost or becomes a traceback. Only within `in_order` (a file is
half written, a bar is shown, workers run) an exception goes up, so that each `finally` has its turn.
"""

from __future__ import annotations

import os
import signal
import sys

from robokin.cli.statuses import say

TYPE_CHECKING = False
if TYPE_CHECKING:  # this module comes first of all and must be quick
    from types import FrameType
    from typing import Any, NoReturn

NAMES = ("SIGINT", "SIGTERM", "SIGHUP")

UNFINISHED: set[str] = set()
"""Paths of files under a temporary name: they are removed whatever happens."""


class _State:
    depth = 0
    """How many `in_order` there are around what is done now."""
    asked = 0
    """The number of the first signal that asked for the end; 0 for none."""


def heed() -> None:
    """From now on, requests to end are heeded. One that whoever started the program has switched off stays off."""
    for number in _numbers():
        if signal.getsignal(number) in (signal.SIG_DFL, signal.default_int_handler):
            signal.signal(number, _end)
    sys.unraisablehook = _lost


def too_late() -> None:
    """All is done: a request that comes while the interpreter closes down changes nothing."""
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_BLOCK, _numbers())


class in_order:  # noqa: N801 - read as `with in_order():`
    """Here a request to end goes up as KeyboardInterrupt or SystemExit, for there is something to put in order."""

    def __enter__(self) -> None:
        """Begin."""
        _State.depth += 1

    def __exit__(self, *error: object) -> None:
        """End."""
        _State.depth -= 1


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
        _remove(self.path)
        UNFINISHED.discard(self.path)


def leave_if_asked() -> None:
    """End the program if there was a request."""
    if _State.asked:
        _leave()


def _leave() -> NoReturn:
    """End the program now, whatever else is going on; no unfinished file is left."""
    for path in [*UNFINISHED]:
        _remove(path)
    if _State.asked == signal.SIGINT:
        say("interrupted")
    os._exit(128 + _State.asked)


def _remove(path: str) -> None:
    try:
        os.unlink(path)  # noqa: PTH108 - pathlib is not loaded here
    except OSError:
        return


def _numbers() -> list[signal.Signals]:
    """The signals that ask for the end, as far as this system knows them."""
    return [getattr(signal, name) for name in NAMES if hasattr(signal, name)]


def _end(number: int, frame: FrameType | None) -> None:
    again, _State.asked = bool(_State.asked), _State.asked or number
    if again or not _State.depth:
        _leave()
    if number == signal.SIGINT:
        raise KeyboardInterrupt
    raise SystemExit(128 + number)


def _lost(raised: Any) -> None:
    """What was raised where nobody can catch it; if that is our own exception, the request still holds."""
    leave_if_asked()
    sys.__unraisablehook__(raised)
