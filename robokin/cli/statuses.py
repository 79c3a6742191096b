"""How a command line ends, and the one way to say a sentence on stderr."""

from __future__ import annotations

import sys

DONE, WRONG_INPUT, NO, INTERRUPTED = 0, 2, 3, 130
"""Exit statuses. 1 is left to a crash, so that no script can mistake a crash for a no."""


def say(sentence: str, lines: bool = False) -> None:
    """A note or an error, on stderr, in which nothing steers the terminal: one line, unless `lines` may be several."""
    import contextlib

    from robokin.errors import visible

    if sys.stderr is not None:  # it is None where a program of its own has none
        with contextlib.suppress(OSError, ValueError):
            print(f"robokin: {visible(sentence, lines)}", file=sys.stderr, flush=True)


def abandon(stream: object) -> None:
    """Point a broken stream at nothing, so that the interpreter's own flush at exit is silent."""
    import contextlib
    import os

    if stream is None:
        return
    with contextlib.suppress(OSError, ValueError):  # a stream of a program of its own has no number
        number = stream.fileno()  # type: ignore[attr-defined]
        devnull = os.open(os.devnull, os.O_WRONLY)
        os.dup2(devnull, number)
        os.close(devnull)
