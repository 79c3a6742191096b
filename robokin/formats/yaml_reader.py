"""YAML text to a tree of nodes, by PyYAML.

A key given twice, which silently wins in YAML, a tag, nesting beyond `MAX_DEPTH` and a text (its aliases written out)
that is larger than `MAX_SIZE` are refused. The tree is built from libyaml's events, which are produced one by one, so
that hostile text is refused before it costs anything. Some libraries refuse deep nesting themselves, and read ahead so
far that they do it before the first event; `_nests_too_deep` finds whether our own limit came first.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import yaml

from robokin.errors import DescriptionError, shown
from robokin.formats.excerpts import LINE_BREAK
from robokin.formats.faults import Faults
from robokin.formats.yaml_tree import CHARACTERS, WHOLE_LINE, FilePlace, Mapping, Node, Scalar, Sequence, describe

MAX_DEPTH = 32
"""Levels of nesting; a description needs about six."""

MAX_SIZE = 100_000
"""Size of the tree with its aliases written out; the largest description has about a thousand values."""

NO_TEXT = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x84\x86-\x9f\ud800-\udfff\ufeff\ufffe\uffff]")
"""Characters that YAML refuses: controls, halves of surrogate pairs, and what is no character."""

BEFORE_VALUE = ("", "-", ":", ",", "?", "[", "{")
"""What stands before a value on its line."""

NO_START = ("@", "`", "%", "|", ">")
"""Characters that no plain value starts with, wherever a library stops at them."""


def read_tree(text: str, file: str, faults: Faults | None = None) -> Node:
    """The tree of a text with one YAML document; mistakes that leave it readable are gathered in `faults`, if given.

    Raises DescriptionError with line and column.
    """
    gathered = Faults() if faults is None else faults
    root = _read(text.removeprefix("\ufeff"), file, gathered)
    if faults is None:
        gathered.stop()
    return root


def _read(text: str, file: str, faults: Faults) -> Node:
    if found := NO_TEXT.search(text):
        ends = [end.end() for end in LINE_BREAK.finditer(text, 0, found.start())]
        line, column = len(ends) + 1, found.start() - (ends[-1] if ends else 0) + 1
        code = f"U+{ord(found[0]):04X}"
        raise FilePlace(file, line, column).error(
            f"found the character {code}, which is no text, expected YAML in UTF-8"
        )
    try:
        return _Builder(_events(text), file, faults).document()
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        for end in (mark.index, mark.index - 1) if mark else ():
            if end > 0 and _nests_too_deep(text[:end]):
                return _Builder(_events(text[:end]), file, faults).document()
        where = FilePlace(file, mark.line + 1, mark.column + 1) if mark else FilePlace(file, 1, 1)
        raise where.error(_problem(error, text)) from None
    except yaml.YAMLError as error:
        raise FilePlace(file, 1, 1).error(f"this is not YAML: {shown(str(error), 200)}") from None


def _events(text: str) -> Iterator[Any]:
    """The events of a text, one by one, from libyaml or from its stand-in in Python."""
    events: Iterator[Any] = yaml.parse(text, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader))
    return events


def _nests_too_deep(text: str) -> bool:
    """Whether the part of a text that a library has read without complaint nests deeper than `MAX_DEPTH`.

    A library reads up to 1,024 characters ahead, since all that it has read may turn out to be a key; what it
    refuses there, nesting beyond a limit of its own or another mistake, hides the events of what stands before.
    The end of a text ends the reading ahead, so the part before the refused place yields its events (a library
    may name the place before the refused character or the one after it).
    """
    depth = 0
    try:
        for event in _events(text):
            if isinstance(event, yaml.CollectionEndEvent):
                depth -= 1
            elif isinstance(event, yaml.CollectionStartEvent):
                depth += 1
            if depth + isinstance(event, yaml.ScalarEvent) > MAX_DEPTH:
                return True
    except yaml.YAMLError:  # the part ends inside a list, or the place of the mistake is not exact
        return False
    return False


def _problem(error: yaml.MarkedYAMLError, text: str) -> str:
    """What is wrong with a text that is no YAML, in words for who wrote it.

    Common mistakes are known by the character at which the library stops: its own words change between versions.
    """
    problem = error.problem or error.context or "it cannot be read"
    mark = error.problem_mark
    character = text[mark.index : mark.index + 1] if mark else ""
    before = text[mark.index - mark.column : mark.index].rstrip(" ")[-1:] if mark else ""
    if character == ":":
        return "found ': ' inside a value, expected quotes around it, or a line for each key"
    if character == "\t":
        return "found a tab, expected spaces: YAML indents with spaces alone"
    if character in NO_START and before in BEFORE_VALUE:
        return f"found '{character}' where a value starts, expected it in quotes"
    expected = "" if "expected" in problem else ", expected quotes around a text with any of : # [ ] { } , & * ! | % @"
    return f"this is not YAML: {problem}{expected}"


class _Builder:
    """Builds the tree from events, keeping count of depth and size."""

    def __init__(self, events: Iterator[Any], file: str, faults: Faults) -> None:
        self.events = events
        self.file = file
        self.faults = faults
        self.anchors: dict[str, Node] = {}
        self.depth = 0

    def document(self) -> Node:
        """The only document of the stream."""
        root: Node | None = None
        for event in self.events:
            if isinstance(event, yaml.DocumentStartEvent):
                if root is not None:
                    self.faults.add(self.mark(event).error("found a second document, expected one description a file"))
                    break
                root = self.node(next(self.events))
        if root is None:
            raise FilePlace(self.file, 1, 1).error(
                "found nothing in the file, expected a description: `robokin: 1`, `name: …`"
            )
        return root

    def mark(self, event: Any) -> FilePlace:
        """Where an event starts, and how much of its line is meant: all of a scalar, the start of anything else."""
        start, end = event.start_mark, event.end_mark
        width = 1
        if isinstance(event, yaml.ScalarEvent | yaml.AliasEvent):
            width = end.column - start.column if end.line == start.line else WHOLE_LINE
        return FilePlace(self.file, start.line + 1, start.column + 1, max(width, 1))

    def node(self, event: Any) -> Node:
        """The node that starts with this event."""
        mark = self.mark(event)
        if isinstance(event, yaml.AliasEvent):
            if event.anchor not in self.anchors:
                self.faults.add(
                    mark.error(f"found the alias *{event.anchor}, expected an anchor &{event.anchor} before it")
                )
                return Scalar("", mark.silent())
            return self.anchors[event.anchor]
        # A plain scalar has no tag and a quoted one the tag '!' of a string; others change its meaning.
        if event.tag is not None and event.tag != "!":
            tag = shown(event.tag)
            self.faults.add(
                mark.error(f"found the tag '{tag}', expected none: a description holds only text and numbers")
            )
            mark = mark.silent()
        self.depth += 1
        if self.depth > MAX_DEPTH:
            raise mark.error(f"found more than {MAX_DEPTH} levels of nesting, expected a plain description")
        node: Node
        if isinstance(event, yaml.ScalarEvent):
            # The style of a plain scalar is "" from libyaml and None from its stand-in in Python.
            node = Scalar(event.value, mark, quoted=bool(event.style), size=1 + len(event.value) // CHARACTERS)
        elif isinstance(event, yaml.SequenceStartEvent):
            node = self.sequence(mark, bool(event.flow_style))
        else:
            node = self.mapping(mark, bool(event.flow_style))
        self.depth -= 1
        if event.anchor is not None:
            self.anchors[event.anchor] = node
        return node

    def grow(self, found: Sequence | Mapping, size: int) -> None:
        """Count what was added to a node; to wait for its end would let aliases multiply first."""
        found.size += size
        if found.size > MAX_SIZE:
            raise found.mark.error(
                f"found more than {MAX_SIZE} values, aliases written out, expected a plain description"
            )

    def sequence(self, mark: FilePlace, flow: bool) -> Sequence:
        """The items up to the end of the list."""
        found = Sequence([], mark)
        cut: Scalar | None = None
        for event in self.events:
            if isinstance(event, yaml.SequenceEndEvent):
                break
            item = self.node(event)
            self.grow(found, item.size)
            if flow and cut is not None and _open(item) < 0:
                self.faults.add(_cut_off(cut))
                cut.mark = cut.mark.silent()
                del found.items[found.items.index(cut) + 1 :]
                cut = None
                continue
            if flow and _open(item) > 0 and isinstance(item, Scalar):
                cut = item
            found.items.append(item)
        return found

    def mapping(self, mark: FilePlace, flow: bool) -> Mapping:
        """The entries up to the end of the mapping; `<<` takes in another mapping's, own keys win."""
        found = Mapping({}, mark)
        merged: list[Mapping] = []
        merging: FilePlace | None = None
        cut: Scalar | None = None
        for event in self.events:
            if isinstance(event, yaml.MappingEndEvent):
                break
            key = self.node(event)
            if not isinstance(key, Scalar):
                self.faults.add(key.mark.error(f"found {describe(key)} as a key, expected a word"))
            value = self.node(next(self.events))
            self.grow(found, key.size + value.size)
            if not isinstance(key, Scalar):
                continue
            if flow and cut is not None and isinstance(value, Scalar) and value.empty:
                self.faults.add(_cut_off(cut))
                cut.mark = cut.mark.silent()
                cut = None if _open(key) < 0 else cut
                continue
            cut = value if isinstance(value, Scalar) and _open(value) > 0 else None
            merges = key.text == "<<" and not key.quoted
            first = merging if merges else found.keys.get(key.text)
            if first is not None:
                self.faults.add(
                    key.mark.error(
                        f"found the key '{shown(key.text)}' twice, first on line {first.line}, expected each key once"
                    )
                )
                # Which of the two is meant is not known: neither is judged.
                if key.text in found.entries:
                    found.entries[key.text] = Scalar("", key.mark.silent())
                continue
            if merges:
                merging = key.mark
                merged.extend(self.merged(value))
            else:
                found.entries[key.text] = value
                found.keys[key.text] = key.mark
        for other in merged:  # bounded, since `found` has grown by the size of each
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
                self.faults.add(part.mark.error(f"found {describe(part)} after '<<', expected a mapping or its alias"))
        return [part for part in parts if isinstance(part, Mapping)]


def _open(node: Node) -> int:
    """How many more parentheses a plain scalar opens than it closes."""
    plain = isinstance(node, Scalar) and not node.quoted
    return node.text.count("(") - node.text.count(")") if plain and isinstance(node, Scalar) else 0


def _cut_off(piece: Scalar) -> DescriptionError:
    """The error for `[atan2(1, 2)]` or `{origin: Trans(0, 0, 1)}`, whose commas are YAML's."""
    return piece.mark.error(
        f"found '{shown(piece.text)}' cut off at a comma, expected the expression in quotes: "
        "inside [ ] and { } a comma ends a value"
    )
