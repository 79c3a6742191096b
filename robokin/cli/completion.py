"""What a shell offers at the Tab key: robots and files, named poses, the words that an option takes.

Nothing here raises: a shell that asks in the middle of a line gets what is known so far.
"""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable

ENDINGS = (".yaml", ".yml")


def robots(incomplete: str) -> list[str]:
    """Names of the library that start so, in any case, and descriptions and folders of the path begun."""
    from robokin.formats.library import library_names

    word = incomplete.casefold()
    return [name for name in library_names() if name.casefold().startswith(word)] + files(incomplete, ENDINGS)


def files(incomplete: str, endings: tuple[str, ...]) -> list[str]:
    """Files with one of some endings, and folders, whose path starts so."""
    from pathlib import Path

    folder, slash, start = incomplete.rpartition("/")
    try:
        entries = sorted(Path(folder + slash or ".").iterdir())
        found = [(entry.name, entry.is_dir()) for entry in entries]
    except OSError:
        return []
    return [
        f"{folder}{slash}{name}{'/' if inside else ''}"
        for name, inside in found
        if name.startswith(start) and (start or not name.startswith("."))
        and (inside or name.casefold().endswith(endings))
    ]  # fmt: skip


def named_poses(incomplete: str) -> list[str]:
    """Named poses of the first robot or tree that the line names."""
    found = _named_first()
    poses: list[str] = [*getattr(found, "poses", ())]
    return [name for name in poses if name.startswith(incomplete)]


def tips(incomplete: str) -> list[str]:
    """The tips of the first tree that the line names."""
    found: list[str] = [*getattr(_named_first(), "tips", ())]
    return [name for name in found if name.startswith(incomplete)]


def tip_targets(incomplete: str) -> list[str]:
    """The same, each with the sign behind which its target stands."""
    return [f"{name}=" for name in tips(incomplete)]


def _named_first() -> object:
    """The first robot or whatever else the line names; None where there is none that can be read."""
    from robokin.errors import RobokinError
    from robokin.formats.library import FOREIGN, library_names, load_any

    library = {name.casefold() for name in library_names()}
    for word in _line():
        if word.casefold() in library or word.casefold().endswith((*ENDINGS, *FOREIGN)):
            with contextlib.suppress(RobokinError, OSError):
                return load_any(word)
            return None
    return None


def _line() -> list[str]:
    """The words of the line that is completed, where the shells' scripts leave it."""
    import shlex  # only a shell that asks pays for it

    line = os.environ.get("COMP_WORDS") or os.environ.get("_TYPER_COMPLETE_ARGS") or ""
    try:
        return shlex.split(line)
    except ValueError:  # a quotation that is still open
        return line.split()


def words(*choices: str) -> Callable[[str], list[str]]:
    """The completion of an option that takes one of some words."""

    def complete(incomplete: str) -> list[str]:
        return [choice for choice in choices if choice.startswith(incomplete.casefold())]

    return complete
