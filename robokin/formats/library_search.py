"""Searching the library by words."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

from robokin.errors import nearest, or_list, shown
from robokin.formats.library_index import Entry

SHORT = 3
"""Letters of a word that in a sentence must stand alone: every other source has a URDF, and few a UR."""

STARTS = re.compile(r"[^\W\d_]+\d*|\d+")
"""Where what is looked for may start: at words, and at the number in a name such as puma560."""

APART = re.compile(r"[\W_]+")


def found(entries: Iterable[Entry], words: Sequence[str]) -> list[Entry]:
    """The entries that have all of the words."""
    wanted = [_squeezed(word) for word in words if _squeezed(word)]
    if not wanted:
        return [] if words else [*entries]
    return [entry for entry in entries if all(_has(entry, word) for word in wanted)]


def nothing_found(entries: Sequence[Entry], words: Sequence[str]) -> str:
    """What to say when no entry has all of the words."""
    unknown = [word for word in words if not found(entries, [word])]
    if not unknown:
        listed = or_list(f"'{shown(word)}'" for word in words).replace(" or ", " and ")
        return f"nothing in the library has {listed} together, expected fewer words"
    known = {part for entry in entries for text in (entry.id, entry.name, entry.words) for part in _parts(text)}
    close = nearest(_plain(unknown[0]), [*sorted(known), *(entry.id for entry in entries)])
    hint = f"did you mean {or_list(repr(word) for word in close)}?" if close else "`robokin list` shows all"
    return f"nothing in the library has the word '{shown(unknown[0])}'; {hint}"


def _has(entry: Entry, word: str) -> bool:
    named = _plain(f"{entry.id} {entry.name} {entry.kind} {entry.words} {entry.joints}")
    if any(start.startswith(word) for start in _starts(named)):
        return True
    told = _plain(f"{entry.description} {entry.source}")
    if len(word) <= SHORT:
        return word in APART.split(told)
    return any(start.startswith(word) for start in _starts(told))


def _starts(text: str) -> list[str]:
    """The text from each of its words on, without what stands between words: `puma560` starts `PUMA 560` too."""
    pieces = [text[match.start() :] for match in STARTS.finditer(text)]
    return [_squeezed(piece[:80]) for piece in pieces]


def _parts(text: str) -> list[str]:
    return [part for part in APART.split(_plain(text)) if len(part) > 1]


def _squeezed(text: str) -> str:
    return APART.sub("", _plain(text))


def _plain(text: str) -> str:
    """The text without accents and capitals, so that `staubli` finds Stäubli."""
    from unicodedata import combining, normalize

    return "".join(letter for letter in normalize("NFKD", text.casefold()) if not combining(letter))
