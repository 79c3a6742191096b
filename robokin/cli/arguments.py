"""What users type: the description that a command works on, and values."""

from __future__ import annotations

from robokin.cli.statuses import say
from robokin.errors import InputError, shown
from robokin.formats.library import load_any
from robokin.formats.vector_expressions import parse_configuration as parse_configuration
from robokin.formats.vector_expressions import parse_numbers as parse_numbers
from robokin.formats.vector_expressions import split_vector as split_vector
from robokin.model import Mechanism, Robot, WheeledBase
from robokin.model.joint_units import in_units as in_units
from robokin.model.joint_units import joint_factors as joint_factors


def load_entry(name: str, overrides: dict[str, str], mode: int | None = None) -> Robot | Mechanism | WheeledBase:
    """What a command works on; what looks like a slip in it is noted on stderr, in one line. Raises InputError."""
    loaded = load_any(name, overrides, mode)
    if loaded.notes:
        more = len(loaded.notes) - 1
        say(str(loaded.notes[0]) + (f"; {more} more: robokin validate {name}" if more else ""))
    return loaded


def load_robot(name: str, overrides: dict[str, str]) -> Robot:
    """The robot that a command works on. Raises InputError, also for a mechanism or a wheeled base."""
    loaded = load_entry(name, overrides)
    if isinstance(loaded, WheeledBase):
        raise InputError(f"{name} is a wheeled base, expected a robot")
    if not isinstance(loaded, Robot):
        raise InputError(f"{name} is a mechanism (links and joints that may form loops), expected a robot")
    return loaded


def way_of(text: str | None) -> int | None:
    """The number of --mode: which way to put a mechanism together. Raises InputError."""
    if text is None:
        return None
    digits = text.strip()
    if not (digits.isascii() and digits.isdecimal() and len(digits) < 10) or not int(digits):
        raise InputError(f"--mode: found '{shown(text)}', expected a whole number from 1")
    return int(digits)
