"""A new folder of files that is whole or absent."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterable
from pathlib import Path

from robokin.errors import InputError, OutputError, shown
from robokin.tables.sink import Writing
from robokin.unfinished_work import in_order


def expect_new_folder(output: str, option: str) -> Path:
    """The path of a folder that is to be made. Raises InputError where there is anything."""
    if Writing.refused:
        raise InputError(f"{option} {output}: expected no folder to write, answers are documents on standard output")
    path, there = Path(output), True
    try:
        path = path.absolute()
    except OSError as error:  # the folder that the command is in is gone
        raise OutputError(f"{option} {shown(output)}: {error.strerror}") from None
    try:
        path.lstat()
    except FileNotFoundError:
        there = False
    except (OSError, ValueError) as error:
        raise OutputError(f"{option} {shown(output)}: {getattr(error, 'strerror', None) or error}") from None
    if there or not path.name or not output:
        raise InputError(f"{option}: {shown(output) or 'nothing'} is there already, expected the name of a new folder")
    return path


def expect_new_file(output: str, ending: str, option: str) -> None:
    """Raise InputError for the name of a file that is there, or that ends otherwise."""
    if not output.lower().endswith(ending):
        raise InputError(f"{option}: found '{shown(output)}', expected a name that ends with {ending}")
    if os.path.lexists(output):
        raise InputError(f"{option}: {shown(output)} is there already, expected the name of a new file")


def write_folder(path: Path, files: Iterable[tuple[str, bytes]], option: str) -> int:
    """Write files, by their paths below the folder with / between the parts; how many. Raises OutputError.

    They stand in a folder beside it until all are there, which then takes the name; on any error nothing is left.
    """
    count = 0
    temporary = path.with_name(f".{path.name[:40]}.{os.urandom(4).hex()}.part")
    with in_order():
        try:
            temporary.mkdir(parents=True)
            made: set[Path] = {temporary}
            for name, data in files:
                place = temporary.joinpath(*name.split("/"))
                if place.parent not in made:
                    place.parent.mkdir(parents=True, exist_ok=True)
                    made.add(place.parent)
                place.write_bytes(data)
                count += 1
            if os.path.lexists(path):  # made meanwhile, by somebody else
                raise OutputError(f"{option} {path}: is there already, nothing was written")
            temporary.rename(path)
        except OSError as error:
            raise OutputError(f"{option} {path}: {error.strerror or error}, nothing was written") from None
        finally:
            shutil.rmtree(temporary, ignore_errors=True)
    return count
