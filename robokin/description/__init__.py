"""Text to model: the reader of descriptions, its expressions, and the library."""

from __future__ import annotations

from pathlib import Path

from robokin.description.library import library_names, load_any
from robokin.description.read import read_file, read_text
from robokin.errors import InputError, shown
from robokin.model import Robot

__all__ = ["library_names", "load", "load_any", "read_file", "read_text"]


def load(name_or_path: str | Path, **parameters: float | str) -> Robot:
    """The robot with a library name ("puma560") or in a file ("arm.yaml"; a path has a / or an ending).

    `parameters` overrides the description's parameters by numbers or expressions. They are the
    file's own cells and so in the file's units, whatever else is in SI: a parameter has no dimension.
    Raises InputError for an unknown name or a file that cannot be read, DescriptionError with line and
    column for a wrong description.
    """
    loaded = load_any(name_or_path, {name: _expression(name, value) for name, value in parameters.items()})
    if not isinstance(loaded, Robot):
        raise InputError(f"{name_or_path} is a mechanism, expected a robot")
    return loaded


def _expression(name: str, value: float | str) -> str:
    """An expression for the value of a parameter."""
    if isinstance(value, str):
        return value
    try:
        return repr(float(value))
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"parameter {name}: found {shown(repr(value))}, expected a number or an expression") from None
