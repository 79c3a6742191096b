"""The library of robots, mechanisms and wheeled bases: names to files."""

from __future__ import annotations

import contextlib
import os
import re
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from robokin.errors import MAX_SHOWN, InputError, nearest, or_list, shown
from robokin.formats.kept_descriptions import keeps
from robokin.formats.part import Part

if TYPE_CHECKING:
    from robokin.model import Mechanism, Robot, Tree, WheeledBase

KINDS = ("arms", "hands", "mechanisms", "bases")
"""The folders of the library."""

TITLE = re.compile(r"^(?:name|description): *(.*)$", re.MULTILINE)
"""The line of a description that says what it is called."""

SHORTEST = 3
"""Letters of a word that is looked for in titles."""

MOST_TITLED = 12
"""Names that a message lists."""


@cache
def library_folder() -> Path:
    """Where the library is: inside the installed package, or at the top of a checkout."""
    package = Path(__file__).resolve().parent.parent
    installed = package / "robots"
    return installed if installed.is_dir() else package.parent / "robots"


def library_files() -> list[Path]:
    """The files of everything in the library, sorted by name; a name stands once, in the folder of its kind."""
    folders = [library_folder() / kind for kind in KINDS]
    return sorted((path for folder in folders for path in folder.glob("*.yaml")), key=lambda path: path.stem)


def library_names() -> list[str]:
    """The names of everything in the library, sorted."""
    return [path.stem for path in library_files()]


def library_file(name: str) -> Path | None:
    """The file of a name in the library; None if there is none."""
    files = (library_folder() / kind / f"{name}.yaml" for kind in KINDS)
    # os.path.isfile takes what no file can be called (too long, a null character) for a no.
    return next((path for path in files if os.path.isfile(path)), None)  # noqa: PTH113 - it raises for none of them


def is_path(name: str) -> bool:
    """Whether a name means a file: it has a separator or an ending."""
    return "/" in name or os.sep in name or bool(Path(name).suffix)


FOREIGN = (".urdf", ".xacro", ".xml", ".mjcf", ".sdf")
"""Endings of descriptions in other formats than robokin's own."""


def load_any(
    name_or_path: str | Path,
    overrides: Mapping[str, str] | None = None,
    mode: int | None = None,
    part: Part | None = None,
) -> Robot | Mechanism | WheeledBase | Tree:
    """The robot, mechanism, wheeled base or tree with a library name or in a file.

    `overrides` replaces parameters by expressions in the file's units; `mode` is the way in which a mechanism by
    lengths is put together, instead of the file's; `part` says which chain of a tree is meant, and how a file of
    another format is read. A tree with one tip is the robot that leads there. A name may be in any case. Raises
    InputError for an unknown name, with those that are near, and DescriptionError for a wrong description.
    """
    part = part or Part()
    return part.of(described_whole(name_or_path, overrides, mode, part))


def described_whole(
    name_or_path: str | Path, overrides: Mapping[str, str] | None, mode: int | None, part: Part
) -> Robot | Mechanism | WheeledBase | Tree:
    """See `load_any`; all that is described, of a tree with one tip the tree."""
    name = str(name_or_path)
    if isinstance(name_or_path, Path) or is_path(name):
        try:
            if Path(name_or_path).suffix.lower() in FOREIGN:
                from robokin.formats.foreign_files import read_foreign

                return read_foreign(Path(name_or_path), overrides or {}, mode, part)
            from robokin.formats.read import read_file

            return read_file(Path(name_or_path), overrides, mode=mode)
        except InputError as error:
            raise _with_hint(error, Path(name_or_path)) from None
    path = library_file(name.lower())
    if path is None:
        raise unknown_name(name)
    if not overrides and mode is None and not keeps():
        from robokin.formats.kept_robots import kept_robot

        if (kept := kept_robot(library_folder(), path)) is not None:
            return kept
    from robokin.formats.read import read_file  # which takes longer to load than most answers

    return read_file(path, overrides, id=path.stem, mode=mode)


def _with_hint(error: InputError, path: Path) -> InputError:
    """The error for a file that cannot be read, with what may be meant where there is no such file."""
    if os.path.lexists(path) or not path.name:
        return error
    if path.stem.lower() in library_names():
        return InputError(f"{error}; the library's is written without an ending: {path.stem.lower()}")
    with contextlib.suppress(OSError, ValueError):
        close = nearest(path.name, os.listdir(path.parent), 1)  # noqa: PTH208 - only names are wanted
        return InputError(f"{error}; did you mean {shown(str(path.parent / close[0]))}?") if close else error
    return error


def unknown_name(name: str) -> InputError:
    """The error for a name that is not in the library: names that are near, or those with this word in their title."""
    close, titled = nearest(name, library_names()), titled_with(name)
    if titled and not any(_letters(near).startswith(_letters(name)) for near in close):
        close = []  # a maker's name is no slip of another one's arm
    beside = f"{name}.yaml"
    if name and os.path.isfile(beside):  # noqa: PTH113 - no name raises, too long or with a null
        close = [shown(beside), *close]
    said = [f"did you mean {or_list(close)}?"] if close else []
    if titled := [other for other in titled if other not in close]:
        listed = ", ".join(titled[:MOST_TITLED]) + (", …" if len(titled) > MOST_TITLED else "")
        said.append(f"'{shown(name)}' is in the title of {listed}")
    expected = "; ".join(said) or "`robokin list` shows what there is"
    in_folder = f" (a file here? write ./{name})" if name and os.path.isfile(name) else ""  # noqa: PTH113 - as above
    return InputError(f"there is no robot or mechanism named '{shown(name)}' in the library{in_folder}; {expected}")


def _letters(name: str) -> str:
    """A name without what separates its words."""
    return "".join(filter(str.isalnum, name.casefold()))


def titled_with(word: str) -> list[str]:
    """The names of what has a word, or the start of one, in its title, such as those of all arms of a maker."""
    if not SHORTEST <= len(word) <= MAX_SHOWN:
        return []
    start = re.compile(rf"(?<!\w){re.escape(word)}", re.IGNORECASE)
    found = []
    for path in library_folder().rglob("*.yaml"):
        with contextlib.suppress(OSError, UnicodeDecodeError):  # of a file that is spoiled no title is known
            title = TITLE.search(path.read_text(encoding="utf-8"))
            if title and start.search(title[1]):
                found.append(path.stem)
    return sorted(found)
