"""`--cores`: how many work at long files."""

from __future__ import annotations

import contextlib
import os
import stat
from typing import Annotated

from robokin.cli.options import option
from robokin.errors import InputError, shown

CoresOption = Annotated[str | None, option("--cores", "N", "Cores to work on; the answer is the same.")]

SOME, MANY = 1 << 19, 1 << 22
"""Bytes of a file from which on several cores work at it, where a row takes long (`ik`) and where it does not (`fk`).

To start workers takes as long as to answer some 2,000 rows of the one and 25,000 of the other.
"""


def whole_cores(text: str | None) -> int | None:
    """The number of --cores; None for all. Raises InputError."""
    from robokin.jobs.ordered_map import MOST_CORES

    if text is None:
        return None
    digits = text.strip().replace("_", "")
    if not (digits.isascii() and digits.isdecimal() and len(digits) < 25) or not 1 <= int(digits) <= MOST_CORES:
        raise InputError(f"--cores: found '{shown(text)}', expected a whole number from 1 to {MOST_CORES}")
    return int(digits)


def cores_worth(cores: int | None, source: str | None, least: int) -> int | None:
    """The cores that a batch is worth: all that may be used for a file of `least` bytes, and one for less.

    One for a pipe as well: whoever writes a row and waits for its answer gets it before the next one is read.
    """
    with contextlib.suppress(OSError, ValueError):
        found = os.stat(0 if source == "-" else source or "")  # noqa: PTH116 - standard input has no path
        if stat.S_ISREG(found.st_mode) and found.st_size >= least:
            return cores
    return 1
