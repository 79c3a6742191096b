"""Text to model: the reader of descriptions, its expressions, and the library."""

from __future__ import annotations

from pathlib import Path

from robokin.description.library import library_names, load_any
from robokin.description.read import read_file, read_text
from robokin.errors import InputError, shown
from robokin.model import Mechanism, Robot, WheeledBase

__all__ = ["library_names", "load", "load_any", "load_mechanism", "load_wheeled", "read_file", "read_text"]

_KINDS = {Robot: "robot", Mechanism: "mechanism", WheeledBase: "wheeled base"}
"""What a message calls that which a description describes."""


def _kind(entry: Robot | Mechanism | WheeledBase) -> str:
    """`robot`, `mechanism` or `wheeled base`."""
    return _KINDS[type(entry)]


def load(name_or_path: str | Path, **parameters: float | str) -> Robot:
    """The robot with a library name ("puma560") or in a file ("arm.yaml"; a path has a / or an ending).

    `parameters` overrides the description's parameters by numbers or expressions. They are the
    file's own cells and so in the file's units, whatever else is in SI: a parameter has no dimension.
    Raises InputError for an unknown name or a file that cannot be read, DescriptionError with line and
    column for a wrong description.
    """
    loaded = _loaded(name_or_path, parameters)
    if not isinstance(loaded, Robot):
        raise InputError(f"{name_or_path} is a {_kind(loaded)}, expected a robot")
    return loaded


def load_mechanism(name_or_path: str | Path, **parameters: float | str) -> Mechanism:
    """The mechanism with a library name ("four-bar") or in a file, as `load` has it of robots."""
    loaded = _loaded(name_or_path, parameters)
    if not isinstance(loaded, Mechanism):
        raise InputError(f"{name_or_path} is a {_kind(loaded)}, expected a mechanism")
    return loaded


def load_wheeled(name_or_path: str | Path, **parameters: float | str) -> WheeledBase:
    """The wheeled base with a library name ("differential-drive") or in a file, as `load` has it of robots."""
    loaded = _loaded(name_or_path, parameters)
    if not isinstance(loaded, WheeledBase):
        raise InputError(f"{name_or_path} is a {_kind(loaded)}, expected a wheeled base")
    return loaded


def _loaded(name_or_path: str | Path, parameters: dict[str, float | str]) -> Robot | Mechanism | WheeledBase:
    return load_any(name_or_path, {name: _expression(name, value) for name, value in parameters.items()})


def _expression(name: str, value: float | str) -> str:
    """An expression for the value of a parameter."""
    if isinstance(value, str):
        return value
    try:
        return repr(float(value))
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"parameter {name}: found {shown(repr(value))}, expected a number or an expression") from None
