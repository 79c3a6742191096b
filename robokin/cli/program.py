"""The program: its start, its end, and the one place that turns errors into statuses."""

from __future__ import annotations

import os
import sys

from robokin.cli.statuses import DONE, INTERRUPTED, WRONG_INPUT, abandon, say

NEEDED = ("typer", "numpy", "yaml", "rich")
"""What an installation brings; a checkout without it answers plain questions alone: `python -m robokin list`."""


def main() -> None:
    """Run the command line on the process's arguments and exit with its status."""
    try:
        from robokin.cli import interruptions
    except KeyboardInterrupt:
        say("interrupted")
        sys.exit(INTERRUPTED)
    try:
        interruptions.heed()
        from robokin.cli.standard_streams import complete

        complete()
        status = _flush(run(sys.argv[1:]))
        interruptions.too_late()
    except BaseException:
        # Whatever has become of the exception that a request to end raised, the request holds.
        interruptions.leave_if_asked()
        raise
    sys.exit(status)


def run(arguments: list[str]) -> int:
    """Run one command line; its exit status. A sentence on stderr says what was wrong."""
    from robokin.errors import DescriptionError, RobokinError

    try:
        from robokin.quick.plain_words import answered

        data = None if "_ROBOKIN_COMPLETE" in os.environ else answered(arguments)
        if data is None:
            from robokin.cli.app import invoke

            return invoke(arguments)
        from robokin.tables.sink import sink

        with sink(None) as stream:
            stream.write(data)
        return DONE
    except RobokinError as error:
        # All mistakes of a description are said at once, each with its line.
        say(str(error), lines=isinstance(error, DescriptionError))
        return WRONG_INPUT
    except ModuleNotFoundError as error:
        if error.name not in NEEDED:
            raise
        say(f"this needs {error.name}, which is not installed; `pip install .` in the checkout installs all it needs")
        return WRONG_INPUT
    except BrokenPipeError:
        # Whoever reads has what it wants (`| head`): a quiet end, and nothing more to be flushed.
        abandon(sys.stdout)
        return DONE
    except OSError as error:
        place = error.filename or "standard output"
        say(f"{place}: {error.strerror or error}, expected a place that can be read or written")
        abandon(sys.stdout)
        return WRONG_INPUT


def _flush(status: int) -> int:
    """Write out what stdout still holds; the status if that fails."""
    if sys.stdout is None:
        return status
    try:
        sys.stdout.flush()
    except BrokenPipeError:
        abandon(sys.stdout)
    except OSError as error:
        say(f"standard output: {error.strerror}, expected a place that can be written")
        abandon(sys.stdout)
        return status or WRONG_INPUT
    return status
