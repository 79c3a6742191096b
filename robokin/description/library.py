"""The library of robots, mechanisms and wheeled bases: names to files."""

from __future__ import annotations

import os
from collections.abc import Mapping
from functools import cache
from pathlib import Path

from robokin.description.read import read_file
from robokin.errors import InputError, nearest, or_list, shown
from robokin.model import Mechanism, Robot, WheeledBase


@cache
def library_folder() -> Path:
    """Where the library is: inside the installed package, or at the top of a checkout."""
    package = Path(__file__).resolve().parent.parent
    installed = package / "robots"
    return installed if installed.is_dir() else package.parent / "robots"


def library_names() -> list[str]:
    """The names of everything in the library, sorted."""
    return sorted(path.stem for path in library_folder().glob("*.yaml"))


def is_path(name: str) -> bool:
    """Whether a name means a file: it has a separator or an ending."""
    return "/" in name or os.sep in name or bool(Path(name).suffix)


def load_any(
    name_or_path: str | Path, overrides: Mapping[str, str] | None = None, mode: int | None = None
) -> Robot | Mechanism | WheeledBase:
    """The robot, mechanism or wheeled base with a library name or in a file.

    `overrides` replaces parameters by expressions in the file's units; `mode` is the way in which a mechanism by
    lengths is put together, instead of the file's. Raises InputError for an unknown name, with the nearest ones, and
    DescriptionError for a wrong description.
    """
    name = str(name_or_path)
    if isinstance(name_or_path, Path) or is_path(name):
        return read_file(Path(name_or_path), overrides, mode=mode)
    path = library_folder() / f"{name}.yaml"
    # os.path.isfile takes what no file can be called (too long, a null character) for a no.
    if not name or not os.path.isfile(path):  # noqa: PTH113 - it raises for none of them
        raise unknown_name(name)
    return read_file(path, overrides, id=name, mode=mode)


def unknown_name(name: str) -> InputError:
    """The error for a name that is not in the library."""
    close = nearest(name, library_names())
    expected = f"did you mean {or_list(close)}?" if close else "`robokin list` shows what there is"
    in_folder = f" (a file here? write ./{name})" if name and os.path.isfile(name) else ""  # noqa: PTH113 - as above
    return InputError(f"there is no robot or mechanism named '{shown(name)}' in the library{in_folder}; {expected}")
