"""Files that students handed in: which there are, what they are called, and what stands in them, safely.

Whoever hands in a file chooses its name and what kind of file it is. A symbolic link could point to another student's
answer or to the key, a pipe keeps whoever reads it waiting, a device never ends: only plain files are read, up to the
size of a description, and links only where the teacher asks for it.
"""

# os.path takes what no file can be called, as a shell hands it over, for a no; it joins and shortens names as they are
# written, without asking the disk where a link leads.
# ruff: noqa: PTH100, PTH114, PTH116, PTH118, PTH119, PTH120
from __future__ import annotations

import os
import stat
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import IO

from robokin.errors import InputError, or_list, shown
from robokin.formats.library import is_path, load_any
from robokin.formats.read import MAX_BYTES, read_bytes
from robokin.model import Mechanism, Robot, Tree, WheeledBase

ENDINGS = (".yaml", ".yml")
"""Names of descriptions in a folder; others there are no answers."""

OPEN_PLACES = ("/dev/fd/", "/dev/stdin")
"""What a shell hands a program to read from, as in `<(command)`: no student can put anything there."""

DEPTH = 16
"""Folders inside each other in which answers are looked for."""


@dataclass(frozen=True)
class Submission:
    """A file that was handed in: what it is called, and where it is.

    id: the name that its mark has. path: None for a name of the library.
    """

    id: str
    place: str
    path: str | None
    follow: bool = False

    def read(self) -> Robot | Mechanism | WheeledBase:
        """What it describes. Raises InputError."""
        if self.path is None:
            described = load_any(self.place)
        else:
            with open_plain_file(self.path, self.follow) as stream:
                described = read_bytes(stream.read(MAX_BYTES + 1), self.path)
        return described.robot() if isinstance(described, Tree) else described


def submissions(places: Sequence[str], follow: bool) -> list[Submission]:
    """The files that some arguments name: files, folders with all descriptions in them, names of the library.

    A file of a folder is called by its path in it. Others are called by their names; where they are in several
    folders, by their paths below what these have in common. So no file changes what another one is called. Raises
    InputError for nothing but a folder without descriptions.
    """
    found: list[Submission] = []
    single: dict[int, str] = {}  # the place of each in `found`, and its path
    for place in places:
        if is_answer_folder(place, follow):
            inside = list(files_inside(place, follow))
            start = os.path.normpath(place) if len(places) > 1 else ""
            found += [Submission(os.path.join(start, name), name, os.path.join(place, name), follow) for name in inside]
            if not inside:  # one who handed in nothing has a mark beside the others'
                found.append(Submission(start or place, place, place, follow))
        elif is_path(place) or os.path.lexists(place):
            single[len(found)] = place
            found.append(Submission("", place, place, follow))
        else:
            found.append(Submission(place, place, None, follow))
    if len(places) == 1 and found[0].path == places[0] and is_answer_folder(places[0], follow):
        expected = f"expected descriptions, files that end with {or_list(ENDINGS)}"
        raise InputError(f"{shown(places[0], MOST_SHOWN)}: found none in the folder, {expected}")
    for i, name in zip(single, _names([*single.values()]), strict=True):
        found[i] = replace(found[i], id=name)
    return found


def is_answer_folder(place: str, follow: bool) -> bool:
    """Whether an argument is a folder; a link to one only where links are followed."""
    try:
        return stat.S_ISDIR((os.stat if follow else os.lstat)(place).st_mode)
    except (OSError, ValueError):
        return False


def _names(paths: list[str]) -> list[str]:
    """What files are called: their names, or their paths below the folder that all are in."""
    folders = {os.path.dirname(path) for path in paths}
    if len(folders) <= 1:
        return [os.path.basename(path) or path for path in paths]
    try:
        common = os.path.commonpath([os.path.abspath(folder) for folder in folders])
        return [os.path.relpath(os.path.abspath(path), common) for path in paths]
    except ValueError:  # on different drives, or with a null character
        return list(paths)


def files_inside(folder: str, follow: bool, endings: tuple[str, ...] = ENDINGS) -> Iterator[str]:
    """The paths in a folder of all that is called like a description, sorted; hidden files and folders are left out.

    endings: of other files, in small letters.
    """
    seen: set[tuple[int, int]] = set()
    for place, folders, files in os.walk(folder, followlinks=follow):
        here = os.stat(place)
        if follow and (here.st_dev, here.st_ino) in seen:  # a link leads back
            folders.clear()
            continue
        seen.add((here.st_dev, here.st_ino))
        below = os.path.relpath(place, folder)
        deep = 0 if below == os.curdir else below.count(os.sep) + 1
        # A folder that is called like a description is no description, and is marked as that.
        called = [name for name in folders if name.lower().endswith(endings)]
        folders[:] = sorted(
            name for name in folders if not name.startswith(".") and name not in called and deep < DEPTH
        )
        for name in sorted([*files, *called]):
            if name.lower().endswith(endings) and not name.startswith("."):
                yield os.path.normpath(os.path.join(below, name))


def open_plain_file(path: str, follow: bool) -> IO[bytes]:
    """A plain file, opened to be read. Raises InputError for anything else: a link, a pipe, a device, a folder.

    Nothing that is handed in can keep it waiting: a pipe is opened without waiting for its other end, and not read.
    """
    given = path.startswith(OPEN_PLACES)
    flags = os.O_RDONLY | getattr(os, "O_CLOEXEC", 0) | getattr(os, "O_BINARY", 0)
    if not given:
        flags |= (
            getattr(os, "O_NONBLOCK", 0) | (0 if follow else getattr(os, "O_NOFOLLOW", 0)) | getattr(os, "O_NOCTTY", 0)
        )
    place = shown(path, MOST_SHOWN)
    try:
        # Before it is opened for its own sentence, and for systems that cannot refuse a link as they open it (Windows).
        link = not follow and not given and os.path.islink(path)
        number = -1 if link else os.open(path, flags)
    except OSError as error:
        raise InputError(f"{place}: cannot be read ({error.strerror}), expected a plain file") from None
    except ValueError:  # a null character
        raise InputError(f"{place}: is no path, expected that of a plain file") from None
    if link:
        raise InputError(f"{place}: found a symbolic link, expected a plain file; --follow reads what it points to")
    mode = os.fstat(number).st_mode
    if not (stat.S_ISREG(mode) or given):
        os.close(number)
        raise InputError(f"{place}: found {_kind(mode)}, expected a plain file")
    return os.fdopen(number, "rb")


MOST_SHOWN = 200
"""Characters of a path that a message repeats."""


def _kind(mode: int) -> str:
    kinds = (
        (stat.S_ISDIR, "a folder"), (stat.S_ISFIFO, "a pipe"), (stat.S_ISSOCK, "a socket"),
        (stat.S_ISCHR, "a device"), (stat.S_ISBLK, "a device"),
    )  # fmt: skip
    return next((name for test, name in kinds if test(mode)), "something else")
