"""What users type: the description that a command works on, and values."""

from __future__ import annotations

from robokin.cli.statuses import say
from robokin.errors import InputError, shown
from robokin.formats.library import load_any
from robokin.formats.part import Part
from robokin.formats.vector_expressions import parse_configuration as parse_configuration
from robokin.formats.vector_expressions import parse_numbers as parse_numbers
from robokin.formats.vector_expressions import split_vector as split_vector
from robokin.model import Mechanism, Robot, Tree, WheeledBase
from robokin.model.joint_units import in_units as in_units
from robokin.model.joint_units import joint_factors as joint_factors


def load_entry(
    name: str, overrides: dict[str, str], mode: int | None = None, part: Part | None = None
) -> Robot | Mechanism | WheeledBase:
    """What a command works on, of a tree one chain; what looks like a slip in it is noted on stderr, in one line.

    Raises InputError, also for a tree of which no chain is named.
    """
    loaded = load_noted(name, overrides, mode, part)
    if isinstance(loaded, Tree):
        if len(loaded.tips) == 1:
            return loaded.robot()
        raise InputError(f"{name} has {len(loaded.tips)} tips, expected --tip with one of {loaded.listed_tips()}")
    return loaded


def load_robot(name: str, overrides: dict[str, str], part: Part | None = None) -> Robot:
    """The robot that a command works on. Raises InputError, also for a mechanism or a wheeled base."""
    robot = expect_jointed(name, load_entry(name, overrides, None, part))
    assert isinstance(robot, Robot)
    return robot


def load_jointed(name: str, overrides: dict[str, str], part: Part | None = None) -> Robot | Tree:
    """The robot that a command works on, or the tree of which no chain is named. Raises InputError."""
    return expect_jointed(name, load_noted(name, overrides, None, part))


def load_tree_of(name: str, overrides: dict[str, str], part: Part) -> Tree:
    """The tree that a command works on, a robot as one of a single branch. Raises InputError."""
    from robokin.formats.part import tree_of
    from robokin.model import Robot

    found = expect_jointed(name, load_noted(name, overrides, None, part))
    return tree_of(found) if isinstance(found, Robot) else found


def load_noted(
    name: str, overrides: dict[str, str], mode: int | None, part: Part | None
) -> Robot | Mechanism | WheeledBase | Tree:
    """What a command works on, a tree too; what looks like a slip in it is noted on stderr. Raises InputError."""
    loaded = load_any(name, overrides, mode, part)
    if loaded.notes:
        more = len(loaded.notes) - 1
        say(str(loaded.notes[0]) + (f"; {more} more: robokin validate {name}" if more else ""))
    return loaded


def expect_jointed(name: str, loaded: Robot | Mechanism | WheeledBase | Tree) -> Robot | Tree:
    """What was loaded by a name, if it is a robot or a tree. Raises InputError."""
    if isinstance(loaded, WheeledBase):
        raise InputError(f"{name} is a wheeled base, expected a robot")
    if isinstance(loaded, Mechanism):
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
