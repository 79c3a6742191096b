"""YAML text to a tree of nodes that know their line and column.

YAML's own guesses are not to be trusted with tables of numbers: in YAML 1.1 `1e-3` is a string, `012`
is ten, `1:30` is ninety, `no` is false, and a key given twice silently wins. So every scalar stays text
here; whoever knows what is expected at a place reads it. A key given twice, a tag, nesting beyond
`MAX_DEPTH` and aliases that multiply beyond `MAX_NODES` are refused. The tree is built from libyaml's
events, which are produced one by one, so that hostile text is refused before it costs anything.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import yaml

from robokin.errors import DescriptionError

MAX_DEPTH = 32
"""Levels of nesting; a description needs about six."""

MAX_NODES = 100_000
"""Nodes of the tree with its aliases written out; the largest description has about a thousand."""


@dataclass(frozen=True, slots=True)
class Mark:
    """A place in a file; line and column count from 1."""

    file: str
    line: int
    column: int

    def error(self, message: str) -> DescriptionError:
        """A DescriptionError at this place."""
        return DescriptionError(message, self.file, self.line, self.column)


@dataclass(slots=True)
class Scalar:
    """A scalar as it is written; `quoted` tells "1" from 1."""

    text: str
    mark: Mark
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
    mark: Mark
    size: int = 1


@dataclass(slots=True)
class Mapping:
    """Keys with their nodes, in file order."""

    entries: dict[str, Node]
    mark: Mark
    keys: dict[str, Mark] = field(default_factory=dict)
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
    return f"'{node.text if len(node.text) <= 40 else node.text[:37] + '...'}'"


def read_tree(text: str, file: str) -> Node:
    """The tree of a text with one YAML document. Raises DescriptionError with line and column."""
    loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
    try:
        return _Builder(yaml.parse(text, Loader=loader), file).document()
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        where = Mark(file, mark.line + 1, mark.column + 1) if mark else Mark(file, 1, 1)
        problem = error.problem or error.context or "it cannot be read"
        raise where.error(f"this is not YAML: {problem}") from None
    except yaml.YAMLError as error:
        raise Mark(file, 1, 1).error(f"this is not YAML: {' '.join(str(error).split())}") from None


class _Builder:
    """Builds the tree from events, keeping count of depth, aliases and size."""

    def __init__(self, events: Iterator[Any], file: str) -> None:
        self.events = events
        self.file = file
        self.anchors: dict[str, Node] = {}
        self.depth = 0

    def document(self) -> Node:
        """The only document of the stream."""
        root: Node | None = None
        for event in self.events:
            if isinstance(event, yaml.DocumentStartEvent):
                if root is not None:
                    raise self.mark(event).error("found a second document, expected one description a file")
                root = self.node(next(self.events))
        if root is None:
            raise Mark(self.file, 1, 1).error("the file is empty, expected a description: `robokin: 1`, `name: …`")
        return root

    def mark(self, event: Any) -> Mark:
        """Where an event starts."""
        return Mark(self.file, event.start_mark.line + 1, event.start_mark.column + 1)

    def node(self, event: Any) -> Node:
        """The node that starts with this event."""
        mark = self.mark(event)
        if isinstance(event, yaml.AliasEvent):
            if event.anchor not in self.anchors:
                raise mark.error(f"found the alias *{event.anchor}, expected an anchor &{event.anchor} before it")
            return self.anchors[event.anchor]
        # A plain scalar has no tag and a quoted one the tag '!' of a string; others change its meaning.
        if event.tag is not None and event.tag != "!":
            raise mark.error(f"found the tag '{event.tag}', expected none: a description holds only text and numbers")
        self.depth += 1
        if self.depth > MAX_DEPTH:
            raise mark.error(f"nested more than {MAX_DEPTH} levels deep, expected a plain description")
        node: Node
        if isinstance(event, yaml.ScalarEvent):
            node = Scalar(event.value, mark, quoted=event.style is not None)
        elif isinstance(event, yaml.SequenceStartEvent):
            node = self.sequence(mark)
        else:
            node = self.mapping(mark)
        self.depth -= 1
        if node.size > MAX_NODES:
            raise mark.error(f"its aliases make more than {MAX_NODES} values of it, expected a plain description")
        if event.anchor is not None:
            self.anchors[event.anchor] = node
        return node

    def sequence(self, mark: Mark) -> Sequence:
        """The items up to the end of the list."""
        found = Sequence([], mark)
        for event in self.events:
            if isinstance(event, yaml.SequenceEndEvent):
                break
            found.items.append(self.node(event))
            found.size += found.items[-1].size
        return found

    def mapping(self, mark: Mark) -> Mapping:
        """The entries up to the end of the mapping; `<<` takes in another mapping's, own keys win."""
        found = Mapping({}, mark)
        merged: list[Mapping] = []
        for event in self.events:
            if isinstance(event, yaml.MappingEndEvent):
                break
            key = self.node(event)
            if not isinstance(key, Scalar):
                raise key.mark.error(f"found {describe(key)} as a key, expected a word")
            value = self.node(next(self.events))
            found.size += 1 + value.size
            if key.text == "<<" and not key.quoted:
                merged.extend(self.merged(value))
            elif key.text in found.entries:
                first = found.keys[key.text].line
                raise key.mark.error(f"the key '{key.text}' is given twice, first on line {first}")
            else:
                found.entries[key.text] = value
                found.keys[key.text] = key.mark
        for other in merged:
            for name, value in other.entries.items():
                if name not in found.entries:
                    found.entries[name] = value
                    found.keys[name] = other.keys[name]
        return found

    def merged(self, value: Node) -> list[Mapping]:
        """The mappings that `<<` names: one, or a list of them."""
        parts = value.items if isinstance(value, Sequence) else [value]
        for part in parts:
            if not isinstance(part, Mapping):
                raise part.mark.error(f"found {describe(part)} after '<<', expected a mapping or its alias")
        return [part for part in parts if isinstance(part, Mapping)]
