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
from robokin.unfinished_work import UNFINISHED, in_order, remove

TYPE_CHECKING = False
if TYPE_CHECKING:  # this module comes first of all and must be quick
    from types import FrameType
    from typing import Any, NoReturn

NAMES = ("SIGINT", "SIGTERM", "SIGHUP")


class _State:
    asked = 0
    """The number of the first signal that asked for the end; 0 for none."""


def heed() -> None:
    """From now on, requests to end are heeded. One that whoever started the program has switched off stays off."""
    for number in _numbers():
        if signal.getsignal(number) in (signal.SIG_DFL, signal.default_int_handler):
            signal.signal(number, _end)
    in_order.heeded = True
    sys.unraisablehook = _lost


def too_late() -> None:
    """All is done: a request that comes while the interpreter closes down changes nothing."""
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_BLOCK, _numbers())


def leave_if_asked() -> None:
    """End the program if there was a request."""
    if _State.asked:
        _leave()


def _leave() -> NoReturn:
    """End the program now, whatever else is going on; no unfinished file is left."""
    for path in [*UNFINISHED]:
        remove(path)
    if _State.asked == signal.SIGINT:
        say("interrupted")
    os._exit(128 + _State.asked)


def _numbers() -> list[signal.Signals]:
    """The signals that ask for the end, as far as this system knows them."""
    return [getattr(signal, name) for name in NAMES if hasattr(signal, name)]


def _end(number: int, frame: FrameType | None) -> None:
    again, _State.asked = bool(_State.asked), _State.asked or number
    if again or not in_order.depth:
        _leave()
    if number == signal.SIGINT:
        raise KeyboardInterrupt
    raise SystemExit(128 + number)


def _lost(raised: Any) -> None:
    """What was raised where nobody can catch it; if that is our own exception, the request still holds."""
    leave_if_asked()
    sys.__unraisablehook__(raised)
