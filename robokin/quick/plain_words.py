"""Command lines whose words are plain: they are answered here, at once, with the bytes that the parser's way gives.

Whatever is not known for sure, every mistake and every note is left to that way: there None stands for an answer.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from robokin.units import METRES, RADIANS

if TYPE_CHECKING:
    from robokin.formats.plain_robots import PlainRobot

    Find = Callable[[str], PlainRobot | None]

FORMATS = ("table", "json", "jsonl")

OPTIONS: dict[str, dict[str, tuple[str, ...] | None]] = {
    "fk": {"--q": None, "--format": FORMATS, "-f": FORMATS, "--angle": tuple(RADIANS), "--length": tuple(METRES)},
    "list": {"--format": (*FORMATS, "csv"), "-f": (*FORMATS, "csv")},
}
"""Options that take a value, and which of them are taken here; None for any."""

LONGEST = 4096
"""Characters of a word; a longer one is nobody's plain question."""


def answered(words: Sequence[str], find: Find | None = None, form: str | None = None) -> bytes | None:
    """What `robokin WORD…` prints with status 0 and without a note; None where the parser must look.

    `find` looks robots of the library up; `form` is the format in place of json.
    """
    if not words or words[0] not in OPTIONS or any(len(word) > LONGEST for word in words):
        return None
    parted = _parted(words[0], words[1:])
    if parted is None:
        return None
    arguments, given = parted
    kind = given.pop("kind", form or "table")
    if form is not None and kind not in ("json", form):
        return None
    kind = form or kind
    if words[0] == "list":
        from robokin.quick.library_list import listed

        data, sentence = listed(arguments, kind)
        return None if sentence else b"".join(data)
    from robokin.quick.plain_poses import fk_written

    return fk_written(arguments[0], given, kind, find) if len(arguments) == 1 and "--q" in given else None


def _parted(command: str, words: Sequence[str]) -> tuple[list[str], dict[str, str]] | None:
    """The arguments, and the values of the options, that of the format under `kind`."""
    takes, arguments = OPTIONS[command], []
    given: dict[str, str] = {}
    rest = iter(words)
    for word in rest:
        if not word.startswith("-"):
            arguments.append(word)
            continue
        name, equals, value = word.partition("=") if word.startswith("--") else (word, "", "")
        if name == "--json" and not equals:
            name, value = "--format", "json"
        elif name in takes:
            value = value if equals else next(rest, "--")
            allowed = takes[name]
            if value.startswith("--") or (allowed is not None and value not in allowed):
                return None
        else:
            return None
        name = "kind" if name in ("--format", "-f") else name
        if name in given:
            return None
        given[name] = value
    return arguments, given
