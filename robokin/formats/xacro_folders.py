"""Which files a xacro file may include: those below its own folder and below the packages that it names."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

from robokin.errors import InputError, shown
from robokin.files import open_path, read_up_to

LEVELS = 6
"""Folders above the file in which packages are sought."""

ENDINGS = (".xacro", ".urdf", ".xml", ".gazebo")
"""What an included file's name ends with."""

TABLES = (".yaml", ".yml")
"""What the name of a file with tables ends with."""

MOST_TABLE_BYTES = 1 << 20
"""Bytes of a file with tables."""

MOST_BYTES = 1 << 24
"""Bytes of all files together."""


class XacroFolders:
    """The folders of one reading. Raises InputError for what may not be read or is not there."""

    def __init__(self, main: Path, packages: Mapping[str, str]) -> None:
        self.home = main.resolve().parent
        self.packages = {name: Path(place).resolve() for name, place in packages.items()}
        self.left = MOST_BYTES
        for name, place in self.packages.items():
            if not place.is_dir():
                raise InputError(f"found no folder {shown(str(place))}, expected that of the package '{shown(name)}'")

    def package(self, name: str) -> Path:
        """The folder of a package: a named one, else one above the file or beside one above it."""
        if name not in self.packages:
            found = next(filter(None, (_package_in(folder, name) for folder in self._above())), None)
            if found is None or not re.fullmatch(r"[\w.-]+", name) or name in (".", ".."):
                raise InputError(
                    f"found no package '{shown(name)}' in the folders above the file, expected one, or "
                    f"--package {shown(name)}=FOLDER"
                )
            self.packages[name] = found.resolve()
        return self.packages[name]

    def _above(self) -> list[Path]:
        return [self.home, *self.home.parents][: LEVELS + 1]

    def included(self, name: str, folder: Path, endings: tuple[str, ...] = ENDINGS) -> Path:
        """The file that a name means in a folder, its links followed."""
        try:
            path = (folder / name).resolve()
            allowed = [self.home, *self.packages.values()]
            inside = any(path.is_relative_to(place) for place in allowed)
            there = inside and path.is_file()
        except (OSError, ValueError, RuntimeError):
            inside = there = False
        if not inside:
            raise InputError(
                f"found '{shown(name)}' outside the file's own folder and its packages, expected a file within them, "
                "or its folder by --package NAME=FOLDER"
            )
        if not there or path.suffix not in endings:
            raise InputError(f"found no file '{shown(name)}', expected one that ends in {', '.join(endings)}")
        return path

    def read(self, path: Path, expected: str = "a xacro file", most: int = MOST_BYTES) -> bytes:
        """The bytes of a file, so many at most."""
        with open_path(str(path), expected) as stream:
            data = read_up_to(stream, str(path), min(self.left, most), expected)
        if len(data) > most:
            raise InputError(f"found a file over {most >> 20} MiB, expected {expected} of a robot")
        self.left -= len(data)
        if self.left < 0:
            raise InputError(f"found files over {MOST_BYTES >> 20} MiB, expected the descriptions of a robot")
        return data


def _package_in(folder: Path, name: str) -> Path | None:
    """A folder, or one in it, if it is the package of a name."""
    if folder == folder.parent:
        return None
    if folder.name == name or _name_in(folder / "package.xml") == name:
        return folder
    return folder / name if (folder / name).is_dir() else None


def _name_in(manifest: Path) -> str:
    """The name of a package by its package.xml, "" where there is none."""
    try:
        if not manifest.is_file():
            return ""
        with manifest.open("rb") as stream:
            found = re.search(rb"<name>\s*([\w.-]+)\s*</name>", stream.read(1 << 16))
    except OSError:
        return ""
    return found[1].decode("ascii", "replace") if found else ""
