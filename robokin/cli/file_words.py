"""Words of a command line that a shell made of file names, though they look like options.

Students choose the names of what they hand in. Where a shell writes them out for `*.yaml`, a file called
`--against=mine.yaml` stands on the command line as if the teacher had typed that option.
"""

# os.path takes what no file can be called, as a shell hands it over, for a no.
# ruff: noqa: PTH112
from __future__ import annotations

import os
from collections.abc import Sequence

from robokin.errors import InputError, shown
from robokin.grading.answers.submissions import ENDINGS

FLAGS = ("--json", "--follow", "--help", "-h")
"""Options of the command that take no value."""


def files_kept(arguments: Sequence[str], needed: str) -> list[str]:
    """Arguments in which a file that is called like an option is a file: `./` is put before its name.

    A word is a file where one with just that name is here, once for each name, since a shell writes out a name once;
    not where all that is to be marked are folders or stands behind --, for then no shell wrote names out here. Raises
    InputError where it cannot be told: a name that does not end like a description's, or one that is all that says
    what `needed` says.
    """
    given = list(arguments)
    end = given.index("--") if "--" in given else len(given)
    front, rest = given[:end], given[end:]
    called = {word for word in front if word.startswith("-") and len(word) > 1 and _is_here(word)}
    if rest and _is_here("--"):
        raise InputError("found a file called -- here, expected the folder of the files to be marked")
    if not called:
        return given
    marked = [word for word, before in zip(front, ["", *front], strict=False) if not _is_option_or_value(word, before)]
    if not marked or all(os.path.isdir(word) for word in marked):
        return given
    for word in sorted(called):
        if front.count(word) == 1 and not word.lower().endswith(ENDINGS):
            raise InputError(
                f"found '{shown(word)}', an option that is also the name of a file here, expected the folder of the "
                "files to be marked, or -- before the files, or ./ before their names"
            )
        front[front.index(word)] = f"./{word}"
    if not any(word == needed or word.startswith(f"{needed}=") for word in front):
        raise InputError(
            f"found no {needed} but in the name of a file here, expected {needed} ROBOT, the right table, in two words"
        )
    return front + rest


def _is_here(name: str) -> bool:
    try:
        return os.path.lexists(name)
    except ValueError:  # a null character
        return False


def _is_option_or_value(word: str, before: str) -> bool:
    takes = before.startswith("-") and len(before) > 1 and before not in FLAGS
    whole = "=" in before or (len(before) > 2 and not before.startswith("--"))
    return word.startswith("-") or (takes and not whole)
