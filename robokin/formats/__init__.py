"""Text to model: the reader of descriptions, its expressions, and the library."""

from __future__ import annotations

from os import PathLike, fsdecode
from pathlib import Path
from typing import TYPE_CHECKING

from robokin.errors import InputError, InputTypeError, shown
from robokin.expected import described, expect_flag
from robokin.formats.library import library_names, load_any

if TYPE_CHECKING:
    from robokin.formats.part import Part
    from robokin.formats.read import read_file as read_file
    from robokin.formats.read import read_text as read_text
    from robokin.model import Mechanism, Robot, Tree, WheeledBase

__all__ = [
    "library_names", "load", "load_any", "load_mechanism", "load_tree", "load_wheeled", "read_file", "read_text",
]  # fmt: skip

_KINDS = {"Robot": "robot", "Mechanism": "mechanism", "WheeledBase": "wheeled base", "Tree": "tree of links"}
"""What a message calls that which a description describes."""


def _kind(entry: Robot | Mechanism | WheeledBase | Tree) -> str:
    """`robot`, `mechanism`, `wheeled base` or `tree of links`."""
    return _KINDS[type(entry).__name__]


def __getattr__(name: str) -> object:
    """Import the reader on first use: who lists the library needs none."""
    if name not in ("read_file", "read_text"):
        raise AttributeError(f"module 'robokin.formats' has no attribute {name!r}")
    from robokin.formats import read

    return getattr(read, name)


def load(
    name_or_path: str | Path,
    *,
    tip: str | None = None,
    root: str | None = None,
    exact: bool = False,
    **parameters: float | str,
) -> Robot:
    """The robot with a library name ("puma560") or in a file ("arm.yaml", "arm.urdf"; a path has a / or an ending).

    `tip` and `root` name the links between which the chain of a tree is, by default its only tip and its root. `exact`
    takes angles of a URDF, MJCF or SDF file as they are written, right angles cut in print too. `parameters` overrides
    the description's parameters by numbers or expressions. They are the
    file's own cells and so in the file's units, whatever else is in SI: a parameter has no dimension.
    Raises InputError for an unknown name, a file that cannot be read and for a tree with several tips where none is
    named, DescriptionError with line and column for a wrong description.
    """
    from robokin.formats.part import Part
    from robokin.model import Robot, Tree

    for argument, name in (("tip", tip), ("root", root)):
        if not isinstance(name, str | None):
            raise InputTypeError(f"{argument}: found {described(name)}, expected the name of a tip or a link")
    loaded = _loaded(name_or_path, parameters, Part(tip, root, expect_flag(exact, "exact")))
    if isinstance(loaded, Tree):
        return loaded.robot()
    if not isinstance(loaded, Robot):
        raise InputError(f"{name_or_path} is a {_kind(loaded)}, expected a robot")
    return loaded


def load_tree(name_or_path: str | Path, *, exact: bool = False, **parameters: float | str) -> Tree:
    """The tree of links with a library name or in a file, as `load` has it of robots; a robot is a tree of one branch.

    Raises InputError for an unknown name and for a file that cannot be read or is of something else, DescriptionError
    with line and column for a wrong description.
    """
    from robokin.formats.part import Part
    from robokin.model import Tree

    loaded = _loaded(name_or_path, parameters, Part(exact=expect_flag(exact, "exact"), whole=True))
    if not isinstance(loaded, Tree):
        raise InputError(f"{name_or_path} is a {_kind(loaded)}, expected a tree or a robot")
    return loaded


def load_mechanism(name_or_path: str | Path, **parameters: float | str) -> Mechanism:
    """The mechanism with a library name ("four-bar") or in a file, as `load` has it of robots.

    Raises InputError for an unknown name and for a file that cannot be read or is of something else, DescriptionError
    with line and column for a wrong description.
    """
    from robokin.model import Mechanism

    loaded = _loaded(name_or_path, parameters)
    if not isinstance(loaded, Mechanism):
        raise InputError(f"{name_or_path} is a {_kind(loaded)}, expected a mechanism")
    return loaded


def load_wheeled(name_or_path: str | Path, **parameters: float | str) -> WheeledBase:
    """The wheeled base with a library name ("differential-drive") or in a file, as `load` has it of robots.

    Raises InputError for an unknown name and for a file that cannot be read or is of something else, DescriptionError
    with line and column for a wrong description.
    """
    from robokin.model import WheeledBase

    loaded = _loaded(name_or_path, parameters)
    if not isinstance(loaded, WheeledBase):
        raise InputError(f"{name_or_path} is a {_kind(loaded)}, expected a wheeled base")
    return loaded


def _loaded(
    name_or_path: str | Path, parameters: dict[str, float | str], part: Part | None = None
) -> Robot | Mechanism | WheeledBase | Tree:
    if not isinstance(name_or_path, str | Path):
        if not isinstance(name_or_path, PathLike):
            found = described(name_or_path)
            raise InputTypeError(f"name_or_path: found {found}, expected a name of the library or a file's path")
        name_or_path = Path(fsdecode(name_or_path))
    overrides = {name: _expression(name, value) for name, value in parameters.items()}
    return load_any(name_or_path, overrides, part=part)


def _expression(name: str, value: float | str) -> str:
    """An expression for the value of a parameter."""
    if isinstance(value, str):
        return value
    try:
        if not isinstance(value, bool):
            return repr(float(value))
        raise TypeError
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"parameter {name}: found {shown(repr(value))}, expected a number or an expression") from None
