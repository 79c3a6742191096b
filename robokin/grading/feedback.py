"""How much a mark tells: right or wrong, which part is wrong, by how much, or the right answer."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

LEVELS = ("verdict", "part", "distance", "answer")
"""From the least told to the most; each tells what those before tell."""

VERDICT, PART, DISTANCE, ANSWER = LEVELS


def tells(level: str, what: str) -> bool:
    """Whether a level tells what belongs to another one."""
    return LEVELS.index(level) >= LEVELS.index(what)


@dataclass(frozen=True)
class Words:
    """A sentence about a mark at each level above the verdict, of which it has none.

    `own` is a sentence about the answer alone, such as that a cell is blank: it is said at each level.
    """

    part: str = ""
    distance: str = ""
    answer: str = ""
    own: str = ""

    def at(self, level: str) -> str:
        """The sentence at a level."""
        said = {PART: self.part, DISTANCE: self.distance, ANSWER: self.answer}.get(level, "")
        return "; ".join(text for text in (said, self.own) if text)

    def mapped(self, change: Callable[[str], str]) -> Words:
        """The sentences, each changed where there is one."""
        part, distance, answer = (change(text) if text else "" for text in (self.part, self.distance, self.answer))
        return Words(part, distance, answer, self.own)


def alike(text: str) -> Words:
    """A sentence that says which part is wrong, and has nothing to add."""
    return Words(text, text, text)


def joined(words: list[Words], separator: str = "; ") -> Words:
    """Several sentences as one."""

    def one(level: str) -> str:
        return separator.join(text for text in (getattr(each, level) for each in words) if text)

    return Words(one(PART), one(DISTANCE), one(ANSWER), one("own"))
