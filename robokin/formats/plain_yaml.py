"""The plainest YAML to the tree of nodes that `yaml_tree` makes of it, without the library that reads all of it.

A robot's table is mappings and lists of words and numbers, each on its line, or in { } and [ ]. Such a text is read
here, with the same places; of any other (anchors, tags, escapes, texts over several lines but folded ones, a key given
twice, whatever is wrong) None is said, and PyYAML reads it, which takes longer to load than most answers take.
"""

from __future__ import annotations

import re
from bisect import bisect_right

from robokin.formats.yaml_tree import CHARACTERS, WHOLE_LINE, FilePlace, Mapping, Node, Scalar, Sequence

LONGEST = 1 << 16
"""Characters of a text that is read here."""

DEEPEST = 8
"""Levels of nesting."""

KEY = r"[A-Za-z_](?:[A-Za-z0-9_-]{0,98}[A-Za-z0-9_])?"
"""A key; YAML has none of more than 1,024 characters."""

START = r"(?:[A-Za-z0-9_.(+]|-(?=[A-Za-z0-9_.(]))"
"""What a word starts with that is nothing else in YAML."""

BLOCK_KEY = re.compile(rf"({KEY}):(?= |$)", re.MULTILINE)
FLOW_KEY = re.compile(rf"({KEY}):(?= )")
BLOCK_WORD = re.compile(rf"{START}(?:[^\n:# ]| +(?! |#|$)|:(?![ \n]|\Z)|(?<! )#)*", re.MULTILINE)
FLOW_WORD = re.compile(rf"{START}(?:[A-Za-z0-9_.+*/()-]| +(?=[A-Za-z0-9_.+*/()-]))*")
QUOTED = re.compile(r"\"([^\"\\\n]*)\"|'([^'\n]*)'(?!')")
REST = re.compile(r" *(?: #.*)?$", re.MULTILINE)
"""What may stand behind a value on its line."""

FOLDED = re.compile(r">-(?= *$)", re.MULTILINE)
LINE = re.compile(r"( *)([^\n]*)(?:\n|\Z)")


class NotPlainError(Exception):
    """The text is for those who read all there is."""


def plain_tree(text: str, file: str) -> Mapping | None:
    """The tree of a text, as `read_tree` gives it; None for a text that is not plain."""
    if len(text) > LONGEST or not text.endswith("\n") or not text.replace("\n", "").isprintable():
        return None
    try:
        return _Text(text, file).whole()
    except NotPlainError:
        return None


class _Text:
    """Reads a text from a place on."""

    def __init__(self, text: str, file: str) -> None:
        self.text, self.file = text, file
        self.at = 0
        self.starts = [0, *(end.end() for end in re.finditer("\n", text))]

    def place(self, at: int, width: int = 1) -> FilePlace:
        """A place in the file."""
        line = bisect_right(self.starts, at)
        return FilePlace(self.file, line, at - self.starts[line - 1] + 1, max(width, 1))

    def whole(self) -> Mapping:
        """All of the text: a mapping that begins at the margin."""
        if self._next_line() != 0:
            raise NotPlainError
        found = self._mapping(0, 1)
        if self.at < len(self.text):
            raise NotPlainError
        return found

    def _next_line(self) -> int:
        """Go to the next line that says something; the spaces before it, -1 at the end."""
        while self.at < len(self.text):
            line = LINE.match(self.text, self.at)
            assert line is not None
            said = line[2]
            if said and said[0] != "#":
                if said.startswith(("---", "...")) and not line[1]:
                    raise NotPlainError
                return len(line[1])
            self.at = line.end()
        return -1

    def _end_line(self) -> None:
        rest = REST.match(self.text, self.at)
        if rest is None:
            raise NotPlainError
        self.at = rest.end() + 1

    def _mapping(self, indent: int, depth: int) -> Mapping:
        """A mapping whose keys stand `indent` spaces behind the margin; the first one is next."""
        self._deeper(depth)
        found = Mapping({}, self.place(self._column(indent)))
        while True:
            self.at = self._column(indent)
            key = BLOCK_KEY.match(self.text, self.at)
            if key is None:
                raise NotPlainError
            name = self._word(key[1], key.start())
            self.at = key.end()
            self._add(found, name, self._value(indent, depth))
            if self._next_line() != indent:
                break
        return found

    def _column(self, indent: int) -> int:
        """The place of what stands at an indent in the line that `at` is in."""
        return self.starts[bisect_right(self.starts, self.at) - 1] + indent

    def _value(self, indent: int, depth: int) -> Node:
        """The value of a key at an indent, which is behind it, or deeper on the lines below it."""
        while self.text.startswith(" ", self.at):
            self.at += 1
        if self.text.startswith((">", "\n", "#"), self.at):
            if folded := FOLDED.match(self.text, self.at):
                return self._folded(folded.end(), indent)
            self._end_line_from_key()
            below = self._next_line()
            if below <= indent:
                raise NotPlainError
            if self.text.startswith("- ", self._column(below)):
                return self._list(below, depth + 1)
            return self._mapping(below, depth + 1)
        return self._on_line(indent, depth + 1)

    def _end_line_from_key(self) -> None:
        if self.text.startswith("#", self.at):
            self.at -= 1
            if self.text[self.at] != " ":
                raise NotPlainError
        self._end_line()

    def _on_line(self, indent: int, depth: int) -> Node:
        """A value on the rest of a line of a block; what is in brackets may go on below."""
        if self.text.startswith(("[", "{"), self.at):
            found = self._flow(indent, depth)
        elif quoted := QUOTED.match(self.text, self.at):
            found = self._quoted(quoted)
        else:
            word = BLOCK_WORD.match(self.text, self.at)
            if word is None:
                raise NotPlainError
            found = self._word(word[0], word.start())
            self.at = word.end()
        self._end_line()
        return found

    def _list(self, indent: int, depth: int) -> Sequence:
        """A list whose dashes stand `indent` spaces behind the margin; the first one is next."""
        self._deeper(depth)
        found = Sequence([], self.place(self._column(indent)))
        while True:
            self.at = self._column(indent)
            if not self.text.startswith("- ", self.at):
                raise NotPlainError
            self.at += 1
            while self.text.startswith(" ", self.at):
                self.at += 1
            inner = self.at - self._column(0)
            if BLOCK_KEY.match(self.text, self.at):
                item: Node = self._mapping(inner, depth + 1)
            else:
                item = self._on_line(indent, depth + 1)
            found.items.append(item)
            found.size += item.size
            if self._next_line() != indent:
                break
        return found

    def _folded(self, at: int, indent: int) -> Scalar:
        """A text on the lines below, all equally far from the margin, without an empty one."""
        mark, self.at = self.place(at - 2, WHOLE_LINE), at
        self._end_line()
        lines: list[str] = []
        deep = 0
        while self.at < len(self.text):
            line = LINE.match(self.text, self.at)
            assert line is not None
            spaces, said = len(line[1]), line[2]
            if said and spaces <= indent:
                break
            if not said or said != said.rstrip() or spaces != (deep or spaces):
                if said or lines == [] or spaces:
                    raise NotPlainError
                self.at = line.end()
                if self._next_line() > indent:
                    raise NotPlainError
                break
            deep = spaces
            lines.append(said)
            self.at = line.end()
        if not lines:
            raise NotPlainError
        text = " ".join(lines)
        return Scalar(text, mark, quoted=True, size=1 + len(text) // CHARACTERS)

    # In brackets -----------------------------------------------------------------------------------------

    def _flow(self, indent: int, depth: int) -> Node:
        """What is in [ ] or { }, which is next."""
        self._deeper(depth)
        mark, listed = self.place(self.at), self.text[self.at] == "["
        end = "]" if listed else "}"
        found: Sequence | Mapping = Sequence([], mark) if listed else Mapping({}, mark)
        self.at += 1
        while True:
            self._between(indent)
            if isinstance(found, Sequence):
                item = self._flow_value(indent, depth)
                found.items.append(item)
                found.size += item.size
            else:
                key = FLOW_KEY.match(self.text, self.at)
                if key is None:
                    raise NotPlainError
                self.at = key.end()
                self._between(indent)
                self._add(found, self._word(key[1], key.start()), self._flow_value(indent, depth))
            self._between(indent)
            self.at += 1
            if self.text[self.at - 1] == end:
                return found
            if self.text[self.at - 1] != "," or self.text[self.at] not in " \n":
                raise NotPlainError

    def _flow_value(self, indent: int, depth: int) -> Node:
        if self.text.startswith(("[", "{"), self.at):
            return self._flow(indent, depth + 1)
        if quoted := QUOTED.match(self.text, self.at):
            return self._quoted(quoted)
        word = FLOW_WORD.match(self.text, self.at)
        if word is None or word[0].count("(") != word[0].count(")"):
            raise NotPlainError
        self.at = word.end()
        return self._word(word[0], word.start())

    def _between(self, indent: int) -> None:
        """Go on to what is next inside brackets, which stands deeper than the block that they are in."""
        before = self.at
        while self.text.startswith((" ", "\n"), self.at) or (
            self.at > before and self.text.startswith("#", self.at) and self.text[self.at - 1] in " \n"
        ):
            if self.text[self.at] == "#":
                self.at = self.text.index("\n", self.at)
            else:
                self.at += 1
        if self.at >= len(self.text):
            raise NotPlainError
        if "\n" in self.text[before : self.at] and self.at - self._column(0) <= indent:
            raise NotPlainError

    # Words -----------------------------------------------------------------------------------------------

    def _word(self, text: str, at: int) -> Scalar:
        return Scalar(text, self.place(at, len(text)), size=1 + len(text) // CHARACTERS)

    def _quoted(self, found: re.Match[str]) -> Scalar:
        text = found[1] if found[1] is not None else found[2]
        self.at = found.end()
        mark = self.place(found.start(), found.end() - found.start())
        return Scalar(text, mark, quoted=True, size=1 + len(text) // CHARACTERS)

    @staticmethod
    def _add(found: Mapping, key: Scalar, value: Node) -> None:
        if key.text in found.entries:
            raise NotPlainError
        found.entries[key.text] = value
        found.keys[key.text] = key.mark
        found.size += key.size + value.size

    @staticmethod
    def _deeper(depth: int) -> None:
        if depth > DEEPEST:
            raise NotPlainError
