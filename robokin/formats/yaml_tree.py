"""What a description's text is read into: nodes that know their line and column.

YAML's own guesses are not to be trusted with tables of numbers: in YAML 1.1 `1e-3` is a string, `012`
is ten, `1:30` is ninety, `no` is false. So every scalar stays text here; whoever knows what is expected at a place
reads it.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from robokin.errors import DescriptionError, shown
from robokin.formats.faults import ConsequenceError

CHARACTERS = 16
"""So many characters of a value count like one more value: an alias repeats the cost of reading it."""

WHOLE_LINE = 1 << 20
"""The width of what goes on to the end of its line, and beyond."""


@dataclass(frozen=True, slots=True)
class FilePlace:
    """A place in a file; line and column count from 1, `width` is how many characters are meant.

    `said`: what is wrong here has been said, and what else is found wrong is a consequence of it.
    """

    file: str
    line: int
    column: int
    width: int = 1
    said: bool = False

    def error(self, message: str) -> DescriptionError:
        """A DescriptionError at this place; what a message repeats of the file steers no terminal."""
        message = message if message.isprintable() else shown(message, len(message))
        kind = ConsequenceError if self.said else DescriptionError
        return kind(message, self.file, self.line, self.column, self.width)

    def silent(self) -> FilePlace:
        """The same place, where what is wrong has been said."""
        return replace(self, said=True)


@dataclass(slots=True)
class Scalar:
    """A scalar as it is written; `quoted` tells "1" from 1."""

    text: str
    mark: FilePlace
    quoted: bool = False
    size: int = 1

    @property
    def empty(self) -> bool:
        """Nothing, or one of YAML's ways to write nothing."""
        return not self.quoted and self.text in ("", "~", "null")


@dataclass(slots=True)
class Sequence:
    """A list of nodes."""

    items: list[Node]
    mark: FilePlace
    size: int = 1


@dataclass(slots=True)
class Mapping:
    """Keys with their nodes, in file order."""

    entries: dict[str, Node]
    mark: FilePlace
    keys: dict[str, FilePlace] = field(default_factory=dict)
    size: int = 1


Node = Scalar | Sequence | Mapping


def describe(node: Node) -> str:
    """What a node is, as an error message says it."""
    if isinstance(node, Mapping):
        return "a mapping" if node.entries else "an empty mapping"
    if isinstance(node, Sequence):
        return f"a list of {len(node.items)}" if node.items else "an empty list"
    if node.empty:
        return "nothing"
    return f"'{shown(node.text)}'"
